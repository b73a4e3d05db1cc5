//! Whole dispatches as one program, against values derived without it.

use super::super::{Binary32, Binary64, FUEL, HazardKind, compile};
use crate::{Chosen, Dispatch, Form, ModuleText, Program, Written};
use base::text::SourceFile;
use base::value::Batch;
use std::sync::Arc;

fn dispatched(text: &str, groups: [u32; 3], lengths: &[(&str, u32)]) -> Program {
    let file = SourceFile::new("a.wgsl", text.to_owned());
    let module = ModuleText::read(&file, Written::Wgsl).unwrap();
    let program = module.program(Chosen::Point { stage: Some(syntax::Stage::Compute), name: None }, &[]).unwrap();
    let lengths = lengths.iter().map(|&(name, len)| (name.to_owned(), len)).collect();
    program.dispatched(&Dispatch { groups, lengths }).unwrap()
}

fn batch(program: &Program, words: Vec<u32>) -> Batch {
    let (invocation, case) = (Arc::new(program.invocation_record()), Arc::new(program.case_record()));
    let count = words.len() / invocation.words();
    Batch { invocation_record: invocation, case_record: case, per_case: count, invocations: words, cases: Vec::new() }
}

const SUM: &str = "
    @group(0) @binding(0) var<storage, read> data: array<f32>;
    @group(0) @binding(1) var<storage, read_write> sums: array<f32>;
    var<workgroup> part: array<f32, 8>;
    @compute @workgroup_size(8)
    fn main(@builtin(local_invocation_index) i: u32, @builtin(workgroup_id) group: vec3u) {
        let at = group.x * 8 + i;
        if at < arrayLength(&data) { part[i] = data[at]; } else { part[i] = 0.0; }
        workgroupBarrier();
        for (var s = 4u; s > 0; s /= 2) {
            if i < s { part[i] += part[i + s]; }
            BARRIER
        }
        if i != 0 { return; }
        sums[group.x] = part[0];
    }";

#[test]
fn workgroups_add_up_what_they_share() {
    let program = dispatched(&SUM.replace("BARRIER", "workgroupBarrier();"), [2, 1, 1], &[("data", 13), ("sums", 2)]);
    let names: Vec<&str> = program.inputs.iter().map(|p| &p.field.name[..]).collect();
    assert_eq!(names, ["data", "sums"]);
    let mut words: Vec<u32> = (1..=13).map(|k| (k as f32).to_bits()).collect();
    words.extend([0, 0]);
    let meaning = compile(&program).unwrap().run::<Binary64>(&batch(&program, words), FUEL).unwrap();
    assert_eq!(meaning.vertex(0, 0), [36.0, 55.0]);
    assert!(!meaning.flags(0).is_undefined());
}

#[test]
fn what_lies_behind_a_barrier_sees_all_that_lies_before() {
    let text = "
        @group(0) @binding(0) var<storage, read_write> data: array<i32>;
        var<workgroup> turned: array<i32, 4>;
        fn swap(i: u32, x: i32) -> i32 { turned[3 - i] = x; workgroupBarrier(); return turned[i] * 10; }
        @compute @workgroup_size(4)
        fn main(@builtin(global_invocation_id) at: vec3u, @builtin(local_invocation_id) local: vec3u) {
            let own = data[at.x];
            let other = swap(local.x, own);
            data[at.x] = other + own;
        }";
    let program = dispatched(text, [2, 1, 1], &[("data", 8)]);
    let words = (1..=8).collect();
    let meaning = compile(&program).unwrap().run::<Binary64>(&batch(&program, words), FUEL).unwrap();
    assert_eq!(meaning.vertex(0, 0), [41.0, 32.0, 23.0, 14.0, 85.0, 76.0, 67.0, 58.0]);
}

#[test]
fn atomic_functions_and_members_of_structures_are_fed_and_read() {
    let text = "
        struct Items { count: atomic<u32>, scale: f32, items: array<vec3f> }
        @group(0) @binding(0) var<storage, read_write> all: Items;
        @compute @workgroup_size(4)
        fn main(@builtin(global_invocation_id) at: vec3u) {
            if at.x >= arrayLength(&all.items) { return; }
            atomicAdd(&all.count, 2u);
            all.items[at.x] *= all.scale;
        }";
    let program = dispatched(text, [1, 1, 1], &[("all", 3)]);
    let mut words = vec![5, 2.0_f32.to_bits()];
    words.extend((1..=9).map(|k| (k as f32).to_bits()));
    let meaning = compile(&program).unwrap().run::<Binary64>(&batch(&program, words), FUEL).unwrap();
    assert_eq!(meaning.vertex(0, 0), [11.0, 2.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0]);
    let Form::Dispatch { buffers, .. } = program.compute_kernel().unwrap().form else { panic!("a dispatch") };
    let places: Vec<u32> = buffers[0].before.iter().map(|place| place.byte).collect();
    assert_eq!(places, [0, 4, 16, 20, 24, 32, 36, 40, 48, 52, 56]);
    assert_eq!((buffers[0].bytes, &buffers[0].after), (64, &buffers[0].before));
}

#[test]
fn invocations_that_do_not_come_to_a_barrier_together_are_told() {
    let text = |condition: &str| {
        format!(
            "@group(0) @binding(0) var<storage, read_write> data: array<u32>;
            var<workgroup> n: u32;
            @compute @workgroup_size(2)
            fn main(@builtin(local_invocation_index) i: u32) {{
                let first = data[0];
                if {condition} {{ workgroupBarrier(); n = 1; }}
                data[i] = n;
            }}"
        )
    };
    for (condition, expected) in [("i == first", true), ("first == 1", false)] {
        // The reader of WGSL leaves it to devices to refuse what is not uniform.
        let program = dispatched(&text(condition), [1, 1, 1], &[("data", 2)]);
        let meaning = compile(&program).unwrap().run::<Binary64>(&batch(&program, vec![1, 0]), FUEL).unwrap();
        assert_eq!(meaning.flags(0).has(HazardKind::Divergence), expected, "{condition}");
    }
}

#[test]
fn a_dispatch_that_does_not_fit_is_refused() {
    let file = SourceFile::new("a.wgsl", SUM.replace("BARRIER", "").clone());
    let module = ModuleText::read(&file, Written::Wgsl).unwrap();
    let program = module.program(Chosen::Point { stage: Some(syntax::Stage::Compute), name: None }, &[]).unwrap();
    let refused = |groups, lengths: &[(&str, u32)]| {
        let lengths = lengths.iter().map(|&(name, len)| (name.to_owned(), len)).collect();
        program.clone().dispatched(&Dispatch { groups, lengths }).unwrap_err().to_string()
    };
    assert!(refused([1, 1, 1], &[("data", 8)]).contains("the buffer `sums` without a length"));
    assert!(refused([0, 1, 1], &[("data", 8), ("sums", 1)]).contains("without workgroups"));
    assert!(refused([1, 1, 1], &[("data", 0), ("sums", 1)]).contains("`data` without an element"));
    let unknown = refused([1, 1, 1], &[("data", 8), ("sums", 1), ("dta", 1)]);
    assert!(unknown.contains("`dta`") && unknown.contains("these are: data, sums"), "{unknown}");
}

/// 2048 + 1 is no number of binary16, nor is 65504 · 2: a device rounds, and meaning does not.
#[test]
fn numbers_of_binary16_are_rounded_and_mean_real_ones() {
    let text = "enable f16;
        struct Mixed { scale: f32, halves: vec3<f16>, count: u32 }
        @group(0) @binding(0) var<storage, read> data: array<f16>;
        @group(0) @binding(1) var<storage, read> mixed: array<Mixed, 2>;
        @group(0) @binding(2) var<storage, read_write> out: array<f16>;
        @compute @workgroup_size(1)
        fn main() {
            out[0] = data[0] + data[1];
            out[1] = data[2] * 2.0h;
            out[2] = f16(mixed[1].scale) + mixed[1].halves.z;
            out[3] = f16(f32(data[0]) + f32(data[1]));
        }";
    let program = dispatched(text, [1, 1, 1], &[("data", 3), ("out", 4)]);
    let numbers = [2048.0_f32, 1.0, 65504.0];
    let mut words: Vec<u32> = numbers.map(f32::to_bits).to_vec();
    // Two structures with a number, three of binary16 and a count, then what is written.
    for scale in [1.0_f32, 3.0] {
        words.extend([scale, 0.25, 0.5, 0.75].map(f32::to_bits));
        words.push(7);
    }
    words.extend([0; 4]);
    let batch = batch(&program, words);
    let executable = compile(&program).unwrap();
    let strict = executable.run::<Binary32>(&batch, FUEL).unwrap();
    let real = executable.run::<Binary64>(&batch, FUEL).unwrap();
    let strict: Vec<f32> = strict.vertex(0, 0).iter().map(|&bits| f32::from_bits(bits)).collect();
    assert_eq!(strict, [2048.0, f32::INFINITY, 3.75, 2048.0]);
    assert_eq!(real.vertex(0, 0), [2049.0, 131_008.0, 3.75, 2049.0]);
}

/// Buffers of binary16 have places of two bytes.
#[test]
fn places_of_binary16_are_two_bytes() {
    let text = "enable f16;
        @group(0) @binding(0) var<storage, read_write> data: array<vec3<f16>>;
        @compute @workgroup_size(1) fn main() { data[1].z = 1.0h; }";
    let program = dispatched(text, [1, 1, 1], &[("data", 2)]);
    let Form::Dispatch { buffers, .. } = program.compute_kernel().unwrap().form else { panic!("a dispatch") };
    let bytes: Vec<u32> = buffers[0].before.iter().map(|place| place.byte).collect();
    assert_eq!(bytes, [0, 2, 4, 8, 10, 12]);
}
