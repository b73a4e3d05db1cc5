//! Numbers of binary16 in kernels and functions of WGSL: their meaning, their bounds, and a device that errs as far as it may.

use std::fs;
use std::path::Path;

use engine::adversary::{Adversary, Strategy};
use engine::suite::load_all;
use engine::suite::run::prepare;
use judge::profile::{self, Promises};
use lanes::Stage;

use crate::binary::run_in;
use crate::large_dispatches::judged;

/// Products of rows with a vector: halves in memory, the sum in `T`, and what is multiplied with each product.
fn kernel(ty: &str, factor: &str) -> String {
    format!(
        "enable f16;
@group(0) @binding(0) var<storage, read> rows: array<f16>;
@group(0) @binding(1) var<storage, read> weights: array<f16>;
@group(0) @binding(2) var<storage, read_write> products: array<f16>;
@compute @workgroup_size(32)
fn main(@builtin(global_invocation_id) id: vec3u) {{
    let n = arrayLength(&weights);
    if (id.x >= arrayLength(&products)) {{ return; }}
    var sum = {ty}(0.0);
    for (var k = 0u; k < n; k++) {{
        sum += {ty}(rows[id.x * n + k]) * {ty}(weights[k]) * {ty}({factor});
    }}
    products[id.x] = f16(sum);
}}
"
    )
}

const SUITE: &str = "suite = \"halves\"\nshader = \"halves.wgsl\"\nstage = \"compute\"\nsamples = 8\n\
    reference = { file = \"reference.wgsl\", groups = \"(ROWS + 31) / 32\" }\n[dispatch]\ngroups = \"(ROWS + 31) / 32\"\n\
    lengths = { rows = \"ROWS * N\", weights = \"N\", products = \"ROWS\" }\nsizes = { ROWS = [3, 200], N = [2, 5] }\n\
    [[inputs]]\nnames = [\"rows\"]\ngenerator = \"array\"\nrange = [0.5, 2.0]\n\
    [[inputs]]\nnames = [\"weights\"]\ngenerator = \"array\"\nrange = [0.5, 1.0]\n";

fn written(folder: &Path, shader: &str) {
    fs::write(folder.join("halves.suite.toml"), SUITE).unwrap();
    fs::write(folder.join("reference.wgsl"), kernel("f32", "1.0")).unwrap();
    fs::write(folder.join("halves.wgsl"), shader).unwrap();
}

#[test]
fn products_of_halves_are_judged_against_real_numbers() {
    let folder = tempfile::tempdir().unwrap();
    for (ty, factor, status) in [("f16", "1.0", 0), ("f32", "1.0", 0), ("f32", "1.01", 1), ("f16", "1.25", 1)] {
        written(folder.path(), &kernel(ty, factor));
        let ran = run_in(folder.path(), "check halves.suite.toml --lane embedded").expect(status);
        assert!(ran.out.contains("embedded"), "{}", ran.out);
        let reported = ran.out.contains("the shader deviates from its reference: `products[");
        assert_eq!(reported, status == 1, "{ty} {factor}\n{}", ran.out);
        assert!(status == 1 || ran.out.contains(" 0 undetermined"), "{ty} {factor}\n{}", ran.out);
    }
}

/// The same in GLSL: a sum that leaves binary16 is told, and one with a `float` for the sum is not.
#[test]
fn sums_of_halves_in_glsl_are_judged_against_real_numbers() {
    let kernel = |ty: &str| {
        format!(
            "#version 450
#extension GL_EXT_shader_16bit_storage : require
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
layout(local_size_x = 32) in;
layout(std430, binding = 0) readonly buffer Rows {{ float16_t rows[]; }};
layout(std430, binding = 1) writeonly buffer Sums {{ float sums[]; }};
void main() {{
    uint id = gl_GlobalInvocationID.x;
    if (id >= sums.length()) {{ return; }}
    uint n = rows.length() / sums.length();
    {ty} sum = {ty}(0.0);
    for (uint k = 0u; k < n; k++) {{ sum += {ty}(rows[id * n + k]); }}
    sums[id] = float(sum);
}}
"
        )
    };
    let suite = |range: &str| {
        format!(
            "suite = \"sums\"\nshader = \"sums.comp\"\nstage = \"compute\"\nsamples = 8\n\
             reference = {{ file = \"reference.comp\", groups = \"(ROWS + 31) / 32\" }}\n[dispatch]\n\
             groups = \"(ROWS + 31) / 32\"\nlengths = {{ rows = \"ROWS * N\", sums = \"ROWS\" }}\n\
             sizes = {{ ROWS = [3], N = [8] }}\n[[inputs]]\nnames = [\"rows\"]\ngenerator = \"array\"\nrange = {range}\n"
        )
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("reference.comp"), kernel("float")).unwrap();
    // 8 numbers above 10,000 do not fit 65504.
    for (ty, range, status) in
        [("float16_t", "[10000.0, 20000.0]", 1), ("float", "[10000.0, 20000.0]", 0), ("float16_t", "[0.5, 1.0]", 0)]
    {
        fs::write(folder.path().join("sums.comp"), kernel(ty)).unwrap();
        fs::write(folder.path().join("sums.suite.toml"), suite(range)).unwrap();
        let ran = run_in(folder.path(), "check sums.suite.toml --lane embedded").expect(status);
        assert!(ran.out.contains("embedded"), "{}", ran.out);
        // Nothing is judged where the sum may be infinite on a device, which fails as well.
        assert_eq!(ran.out.contains("ill-conditioned"), status == 1, "{ty} {range}\n{}", ran.out);
    }
}

/// Bounds hold for a device that rounds to either neighbour and takes small numbers for 0.
#[test]
fn a_device_that_errs_as_far_as_it_may_is_not_accused() {
    let folder = tempfile::tempdir().unwrap();
    let functions = "enable f16;
        fn gelu(x: f16) -> f16 { return 0.5h * x * (1.0h + tanh(0.797h * (x + 0.0447h * x * x * x))); }
        fn soft(a: f16, b: f16) -> f16 { return exp(a - max(a, b)) / (exp(a - max(a, b)) + exp(b - max(a, b))); }
        fn unit(v: vec3<f16>) -> vec3<f16> { return v * inverseSqrt(dot(v, v) + 0.01h); }
        fn root(x: f16) -> f16 { return sqrt(abs(x)) + pow(abs(x) + 0.5h, 1.5h) + log2(abs(x) + 1.0h); }\n";
    let wgsl = profile::by_name("wgsl").unwrap();
    let promises = Promises { text: wgsl, conformance: None, measured: None };
    fs::write(folder.path().join("f.wgsl"), functions).unwrap();
    for (function, inputs, generator) in
        [("gelu", "x", "interval"), ("soft", "a, b", "interval"), ("unit", "v", "vector"), ("root", "x", "interval")]
    {
        let names: Vec<String> = inputs.split(", ").map(|name| format!("{name:?}")).collect();
        let suite = format!(
            "suite = \"f\"\nshader = \"f.wgsl\"\nstage = \"function\"\nentry = \"{function}\"\nsamples = 4096\n\
             reference = {{ file = \"f.wgsl\", function = \"{function}\" }}\n[[inputs]]\nnames = [{}]\ngenerator = \"{generator}\"\nrange = [-4.0, 4.0]\n",
            names.join(", ")
        );
        fs::write(folder.path().join("f.suite.toml"), suite).unwrap();
        let loaded = load_all(&folder.path().join("f.suite.toml")).unwrap().remove(0);
        let prepared = prepare(&loaded.suite.variants()[0], &loaded.shader).unwrap();
        for seed in 1..5 {
            let lane = Adversary::lane(wgsl, Stage::Compute, Strategy::Extreme, seed, false);
            let report = judged(&prepared, &lane, promises.clone(), 4096);
            assert_eq!(report.verdicts.deviated, 0, "{function}: {:?}", report.findings);
            assert!(report.verdicts.agreed > 1000, "{function}: {:?}", report.verdicts);
        }
    }
}

#[test]
fn lanes_of_devices_say_that_they_do_not_run_halves() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), &kernel("f16", "1.0"));
    let ran = run_in(folder.path(), "check halves.suite.toml --lane vulkan");
    assert!(ran.out.contains("16-bit floats, which the embedded lane alone runs"), "{}", ran.out);
}
