//! `fuzz --reproducible` and `compare --same-bits`: what is left to devices is told, and what is called fixed is fixed.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;

use crate::binary::run_in;
use crate::fuzz::functions;
use base::text::SourceFile;
use engine::adversary::{Adversary, Fault, Strategy};
use engine::fuzz::{Domain, Subject};
use engine::reproducible::{BitsReport, Request, Standing, run};
use judge::profile::{Op, Profile, by_name, parse};
use lanes::{Lane, Stage};

/// Functions whose bits are fixed, by name, beside some whose bits are not.
const FUNCTIONS: &str = "\
float fixedSum(float x, float y) { return max(x, y) + 0.5; }
uint fixedHash(uint x) { x ^= x >> 16; x *= 0x7feb352du; x ^= x >> 15; return x; }
float fixedStep(float x) { return x < 0.7 ? 2.0 * x - 1.0 : floor(x); }
float fixedKept(float a, float b, float c) { precise float r = a * b + c; return r; }
float pinned(float a, float b, float c) { return a * b + c; }
float ordered(float a, float b, float c) { return a + b + c; }
float freeRoot(float x) { return sqrt(abs(x) + 1.0); }
float freeMix(vec3 a, vec3 b) { return dot(a, b); }
float freeSide(float x) { return x * 3.0 + 0.1 < 0.7 ? 1.0 : 0.0; }
float freeRatio(float x, float y) { precise float r = x / (abs(y) + 1.0); return r; }
";

/// Vulkan with sums and products that are rounded to nearest, which is what the report takes for granted.
fn nearest() -> Profile {
    let text = "name = \"nearest\"\nextends = \"vulkan-1.4\"\nrevision = \"rounded to nearest\"\n\
                rounding = \"nearest-even\"\ncontraction = \"allowed\"\nrearrangement = \"allowed\"\n";
    parse(&SourceFile::new("nearest.toml", text), &|name| by_name(name).cloned()).unwrap()
}

fn looked(text: &str, profile: &Profile, lanes: &[&dyn Lane]) -> Vec<BitsReport> {
    let request = Request { samples: 2048, seed: 1, case: None, profile, lanes, command: "shadercheck fuzz a.glsl" };
    let of = |subject: &Subject| {
        let ready = subject.ready.as_ref().ok().unwrap();
        let (invocation, case) = (ready.kernel.invocation.fields(), ready.kernel.case.fields());
        run(subject, ready, &Domain::new(&subject.name, invocation, case, &[]), &request).unwrap()
    };
    functions("a.glsl", text).iter().map(of).collect()
}

#[test]
fn each_way_to_be_free_is_told_and_what_is_fixed_is_silent() {
    for report in looked(FUNCTIONS, &nearest(), &[]) {
        let standing = report.outputs[0].standing();
        let wanted = match report.function.as_str() {
            name if name.starts_with("fixed") => standing == Standing::Fixed || standing == Standing::FixedButForEdges,
            name if name.starts_with("free") => standing == Standing::Free,
            _ => standing == Standing::FixedByPrecise,
        };
        assert!(wanted, "{report:?}");
    }
}

#[test]
fn no_device_that_keeps_the_profile_has_other_bits_where_they_are_fixed() {
    let nearest = nearest();
    let mut differs = Vec::new();
    for (seed, strategy) in [Strategy::Random, Strategy::Extreme, Strategy::Upward, Strategy::BySite, Strategy::Mixed]
        .into_iter()
        .enumerate()
    {
        let device = Adversary::lane(&nearest, Stage::Compute, strategy, seed as u64, true);
        for report in looked(FUNCTIONS, &nearest, &[&device]) {
            assert!(report.lanes.iter().all(|lane| lane.not_run.is_none()), "{report:?}");
            for output in &report.outputs {
                assert!(output.apart.iter().all(|apart| apart.fixed == 0), "{strategy:?}: {report:?}");
                differs.extend(output.apart.first().map(|_| report.function.clone()));
            }
        }
    }
    // The device is one that errs.
    for free in ["pinned", "freeRoot", "freeMix", "freeRatio"] {
        assert!(differs.iter().any(|name| name == free), "{free}: {differs:?}");
    }
}

#[test]
fn a_device_with_other_bits_where_they_are_fixed_is_told() {
    let nearest = nearest();
    let right = Adversary::lane(&nearest, Stage::Compute, Strategy::Random, 1, false);
    let wrong = right.with_fault(Fault { op: Op::Add, factor: 8.0 });
    let all = looked(FUNCTIONS, &nearest, &[&wrong]);
    let apart = |name: &str| &all.iter().find(|report| report.function == name).unwrap().outputs[0].apart;
    assert!(apart("fixedSum")[0].fixed > 500, "{:?}", apart("fixedSum"));
    assert!(apart("fixedHash").is_empty());
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.glsl"), format!("#version 450\n{FUNCTIONS}")).unwrap();
    folder
}

#[test]
fn what_a_filter_gives_is_said_to_be_open() {
    let folder = tempfile::tempdir().unwrap();
    let text = "#version 450\nuniform sampler2D t;\nvec4 look(vec2 uv) { return texture(t, uv); }\n\
                vec4 texel(ivec2 p) { return texelFetch(t, p & 3, 0); }\n";
    fs::write(folder.path().join("a.glsl"), text).unwrap();
    let of = |function: &str| {
        run_in(folder.path(), &format!("fuzz a.glsl --reproducible --lane embedded --function {function}"))
            .expect(0)
            .out
    };
    assert!(of("look").contains("of `t` one texel is taken for each sample"), "{}", of("look"));
    assert!(!of("texel").contains("one texel"), "{}", of("texel"));
}

#[test]
fn the_command_names_each_operation_and_gates() {
    let folder = folder();
    let of =
        |arguments: &str| run_in(folder.path(), &format!("fuzz a.glsl --reproducible --lane embedded {arguments}"));
    let all = of("").expect(1).out;
    assert!(all.contains("`a * b + c`: a product and a sum may be rounded once"), "{all}");
    assert!(all.contains("return    fixed if `precise`"), "{all}");
    assert!(all.contains("`sqrt(abs(x) + 1.0)`: `sqrt` is promised within an error"), "{all}");
    assert!(all.ends_with("10 outputs of 10 functions: 4 fixed, 2 fixed if `precise`, 4 free\n"), "{all}");
    let fixed = of("--function fixedHash --function fixedKept --format json").expect(0).json();
    let outputs = |at: usize| &fixed["functions"][at]["outputs"][0];
    assert_eq!((outputs(0)["standing"].as_str(), outputs(0)["places"].as_array().unwrap().len()), (Some("fixed"), 0));
    // Strict binary32 leaves nothing open.
    of("--profile binary32 --function freeMix").expect(0);
    assert!(of("--profile none").expect(2).err.contains("follows from what they promise"));
    assert!(of("--shard 1/2").expect(2).err.contains("--shard"));
    assert!(of("--function nothing").expect(2).err.contains("there is no function `nothing`"));
    let wrong = run_in(folder.path(), "fuzz a.glsl --profile binary32").expect(2).err;
    assert!(wrong.contains("--reproducible"), "{wrong}");
}

#[test]
fn two_functions_have_the_same_bits_or_the_reason_why_not() {
    let folder = folder();
    fs::write(
        folder.path().join("b.wgsl"),
        "fn fixedSum(x: f32, y: f32) -> f32 { return 0.5 + max(y, x); }\n\
         fn fixedHash(v: u32) -> u32 { var x = v; x ^= x >> 16u; x *= 0x7feb352du; x ^= x >> 15u; return x; }\n\
         fn pinned(a: f32, b: f32, c: f32) -> f32 { return c + b * a; }\n\
         fn ordered(a: f32, b: f32, c: f32) -> f32 { return a + (b + c); }\n",
    )
    .unwrap();
    let of = |function: &str| {
        run_in(
            folder.path(),
            &format!(
                "compare a.glsl b.wgsl --same-bits --lane embedded --samples 4096 --function {function} --format json"
            ),
        )
    };
    let bits = |report: &Value| {
        let own = &report["pairs"][0]["same_bits"][0];
        ["same", "other", "open"].map(|key| own[key].as_u64().unwrap())
    };
    assert_eq!(bits(&of("fixedHash").expect(0).json()), [3072, 0, 0]);
    assert_eq!(bits(&of("fixedSum").expect(0).json()), [3072, 0, 0]);
    let pinned = of("pinned").expect(1).json();
    let [_, other, open] = bits(&pinned);
    assert!(other == 0 && open > 0, "{pinned}");
    assert_eq!(pinned["pairs"][0]["same_bits"][0]["second"][0]["kind"], "contraction", "{pinned}");
    let ordered = of("ordered").expect(1).json();
    assert!(bits(&ordered)[1] > 0, "{ordered}");
    let text = run_in(folder.path(), "compare a.glsl b.wgsl --same-bits --lane embedded --samples 4096").expect(1).out;
    assert!(text.contains("same bits  `return`: the same on every conforming device in all 3072 samples"), "{text}");
    assert!(text.contains("second: b.wgsl:3:51 `c + b * a`: a product and a sum"), "{text}");
    // Without the option nothing is said of bits, and the functions mean the same.
    assert!(!run_in(folder.path(), "compare a.glsl b.wgsl --lane embedded").expect(0).out.contains("same bits  `"));
}
