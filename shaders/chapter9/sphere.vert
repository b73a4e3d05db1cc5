#version 150 core

// 球面：格子点 (s, t) を方位角と極角に写して単位球面上の点にする
// Unit sphere: s runs once around the y axis, t from the north pole to the south pole.

in vec2 parameter;      // 格子点 (s, t)、どちらも 0 から 1
uniform mat4 mc;        // クリッピング座標系への変換行列

void main(void)
{
  float th = 6.28318530717958648 * parameter.s;    // 方位角 θ = 2πs
  float ph = 3.14159265358979324 * parameter.t;    // 極角 φ = πt、y 軸の正の向きから測る
  float r = sin(ph);                    // y 軸からの距離

  vec4 p = vec4(r * cos(th), cos(ph), r * sin(th), 1.0);
  gl_Position = mc * p;
}
