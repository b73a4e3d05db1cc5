#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void main() { vec3 q = vec3(p.x, p.y, p.z, 1.0); color = vec4(q, 1.0); }
