@group(0) @binding(0) var<storage, read_write> o: i32;
@compute @workgroup_size(1)
fn main() {
    o = countTrailingZeros(o);
}
