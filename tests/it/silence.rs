//! What judged nothing is never told as a pass: translators that crash, hang or give garbage, lanes that are missing or
//! cannot run a suite, shaders without outputs, and samples that are mostly undetermined.

use std::ffi::OsString;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::binary::{Ran, command, root, run_in};

/// A folder first in the search path, in which `glslangValidator` does this with a text; the real one is `$REAL`.
fn translator(script: &str) -> (tempfile::TempDir, OsString) {
    let path = std::env::var_os("PATH").unwrap();
    let found = |folder: PathBuf| Some(folder.join("glslangValidator")).filter(|file| file.is_file());
    let real = std::env::split_paths(&path).find_map(found);
    let real = real.expect("these tests need glslangValidator; `cargo xtask test` installs it");
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "#!/bin/sh\nREAL='{}'\ncase \" $* \" in\n*' --stdin '*) {script} ;;\n*) exec \"$REAL\" \"$@\" ;;\nesac\n",
        real.display()
    );
    let file = folder.path().join("glslangValidator");
    fs::write(&file, text).unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).unwrap();
    let paths = std::iter::once(folder.path().to_owned()).chain(std::env::split_paths(&path));
    let paths = std::env::join_paths(paths).unwrap();
    (folder, paths)
}

/// Runs a suite beside such a translator.
fn with_translator(script: &str, args: &str) -> Ran {
    let (_folder, path) = translator(script);
    let args = format!("check morph --samples 64 --lane vulkan --plain {args}");
    command(root(), &args).env("PATH", path).output().unwrap().into()
}

/// The line of a suite on a lane and stage.
fn line<'r>(ran: &'r Ran, on: &str) -> &'r str {
    let found = ran.out.lines().find(|line| line.split_whitespace().any(|word| word == on));
    found.unwrap_or_else(|| panic!("nothing of {on}:\n{}\n{}", ran.out, ran.err))
}

#[test]
fn a_translator_that_crashes_or_gives_no_module_fails_its_lane() {
    for (script, words) in [
        ("kill -SEGV $$", "was ended by signal 11 (segmentation fault)"),
        ("exit 134", "ended with status 134, as a shell does after signal 6"),
        ("exit 0", "gave no whole module; it printed nothing"),
        ("echo what", "gave no whole module; it printed `what`"),
        ("\"$REAL\" \"$@\" | head -c 600", "gave no whole module"),
        ("exit 2", "ended with status 2; it printed nothing"),
    ] {
        let ran = with_translator(script, "--lane vulkan-glslang").expect(1);
        let line = line(&ran, "vulkan-glslang/vertex");
        assert!(line.starts_with("FAIL ") && line.contains(words), "{script}: {line}");
        assert!(self::line(&ran, "vulkan/vertex").starts_with("ok "), "{}", ran.out);
    }
}

#[test]
fn a_translator_that_hangs_is_ended() {
    let ran = with_translator("exec sleep 600", "--lane vulkan-glslang").expect(1);
    let line = line(&ran, "vulkan-glslang/vertex");
    assert!(line.starts_with("FAIL ") && line.contains("did not end within 30 s"), "{line}");
}

#[test]
fn a_translator_that_is_slow_is_right() {
    let ran = with_translator("sleep 1; exec \"$REAL\" \"$@\"", "--require-lane vulkan-glslang").expect(0);
    assert!(line(&ran, "vulkan-glslang/vertex").starts_with("ok "), "{}", ran.out);
}

const REFUSED: &str = "echo 'ERROR: 0:3: no'; exit 2";

#[test]
fn a_required_lane_that_judges_nothing_is_a_failure() {
    let ran = with_translator(REFUSED, "--require-lane vulkan-glslang").expect(2);
    let reported = "error: the required lane `vulkan-glslang` judged no sample: 64 samples not supported on this lane: \
                glslang, line 3: no\n";
    assert_eq!(ran.err, reported);
    assert!(ran.out.lines().last().unwrap().starts_with("incomplete: "), "{}", ran.out);
    let json = with_translator(REFUSED, "--require-lane vulkan-glslang --format json").expect(2).json();
    assert_eq!((&json["status"], &json["incomplete"][0]["lane"]), (&"fail".into(), &"vulkan-glslang".into()));
    let junit = with_translator(REFUSED, "--require-lane vulkan-glslang --format junit").expect(2).out;
    assert!(junit.contains("<error message=\"the required lane `vulkan-glslang` judged no sample"), "{junit}");
    // The same run is fine where the lane is not required, and the same lane where it judges something.
    with_translator(REFUSED, "--lane vulkan-glslang").expect(0);
    with_translator("exec \"$REAL\" \"$@\"", "--require-lane vulkan-glslang").expect(0);
}

#[test]
fn a_suite_without_a_judged_sample_is_not_run_in_every_format() {
    let ran = with_translator(REFUSED, "--lane vulkan-glslang").expect(0);
    let why = "64 samples not supported on this lane: glslang, line 3: no";
    let line = line(&ran, "vulkan-glslang/vertex");
    assert!(line.starts_with("not run morph ") && line.ends_with(why), "{line}");
    let markdown = with_translator(REFUSED, "--lane vulkan-glslang --format markdown").expect(0).out;
    assert!(markdown.contains("| not run | `morph` | vulkan-glslang/vertex | - | - | - | - |"), "{markdown}");
    assert!(markdown.contains("### Not run\n\n- on vulkan-glslang: glslang, line 3: no: `morph`\n"), "{markdown}");
    let junit = with_translator(REFUSED, "--lane vulkan-glslang --format junit").expect(0).out;
    assert!(junit.contains(&format!("<skipped message=\"not run: {why}\"/>")), "{junit}");
    let json = with_translator(REFUSED, "--lane vulkan-glslang --format json").expect(0).json();
    let suites = json["suites"].as_array().unwrap();
    let not_run: Vec<&Value> = suites.iter().filter(|suite| !suite["not_run"].is_null()).collect();
    assert_eq!(not_run.len(), 1);
    assert_eq!((&not_run[0]["lane"], &not_run[0]["not_run"]), (&"vulkan-glslang".into(), &why.into()));
    let folder = tempfile::tempdir().unwrap();
    with_translator(REFUSED, &format!("--lane vulkan-glslang --report-dir {}", folder.path().display())).expect(0);
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    assert!(page.contains("<b>not run</b><span class=\"rest\">64 samples not supported on this lane"), "the page");
    assert!(!page.contains("<b>not supported</b>"));
}

/// A suite of a vertex shader with the attribute `p` in a folder of its own.
fn suite(shader: &str, more: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.vert"), shader).unwrap();
    let text = format!("suite = \"a\"\ntitle = \"A\"\nshader = \"a.vert\"\nstage = \"vertex\"\nsamples = 64\n{more}");
    fs::write(folder.path().join("a.suite.toml"), text).unwrap();
    folder
}

const POINT: &str = "[[inputs]]\nnames = [\"p\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n";

#[test]
fn a_version_that_a_driver_lacks_is_not_run_there() {
    let folder = suite("#version 410 core\nin vec3 p;\nvoid main() { gl_Position = vec4(p, 1.0); }\n", POINT);
    let ran = run_in(folder.path(), "check a.suite.toml --plain --lane opengl,opengl-softpipe").expect(0);
    assert!(line(&ran, "opengl/vertex").starts_with("ok "), "{}", ran.out);
    let line = line(&ran, "opengl-softpipe/vertex");
    assert!(line.starts_with("not run ") && line.ends_with("GLSL 4.10; the driver has 3.30"), "{line}");
    // Where nothing else ran, the run has not passed.
    let ran = run_in(folder.path(), "check a.suite.toml --plain --lane opengl-softpipe").expect(2);
    assert!(ran.out.lines().last().unwrap().starts_with("not run: 0 judged"), "{}", ran.out);
}

/// The binary where no Vulkan driver can be found.
fn without_vulkan(folder: &Path, args: &str) -> Ran {
    let mut command = command(folder, args);
    command.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent").output().unwrap().into()
}

#[test]
fn a_run_without_a_lane_that_was_asked_for_is_incomplete() {
    let ran = without_vulkan(root(), "check sphere --samples 16 --plain --lane vulkan --lane embedded").expect(2);
    assert!(
        ran.err.starts_with("error: the lane `vulkan` was asked for and is not available: no Vulkan"),
        "{}",
        ran.err
    );
    assert!(line(&ran, "embedded/compute").starts_with("ok "), "what runs is judged all the same: {}", ran.out);
    assert!(ran.out.lines().last().unwrap().starts_with("incomplete: 16 judged"), "{}", ran.out);
    without_vulkan(root(), "check sphere --samples 16 --plain --lane embedded").expect(0);
    let functions = tempfile::tempdir().unwrap();
    fs::write(functions.path().join("f.glsl"), "float f(float x) { return x + 1.0; }\n").unwrap();
    let ran = without_vulkan(functions.path(), "fuzz f.glsl --samples 64 --lane vulkan --lane embedded").expect(2);
    assert!(ran.err.contains("error: the lane `vulkan` was asked for and is not available"), "{}", ran.err);
    without_vulkan(functions.path(), "fuzz f.glsl --samples 64 --lane embedded").expect(0);
}

#[test]
fn a_shader_without_outputs_is_a_note_and_no_failure_of_a_lane() {
    let folder = suite("#version 150\nvoid main() { }\n", "");
    let ran = run_in(folder.path(), "check a.suite.toml --plain").expect(2);
    assert!(!ran.out.contains("FAIL") && !ran.out.contains("GL_INVALID"), "{}", ran.out);
    for on in ["vulkan/compute", "opengl/vertex", "opengl-softpipe/vertex", "vulkan-glslang/vertex"] {
        let line = line(&ran, on);
        assert!(line.starts_with("not run ") && line.ends_with("the shader writes no output"), "{line}");
    }
    let ran = run_in(folder.path(), "fuzz a.vert --samples 64").expect(2);
    assert!(ran.out.contains("not run: it writes no output"), "{}", ran.out);
    // A geometry stage without outputs of its own still says how much it emits.
    let geometry =
        "#version 150\nlayout(points) in;\nlayout(points, max_vertices = 1) out;\nvoid main() { EmitVertex(); }\n";
    fs::write(folder.path().join("g.geom"), geometry).unwrap();
    let ran = run_in(folder.path(), "fuzz g.geom --samples 64");
    assert!(!ran.out.contains("GL_INVALID"), "{}", ran.out);
}

#[test]
fn a_suite_that_leaves_more_than_half_undetermined_is_weak() {
    let floors = "[floors]\nundetermined = 0.95\nreason = \"a test\"\n";
    let shader = |e: &str| {
        format!("#version 330\nin float p;\nout float y;\nvoid main() {{ y = {e}; gl_Position = vec4(y); }}\n")
    };
    // A zero vector has no direction: two thirds of the samples are inconclusive.
    let point = POINT.replace("[0.0, 1.0]", "[-2.0, 1.0]");
    let folder = suite(&shader("normalize(vec2(max(p, 0.0), 0.0)).x"), &format!("{point}{floors}"));
    let check = "check a.suite.toml --plain --lane embedded";
    let ran = run_in(folder.path(), check).expect(0);
    assert!(line(&ran, "embedded/compute").starts_with("weak  a "), "{}", ran.out);
    let markdown = run_in(folder.path(), "check a.suite.toml --lane embedded --format markdown").expect(0).out;
    assert!(markdown.contains("| weak | `a` |"), "{markdown}");
    let json = run_in(folder.path(), "check a.suite.toml --lane embedded --format json").expect(0).json();
    assert_eq!(json["suites"][0]["weak"], true);
    let junit = run_in(folder.path(), "check a.suite.toml --lane embedded --format junit").expect(0).out;
    assert!(junit.contains("<system-out>weak: "), "{junit}");
    let folder = suite(&shader("p * p"), &format!("{point}{floors}"));
    assert!(line(&run_in(folder.path(), check).expect(0), "embedded/compute").starts_with("ok    a "));
}

#[test]
fn notes_are_grouped_by_their_cause() {
    let ran = crate::binary::run("check sphere cylinder --samples 4096 --plain --lane vulkan,opengl,opengl-softpipe");
    let ran = ran.expect(0);
    let notes: Vec<&str> = ran.out.lines().filter(|line| line.starts_with("note: ")).collect();
    // The reason and the place.
    let cause = |note: &&str| {
        let (_, why) = note.split_once(" undetermined, ")?;
        Some((why.split(':').next()?.to_owned(), why.rsplit('`').next()?.to_owned()))
    };
    let mut causes: Vec<(String, String)> = notes.iter().filter_map(cause).collect();
    let all = causes.len();
    causes.sort_unstable();
    causes.dedup();
    assert!(all > 0 && causes.len() == all, "each place once: {notes:#?}");
    let shared =
        |note: &&str| note.starts_with("note: sphere on ") && note.contains("opengl/vertex, opengl-softpipe/vertex: ");
    assert!(notes.iter().any(shared), "{notes:#?}");
    let lanes = "note: lane `opengl`: promises of ";
    assert_eq!(notes.iter().filter(|note| note.starts_with(lanes)).count(), 1, "{notes:#?}");
}
