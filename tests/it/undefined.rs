//! Values that GLSL leaves undefined are the shader's fault: told with place and smallest input, and held against no
//! lane, in every stage.

use base::text::SourceFile;
use base::value::Batch;
use engine::suite::parse;
use engine::suite::run::{Finding, FindingKind, Prepared, Report, prepare, run};
use judge::profile::{Promises, by_name};
use judge::verdict::{Blame, Reason};
use lanes::{Actual, Description, Lane, LaneError, Runner, Stage, embedded};
use program::Kernel;

use crate::support::request;

/// What is undefined: functions of `x` and `y` from -2 to 2, what is said of it, and the same within the rules.
const CASES: [(&str, &str, &str); 44] = [
    (
        "float f(float x, float y) { float a[3]; a[0] = 1.0; a[1] = y; a[2] = 3.0; return a[int(floor(x))]; }",
        "index -",
        "float f(float x, float y) { float a[3]; a[0] = 1.0; a[1] = y; a[2] = 3.0; return a[max(int(floor(x)), 0)]; }",
    ),
    (
        "float f(float x, float y) { vec3 v = vec3(x, y, 1.0); return v[int(floor(x))]; }",
        "index -",
        "float f(float x, float y) { vec3 v = vec3(x, y, 1.0); return v[clamp(int(floor(x)) + 2, 0, 2)] + x; }",
    ),
    (
        "float f(float x, float y) { mat2 m = mat2(x, y, 1.0, 2.0); return m[int(floor(x))].y; }",
        "index -",
        "float f(float x, float y) { mat2 m = mat2(x, y, 1.0, 2.0); return m[int(x > 0.0)].y + x; }",
    ),
    (
        "float f(float x, float y) { float a[2]; a[0] = x; a[1] = y; a[int(floor(x))] = 5.0; return a[0] + a[1]; }",
        "index -",
        "float f(float x, float y) { float a[2]; a[0] = x; a[1] = y; a[int(x > 0.0)] = 5.0; return a[0] + a[1]; }",
    ),
    (
        "float f(float x, float y) { return float(7 / int(floor(x))) + y; }",
        "7 is divided by zero",
        "float f(float x, float y) { return float(7 / (int(floor(x)) + 5)) + y; }",
    ),
    (
        "float f(float x, float y) { return float(7u % uint(max(x, 0.0))) + y; }",
        "7 is divided by zero",
        "float f(float x, float y) { return float(7u % (uint(max(x, 0.0)) + 1u)) + y; }",
    ),
    (
        "float f(float x, float y) { return float(int(floor(x)) % 3) + y; }",
        "`%` has a negative operand: -",
        "float f(float x, float y) { return float((int(floor(x)) + 5) % 3) + y; }",
    ),
    (
        "float f(float x, float y) { int m = int(-2147483648.0 + 0.0 * y); return float(m / (x < 0.0 ? -1 : 2)); }",
        "-2147483648 / -1 does not fit",
        "float f(float x, float y) { int m = int(-2147483648.0 + 0.0 * y); return 1e-9 * float(m / (x < 0.0 ? -2 : 2)) + y; }",
    ),
    (
        "float f(float x, float y) { return float(uint(x)) + y; }",
        "is converted to an integer type that does not hold it",
        "float f(float x, float y) { return float(uint(x + 2.0)) + y; }",
    ),
    (
        "float f(float x, float y) { return float(int(x * 1e12)) + y; }",
        "is converted to an integer type that does not hold it",
        "float f(float x, float y) { return float(int(x * 1e3)) + y; }",
    ),
    (
        "float f(float x, float y) { return float(1 << (31 + int(floor(x)))) + y; }",
        "a shift by 32 bits",
        "float f(float x, float y) { return float(1 << (20 + int(floor(x)))) + y; }",
    ),
    (
        "float f(float x, float y) { return float(-9 >> int(floor(x))) + y; }",
        "a shift by -",
        "float f(float x, float y) { return float(-9 >> (2 + int(floor(x)))) + y; }",
    ),
    (
        "float f(float x, float y) { return float(bitfieldExtract(-255, 30, 2 + int(floor(x)))) + y; }",
        "a bit field at offset 30 with 3 bits",
        "float f(float x, float y) { return float(bitfieldExtract(-255, 9, 2 + int(floor(x)))) + y; }",
    ),
    (
        "float f(float x, float y) { return float(bitfieldInsert(7, 5, int(floor(x)), 2)) + y; }",
        "a bit field at offset -",
        "float f(float x, float y) { return float(bitfieldInsert(7, 5, 2 + int(floor(x)), 2)) + y; }",
    ),
    (
        "float f(float x, float y) { return pow(x, y); }",
        "`pow` of ",
        "float f(float x, float y) { return pow(x + 2.5, y); }",
    ),
    (
        "float f(float x, float y) { return pow(max(floor(x), 0.0), y); }",
        "`pow` of 0 to the power of",
        "float f(float x, float y) { return pow(max(floor(x), 1.0), y) + y; }",
    ),
    (
        "float f(float x, float y) { return clamp(x, 0.5, y); }",
        "`clamp` with a lower end of 0.5 above",
        "float f(float x, float y) { return clamp(x, -2.5, y); }",
    ),
    (
        "float f(float x, float y) { return float(clamp(3, int(floor(x)), int(floor(y)))); }",
        "`clamp` with a lower end of",
        "float f(float x, float y) { return float(clamp(3, int(floor(x)), int(floor(y)) + 4)) + y; }",
    ),
    (
        "float f(float x, float y) { return smoothstep(x, y, 0.5); }",
        "`smoothstep` with edges",
        "float f(float x, float y) { return smoothstep(x - 5.0, y, 0.5); }",
    ),
    (
        "float f(float x, float y) { return smoothstep(floor(x), floor(x), y); }",
        "`smoothstep` with edges",
        "float f(float x, float y) { return smoothstep(floor(x), floor(x) + 1.0, y); }",
    ),
    (
        "float f(float x, float y) { return asin(x) + y; }",
        "`asin` of",
        "float f(float x, float y) { return asin(0.4 * x) + y; }",
    ),
    (
        "float f(float x, float y) { return acos(x) + y; }",
        "`acos` of",
        "float f(float x, float y) { return acos(0.4 * x) + y; }",
    ),
    (
        "float f(float x, float y) { return log(x) + y; }",
        "`log` of",
        "float f(float x, float y) { return log(x + 3.0) + y; }",
    ),
    (
        "float f(float x, float y) { return log2(x) + y; }",
        "`log2` of",
        "float f(float x, float y) { return log2(x + 3.0) + y; }",
    ),
    (
        "float f(float x, float y) { return sqrt(x) + y; }",
        "`sqrt` of -",
        "float f(float x, float y) { return sqrt(x + 3.0) + y; }",
    ),
    (
        "float f(float x, float y) { return inversesqrt(x) + y; }",
        "`inversesqrt` of",
        "float f(float x, float y) { return inversesqrt(x + 3.0) + y; }",
    ),
    (
        "float f(float x, float y) { return acosh(x) + y; }",
        "`acosh` of",
        "float f(float x, float y) { return acosh(x + 4.0) + y; }",
    ),
    (
        "float f(float x, float y) { return atanh(x) + y; }",
        "`atanh` of",
        "float f(float x, float y) { return atanh(0.4 * x) + y; }",
    ),
    (
        "float f(float x, float y) { return atan(floor(x), floor(y)); }",
        "`atan` of 0, 0",
        "float f(float x, float y) { return atan(floor(x), floor(y) + 5.0) + y; }",
    ),
    (
        "float f(float x, float y) { float r; if (x > 0.0) r = y; return r; }",
        "it is read before it has a value",
        "float f(float x, float y) { float r; if (x > 0.0) r = y; else r = 1.0; return r; }",
    ),
    (
        "float f(float x, float y) { int k; if (x > 0.0) { k = 3; } return float(k + 1) * y; }",
        "it is read before it has a value",
        "float f(float x, float y) { int k; if (x > 0.0) { k = 3; } else { k = 4; } return float(k + 1) * y; }",
    ),
    (
        "float f(float x, float y) { bool b; if (x > 0.0) { b = y > 0.0; } return b ? 1.0 : 2.0; }",
        "it is read before it has a value",
        "float f(float x, float y) { bool b; if (x > 0.0) { b = y > 0.0; } return (x > 0.0 && b ? 1.0 : 2.0) + y; }",
    ),
    (
        "float f(float x, float y) { float a[2]; a[int(x > 0.0)] = y; return a[0]; }",
        "it is read before it has a value",
        "float f(float x, float y) { float a[2]; a[int(x > 0.0)] = y; return a[int(x > 0.0)]; }",
    ),
    (
        "float f(float x, float y) { float s; for (int i = 0; i < 3; i++) s += x; return s * y; }",
        "it is read before it has a value",
        "float f(float x, float y) { float s; for (int i = 0; i < 3; i++) { if (i == 0) s = 0.0; s += x; } return s * y; }",
    ),
    (
        "void g(float t, out float r) { if (t > 0.0) r = t; }\nfloat f(float x, float y) { float r = y; g(x, r); return r; }",
        "it is read before it has a value",
        "void g(float t, inout float r) { if (t > 0.0) r = t; }\nfloat f(float x, float y) { float r = y; g(x, r); return r; }",
    ),
    (
        "float g(float t) { if (t > 0.0) return t; }\nfloat f(float x, float y) { return g(x) + y; }",
        "the function ends without `return`",
        "float g(float t) { if (t > 0.0) return t; return 0.5; }\nfloat f(float x, float y) { return g(x) + y; }",
    ),
    (
        "float h;\nfloat f(float x, float y) { if (x > 0.0) h = y; return h; }",
        "it is read before it has a value",
        "float h = 0.5;\nfloat f(float x, float y) { if (x > 0.0) h = y; return h; }",
    ),
    (
        "void g(inout float a, inout float b) { a += 1.0; b *= 2.0; }\nfloat f(float x, float y) { float h = x; g(h, h); return h + y; }",
        "two `out` arguments are one variable",
        "void g(inout float a, inout float b) { a += 1.0; b *= 2.0; }\nfloat f(float x, float y) { float h = x; float k = y; g(h, k); return h + k; }",
    ),
    (
        "void g(out vec3 a, out float b) { a = vec3(1.0); b = 2.0; }\nfloat f(float x, float y) { vec3 h = vec3(x); g(h, h.y); return h.y + y; }",
        "two `out` arguments are one variable",
        "void g(out float a, out float b) { a = 1.0; b = 2.0; }\nfloat f(float x, float y) { vec3 h = vec3(x); g(h.x, h.y); return h.y + y; }",
    ),
    (
        "float h;\nvoid g(out float a, out float b) { a = 1.0; b = 2.0; }\nfloat f(float x, float y) { g(h, h); return h + y + x; }",
        "two `out` arguments are one variable",
        "float h;\nvoid g(inout float a) { h = 2.0; a += h; }\nfloat f(float x, float y) { h = x; g(h); return h + y; }",
    ),
    (
        "void g(out float a, out float b) { a = 1.0; b = 2.0; }\nfloat f(float x, float y) { float a[2]; a[0] = x; a[1] = y; g(a[int(x > 0.0)], a[int(y > 0.0)]); return a[0] + a[1]; }",
        "two `out` arguments are one variable",
        "void g(out float a, out float b) { a = 1.0; b = 2.0; }\nfloat f(float x, float y) { float a[2]; a[0] = x; a[1] = y; g(a[int(x > 0.0)], a[1 - int(x > 0.0)]); return a[0] + a[1] + x; }",
    ),
    // Where it does not matter nothing is said: not selected, not read, multiplied by 0, the same whatever it is.
    (
        "float f(float x, float y) { float v = sqrt(x); return v; }",
        "`sqrt` of -",
        "float f(float x, float y) { float v = sqrt(x); return x > 0.0 ? v : y; }",
    ),
    (
        "float f(float x, float y) { float a[2]; a[0] = x; a[1] = y; return a[int(floor(x))]; }",
        "index -",
        "float f(float x, float y) { float a[2]; a[0] = x; a[1] = y; return x < 0.0 || x >= 2.0 ? 0.5 : a[int(floor(x))]; }",
    ),
    (
        "float f(float x, float y) { return float(uint(x)); }",
        "is converted to an integer type that does not hold it",
        "float f(float x, float y) { return float(uint(x)) * 0.0 + y; }",
    ),
];

const INPUTS: &str = "[[inputs]]\nnames = [\"x\", \"y\"]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n";

/// The function in a stage, with the suite for it.
fn staged(function: &str, stage: &str) -> Prepared {
    let main = match stage {
        "vertex" => "in float x;\nin float y;\nout float r;\nvoid main() { r = f(x, y); gl_Position = vec4(0.0); }\n",
        "fragment" => "in float x;\nin float y;\nout vec4 r;\nvoid main() { r = vec4(f(x, y)); }\n",
        "geometry" => {
            "layout(points) in;\nlayout(points, max_vertices = 1) out;\nuniform float x;\nuniform float y;\nout float r;\n\
             void main() { r = f(x, y); gl_Position = vec4(0.0); EmitVertex(); }\n"
        }
        _ => "",
    };
    let entry = if main.is_empty() { "entry = \"f\"\n" } else { "" };
    let toml = format!("suite = \"u\"\nshader = \"u.glsl\"\nstage = \"{stage}\"\n{entry}samples = 1024\n{INPUTS}");
    let suite = parse(&SourceFile::new("u.suite.toml", toml)).unwrap_or_else(|error| panic!("{error:?}"));
    let shader = format!("#version 450 core\n{function}\n{main}");
    prepare(&suite, &SourceFile::new("u.glsl", shader)).unwrap_or_else(|error| panic!("{function}: {error}"))
}

fn check(prepared: &Prepared, lane: &dyn Lane) -> Report {
    outcome(prepared, lane).unwrap()
}

fn outcome(prepared: &Prepared, lane: &dyn Lane) -> Result<Report, LaneError> {
    // A promise under which these functions have bounds.
    let promises = Promises { text: by_name("vulkan-1.4").unwrap(), conformance: None, measured: None };
    run(prepared, lane, Stage::Compute, &request(prepared, Some(1024), promises), &mut |_| {})
}

/// A device that is off by a part in 1000 wherever the first input is between 1.25 and 1.5.
struct Off(Box<dyn Lane>);

struct OffRunner(Box<dyn Runner>);

impl Lane for Off {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        Ok(Box::new(OffRunner(self.0.prepare(kernel, capacity)?)))
    }
}

impl Runner for OffRunner {
    fn capacity(&self) -> usize {
        self.0.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        // Its inputs are off, which moves what is computed from them.
        let mut batch = batch.clone();
        for word in batch.invocations.iter_mut().chain(&mut batch.cases) {
            let x = f32::from_bits(*word);
            if (1.25..1.5).contains(&x) {
                *word = (x + 0.125).to_bits();
            }
        }
        self.0.run(&batch)
    }
}

/// A device that fails outright where the first input of an invocation fulfils a condition, or writes over the inputs of
/// its neighbours there.
struct Brittle {
    lane: Box<dyn Lane>,
    breaks: fn(f32) -> bool,
    dies: bool,
}

struct BrittleRunner {
    runner: Box<dyn Runner>,
    breaks: fn(f32) -> bool,
    dies: bool,
}

impl Lane for Brittle {
    fn description(&self) -> &Description {
        self.lane.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        let runner = self.lane.prepare(kernel, capacity)?;
        Ok(Box::new(BrittleRunner { runner, breaks: self.breaks, dies: self.dies }))
    }
}

impl Runner for BrittleRunner {
    fn capacity(&self) -> usize {
        self.runner.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let count = batch.invocation_count();
        let x = |k: usize| f32::from_bits(*batch.invocation(k).iter().chain(batch.case_of(k)).next().unwrap());
        let broken: Vec<usize> = (0..count).filter(|&k| (self.breaks)(x(k))).collect();
        let Some(&first) = broken.first() else { return self.runner.run(batch) };
        if self.dies {
            let how = "was ended by signal 11 (segmentation fault)".to_owned();
            return Err(LaneError::Lost { how, invocation: Some(first), count, inputs: String::new() });
        }
        let mut batch = batch.clone();
        for at in broken {
            let next = (at + 1) % count;
            if !(self.breaks)(x(next)) {
                let words = batch.invocation_record.words();
                batch.invocations[next * words..][..words].fill(0.25_f32.to_bits());
            }
        }
        self.runner.run(&batch)
    }
}

fn messages(report: &Report, kind: FindingKind) -> Vec<String> {
    report.findings.iter().filter(|f| f.kind == kind).map(|f| f.message.clone()).collect()
}

#[test]
fn an_undefined_value_is_reported_as_the_shaders_fault_where_it_matters() {
    let strict = embedded::open().unwrap();
    let off = Off(embedded::open().unwrap());
    let mut wrong = Vec::new();
    for (function, said, twin) in CASES {
        for stage in ["function", "vertex", "fragment", "geometry"] {
            let undefined = staged(function, stage);
            let report = check(&undefined, &*strict);
            let reported = messages(&report, FindingKind::Undefined);
            let good = |m: &String| {
                m.starts_with("the shader gives an undefined value: `") && m.contains(" at u.glsl:") && m.contains(said)
            };
            if reported.is_empty() || !reported.iter().any(good) {
                wrong.push(format!("{stage} {function}: {reported:?} {:?}", report.findings));
                continue;
            }
            let open = report.verdicts.undetermined[Reason::Undefined as usize];
            if report.verdicts.deviated != 0 || open == 0 {
                wrong.push(format!("{stage} {function}: {} deviate, {open} are open", report.verdicts.deviated));
            }
            let finding =
                report.findings.iter().find(|f| f.kind == FindingKind::Undefined && good(&f.message)).unwrap();
            let case = finding.case.as_ref().unwrap();
            if case.inputs.len() != 2
                || case.deviation.is_some()
                || !finding.reproduce.as_ref().unwrap().contains("--case '")
            {
                wrong.push(format!("{stage} {function}: {case:?}"));
            }
            // Elsewhere a wrong device is accused as before, and never for what is undefined.
            let accused = check(&undefined, &off);
            let lane = |f: &&engine::suite::run::Finding| f.kind == FindingKind::Deviation;
            let by_lane = accused.findings.iter().filter(lane).filter_map(|f| f.case.as_ref()?.deviation.as_ref());
            let blames: Vec<Blame> = by_lane.map(|deviation| deviation.blame).collect();
            let same = accused.verdicts.undetermined[Reason::Undefined as usize];
            if same != open || blames.contains(&Blame::Shader) {
                wrong.push(format!("{stage} {function}: {open} and {same} are open, {blames:?}"));
            }
            // Within the rules nothing is said, and the device is accused.
            let within = staged(twin, stage);
            let report = check(&within, &*strict);
            if !report.findings.is_empty() && !messages(&report, FindingKind::Undefined).is_empty() {
                wrong.push(format!("{stage} {twin}: {:?}", messages(&report, FindingKind::Undefined)));
            }
            let accused = check(&within, &off).verdicts.deviated;
            if report.verdicts.deviated != 0 || accused == 0 {
                wrong.push(format!("{stage} {twin}: {} and {accused} deviate", report.verdicts.deviated));
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong[..wrong.len().min(40)].join("\n"));
}

#[test]
fn the_smallest_input_is_shown_with_the_place() {
    let shader = "float f(float x, float y) {\n  float a[4];\n  for (int i = 0; i < 4; i++) a[i] = y;\n  return a[int(3.0 * x)];\n}";
    let report = check(&staged(shader, "function"), &*embedded::open().unwrap());
    let finding = report.findings.iter().find(|f| f.kind == FindingKind::Undefined).unwrap();
    let inputs = &finding.case.as_ref().unwrap().inputs;
    assert_eq!(
        finding.message,
        "the shader gives an undefined value: `a[int(3.0 * x)]` at u.glsl:5:10: index -3 is outside of 0 to 3"
    );
    assert_eq!(inputs.iter().map(|i| i.decimal.concat()).collect::<Vec<_>>(), ["-1.0", "0.0"]);
}

/// A load and a store at an index that may lie outside, and a division of integers.
const BREAKING: [&str; 3] = [
    "float f(float x, float y) { float a[3]; a[0] = 1.0; a[1] = y; a[2] = 3.0; return a[int(floor(x + 1.0))]; }",
    "float f(float x, float y) { float a[3]; a[0] = y; a[1] = x; a[2] = 3.0; a[int(floor(x + 1.0))] = 5.0; return a[0]; }",
    "float f(float x, float y) { return float(7 / max(int(floor(x + 2.0)), 0)) + y; }",
];

#[test]
fn an_executor_that_dies_where_the_shader_is_undefined_is_not_at_fault() {
    for function in BREAKING {
        let prepared = staged(function, "function");
        // From -2 to -1 each of them is undefined.
        let lane = Brittle { lane: embedded::open().unwrap(), breaks: |x| x < -1.0, dies: true };
        let report = check(&prepared, &lane);
        let undefined = messages(&report, FindingKind::Undefined);
        let reported = |what: &str| undefined.iter().any(|message| message.contains(what));
        assert!(reported("the shader gives an undefined value"), "{function}: {undefined:?}");
        // What stores outside of an array is not run at all.
        let dies = "the process of the driver was ended by signal 11 (segmentation fault), which it may do there";
        assert_eq!(reported(dies), !function.contains("] = 5.0"), "{function}: {undefined:?}");
        // Annotations and SARIF point at it.
        let of_the_shader = report.findings.iter().filter(|f| f.kind == FindingKind::Undefined);
        let placed = |f: &Finding| f.case.as_ref().is_some_and(|case| case.diagnosis.written.is_some());
        assert!(of_the_shader.clone().count() > 0 && of_the_shader.clone().all(placed), "{function}: {undefined:?}");
        assert!(report.verdicts.deviated == 0 && report.verdicts.agreed > 0, "{function}: {:?}", report.verdicts);
        let known = |kind| matches!(kind, FindingKind::Undefined | FindingKind::Floor);
        assert!(report.findings.iter().all(|f| known(f.kind)), "{function}: {:?}", report.findings);
    }
}

#[test]
fn an_executor_that_dies_where_the_shader_is_defined_has_failed() {
    for function in BREAKING {
        let prepared = staged(function, "function");
        let lane = Brittle { lane: embedded::open().unwrap(), breaks: |x| (0.5..0.75).contains(&x), dies: true };
        let error = outcome(&prepared, &lane).unwrap_err();
        assert!(matches!(&error, LaneError::Lost { invocation: Some(_), .. }), "{function}: {error}");
    }
}

#[test]
fn what_a_store_outside_of_its_array_does_to_others_is_held_against_no_executor() {
    let prepared = staged(BREAKING[1], "function");
    let deviated = |breaks| {
        let report = check(&prepared, &Brittle { lane: embedded::open().unwrap(), breaks, dies: false });
        assert!(!messages(&report, FindingKind::Undefined).is_empty(), "{:?}", report.findings);
        report.verdicts.deviated
    };
    assert_eq!(deviated(|x| x < -1.0), 0);
    assert!(deviated(|x| (0.5..0.75).contains(&x)) > 0, "a device that writes over others by itself is at fault");
}
