// Each row is shifted and scaled to mean 0 and variance 1, then scaled and shifted as learned. A workgroup has a row.
@group(0) @binding(0) var<storage, read> values: array<f32>;
@group(0) @binding(1) var<storage, read> gain: array<f32>;
@group(0) @binding(2) var<storage, read> bias: array<f32>;
@group(0) @binding(3) var<storage, read_write> normed: array<f32>;

const epsilon = 1e-3;

var<workgroup> part: array<f32, 32>;

fn sum_of_group(own: f32, local: u32) -> f32 {
    part[local] = own;
    workgroupBarrier();
    for (var width = 16u; width > 0u; width >>= 1u) {
        if (local < width) {
            part[local] += part[local + width];
        }
        workgroupBarrier();
    }
    let sum = part[0];
    workgroupBarrier();
    return sum;
}

@compute @workgroup_size(32)
fn main(@builtin(local_invocation_index) local: u32, @builtin(workgroup_id) group: vec3u) {
    let columns = arrayLength(&gain);
    let row = group.x * columns;
    var own = 0.0;
    for (var k = local; k < columns; k += 32u) {
        own += values[row + k];
    }
    let mean = sum_of_group(own, local) / f32(columns);
    own = 0.0;
    for (var k = local; k < columns; k += 32u) {
        let away = values[row + k] - mean;
        own += away * away;
    }
    let scale = inverseSqrt(sum_of_group(own, local) / f32(columns) + epsilon);
    for (var k = local; k < columns; k += 32u) {
        normed[row + k] = (values[row + k] - mean) * scale * gain[k] + bias[k];
    }
}
