// exp(x) of each number of a row, divided by the sum of them. The largest of the row is taken out, so that nothing
// overflows. A workgroup has a row.
@group(0) @binding(0) var<storage, read> values: array<f32>;
@group(0) @binding(1) var<storage, read_write> shares: array<f32>;

var<workgroup> part: array<f32, 32>;

@compute @workgroup_size(32)
fn main(
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
) {
    let columns = arrayLength(&values) / groups.x;
    let row = group.x * columns;

    var largest = -3.4e38;
    for (var k = local; k < columns; k += 32u) {
        largest = max(largest, values[row + k]);
    }
    part[local] = largest;
    workgroupBarrier();
    for (var width = 16u; width > 0u; width >>= 1u) {
        if (local < width) {
            part[local] = max(part[local], part[local + width]);
        }
        workgroupBarrier();
    }
    largest = part[0];
    workgroupBarrier();

    var sum = 0.0;
    for (var k = local; k < columns; k += 32u) {
        sum += exp(values[row + k] - largest);
    }
    part[local] = sum;
    workgroupBarrier();
    for (var width = 16u; width > 0u; width >>= 1u) {
        if (local < width) {
            part[local] += part[local + width];
        }
        workgroupBarrier();
    }
    for (var k = local; k < columns; k += 32u) {
        shares[row + k] = exp(values[row + k] - largest) / part[0];
    }
}
