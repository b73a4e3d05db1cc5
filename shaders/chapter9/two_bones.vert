#version 150 core

// 二本の骨による頂点ブレンディング：それぞれの骨で動かした位置を重みで混ぜる
// The host computes blendMatrix[i] = B_i * inverse(M_i): from the pose in which the vertex was given
// to the bone, and from there to its present place. Weights with a sum other than 1 leave that sum
// in w, where the homogeneous divide takes it out.

in vec4 position;               // 初期姿勢における頂点の位置
in vec2 weight;                 // 二本の骨の重み
uniform mat4 blendMatrix[2];    // 骨の現在の変換と初期姿勢の逆変換の積
uniform mat4 mc;                // クリッピング座標系への変換行列

out vec4 candidate0;            // 骨 0 だけで動かした位置
out vec4 candidate1;            // 骨 1 だけで動かした位置

void main(void)
{
  candidate0 = blendMatrix[0] * position;
  candidate1 = blendMatrix[1] * position;

  gl_Position = mc * (weight.x * candidate0 + weight.y * candidate1);
}
