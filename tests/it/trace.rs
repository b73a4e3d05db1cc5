//! `shadercheck trace`: the first expression that goes wrong is named, for each way in which one can; what is right has none.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;

use crate::binary::{Ran, command, root, run_in, run_reported};
use crate::fuzz::functions;
use engine::adversary::{Adversary, Fault, Strategy};
use engine::fuzz::Domain;
use engine::trace::{Case, Mark, Request, run};
use judge::profile::{Op, by_name};
use lanes::{Lane, Stage};

/// Functions that go wrong, each beside one that does not.
const FUNCTIONS: &str = "\
float facing(vec3 n, vec3 l) {
    vec3 m = normalize(n);
    return dot(m, l) + 1.0;
}
float near(float x) {
    float c = cos(x);
    float d = 1.0 - c;
    return d * 3.0;
}
float nearRight(float x) {
    float s = sin(0.5 * x);
    return 6.0 * s * s;
}
float moved(float x) {
    if (x + 1e-9 > x) {
        return x * 2.0;
    }
    return x / 3.0;
}
float large(float x) {
    float big = x * x;
    return sqrt(big);
}
float many(float x) {
    float sum = 0.0;
    for (int i = 0; i < 100; i++) {
        sum += x;
    }
    return sum;
}
float bits(uint x) {
    return uintBitsToFloat(x) * 2.0;
}
";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.glsl"), FUNCTIONS).unwrap();
    folder
}

fn traced(arguments: &str) -> Ran {
    run_in(folder().path(), &format!("trace a.glsl {arguments}"))
}

fn report(arguments: &str) -> Value {
    traced(&format!("{arguments} --format json")).expect(0).json()["traces"][0].clone()
}

/// The kind and the place of the origin.
fn origin(report: &Value) -> (String, String) {
    let part = |key: &str| report["origin"][key].as_str().unwrap_or_default().to_owned();
    (part("kind"), part("at"))
}

#[test]
fn each_way_to_go_wrong_has_its_origin() {
    for (arguments, kind, at) in [
        ("--function facing", "no_value", "a.glsl:2:14"),
        ("--function near --set x=0.0005", "loses_most", "a.glsl:7:15"),
        ("--function moved --set x=1", "parts", "a.glsl:15:9"),
        ("--function large --set x=1e30", "lost", "a.glsl:21:17"),
        ("--function bits --set x=2143289344", "no_value", "a.glsl:32:12"),
    ] {
        let report = report(arguments);
        assert_eq!(origin(&report), (kind.to_owned(), at.to_owned()), "{arguments}: {report}");
    }
}

#[test]
fn what_is_right_has_no_origin() {
    for arguments in [
        "--function facing --set n=0,0,2 --set l=0,0,1",
        "--function nearRight --set x=0.0005",
        "--function near --set x=1.5",
        "--function moved --set x=0",
        "--function large --set x=3",
        "--function bits --set x=1065353216",
    ] {
        let report = report(arguments);
        assert!(report["origin"].is_null(), "{arguments}: {}", report["origin"]);
    }
}

#[test]
fn without_a_name_functions_with_findings_are_traced_and_others_counted() {
    let whole = traced("--format json").expect(0).json();
    let names: Vec<&str> =
        whole["traces"].as_array().unwrap().iter().filter_map(|one| one["function"].as_str()).collect();
    assert!(names.contains(&"facing") && names.contains(&"near") && !names.contains(&"nearRight"), "{names:?}");
    let not: Vec<&str> = whole["not_traced"].as_array().unwrap().iter().filter_map(|one| one["why"].as_str()).collect();
    assert!(not.iter().all(|why| why.starts_with("nothing was found in ")) && not.len() + names.len() == 7, "{not:?}");
}

#[test]
fn the_reproduce_line_of_a_finding_is_traced() {
    let folder = folder();
    let found = run_in(folder.path(), "fuzz a.glsl --function facing --lane embedded").expect(0).out;
    let line = found.lines().find(|line| line.contains("reproduce")).unwrap();
    let case = line.split_once("--case '").unwrap().1.trim_end_matches('\'');
    let ran = command(folder.path(), "trace a.glsl --function facing --format json --case").arg(case).output().unwrap();
    let whole: Value = serde_json::from_slice(&ran.stdout).unwrap();
    assert_eq!(origin(&whole["traces"][0]).0, "no_value");
}

#[test]
fn options_that_a_reproduce_line_may_have_are_taken() {
    let folder = folder();
    let found =
        run_in(folder.path(), "fuzz a.glsl --function facing --lane embedded --arbitrary --strict-integers").out;
    let line = found.lines().find_map(|line| line.trim().strip_prefix("reproduce")).unwrap().trim();
    let ran = run_reported(folder.path(), &line.replacen(" fuzz ", " trace ", 1), &["--format", "json"]).expect(0);
    assert_eq!(ran.json()["traces"][0]["why"], "the inputs of --case", "{}", ran.out);
}

#[test]
fn what_an_endless_loop_leaves_out_is_no_number() {
    let folder = tempfile::tempdir().unwrap();
    let text = "float f(float x) { while (x < 1.0) { x = x * 1.0; } return x; }\n";
    fs::write(folder.path().join("a.glsl"), text).unwrap();
    let ran = run_in(folder.path(), "trace a.glsl --function f --set x=0.5").expect(0).out;
    assert!(ran.contains("return = not written") && ran.contains("a loop goes on for too long"), "{ran}");
    let ran = run_in(folder.path(), "trace a.glsl --function f --set x=2").expect(0).out;
    assert!(ran.contains("return = 2.0") && !ran.contains("too long"), "{ran}");
}

#[test]
fn rows_are_those_that_the_output_needs_and_long_loops_are_cut() {
    let own = traced("--function facing --set n=0,0,2 --set l=0,0,1").expect(0).out;
    assert!(own.contains("2:14  normalize(n)  .x") && own.contains("return = 2.0"), "{own}");
    let many = traced("--function many --set x=0.1").expect(0).out;
    assert!(
        many.contains("sum += x #1 ") && many.contains("sum += x #100 ") && !many.contains("sum += x #50 "),
        "{many}"
    );
    assert!(many.contains("note: 98 steps of loops left out; `--all` shows them"), "{many}");
    let all = traced("--function many --set x=0.1 --all").expect(0).out;
    assert!(all.contains("sum += x #50 ") && !all.contains("left out"), "{all}");
}

#[test]
fn a_lane_is_named_at_the_expression_where_it_is_wrong() {
    let subjects = functions("a.glsl", "float wave(float x) { float s = sin(x); return 0.5 * s + 1.0; }");
    let ready = subjects[0].ready.as_ref().ok().unwrap();
    let vulkan = by_name("vulkan-1.4").unwrap();
    let case = Case::hardest(&subjects[0], ready, &Domain::default(), (256, 1));
    let of = |lane: &dyn Lane| {
        let request = Request { lanes: &[lane], profile: vulkan, output: None };
        let traced = run(&subjects[0], ready, &case, &request).unwrap();
        let wrong = traced.steps.iter().find(|step| step.marks.iter().any(|mark| matches!(mark, Mark::Lane(_))));
        wrong.map(|step| step.place.as_ref().unwrap().text.clone())
    };
    let right = Adversary::lane(vulkan, Stage::Compute, Strategy::Extreme, 1, false);
    assert_eq!(of(&right), None);
    assert_eq!(of(&right.with_fault(Fault { op: Op::Sin, factor: 2.0 })).as_deref(), Some("sin(x)"));
}

#[test]
fn a_geometry_stage_and_a_kernel_are_traced() {
    let ran = run_in(&root().join("shaders/hair"), "trace hair.geom").expect(0).out;
    assert!(ran.contains("origin     `normalize(") && ran.contains("EmitVertex: "), "{ran}");
    let folder = tempfile::tempdir().unwrap();
    let kernel = "@group(0) @binding(0) var<storage, read_write> o: array<f32>;\n\
                  @compute @workgroup_size(8) fn main(@builtin(global_invocation_id) id: vec3u) {\n\
                  o[id.x] = 1.0 / (o[id.x] - 1.0);\n}\n";
    fs::write(folder.path().join("a.wgsl"), kernel).unwrap();
    let ran = run_in(folder.path(), "trace a.wgsl --function main").expect(0).out;
    assert!(ran.contains("origin     `1.0 / (o[id.x] - 1.0)` at a.wgsl:3:11"), "{ran}");
    // A call in WGSL is told as a whole.
    let text = "fn facing(a: vec3f, b: vec3f) -> vec3f { return normalize(cross(a, b)); }\n";
    fs::write(folder.path().join("b.wgsl"), text).unwrap();
    let ran = run_in(folder.path(), "trace b.wgsl --set a=1,0,0 --set b=2,0,0 --function facing").expect(0).out;
    assert!(
        ran.contains("origin     `normalize(cross(a, b))` at b.wgsl:1:49: `normalize(cross(a, b))` of a zero"),
        "{ran}"
    );
}

#[test]
fn what_is_wrong_with_the_arguments_is_told() {
    for (arguments, told) in [
        ("--function facing --set n=0,0,1", "input `l` has no value; each of these needs one: n, l"),
        ("--function facing --set n=0,0 --set l=0,0,1", "input `n` (vec3) has 3 numbers, not 2"),
        ("--function facing --set n=0,0,x --set l=0,0,1", "--set `n=0,0,x`: `x` is no number"),
        ("--function near --set y=1", "the function has no input `y`; it has: x"),
        ("--function near --set x=1 --set x=2", "input `x` is given twice"),
        ("--function near --set x", "give INPUT=NUMBERS"),
        ("--function near --set x=1 --case x=3f800000", "give one of them"),
        ("--function near --set x=1 --output r", "there is no output `r`; it has: return"),
        ("--function near --set x=1 --profile none", "a trace needs bounds"),
        ("--function nearest", "did you mean `near`?"),
        ("--function near --set x=1 --lane nosuch", "nosuch"),
        ("--case x=00000000", "--function"),
    ] {
        let ran = traced(arguments).expect(2);
        assert!(ran.err.contains(told), "{arguments}: {}", ran.err);
    }
}
