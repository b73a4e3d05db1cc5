#version 150 core

// 点と線分の距離
// Distance of p to the segment from p0 to p1. All three have the same w, as points with w = 1 have:
// a difference in w would count as a distance. A segment of length 0 is a point.
float segment_distance(vec4 p, vec4 p0, vec4 p1)
{
  vec4 v1 = p1 - p0;
  vec4 v2 = p - p0;
  float l = dot(v1, v1);

  // 線分上の最も近い点からのベクトル
  if (l > 0.0) v2 -= v1 * clamp(dot(v1, v2) / l, 0.0, 1.0);

  return length(v2);
}
