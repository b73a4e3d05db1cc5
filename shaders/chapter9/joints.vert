#version 150 core

// 関節：頂点ごとの部品番号で、その部品の剛体変換を選ぶ
// Every vertex belongs to one rigid part. The part that connects two others has no vertices of its
// own: its faces are indexed from the rims of its two neighbours, whose vertices carry their own
// part numbers. It therefore follows both, and collapses when they turn apart: at half a turn
// about the common axis all its edges meet in one point.

const int PARTS = 4;            // 部品の数

in vec4 position;               // ローカル座標系の頂点の位置
in int part;                    // 頂点の属する部品の番号、0 から PARTS - 1
uniform mat4 partMatrix[PARTS]; // 部品の剛体変換
uniform mat4 mc;                // クリッピング座標系への変換行列

void main(void)
{
  gl_Position = mc * (partMatrix[part] * position);
}
