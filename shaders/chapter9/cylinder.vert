#version 150 core

// 円柱の側面：格子点 (s, t) を半径 1、高さ 2 の円柱に写す
// Side of a cylinder around the y axis: s runs once around, t from the bottom to the top.

in vec2 parameter;      // 格子点 (s, t)、どちらも 0 から 1
uniform mat4 mc;        // クリッピング座標系への変換行列

void main(void)
{
  /* 方位角 */ float th = 6.28318530717958648 * parameter.s;
  /* 高さ   */ float y = parameter.t * 2.0 - 1.0;
  /* 頂点   */ vec4 p = vec4(cos(th), y, sin(th), 1.0);

  gl_Position = mc * p;
}
