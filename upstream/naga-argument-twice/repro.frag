#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
void add(inout float a) { a += 1.0; }
void main() {
    float q[3] = float[3](0.0, 0.0, 0.0);
    int i = 0;
    add(q[i++]);
    color = vec4(q[0], q[1], q[2], float(i));
}
