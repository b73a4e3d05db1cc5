#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void change(inout float a, inout float b) { a = 1.0; b = b + 1.0; }
void main() {
    float x = 5.0;
    change(x, x);
    color = vec4(x);
}
