//! Storage blocks, atomic counters, and textures and images that are buffers.

use program::{Language, Program};

use super::{built, expect};

#[test]
fn what_a_storage_block_holds_goes_in_and_comes_out() {
    let text = "#version 430
      layout(local_size_x = 1) in;
      struct P { vec3 at; float w; };
      layout(std430) buffer A { int n; P list[]; };
      layout(std430) readonly buffer B { vec3 k; bool flag; } b;
      void main() {
        int old = atomicAdd(n, 5);
        list[1].at += b.k;
        list[old - 5].w = float(list.length()) + float(old);
        int was = atomicCompSwap(n, 12, 20);
        if (b.flag) list[3].w = float(was + n);
        atomicCompSwap(n, 12, 50);
      }";
    let list = |k: f64| vec![k, k, k, 10.0 * k];
    let inputs = [vec![7.0], list(0.0), list(1.0), list(2.0), list(3.0), vec![1.0, 2.0, 3.0, 1.0]].concat();
    // n is 7 and becomes 12; the first exchange finds 12 and writes 20, the second finds 20.
    let after =
        [vec![20.0], list(0.0), vec![2.0, 3.0, 4.0, 10.0], vec![2.0, 2.0, 2.0, 11.0], vec![3.0, 3.0, 3.0, 32.0]];
    expect("t.comp", text, &inputs, &[], &after.concat());
    let program = built("t.comp", text).unwrap();
    assert!(program.check_fed().is_err() && program.inputs.is_empty());
    let program = program.with_memory_inside().unwrap();
    let names: Vec<&str> = program.outputs.iter().map(|p| p.field.name.as_str()).collect();
    assert_eq!(names[..3], ["n", "list[0].at", "list[0].w"]);
    assert!(program.compute_kernel().is_ok());
}

#[test]
fn invocations_that_need_each_other_are_not_run_alone() {
    for text in [
        "#version 430\nlayout(local_size_x = 2) in; buffer A { int n; }; void main() { n = 1; barrier(); }",
        "#version 430\nlayout(local_size_x = 2) in; shared int s; buffer A { int n; }; void main() { s = 1; n = s; }",
    ] {
        let program = built("t.comp", text).and_then(Program::with_memory_inside).unwrap();
        assert!(program.compute_kernel().is_err());
    }
}

#[test]
fn counters_count() {
    let text = "#version 420
      layout(binding = 0, offset = 0) uniform atomic_uint c; layout(binding = 0, offset = 4) uniform atomic_uint d[2];
      out vec4 r; uint up(atomic_uint k) { return atomicCounterIncrement(k); }
      void main() { uint a = up(c); uint b = up(d[1]); uint e = atomicCounterDecrement(d[1]); e += atomicCounterDecrement(d[1]);
        r = vec4(a, b, e, atomicCounter(c)); gl_Position = vec4(1.0); }";
    // The increment gives the value before, the decrement the one behind: 10, then 9.
    expect("t.vert", text, &[3.0, 10.0], &[], &[1.0, 1.0, 1.0, 1.0, 3.0, 10.0, 19.0, 4.0, 4.0, 9.0]);
}

#[test]
fn a_texture_that_is_a_buffer() {
    let text = "#version 330\nuniform isamplerBuffer b; in float x; out vec4 r;
      void main() { r = vec4(texelFetch(b, int(x)) + textureSize(b)); gl_Position = vec4(0.0); }";
    let inputs: Vec<f64> = std::iter::once(2.0).chain((1..=16).map(f64::from)).collect();
    expect("t.vert", text, &inputs, &[], &[0.0, 0.0, 0.0, 0.0, 13.0, 14.0, 15.0, 16.0]);
}

#[test]
fn an_image_that_is_a_buffer() {
    let text = "#version 430\nlayout(local_size_x = 1) in; layout(r32ui) uniform uimageBuffer b;
      void main() { uint old = imageAtomicAdd(b, 1, 5u); imageStore(b, 0, uvec4(old, 9, 9, 9));
        imageStore(b, 3, imageLoad(b, 1) + uint(imageSize(b))); imageStore(b, 7, uvec4(99)); imageStore(b, 2, imageLoad(b, -1)); }";
    // Outside nothing is written, and zero is read.
    expect("t.comp", text, &[10.0, 20.0, 30.0, 40.0], &[], &[20.0, 25.0, 0.0, 29.0]);
    let text = "#version 430\nlayout(local_size_x = 1) in; layout(rgba8) uniform imageBuffer b;
      void main() { imageStore(b, 1, imageLoad(b, 0).wzyx); }";
    let packed = |v: [u32; 4]| f64::from(v[0] | v[1] << 8 | v[2] << 16 | v[3] << 24);
    let (a, b) = (packed([1, 2, 3, 255]), packed([255, 3, 2, 1]));
    expect("t.comp", text, &[a, 0.0, 0.0, 0.0], &[], &[a, b, 0.0, 0.0]);
}

#[test]
fn an_image_with_atomic_texels_lies_behind_its_size() {
    let text = "#version 430\nlayout(r32ui) uniform uimage2D h; out vec4 c;
      void main() { uint before = imageAtomicExchange(h, ivec2(1, 1), 7u); imageAtomicAdd(h, ivec2(0, 0), 10u);
        c = vec4(before, imageLoad(h, ivec2(0, 1)).x, imageLoad(h, ivec2(2, 0)).x, imageSize(h).x); }";
    // Width 2 and height 2; the texel at (2, 0) is none, and no texel of the next row.
    let inputs = [2.0, 2.0, 1.0, 1.0, 1.0, 2.0, 3.0, 4.0];
    expect("t.frag", text, &inputs, &[], &[4.0, 3.0, 0.0, 2.0, 2.0, 2.0, 1.0, 1.0, 11.0, 2.0, 3.0, 7.0]);
    let wgsl = built("t.frag", text).unwrap().translate(Language::Wgsl).unwrap().into_bytes();
    assert!(String::from_utf8(wgsl).unwrap().contains("atomicExchange("));
    let text = "#version 450\nlayout(r32f) uniform image3D h; out vec4 c;
      void main() { c = vec4(imageAtomicExchange(h, ivec3(0, 0, 1), 2.5)) + imageLoad(h, ivec3(0, 0, 1)); }";
    let bits = |x: f32| f64::from(x.to_bits());
    let inputs = [1.0, 1.0, 4.0, 1.0, 0.0, bits(0.5), 0.0, 0.0];
    expect("t.frag", text, &inputs, &[], &[3.0, 0.5, 0.5, 1.5, 1.0, 1.0, 4.0, 1.0, 0.0, bits(2.5), 0.0, 0.0]);
}

#[test]
fn a_cube_that_is_written() {
    let text = "#version 430\nlayout(local_size_x = 1) in; layout(rgba32f) uniform imageCube h;
      void main() { imageStore(h, ivec3(0, 0, 2), vec4(imageSize(h), 5.0, 6.0)); }";
    let mut inputs = vec![1.0, 1.0, 6.0, 1.0];
    inputs.extend([0.0; 16]);
    let mut after = inputs.clone();
    after[12..16].copy_from_slice(&[1.0, 1.0, 5.0, 6.0]);
    expect("t.comp", text, &inputs, &[], &after);
}

#[test]
fn storage_blocks_in_an_array_are_bound_one_by_one() {
    let text = "#version 450\nlayout(std430) buffer B { vec4 v[]; } all[2]; out vec4 c;
      void main() { c = all[1].v[2] + float(all[0].v.length()); all[0].v[0] = c; }";
    let program = built("t.frag", text).unwrap();
    let spirv = program.translate(Language::SpirV).unwrap().into_bytes();
    assert!(!spirv.is_empty() && program.with_memory_inside().unwrap().compute_kernel().is_err());
}

#[test]
fn structures_of_memory_are_values_of_functions() {
    let text = "#version 450\nlayout(local_size_x = 1) in; struct P { vec3 at; float w; };
      layout(std430) buffer A { P one; P list[]; }; float sum(P p) { return p.at.x + p.w; }
      void main() { P p = list[1]; p.w = sum(one); list[0] = p; }";
    let inputs: Vec<f64> = (1..=20).map(f64::from).collect();
    let mut after = inputs.clone();
    // list[1] is (9, 10, 11, 12); 1 + 4.
    after[4..8].copy_from_slice(&[9.0, 10.0, 11.0, 5.0]);
    expect("t.comp", text, &inputs, &[], &after);
    // What looks behind the elements that there are here stays as it is.
    let text = "#version 450\nlayout(local_size_x = 1) in; layout(std430) buffer A { int list[]; }; void main() { list[9] = 1; }";
    assert!(built("t.comp", text).unwrap().with_memory_inside().unwrap().check_fed().is_err());
}
