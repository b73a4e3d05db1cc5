@group(0) @binding(0) var<storage, read_write> o: f32;
fn put(p: ptr<function, f32>) { *p += 1.0; }
@compute @workgroup_size(1)
fn main() {
    var a: array<f32, 2>;
    put(&a[0]);
    o = a[0];
}
