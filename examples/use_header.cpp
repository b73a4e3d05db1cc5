// Includes reference data of shadercheck in the format c, and tests a function of one's own with them.
//
//     shadercheck refdata generate bone_weight --format c --output bone_weight.h
//     c++ -std=c++17 -O2 -I . use_header.cpp -o use_header && ./use_header

#include <cmath>
#include <cstdio>

#include "bone_weight.h"

// What is tested: the weight of a bone at the distance d.
static float bone_weight(float d, float c)
{
  return std::pow(d + 1.0f, -c);
}

int main()
{
  unsigned judged = 0, wrong = 0;
  for (const refdata_bone_weight_sample &sample : refdata_bone_weight_samples)
  {
    const double actual = bone_weight(sample.d, sample.c);
    if (!std::isfinite(sample.bound_return)) continue;
    ++judged;
    if (!(std::fabs(actual - sample.expected_return) <= sample.bound_return)) ++wrong;
  }
  std::printf("%u of %d samples judged, %u beyond their bounds\n", judged, REFDATA_BONE_WEIGHT_SAMPLES, wrong);
  return judged > 0 && wrong == 0 ? 0 : 1;
}
