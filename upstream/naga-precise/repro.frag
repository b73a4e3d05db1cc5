#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void main() { precise vec4 q = p * p.x + p.y; color = q; }
