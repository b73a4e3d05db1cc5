#version 450
// One pass of a separable blur: the rows of an image, which end as their last pixels go on. A workgroup has 32 pixels of
// a row, and two more on either side.
layout(local_size_x = 32) in;
layout(std140, binding = 0) uniform Image { uint width; };
layout(std430, binding = 1) readonly buffer Source { float source[]; };
layout(std430, binding = 2) writeonly buffer Blurred { float blurred[]; };

const float weights[3] = float[](0.375, 0.25, 0.0625);

shared float row[36];

float pixel(int x) {
    return source[gl_WorkGroupID.y * width + uint(clamp(x, 0, int(width) - 1))];
}

void main() {
    int local = int(gl_LocalInvocationIndex);
    int x = int(gl_GlobalInvocationID.x);
    row[local + 2] = pixel(x);
    if (local < 2) {
        row[local] = pixel(x - 2);
        row[local + 34] = pixel(x + 32);
    }
    barrier();
    if (x < int(width)) {
        float sum = weights[0] * row[local + 2];
        for (int k = 1; k <= 2; k++) {
            sum += weights[k] * (row[local + 2 - k] + row[local + 2 + k]);
        }
        blurred[gl_WorkGroupID.y * width + uint(x)] = sum;
    }
}
