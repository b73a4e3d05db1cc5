#version 150 core

// Cardinal スプライン：Catmull-Rom の接線を 1 - w 倍する
// Point between q1 (s = 0) and q2 (s = 1). w = 0 is Catmull-Rom, w = 1 the straight line.
vec4 cardinal(vec4 q0, vec4 q1, vec4 q2, vec4 q3, float w, float s)
{
  float k = (1.0 - w) * 0.5;
  vec4 m0 = (q2 - q0) * k;
  vec4 m1 = (q3 - q1) * k;

  vec4 dp = q1 - q2;
  vec4 a = 2.0 * dp + m0 + m1;
  vec4 b = -3.0 * dp - 2.0 * m0 - m1;

  return ((a * s + b) * s + m0) * s + q1;
}
