#version 450
// Blended vertices into a buffer, for passes that draw them more than once: the chapter's blending with weights that are
// given.
layout(local_size_x = 16) in;
layout(std430, binding = 0) readonly buffer Positions { vec4 positions[]; };
layout(std430, binding = 1) readonly buffer Joints { uvec4 joints[]; };
layout(std430, binding = 2) readonly buffer Weights { vec4 weights[]; };
layout(std430, binding = 3) readonly buffer Blends { mat4 blends[4]; };
layout(std430, binding = 4) writeonly buffer Skinned { vec4 skinned[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(positions.length())) {
        return;
    }
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        sum += weights[i][k] * (blends[joints[i][k]] * positions[i]);
    }
    skinned[i] = sum;
}
