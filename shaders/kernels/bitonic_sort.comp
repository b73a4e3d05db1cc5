#version 450
// Up to 64 keys in ascending order, by a bitonic network in one workgroup. Places behind the keys hold the largest number.
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Keys { uint keys[]; };

shared uint own[64];

void main() {
    uint i = gl_LocalInvocationIndex;
    uint count = uint(keys.length());
    own[i] = i < count ? keys[i] : 0xffffffffu;
    barrier();
    for (uint run = 2u; run <= 64u; run <<= 1) {
        for (uint away = run >> 1; away > 0u; away >>= 1) {
            uint other = i ^ away;
            if (other > i) {
                bool rising = (i & run) == 0u;
                uint a = own[i];
                uint b = own[other];
                if ((a > b) == rising) {
                    own[i] = b;
                    own[other] = a;
                }
            }
            barrier();
        }
    }
    if (i < count) {
        keys[i] = own[i];
    }
}
