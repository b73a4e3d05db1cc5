#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
const float table[2] = float[2](1.0, 2.0);
const float second = table[1];
void main() { color = vec4(second); }
