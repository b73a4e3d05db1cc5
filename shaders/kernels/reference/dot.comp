#version 450
// The dot product of two long vectors, one product after the other.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer A { float a[]; };
layout(std430, binding = 1) readonly buffer B { float b[]; };
layout(std430, binding = 2) writeonly buffer Product { float product[1]; };

void main() {
    float sum = 0.0;
    for (int k = 0; k < a.length(); k++) {
        sum += a[k] * b[k];
    }
    product[0] = sum;
}
