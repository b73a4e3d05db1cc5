// The sum of all numbers: each invocation adds up every 64th, then a tree adds up what they have.
@group(0) @binding(0) var<storage, read> values: array<f32>;
@group(0) @binding(1) var<storage, read_write> total: array<f32, 1>;

var<workgroup> part: array<f32, 64>;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) local: u32) {
    var own = 0.0;
    for (var k = local; k < arrayLength(&values); k += 64u) {
        own += values[k];
    }
    part[local] = own;
    workgroupBarrier();
    for (var width = 32u; width > 0u; width >>= 1u) {
        if (local < width) {
            part[local] += part[local + width];
        }
        workgroupBarrier();
    }
    if (local == 0u) {
        total[0] = part[0];
    }
}
