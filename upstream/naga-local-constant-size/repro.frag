#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void main() { const int N = 3; float c[N]; c[0] = p.x; color = vec4(c[0]); }
