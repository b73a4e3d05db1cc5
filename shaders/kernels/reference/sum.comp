#version 450
// The sum of all numbers, one after the other.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer Values { float values[]; };
layout(std430, binding = 1) writeonly buffer Total { float total[1]; };

void main() {
    float sum = 0.0;
    for (int k = 0; k < values.length(); k++) {
        sum += values[k];
    }
    total[0] = sum;
}
