#version 150 core

// 骨までの距離 d に対する重み
// 1 on the bone, falling with the distance d >= 0; the greater c, the faster. Binary32 leaves its
// normal range at d = 2^(126/c) - 1: 233 for c = 16, but 2.9 for c = 64.
float bone_weight(float d, float c)
{
  return pow(d + 1.0, -c);
}
