#version 150 core

// Kochanek-Bartels スプライン：張り、偏り、連続性で接線を決める
// Point between q1 (s = 0) and q2 (s = 1). With tension, bias and continuity 0 it is Catmull-Rom.
vec4 kochanek_bartels(vec4 q0, vec4 q1, vec4 q2, vec4 q3,
                      float tension, float bias, float continuity, float s)
{
  vec4 d0 = q1 - q0;
  vec4 d1 = q2 - q1;
  vec4 d2 = q3 - q2;

  // 接線に対する、節点の前の差と後の差の寄与
  float before = (1.0 - tension) * (1.0 + bias) * 0.5;
  float after = (1.0 - tension) * (1.0 - bias) * 0.5;

  // q1 を出る接線と q2 に入る接線
  vec4 m0 = before * (1.0 + continuity) * d0 + after * (1.0 - continuity) * d1;
  vec4 m1 = before * (1.0 - continuity) * d1 + after * (1.0 + continuity) * d2;

  vec4 a = m0 + m1 - 2.0 * d1;
  vec4 b = 3.0 * d1 - 2.0 * m0 - m1;

  return ((a * s + b) * s + m0) * s + q1;
}
