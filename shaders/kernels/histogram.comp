#version 450
// How often each of 16 values occurs: counted for each workgroup first, then added to what the bins hold.
layout(local_size_x = 32) in;
layout(std430, binding = 0) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 1) buffer Bins { uint bins[16]; };

shared uint counts[16];

void main() {
    uint local = gl_LocalInvocationIndex;
    if (local < 16u) {
        counts[local] = 0u;
    }
    barrier();
    uint i = gl_GlobalInvocationID.x;
    if (i < uint(keys.length())) {
        atomicAdd(counts[keys[i] & 15u], 1u);
    }
    barrier();
    if (local < 16u) {
        atomicAdd(bins[local], counts[local]);
    }
}
