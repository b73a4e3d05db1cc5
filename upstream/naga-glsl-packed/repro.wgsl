@group(0) @binding(0) var<storage, read_write> o: u32;
@compute @workgroup_size(1)
fn main() { o = pack4xU8Clamp(vec4<u32>(o)) / 5u; }
