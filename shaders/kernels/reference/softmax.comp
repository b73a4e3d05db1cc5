#version 450
// exp(x) of each number of a row, divided by the sum of them.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer Values { float values[]; };
layout(std430, binding = 1) writeonly buffer Shares { float shares[]; };

void main() {
    int columns = values.length() / ROWS;
    for (int row = 0; row < ROWS; row++) {
        float sum = 0.0;
        for (int k = 0; k < columns; k++) {
            sum += exp(values[row * columns + k]);
        }
        for (int k = 0; k < columns; k++) {
            shares[row * columns + k] = exp(values[row * columns + k]) / sum;
        }
    }
}
