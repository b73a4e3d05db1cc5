#version 150 core
#extension GL_ARB_explicit_attrib_location : enable

// 入力と出力
layout(lines_adjacency) in;
layout(line_strip, max_vertices = 20) out;

const int division = 4;              // 分割数
const vec4 pl = vec4(1.0, 6.0, 4.0, 1.0);

uniform mat4 mc;

out vec3 v, l, t;

void main()
{
  vec4 q0 = gl_in[0].gl_Position, q1 = gl_in[1].gl_Position;
  vec4 q2 = gl_in[2].gl_Position, q3 = gl_in[3].gl_Position;
  vec4 m0 = (q2 - q0) * 0.5, m1 = (q3 - q1) * 0.5, dp = q1 - q2;
  vec4 a = 2.0 * dp + m0 + m1, b = -3.0 * dp - 2.0 * m0 - m1;

  for (int i = 0; i <= division; ++i) {
    float s = float(i) / float(division);
    vec4 position = ((a * s + b) * s + m0) * s + q1;
    gl_Position = mc * position;
    v = -normalize(position.xyz);
    l = normalize((pl - position * pl.w).xyz);
    t = normalize(((3.0 * a * s + 2.0 * b) * s + m0).xyz);
    EmitVertex();
  }
  EndPrimitive();
}
