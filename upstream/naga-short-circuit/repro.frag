#version 450
layout(location = 0) in vec4 p;
layout(location = 0) out vec4 color;
int calls = 0;
bool counted() { calls++; return true; }
void main() {
    bool both = p.x > 0.0 && counted();
    color = vec4(float(calls), both ? 1.0 : 0.0, 0.0, 1.0);
}
