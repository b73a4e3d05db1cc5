//! Files that cannot be read, and names that nothing has.

use std::fs;
use std::path::Path;

use crate::binary::{root, run, run_in};

/// A folder with files that are no suites and no shaders.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let sphere = fs::read_to_string(root().join("shaders/chapter9/sphere.suite.toml")).unwrap();
    fs::write(path("bytes.suite.toml"), b"suite = 'a'\n# \x8b\x85\n").unwrap();
    fs::write(path("bytes.vert"), b"#version 150\n// \xff\xff\x01\nvoid main() {}\n").unwrap();
    fs::write(path("empty.suite.toml"), "").unwrap();
    fs::write(path("empty.vert"), "").unwrap();
    fs::write(path("alone.suite.toml"), sphere).unwrap();
    fs::create_dir(path("folder.suite.toml")).unwrap();
    fs::create_dir(path("folder.vert")).unwrap();
    #[cfg(unix)]
    for name in ["link.suite.toml", "link.vert"] {
        std::os::unix::fs::symlink("nowhere", path(name)).unwrap();
    }
    folder
}

/// Nothing is checked, and one line on standard error starts with `error: ` and holds `said`.
#[track_caller]
fn refused(folder: &Path, args: &str, said: &[&str]) {
    let ran = run_in(folder, args).expect(2);
    assert_eq!(ran.out, "", "{args}");
    let line = ran.err.lines().next().unwrap_or_default();
    assert!(line.starts_with("error: "), "{args}: {}", ran.err);
    for part in said {
        assert!(line.contains(part), "{args}: `{part}` is not in `{line}`");
    }
}

#[test]
fn suite_files_that_cannot_be_read_are_reported() {
    let folder = folder();
    let folder = folder.path();
    refused(folder, "check bytes.suite.toml", &["bytes.suite.toml:2:3: not UTF-8 (byte 0x8b)", "iconv"]);
    refused(folder, "check empty.suite.toml", &["empty.suite.toml:1:1: missing key `suite`", "for example"]);
    refused(folder, "check folder.suite.toml", &["`folder.suite.toml` holds no suite file (*.suite.toml)"]);
    refused(folder, "check gone.suite.toml", &["cannot read `gone.suite.toml`"]);
    refused(folder, "check alone.suite.toml", &["alone.suite.toml:3:", "cannot read the shader `sphere.vert`"]);
    #[cfg(unix)]
    refused(folder, "check link.suite.toml", &["cannot read `link.suite.toml`"]);
}

#[test]
fn shaders_that_cannot_be_read_are_reported() {
    let folder = folder();
    let folder = folder.path();
    refused(
        folder,
        "check sphere --shader bytes.vert",
        &["bytes.vert:2:4: neither UTF-8 nor Shift_JIS", "(byte 0xff)", "iconv"],
    );
    refused(folder, "check sphere --shader empty.vert", &["`empty.vert` is empty"]);
    refused(folder, "check sphere --shader folder.vert", &["`folder.vert` is a folder"]);
    refused(folder, "check sphere --shader gone.vert", &["cannot read `gone.vert`"]);
    #[cfg(unix)]
    refused(folder, "check sphere --shader link.vert", &["cannot read `link.vert`"]);
}

#[cfg(unix)]
#[test]
fn files_without_permission_are_reported() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let path = folder.path().join("closed.vert");
    fs::copy(root().join("shaders/chapter9/sphere.vert"), &path).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o000)).unwrap();
    if fs::read(&path).is_ok() {
        // The superuser reads everything; a dangling link stands for this elsewhere.
        return;
    }
    refused(folder.path(), "check sphere --shader closed.vert", &["cannot read `closed.vert`", "ermission"]);
}

#[test]
fn a_cause_is_reported_once() {
    let folder = folder();
    let ran = run_in(folder.path(), "check gone.suite.toml").expect(2);
    assert_eq!(ran.err.matches("No such file").count(), 1, "{}", ran.err);
}

#[test]
fn unknown_names_are_reported_with_the_one_that_was_meant() {
    refused(root(), "check spere", &["there is no suite `spere`; did you mean `sphere`?"]);
    refused(root(), "check teapot", &["there is no suite `teapot`; suites are sphere, cylinder, "]);
    refused(root(), "check gone.vert", &["there is no file or folder `gone.vert`"]);
    refused(root(), "check sphere --lane vulcan", &["there is no lane `vulcan`; did you mean `vulkan`?"]);
    refused(root(), "check sphere --require-lane metal", &["there is no lane `metal`; lanes are vulkan"]);
    refused(root(), "check sphere --stage vertx", &["invalid value 'vertx'"]);
    let ran = run("check sphere --sampels 3").expect(2);
    assert!(ran.err.contains("unexpected argument '--sampels'") && ran.err.contains("'--samples'"), "{}", ran.err);
}

#[test]
fn a_shader_without_a_suite_is_reported_how_to_run_it() {
    let said = "`fixtures/printed/cylinder.vert` is no suite file, and no suite beside it is about it; to run a shader \
                under a suite, write `check SUITE --shader fixtures/printed/cylinder.vert`";
    refused(root(), "check fixtures/printed/cylinder.vert", &[said]);
}

#[test]
fn one_shader_needs_one_suite() {
    let shader = "--shader shaders/chapter9/sphere.vert";
    refused(
        root(),
        &format!("check sphere cylinder {shader}"),
        &["--shader needs exactly one suite, and 2 are chosen"],
    );
    refused(root(), &format!("check --shipped {shader}"), &["--shader needs exactly one suite, and 14 are chosen"]);
}
