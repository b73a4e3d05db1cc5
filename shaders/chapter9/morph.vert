#version 150 core

// モーフィング：二つの形状の対応する頂点を割合 t で補間する
// Blends two corresponding vertices: p0 at t = 0, p1 at t = 1.

in vec4 p0, p1;         // 変形前と変形後の頂点の位置
uniform float t;        // 補間の割合、0 から 1
uniform mat4 mc;        // クリッピング座標系への変換行列

void main(void)
{
  gl_Position = mc * mix(p0, p1, t);
}
