//! The report for programs: keys may be added, and are never renamed.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::binary::{root, run};
use crate::schema::{closed, conforms};

#[track_caller]
fn has(value: &Value, keys: &[&str]) {
    let object = value.as_object().unwrap_or_else(|| panic!("no object: {value:#}"));
    let missing: BTreeSet<_> = keys.iter().filter(|key| !object.contains_key(**key)).collect();
    assert!(missing.is_empty(), "{missing:?} are missing in {value:#}");
}

const RUN: [&str; 5] = ["status", "seed", "lanes", "suites", "totals"];
const LANE: [&str; 7] = ["name", "stage", "driver", "api", "promise", "conformance", "measured"];
const SUITE: [&str; 11] = [
    "suite",
    "shader",
    "lane",
    "stage",
    "judged",
    "agreed",
    "deviated",
    "undetermined",
    "unsupported",
    "max_ulp",
    "findings",
];
const PROMISES: [&str; 4] = ["text", "conformance", "rearranged", "measured"];
const REASONS: [&str; 8] =
    ["domain", "no_promise", "ill_conditioned", "branch", "texel_edge", "long_loop", "underflow", "overflow"];

/// What a report breaks of `docs/check.schema.json`, which lists every key that this version writes.
fn faults(report: &Value) -> Vec<String> {
    let schema = std::fs::read_to_string(root().join("docs/check.schema.json")).unwrap();
    let schema = closed(serde_json::from_str(&schema).unwrap());
    let mut faults = Vec::new();
    conforms(&schema, &schema, report, "", &mut faults);
    faults
}

#[test]
fn reports_follow_the_schema() {
    for (args, status) in [
        ("check --shipped --samples 64", 0),
        ("check sphere --samples 64 --sources", 0),
        ("check sphere --shader fixtures/alarms/sphere_swapped.vert --samples 64", 1),
        ("check sphere --shader fixtures/alarms/sphere_turn.vert --samples 64 --lane embedded", 1),
        ("check sphere --shader fixtures/alarms/sphere_nan.vert --samples 64 --lane embedded", 1),
        ("check sphere --shader fixtures/alarms/sphere_syntax.vert --samples 64", 1),
        ("check hair --shader fixtures/alarms/hair_few.geom --samples 64", 1),
        ("check shaders/kernels/sum.suite.toml[N=70001] --lane embedded", 0),
        ("check fixtures/alarms/floor.suite.toml --samples 64", 1),
    ] {
        let report = run(&format!("{args} --format json")).expect(status).json();
        assert_eq!(faults(&report), Vec::<String>::new(), "{args}");
    }
}

#[test]
fn a_report_that_breaks_the_schema_is_found() {
    let args = "check sphere --shader fixtures/alarms/sphere_swapped.vert --samples 64 --lane embedded --format json";
    let report = run(args).expect(1).json();
    for (pointer, key, wrong) in [
        ("", "status", Value::from("passed")),
        ("/totals", "judged", Value::from(-1)),
        ("/suites/0", "surprise", Value::from(1)),
        ("/suites/0/findings/0", "kind", Value::from("deviatoin")),
        ("/suites/0/findings/0/case", "rounds", Value::from("3")),
        ("/suites/0/findings/0/case/inputs/0", "bits", Value::from(vec!["3f800000"])),
    ] {
        let mut broken = report.clone();
        broken.pointer_mut(pointer).unwrap()[key] = wrong;
        assert!(!faults(&broken).is_empty(), "{pointer}/{key}");
    }
    let mut short = report;
    short["suites"][0].as_object_mut().unwrap().remove("known");
    assert_eq!(faults(&short), ["/suites/0: `known` is missing"]);
}

#[test]
fn a_run_that_passes_has_all_keys() {
    let json = run("check sphere hermite --samples 300 --seed 7 --lane vulkan --format json").expect(0).json();
    has(&json, &RUN);
    assert_eq!((&json["status"], &json["seed"]), (&"pass".into(), &7.into()));
    for lane in json["lanes"].as_array().unwrap() {
        has(lane, &LANE);
        assert_eq!(lane["name"], "vulkan");
        assert!(lane["driver"].as_str().is_some_and(|d| !d.is_empty()));
    }
    let suites = json["suites"].as_array().unwrap();
    let on: Vec<_> = suites.iter().map(|s| (s["suite"].as_str().unwrap(), s["stage"].as_str().unwrap())).collect();
    assert_eq!(on, [("sphere", "compute"), ("sphere", "vertex"), ("hermite", "compute")]);
    let mut judged = 0;
    for suite in suites {
        has(suite, &SUITE);
        let count = |key: &str| suite[key].as_u64().unwrap_or_else(|| panic!("{key}: {suite:#}"));
        // Cases are never cut: 19 of 16 samples.
        assert_eq!(count("judged") + count("undetermined"), 304);
        assert_eq!(count("agreed") + count("deviated"), count("judged"));
        assert_eq!((count("deviated"), count("shader_deviated"), count("unsupported")), (0, 0, 0));
        let sum = |key: &str, names: &[&str]| -> u64 {
            has(&suite[key], names);
            assert_eq!(suite[key].as_object().unwrap().len(), names.len(), "{suite:#}");
            names.iter().map(|name| suite[key][name].as_u64().unwrap()).sum()
        };
        assert_eq!(sum("agreed_by", &PROMISES), count("agreed"));
        assert_eq!(sum("undetermined_by", &REASONS), count("undetermined"));
        assert!(suite["max_ulp"].as_f64().is_some_and(|u| u > 0.0));
        assert_eq!(suite["findings"], Value::Array(Vec::new()));
        judged += count("judged");
    }
    assert_eq!(json["totals"]["judged"], judged);
}

#[test]
fn a_deviation_has_its_case_with_bits_and_the_command() {
    let shader = "fixtures/alarms/sphere_swapped.vert";
    let json = run(&format!("check sphere --shader {shader} --samples 300 --format json")).expect(1).json();
    assert_eq!(json["status"], "fail");
    let suite = &json["suites"][0];
    has(suite, &SUITE);
    assert_eq!(suite["shader"], shader);
    let finding = &suite["findings"][0];
    has(finding, &["kind", "message", "samples", "case", "reproduce"]);
    assert_eq!(finding["samples"], suite["deviated"]);
    let case = &finding["case"];
    has(case, &["inputs", "blame", "component", "expected", "meaning", "actual", "actual_bits", "bound", "ulp"]);
    assert_eq!(case["blame"], "shader");
    assert_eq!(suite["shader_deviated"], suite["deviated"]);
    assert!(!case.as_object().unwrap().contains_key("tolerance"), "{case:#}");
    for input in case["inputs"].as_array().unwrap() {
        let (bits, decimal) = (input["bits"].as_array().unwrap(), input["decimal"].as_array().unwrap());
        assert_eq!(bits.len(), decimal.len());
        for (bits, decimal) in bits.iter().zip(decimal) {
            let word = u32::from_str_radix(bits.as_str().unwrap().strip_prefix("0x").unwrap(), 16).unwrap();
            assert_eq!(f32::from_bits(word), decimal.as_str().unwrap().parse::<f32>().unwrap());
        }
    }
    let number = |key: &str| case[key].as_f64().unwrap_or_else(|| panic!("{key}: {case:#}"));
    assert!((number("expected") - number("meaning")).abs() > number("bound"), "{case:#}");
    // Two evaluations in binary64 are compared, and no lane: next to nothing is allowed.
    assert!(number("bound") < 1e-9, "{case:#}");
    let bits = u32::from_str_radix(case["actual_bits"].as_str().unwrap().strip_prefix("0x").unwrap(), 16).unwrap();
    assert_eq!(f64::from(f32::from_bits(bits)), number("actual"));
}

#[test]
fn nan_is_no_number_in_json_and_does_not_break_it() {
    let shader = "fixtures/alarms/sphere_nan.vert";
    let json = run(&format!("check sphere --shader {shader} --samples 300 --format json")).expect(1).json();
    let case = &json["suites"][0]["findings"][0]["case"];
    assert_eq!(case["actual"], Value::Null);
    let bits = u32::from_str_radix(case["actual_bits"].as_str().unwrap().trim_start_matches("0x"), 16).unwrap();
    assert!(f32::from_bits(bits).is_nan());
}

#[test]
fn a_suite_that_does_not_fit_is_in_the_report() {
    let ran = run("check cylinder --shader shaders/chapter9/morph.vert --format json").expect(2);
    let json = ran.json();
    assert_eq!(json["status"], "fail");
    has(&json["suites"][0], &SUITE);
    assert_eq!(json["suites"][0]["findings"][0]["kind"], "configuration");
}

#[test]
fn nothing_but_json_is_on_standard_output() {
    let ran = run("check hermite --samples 100 --format json").expect(0);
    assert!(ran.out.starts_with('{') && ran.out.ends_with("}\n"), "{}", ran.out);
    assert_eq!(ran.err, "");
}

#[test]
fn translations_are_reported_once_a_suite() {
    let json = run("check sphere --samples 300 --lane vulkan --format json").expect(0).json();
    let suites = json["suites"].as_array().unwrap();
    let reported: Vec<_> = suites.iter().map(|s| s["translations"].as_array().unwrap()).collect();
    assert_eq!(reported.iter().map(|t| t.len()).collect::<Vec<_>>(), [4, 0]);
    for (translation, language) in reported[0].iter().zip(["spirv", "wgsl", "glsl450", "naga-glsl"]) {
        has(translation, &["language", "agreed", "deviated", "undetermined", "unsupported"]);
        assert_eq!((&translation["language"], &translation["agreed"]), (&language.into(), &304.into()));
    }
    let text = run("check sphere hermite --samples 300 --lane vulkan").expect(0).out;
    let line = "note: translations agree with the shader: spirv, wgsl, glsl450 (608 samples, 2 suites)";
    assert_eq!(text.matches(line).count(), 1, "{text}");
}
