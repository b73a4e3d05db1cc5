#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void main() { mat2 m = mat2(p); color = vec4(m[0], m[1]); }
