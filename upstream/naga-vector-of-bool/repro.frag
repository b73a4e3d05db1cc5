#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void main() { color = vec4(p.x > 0.0); }
