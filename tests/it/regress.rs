//! Cases that failed are kept beside the suite file and run first from then on.

use std::fs;
use std::path::Path;

use crate::binary::{root, run_in};

/// A folder with the suite `sphere` over a given shader.
fn folder(shader: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let copy = |from: &str, to: &str| fs::copy(root().join(from), folder.path().join(to)).unwrap();
    copy("shaders/chapter9/sphere.suite.toml", "sphere.suite.toml");
    copy(shader, "sphere.vert");
    folder
}

const RIGHT: &str = "shaders/chapter9/sphere.vert";
const WRONG: &str = "fixtures/alarms/sphere_turn.vert";
const CHECK: &str = "check sphere.suite.toml --samples 64 --format json";

fn saved(folder: &Path) -> String {
    fs::read_to_string(folder.join("sphere.regressions")).unwrap()
}

/// Lines of cases.
fn cases(text: &str) -> usize {
    text.lines().filter(|line| line.starts_with("sphere ")).count()
}

#[test]
fn a_suite_that_passes_writes_nothing() {
    let folder = folder(RIGHT);
    run_in(folder.path(), CHECK).expect(0);
    let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["sphere.suite.toml", "sphere.vert"]);
}

#[test]
fn failures_are_saved_and_run_again() {
    let folder = folder(WRONG);
    let first = run_in(folder.path(), CHECK).expect(1).json();
    assert_eq!(first["suites"][0]["replayed"], 0);
    let text = saved(folder.path());
    assert!(text.starts_with("# Inputs that made a suite fail."), "{text}");
    let count = cases(&text) as u64;
    assert!(count > 0, "{text}");
    // Once saved, a case is not saved again.
    let again = run_in(folder.path(), CHECK).expect(1).json();
    assert_eq!(saved(folder.path()), text);
    assert_eq!(again["suites"][0]["replayed"], count);
    assert_eq!(again["suites"][0]["judged"], first["suites"][0]["judged"].as_u64().unwrap() + count);
    // The repaired shader passes on them too, and the file stays as it is.
    fs::copy(root().join(RIGHT), folder.path().join("sphere.vert")).unwrap();
    let ran = run_in(folder.path(), "check sphere.suite.toml --samples 64").expect(0);
    assert!(ran.out.contains(&format!("saved cases that ran first: {count}")), "{}", ran.out);
    assert_eq!(saved(folder.path()), text);
}

/// A shader that is wrong for one parameter out of billions, which no comparison leads to: its bits are multiplied by an
/// odd number first.
fn rarely_wrong(folder: &Path) {
    let text = fs::read_to_string(root().join(RIGHT)).unwrap();
    let product = 0.123_456_f32.to_bits().wrapping_mul(2_654_435_761);
    let wrong = text.replace("#version 150", "#version 330").replace(
        "gl_Position = mc * p;",
        &format!(
            "gl_Position = mc * p;\n  if (floatBitsToUint(parameter.s) * 2654435761u == {product}u) gl_Position.x += 1.0;"
        ),
    );
    assert_ne!(wrong, text);
    fs::write(folder.join("sphere.vert"), wrong).unwrap();
}

#[test]
fn a_saved_case_finds_what_no_generated_one_does() {
    let folder = folder(RIGHT);
    rarely_wrong(folder.path());
    run_in(folder.path(), CHECK).expect(0);
    let case = format!(
        "sphere mc=3f800000{0},3f800000{0},3f800000{0},3f800000 parameter={1:08x},3f000000\n",
        ",00000000,00000000,00000000,00000000",
        0.123_456_f32.to_bits()
    );
    fs::write(folder.path().join("sphere.regressions"), &case).unwrap();
    let json = run_in(folder.path(), CHECK).expect(1).json();
    assert_eq!((&json["suites"][0]["deviated"], &json["suites"][0]["shader_deviated"]), (&1.into(), &1.into()));
    assert!(
        json["suites"][0]["findings"][0]["message"]
            .as_str()
            .unwrap()
            .starts_with("the shader deviates from its formula: `gl_Position.x` is "),
        "{json:#}"
    );
    assert!(saved(folder.path()).starts_with(&case), "what the user wrote stays");
}

#[test]
fn nothing_of_the_user_s_file_is_lost() {
    let folder = folder(WRONG);
    let path = folder.path().join("sphere.regressions");
    // A comment in Japanese, a case of another suite, Windows line ends, no line end at the end.
    let mine = "# 私の注釈\r\n\r\nother t=3f000000 # half\r\n  # indented";
    fs::write(&path, mine).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    }
    run_in(folder.path(), CHECK).expect(1);
    let text = saved(folder.path());
    assert!(text.starts_with(mine), "{text}");
    assert!(cases(&text) > 0, "{text}");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3, "no file is left behind");
}

#[test]
fn a_file_that_cannot_be_read_is_reported_and_left_alone() {
    let folder = folder(WRONG);
    let path = folder.path().join("sphere.regressions");
    let broken = "sphere parameter=3f000000,nonsense\n";
    fs::write(&path, broken).unwrap();
    let ran = run_in(folder.path(), CHECK).expect(2);
    assert!(ran.err.contains("sphere.regressions:1:27: `nonsense` is not a 32-bit word"), "{}", ran.err);
    assert_eq!(saved(folder.path()), broken);
    fs::write(&path, "sphere parameter=3f000000,3f000000\n").unwrap();
    let ran = run_in(folder.path(), CHECK).expect(2);
    assert!(ran.err.contains("a saved case does not fit the shader; delete its line"), "{}", ran.err);
    assert!(ran.err.contains("sphere.regressions:1:1: input `mc` (mat4) of the shader is missing"), "{}", ran.err);
}

#[test]
fn another_shader_neither_reads_nor_writes_the_saved_cases() {
    let folder = folder(RIGHT);
    fs::write(folder.path().join("sphere.regressions"), "sphere gone=3f000000\n").unwrap();
    fs::copy(root().join(WRONG), folder.path().join("wrong.vert")).unwrap();
    let json = run_in(folder.path(), &format!("{CHECK} --shader wrong.vert")).expect(1).json();
    assert_eq!(json["suites"][0]["replayed"], 0);
    assert_eq!(saved(folder.path()), "sphere gone=3f000000\n");
}
