#version 150 core

// エルミート曲線
// Cubic from p0 (s = 0) with the tangent m0 to p1 (s = 1) with the tangent m1.
vec4 hermite(vec4 p0, vec4 p1, vec4 m0, vec4 m1, float s)
{
  vec4 dp = p0 - p1;
  vec4 a = 2.0 * dp + m0 + m1;
  vec4 b = -3.0 * dp - 2.0 * m0 - m1;

  return ((a * s + b) * s + m0) * s + p0;
}
