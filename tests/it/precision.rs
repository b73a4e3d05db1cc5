//! What `mediump` and `precise` mean to `fuzz`, `lint` and the lanes.

use std::fs;

use engine::fuzz::{Finding, FunctionReport, FuzzFindingKind, Severity};
use judge::profile::Promises;
use judge::verdict::diagnosis::Origin;
use lanes::{Api, Description, Lane, LaneError, Runner, embedded};
use program::Kernel;

use crate::binary::{run, run_in};
use crate::fuzz::{functions, on, on_lanes};

const SQUARE: &str = "fuzz fixtures/precision/square.frag --samples 2048";

#[test]
fn a_square_overflows_at_mediump_in_the_range_that_is_stated() {
    let ran = run(&format!("{SQUARE} --lane embedded --domain v=[-500,500]")).expect(1);
    assert!(ran.out.contains("overflow at `mediump`"), "{}", ran.out);
    assert!(ran.out.contains("square.frag:9:32: `dot(v, v)`"), "{}", ran.out);
    let ran = run(&format!("{SQUARE} --lane embedded --domain v=[-60,60]")).expect(0);
    assert!(!ran.out.contains("mediump"), "{}", ran.out);
}

#[test]
fn the_half_lane_is_held_against_what_mediump_promises() {
    for domain in ["v=[-60,60]", "v=[-1,1]"] {
        let ran = run(&format!("{SQUARE} --lane embedded-half --domain {domain}")).expect(0);
        assert!(ran.out.contains("embedded-half"), "{}", ran.out);
    }
}

#[test]
fn the_half_lane_runs_where_it_is_named_alone() {
    let ran = run(&format!("{SQUARE} --domain v=[-1,1] --format json")).expect(0);
    assert!(!ran.out.contains("embedded-half"), "{}", ran.out);
    let ran = run("lanes").expect(0);
    assert!(ran.out.contains("embedded-half"), "{}", ran.out);
}

/// The error of a sum (Knuth), by what its variables are declared as.
fn two_sum(declared: &str) -> String {
    format!(
        "#version 450\nfloat error_of(float a, float b) {{\n  {declared} s = a + b;\n  {declared} t = s - a;\n  {declared} u = s - t;\n  \
         {declared} v = a - u;\n  {declared} w = b - t;\n  {declared} e = v + w;\n  return e;\n}}\n"
    )
}

#[test]
fn an_error_free_transformation_is_told_without_precise_and_silent_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let found = |declared: &str| {
        fs::write(folder.path().join("sum.glsl"), two_sum(declared)).unwrap();
        run_in(folder.path(), "fuzz sum.glsl --samples 4096 --lane embedded --notes").out
    };
    let loose = found("float");
    assert!(loose.contains("relies on rounding order"), "{loose}");
    let strict = found("precise float");
    assert!(!strict.contains("relies on rounding order"), "{strict}");
}

/// A sum with its error, by what its variables are declared as.
fn pair(declared: &str) -> String {
    format!(
        "#version 450\nvec2 two_sum(float a, float b) {{\n  {declared} s = a + b;\n  {declared} t = s - a;\n  \
         {declared} e = (a - (s - t)) + (b - t);\n  return vec2(s, e);\n}}\n"
    )
}

#[test]
fn a_pair_of_numbers_is_told_by_what_regrouping_costs() {
    let folder = tempfile::tempdir().unwrap();
    let found = |text: &str| {
        fs::write(folder.path().join("sum.glsl"), text).unwrap();
        run_in(folder.path(), "fuzz sum.glsl --samples 4096 --lane embedded --domain a=[-1,1] --domain b=[-1,1]").out
    };
    let loose = found(&pair("float"));
    assert!(loose.contains("relies on rounding order") && loose.contains("the error of both grows from"), "{loose}");
    assert!(!loose.contains("ill-conditioned"), "{loose}");
    let strict = found(&pair("precise float"));
    assert!(!strict.contains("rounding order") && !strict.contains("ill-conditioned"), "{strict}");
    // Two outputs of which one is 0 and right.
    let plain = found("#version 450\nvec2 two(float a, float b) { return vec2(a + b, (a - b) * 0.0); }\n");
    assert!(!plain.contains("rounding order"), "{plain}");
}

#[test]
fn one_transformation_is_told_once_and_a_coincidence_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let found = |text: &str| {
        fs::write(folder.path().join("sum.glsl"), text).unwrap();
        let command = "fuzz sum.glsl --samples 8192 --lane embedded --domain a=[-1,1] --domain b=[-1,1] --format json";
        run_in(folder.path(), command).json()["files"][0]["functions"][0]["findings"].clone()
    };
    // Two sums take rounding errors, on one way to the second output.
    let twice = "#version 450\nvec2 two(float a, float b) {\n    float s = a + b;\n    float v = s - a;\n    \
                 float low = (a - (s - v)) + (b - v);\n    float t = s + low;\n    return vec2(t, low + (s - t));\n}\n";
    let all = found(twice);
    let orders: Vec<_> = all.as_array().unwrap().iter().filter(|f| f["kind"] == "rounding_order").collect();
    assert_eq!(orders.len(), 1, "{all}");
}

#[test]
fn a_way_through_zero_is_no_warning_and_a_lost_digit_is() {
    let folder = tempfile::tempdir().unwrap();
    let found = |body: &str| {
        let text = format!("#version 450\nfloat f(float x, float y) {{ return {body}; }}\n");
        fs::write(folder.path().join("f.glsl"), text).unwrap();
        let command = "fuzz f.glsl --samples 65536 --lane embedded --domain x=[2,3.5] --domain y=[2,3.5] --format json";
        run_in(folder.path(), command).json()["files"][0]["functions"][0]["findings"].clone()
    };
    for body in ["x * y - 7.5", "x * 1.1 - y * 1.2"] {
        let all = found(body);
        assert!(!all.to_string().contains("ill_conditioned"), "{body}: {all}");
        let crossing = all.as_array().unwrap().iter().filter(|f| f["kind"] == "zero_crossing");
        let severities: Vec<_> = crossing.map(|f| f["severity"].clone()).collect();
        assert_eq!(severities, ["note"], "{body}: {all}");
    }
    // Twins that another formula mends, and one whose error is large beside all of its values.
    for body in ["exp(x * 1e-5) - 1.0 + y * 0.0", "fract(sin(x * 12.9898 + y * 78.233) * 43758.5453)"] {
        let all = found(body);
        assert!(all.to_string().contains("ill_conditioned"), "{body}: {all}");
    }
}

#[test]
fn an_overflow_inside_of_a_split_is_no_fault_of_the_lane() {
    let folder = tempfile::tempdir().unwrap();
    let text = "#version 450\nfloat high(float a) { precise float t = 4097.0 * a; precise float h = t - (t - a); return h; }\n";
    fs::write(folder.path().join("split.glsl"), text).unwrap();
    let ran = run_in(folder.path(), "fuzz split.glsl --samples 4096 --lane embedded --domain a=[8e34,9e34]").out;
    assert!(ran.contains("is too large for binary32") && !ran.contains("deviates"), "{ran}");
}

/// A device behind a translator; what it runs instead of what it is given.
struct Behind {
    lane: Box<dyn Lane>,
    description: Description,
    instead: Option<Kernel>,
}

impl Behind {
    fn new(name: &'static str, front_end: &str, instead: Option<Kernel>) -> Self {
        let lane = embedded::open().unwrap();
        let executor = "a device that rounds to nearest".to_owned();
        let description = Description { name, executor, front_end: front_end.to_owned(), ..lane.description().clone() };
        Self { lane, description, instead }
    }
}

impl Lane for Behind {
    fn description(&self) -> &Description {
        &self.description
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        self.lane.prepare(self.instead.as_ref().unwrap_or(kernel), capacity)
    }
}

/// Where the sum of two numbers is the larger one, rounded to nearest, and its error the smaller one.
const SUMMANDS: &str = "a=[1e30,2e30];b=[1,2]";

#[test]
fn a_device_that_was_not_told_of_precise_is_no_miscompiler() {
    let source = |text: &str| text.trim_start_matches("#version 450\n").to_owned();
    let subject = &functions("sum.glsl", &source(&pair("precise float")))[0];
    // It takes `(a + b) - a` for `b`, so that nothing is left of the error.
    let regrouped = &functions("sum.glsl", "vec2 two_sum(float a, float b) { return vec2(a + b, 0.0); }\n")[0];
    let kernel = regrouped.ready.as_ref().unwrap().kernel.clone();
    let nearest = || Promises::of_api(Api::Binary32);
    let lane = Behind::new("behind-naga", "naga", Some(kernel.clone()));
    let wrong = |report: &FunctionReport| -> Vec<Finding> {
        report.findings.iter().filter(|found| found.kind == FuzzFindingKind::LaneDeviation).cloned().collect()
    };
    let found = wrong(&on(subject, SUMMANDS, &lane, nearest()));
    let Some(Origin::PreciseLost { front_end }) = found[0].diagnosis.as_ref().unwrap().origin.clone() else {
        panic!("{found:?}")
    };
    assert_eq!((front_end.as_str(), found[0].severity), ("naga", Severity::Finding));
    // A twin that keeps the order is right, and where it has another translator, only what this tool puts between is at fault.
    let other = Behind::new("behind-glslang", "glslang", None);
    assert!(wrong(&on(subject, SUMMANDS, &other, nearest())).is_empty());
    let both: [(&dyn Lane, Promises); 2] = [(&lane, nearest()), (&other, nearest())];
    let found = wrong(&on_lanes(subject, SUMMANDS, &both));
    assert_eq!(found.iter().map(|found| found.severity).collect::<Vec<_>>(), [Severity::Note], "{found:?}");
    assert!(found[0].message.contains("the translator of this lane is at fault"), "{found:?}");
}

#[test]
fn what_rounding_in_either_direction_allows_is_held_against_no_device() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("sum.glsl"), pair("precise float")).unwrap();
    // A device that may round up gives the next number for `1e30 + 1.0`, and any error below that step for the second output.
    let ran = run_in(folder.path(), "fuzz sum.glsl --lane vulkan").expect(0);
    assert!(!ran.out.contains("deviates"), "{}", ran.out);
}

#[test]
fn a_time_and_a_screen_are_taken_as_far_as_they_come_on_phones() {
    let fuzzed = |name: &str| run(&format!("fuzz fixtures/precision/{name} --lane embedded --samples 4096"));
    let ran = fuzzed("clock.frag").expect(0);
    assert!(ran.out.contains("digits are lost at `mediump`"), "{}", ran.out);
    assert!(ran.out.contains("(taken: `u_time` for a time of up to 3600)"), "{}", ran.out);
    let ran = fuzzed("phone.frag").expect(0);
    assert!(ran.out.contains("overflow at `mediump`"), "{}", ran.out);
    assert!(ran.err.contains("asks for OpenGL ES"), "{}", ran.err);
    // The twin states `highp`.
    let folder = tempfile::tempdir().unwrap();
    for name in ["clock.frag", "phone.frag"] {
        let text = fs::read_to_string(crate::binary::root().join("fixtures/precision").join(name)).unwrap();
        fs::write(folder.path().join(name), text.replace("mediump", "highp")).unwrap();
        let ran = run_in(folder.path(), &format!("fuzz {name} --lane embedded --samples 4096")).expect(0);
        assert!(!ran.out.contains("mediump"), "{}", ran.out);
    }
}
