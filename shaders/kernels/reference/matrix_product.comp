#version 450
// The product of two matrices, element by element.
layout(local_size_x = 1) in;
layout(std430, binding = 1) readonly buffer A { float a[]; };
layout(std430, binding = 2) readonly buffer B { float b[]; };
layout(std430, binding = 3) writeonly buffer C { float c[]; };

void main() {
    for (int row = 0; row < M; row++) {
        for (int column = 0; column < N; column++) {
            float sum = 0.0;
            for (int k = 0; k < K; k++) {
                sum += a[row * K + k] * b[k * N + column];
            }
            c[row * N + column] = sum;
        }
    }
}
