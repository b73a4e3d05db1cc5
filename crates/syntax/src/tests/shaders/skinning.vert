#version 150 core

// 骨の数の上限
const int MAXBONES = 8;

// 重みの減衰
const float exponent = -16.0;

in vec4 position;                    // ローカル座標
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform int numberOfBones;
uniform vec4 p0[MAXBONES], p1[MAXBONES]; // 根元と先端
uniform mat4 blendMatrix[MAXBONES];

void main()
{
  vec4 p = modelViewMatrix * position;
  vec4 u = vec4(0.0);

  for (int i = 0; i < numberOfBones; ++i) {
    vec4 v1 = p1[i] - p0[i], v2 = p - p0[i];
    float l = dot(v1, v1);
    if (l > 0.0) v2 -= v1 * clamp(dot(v1, v2) / l, 0.0, 1.0);
    u += pow(length(v2) + 1.0, exponent) * blendMatrix[i] * p;
  }

  gl_Position = projectionMatrix * u;
}
