#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void main() { mat2x3 m = outerProduct(p.xyz, p.xy); color = vec4(m[1], 1.0); }
