#version 450
// The sum of all numbers: each invocation adds up every 64th, then a tree adds up what they have.
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Values { float values[]; };
layout(std430, binding = 1) writeonly buffer Total { float total[1]; };

shared float part[64];

void main() {
    uint local = gl_LocalInvocationIndex;
    float own = 0.0;
    for (uint k = local; k < uint(values.length()); k += 64u) {
        own += values[k];
    }
    part[local] = own;
    barrier();
    for (uint width = 32u; width > 0u; width >>= 1) {
        if (local < width) {
            part[local] += part[local + width];
        }
        barrier();
    }
    if (local == 0u) {
        total[0] = part[0];
    }
}
