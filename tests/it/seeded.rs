//! The whole program with a fault planted inside of a lane: who is blamed for it, by the lanes that ran beside.
//!
//! Mesa's drivers of OpenGL read a shader from a file when the environment says so, and glslang is a program in the
//! search path: both take another shader than the one they were given, as a compiler with a defect would.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::binary::{Ran, command, root};

/// The expression of the shipped suite that the fault is put in place of, and what the faulty compiler makes of it.
const FROM: &str = "mix(p0, p1, t)";
const TO: &str = "mix(p0, p1, t * 1.01)";

/// Runs the suite `morph` on some lanes with more in the environment.
fn check(lanes: &[&str], environment: &[(&str, &Path)]) -> Ran {
    let mut command = command(root(), "check morph --samples 256 --format json");
    for lane in lanes {
        command.args(["--require-lane", lane, "--lane", lane]);
    }
    command.envs(environment.iter().copied()).output().unwrap().into()
}

/// Lanes that deviate, and for each finding about a deviation whose fault it is, in words.
fn blamed(ran: Ran) -> (Vec<String>, Vec<(String, String)>) {
    let report = ran.expect(1).json();
    let suites = report["suites"].as_array().unwrap();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let findings = || suites.iter().flat_map(|suite| suite["findings"].as_array().unwrap());
    let fault = |finding: &Value| {
        let fault = &finding["case"]["fault"];
        fault.is_object().then(|| (text(&fault["kind"]), text(&fault["message"])))
    };
    let mut lanes: Vec<String> = suites
        .iter()
        .filter(|suite| suite["findings"].as_array().is_some_and(|found| !found.is_empty()))
        .map(|suite| text(&suite["lane"]))
        .collect();
    lanes.dedup();
    (lanes, findings().filter_map(fault).collect())
}

/// Every deviation is the fault of this part, in these words.
#[track_caller]
fn all_blame((_, faults): &(Vec<String>, Vec<(String, String)>), kind: &str, words: &str) {
    assert!(!faults.is_empty(), "nobody was blamed");
    for (found, message) in faults {
        assert_eq!(found, kind, "{message}");
        assert!(message.starts_with(words), "{message}");
    }
}

/// The shader as OpenGL's drivers get it, with `expression` in place of the one above, in a folder from which they read
/// it.
fn replaced(expression: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    check(&["opengl"], &[("MESA_SHADER_DUMP_PATH", folder.path())]).expect(0);
    let mut changed = 0;
    for file in fs::read_dir(folder.path()).unwrap() {
        let path = file.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        changed += text.matches(FROM).count();
        fs::write(path, text.replace(&format!("gl_Position = mc * {FROM};"), expression)).unwrap();
    }
    assert_eq!(changed, 1, "the driver wrote the shader down: MESA_SHADER_DUMP_PATH");
    folder
}

/// A statement for drivers that have this extension, and the right one for all others.
fn only_with(extension: &str) -> String {
    format!("\n#ifdef {extension}\n  gl_Position = mc * {TO};\n#else\n  gl_Position = mc * {FROM};\n#endif\n")
}

const ALL: [&str; 4] = ["vulkan", "opengl", "opengl-softpipe", "vulkan-glslang"];

#[test]
fn a_fault_in_the_compiler_of_opengl_is_its_fault_on_both_executors() {
    let folder = replaced(&format!("gl_Position = mc * {TO};"));
    let found = blamed(check(&ALL, &[("MESA_SHADER_READ_PATH", folder.path())]));
    assert_eq!(found.0, ["opengl", "opengl-softpipe"]);
    all_blame(
        &found,
        "translator",
        "the translator `Mesa`: what went through it deviates on `gallivm` and `softpipe`, and what went through \
         `glslang` and `naga` is right",
    );
}

#[test]
fn a_fault_in_one_driver_of_opengl_is_the_fault_of_its_executor() {
    // Mesa's llvmpipe has this extension and its softpipe has not: one compiler, and a fault on one executor alone.
    let folder = replaced(&only_with("GL_ARB_tessellation_shader"));
    let read: [(&str, &Path); 1] = [("MESA_SHADER_READ_PATH", folder.path())];
    let found = blamed(check(&["opengl", "opengl-softpipe"], &read));
    assert_eq!(found.0, ["opengl"]);
    all_blame(&found, "executor", "the executor `gallivm`: it deviates behind `Mesa`, and `softpipe` is right");
    // Where the same executor is right behind other compilers, it is neither alone.
    let found = blamed(check(&ALL, &read));
    assert_eq!(found.0, ["opengl"]);
    all_blame(&found, "pair", "the executor `gallivm` with what `Mesa` makes of the shader");
}

#[test]
fn a_fault_in_the_second_executor_is_blamed_on_it_whatever_else_ran() {
    let folder = replaced(&format!(
        "\n#ifdef GL_ARB_tessellation_shader\n  gl_Position = mc * {FROM};\n#else\n  gl_Position = mc * {TO};\n#endif\n"
    ));
    let found = blamed(check(&ALL, &[("MESA_SHADER_READ_PATH", folder.path())]));
    assert_eq!(found.0, ["opengl-softpipe"]);
    all_blame(&found, "executor", "the executor `softpipe`: it deviates behind `Mesa`, and `gallivm` is right");
}

/// A `glslangValidator` in a folder of its own that translates another shader than it is given; and the search path in
/// which it comes first.
#[cfg(unix)]
fn faulty_glslang(edit: &str) -> (tempfile::TempDir, std::ffi::OsString) {
    use std::os::unix::fs::PermissionsExt;
    let path = std::env::var_os("PATH").unwrap();
    let found = |folder: std::path::PathBuf| Some(folder.join("glslangValidator")).filter(|file| file.is_file());
    let real = std::env::split_paths(&path).find_map(found);
    let real = real.expect("these tests need glslangValidator; `cargo xtask test` installs it");
    let folder = tempfile::tempdir().unwrap();
    let script = format!(
        "#!/bin/sh\ncase \" $* \" in\n*' --stdin '*) sed '{edit}' | '{0}' \"$@\" ;;\n*) exec '{0}' \"$@\" ;;\nesac\n",
        real.display()
    );
    let file = folder.path().join("glslangValidator");
    fs::write(&file, script).unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).unwrap();
    let paths = std::iter::once(folder.path().to_owned()).chain(std::env::split_paths(&path));
    let paths = std::env::join_paths(paths).unwrap();
    (folder, paths)
}

#[test]
#[cfg(unix)]
fn a_fault_in_glslang_is_blamed_on_the_translator() {
    let (_folder, path) = faulty_glslang(&format!("s/{FROM}/{TO}/"));
    // Two lanes on one executor: only the translator differs.
    for lanes in [&["vulkan", "vulkan-glslang"][..], &ALL] {
        let found = blamed(check(lanes, &[("PATH", Path::new(&path))]));
        assert_eq!(found.0, ["vulkan-glslang"]);
        all_blame(
            &found,
            "translator",
            "the translator `glslang`: what went through it deviates on `gallivm`, and what went through",
        );
    }
    // The same program that changes nothing: nothing deviates.
    let (_folder, path) = faulty_glslang("s/nowhere/nothing/");
    check(&["vulkan", "vulkan-glslang"], &[("PATH", Path::new(&path))]).expect(0);
}
