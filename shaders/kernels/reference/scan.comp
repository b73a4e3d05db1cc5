#version 450
// Inclusive prefix sums, one after the other.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer Values { uint values[]; };
layout(std430, binding = 1) writeonly buffer Sums { uint sums[]; };

void main() {
    uint sum = 0u;
    for (int k = 0; k < values.length(); k++) {
        sum += values[k];
        sums[k] = sum;
    }
}
