//! Documents on the command line: `lint`, `fuzz` and `check --shader` read the shaders that they print.

use std::fs;

use crate::binary::{root, run, run_in};

const CHAPTER: &str = "fixtures/documents/chapter.md";

#[test]
fn findings_have_the_place_in_the_document() {
    let ran = run(&format!("lint {CHAPTER} --lang en --format concise")).expect(1);
    let grave: Vec<&str> = ran.out.lines().filter(|l| !l.contains(": info[")).collect();
    let starts = ["44:23: error[T001", "64:13: error[H029", "78:60: error[H004", "115:15: error[H001"];
    assert_eq!(grave.len(), starts.len(), "{}", ran.out);
    for (line, start) in grave.iter().zip(starts) {
        assert!(line.starts_with(&format!("{CHAPTER}:{start}")), "{line}");
    }
}

#[test]
fn repairs_are_written_into_the_document() {
    let folder = tempfile::tempdir().unwrap();
    let before = fs::read_to_string(root().join(CHAPTER)).unwrap();
    fs::write(folder.path().join("notes.txt"), &before).unwrap();
    run_in(folder.path(), "lint notes.txt --fix --unsafe-fixes --select T,H").expect(0);
    let after = fs::read_to_string(folder.path().join("notes.txt")).unwrap();
    let expected = before
        .replace("vec4 p = vec3(", "vec4 p = vec4(")
        .replace("attribute[k]", "parameter[k]")
        .replace("glGetAttribLocation(program, \"p1\")", "glGetAttribLocation(program, \"parameter\")")
        .replace("glGetUniformLocation(program, \"p1\")", "glGetAttribLocation(program, \"p1\")");
    assert_eq!(after, expected);
}

#[test]
fn files_without_code_are_passed_over_in_folders_and_told_when_named() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("README.md", "# A shader\n\nNo code.\n\n```sh\nmake shader\n```\n");
    write("a.vert", "#version 150 core\nin vec4 p;\nvoid main() { gl_Position = p; }\n");
    let ran = run_in(folder.path(), "lint . --lang en").expect(0);
    assert!(ran.err.contains("1 file"), "{}", ran.err);
    let ran = run_in(folder.path(), "lint README.md --lang en").expect(0);
    assert!(ran.err.contains("README.md: no block of this document"), "{}", ran.err);
    write("notes.log", "nothing to see\n");
    let ran = run_in(folder.path(), "lint notes.log --lang en").expect(2);
    assert!(ran.err.contains("no document with blocks of such code"), "{}", ran.err);
}

#[test]
fn printed_files_that_are_named_together_belong_together() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "blend.vert",
        "#version 150 core\nin vec4 p0, p1;\nuniform float t;\nvoid main() { gl_Position = mix(p0, p1, t); }\n",
    );
    write("setup.cpp", "GLint p1Loc = glGetUniformLocation(program, \"p1\");\n");
    for args in ["lint blend.vert setup.cpp", "lint ."] {
        let ran = run_in(folder.path(), &format!("{args} --lang en --format concise")).expect(1);
        assert!(ran.out.contains("setup.cpp:1:15: error[H001"), "{}", ran.out);
        assert_eq!(ran.out.lines().count(), 1, "{}", ran.out);
    }
}

#[test]
fn a_printed_shader_is_checked_and_fuzzed_by_its_line() {
    let ran = run(&format!("check cylinder --shader {CHAPTER}:40 --format json")).expect(1);
    let finding = &ran.json()["suites"][0]["findings"][0];
    assert_eq!((&finding["file"], &finding["line"]), (&CHAPTER.into(), &44.into()));
    run(&format!("check sphere --shader {CHAPTER}:12 --samples 1024")).expect(0);
    let ran = run(&format!("check sphere --shader {CHAPTER}")).expect(2);
    assert!(ran.err.contains("holds several shaders"), "{}", ran.err);
    let ran = run(&format!("check sphere --shader {CHAPTER}:4")).expect(2);
    assert!(ran.err.contains("no whole shader stands at line 4"), "{}", ran.err);
    let ran = run(&format!("fuzz {CHAPTER}:100 --samples 256 --lane embedded")).expect(0);
    assert!(ran.out.contains("main"), "{}", ran.out);
}

const LIT: &str =
    "#version 330 core\nin vec3 n, m;\nout vec4 c;\nvoid main() { c = vec4(acos(dot(normalize(n), normalize(m)))); }\n";

#[test]
fn a_stage_that_a_name_does_not_say_is_stated() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lit.txt"), LIT).unwrap();
    fs::write(folder.path().join("part.glsl"), "#version 330 core\nin vec3 n;\nout vec3 m;\nvoid main() { m = n; }\n")
        .unwrap();
    let lint = |args: &str| run_in(folder.path(), &format!("lint --lang en --format concise {args}"));
    let told = lint("lit.txt --stage fragment").expect(1);
    assert!(told.out.contains("lit.txt:4:29: warning[N006"), "{}", told.out);
    let told = lint(". --stage frag").expect(2);
    assert!(told.err.contains("--stage says the stage of shader files that are named"), "{}", told.err);
    let told = lint("lit.txt --stage pixel").expect(2);
    assert!(told.err.contains("invalid value 'pixel'") && told.err.contains("tess-evaluation"), "{}", told.err);
    let translated = |args: &str| run_in(folder.path(), &format!("translate part.glsl --to wgsl {args}"));
    assert!(translated("--stage vertex").out.contains("@vertex"));
    assert!(translated("--stage fragment").expect(0).out.contains("@fragment"));
    let ran = run_in(folder.path(), "fuzz lit.txt --stage fragment --samples 64 --lane embedded");
    assert!(ran.out.contains("main") && ran.code < 2, "{ran:?}");
}

#[test]
fn shaders_in_strings_and_files_of_two_stages_are_fuzzed() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("scene.js", &format!("const frag = `{LIT}`;\n"));
    write("scene.cpp", "int main() { return 0; }\n");
    write(
        "both.glsl",
        "attribute vec3 p;\nvarying vec2 t;\nvoid main() { t = p.xy; gl_Position = vec4(p, 1.0); }\n$$\n\
         varying vec2 t;\nvoid main() { gl_FragColor = vec4(t, 0.0, 1.0); }\n",
    );
    let fuzz = |args: &str| run_in(folder.path(), &format!("fuzz {args} --samples 64 --lane embedded"));
    let ran = fuzz("scene.js --arbitrary");
    assert!(ran.out.contains("scene.js:4:"), "{ran:?}");
    assert!(ran.out.contains("reproduce  shadercheck fuzz scene.js:1 "), "{ran:?}");
    assert!(fuzz("scene.js:1").out.contains("main"));
    let ran = fuzz("both.glsl").expect(0);
    assert!(ran.out.contains("both.glsl (vertex)") && ran.out.contains("both.glsl (fragment)"), "{ran:?}");
    let ran = fuzz("scene.cpp").expect(2);
    assert!(ran.err.contains("`scene.cpp` holds no whole shader"), "{ran:?}");
}
