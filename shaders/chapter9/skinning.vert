#version 150 core

// 頂点ブレンディング：頂点から骨（線分）までの距離で各骨の変換の重みを決める
// Every bone is a segment; its influence falls with the distance of the vertex to the segment.
// The sum of the weights stays in u.w, and the homogeneous divide takes it out.

const int MAXBONES = 8;             // 骨の最大数
const float exponent = -16.0;       // 距離に対する重みの減り方

in vec4 position;                   // ローカル座標系の頂点の位置
uniform mat4 modelViewMatrix;       // 視点座標系への変換行列
uniform mat4 projectionMatrix;      // 投影変換行列
uniform int numberOfBones;          // 骨の数
uniform vec4 p0[MAXBONES];          // 骨の根元の位置（視点座標系）
uniform vec4 p1[MAXBONES];          // 骨の先端の位置（視点座標系）
uniform mat4 blendMatrix[MAXBONES]; // 骨の現在の変換と初期姿勢の逆変換の積

void main(void)
{
  vec4 p = modelViewMatrix * position;
  vec4 u = vec4(0.0);

  for (int i = 0; i < numberOfBones; ++i)
  {
    vec4 v1 = p1[i] - p0[i], v2 = p - p0[i];
    float l = dot(v1, v1);

    // 長さのある骨なら、線分上の最も近い点からのベクトルにする
    if (l > 0.0) v2 -= v1 * clamp(dot(v1, v2) / l, 0.0, 1.0);

    u += pow(length(v2) + 1.0, exponent) * blendMatrix[i] * p;
  }

  gl_Position = projectionMatrix * u;
}
