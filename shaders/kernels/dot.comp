#version 450
// The dot product of two long vectors.
layout(local_size_x = 32) in;
layout(std430, binding = 0) readonly buffer A { float a[]; };
layout(std430, binding = 1) readonly buffer B { float b[]; };
layout(std430, binding = 2) writeonly buffer Product { float product[1]; };

shared float part[32];

void main() {
    uint local = gl_LocalInvocationIndex;
    float own = 0.0;
    for (uint k = local; k < uint(a.length()); k += 32u) {
        own += a[k] * b[k];
    }
    part[local] = own;
    barrier();
    for (uint width = 16u; width > 0u; width >>= 1) {
        if (local < width) {
            part[local] += part[local + width];
        }
        barrier();
    }
    if (local == 0u) {
        product[0] = part[0];
    }
}
