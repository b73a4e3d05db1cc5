// One pass of a separable blur: the rows of an image, which end as their last pixels go on. A workgroup has 32 pixels of
// a row, and two more on either side.
@group(0) @binding(0) var<uniform> width: u32;
@group(0) @binding(1) var<storage, read> source: array<f32>;
@group(0) @binding(2) var<storage, read_write> blurred: array<f32>;

var<workgroup> row: array<f32, 36>;

fn pixel(x: i32, y: u32) -> f32 {
    return source[y * width + u32(clamp(x, 0, i32(width) - 1))];
}

@compute @workgroup_size(32)
fn main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    let x = i32(id.x);
    row[local + 2u] = pixel(x, group.y);
    if (local < 2u) {
        row[local] = pixel(x - 2, group.y);
        row[local + 34u] = pixel(x + 32, group.y);
    }
    workgroupBarrier();
    if (id.x < width) {
        blurred[group.y * width + id.x] = 0.375 * row[local + 2u]
            + 0.25 * (row[local + 1u] + row[local + 3u])
            + 0.0625 * (row[local] + row[local + 4u]);
    }
}
