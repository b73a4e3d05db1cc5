#version 450
// Each row is shifted and scaled to mean 0 and variance 1, then scaled and shifted as learned. A workgroup has a row.
layout(local_size_x = 32) in;
layout(std430, binding = 0) readonly buffer Values { float values[]; };
layout(std430, binding = 1) readonly buffer Gain { float gain[]; };
layout(std430, binding = 2) readonly buffer Bias { float bias[]; };
layout(std430, binding = 3) writeonly buffer Normed { float normed[]; };

const float epsilon = 1e-3;

shared float part[32];

float sumOfGroup(float own) {
    uint local = gl_LocalInvocationIndex;
    part[local] = own;
    barrier();
    for (uint width = 16u; width > 0u; width >>= 1) {
        if (local < width) {
            part[local] += part[local + width];
        }
        barrier();
    }
    float sum = part[0];
    // Without it Mesa 22.3 gives other numbers on OpenGL, as if it read behind the barrier.
    memoryBarrierShared();
    barrier();
    return sum;
}

void main() {
    uint columns = uint(gain.length());
    uint row = gl_WorkGroupID.x * columns;
    float own = 0.0;
    for (uint k = gl_LocalInvocationIndex; k < columns; k += 32u) {
        own += values[row + k];
    }
    float mean = sumOfGroup(own) / float(columns);
    own = 0.0;
    for (uint k = gl_LocalInvocationIndex; k < columns; k += 32u) {
        float away = values[row + k] - mean;
        own += away * away;
    }
    float scale = inversesqrt(sumOfGroup(own) / float(columns) + epsilon);
    for (uint k = gl_LocalInvocationIndex; k < columns; k += 32u) {
        normed[row + k] = (values[row + k] - mean) * scale * gain[k] + bias[k];
    }
}
