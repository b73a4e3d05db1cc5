//! Compute stages as whole dispatches: each kernel of `fixtures/kernels/right` is silent, and its twin in `wrong`, which
//! has one fault, is found with the kind of the fault and its place.

use std::collections::BTreeSet;
use std::fs;

use serde_json::Value;

use crate::binary::{Ran, root, run_in};
use crate::webgpu;

fn fuzzed(folder: &str, name: &str, status: i32) -> Value {
    let command = format!("fuzz fixtures/kernels/{folder}/{name} --lane embedded --samples 16 --format json");
    run_in(root(), &command).expect(status).json()
}

/// Findings and warnings of dispatches: kind, severity, line.
fn told(report: &Value) -> Vec<(String, String, u64)> {
    let functions = report["files"][0]["functions"].as_array().unwrap();
    let all = functions.iter().flat_map(|function| function["findings"].as_array().unwrap());
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let line = |finding: &Value| {
        let at = text(&finding["at"]);
        at.rsplit(':').nth(1).unwrap().parse().unwrap()
    };
    all.filter(|finding| finding["severity"] != "note")
        .map(|finding| (text(&finding["kind"]), text(&finding["severity"]), line(finding)))
        .collect()
}

/// The wrong twins: the fault that each has, whether it fails the run, and a line that is named.
pub const WRONG: [(&str, &str, bool, u64); 59] = [
    // A barrier that is missing behind a step of the sum.
    ("sum.wgsl", "race", true, 21),
    // Elements behind the last one are not filled.
    ("tail.comp", "unset", true, 18),
    // Written and read in one step.
    ("scan.comp", "race", true, 17),
    // No guard for the tail.
    ("transpose.wgsl", "index", false, 21),
    // Counted without an atomic function.
    ("histogram.wgsl", "race", true, 11),
    // The blur reads what it writes.
    ("blur.comp", "race", true, 14),
    // One off in the guard.
    ("particles.wgsl", "index", true, 12),
    // The next tile is loaded while others still read the last one.
    ("product.comp", "race", true, 20),
    // Who has no element leaves before the barrier.
    ("reverse.wgsl", "divergence", true, 13),
    // An index behind the end, after a wait that depends on what is in memory.
    ("ticket.wgsl", "index", true, 27),
    // One more than there are for each workgroup; a host may have room for it.
    ("blocks.wgsl", "index", false, 9),
    // The element before the first; its twin selects another value there.
    ("select.wgsl", "index", true, 12),
    // One off in the guard of an array with nine elements for each of the dispatch.
    ("gradients.wgsl", "index", true, 20),
    // A number of columns that is called padded leads around the barrier.
    ("padded.comp", "divergence", true, 16),
    // No barrier between the steps, in a workgroup whose size is a specialization constant.
    ("specialized.comp", "race", true, 16),
    // Pairs overlap.
    ("sort.wgsl", "race", true, 18),
    // A barrier that is missing, between numbers of binary16.
    ("halves.wgsl", "race", true, 25),
    // As if 32 invocations made a subgroup.
    ("subgroup_sum.wgsl", "subgroup_width", true, 19),
    // Who has no element leaves before the others of the subgroup are asked.
    ("subgroup_tail.wgsl", "divergence", true, 13),
    ("subgroup_reduce.comp", "subgroup_width", true, 15),
    // A fence without a barrier.
    ("subgroup_exchange.comp", "race", true, 18),
    // Two bytes are taken for four.
    ("half_stride.comp", "index", true, 15),
    // An image is written while others still read it.
    ("image_blur.wgsl", "race", true, 13),
    // No barrier between the row of an image in the memory of the workgroup and who reads it.
    ("row_blur.comp", "race", true, 20),
    // The filter reads neighbours from the image that it writes.
    ("sharpen.wgsl", "race", true, 13),
    // Four invocations store at one texel.
    ("halve.comp", "race", true, 9),
    // The guard asks for the size of the image that is read.
    ("scale.comp", "index", false, 13),
    // Counted in an image without an atomic function.
    ("counts.comp", "race", true, 14),
    // One behind the end of the memory of the workgroup, on the way into an image.
    ("volume.wgsl", "index", true, 9),
    // Who has no texel leaves before the barrier.
    ("layers.wgsl", "divergence", true, 19),
    // The barrier orders the memory of workgroups, and the values are in a storage buffer.
    ("columns.wgsl", "race", true, 20),
    // The same in GLSL.
    ("pairs.comp", "race", true, 15),
    // The mean of no neighbour.
    ("flock.comp", "no_value", true, 19),
    // Values without variance are divided by 0.
    ("standard.wgsl", "no_value", false, 23),
    // Tiles overlap, whole ones too; its twin is written for whole tiles, and others are tried as well.
    ("tiles.comp", "race", false, 14),
    // No barrier behind the steps of a sum, in a kernel whose numbers of a call are packed by fours.
    ("heads.comp", "race", true, 27),
    // The memory of the workgroup is indexed by the place in the dispatch: right with one workgroup.
    ("row_max.comp", "index", false, 16),
    // No barrier, along an axis of which workgroups ask nothing.
    ("states.comp", "race", true, 15),
    // Pixels of one channel get three; with none, which no image has, its twin divides by 0 and goes outside.
    ("channels.comp", "race", false, 25),
    // No barrier between the steps, in a workgroup whose size is left to the host.
    ("host_sized.comp", "race", true, 24),
    // A sum over the workgroup is 0 where all of its elements are.
    ("shares.comp", "no_value", false, 23),
    // Four invocations store at one index, whatever number the host gives the guard.
    ("mask.wgsl", "race", true, 9),
    // Keys lead to 64 places; its twin takes the places from a permutation, which only the host knows.
    ("places.wgsl", "race", true, 9),
    // Who writes came first, which in the order of their numbers it never does.
    ("elect.wgsl", "race", true, 13),
    // The same where the last one reads.
    ("last.wgsl", "race", true, 14),
    // A flag of another workgroup that nobody asks for.
    ("flag.wgsl", "race", true, 12),
    // A store undoes what came behind the load.
    ("count_up.wgsl", "race", true, 9),
    // Who asks early waits at a barrier that others do not reach.
    ("rounds.wgsl", "divergence", true, 11),
    // Who comes first stays; its twin stores the same values at other places.
    ("append.wgsl", "order", false, 13),
    // Atomic functions of WGSL order nothing else between workgroups.
    ("relaxed.wgsl", "race", false, 20),
    // The softmax of an empty sequence.
    ("attention.wgsl", "no_value", false, 31),
    // A tangent of exponential functions, which are too large for binary32 where the tangent is 1.
    ("activation.wgsl", "no_value", false, 11),
    // The barrier orders the memory of workgroups, and which element is marked is up to data.
    ("picked.wgsl", "race", false, 13),
    // No barrier between the steps, behind numbers that are packed into one word.
    ("tiled.comp", "race", true, 19),
    // Read by all in the condition before the one that keeps them away.
    ("guarded.comp", "race", true, 15),
    // Halves of a place, whatever number the host sets.
    ("host_stride.comp", "race", false, 12),
    // What only numbers of a host show that differ: a way out of a loop, a cache that other workgroups fill, sizes in storage.
    ("late_return.comp", "divergence", false, 12),
    ("past.comp", "race", false, 14),
    ("held_size.comp", "race", false, 25),
];

#[test]
fn kernels_that_are_right_are_silent() {
    for (name, ..) in WRONG {
        let report = fuzzed("right", name, 0);
        assert_eq!(told(&report), [], "{name}");
        let functions = report["files"][0]["functions"].as_array().unwrap();
        let dispatches: u64 = functions.iter().filter_map(|function| function["dispatches"].as_u64()).sum();
        assert!(dispatches >= 2, "{name}: {dispatches}");
    }
}

#[test]
fn each_wrong_kernel_is_found_by_kind_and_place() {
    for (name, kind, fails, line) in WRONG {
        let report = fuzzed("wrong", name, i32::from(fails));
        let told = told(&report);
        let severity = if fails { "finding" } else { "warning" };
        let wanted = (kind.to_owned(), severity.to_owned(), line);
        assert!(told.contains(&wanted), "{name}: {told:?}");
        // One fault is no reason to tell another.
        let kinds: BTreeSet<&str> =
            told.iter().filter(|(_, severity, _)| severity == "finding").map(|(kind, ..)| &**kind).collect();
        assert!(kinds.is_subset(&BTreeSet::from([kind])), "{name}: {told:?}");
    }
}

#[test]
fn the_size_that_a_host_chooses_is_stated_or_told() {
    let run = |size: &str| {
        let kernel = "fixtures/kernels/right/host_sized.comp";
        let define =
            if size.is_empty() { String::new() } else { format!("--define SHADERCHECK_WORKGROUP_SIZE={size}") };
        run_in(root(), &format!("fuzz {kernel} --lane embedded --samples 16 {define}"))
    };
    let assumed = run("").expect(0);
    assert!(assumed.err.contains("assumed --define SHADERCHECK_WORKGROUP_SIZE=64,1,1: the text leaves"), "{assumed:?}");
    let stated = run("64,1,1").expect(0);
    assert!(!stated.err.contains("assumed"), "{stated:?}");
    for wrong in ["abc", "32", "64,1", "0,1,1", "64,1,1,1"] {
        let ran = run(wrong);
        let told = format!("host_sized.comp:3:8: `SHADERCHECK_WORKGROUP_SIZE` is `{wrong}`; state a size");
        assert!(ran.code == 2 && ran.out.contains(&told), "{told}\n{ran:?}");
    }
}

/// A guard that is one off lets an invocation outside at each of its loads and stores.
#[test]
fn one_cause_is_one_finding_with_its_places() {
    let report = fuzzed("wrong", "particles.wgsl", 1);
    let findings = report["files"][0]["functions"][0]["findings"].as_array().unwrap();
    let is_outside = |finding: &&Value| finding["kind"] == "index" && finding["severity"] == "finding";
    let outside: Vec<&Value> = findings.iter().filter(is_outside).collect();
    assert_eq!(outside.len(), 1, "{outside:?}");
    let also: Vec<&str> = outside[0]["also"].as_array().unwrap().iter().filter_map(|at| at["at"].as_str()).collect();
    assert!(!also.is_empty() && also.iter().all(|at| at.contains("particles.wgsl:13:")), "{also:?}");
    // Three partial sums are read without a barrier; the index is another fault.
    let told = told(&fuzzed("wrong", "states.comp", 1));
    assert_eq!(told.iter().filter(|(kind, ..)| kind == "race").count(), 1, "{told:?}");
}

#[test]
fn a_module_in_host_code_is_run_as_wgsl() {
    let kernel = |guard: &str| {
        format!(
            "export const source = /* wgsl */ `\n@group(0) @binding(0) var<storage, read_write> x: array<u32>;\n\
             var<workgroup> part: array<u32, 64>;\n@compute @workgroup_size(64)\nfn turn(@builtin(local_invocation_index) i: u32, \
             @builtin(global_invocation_id) id: vec3u) {{\n  part[i] = id.x;\n  {guard}\n  \
             if (id.x < arrayLength(&x)) {{ x[id.x] = part[63u - i]; }}\n}}\n`;\n"
        )
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("turn.js"), kernel("")).unwrap();
    let wrong = run_in(folder.path(), "fuzz turn.js --lane embedded --samples 16").expect(1);
    assert!(wrong.out.contains("race on `part[") && wrong.out.contains("turn.js:8:"), "{}", wrong.out);
    fs::write(folder.path().join("turn.js"), kernel("workgroupBarrier();")).unwrap();
    run_in(folder.path(), "fuzz turn.js --lane embedded --samples 16").expect(0);
}

/// A block with a counter: its structures are stored and loaded as a whole beside atomic functions on it.
#[test]
fn structures_beside_atomics_are_stored_and_loaded() {
    let text = "#version 450\nlayout(local_size_x = 64) in;\nstruct Sum { uint value; };\n\
                struct State { uint flag; Sum sums[2]; };\nlayout(binding = 0) buffer States { uint n; State states[]; };\n\
                layout(binding = 1) buffer Out { uint o[]; };\nvoid main() {\n  uint i = gl_GlobalInvocationID.x;\n  \
                Sum one; one.value = i;\n  atomicAdd(n, 1u);\n  if (i >= states.length() || i >= o.length()) return;\n  \
                states[i].sums[1] = one;\n  State all = states[i];\n  o[i] = all.sums[1].value;\n}\n";
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("states.comp"), text).unwrap();
    let report = run_in(folder.path(), "fuzz states.comp --lane embedded --samples 16 --format json").expect(0).json();
    let function = &report["files"][0]["functions"][0];
    assert!(function["dispatches"].as_u64().unwrap() > 2 && function["not_run"].is_null(), "{function}");
}

/// A guard that no chosen number passes keeps all invocations away: that is no clean bill.
#[test]
fn a_kernel_that_stores_nothing_is_told() {
    let kernel = |least: u32| {
        format!(
            "@group(0) @binding(0) var<storage, read_write> out: array<u32>;\n\
             @group(0) @binding(1) var<uniform> budget: u32;\n\n@compute @workgroup_size(64)\n\
             fn main(@builtin(global_invocation_id) id: vec3<u32>) {{\n  if (budget < {least}u) {{ return; }}\n  \
             if (id.x < arrayLength(&out)) {{ out[id.x] = id.x; }}\n}}\n"
        )
    };
    let folder = tempfile::tempdir().unwrap();
    let findings = |least| {
        fs::write(folder.path().join("a.wgsl"), kernel(least)).unwrap();
        let report = run_in(folder.path(), "fuzz a.wgsl --lane embedded --samples 16 --format json").expect(0).json();
        told(&report)
    };
    assert_eq!(findings(1000), [("not_written".to_owned(), "warning".to_owned(), 7)]);
    assert_eq!(findings(1), []);
}

/// A number of which a mask leaves nothing is none that a host packs.
#[test]
fn words_of_which_nothing_is_left_are_no_packed_numbers() {
    let text = "@group(0) @binding(0) var<storage, read_write> out: array<u32>;\n@group(0) @binding(1) var<uniform> heads: u32;\n\
                @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {\n  \
                if (id.x < arrayLength(&out)) { out[id.x] = (heads >> 16u) / (heads & 0xffu) + (heads & 0u); }\n}\n";
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.wgsl"), text).unwrap();
    let report = run_in(folder.path(), "fuzz a.wgsl --lane embedded --samples 16 --format json").expect(0).json();
    assert_eq!(told(&report), []);
}

/// `sharpen` reads beyond the border of an image, and `halve` has more invocations than texels.
#[test]
fn coordinates_outside_of_an_image_are_notes() {
    for (name, place) in [("sharpen.wgsl", "reads `source` at coordinate"), ("halve.comp", "`halved` at coordinate")] {
        let command = format!("fuzz fixtures/kernels/right/{name} --lane embedded --samples 16 --format json --notes");
        let report = run_in(root(), &command).expect(0).json();
        let findings = report["files"][0]["functions"][0]["findings"].as_array().unwrap();
        let of_image = |finding: &&Value| finding["message"].as_str().unwrap().contains(place);
        let outside: Vec<&Value> = findings.iter().filter(of_image).collect();
        assert!(!outside.is_empty(), "{name}: {findings:?}");
        assert!(outside.iter().all(|finding| finding["severity"] == "note"), "{name}: {outside:?}");
    }
}

#[test]
fn every_kernel_has_its_twin() {
    let names = |folder: &str| -> BTreeSet<String> {
        let entries = fs::read_dir(root().join("fixtures/kernels").join(folder)).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    };
    let listed: BTreeSet<String> = WRONG.iter().map(|(name, ..)| (*name).to_owned()).collect();
    assert_eq!((names("right"), names("wrong")), (listed.clone(), listed));
}

#[test]
fn a_race_is_told_with_both_places_and_what_the_host_did() {
    let report = run_in(root(), "fuzz fixtures/kernels/wrong/sum.wgsl --lane embedded").expect(1);
    for part in [
        "race on `part[16]`: invocation 0 reads it, and invocation 16 writes it at fixtures/kernels/wrong/sum.wgsl:21:13, with no barrier between",
        "at         fixtures/kernels/wrong/sum.wgsl:21:30: `part[local.x + half]`",
        "workgroups = 1",
        "elements of `values` = 1",
        "20 dispatches",
    ] {
        assert!(report.out.contains(part), "{part}\n{}", report.out);
    }
}

#[test]
fn what_is_not_judged_is_told() {
    let head = "@group(0) @binding(0) var<storage, read_write> a: array<u32>;\n\
                @group(0) @binding(1) var<storage, read> b: array<u32>;\n";
    let id = "@builtin(global_invocation_id) id: vec3u";
    for (size, body, flag, told) in [
        (
            256,
            "if (id.x >= arrayLength(&a)) { return; } for (var i = 0u; i < 16000u; i++) { a[id.x] ^= i; }",
            "",
            "went on for too long and were cut off: the rest of them is not judged",
        ),
        (
            64,
            "if (id.x < arrayLength(&b)) { a[b[id.x] * b[id.x]] = 1u; }",
            "--notes",
            "no index into `a` is called too large: no rule was found for its length",
        ),
        (
            4096,
            "if (id.x < arrayLength(&a)) { a[id.x] = 1u; }",
            "",
            "a workgroup of 4096 invocations; 2048 at most are run",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let text = format!("{head}@compute @workgroup_size({size}) fn main({id}) {{ {body} }}\n");
        fs::write(folder.path().join("a.wgsl"), &text).unwrap();
        let ran = run_in(folder.path(), &format!("fuzz a.wgsl --lane embedded --samples 16 {flag}"));
        assert!(ran.out.contains(told), "{told}\n{text}\n{}{}", ran.out, ran.err);
    }
}

/// Wrong twins of the kernels in `shaders/kernels`: the suite in one size, and a part of what is reported.
const TWINS: [(&str, &str, &str); 16] = [
    ("sum_zeros", "sum.suite.toml[N=63]", "the shader deviates from its reference: `total[0]` is 0.0"),
    ("sum_tail", "sum.suite.toml[N=65]", "the shader deviates from its reference: `total[0]` is"),
    ("sum_barrier", "sum.suite.toml[N=64]", "sum_barrier.comp:18:28: race on `part["),
    // Right at all sizes but the large one.
    ("sum_sixteen_bits", "sum.suite.toml[N=70001]", "the shader deviates from its reference: `total[0]` is"),
    ("dot_copy", "dot.suite.toml[N=31]", "the shader deviates from its reference: `product[0]` is"),
    ("scan_off_by_one", "scan.suite.toml[N=1]", "the shader deviates from its reference: `sums[0]` is 0, expected 1"),
    // Two blocks are summed right, three are not.
    ("scan_carry", "scan.suite.toml[N=129]", "the shader deviates from its reference: `sums[128]` is"),
    ("histogram_race", "histogram.suite.toml[N=31]", "histogram_race.comp:17:9: race on `counts["),
    ("softmax_accumulates", "softmax.suite.toml[N=1,ROWS=3]", "the shader deviates from its reference: `shares[2]` is"),
    (
        "layer_norm_stride",
        "layer_norm.suite.toml[N=31,ROWS=2]",
        "layer_norm_stride.comp:43:9: race on `Normed.normed[30]`",
    ),
    ("matrix_product_stride", "matrix_product.suite.toml[K=9,M=1,N=7]", "the shader gives an undefined value: `b["),
    ("bitonic_sort_barrier", "bitonic_sort.suite.toml[N=2]", "race on `own["),
    ("bitonic_sort_loses", "bitonic_sort.suite.toml[N=2]", "the relation `sorts(keys)` does not hold"),
    ("blur_beyond", "blur.suite.toml[HEIGHT=2,WIDTH=31]", "the shader gives an undefined value: `source["),
    ("particles_order", "particles.suite.toml[N=31]", "particles_order.comp:19:5: race on `Positions.positions[0].x`"),
    ("skinning_first", "skinning.suite.toml[N=1]", "the shader deviates from its reference: `skinned[0]"),
];

/// A kernel that a build makes for each type and width: the last step of its sum lacks a barrier where `LAST` is 1.
const BUILT: &str = "#version 450\nlayout(local_size_x = WIDTH) in;\n\
    layout(binding = 0) readonly buffer A { ELEMENT a[]; };\nlayout(binding = 1) buffer B { ELEMENT b[]; };\n\
    shared float part[WIDTH];\nvoid main() {\n  uint k = gl_LocalInvocationIndex;\n  part[k] = float(a[k % a.length()]);\n\
    barrier();\n  for (uint n = WIDTH / 2; n > LAST; n >>= 1) {\n    if (k < n) { part[k] += part[k + n]; }\n    barrier();\n  }\n\
    if (k == 0u) { b[0] = ELEMENT(part[0] + (LAST == 1 ? part[1] : 0.0)); }\n}\n";

#[test]
fn macros_of_a_build_are_assumed_and_told() {
    let run = |text: &str, arguments: &str| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("sum.comp"), text).unwrap();
        run_in(folder.path(), &format!("fuzz sum.comp --lane embedded --samples 16 {arguments}"))
    };
    let right = BUILT.replace("LAST", "0u");
    let ran = run(&right, "").expect(0);
    assert!(ran.err.contains("note: assumed --define WIDTH=32 --define ELEMENT=float: "), "{ran:?}");
    let told = run(&right, "--format json").expect(0).json()["files"][0]["notes"].to_string();
    assert!(told.contains("assumed --define WIDTH=32"), "{told}");
    // What is stated is not assumed.
    let ran = run(&right, "--define WIDTH=8 --define ELEMENT=uint").expect(0);
    assert!(!ran.err.contains("assumed"), "{ran:?}");
    let wrong = right.replacen("    barrier();\n  }", "  }", 1);
    let ran = run(&wrong, "").expect(1);
    assert!(ran.out.contains("race"), "{ran:?}");
    // A command that shows it again says what was assumed.
    assert!(ran.out.contains("--define WIDTH=32 --define ELEMENT=float"), "{ran:?}");
    // A slip of the pen is no macro of a build.
    run(&right.replacen("part[k] = float(a", "part[k] = float(aa", 1), "").expect(1);
}

/// A kernel whose host puts macros in front of it, in files as an engine has them.
const HOSTED: &str = "#version 450\nlayout(local_size_x = 64) in;\nlayout(binding = 0) buffer A { real4 a[]; };\n\
    layout(push_constant) uniform P { uint n; } p;\nvoid main() {\n  uint k = gl_GlobalInvocationID.x;\n\
    if (k >= given(n)) return;\n  store4(a, k, load4(a, k) * real(2.0));\n}\n";

const HOST: &str = "void macros(Defines& defines, bool packed) {\n  // macros of all shaders\n  if (packed) {\n\
    defines.append(\"real4\", \"uvec2\");\n  } else {\n    defines.append(\"real4\", \"vec4\");\n  }\n\
    defines.append(\"real\", \"float\");\n  defines.append(\"given(x)\", \"(p.x)\");\n\
    defines.append(\"load4(buf,i)\", \"buf[i]\");\n  defines.append(\"store4(buf,i,v)\", \"{buf[i]=v;}\");\n}\n";

#[test]
fn macros_of_host_code_in_the_project_are_taken_and_told() {
    let run = |kernel: &str, host: Option<&str>, arguments: &str| {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("src/shaders")).unwrap();
        fs::create_dir(folder.path().join(".git")).unwrap();
        fs::write(folder.path().join("src/shaders/twice.comp"), kernel).unwrap();
        if let Some(host) = host {
            fs::write(folder.path().join("src/gpu.cpp"), host).unwrap();
        }
        run_in(folder.path(), &format!("fuzz src/shaders/twice.comp --lane embedded --samples 16 {arguments}"))
    };
    let ran = run(HOSTED, Some(HOST), "").expect(0);
    assert!(ran.err.contains("taken from") && ran.err.contains("gpu.cpp") && ran.err.contains("`real4`"), "{ran:?}");
    assert!(!ran.err.contains("assumed"), "{ran:?}");
    // Nothing is invented for functions of which no host code speaks.
    run(HOSTED, None, "").expect(1);
    // A fault of the kernel is one whatever the macros are called.
    let wrong = HOSTED.replace("k >= given(n)", "k > given(n)");
    let ran = run(&wrong, Some(HOST), "").expect(1);
    assert!(ran.out.contains("index"), "{ran:?}");
    // What is stated goes before what host code says.
    let stated = "--define load4(buf,i)=vec4(0.0,0.0,buf[i].xy)";
    let ran = run(HOSTED, Some(&HOST.replace("load4(buf,i)", "other(buf,i)")), stated).expect(0);
    assert!(ran.err.contains("taken from"), "{ran:?}");
}

#[test]
fn suites_of_kernels_find_each_wrong_twin() {
    for (twin, suite, reported) in TWINS {
        let shader = format!("fixtures/kernels/twins/{twin}.comp");
        let command = format!("check shaders/kernels/{suite} --shader {shader} --lane embedded --samples 16");
        let ran = run_in(root(), &command).expect(1);
        assert!(ran.out.contains(reported), "{twin}\n{}", ran.out);
    }
    let all: BTreeSet<String> = fs::read_dir(root().join("fixtures/kernels/twins"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().trim_end_matches(".comp").to_owned())
        .collect();
    assert_eq!(all, TWINS.iter().map(|(twin, ..)| (*twin).to_owned()).collect());
}

#[test]
fn kernels_without_a_fault_pass_on_the_interpreter_and_on_a_device() {
    for lane in ["embedded", "vulkan"] {
        let ran = run_in(root(), &format!("check shaders/kernels --lane {lane} --samples 4")).expect(0);
        let passed = ran.out.lines().filter(|line| line.starts_with("ok ")).count();
        assert_eq!(passed, 106, "{lane}\n{}", ran.out);
        assert!(ran.out.contains(" 0 deviated"), "{}", ran.out);
    }
}

/// Twins in sizes in which each word is judged by itself: what was found small is found large.
const LARGE: [(&str, &str, &str); 6] = [
    ("sum_zeros", "sum.suite.toml[N=70001]", "the shader deviates from its reference: `total[0]` is 0.0"),
    ("sum_tail", "sum.suite.toml[N=70001]", "the shader deviates from its reference: `total[0]` is"),
    ("sum_barrier", "sum.suite.toml[N=70001]", "sum_barrier.comp:18:28: race on `part["),
    ("scan_carry", "scan.suite.toml[N=5003]", "the shader deviates from its reference: `sums[128]` is"),
    ("dot_copy", "dot.suite.toml[N=4111]", "the shader deviates from its reference: `product[0]` is"),
    ("skinning_first", "skinning.suite.toml[N=1031]", "the shader deviates from its reference: `skinned[0]"),
];

#[test]
fn large_dispatches_find_what_small_ones_find() {
    for (twin, suite, reported) in LARGE {
        let shader = format!("fixtures/kernels/twins/{twin}.comp");
        let command = format!("check shaders/kernels/{suite} --shader {shader} --lane embedded --samples 2");
        let ran = run_in(root(), &command).expect(1);
        assert!(ran.out.contains(reported), "{twin}\n{}", ran.out);
    }
    // Whose fault only a large size shows.
    let shader = "fixtures/kernels/twins/sum_sixteen_bits.comp";
    for (size, status) in [(97, 0), (70_001, 1)] {
        run_in(root(), &format!("check shaders/kernels/sum.suite.toml[N={size}] --shader {shader} --lane embedded"))
            .expect(status);
    }
}

/// Suites in one size each, with a kernel that is wrong on every lane. Races are told before any lane is asked.
const ON_LANES: [(&str, &str); 6] = [
    ("sum_zeros", "sum.suite.toml[N=63]"),
    ("sum_tail", "sum.suite.toml[N=65]"),
    ("dot_copy", "dot.suite.toml[N=31]"),
    ("scan_carry", "scan.suite.toml[N=129]"),
    ("softmax_accumulates", "softmax.suite.toml[N=1,ROWS=3]"),
    ("skinning_first", "skinning.suite.toml[N=1]"),
];

#[test]
fn each_lane_passes_right_kernels_and_fails_wrong_twins() {
    let suites: Vec<String> = ON_LANES.iter().map(|(_, suite)| format!("shaders/kernels/{suite}")).collect();
    let suites = suites.join(" ");
    let mut lanes = vec!["vulkan", "opengl", "vulkan-glslang"];
    lanes.extend(webgpu::device("whole dispatches").map(|_| "webgpu"));
    // Dawn needs a driver that the others may do without.
    let run = |args: &str| Ran::from(webgpu::command(root(), args).output().unwrap());
    for lane in lanes {
        let ran = run(&format!("check {suites} --require-lane {lane} --lane {lane} --samples 16")).expect(0);
        assert_eq!(ran.out.lines().filter(|line| line.starts_with("ok ")).count(), 6, "{lane}\n{}", ran.out);
        assert!(ran.out.contains(" 0 deviated"), "{lane}\n{}", ran.out);
        for (twin, suite) in ON_LANES {
            let shader = format!("--shader fixtures/kernels/twins/{twin}.comp");
            let command =
                format!("check shaders/kernels/{suite} {shader} --require-lane {lane} --lane {lane} --samples 16");
            let ran = run(&command).expect(1);
            assert!(ran.out.contains("the shader deviates from its reference"), "{lane} {twin}\n{}", ran.out);
        }
    }
}

/// What NumPy or `refdata` computed is an expectation, and a wrong kernel does not keep it.
#[test]
fn recorded_arrays_are_an_expectation() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().display();
    run_in(root(), &format!("refdata generate shaders/kernels/scan.suite.toml --samples 16 --output {path}")).expect(0);
    let written: BTreeSet<String> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert!(written.contains("kernel_scan_N=65_.npz"), "{written:?}");
    let suite = |shader: &str| {
        fs::copy(root().join(shader), folder.path().join("scan.comp")).unwrap();
        let text = "suite = \"scan\"\nshader = \"scan.comp\"\nstage = \"compute\"\nper_case = 16\n\
            recorded = \"kernel_scan_N={N}_.npz\"\n[dispatch]\ngroups = 1\n\
            lengths = { values = \"N\", sums = \"N\" }\nsizes = { N = [1, 63, 65, 129] }\n";
        fs::write(folder.path().join("scan.suite.toml"), text).unwrap();
    };
    suite("shaders/kernels/scan.comp");
    let ran = run_in(folder.path(), "check scan.suite.toml --lane embedded").expect(0);
    assert_eq!(ran.out.lines().filter(|line| line.starts_with("ok ")).count(), 4, "{}", ran.out);
    suite("fixtures/kernels/twins/scan_carry.comp");
    let ran = run_in(folder.path(), "check scan.suite.toml --lane embedded").expect(1);
    assert!(ran.out.contains("the shader deviates from its record"), "{}", ran.out);
    // An array of another size is named with what it should be.
    fs::copy(folder.path().join("kernel_scan_N=63_.npz"), folder.path().join("kernel_scan_N=65_.npz")).unwrap();
    let ran = run_in(folder.path(), "check scan.suite.toml --lane embedded").expect(2);
    let all = format!("{}{}", ran.out, ran.err);
    assert!(all.contains("kernel_scan_N=65_.npz: the array `input.values` has the shape [16, 63]"), "{all}");
    assert!(all.contains("`values` has [65] with N = 65"), "{all}");
}

#[test]
fn a_mistake_in_a_suite_is_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let shader = "#version 450\nlayout(local_size_x = 1) in;\nlayout(std430, binding = 0) buffer V { float v[]; };\n\
        void main() { v[0] = 1.0; }\n";
    fs::write(folder.path().join("a.comp"), shader).unwrap();
    let suite =
        "suite = \"a\"\nshader = \"a.comp\"\nstage = \"compute\"\n[dispatch]\ngroups = 1\nsizes = { N = [1, 2, 3] }\n";
    fs::write(folder.path().join("a.suite.toml"), suite).unwrap();
    let ran = run_in(folder.path(), "check a.suite.toml --lane embedded").expect(2);
    assert_eq!(ran.out.matches("without a length").count(), 1, "{}", ran.out);
    assert_eq!(ran.out.matches("the same as a[N=1]").count(), 2, "{}", ran.out);
}

#[test]
fn numbers_of_a_dispatch_that_have_no_value_are_reported_with_their_place() {
    let shader = "#version 450\nlayout(local_size_x = 1) in;\nlayout(std430, binding = 0) buffer V { float v[]; };\n\
        void main() { v[0] = 1.0; }\n";
    let refused = |dispatch: &str, inputs: &str, reported: &str| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.comp"), shader).unwrap();
        let suite = format!("suite = \"a\"\nshader = \"a.comp\"\nstage = \"compute\"\n{dispatch}\n{inputs}");
        fs::write(folder.path().join("a.suite.toml"), suite).unwrap();
        let ran = run_in(folder.path(), "check a.suite.toml --lane embedded").expect(2);
        let all = format!("{}{}", ran.out, ran.err);
        assert!(all.contains(reported), "{reported}\n{all}");
    };
    let values = "[[inputs]]\nnames = [\"v\"]\ngenerator = \"array\"\nrange = [0, \"M - 1\"]\n";
    let dispatch = "[dispatch]\ngroups = 1\nlengths = { v = \"N\" }\nsizes = { N = [2] }";
    refused("", "", "a compute stage needs a table [dispatch]");
    refused(dispatch, values, "a.suite.toml:11:9: `M - 1`: `M` is no size; name it in [dispatch.sizes]");
    refused("[dispatch]\ngroups = 0\nlengths = { v = 2 }", "", "a dispatch without workgroups");
    refused("[dispatch]\ngroups = [1, 1, 1, 1]\nlengths = { v = 2 }", "", "three axes at most");
    refused("[dispatch]\ngroups = 1\nlengths = { w = 2 }", "", "a length of `w`, which is no buffer");
    refused("[dispatch]\ngroups = 1\nlengths = { v = 0 }", "", "without an element");
    refused(
        "[dispatch]\ngroups = 1",
        "",
        "a.suite.toml:4:1: the buffer `v` without a length; say how many elements it has: lengths = { v = 64 }",
    );
    refused(
        "[dispatch]\ngroups = 1\nlengths = { v = 1073741824 }",
        "",
        "the buffer `v` of 4294967296 bytes; 67108864 at most",
    );
}
