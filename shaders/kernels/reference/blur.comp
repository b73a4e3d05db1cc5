#version 450
// The rows of an image, blurred: the weights are those of (1 + x)^4 / 16.
layout(local_size_x = 1) in;
layout(std430, binding = 1) readonly buffer Source { float source[]; };
layout(std430, binding = 2) writeonly buffer Blurred { float blurred[]; };

void main() {
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            float sum = 0.0;
            float binomial = 1.0;
            for (int k = 0; k < 5; k++) {
                sum += binomial * source[y * WIDTH + clamp(x + k - 2, 0, WIDTH - 1)];
                binomial = binomial * float(4 - k) / float(k + 1);
            }
            blurred[y * WIDTH + x] = sum / 16.0;
        }
    }
}
