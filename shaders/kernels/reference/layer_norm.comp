#version 450
// Each row is shifted and scaled to mean 0 and variance 1, then scaled and shifted as learned.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer Values { float values[]; };
layout(std430, binding = 1) readonly buffer Gain { float gain[]; };
layout(std430, binding = 2) readonly buffer Bias { float bias[]; };
layout(std430, binding = 3) writeonly buffer Normed { float normed[]; };

void main() {
    int columns = gain.length();
    for (int row = 0; row < ROWS; row++) {
        float mean = 0.0;
        for (int k = 0; k < columns; k++) {
            mean += values[row * columns + k] / float(columns);
        }
        float variance = 0.0;
        for (int k = 0; k < columns; k++) {
            float away = values[row * columns + k] - mean;
            variance += away * away / float(columns);
        }
        for (int k = 0; k < columns; k++) {
            normed[row * columns + k] = (values[row * columns + k] - mean) / sqrt(variance + 1e-3) * gain[k] + bias[k];
        }
    }
}
