#version 450
// How often each of 16 values occurs, added to what the bins hold.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 1) buffer Bins { uint bins[16]; };

void main() {
    for (int k = 0; k < keys.length(); k++) {
        bins[keys[k] & 15u] += 1u;
    }
}
