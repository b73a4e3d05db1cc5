#version 450
// Blended vertices: the matrices are blended first.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };
layout(std430, binding = 1) readonly buffer Joints { uvec4 joints[]; };
layout(std430, binding = 2) readonly buffer Weights { vec4 weights[]; };
layout(std430, binding = 3) readonly buffer Blends { mat4 blends[4]; };
layout(std430, binding = 4) writeonly buffer Skinned { vec4 skinned[]; };

void main() {
    for (int i = 0; i < positions.length(); i++) {
        mat4 blend = blends[joints[i].x] * weights[i].x;
        blend += blends[joints[i].y] * weights[i].y;
        blend += blends[joints[i].z] * weights[i].z;
        blend += blends[joints[i].w] * weights[i].w;
        skinned[i] = blend * positions[i];
    }
}
