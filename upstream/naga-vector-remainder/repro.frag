#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void main() { ivec2 i = ivec2(p.xy) % 3; color = vec4(i, i); }
