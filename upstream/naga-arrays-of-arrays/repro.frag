#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void main() {
    float a[2][3];
    a[1][2] = p.x;
    color = vec4(a[1][2]);
}
