#version 150 core

// 頭髪の陰影：接線と光線、視線のなす角から拡散反射と鏡面反射を求める
// Shades a thin cylinder by the angles between its tangent, the light and the viewer.

const vec3 kd = vec3(0.4, 0.25, 0.1);   // 拡散反射係数
const vec3 ks = vec3(0.3, 0.3, 0.3);    // 鏡面反射係数
const float shininess = 40.0;           // 輝き係数

in vec3 v;                              // 視線ベクトル
in vec3 l;                              // 光線ベクトル
in vec3 t;                              // 接線ベクトル

out vec4 fc;                            // フラグメントの色

void main(void)
{
  float lt = dot(normalize(l), normalize(t));
  float vt = dot(normalize(v), normalize(t));
  float ls = sqrt(max(1.0 - lt * lt, 0.0));
  float vs = sqrt(max(1.0 - vt * vt, 0.0));

  vec3 diffuse = kd * ls;
  vec3 specular = ks * pow(max(ls * vs - lt * vt, 0.0), shininess);
  fc = vec4(diffuse + specular, 1.0);
}
