#version 450
layout(location = 0) flat in int x;
layout(location = 0) out int o;
void main() {
    o = x < bitCount(1u) ? 1 : 0;
}
