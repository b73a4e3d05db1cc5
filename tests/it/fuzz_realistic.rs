//! What `fuzz` takes for realistic: faults that programs meet are errors, those that take an input which nobody stated
//! are warnings, and what is right is silent.

use std::fs;

use engine::fuzz::{FunctionReport, FuzzFindingKind, Part, Severity};
use judge::profile::Promises;
use lanes::{Api, embedded};

use crate::binary::run_in;
use crate::fuzz::{functions, on, only};

/// The report of `main` of a stage.
fn main_of(name: &str, text: &str) -> FunctionReport {
    let all = functions(name, text);
    let main = all.iter().find(|subject| subject.label == "main").unwrap();
    let report = on(main, "", &*embedded::open().unwrap(), Promises::of_api(Api::Binary32));
    assert_eq!(report.not_run, None);
    report
}

#[track_caller]
fn is_error(report: &FunctionReport) {
    let found = report.of(Severity::Finding).next().unwrap_or_else(|| panic!("{:?}", report.findings));
    assert_eq!(found.part, Part::Realistic, "{found:?}");
    assert!(found.counting > 0 && found.reproduce.is_some());
}

#[track_caller]
fn is_warning(report: &FunctionReport, kinds: &[FuzzFindingKind]) {
    assert!(!report.fails(), "{:?}", report.findings);
    let found = report.of(Severity::Warning).find(|f| kinds.contains(&f.kind));
    let found = found.unwrap_or_else(|| panic!("{:?}", report.findings));
    assert_eq!((found.part, found.counting), (Part::Arbitrary, 0), "{found:?}");
}

#[track_caller]
fn is_silent(report: &FunctionReport) {
    let told: Vec<_> = report.findings.iter().filter(|f| f.severity != Severity::Note).collect();
    assert!(told.is_empty(), "{told:?}");
}

const MISSING: [FuzzFindingKind; 2] = [FuzzFindingKind::NoValue, FuzzFindingKind::Infinite];

#[test]
fn a_fault_at_realistic_inputs_is_an_error() {
    // A surface that faces up; a texel without colour; a highlight behind the surface.
    is_error(&only("vec3 tangent(vec3 normal) { return normalize(cross(normal, vec3(0.0, 1.0, 0.0))); }", ""));
    is_error(&only("vec3 straight(vec4 color) { return color.rgb / color.a; }", ""));
    is_error(&only(
        "float spot(vec3 reflectDir, vec3 viewDir, float shininess) { return pow(dot(reflectDir, viewDir), shininess); }",
        "",
    ));
}

/// A stage that calls a function with `argument`, of two numbers `v` from the stage before.
fn called(function: &str, argument: &str) -> FunctionReport {
    let text = format!("in vec2 v;\nout vec4 c;\n{function}\nvoid main() {{ c = vec4(f({argument})); }}\n");
    let all = functions("a.frag", &text);
    on(&all[0], "", &*embedded::open().unwrap(), Promises::of_api(Api::Binary32))
}

/// How large a texture is, its host knows, unless the text asks for it.
#[test]
fn a_texel_at_a_fixed_place_is_no_fault() {
    let of = |at: &str| {
        let text = format!("uniform sampler2D data;\nout vec4 c;\nvoid main() {{ c = texelFetch(data, {at}, 0); }}\n");
        main_of("a.frag", &text)
    };
    is_silent(&of("ivec2(100, 0)"));
    is_error(&of("textureSize(data, 0)"));
}

/// What a stage passes to its own functions is what these are tried with.
#[test]
fn a_function_is_run_on_what_its_callers_pass() {
    let asked = "float f(float q) { return sqrt(1.0 - q * q); }";
    is_silent(&called(asked, "clamp(v.x, -1.0, 1.0)"));
    is_silent(&called(asked, "normalize(v).x"));
    is_warning_at_realistic(&called(asked, "v.x"));
    is_warning_at_realistic(&called(asked, "v.x > 0.0 ? 0.5 : 1.5"));
    let far = "float f(float q) { return sqrt(25.0 - q * q); }";
    is_silent(&called(far, "clamp(v.x, 0.0, 4.0)"));
    is_warning_at_realistic(&called(far, "clamp(v.x, 0.0, 30.0)"));
}

#[track_caller]
fn is_warning_at_realistic(report: &FunctionReport) {
    let found = report.of(Severity::Finding).chain(report.of(Severity::Warning)).find(|f| f.part == Part::Realistic);
    assert!(found.is_some(), "{:?}", report.findings);
}

#[test]
fn what_takes_an_input_that_nobody_stated_is_a_warning() {
    is_warning(&only("vec3 turned(vec3 v) { return normalize(v); }", ""), &MISSING);
    is_warning(&only("vec3 to(vec3 lightPos, vec3 fragPos) { return normalize(lightPos - fragPos); }", ""), &MISSING);
    is_warning(&only("float part(float a, float b) { return a / (a + b); }", ""), &MISSING);
    is_warning(
        &only("vec3 half_way(vec3 lightDir, vec3 viewDir) { return normalize(lightDir + viewDir); }", ""),
        &MISSING,
    );
}

/// Values that were taken since nobody stated any, and that are right elsewhere: random numbers between 0 and 1, a size that is
/// never 0.
#[test]
fn what_needs_a_guess_is_a_warning_and_what_no_value_mends_is_an_error() {
    let told = |text: &str| {
        let report = only(text, "");
        assert!(!report.fails(), "{:?}", report.findings);
        let found = report.of(Severity::Warning).find(|f| MISSING.contains(&f.kind) && f.part == Part::Realistic);
        assert!(found.is_some(), "{:?}", report.findings);
    };
    told("vec2 disc(float u1, float u2) { return sqrt(1.0 - u1 * u1) * vec2(cos(u2), sin(u2)); }");
    told("float part(float vanillaDiffuse, vec3 albedo) { return albedo.x * 4.0 / vanillaDiffuse; }");
    // Four numbers in one word, and a temperature.
    told("vec4 unpacked(uint data) { vec4 v = unpackUnorm4x8(data); return v / v.y; }");
    told("float planck(float t) { return 1.0 / exp(-400.0 / t); }");
    is_silent(&only(
        "float held(uint data) { return 1.0 / (1.0 + uintBitsToFloat(data) * uintBitsToFloat(data)); }",
        "",
    ));
    is_error(&only("float never(float u) { return sqrt(-1.0 - u * u); }", ""));
    is_error(&only("vec3 straight(vec4 color, float u) { return u * color.rgb / color.a; }", ""));
    assert!(only("vec2 disc(float u1) { return vec2(sqrt(1.0 - u1 * u1), u1); }", "u1=[-2,2]").fails());
}

#[test]
fn a_variable_that_starts_with_an_input_has_its_value_in_each_function() {
    let text = "uniform vec3 size;\nvec3 iResolution = vec3(size.xy, 1.0);\nfloat aspect = iResolution.x / iResolution.y;\n\
                in vec2 uv;\nout vec4 color;\nfloat of(vec2 p) { return p.x * aspect; }\nvoid main() { color = vec4(of(uv)); }\n";
    let all = functions("a.frag", text);
    let of = all.iter().find(|subject| subject.label == "of").unwrap();
    let report = on(of, "size=[64,2048]", &*embedded::open().unwrap(), Promises::of_api(Api::Binary32));
    assert_eq!(report.not_run, None);
    is_silent(&report);
}

#[test]
fn what_is_right_is_silent() {
    is_silent(&only("vec3 turned(vec3 v) { return v / max(length(v), 0.0001); }", "v=[-8,8]"));
    is_silent(&only(
        "vec3 straight(vec4 color) { return color.a > 0.0 ? clamp(color.rgb / color.a, 0.0, 1.0) : vec3(0.0); }",
        "color=[0,1]",
    ));
    is_silent(&only("vec3 lit(vec3 color, float ndotl) { return color * max(ndotl, 0.0); }", ""));
}

#[test]
fn colours_and_shares_are_no_negative_numbers_unless_that_is_stated() {
    let text = "vec3 linear(vec3 color) { return pow(color, vec3(2.2)); }";
    is_silent(&only(text, ""));
    assert!(only(text, "color=[-1,1]").fails());
    is_silent(&only("float shade(float roughness) { return sqrt(1.0 - roughness); }", ""));
    // Within [0, 1] nothing is left out, and other inputs are of any size.
    assert!(only("vec3 straight(vec3 color, float alpha) { return color / alpha; }", "").fails());
    let curve = only("float curve(float height) { return pow(height - 1.0, 2.2); }", "");
    assert!(curve.of(Severity::Warning).any(|f| f.part == Part::Realistic), "{:?}", curve.findings);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.glsl"), "vec3 over(vec3 color, float size) { return color / size; }\n").unwrap();
    let told = run_in(folder.path(), "fuzz a.glsl --samples 2048 --lane embedded").expect(0);
    assert!(told.out.contains("note: in [0, 1], as names say: `color`; `--domain`"), "{}", told.out);
    let stated = run_in(folder.path(), "fuzz a.glsl --samples 2048 --lane embedded --domain color=[0,2]").expect(0);
    assert!(!stated.out.contains("as names say"), "{}", stated.out);
}

#[test]
fn the_angle_of_no_vector_is_a_warning() {
    is_warning(&only("float angle(vec2 p) { return atan(p.y, p.x); }", ""), &[FuzzFindingKind::Undefined]);
    is_silent(&only("float angle(vec2 p) { return p.x == 0.0 ? 0.0 : atan(p.y, p.x); }", ""));
}

#[test]
fn the_first_line_names_what_the_author_wrote() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.glsl"), "vec3 turned(vec3 v) { return normalize(v); }\n").unwrap();
    let told = run_in(folder.path(), "fuzz a.glsl --samples 2048 --lane embedded").expect(0).out;
    assert!(told.contains("turned: `normalize` where it has no finite value"), "{told}");
    assert!(told.contains("`normalize(v)` of a zero vector"), "{told}");
}

#[test]
fn a_better_formula_is_named_only_where_there_is_one() {
    let folder = tempfile::tempdir().unwrap();
    let text = "// shadercheck: x in [1, 1e7]\nfloat rise(float x) { return sqrt(x + 1.0) - sqrt(x); }\n\
                // shadercheck: p in [0, 100]\nfloat hash(vec2 p) { return fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453); }\n";
    fs::write(folder.path().join("a.glsl"), text).unwrap();
    let told = run_in(folder.path(), "fuzz a.glsl --samples 2048 --lane embedded").out;
    let of = |function: &str| told.split("\n\n").find(|one| one.contains(&format!("{function}: ill-"))).unwrap_or("");
    assert!(of("rise").contains("improve    shadercheck improve a.glsl:2 writes `1.0 / (sqrt("), "{told}");
    assert!(!of("hash").is_empty() && !of("hash").contains("improve  "), "{told}");
}

#[test]
fn half_floats_and_wgsl_are_told_in_their_own_words() {
    let folder = tempfile::tempdir().unwrap();
    let text = "enable f16;\n// shadercheck: x in [300, 400]\nfn square(x: f16) -> f16 { return x * x; }\n";
    fs::write(folder.path().join("a.wgsl"), text).unwrap();
    let told = run_in(folder.path(), "fuzz a.wgsl --samples 256 --lane embedded").out;
    assert!(told.contains("is too large for binary16") && told.contains("binary16 gives inf"), "{told}");
    let sum = "fn error_of(a: f32, b: f32) -> f32 { let s = a + b; return b - (s - a); }\n";
    fs::write(folder.path().join("b.wgsl"), sum).unwrap();
    let told = run_in(folder.path(), "fuzz b.wgsl --samples 2048 --lane embedded --notes").out;
    assert!(!told.contains("precise"), "{told}");
}

#[test]
fn a_stated_input_or_an_arbitrary_run_makes_it_an_error() {
    assert!(only("vec3 turned(vec3 v) { return normalize(v); }", "v=[-1,1]").fails());
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.glsl"), "vec3 turned(vec3 v) { return normalize(v); }\n").unwrap();
    let run = |more: &str| run_in(folder.path(), &format!("fuzz a.glsl --samples 2048 --lane embedded {more}"));
    let told = run("").expect(0);
    assert!(told.out.contains("warning: turned: ") && told.out.contains("at arbitrary inputs"), "{}", told.out);
    assert!(told.out.contains("(taken for any number)"), "{}", told.out);
    let arbitrary = run("--arbitrary").expect(1);
    assert!(arbitrary.out.contains("--arbitrary --lane embedded --function turned"), "{}", arbitrary.out);
    let json = run("--format json").expect(0).json();
    let function = &json["files"][0]["functions"][0];
    assert_eq!(function["inputs"][0]["taken_for"], "any number");
    assert_eq!((function["samples"].as_u64(), function["arbitrary"].as_u64()), (Some(2048), Some(512)));
    let warning = function["findings"].as_array().unwrap().iter().find(|f| f["severity"] == "warning").unwrap();
    assert_eq!(warning["part"], "arbitrary");
    // Who gives the case states its inputs.
    let command = warning["reproduce"].as_str().unwrap();
    assert!(
        crate::binary::run_reported(folder.path(), command, &[])
            .expect(1)
            .out
            .contains(warning["message"].as_str().unwrap())
    );
}

#[test]
fn one_cause_at_many_places_is_one_warning_of_ten_lines() {
    let folder = tempfile::tempdir().unwrap();
    let text: String = (0..9).map(|k| format!("float f{k}(float a, float b) {{ return {k}.5 * a / b; }}\n")).collect();
    fs::write(folder.path().join("a.glsl"), text).unwrap();
    let out = run_in(folder.path(), "fuzz a.glsl --samples 2048 --lane embedded").expect(0).out;
    let blocks: Vec<&str> = out.split("\n\n").filter(|block| block.starts_with("warning: ")).collect();
    let cause = blocks.iter().find(|block| block.contains("a division by 0")).unwrap_or_else(|| panic!("{out}"));
    assert!(cause.starts_with("warning: f0 and 8 more: a division by 0"), "{cause}");
    assert!(blocks.iter().all(|block| block.trim_end().lines().count() <= 10), "{out}");
}

/// Inputs of a fragment shader as the vertex stage gives them: shorter than 1, and never 0.
#[test]
fn what_is_interpolated_is_no_longer_of_length_one() {
    let text = "in vec3 normal;\nout vec4 color;\nvoid main() { float l = length(normal); \
                color = vec4(l > 0.4 && l < 0.99 ? log(0.98 - l) : 1.0); }\n";
    is_error(&main_of("a.frag", text));
    let text = "in vec3 normal;\nout vec4 color;\nvoid main() { float l = length(normal); \
                color = vec4(1.0 / (l - 0.4), sqrt(1.001 - l), 0.0, 1.0); }\n";
    is_warning(&main_of("a.frag", text), &[FuzzFindingKind::NoValue, FuzzFindingKind::Infinite]);
}

#[test]
fn a_normal_matrix_belongs_to_its_model_matrix() {
    let of = |normal: &str, compared: &str| {
        let text = format!(
            "layout(location = 0) in vec3 p;\nuniform mat4 model;\nuniform mat3 {normal};\nout float gap;\n\
             void main() {{ mat3 d = transpose({normal}) * mat3(model) - mat3(1.0);\n\
             gap = dot(d[0], d[0]) + dot(d[1], d[1]) + dot(d[2], d[2]) < 0.0001 ? {compared}; gl_Position = vec4(p, 1.0); }}\n"
        );
        main_of("a.vert", &text)
    };
    // The gap is 0 in every realistic sample, and another matrix has one.
    let broken = |report: &FunctionReport| report.of(Severity::Finding).any(|f| f.kind == FuzzFindingKind::NoValue);
    assert!(!broken(&of("normalMatrix", "1.0 : sqrt(-1.0 - p.x * p.x)")));
    assert!(broken(&of("other", "1.0 : sqrt(-1.0 - p.x * p.x)")));
}

#[test]
fn a_function_that_no_lane_ran_is_not_called_ok() {
    let mut report = only("float twice(float x) { return 2.0 * x; }", "");
    assert!(report.ran() && report::fuzz::line(&report, false).starts_with("ok "));
    report.lanes.iter_mut().for_each(|lane| lane.not_run = Some("not supported".to_owned()));
    assert!(!report.ran() && report::fuzz::line(&report, false).starts_with("-- "));
}
