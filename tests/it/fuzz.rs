//! `shadercheck fuzz`: planted faults, each found and blamed on what it is; functions of all shapes; and
//! the command.

use std::fs;

use base::text::SourceFile;
use base::value::Batch;
use engine::adversary::{Adversary, Fault, Strategy};
use engine::fuzz::{
    Domain, Finding, FunctionReport, FuzzFindingKind, Request, Severity, Subject, option, run, subjects,
};
use judge::profile::{Op, Promises, by_name};
use judge::verdict::Reason;
use judge::verdict::diagnosis::Origin;
use lanes::{Actual, Api, Description, Lane, LaneError, Runner, embedded};
use program::Kernel;
use syntax::{Shader, Stage};

use crate::binary::{run_in, run_reported};

fn request() -> Request {
    Request {
        strict_integers: false,
        samples: 4096,
        seed: 1,
        case: None,
        notes: true,
        arbitrary: false,
        first_lane: false,
        command: "shadercheck fuzz a.glsl".to_owned(),
    }
}

pub fn functions(name: &str, text: &str) -> Vec<Subject> {
    let stage = Stage::from_path(name).unwrap();
    let parsed = Shader::parse(&SourceFile::new(name, format!("#version 450\n{text}")), stage);
    assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
    let subjects = subjects(&parsed.shader, &|_| true).unwrap();
    assert!(!subjects.is_empty(), "no function in {text}");
    subjects
}

pub fn on(subject: &Subject, domain: &str, lane: &dyn Lane, promises: Promises) -> FunctionReport {
    on_lanes(subject, domain, &[(lane, promises)])
}

pub fn on_lanes(subject: &Subject, domain: &str, lanes: &[(&dyn Lane, Promises)]) -> FunctionReport {
    requested(subject, domain, lanes, &request())
}

fn requested(subject: &Subject, domain: &str, lanes: &[(&dyn Lane, Promises)], request: &Request) -> FunctionReport {
    let mut stated = option(domain).unwrap();
    stated.extend(subject.stated.clone());
    let domain = match &subject.ready {
        Ok(ready) => Domain::new(&subject.label, ready.kernel.invocation.fields(), ready.kernel.case.fields(), &stated),
        Err(_) => Domain::default(),
    };
    run(subject, &domain, lanes, request).unwrap()
}

fn strict(subject: &Subject, domain: &str) -> FunctionReport {
    on(subject, domain, &*embedded::open().unwrap(), Promises::of_api(Api::Binary32))
}

/// With all inputs alike.
fn arbitrary(subject: &Subject) -> FunctionReport {
    let request = Request { arbitrary: true, ..request() };
    requested(subject, "", &[(&*embedded::open().unwrap(), Promises::of_api(Api::Binary32))], &request)
}

/// The report of the only function of a library.
#[track_caller]
pub fn only(text: &str, domain: &str) -> FunctionReport {
    let all = functions("a.glsl", text);
    assert_eq!(all.len(), 1);
    let report = strict(&all[0], domain);
    assert_eq!(report.not_run, None);
    report
}

fn kinds(report: &FunctionReport, severity: Severity) -> Vec<FuzzFindingKind> {
    report.of(severity).map(|f| f.kind).collect()
}

fn values(finding: &Finding) -> Vec<String> {
    finding.inputs.iter().map(|input| format!("{} = {}", input.name, input.decimal.join(", "))).collect()
}

#[test]
fn a_division_that_has_no_value_is_found_at_its_smallest() {
    let report = arbitrary(&functions("a.glsl", "float part(float a, float b) { return a / (a + b); }")[0]);
    let none = report.findings.iter().find(|f| f.kind == FuzzFindingKind::NoValue).unwrap();
    assert_eq!(none.severity, Severity::Finding);
    assert_eq!(none.message, "`return` has no value: 0.0 / 0.0 has none");
    let place = none.place.as_ref().unwrap();
    assert_eq!((&*place.at.to_string(), &*place.text, &place.expansion), ("a.glsl:2:39", "a / (a + b)", &None));
    assert_eq!(values(none), ["float a = 0.0", "float b = 0.0"]);
    let infinite = report.findings.iter().find(|f| f.kind == FuzzFindingKind::Infinite).unwrap();
    assert_eq!(values(infinite), ["float a = -1.0", "float b = 1.0"]);
    // Inputs that never come are left out.
    assert!(!only("float part(float a, float b) { return a / (a + b); }", "a=(0,1];b=(0,1]").fails());
}

#[test]
fn what_a_function_leaves_unset_when_it_says_no_is_no_fault() {
    let text = |says: &str| {
        format!(
            "bool ray(float a, out float t) {{ float u; if (a < 0.5) {{ t = u; return {says}; }} t = a; return true; }}"
        )
    };
    let right = only(&text("false"), "a=[0,1]");
    assert!(right.findings.is_empty(), "{:?}", right.findings);
    let wrong = only(&text("true"), "a=[0,1]");
    assert_eq!(kinds(&wrong, Severity::Finding), [FuzzFindingKind::Unset]);
}

#[test]
fn weights_that_all_vanish_are_an_underflow() {
    let text = "float first(vec2 d) { vec2 w = exp(-d * d); return w.x / (w.x + w.y); }";
    let report = only(text, "d=[-20,20]");
    let found: Vec<&Finding> = report.of(Severity::Finding).collect();
    assert!(found.iter().any(|f| f.kind == FuzzFindingKind::Underflow), "{:?}", report.findings);
    assert!(found.iter().all(|f| f.kind == FuzzFindingKind::Underflow), "{:?}", report.findings);
    assert_eq!(found[0].place.as_ref().unwrap().text, "exp(-d * d)");
    assert!(!only(text, "d=[-4,4]").fails());
}

#[test]
fn an_overflow_that_only_huge_inputs_bring_about_is_a_note() {
    let text = "float far(float a) { return sqrt(a * a); }";
    let report = only(text, "");
    assert!(!report.fails(), "{:?}", report.findings);
    assert!(kinds(&report, Severity::Note).contains(&FuzzFindingKind::Overflow), "{:?}", report.findings);
    let report = only(text, "a=[1e20,1e21]");
    assert_eq!(kinds(&report, Severity::Finding), [FuzzFindingKind::Overflow]);
    assert_eq!(report.findings[0].place.as_ref().unwrap().text, "a * a");
}

#[test]
fn signed_integers_that_wrap_are_a_note_unless_they_are_asked_for() {
    let text = "int hash(int n) { return n * 15731 + 789221; }";
    let subject = &functions("a.glsl", text)[0];
    let severities = |strict_integers: bool| {
        let request = Request { strict_integers, ..request() };
        let lane = embedded::open().unwrap();
        let report = requested(subject, "n=[0,1000000]", &[(&*lane, Promises::of_api(Api::Binary32))], &request);
        let wraps = |f: &&Finding| f.kind == FuzzFindingKind::IntegerOverflow;
        (report.fails(), report.findings.iter().filter(wraps).map(|f| f.severity).collect::<Vec<_>>())
    };
    let (fails, found) = severities(false);
    assert!(!fails && !found.is_empty() && found.iter().all(|s| *s == Severity::Note), "{found:?}");
    let (fails, found) = severities(true);
    assert!(fails && found.iter().all(|s| *s == Severity::Finding), "{found:?}");
}

#[test]
fn catastrophic_cancellation_is_named_with_its_condition() {
    let report = only("float versine(float x) { return 1.0 - cos(x); }", "x=[0.0001,1]");
    assert_eq!(kinds(&report, Severity::Warning), [FuzzFindingKind::IllConditioned]);
    let found = &report.findings[0];
    assert_eq!(found.place.as_ref().unwrap().text, "1.0 - cos(x)");
    assert!(found.condition.unwrap() > 1e3, "{:?}", found.condition);
    let (error, worst) = found.worst.as_ref().unwrap();
    let x: f64 = worst[0].decimal[0].parse().unwrap();
    assert!(*error > 0.5 && x < 1e-3, "{error} at {x}");
    assert!(!report.fails());
}

#[test]
fn a_function_that_is_right_has_no_findings() {
    let report = only("float smoothed(float t) { float c = clamp(t, 0.0, 1.0); return c * c * (3.0 - 2.0 * c); }", "");
    assert!(report.findings.is_empty(), "{:?}", report.findings);
    assert_eq!(report.samples, 4096);
    let verdicts = &report.lanes[0].verdicts;
    let second = &report.lanes[0].arbitrary;
    assert!(verdicts.agreed + second.agreed > 3900 && verdicts.deviated + second.deviated == 0, "{verdicts:?}");
    assert_eq!(report.arbitrary, 1024);
}

#[test]
fn what_overflows_on_the_way_is_not_held_against_a_lane() {
    let text = "float product(vec2 a) { return a.x * a.y; }\nvec2 between(vec2 a, vec2 b) { return mix(a, b, 0.5); }\n\
                float part(vec3 a, vec3 b) { float l = dot(b, b); vec3 c = a; if (l > 0.0) c -= b * clamp(dot(a, b) / l, 0.0, 1.0); return length(c); }\n\
                float lit(vec3 n, vec3 l) { return max(dot(n, normalize(l)), 0.0); }\n\
                float turned(vec3 v, float k) { return (v.x * v.y) * v.z + k * (2.0 * v.x); }\n";
    let vulkan = || Promises::of_api(Api::Vulkan);
    let device = Adversary::lane(by_name("vulkan-1.4").unwrap(), lanes::Stage::Compute, Strategy::Extreme, 5, true);
    for subject in functions("a.glsl", text) {
        for lane in [&*embedded::open().unwrap(), &device as &dyn Lane] {
            for domain in
                ["", "a=[1e18,1e20];b=[-1e20,1e20];n=[1,2];l=[-1e-20,1e-20]", "v=[-1e20,1e20];k=[-1e-19,1e30]"]
            {
                let report = on(&subject, domain, lane, vulkan());
                let wrong: Vec<&Finding> =
                    report.findings.iter().filter(|f| f.kind == FuzzFindingKind::LaneDeviation).collect();
                assert!(wrong.is_empty(), "{} {domain}: {:?}", subject.label, wrong[0]);
            }
        }
    }
}

#[test]
fn a_library_of_many_kinds_holds_nothing_against_a_lane_that_is_right() {
    let text = include_str!("../../benches/library.glsl").replace("#version 330 core", "");
    let subjects = functions("library.glsl", &text);
    assert_eq!(subjects.len(), 50);
    for subject in subjects {
        let ready = subject.ready.as_ref().unwrap_or_else(|why| panic!("{}: {why}", subject.label));
        let domain = Domain::new("", ready.kernel.invocation.fields(), &[], &subject.stated);
        let (lane, request) = (embedded::open().unwrap(), Request { samples: 8192, notes: false, ..request() });
        for api in [Api::Binary32, Api::Vulkan] {
            let report = run(&subject, &domain, &[(&*lane, Promises::of_api(api))], &request).unwrap();
            let wrong: Vec<&Finding> = report.findings.iter().filter(|f| f.lane.is_some()).collect();
            assert!(wrong.is_empty(), "{} by {}: {:?}", subject.label, api.name(), wrong[0]);
        }
    }
}

#[test]
fn a_lane_with_a_wrong_sine_is_blamed() {
    let vulkan = by_name("vulkan-1.4").unwrap();
    let rulings = || Promises { text: vulkan, conformance: None, measured: None };
    let subject = &functions("a.glsl", "float wave(float x) { return 0.5 * sin(x) + 1.0; }")[0];
    let device = Adversary::lane(vulkan, lanes::Stage::Compute, Strategy::Extreme, 1, false);
    let report = on(subject, "x=[-3,3]", &device, rulings());
    assert!(!report.fails(), "{:?}", report.findings);
    let faulty = device.with_fault(Fault { op: Op::Sin, factor: 2.0 });
    let report = on(subject, "x=[-3,3]", &faulty, rulings());
    let found = report.findings.iter().find(|f| f.kind == FuzzFindingKind::LaneDeviation).unwrap();
    assert_eq!(found.lane, Some("adversary"));
    let Some(Origin::BuiltIn { op, .. }) = found.diagnosis.as_ref().unwrap().origin else { panic!("{found:?}") };
    assert_eq!(op, Op::Sin);
    assert!(found.reproduce.as_ref().unwrap().contains("--function wave --seed 1 --case 'x="));
}

/// A lane that gives some invocations the inputs of others.
struct Mixed(Box<dyn Lane>);

struct MixedRunner(Box<dyn Runner>);

impl Lane for Mixed {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        Ok(Box::new(MixedRunner(self.0.prepare(kernel, capacity)?)))
    }
}

impl Runner for MixedRunner {
    fn capacity(&self) -> usize {
        self.0.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let mut batch = batch.clone();
        let words = batch.invocation_record.words();
        if batch.invocation_count() > 64 {
            batch.invocations.copy_within(0..words, 15 * words);
        }
        self.0.run(&batch)
    }
}

#[test]
fn equal_inputs_with_different_outputs_are_found() {
    let subject = &functions("a.glsl", "float twice(float x) { return 2.0 * x; }")[0];
    let rulings = || Promises::of_api(Api::Binary32);
    let report = on(subject, "", &Mixed(embedded::open().unwrap()), rulings());
    assert!(kinds(&report, Severity::Finding).contains(&FuzzFindingKind::NotDeterministic), "{:?}", report.findings);
    let report = on(subject, "", &*embedded::open().unwrap(), rulings());
    assert!(!report.fails(), "{:?}", report.findings);
}

#[test]
fn the_first_lane_is_enough_unless_it_is_at_fault() {
    let subject = &functions("a.glsl", "float twice(float x) { return 2.0 * x; }")[0];
    let (right, wrong) = (embedded::open().unwrap(), Mixed(embedded::open().unwrap()));
    let rulings = || Promises::of_api(Api::Binary32);
    let lanes = |first: &'static str| -> Vec<(&dyn Lane, Promises)> {
        let (right, wrong): (&dyn Lane, &dyn Lane) = (&*right, &wrong);
        let pair = if first == "right" { [right, wrong] } else { [wrong, right] };
        pair.map(|lane| (lane, rulings())).to_vec()
    };
    let ran = |first: &'static str, first_lane: bool| {
        let request = Request { first_lane, ..request() };
        let report = requested(subject, "", &lanes(first), &request);
        (report.lanes.len(), report.fails())
    };
    assert_eq!((ran("right", true), ran("right", false)), ((1, false), (2, true)));
    assert_eq!(ran("wrong", true), (2, true));
}

/// A lane on which a number takes the sign of another one beside it.
struct Near(Box<dyn Lane>);

struct NearRunner(Box<dyn Runner>);

impl Lane for Near {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        Ok(Box::new(NearRunner(self.0.prepare(kernel, capacity)?)))
    }
}

impl Runner for NearRunner {
    fn capacity(&self) -> usize {
        self.0.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let mut seen = batch.clone();
        for (k, x) in seen.invocations.iter_mut().enumerate() {
            let beside = batch.invocations.get(k ^ 1).copied().unwrap_or(*x);
            if beside != *x && f32::from_bits(beside) < 0.0 {
                *x ^= 1 << 31;
            }
        }
        self.0.run(&seen)
    }
}

#[test]
fn invocations_that_disturb_each_other_are_told_from_chance_and_from_wrong_places() {
    let subject = &functions("a.glsl", "float twice(float x) { return 2.0 * x; }")[0];
    let rulings = || Promises::of_api(Api::Binary32);
    let report = on(subject, "", &Near(embedded::open().unwrap()), rulings());
    assert_eq!(kinds(&report, Severity::Finding), [FuzzFindingKind::Disturbed], "{:?}", report.findings);
    // Inputs of another place are no inputs beside it.
    let report = on(subject, "", &Mixed(embedded::open().unwrap()), rulings());
    assert!(!kinds(&report, Severity::Finding).contains(&FuzzFindingKind::Disturbed), "{:?}", report.findings);
}

#[test]
fn a_function_that_is_mostly_undetermined_is_weak_and_tells_why() {
    let report = |body: &str| strict(&functions("a.glsl", &format!("float f(float x) {{ return {body}; }}"))[0], "");
    let weak = report("clamp(0.0, 1.0, x)");
    assert!(weak.weak() == Some(Reason::Undefined) && weak.tells_notes() && !weak.fails(), "{:?}", weak.findings);
    let right = report("clamp(x, 0.0, 1.0)");
    assert!(right.weak().is_none() && !right.tells_notes(), "{:?}", right.findings);
}

/// Each function of a text with its inputs, or why it does not run.
fn shapes(name: &str, text: &str) -> Vec<(String, Result<Vec<String>, String>)> {
    let all = functions(name, text);
    let reported = |subject: &Subject| {
        let report = strict(subject, "");
        let inputs = report.inputs.into_iter().map(|(input, _)| input).collect();
        (report.function, report.not_run.map_or(Ok(inputs), Err))
    };
    all.iter().map(reported).collect()
}

#[test]
fn functions_of_all_shapes_run() {
    let text = "struct Light { vec3 at; float power[2]; };\nuniform Light sun;\nuniform mat3 turn;\nint calls;\n\
                vec3 shade(Light l, vec3 p, inout float sum) { sum += l.power[1]; calls++; return l.at - p + sun.at; }\n\
                mat2 flip(mat2 m, bool on) { return on ? transpose(m) : m; }\n\
                vec3 turned(vec3 v) { return turn * v; }\n\
                Light[2] two(Light a[2]) { a[0].at = a[1].at; return a; }\n\
                float same(float x) { return x; }\nvec2 same(vec2 x) { return x; }\n\
                void nothing(float x) { x = 1.0; }\nfloat image(sampler2D t) { return textureLod(t, vec2(0.0), 0.0).x; }\n";
    let all = shapes("a.glsl", text);
    let of = |name: &str| all.iter().find(|(n, _)| n == name).unwrap_or_else(|| panic!("{all:?}")).1.clone();
    let inputs =
        ["vec3 l.at", "float[2] l.power", "vec3 p", "float sum", "vec3 sun.at", "float[2] sun.power", "int calls"];
    assert_eq!(of("shade"), Ok(inputs.map(str::to_owned).to_vec()));
    assert_eq!(of("flip"), Ok(vec!["mat2 m".to_owned(), "bool on".to_owned()]));
    assert_eq!(of("turned"), Ok(vec!["vec3 v".to_owned(), "mat3 turn".to_owned()]));
    assert_eq!(of("same(vec2)"), Ok(vec!["vec2 x".to_owned()]));
    assert_eq!(of("same(float)"), Ok(vec!["float x".to_owned()]));
    assert!(of("two").is_ok(), "{:?}", of("two"));
    assert!(of("nothing").unwrap_err().starts_with("it gives nothing back"));
    assert_eq!(of("image"), Ok(Vec::new()));
}

#[test]
fn stages_run_by_their_interface() {
    let fragment = "in vec3 normal;\nin VS { vec2 uv; } from;\nuniform vec3 light;\nout vec4 color;\n\
                    void main() { color = vec4(max(dot(normal, light), 0.0) * from.uv, gl_FragCoord.x, 1.0); }\n";
    let all = shapes("a.frag", fragment);
    let inputs = ["vec3 normal", "vec2 from.uv", "vec4 gl_FragCoord", "vec3 light"];
    assert_eq!(all, [("main".to_owned(), Ok(inputs.map(str::to_owned).to_vec()))]);
    let vertex = "layout(location = 0) in vec4 p;\nuniform mat4 mc;\nvoid main() { gl_Position = mc * p; }\n";
    let all = shapes("a.vert", vertex);
    assert_eq!(all, [("main".to_owned(), Ok(vec!["vec4 p".to_owned(), "mat4 mc".to_owned()]))]);
    let subroutine = "subroutine float Shape(float x);\nsubroutine uniform Shape shape;\nout float y;\n\
                      subroutine(Shape) float round_one(float x) { return x * x; }\nvoid main() { y = shape(1.0); }\n";
    assert_eq!(shapes("a.frag", subroutine)[0], ("round_one".to_owned(), Ok(vec!["float x".to_owned()])));
    let compute = "layout(local_size_x = 1) in;\nbuffer Data { float x[]; };\nvoid main() { x[0] = 1.0; }\n\
                   float own(uint k) { return float(k + gl_GlobalInvocationID.x); }\n";
    let all = shapes("a.comp", compute);
    assert_eq!(all[0].1, Ok(vec!["float[4] x".to_owned()]));
    assert_eq!(all[1].1, Ok(vec!["uint k".to_owned(), "uvec3 gl_GlobalInvocationID".to_owned()]));
}

#[test]
fn loops_without_end_are_reported_and_hold_nothing_up() {
    let text = "float steps(float x) { float s = 0.0; for (float t = 0.0; t < 1.0; t += x) { s += 1.0; } return s; }";
    let report = only(text, "");
    let found = report.findings.iter().find(|f| f.kind == FuzzFindingKind::Endless).unwrap();
    assert_eq!(found.severity, Severity::Note);
    assert!(kinds(&only(text, "x=[0,1]"), Severity::Finding).contains(&FuzzFindingKind::Endless));
    assert!(!only(text, "x=[0.1,1]").fails());
}

#[test]
fn comments_before_a_function_state_its_domain() {
    let text = "// shadercheck: x in (0, 1]\nfloat log_of(float x) { return log(x); }\n\
                float raw(float x) { return log(x); }\n";
    let all = functions("a.glsl", text);
    assert!(!strict(&all[0], "").fails());
    // What goes into a logarithm is taken for a positive number; others are an error where all inputs are alike.
    let raw = strict(&all[1], "");
    assert!(!raw.fails() && kinds(&raw, Severity::Warning).contains(&FuzzFindingKind::NoValue), "{:?}", raw.findings);
    assert!(arbitrary(&all[1]).fails());
}

const LIBRARY: &str = "#include \"lib/part.glsl\"\nfloat whole(float a, float b) { return part(a, b) + 1.0; }\n";
const PART: &str = "// a part\nfloat part(float a, float b) { return a / b; }\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("lib")).unwrap();
    fs::write(folder.path().join("whole.glsl"), LIBRARY).unwrap();
    fs::write(folder.path().join("lib/part.glsl"), PART).unwrap();
    folder
}

#[test]
fn included_files_keep_their_names_and_the_command_shows_it_again() {
    let folder = folder();
    let ran =
        run_in(folder.path(), "fuzz whole.glsl --samples 2048 --lane embedded --arbitrary --format json").expect(1);
    let report = ran.json();
    let function = &report["files"][0]["functions"][1];
    assert_eq!(function["function"], "whole");
    let finding = &function["findings"][0];
    assert_eq!((finding["kind"].as_str(), finding["at"].as_str()), (Some("no_value"), Some("lib/part.glsl:2:39")));
    let again = run_reported(folder.path(), finding["reproduce"].as_str().unwrap(), &[]).expect(1);
    assert!(again.out.contains(finding["message"].as_str().unwrap()), "{}", again.out);
    // A stated domain leaves it out.
    run_in(folder.path(), "fuzz whole.glsl --samples 2048 --lane embedded --domain b=[1,2]").expect(0);
    run_in(folder.path(), "fuzz whole.glsl --samples 512 --lane embedded --domain whole.b=[1,2] --function whole")
        .expect(0);
}

#[test]
fn what_rests_on_a_number_of_the_host_that_was_chosen_is_a_warning() {
    let kernel = |value: &str| {
        format!(
            "struct P {{ time: f32, width: u32 }}\n@group(0) @binding(0) var<storage, read_write> o: array<f32, 4>;\n\
             @group(0) @binding(1) var<uniform> p: P;\n@compute @workgroup_size(4)\n\
             fn main(@builtin(local_invocation_index) i: u32) {{ let w = vec2f(f32(p.width), 1.0); o[i] = {value}; }}\n"
        )
    };
    let fuzzed = |value: &str| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("k.wgsl"), kernel(value)).unwrap();
        crate::binary::run_in(folder.path(), "fuzz k.wgsl --lane embedded")
    };
    let ran = fuzzed("f32(i) / w.x").expect(0);
    assert!(ran.out.contains("warning: main: `o[0]` has no value"), "{}", ran.out);
    // Whatever the width is.
    let ran = fuzzed("w.x * f32(i) / (w.y - 1.0)").expect(1);
    assert!(ran.out.contains("has no value") || ran.out.contains("is infinite"), "{}", ran.out);
}

#[test]
fn wrong_usage_is_reported() {
    let folder = folder();
    let reported = |args: &str, text: &str| {
        let ran = run_in(folder.path(), &format!("fuzz whole.glsl --samples 64 --lane embedded {args}")).expect(2);
        assert!(ran.err.contains(text), "{}", ran.err);
    };
    reported("--function hole", "there is no function `hole` with a body; did you mean `whole`?");
    reported("--domain c=[0,1]", "--domain: no function that was run has an input `c`");
    reported("--domain b=[1,0]", "`[1,0]` is empty");
    reported("--lane vulcan", "did you mean `vulkan`?");
    fs::write(folder.path().join("whole.glsl"), "// shadercheck: z in [0,1]\nfloat f(float x) { return x; }\n")
        .unwrap();
    reported("", "whole.glsl:1:1: `f` has no input `z`; it has: x");
    fs::write(folder.path().join("whole.glsl"), "// shadercheck: x on [0,1]\nfloat f(float x) { return x; }\n")
        .unwrap();
    reported("", "whole.glsl:1:1: this comment states no domain: `x on [0,1]` is no domain");
    fs::write(folder.path().join("whole.glsl"), "#include \"gone.glsl\"\nfloat f(float x) { return x; }\n").unwrap();
    let ran = run_in(folder.path(), "fuzz whole.glsl --samples 64 --lane embedded").expect(0);
    assert!(ran.err.contains("not found, and left out: `#include \"gone.glsl\"`; name the folder with `-I FOLDER`"));
    fs::write(folder.path().join("whole.glsl"), "void f(float t) { t = 1.0; }\n").unwrap();
    let ran = run_in(folder.path(), "fuzz whole.glsl --lane embedded").expect(2);
    assert!(ran.out.contains("not run: it gives nothing back"), "{}", ran.out);
}

#[test]
fn a_first_suite_is_written_once() {
    let folder = folder();
    let args = "fuzz whole.glsl --samples 64 --lane embedded --domain a=[0,1];b=[1,2] --write-suite";
    let ran = run_in(folder.path(), args).expect(0);
    assert!(ran.err.contains("note: wrote whole.part.suite.toml"), "{}", ran.err);
    let path = folder.path().join("whole.part.suite.toml");
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("entry = \"part\"") && text.contains("range = [1.0, 2.0]"), "{text}");
    toml::from_str::<toml::Table>(&text).unwrap();
    fs::write(&path, "mine").unwrap();
    let ran = run_in(folder.path(), args).expect(0);
    assert!(ran.err.contains("is there already and stays as it is"), "{}", ran.err);
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
}

#[test]
fn main_of_a_compute_shader_runs_alone() {
    let text = "layout(local_size_x = 1) in; layout(std430) buffer B { float a; float list[]; };\n\
        void main() { list[1] = 1.0 / a; atomicAdd(n, 1); }";
    let counted = text.replace("layout(std430)", "layout(std430) buffer N { int n; }; layout(std430)");
    let all = functions("a.comp", &counted);
    let report = strict(&all[0], "a=[0,1]");
    assert_eq!(report.not_run, None);
    let found = report.of(Severity::Finding).next().unwrap();
    assert!(values(found).iter().any(|v| v == "float a = 0.0"), "{:?}", values(found));
    // Nothing is left to find where `a` is never 0.
    let report = strict(&all[0], "a=[1,2]");
    assert_eq!(kinds(&report, Severity::Finding), []);
    let waits = "layout(local_size_x = 2) in; buffer B { float a; }; void main() { a = 1.0; barrier(); }";
    assert!(functions("a.comp", waits)[0].ready.is_err());
}

#[test]
fn a_compute_stage_is_dispatched_and_run_alone_as_well() {
    let folder = tempfile::tempdir().unwrap();
    let run = |body: &str| {
        let text = format!(
            "#version 430\nlayout(local_size_x = 8) in;\nlayout(std430) buffer B {{ float a[]; }};\nvoid main() {{ {body} }}\n"
        );
        fs::write(folder.path().join("a.comp"), text).unwrap();
        run_in(folder.path(), "fuzz a.comp --samples 512 --lane embedded").expect(0).out
    };
    let reported = run("a[gl_GlobalInvocationID.x] = float(gl_LocalInvocationIndex) + 1.0;");
    assert!(reported.contains("512 samples") && reported.contains("19 dispatches"), "{reported}");
    let told = "warning: main: invocation 1 writes `B` at index 1, outside of its 1 elements";
    assert!(reported.contains(told), "{reported}");
    // All its invocations were run.
    assert!(!reported.contains("first invocation"), "{reported}");
}

#[test]
fn what_a_host_cuts_off_or_puts_in_front_of_a_kernel_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, text: &str, status: i32| {
        fs::write(folder.path().join(name), text).unwrap();
        let ran = run_in(folder.path(), &format!("fuzz {name} --samples 64 --lane embedded")).expect(status);
        (ran.out, ran.err)
    };
    let kernel = "layout(local_size_x = 8) in;\nlayout(set = 0, binding = 0) writeonly buffer B { uint a[]; } b;\n\
        void main() { uint i = gl_GlobalInvocationID.x; if (i < uint(b.a.length())) b.a[i] = 1u << i % 8u; }\n";
    // A section of Godot, whose places are those of the file.
    let section = format!("#[compute]\n#version 450\n{kernel}");
    let (out, _) = run("section.glsl", &section, 0);
    assert!(out.contains("ok    main"), "{out}");
    let (out, _) = run("section.glsl", &section.replace("1u << i % 8u", "missing"), 1);
    assert!(out.contains("section.glsl:5:") && !out.contains("E010") && !out.contains("V001"), "{out}");
    // A text to which the host adds the version: told once, and no error follows from it.
    let (out, err) = run("bare.comp", kernel, 0);
    assert!(out.contains("ok    main"), "{out}");
    assert_eq!(err.matches("has no `#version`: it is read as GLSL 4.30").count(), 1, "{err}");
    // Nor is a name that may be in what the host puts in front: it is an input, and said to be one.
    let (out, err) = run("bare.comp", &kernel.replace("1u << i % 8u", "missing"), 0);
    assert!(out.contains("ok    main") && err.contains("any value: `missing` as `int`"), "{out}\n{err}");
    let (out, _) = run("bare.comp", &kernel.replace("1u << i % 8u", "1.5"), 1);
    assert_eq!(out.matches("error[").count(), 1, "{out}");
    let (_, err) = run("stated.comp", &format!("#version 430\n{kernel}"), 0);
    assert!(!err.contains("it is read as"), "{err}");
}

#[test]
fn a_kernel_of_fixed_arrays_is_dispatched_along_the_axis_that_it_asks_for() {
    let folder = tempfile::tempdir().unwrap();
    let run = |at: &str, rows: u32| {
        let text = format!(
            "struct S {{ h: array<array<atomic<u32>, 4>, {rows}> }}\n@group(0) @binding(0) var<storage, read_write> s: S;\n\
             @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) g: vec3u) {{ var sum = 0u;\n\
             for (var d = 0u; d < 4u; d += 1u) {{ let t = atomicLoad(&s.h[{at}][d]); atomicStore(&s.h[{at}][d], sum); sum += t; }} }}\n"
        );
        fs::write(folder.path().join("rows.wgsl"), text).unwrap();
        run_in(folder.path(), "fuzz rows.wgsl --samples 64 --lane embedded").out
    };
    for (at, rows) in [("g.x", 2), ("g.y", 2), ("g.z", 1)] {
        let out = run(at, rows);
        assert!(out.contains("0 findings, 0 warnings"), "{at} {rows} {out}");
    }
    // Two invocations share a row.
    assert!(run("g.y / 2u", 4).contains("lost update"), "{}", run("g.y / 2u", 4));
}
