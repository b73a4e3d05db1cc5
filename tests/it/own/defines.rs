//! Macros: each combination is a variant with a name of its own.

use super::{check, finding, folder, suite};
use crate::binary::{command, run_reported};

const SHADER: &str = "#ifndef STEPS\n#define STEPS 1\n#endif\nfloat f(float x) {\n  float y = x;\n\
    for (int i = 0; i < STEPS; i++) y = 0.5 * y + 0.25;\n#ifdef ROUND\n  y = floor(y);\n#endif\n\
    return y + OFFSET;\n}\n";

#[test]
fn every_combination_is_run_under_its_name() {
    let text = suite(&["x"], "defines = { STEPS = [1, 3], ROUND = [true, false], OFFSET = \"(1.0 + 2.0)\" }");
    let ran = check(&[("f.glsl", SHADER), ("f.suite.toml", &text)], &[]).expect(0);
    let lines = ran.out.lines().filter(|line| line.starts_with("ok "));
    let names: Vec<&str> = lines.map(|line| line.split_whitespace().nth(1).unwrap()).collect();
    assert_eq!(names.len(), 4, "{}", ran.out);
    assert_eq!(names[0], "own[OFFSET=(1.0_+_2.0),ROUND=1,STEPS=1]", "{}", ran.out);
    assert!(names[3].contains("no-ROUND,STEPS=3"), "{}", ran.out);
}

#[test]
fn a_fault_of_one_variant_is_reported_with_its_name_and_shown_again() {
    let text = suite(
        &["x"],
        "relations = [{ kind = \"range\", range = [-2.5, 2.5] }]\ndefines = { OFFSET = [0.0, 1.5], STEPS = 1 }",
    );
    let files = [("f.glsl", SHADER), ("f.suite.toml", &*text)];
    let ran = check(&files, &[]).expect(1);
    assert!(
        ran.out.contains("ok    own[OFFSET=0.0,STEPS=1]") && ran.out.contains("FAIL  own[OFFSET=1.5,STEPS=1]"),
        "{}",
        ran.out
    );
    assert_eq!(finding(&ran).1, ["float x = 2.0"]);
    let line = ran.out.lines().find_map(|line| line.strip_prefix("  reproduce  ")).unwrap();
    assert!(line.contains("'./f.suite.toml[OFFSET=1.5,STEPS=1]'"), "{line}");
    let folder = folder(&files);
    let again = run_reported(folder.path(), line, &[]).expect(1);
    assert!(
        again.out.contains("the relation `range` does not hold") && !again.out.contains("OFFSET=0.0"),
        "{}",
        again.out
    );
    let ran: crate::binary::Ran = command(folder.path(), "check f.suite.toml[STEPS=9]").output().unwrap().into();
    assert!(ran.expect(2).err.contains("has no variant `[STEPS=9]`"));
}

#[test]
fn a_macro_that_the_text_defines_itself_is_reported() {
    let text = suite(&["x"], "defines = { STEPS = 2 }");
    let shader = "#define STEPS 1\nfloat f(float x) { return x * float(STEPS); }\n";
    let ran = check(&[("f.glsl", shader), ("f.suite.toml", &text)], &[]).expect(1);
    assert!(ran.out.contains("f.glsl:1:9") && ran.out.contains("`#ifndef STEPS`"), "{}", ran.out);
}

#[test]
fn places_in_the_shader_stay_what_they_are() {
    let text = suite(&["x"], "defines = { STEPS = 2 }");
    let ran = check(&[("f.glsl", "float f(float x) {\n  return y * float(STEPS);\n}\n"), ("f.suite.toml", &text)], &[])
        .expect(1);
    assert!(ran.out.contains("f.glsl:2:10"), "{}", ran.out);
}

#[test]
fn macros_that_make_no_sense_are_refused() {
    for (defines, reported) in [
        ("{ 3D = 1 }", "`3D` cannot be the name of a macro"),
        ("{ GL_ES = 1 }", "`GL_ES` cannot be the name of a macro"),
        ("{ A = [] }", "`A` has no values"),
        ("{ A = [1, 1] }", "`1` stands twice in `A`"),
        ("{ A = [[1]] }", "`A` is a text of one line, a number, true or false"),
        ("{ A = [1,2,3,4,5,6,7,8,9], B = [1,2,3,4,5,6,7,8] }", "more than 64 combinations"),
    ] {
        let text = suite(&["x"], &format!("defines = {defines}"));
        let ran = check(&[("f.glsl", SHADER), ("f.suite.toml", &text)], &[]).expect(2);
        assert!(ran.err.contains(reported), "{reported}\n{}", ran.err);
    }
}
