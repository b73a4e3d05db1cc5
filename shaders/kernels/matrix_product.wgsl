// The product of two matrices, by tiles: row by row, a has `inner` columns and b has `columns`.
struct Shape {
    rows: u32,
    inner: u32,
    columns: u32,
}

@group(0) @binding(0) var<uniform> shape: Shape;
@group(0) @binding(1) var<storage, read> a: array<f32>;
@group(0) @binding(2) var<storage, read> b: array<f32>;
@group(0) @binding(3) var<storage, read_write> c: array<f32>;

var<workgroup> tile_a: array<array<f32, 8>, 8>;
var<workgroup> tile_b: array<array<f32, 8>, 8>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let row = id.y;
    let column = id.x;
    var sum = 0.0;
    for (var k = 0u; k < shape.inner; k += 8u) {
        let across = k + local.x;
        let down = k + local.y;
        var of_a = 0.0;
        if (row < shape.rows && across < shape.inner) {
            of_a = a[row * shape.inner + across];
        }
        var of_b = 0.0;
        if (down < shape.inner && column < shape.columns) {
            of_b = b[down * shape.columns + column];
        }
        tile_a[local.y][local.x] = of_a;
        tile_b[local.y][local.x] = of_b;
        workgroupBarrier();
        for (var i = 0u; i < 8u; i++) {
            sum += tile_a[local.y][i] * tile_b[i][local.x];
        }
        workgroupBarrier();
    }
    if (row < shape.rows && column < shape.columns) {
        c[row * shape.columns + column] = sum;
    }
}
