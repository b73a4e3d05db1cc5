//! Faults in shaders. The shipped shaders are the ones without a fault.

use serde_json::Value;

use crate::binary::{run, strings};

/// Runs a shader of `fixtures/alarms` under a shipped suite: it fails, and on each stage the first
/// finding is a deviation whose message holds `said`. Gives the findings of each stage.
#[track_caller]
fn rings(suite: &str, shader: &str, said: &str) -> Vec<Value> {
    let ran = run(&format!("check {suite} --shader fixtures/alarms/{shader} --samples 300 --format json")).expect(1);
    let json = ran.json();
    assert_eq!(json["status"], "fail");
    let entries = json["suites"].as_array().unwrap();
    assert!(!entries.is_empty());
    let findings = entries.iter().map(|entry| {
        assert!(entry["deviated"].as_u64() > Some(0), "{entry:#}");
        assert_eq!(entry["findings"][0]["kind"], "deviation", "{entry:#}");
        let message = entry["findings"][0]["message"].as_str().unwrap();
        assert!(message.starts_with("the shader deviates from its formula: ") && message.contains(said), "{message}");
        assert_eq!(entry["findings"][0]["case"]["blame"], "shader", "{entry:#}");
        assert_eq!(entry["shader_deviated"], entry["deviated"], "no fault is the lane's: {entry:#}");
        entry["findings"].clone()
    });
    findings.collect()
}

#[test]
fn shaders_without_a_fault_pass() {
    for (suite, shader) in [("sphere", "chapter9/sphere.vert"), ("hair", "hair/hair.geom")] {
        let ran = run(&format!("check {suite} --shader shaders/{shader} --samples 300 --format json")).expect(0);
        assert_eq!(ran.json()["status"], "pass");
    }
}

#[test]
fn one_part_in_ten_thousand_is_found() {
    rings("sphere", "sphere_off.vert", "is 1.0001, expected 1.0");
}

#[test]
fn swapped_columns_are_found() {
    rings("sphere", "sphere_columns.vert", "`gl_Position.");
}

#[test]
fn a_wrong_w_is_found() {
    rings("sphere", "sphere_w.vert", "`gl_Position.w` is 0.0");
}

#[test]
fn nan_is_found() {
    rings("sphere", "sphere_nan.vert", "nan");
}

#[test]
fn an_output_that_is_not_written_is_found() {
    rings("sphere", "sphere_unwritten.vert", "`gl_Position.x` is not written");
}

#[test]
fn a_wrong_last_vertex_is_found() {
    rings("hair", "hair_last.geom", "of vertex 4 is");
}

#[test]
fn a_missing_vertex_is_found() {
    rings("hair", "hair_few.geom", "4 vertices emitted, expected 5");
}

#[test]
fn vertices_beyond_max_vertices_are_found() {
    rings("hair", "hair_many.geom", "6 vertices emitted, `max_vertices` is 5");
}

#[test]
fn a_strip_that_ends_early_is_found() {
    rings("hair", "hair_strips.geom", "vertex 2 begins a strip, and should not");
}

#[test]
fn relations_are_found_broken_with_a_minimal_case() {
    for findings in rings("sphere", "sphere_turn.vert", "`gl_Position.x` is 0.9999998") {
        let seam =
            findings.as_array().unwrap().iter().find(|f| f["message"].as_str().unwrap().contains("surface_seam"));
        let seam = seam.unwrap_or_else(|| panic!("{findings:#}"));
        assert_eq!(seam["kind"], "relation");
        assert!(seam["message"].as_str().unwrap().contains("s = 0 and s = 1 give the same point"), "{seam:#}");
        minimal(&seam["case"]);
        assert!(seam["reproduce"].as_str().unwrap().starts_with("shadercheck check sphere --shader "));
    }
}

#[test]
fn a_deviation_shrinks_to_few_bits_and_the_identity() {
    for findings in rings("sphere", "sphere_swapped.vert", "`gl_Position.") {
        assert_eq!(findings.as_array().unwrap().len(), 1, "{findings:#}");
        minimal(&findings[0]["case"]);
        assert!(findings[0]["case"]["rounds"].as_u64() > Some(0));
    }
}

/// The parameter is made of halves and quarters, and the matrix is the identity.
#[track_caller]
fn minimal(case: &Value) {
    let inputs = &case["inputs"];
    assert_eq!(strings(inputs, "name"), ["vec2 parameter", "mat4 mc"]);
    for value in inputs[0]["decimal"].as_array().unwrap() {
        assert!(["0.0", "0.25", "0.5", "0.75", "1.0"].contains(&value.as_str().unwrap()), "{inputs:#}");
    }
    for (k, word) in inputs[1]["bits"].as_array().unwrap().iter().enumerate() {
        assert_eq!(word, if k % 5 == 0 { "0x3f800000" } else { "0x00000000" }, "{inputs:#}");
    }
}

#[test]
fn a_shader_that_does_not_compile_is_reported_with_its_place() {
    let ran = run("check sphere --shader fixtures/alarms/sphere_syntax.vert").expect(1);
    assert!(ran.out.contains("does not compile"), "{}", ran.out);
    assert!(ran.out.contains("`q` is not declared"), "{}", ran.out);
    // The column counts characters: a comment in Japanese stands before it.
    assert!(ran.out.contains("fixtures/alarms/sphere_syntax.vert:15:31"), "{}", ran.out);
    assert!(ran.out.contains("fail: 0 judged"), "{}", ran.out);
}

#[test]
fn the_printed_cylinder_does_not_compile() {
    let ran = run("check cylinder --shader fixtures/printed/cylinder.vert --format json").expect(1);
    let finding = &ran.json()["suites"][0]["findings"][0];
    assert_eq!(finding["kind"], "compile");
    assert_eq!(finding["file"], "fixtures/printed/cylinder.vert");
    assert_eq!((&finding["line"], &finding["column"]), (&13.into(), &23.into()));
}

#[test]
fn the_short_pi_of_the_printed_sphere_is_a_warning_and_exactly_a_deviation_of_the_shader_and_lint_tells_it() {
    let short = "fixtures/printed/sphere.vert";
    let ran = run(&format!("check sphere --shader {short} --samples 8192 --format json")).expect(0);
    for entry in ran.json()["suites"].as_array().unwrap() {
        assert_eq!(entry["deviated"], 0, "{entry:#}");
        let found = entry["findings"].as_array().unwrap();
        let found = found.iter().filter(|finding| finding["kind"] == "rounded_literal");
        let said: Vec<&str> = found.map(|finding| finding["message"].as_str().unwrap()).collect();
        let reported = |place: &str, name: &str| said.iter().any(|m| m.contains(place) && m.contains(name));
        assert!(
            said.len() == 2 && reported(":11:14", "2π in 7 digits") && reported("`3.141593`", "π in 7 digits"),
            "{said:?}"
        );
    }
    // Both literals are one binary32 number beside the nearest one, less than the roundings of the rest:
    // no comparison with a lane shows them, and one in binary64 does.
    let ran = run(&format!("check sphere --shader {short} --samples 8192 --strict-literals --format json")).expect(1);
    for entry in ran.json()["suites"].as_array().unwrap() {
        let count = |key: &str| entry[key].as_u64().unwrap();
        // Where an angle is 0 its literal says nothing.
        assert!(count("shader_deviated") > 8192 * 9 / 10, "{entry:#}");
        assert_eq!(count("shader_deviated"), count("deviated"), "{entry:#}");
        let case = &entry["findings"][0]["case"];
        assert_eq!(case["blame"], "shader");
        let number = |key: &str| case[key].as_f64().unwrap_or_else(|| panic!("{key}: {case:#}"));
        // 3.141593 is 3.5e-7 beyond π, and 6.283185 is 3.1e-7 below 2π.
        assert!((1e-9..5e-7).contains(&(number("meaning") - number("expected")).abs()), "{case:#}");
    }
    run("check sphere --samples 8192").expect(0);
    let ran = run(&format!("lint {short} --format concise")).expect(0);
    assert!(ran.out.contains(":11:14: info[N014 low-precision-pi]: `6.283185` stands for 2π"), "{}", ran.out);
}

#[test]
fn a_shader_of_another_stage_or_interface_does_not_fit_the_suite() {
    let ran = run("check cylinder --shader shaders/chapter9/morph.vert").expect(2);
    assert!(ran.out.contains("the formula `cylinder` needs an input `parameter` of type `vec2`; the shader has"));
    assert!(ran.out.contains("not run: 0 judged"), "{}", ran.out);
    let ran = run("check sphere --shader shaders/hair/hair.geom").expect(1);
    assert!(ran.out.contains("it belongs to the geometry stage, and this is a vertex shader"), "{}", ran.out);
    let ran = run("check hermite --shader shaders/hair/cardinal.glsl").expect(1);
    assert!(ran.out.contains("there is no function `hermite`"), "{}", ran.out);
    assert!(ran.out.contains("the file defines: cardinal"), "{}", ran.out);
}
