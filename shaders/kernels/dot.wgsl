// The dot product of two long vectors.
@group(0) @binding(0) var<storage, read> a: array<f32>;
@group(0) @binding(1) var<storage, read> b: array<f32>;
@group(0) @binding(2) var<storage, read_write> product: array<f32, 1>;

var<workgroup> part: array<f32, 32>;

@compute @workgroup_size(32)
fn main(@builtin(local_invocation_index) local: u32) {
    var own = 0.0;
    for (var k = local; k < arrayLength(&a); k += 32u) {
        own += a[k] * b[k];
    }
    part[local] = own;
    workgroupBarrier();
    for (var width = 16u; width > 0u; width >>= 1u) {
        if (local < width) {
            part[local] += part[local + width];
        }
        workgroupBarrier();
    }
    if (local == 0u) {
        product[0] = part[0];
    }
}
