#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
layout(binding = 0) uniform Lamp { float brightness; };
float doubled = brightness * 2.0;
void main() { color = p * doubled; }
