#version 150 core

// 頭髪：隣り合う四つの節点から Catmull-Rom 曲線を作り、折れ線にして出力する
// Draws the piece of curve between the second and the third of four successive nodes.

layout (lines_adjacency) in;
layout (line_strip, max_vertices = 5) out;

const int division = 4;                         // 一つの区間の分割数
const vec4 pl = vec4(1.0, 6.0, 4.0, 1.0);       // 光源の位置

uniform mat4 mc;                                // クリッピング座標系への変換行列

out vec3 v;                                     // 視線ベクトル
out vec3 l;                                     // 光線ベクトル
out vec3 t;                                     // 接線ベクトル

void main(void)
{
  vec4 q0 = gl_in[0].gl_Position;
  vec4 q1 = gl_in[1].gl_Position;
  vec4 q2 = gl_in[2].gl_Position;
  vec4 q3 = gl_in[3].gl_Position;

  // 区間の両端における接線
  vec4 m0 = (q2 - q0) * 0.5;
  vec4 m1 = (q3 - q1) * 0.5;

  // 三次式の係数
  vec4 dp = q1 - q2;
  vec4 a = 2.0 * dp + m0 + m1;
  vec4 b = -3.0 * dp - 2.0 * m0 - m1;
  vec4 c = m0;
  vec4 d = q1;

  for (int i = 0; i <= division; ++i)
  {
    float s = float(i) / float(division);
    vec4 position = ((a * s + b) * s + c) * s + d;

    gl_Position = mc * position;
    v = -normalize(position.xyz);
    l = normalize((pl - position * pl.w).xyz);
    t = normalize(((3.0 * a * s + 2.0 * b) * s + c).xyz);
    EmitVertex();
  }

  EndPrimitive();
}
