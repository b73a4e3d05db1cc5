//! `shadercheck translate` on files as people have them: without a version, without a stage in the ending, in Latin-1.

use std::fs;
use std::process::Command;

/// Exit status, standard output and standard error of a translation to WGSL.
fn translated(name: &str, bytes: &[u8]) -> (Option<i32>, String, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(name), bytes).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_shadercheck"))
        .current_dir(folder.path())
        .args(["translate", "--to", "wgsl", name])
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[track_caller]
fn is_stage(name: &str, text: &[u8], stage: &str) {
    let (status, out, err) = translated(name, text);
    assert_eq!((status, err.as_str()), (Some(0), ""), "{name}");
    assert!(out.contains(stage), "{name}: {out}");
}

#[test]
fn a_bare_ending_leaves_the_stage_to_text_and_name() {
    is_stage("sky.glsl", b"#version 330\nout vec4 c;\nvoid main() { c = gl_FragCoord; }\n", "@fragment");
    is_stage("skin_vs.glsl", b"#version 330\nin vec4 p;\nout vec4 q;\nvoid main() { q = p; }\n", "@vertex");
    let library = b"#version 330\nfloat f(float x) { return x; }\nfloat g(float x) { return x; }\n";
    let (status, _, err) = translated("noise_vs.glsl", library);
    assert_eq!(status, Some(2));
    assert!(err.contains("choose one with --entry: f, g"), "{err}");
}

#[test]
fn a_text_without_a_version_gets_the_one_that_fits() {
    is_stage("a.vert", b"in vec4 p;\nout vec4 q;\nvoid main() { q = p; gl_Position = p; }\n", "@vertex");
    // Errors that no version takes away stand at their places in the author's text.
    let (status, _, err) = translated("a.vert", b"in vec4 p;\nvoid main() { gl_Position = p * q; }\n");
    assert_eq!(status, Some(1));
    assert!(err.contains("a.vert:2:33"), "{err}");
}

#[test]
fn latin_letters_in_comments_are_read() {
    is_stage("a.frag", b"#version 330\n// \xe9clairage\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n", "@fragment");
}
