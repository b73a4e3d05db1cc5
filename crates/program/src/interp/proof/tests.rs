//! Kernels of which something holds for all sizes, each beside one of which it does not.

use super::super::Executable;
use super::super::group::{Buffer, Dispatch, Space, Turns, WIDTH, Wrong};
use super::super::tests::kernel;
use super::Proof;
use crate::Written;

/// What is proved of the only entry point of a text.
fn proved(text: &str) -> (Executable, Proof) {
    let (compiled, size) = kernel(text);
    let executable = Executable { written: Written::Wgsl, ..compiled };
    let proof = executable.prove(size);
    (executable, proof)
}

/// Random kernels.
const KERNELS: usize = 400;

const HEAD: &str = "
    struct Params { n: u32, width: u32, height: u32, stride: u32 }
    @group(0) @binding(0) var<uniform> p: Params;
    @group(0) @binding(1) var<storage, read> a: array<u32>;
    @group(0) @binding(2) var<storage, read_write> b: array<u32>;
    var<workgroup> w: array<u32, 64>;
    @compute @workgroup_size(64) fn main(
        @builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) l: u32,
        @builtin(workgroup_id) g: vec3u, @builtin(num_workgroups) all: vec3u) { let i = id.x; ";

/// What is proved of `name` with this body: `verified`, the conditions, or why not.
fn of(body: &str, name: &str) -> String {
    let (executable, proof) = proved(&format!("{HEAD}{body} }}"));
    let own = proof.memories.iter().find(|own| executable.memories()[own.memory as usize].name == name);
    let Some(own) = own else { return "nothing".to_owned() };
    match (&own.races, &own.bounds) {
        (Ok(()), Ok(conditions)) if conditions.is_empty() => "verified".to_owned(),
        (Ok(()), Ok(conditions)) => conditions.join("; "),
        (Err(why), _) => format!("race: {}", why.why),
        (_, Err(why)) => format!("bounds: {}", why.why),
    }
}

#[test]
fn an_element_for_each_invocation() {
    assert_eq!(of("if i < arrayLength(&b) { b[i] = 1; }", "b"), "verified");
    assert_eq!(of("if i >= arrayLength(&b) { return; } b[i] = 1;", "b"), "verified");
    assert!(of("if i <= arrayLength(&b) { b[i] = 1; }", "b").starts_with("bounds"));
    assert_eq!(of("if i < p.n { b[i] = 1; }", "b"), "the length of `b` is at least `p.n`");
    assert_eq!(of("if i < p.n { b[4 * i + 3] = 1; }", "b"), "the length of `b` is at least 4 × `p.n`");
    assert_eq!(of("b[i] = 1;", "b"), "the length of `b` is at least 64 × workgroups along x");
    assert!(of("if i < arrayLength(&b) { b[i / 2] = 1; }", "b").starts_with("race"));
    assert!(of("if l < arrayLength(&b) { b[l] = g.x; }", "b").starts_with("race"));
    assert_eq!(of("if i < p.n { b[i] = b[i + 1]; }", "b").split(':').next(), Some("race"));
}

#[test]
fn differences_without_a_sign_wrap_around() {
    assert!(of("if i < p.n { b[i] = a[i - 1]; }", "a").starts_with("bounds"));
    assert_eq!(of("if i < p.n && i > 0 { b[i] = a[i - 1]; }", "a"), "the length of `a` is at least `p.n`");
    assert_eq!(of("if i + 1 < arrayLength(&a) { b[0] = a[i + 1]; }", "a"), "verified");
    // 0 - 1 is below no length.
    assert!(of("if i < arrayLength(&a) - 1 { b[0] = a[i + 1]; }", "a").starts_with("verified"));
    assert!(of("if i < arrayLength(&a) - 2 { b[0] = a[i + 2]; }", "a").starts_with("bounds"));
}

#[test]
fn rows_and_columns() {
    let rows = "let x = i; let y = id.y; if x >= p.width || y >= p.height { return; } b[y * p.width + x] = 1;";
    assert_eq!(of(rows, "b"), "the length of `b` is at least `p.width` × `p.height`");
    let wrong = rows.replace("y * p.width", "y * p.height");
    assert!(of(&wrong, "b").starts_with("race"), "{}", of(&wrong, "b"));
    let apart = "if i >= p.width * p.height { return; } let y = i / p.width; let x = i % p.width; \
                 b[y * p.width + x] = a[x * p.height + y];";
    assert_eq!(of(apart, "b"), "the length of `b` is at least `p.width` × `p.height`");
    assert_eq!(of(apart, "a"), "the length of `a` is at least `p.width` × `p.height`");
}

#[test]
fn loops_with_a_step() {
    let rows = "if i >= p.n { return; } for (var k = 0u; k < p.width; k++) { b[i * p.width + k] = a[k * p.n + i]; }";
    assert_eq!(of(rows, "b"), "the length of `b` is at least `p.n` × `p.width`");
    assert_eq!(of(rows, "a"), "the length of `a` is at least `p.n` × `p.width`");
    let stride = "for (var k = i; k < arrayLength(&b); k += 64 * all.x) { b[k] = 1; }";
    assert_eq!(of(stride, "b"), "verified");
    assert!(of(&stride.replace("64 *", "63 *"), "b").starts_with("race"));
    let down = "for (var k = i32(p.n) - 1; k >= 0; k--) { if i == 0 { b[k] = 1; } }";
    assert_eq!(of(down, "b"), "the length of `b` is at least `p.n`");
}

#[test]
fn sums_in_a_workgroup() {
    let sum = "w[l] = a[0]; workgroupBarrier();
        for (var s = 32u; s > 0; s >>= 1) { if l < s { w[l] += w[l + s]; } workgroupBarrier(); }
        if l == 0 { b[g.x] = w[0]; }";
    assert_eq!(of(sum, "w"), "verified");
    assert!(of(&sum.replace("w[0]; }", "w[63]; }"), "w") == "verified");
    assert!(of(&sum.replacen("workgroupBarrier();", "", 1), "w").starts_with("race"));
    let late = sum.replace("} workgroupBarrier(); }", "} }");
    assert!(of(&late, "w").starts_with("race"), "{}", of(&late, "w"));
    assert_eq!(of(sum, "b"), "the length of `b` is at least workgroups along x");
}

#[test]
fn tiles_in_a_loop_with_barriers() {
    let tiles = "for (var t = 0u; t < p.n; t++) { w[l] = a[0]; workgroupBarrier();
        for (var k = 0u; k < 64; k++) { b[i] = w[k]; } workgroupBarrier(); }";
    assert_eq!(of(tiles, "w"), "verified");
    let late = tiles.replace("} workgroupBarrier(); }", "} }");
    assert!(of(&late, "w").starts_with("race"));
    let early = tiles.replacen("workgroupBarrier();", "", 1);
    assert!(of(&early, "w").starts_with("race"));
}

#[test]
fn two_buffers_in_turn_need_one_barrier_a_round() {
    let text = "var s = 0u; w[l % 32] = 0; workgroupBarrier();
        for (var t = 0u; t < 5; t++) { if l < 32 { w[(1 - s) * 32 + l] = w[s * 32 + (l + 1) % 32]; }
        workgroupBarrier(); s = 1 - s; }";
    assert!(of(text, "w").starts_with("race"), "two write one element at first");
    assert_eq!(of(&text.replace("w[l % 32] = 0;", "if l < 32 { w[l] = 0; }"), "w"), "verified");
}

#[test]
fn what_data_say_is_not_decided() {
    assert_eq!(of("if i < p.n { b[a[i]] = 1; }", "b"), "race: an index depends on what `a` holds");
    assert_eq!(of("if i < p.n { b[i] = a[b[i]]; }", "a"), "bounds: an index depends on what `b` holds");
    assert_eq!(of("if a[i] < 64 { w[a[i]] = 1; }", "w"), "race: an index depends on what `a` holds");
    assert_eq!(of("w[l] = 1; workgroupBarrier(); let k = a[i]; if k < 64 { b[i] = w[k]; }", "w"), "verified");
    assert_eq!(of("w[l] = 1; workgroupBarrier(); b[i] = w[min(a[i], 63)];", "w"), "verified");
    assert_eq!(of("w[l] = 1; workgroupBarrier(); b[i] = w[a[i] & 63];", "w"), "verified");
    assert_eq!(
        of("w[l] = 1; workgroupBarrier(); b[i] = w[a[i] % 65];", "w"),
        "bounds: an index depends on what `a` holds"
    );
}

#[test]
fn barriers_that_some_do_not_reach_order_nothing() {
    let text = "w[l] = 1; if i < p.n { workgroupBarrier(); } b[i] = w[63 - l];";
    assert!(of(text, "w").contains("barrier"), "{}", of(text, "w"));
    let uniform = "w[l] = 1; if p.n > 3 { workgroupBarrier(); b[i] = w[63 - l]; }";
    assert_eq!(of(uniform, "w"), "verified");
    let maybe = "w[l] = 1; if p.n > 3 { workgroupBarrier(); } b[i] = w[63 - l];";
    assert!(of(maybe, "w").starts_with("race"));
}

#[test]
fn a_barrier_between_what_does_not_meet_can_go() {
    let idle = |body: &str| proved(&format!("{HEAD}{body} }}")).1.idle.len();
    assert_eq!(idle("w[l] = a[i]; workgroupBarrier(); b[i] = w[l];"), 1);
    assert_eq!(idle("w[l] = a[i]; workgroupBarrier(); b[i] = w[63 - l];"), 0);
    assert_eq!(idle("w[l] = a[i]; workgroupBarrier(); workgroupBarrier(); b[i] = w[63 - l];"), 2);
}

/// Numbers that look random and are the same each time.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }

    fn of<'t>(&mut self, all: &[&'t str]) -> &'t str {
        all[self.below(all.len())]
    }

    /// An index of the invocation, the host and a loop.
    fn index(&mut self) -> String {
        let one = [
            "i",
            "l",
            "g.x",
            "i / 2",
            "i % p.n",
            "l ^ 1",
            "l & 6",
            "i >> 1",
            "63 - l",
            "l + 8",
            "k",
            "7 - l",
            "l / 4 * 4 + l % 4",
        ];
        let one = self.of(&one).to_owned();
        match self.below(6) {
            0 => format!("{one} + {}", self.of(&["1", "p.n", "k", "8 * g.x", "g.x"])),
            1 => format!("2 * ({one})"),
            2 => format!("({one}) * p.n + k"),
            3 => format!("min({one}, {})", self.of(&["p.n", "5u", "arrayLength(&b) - 1"])),
            4 => format!("select({one}, {}, {})", self.of(&["0u", "l", "i"]), self.of(&["l < 4", "i == 3", "p.n > 2"])),
            _ => one,
        }
    }

    fn statement(&mut self) -> String {
        let guard = self.of(&[
            "i < p.n",
            "i < arrayLength(&b)",
            "l < 4",
            "l == 0",
            "i > 0 && i < p.n",
            "p.n > 2",
            "k < l",
            "i <= p.n",
        ]);
        let (first, second) = (self.index(), self.index());
        let body = match self.below(5) {
            0 => format!("b[{first}] = 1;"),
            1 => format!("b[{first}] = w[{second}];"),
            2 => format!("w[{first}] = l;"),
            3 => format!("w[{first}] = w[{second}] + 1;"),
            _ => format!("b[{first}] += 1;"),
        };
        if self.below(3) == 0 { body } else { format!("if {guard} {{ {body} }}") }
    }

    /// A kernel with workgroups of eight.
    fn kernel(&mut self) -> String {
        let mut text = String::from("var k = 0u; ");
        for _ in 0..1 + self.below(3) {
            let one = self.statement();
            let barrier = self.of(&["", "workgroupBarrier();", "storageBarrier();"]);
            text += &match self.below(4) {
                0 => format!("for (k = 0; k < {}; k++) {{ {one} {barrier} }} ", self.of(&["3", "p.n", "l"])),
                1 => format!(
                    "for (k = {}; k < {}; k += 8) {{ {one} }} ",
                    self.of(&["l", "i", "0"]),
                    self.of(&["16", "p.n"])
                ),
                _ => format!("{one} {barrier} "),
            };
        }
        text.replace("63 - l", "7 - l")
    }
}

/// Dispatches a kernel in some sizes. Gives the memories with a race, and those with an index outside.
fn dispatched(executable: &Executable) -> [Vec<u32>; 2] {
    let mut found = [Vec::new(), Vec::new()];
    for (n, groups, elements) in [(1, 1, 1), (3, 2, 4), (5, 2, 9), (9, 2, 24), (16, 2, 16), (8, 3, 40)] {
        let buffers: Vec<Buffer> = (executable.memories().iter())
            .map(|shape| match shape.space {
                Space::Uniform => Buffer { words: vec![n, n, n, n], ..Buffer::default() },
                Space::Workgroup => Buffer::default(),
                Space::Storage { .. } => Buffer { words: vec![0; shape.words_with(elements)], elements, sides: [0; 3] },
            })
            .collect();
        let outcome = executable.dispatch::<f32>(&Dispatch {
            size: [8, 1, 1],
            groups: [groups, 1, 1],
            buffers: &buffers,
            zeroed: true,
            outside: 0,
            fuel: 1000,
            work: 100_000,
            watched: true,
            order: 0,
            turns: Turns::default(),
            subgroup: WIDTH,
        });
        for incident in outcome.incidents {
            match incident.what {
                Wrong::Race | Wrong::Unordered | Wrong::SameValue => found[0].extend(incident.memory),
                Wrong::Outside => found[1].extend(incident.memory),
                _ => {}
            }
        }
    }
    found
}

#[test]
fn no_dispatch_of_a_random_kernel_contradicts_a_proof() {
    let mut numbers = Numbers(11);
    let (mut verified, mut all) = (0, 0);
    for _ in 0..KERNELS {
        let body = numbers.kernel();
        let head = HEAD.replace("workgroup_size(64)", "workgroup_size(8)").replace("array<u32, 64>", "array<u32, 16>");
        let (executable, proof) = proved(&format!("{head}{body} }}"));
        // With several workgroups of one that asks for none, nothing is promised.
        if proof.single.contains(&0) {
            continue;
        }
        let [races, outside] = dispatched(&executable);
        for own in &proof.memories {
            all += 2;
            let without = own.bounds.as_ref().is_ok_and(Vec::is_empty);
            verified += usize::from(own.races.is_ok()) + usize::from(own.bounds.is_ok());
            assert!(own.races.is_err() || !races.contains(&own.memory), "{body}\n{own:?}");
            assert!(!without || !outside.contains(&own.memory), "{body}\n{own:?}");
        }
    }
    assert!(verified * 4 > all, "{verified} of {all}");
}
