//! Faults of dispatches, each beside a program without it.

use super::super::tests::kernel;
use super::{Access, Buffer, Dispatch, Outcome, Turn, Turns, Wrong};

/// Runs the only entry point of a text with one buffer of so many words, in two workgroups.
fn run(text: &str, words: u32, zeroed: bool) -> Outcome {
    run_in(text, words, zeroed, super::WIDTH)
}

/// The same with so many invocations in a subgroup.
fn run_in(text: &str, words: u32, zeroed: bool, subgroup: u32) -> Outcome {
    run_with(text, words, zeroed, |dispatch| dispatch.subgroup = subgroup)
}

/// The same with further choices.
fn run_with(text: &str, words: u32, zeroed: bool, choose: impl FnOnce(&mut Dispatch<'_>)) -> Outcome {
    let (executable, size) = kernel(text);
    let buffer = |shape: &super::MemoryShape| {
        let elements = if shape.array.is_some() { words } else { 0 };
        Buffer { words: (0..shape.words_with(elements) as u32).collect(), elements, sides: [0; 3] }
    };
    let buffers: Vec<Buffer> = executable.memories().iter().map(buffer).collect();
    let mut dispatch = Dispatch {
        size,
        groups: [2, 1, 1],
        buffers: &buffers,
        zeroed,
        outside: 0,
        fuel: 1000,
        work: 100_000,
        watched: true,
        order: 0,
        turns: Turns::default(),
        subgroup: super::WIDTH,
    };
    choose(&mut dispatch);
    executable.dispatch::<f32>(&dispatch)
}

const HEAD: &str = "@group(0) @binding(0) var<storage, read_write> a: array<u32>;
    @group(0) @binding(1) var<storage, read_write> n: atomic<u32>;
    @group(0) @binding(2) var<storage, read_write> r: array<f32>;
    var<workgroup> w: array<u32, 200>;
    var<workgroup> v: atomic<u32>;
    @compute @workgroup_size(200) fn main(
        @builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) l: u32,
        @builtin(workgroup_id) g: vec3u) ";

fn found(body: &str, zeroed: bool) -> Vec<Wrong> {
    let outcome = run(&format!("{HEAD}{{ {body} }}"), 400, zeroed);
    assert!(outcome.whole);
    outcome.incidents.iter().map(|incident| incident.what).collect()
}

#[test]
fn each_fault_is_found_and_its_twin_is_silent() {
    for (what, wrong, right) in [
        (Wrong::Race, "w[l] = l; a[id.x] = w[199u - l];", "w[l] = l; workgroupBarrier(); a[id.x] = w[199u - l];"),
        // The second of two chunks of slots meets the first.
        (
            Wrong::Race,
            "if (l == 0u) { w[0] = 7u; } a[id.x] = w[0];",
            "if (l == 0u) { w[0] = 7u; } workgroupBarrier(); a[id.x] = w[0];",
        ),
        (
            Wrong::Unordered,
            "w[l] = l; storageBarrier(); a[id.x] = w[199u - l];",
            "w[l] = l; storageBarrier(); workgroupBarrier(); a[id.x] = w[199u - l];",
        ),
        (
            Wrong::Unordered,
            "a[id.x] = l; workgroupBarrier(); w[l] = a[g.x * 200u + 199u - l];",
            "a[id.x] = l; workgroupBarrier(); storageBarrier(); w[l] = a[g.x * 200u + 199u - l];",
        ),
        (Wrong::Race, "a[l / 2u] = l;", "a[id.x] = l;"),
        (Wrong::Race, "a[0] = a[0] + 1u;", "atomicAdd(&n, 1u);"),
        // A store undoes what another invocation added; one that only looks, or comes behind a barrier, is in nobody's way.
        (
            Wrong::Race,
            "if (l == 0u) { atomicStore(&v, 0u); } atomicOr(&v, 1u << (l & 31u));",
            "if (l == 0u) { atomicStore(&v, 0u); } workgroupBarrier(); atomicOr(&v, 1u << (l & 31u));",
        ),
        (
            Wrong::Race,
            "atomicAdd(&v, 1u); if (l == 0u) { atomicStore(&v, 0u); }",
            "if (l == 0u) { atomicStore(&v, 0u); } atomicMax(&v, 0u);",
        ),
        // Between a load and the store of what comes of it, others store.
        (
            Wrong::LostUpdate,
            "atomicAdd(&v, 0u); workgroupBarrier(); atomicStore(&v, atomicLoad(&v) + 1u);",
            "if (l == 0u) { atomicStore(&v, 0u); atomicStore(&v, atomicLoad(&v) + 1u); }",
        ),
        (
            Wrong::LostUpdate,
            "if (l == 7u) { atomicStore(&n, atomicLoad(&n) + 1u); }",
            "if (id.x == 7u) { atomicStore(&n, atomicLoad(&n) + 1u); }",
        ),
        (Wrong::SameValue, "a[0] = 5u;", "if (id.x == 0u) { a[0] = 5u; }"),
        (Wrong::Outside, "a[id.x + 1u] = 1u;", "a[id.x] = 1u;"),
        (Wrong::Outside, "w[l + 1u] = 1u;", "if (l < 199u) { w[l + 1u] = 1u; }"),
        (Wrong::Outside, "a[arrayLength(&a) - 1u - id.x - 1u] = 1u;", "a[arrayLength(&a) - 1u - id.x] = 1u;"),
        (
            Wrong::Divergence,
            "if (l > 3u) { return; } workgroupBarrier();",
            "if (g.x > 3u) { return; } workgroupBarrier();",
        ),
        (
            Wrong::Divergence,
            "for (var i = 0u; i < l; i++) { workgroupBarrier(); }",
            "for (var i = l; i < l + 3u; i++) { workgroupBarrier(); }",
        ),
        (Wrong::Unwritten, "a[id.x] = w[l];", "w[l] = 1u; a[id.x] = w[l];"),
        // 0.0 / 0.0 for one invocation.
        (Wrong::NotANumber, "let x = f32(l); r[id.x] = x / x;", "let x = f32(l + 1u); r[id.x] = x / x;"),
    ] {
        assert!(found(wrong, false).contains(&what), "{what:?}: {wrong}: {:?}", found(wrong, false));
        assert_eq!(found(right, false), [], "{right}");
    }
}

#[test]
fn the_memory_of_a_workgroup_begins_with_zeros_in_wgsl() {
    assert_eq!(found("a[id.x] = w[l];", true), []);
}

#[test]
fn what_another_workgroup_was_told_of_by_an_atomic_is_no_race() {
    let told = "if (g.x == 0u && l == 0u) { a[7] = 3u; atomicStore(&n, 1u); }
        if (g.x == 1u && l == 0u) { let flag = atomicLoad(&n); if (flag == 1u) { a[8] = a[7]; } }";
    // An atomic function orders no other memory, unless a barrier does before it.
    assert_eq!(found(told, false), [Wrong::Relaxed]);
    let ordered = told.replace(
        "if (g.x == 0u && l == 0u) { a[7] = 3u; ",
        "if (g.x == 0u && l == 0u) { a[7] = 3u; }
        storageBarrier(); if (g.x == 0u && l == 0u) { ",
    );
    assert_eq!(found(&ordered, false), []);
    let untold = "if (g.x == 0u && l == 0u) { a[7] = 3u; } if (g.x == 1u && l == 0u) { a[8] = a[7]; }";
    assert_eq!(found(untold, false), [Wrong::Race]);
}

/// What is found in an order of workgroups and invocations.
fn found_in(body: &str, turns: Turns) -> Vec<Wrong> {
    let outcome = run_with(&format!("{HEAD}{{ {body} }}"), 400, true, |dispatch| dispatch.turns = turns);
    outcome.incidents.iter().map(|incident| incident.what).collect()
}

#[test]
fn what_takes_an_order_is_found_in_it() {
    let natural = Turns::default();
    let (group, last) = (Turn::First(1), Turn::First(199));
    for (turns, wrong, body, right) in [
        (
            Turns { invocations: last, ..natural },
            Wrong::Race,
            "let t = atomicAdd(&v, 1u); if (t == 0u && l == 199u) { w[0] = 7u; } if (l == 5u) { a[id.x] = w[0]; }",
            "let t = atomicAdd(&v, 1u); if (t == 0u) { w[0] = 7u; } workgroupBarrier(); if (l == 5u) { a[id.x] = w[0]; }",
        ),
        (
            Turns { groups: group, ..natural },
            Wrong::Outside,
            "let t = atomicAdd(&n, 1u); if (t == 0u && g.x == 1u) { a[400] = l; }",
            "let t = atomicAdd(&n, 1u); if (t == 0u && g.x == 1u) { a[399] = l; }",
        ),
        (
            Turns { ahead: Some(0), ..natural },
            Wrong::Divergence,
            "atomicAdd(&v, 1u); if (atomicLoad(&v) < 200u) { workgroupBarrier(); }",
            "atomicAdd(&v, 1u); workgroupBarrier(); if (atomicLoad(&v) < 200u) { workgroupBarrier(); }",
        ),
    ] {
        assert_eq!(found_in(body, natural), [], "{body}");
        assert!(found_in(body, turns).contains(&wrong), "{body}: {:?}", found_in(body, turns));
        assert_eq!(found_in(right, turns), [], "{right}");
    }
}

#[test]
fn who_meets_whom_is_told() {
    let outcome = run(&format!("{HEAD}{{ w[l] = l; a[id.x] = w[(l + 1u) % 200u]; }}"), 400, true);
    let [incident] = &outcome.incidents[..] else { panic!("{:?}", outcome.incidents) };
    let other = incident.other.unwrap();
    assert_eq!((incident.who.group, incident.who.local, incident.who.access), (0, 0, Access::Read));
    assert_eq!((other.local, other.access), (1, Access::Write));
    assert_eq!(incident.count, 400);
}

#[test]
fn invocations_of_all_workgroups_see_one_memory() {
    let text = format!(
        "{HEAD}{{ w[l] = a[id.x]; workgroupBarrier(); let before = atomicAdd(&n, 1u); a[id.x] = w[199u - l] + 0u * before; }}"
    );
    let outcome = run(&text, 400, true);
    assert_eq!(outcome.incidents, []);
    assert_eq!(outcome.contents[0][..3], [199, 198, 197]);
    assert_eq!(outcome.contents[0][200], 399);
    assert_eq!(outcome.contents[1], [400]);
}

#[test]
fn a_loop_without_end_is_stopped_and_told() {
    let outcome = run(&format!("{HEAD}{{ loop {{ if (a[0] == 4u) {{ break; }} }} }}"), 400, true);
    assert!(!outcome.findings.is_empty() || !outcome.whole);
}

#[test]
fn places_are_named_as_their_author_does() {
    let text = "struct P { at: vec3f, links: array<array<u32, 3>, 2> }
        struct All { count: u32, parts: array<P> }
        @group(0) @binding(0) var<storage, read_write> all: All;
        var<workgroup> tile: array<array<vec2f, 4>, 2>;
        @compute @workgroup_size(1) fn main() { all.parts[1].at.y = f32(all.count) + tile[1][2].y; }";
    let (module, _) = super::super::tests::wgsl(text);
    let shape = |k: usize| {
        let (handle, _) = module.global_variables.iter().nth(k).unwrap();
        super::super::compile_shape(&module, handle)
    };
    let all = shape(0);
    let array = all.array.as_ref().unwrap();
    assert_eq!((array.offset, array.stride), (4, 12));
    assert_eq!(all.place(0), "all.count");
    assert_eq!(all.place(4 + 12 + 1), "all.parts[1].at.y");
    assert_eq!(all.place(4 + 3), "all.parts[0].links[0][0]");
    assert_eq!(shape(1).place(2 * (4 + 2) + 1), "tile[1][2].y");
}

/// What the first invocations of the first workgroup write, for a width of subgroups.
fn of_subgroups(value: &str, subgroup: u32) -> Vec<u32> {
    let text = format!(
        "@group(0) @binding(0) var<storage, read_write> a: array<u32>;
        @compute @workgroup_size(16) fn main(
            @builtin(global_invocation_id) id: vec3u, @builtin(subgroup_invocation_id) lane: u32,
            @builtin(subgroup_size) size: u32) {{
            let x = id.x + 1u; let given = {value}; a[id.x] = given;
        }}"
    );
    run_in(&text, 32, true, subgroup).contents[0][..10].to_vec()
}

#[test]
fn operations_of_subgroups_see_their_width() {
    assert_eq!(of_subgroups("subgroupAdd(x)", 4), [10, 10, 10, 10, 26, 26, 26, 26, 42, 42]);
    assert_eq!(of_subgroups("subgroupAdd(x)", 8), [36, 36, 36, 36, 36, 36, 36, 36, 100, 100]);
    assert_eq!(of_subgroups("subgroupInclusiveAdd(x)", 4), [1, 3, 6, 10, 5, 11, 18, 26, 9, 19]);
    assert_eq!(of_subgroups("subgroupExclusiveMul(x)", 4), [1, 1, 2, 6, 1, 5, 30, 210, 1, 9]);
    assert_eq!(of_subgroups("subgroupMax(x)", 4), [4, 4, 4, 4, 8, 8, 8, 8, 12, 12]);
    assert_eq!(of_subgroups("subgroupBroadcast(x, 2u)", 4), [3, 3, 3, 3, 7, 7, 7, 7, 11, 11]);
    assert_eq!(of_subgroups("subgroupBroadcastFirst(x)", 8), [1, 1, 1, 1, 1, 1, 1, 1, 9, 9]);
    assert_eq!(of_subgroups("subgroupShuffleXor(x, 1u)", 4), [2, 1, 4, 3, 6, 5, 8, 7, 10, 9]);
    // From one that is not there comes anything: here 0.
    assert_eq!(of_subgroups("subgroupShuffleUp(x, 1u)", 4), [0, 1, 2, 3, 0, 5, 6, 7, 0, 9]);
    assert_eq!(of_subgroups("subgroupShuffleDown(x, 1u)", 4), [2, 3, 4, 0, 6, 7, 8, 0, 10, 11]);
    assert_eq!(of_subgroups("subgroupBallot((x & 1u) == 1u).x", 8), [85, 85, 85, 85, 85, 85, 85, 85, 85, 85]);
    assert_eq!(of_subgroups("select(0u, 1u, subgroupAll(x < 6u))", 4), [1, 1, 1, 1, 0, 0, 0, 0, 0, 0]);
    assert_eq!(of_subgroups("select(0u, 1u, subgroupAny(x == 6u))", 4), [0, 0, 0, 0, 1, 1, 1, 1, 0, 0]);
    assert_eq!(of_subgroups("lane * 100u + size", 4), [4, 104, 204, 304, 4, 104, 204, 304, 4, 104]);
    assert_eq!(of_subgroups("u32(subgroupAdd(f32(x)) * 2.0)", 4), [20, 20, 20, 20, 52, 52, 52, 52, 84, 84]);
}

#[test]
fn who_is_missing_in_a_subgroup_is_told() {
    let found = |body: &str| {
        let text = format!(
            "@group(0) @binding(0) var<storage, read_write> a: array<u32>;
            @compute @workgroup_size(16) fn main(@builtin(global_invocation_id) id: vec3u) {{ {body} }}"
        );
        run_in(&text, 32, true, 8).incidents.iter().map(|incident| incident.what).collect::<Vec<_>>()
    };
    assert_eq!(found("if id.x < 4u { a[id.x] = subgroupAdd(id.x); }"), [Wrong::Apart]);
    // All of a subgroup come, or none.
    assert_eq!(found("if id.x < 8u { a[id.x] = subgroupAdd(id.x); }"), []);
}
