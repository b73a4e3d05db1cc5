//! `shadercheck improve`: better formulas are found, proved and written; sound ones are left alone; and what cannot be
//! improved is said.

use std::fs;

use serde_json::Value;

use crate::binary::{Ran, root, run_in};

/// Runs on a copy of the fixtures, so that nothing is written beside them.
fn improved(arguments: &str) -> (Ran, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    for file in fs::read_dir(root().join("fixtures/improve")).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    (run_in(folder.path(), &format!("improve {arguments} --samples 65536")), folder)
}

fn expression<'r>(report: &'r Value, function: &str) -> &'r Value {
    let all = report["files"][0]["expressions"].as_array().unwrap();
    all.iter().find(|one| one["function"] == function).unwrap_or_else(|| panic!("{function}: {report}"))
}

fn mean(of: &Value) -> f64 {
    of["lost"]["mean"].as_f64().unwrap()
}

#[test]
fn each_planted_formula_gets_a_better_one_that_is_proved() {
    let report = improved("formulas.glsl --format json").0.expect(1).json();
    for function in ["mercatorY", "haversine", "rootStep", "growth"] {
        let one = expression(&report, function);
        let best = &one["proposals"][0];
        assert!(mean(best) < 0.75 * mean(one), "{one}");
        let proof = &best["proof"];
        assert!(proof["points"].as_u64().unwrap() > 60_000, "{proof}");
        assert!(best["lanes"][0]["samples"].as_u64().unwrap() > 4_000 && !best["text"].as_str().unwrap().is_empty());
        let most = one["proposals"].as_array().unwrap().len();
        assert!((1..=3).contains(&most), "{most}");
    }
    for one in report["files"][0]["expressions"].as_array().unwrap() {
        is_worse_nowhere(one);
    }
    // The difference and what is made of it, each with the variables before it written out.
    let all = report["files"][0]["expressions"].as_array().unwrap();
    let inlined =
        all.iter().filter(|one| one["function"] == "haversine").map(|one| one["inlined"].as_array().unwrap().len());
    assert_eq!(inlined.collect::<Vec<_>>(), [1, 2]);
}

/// No proposal rests on functions that a device makes of exponentials, or loses more on a device that ships.
fn is_worse_nowhere(expression: &Value) {
    for one in expression["proposals"].as_array().unwrap() {
        let (text, devices) = (one["text"].as_str().unwrap(), one["devices"].as_array().unwrap());
        assert!(!text.contains("sinh(") && !text.contains("tanh(") && !text.contains("cosh("), "{text}");
        assert!(devices.iter().any(|device| device["name"].as_str().unwrap().starts_with("llvmpipe")), "{one}");
        for device in devices {
            let [before, after] = ["before", "after"].map(|side| device[side]["mean"].as_f64().unwrap());
            assert!(after <= before + 0.02, "{text}: {device}");
        }
    }
}

#[test]
fn functions_that_devices_make_of_others_are_offered_for_a_profile_that_has_them() {
    let of = |arguments: &str| {
        let report = improved(&format!("formulas.glsl --function mercatorY --format json {arguments}")).0.json();
        expression(&report, "mercatorY")["proposals"].to_string()
    };
    let rounded = of("--profile binary32");
    assert!(rounded.contains("asinh(tan(") || rounded.contains("atanh("), "{rounded}");
    let shipped = of("");
    assert!(!shipped.contains("asinh(") && !shipped.contains("atanh("), "{shipped}");
}

#[test]
fn hashes_are_no_offer() {
    let folder = tempfile::tempdir().unwrap();
    let text = "#version 330\nfloat hash(vec2 p) { return fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453); }\n\
                // shadercheck: x in [0, 100000]\nfloat rise(float x) { return sqrt(x + 1.0) - sqrt(x); }\n";
    fs::write(folder.path().join("noise.glsl"), text).unwrap();
    let report = run_in(folder.path(), "improve noise.glsl --samples 4096 --format json").expect(1).json();
    let all = report["files"][0]["expressions"].as_array().unwrap();
    assert_eq!((all.len(), &all[0]["function"]), (1, &"rise".into()), "{report}");
}

#[test]
fn sound_twins_are_left_alone() {
    let (ran, _) = improved("sound.glsl --format json");
    let report = ran.expect(0).json();
    assert_eq!(report["status"], "clean", "{report}");
}

/// The first proposal of each function with how much it loses less, and its text.
fn proposals(report: &Value, functions: &[&str]) -> Vec<String> {
    let best = |function: &&str| {
        let one = expression(report, function);
        let best = &one["proposals"][0];
        assert!(mean(best) < 0.75 * mean(one), "{one}");
        best["text"].as_str().unwrap().to_owned()
    };
    functions.iter().map(best).collect()
}

#[test]
fn wgsl_is_improved_in_its_own_words() {
    let (ran, folder) = improved("formulas.wgsl --fix --format json");
    let report = ran.expect(0).json();
    let functions = ["haversine", "root_step", "far", "direction_of", "nearer"];
    let texts = proposals(&report, &functions);
    assert!(!texts.iter().any(|text| text.contains('?')), "{texts:?}");
    assert!(texts[2].contains("length(a / ") && texts[3].contains("length(v / "), "{texts:?}");
    assert!(texts[4].contains("dot(p - q, p + q)"), "{texts:?}");
    // What was written compiles, and means the same.
    let own = root().join("fixtures/improve/formulas.wgsl");
    fs::copy(own, folder.path().join("own.wgsl")).unwrap();
    let equal = "--function far --function direction_of --function nearer";
    run_in(folder.path(), &format!("compare own.wgsl formulas.wgsl {equal} --lane embedded --samples 512")).expect(0);
    let (sound, _) = improved("sound.wgsl --format json");
    assert_eq!(sound.expect(0).json()["status"], "clean");
}

#[test]
fn vectors_of_glsl_get_better_formulas() {
    let (ran, folder) = improved("vectors.glsl --fix --format json");
    let report = ran.expect(0).json();
    let texts = proposals(&report, &["apart", "directionOf", "byRoot", "angleBetween", "further"]);
    assert!(texts[0].contains("length((a - b) / ") && texts[1].starts_with("v / "), "{texts:?}");
    assert!(texts[3].contains("length(cross(u, ") && texts[4].contains("dot(q - p, q + p)"), "{texts:?}");
    let own = root().join("fixtures/improve/vectors.glsl");
    fs::copy(own, folder.path().join("own.glsl")).unwrap();
    let equal = "--function apart --function byRoot --function further";
    run_in(folder.path(), &format!("compare own.glsl vectors.glsl {equal} --lane embedded --samples 512")).expect(0);
}

#[test]
fn halves_are_left_alone_and_told() {
    let ran = improved("halves.wgsl --function half_of").0.expect(0);
    assert!(ran.out.contains("`half_of` was not looked at: it has numbers of `f16`"), "{}", ran.out);
}

#[test]
fn what_has_no_halves_is_improved_beside_them() {
    let ran = improved("mixed.wgsl").0.expect(1);
    assert!(ran.out.contains("`scaled` was not looked at: it has numbers of `f16`"), "{}", ran.out);
    assert!(!ran.out.contains("`step_of` was not looked at"), "{}", ran.out);
    assert!(ran.out.contains("1.0 / (sqrt(x + 1.0) + sqrt(x))"), "{}", ran.out);
}

#[test]
fn nothing_is_written_without_fix_and_a_fixed_file_has_nothing_left() {
    let (ran, folder) = improved("formulas.glsl --function growth");
    let ran = ran.expect(1);
    let own = fs::read_to_string(root().join("fixtures/improve/formulas.glsl")).unwrap();
    let path = folder.path().join("formulas.glsl");
    assert_eq!(fs::read_to_string(&path).unwrap(), own);
    assert!(ran.out.contains("--- formulas.glsl") && ran.out.contains("-    return exp(x) - 1.0;"), "{}", ran.out);
    run_in(folder.path(), "improve formulas.glsl --function growth --samples 4096 --fix").expect(0);
    let changed = fs::read_to_string(&path).unwrap();
    assert!(changed != own && !changed.contains("return exp(x) - 1.0;"), "{changed}");
    run_in(folder.path(), "improve formulas.glsl --function growth --samples 4096").expect(0);
    run_in(folder.path(), "compare formulas.glsl formulas.glsl --lane embedded --samples 512").expect(0);
}

#[test]
fn a_line_chooses_expressions() {
    let own = fs::read_to_string(root().join("fixtures/improve/formulas.glsl")).unwrap();
    let line = own.lines().position(|line| line.contains("sqrt(x + 1.0)")).unwrap() + 1;
    let report = improved(&format!("formulas.glsl:{line} --format json")).0.expect(1).json();
    let all = report["files"][0]["expressions"].as_array().unwrap();
    assert_eq!((all.len(), &all[0]["function"]), (1, &"rootStep".into()));
}

#[test]
fn poles_textures_and_branches_are_told() {
    let report = improved("poles.glsl --format json").0.expect(1).json();
    let root = expression(&report, "rootStep");
    assert!(root["without_value"].as_u64().unwrap() > 20, "{root}");
    assert!(root["pole"][0]["value"].as_f64().unwrap() < 0.0, "{root}");
    let textured = expression(&report, "textured");
    assert!(textured["inputs"].to_string().contains("texture"), "{textured}");
    assert!(textured["proposals"][0]["text"].as_str().unwrap().contains("texture("), "{textured}");
    assert!(!expression(&report, "branched")["proposals"].as_array().unwrap().is_empty());
}

#[test]
fn lint_offers_what_is_proved_and_writes_it() {
    let folder = tempfile::tempdir().unwrap();
    let text = "#version 450\n// shadercheck: x in [-0.5, 0.5]\nfloat versine(float x) {\n    float y = 1.0 - cos(x);\n    return y;\n}\n";
    fs::write(folder.path().join("curve.glsl"), text).unwrap();
    let found = run_in(folder.path(), "lint curve.glsl --level strict --select N022 --prove --lang en");
    let out = found.out;
    assert!(out.contains("equal in real numbers at ") && out.contains("the bound of a device is 0."), "{out}");
    let patch = run_in(folder.path(), "lint curve.glsl --level strict --select N022 --prove --diff --lang en");
    assert!(
        patch.out.contains("-    float y = 1.0 - cos(x);") && patch.err.contains("equal in real numbers"),
        "{}",
        patch.err
    );
    assert_eq!(fs::read_to_string(folder.path().join("curve.glsl")).unwrap(), text);
    run_in(folder.path(), "lint curve.glsl --level strict --select N022 --prove --fix --lang en").expect(0);
    let changed = fs::read_to_string(folder.path().join("curve.glsl")).unwrap();
    assert!(changed.contains("float y = ") && !changed.contains("cos(x)"), "{changed}");
    // What loses nothing over its range keeps the repair of the rule, which is not proved.
    let wide = "#version 450\n// shadercheck: x in [1.5, 2]\nfloat versine(float x) {\n    return 1.0 - cos(x);\n}\n";
    fs::write(folder.path().join("curve.glsl"), wide).unwrap();
    let found = run_in(folder.path(), "lint curve.glsl --level strict --select N022 --prove --lang en");
    assert!(!found.out.contains("equal in real numbers"), "{}", found.out);
}

#[test]
fn ranges_without_an_end_and_empty_ones_are_errors() {
    let ran = improved("unbounded.glsl").0.expect(2);
    assert!(ran.err.contains("a range without an end") && ran.err.contains("--domain 'x=["), "{}", ran.err);
    let ran = improved("formulas.glsl --domain x=[2,1]").0.expect(2);
    assert!(ran.err.contains("is empty"), "{}", ran.err);
    improved("unbounded.glsl --domain x=[1,1000]").0.expect(1);
    let ran = improved("nothing.glsl").0.expect(2);
    assert!(ran.err.contains("nothing.glsl"), "{}", ran.err);
}

#[test]
fn no_way_to_write_pi_is_ill_conditioned() {
    let ran = run_in(&root().join("fixtures/improve"), "fuzz pi.glsl --lane embedded --samples 4096 --format json");
    let report = ran.expect(0).json();
    let functions = report["files"][0]["functions"].as_array().unwrap();
    assert!(functions.len() >= 12, "{}", functions.len());
    for function in functions {
        let kinds = function["findings"].to_string();
        assert!(!kinds.contains("ill_conditioned"), "{function}");
    }
}
