// Blended vertices into a buffer, for passes that draw them more than once: the chapter's blending with weights that are
// given.
@group(0) @binding(0) var<storage, read> positions: array<vec4f>;
@group(0) @binding(1) var<storage, read> joints: array<vec4u>;
@group(0) @binding(2) var<storage, read> weights: array<vec4f>;
@group(0) @binding(3) var<storage, read> blends: array<mat4x4f, 4>;
@group(0) @binding(4) var<storage, read_write> skinned: array<vec4f>;

@compute @workgroup_size(16)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if (i >= arrayLength(&positions)) {
        return;
    }
    var sum = vec4f(0.0);
    for (var k = 0; k < 4; k++) {
        sum += weights[i][k] * (blends[joints[i][k]] * positions[i]);
    }
    skinned[i] = sum;
}
