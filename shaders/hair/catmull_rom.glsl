#version 150 core

// Catmull-Rom 曲線：前後の節点の差の半分を接線とする
// Point between q1 (s = 0) and q2 (s = 1), and the derivative there.
vec4 catmull_rom(vec4 q0, vec4 q1, vec4 q2, vec4 q3, float s, out vec4 derivative)
{
  vec4 m0 = (q2 - q0) * 0.5;
  vec4 m1 = (q3 - q1) * 0.5;

  vec4 dp = q1 - q2;
  vec4 a = 2.0 * dp + m0 + m1;
  vec4 b = -3.0 * dp - 2.0 * m0 - m1;

  derivative = (3.0 * a * s + 2.0 * b) * s + m0;
  return ((a * s + b) * s + m0) * s + q1;
}
