#version 150 core

// モーフターゲット：基準の形状を、複数の目標の形状に向けてそれぞれの重みで変形する
// Moves a base vertex towards four targets. The weights are independent of each other: weight 0
// leaves the base, weight 1 reaches its target, and their sum need not be 1.

const int TARGETS = 4;          // 目標の数

in vec4 pn;                     // 基準の位置
in vec4 p1, p2, p3, p4;         // 目標の位置
uniform float w[TARGETS];       // 目標の重み
uniform mat4 mc;                // クリッピング座標系への変換行列

void main(void)
{
  // 基準からの変位に重みを掛けて足し合わせる
  vec4 p = pn;
  p += w[0] * (p1 - pn);
  p += w[1] * (p2 - pn);
  p += w[2] * (p3 - pn);
  p += w[3] * (p4 - pn);

  gl_Position = mc * p;
}
