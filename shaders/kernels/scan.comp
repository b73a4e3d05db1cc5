#version 450
// Inclusive prefix sums: blocks of 64 one after the other, each by doubling distances, with what came before carried on.
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Values { uint values[]; };
layout(std430, binding = 1) writeonly buffer Sums { uint sums[]; };

shared uint part[64];

void main() {
    uint local = gl_LocalInvocationIndex;
    uint count = uint(values.length());
    uint carried = 0u;
    for (uint first = 0u; first < count; first += 64u) {
        uint i = first + local;
        part[local] = i < count ? values[i] : 0u;
        barrier();
        for (uint by = 1u; by < 64u; by <<= 1) {
            uint before = local >= by ? part[local - by] : 0u;
            barrier();
            part[local] += before;
            barrier();
        }
        if (i < count) {
            sums[i] = carried + part[local];
        }
        carried += part[63];
        barrier();
    }
}
