#version 150 core
#extension GL_ARB_explicit_attrib_location : enable

// 頭髪の節点：変換はジオメトリシェーダで行う
// Hands a node of a strand on as it is.

layout (location = 0) in vec4 position;   // 節点の位置（ローカル座標系）

void main(void)
{
  gl_Position = position;                 // 視点座標系への変換はしない
}
