//! `shadercheck check` as a command: lines, options, exit status, and how a failure is shown again.

use std::fs;
use std::io::Read;
use std::process::Stdio;

use serde_json::Value;

use crate::binary::{Ran, command, root, run, run_in, run_reported};

/// The binary where no Vulkan driver can be found.
fn without_lanes(args: &str) -> Ran {
    command(root(), args)
        .env("VK_DRIVER_FILES", "/nonexistent")
        .env("VK_ICD_FILENAMES", "/nonexistent")
        .env("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent")
        .output()
        .unwrap()
        .into()
}

#[test]
fn a_line_for_each_suite_and_stage_then_totals() {
    let ran = run("check sphere hermite --samples 304 --lane vulkan").expect(0);
    let lines: Vec<&str> = ran.out.lines().collect();
    let (mut judged, mut undetermined) = (0, 0);
    for (line, (suite, on)) in
        lines.iter().zip([("sphere", "vulkan/compute"), ("sphere", "vulkan/vertex"), ("hermite", "vulkan/compute")])
    {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(&words[..3], &["ok", suite, on], "{line}");
        assert!(line.contains(" ULP"), "{line}");
        let at = |what: &str| words.iter().position(|w| *w == what).unwrap_or_else(|| panic!("{what}: {line}"));
        let count = |what: &str| words[at(what) - 1].parse::<u64>().unwrap();
        assert_eq!((count("judged"), count("deviated")), (count("agreed"), 0), "{line}");
        assert_eq!(count("judged") + count("undetermined"), 304, "{line}");
        judged += count("judged");
        undetermined += count("undetermined");
    }
    assert_eq!(lines[3], "");
    // Each doubt is told with its reason and its place; then the lanes.
    let doubts: Vec<&&str> = lines[4..].iter().take_while(|line| line.contains(" undetermined, ")).collect();
    assert_eq!(doubts.is_empty(), undetermined == 0, "{doubts:?}");
    for doubt in &doubts {
        assert!(
            doubt.starts_with("note: sphere on vulkan/") && doubt.contains("shaders/chapter9/sphere.vert:"),
            "{doubt}"
        );
    }
    let lines = &lines[doubts.len()..];
    assert!(lines[4].starts_with("note: lane `vulkan`: promises of vulkan-1.4, vulkan-cts; "), "{}", lines[4]);
    let translations = "note: translations agree with the shader: spirv, wgsl, glsl450 (608 samples, 2 suites)";
    let total =
        format!("pass: {judged} judged, {judged} agreed, 0 deviated, {undetermined} undetermined, 0 unsupported");
    assert!(lines[6].starts_with("note: coverage: "), "{}", lines[6]);
    assert_eq!([lines[5], lines[7]], [translations, &*total]);
    assert_eq!(lines.len(), 8);
    assert_eq!(ran.err, "", "no progress bar where there is no terminal");
    assert!(!ran.out.contains('\u{1b}'), "no colours either");
}

#[test]
fn a_failure_has_a_line_a_finding_and_a_total() {
    let ran = run("check sphere --shader fixtures/alarms/sphere_swapped.vert --samples 304 --stage compute").expect(1);
    assert!(ran.out.starts_with("FAIL  sphere           vulkan/compute  "), "{}", ran.out);
    for part in [
        "\nsphere on vulkan/compute: the shader deviates from its formula: `gl_Position.",
        "\n  file       fixtures/alarms/sphere_swapped.vert\n",
        "\n  smallest   vec2 parameter = ",
        "\n             bits ",
        "\n  formula    gl_Position.",
        "\n  shader     gl_Position.",
        "\n  lane       gl_Position.",
        "\n  off by     ",
        "\n  shrunk     in ",
        "\n  reproduce  shadercheck check sphere --shader fixtures/alarms/sphere_swapped.vert --lane vulkan --stage compute --case '",
        // 303 of the samples asked for, and those at edges that deviate.
        "\nfail: 327 judged, ",
    ] {
        assert!(ran.out.contains(part), "`{part}` is not in\n{}", ran.out);
    }
    // What a lane may be off has no part in a fault of the shader.
    assert!(!ran.out.contains(" ± ") && !ran.out.contains("times what is allowed"), "{}", ran.out);
}

#[test]
fn a_case_that_several_findings_share_is_printed_once() {
    let ran = run("check hair --shader fixtures/alarms/hair_few.geom --samples 304").expect(1);
    assert_eq!(ran.out.matches("  reproduce  ").count(), 1, "{}", ran.out);
    assert!(ran.out.matches("\n  smallest   as above\n").count() >= 2, "{}", ran.out);
    let first = ran.out.split("\n\n").nth(1).unwrap();
    assert!(first.contains("4 vertices emitted, expected 5"), "the deviation comes first: {first}");
}

#[test]
fn shipped_suites_run_from_any_folder() {
    let folder = tempfile::tempdir().unwrap();
    let ran = run_in(folder.path(), "check --shipped --samples 64 --format json").expect(0);
    let json = ran.json();
    let names: Vec<&str> = json["suites"].as_array().unwrap().iter().map(|s| s["suite"].as_str().unwrap()).collect();
    for suite in engine::suite::shipped() {
        assert!(names.contains(&suite.name), "{} did not run", suite.name);
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "a run that passes writes nothing");
}

#[test]
fn without_a_path_the_current_folder_is_meant() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    // A folder without suites is no success.
    for command in ["check", "mutate", "check .", "check --lane embedded"] {
        let ran = run_in(folder.path(), command).expect(2);
        for part in ["`.` holds no suite file", "`shadercheck init .`", "`shadercheck fuzz .`", "--shipped"] {
            assert!(ran.err.contains(part), "{command}: {}", ran.err);
        }
    }
    for command in ["fuzz", "tune", "improve", "init"] {
        let ran = run_in(folder.path(), command).expect(2);
        assert!(ran.err.contains("`.` holds no shader"), "{command}: {}", ran.err);
    }
    run_in(folder.path(), "lint").expect(2);
    write("f.glsl", "float f(float x) { return x * 0.5; }\n");
    write(
        "f.suite.toml",
        "suite = \"f\"\nshader = \"f.glsl\"\nstage = \"function\"\nentry = \"f\"\n\
        [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [1.0, 2.0]\n",
    );
    fs::create_dir(folder.path().join("inner")).unwrap();
    write("inner/g.wgsl", "fn g(x: f32) -> f32 { return 2.0 * x; }\n");
    let ran = run_in(folder.path(), "check --lane embedded --samples 64").expect(0);
    assert_eq!(ran.out.lines().filter(|line| line.starts_with("ok ")).count(), 1, "{}", ran.out);
    let ran = run_in(folder.path(), "fuzz --lane embedded --samples 64").expect(0);
    assert!(ran.out.contains("f.glsl") && ran.out.contains("inner/g.wgsl"), "{}", ran.out);
    run_in(folder.path(), "lint").expect(0);
    run_in(folder.path(), "improve").expect(0);
    run_in(folder.path(), "mutate --lane embedded --samples 64").expect(0);
}

#[test]
fn a_file_of_a_folder_that_cannot_be_read_does_not_keep_the_others_from_being_run() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.glsl"), "float f(float x) { return x * 0.5; }\n").unwrap();
    fs::write(folder.path().join("b.glsl"), "").unwrap();
    let ran = run_in(folder.path(), "fuzz . --lane embedded --samples 64").expect(0);
    assert!(ran.err.contains("left out: `b.glsl` is empty"), "{}", ran.err);
    run_in(folder.path(), "fuzz b.glsl --lane embedded --samples 64").expect(2);
}

#[test]
fn a_failure_under_a_shipped_suite_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(root().join("fixtures/alarms/sphere_off.vert"), folder.path().join("a.vert")).unwrap();
    run_in(folder.path(), "check sphere --shader a.vert --samples 64").expect(1);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn the_same_seed_gives_the_same_report() {
    let shader = "check sphere --shader fixtures/alarms/sphere_swapped.vert --samples 304 --format json";
    let seven = run(&format!("{shader} --seed 7")).expect(1);
    assert_eq!(seven, run(&format!("{shader} --seed 7")));
    assert_ne!(
        seven.json()["suites"][0]["deviated"],
        run(&format!("{shader} --seed 8")).json()["suites"][0]["deviated"]
    );
    // A run without a seed is one with the seed that it reports.
    let plain = run(shader);
    assert_eq!(plain, run(&format!("{shader} --seed {}", plain.json()["seed"])));
}

#[test]
fn samples_quick_lane_and_stage_choose_what_is_run() {
    let judged = |args: &str| {
        let json = run(&format!("check sphere --format json {args}")).expect(0).json();
        let entries = json["suites"].as_array().unwrap();
        entries
            .iter()
            .map(|e| {
                let count = |key: &str| e[key].as_u64().unwrap();
                assert!(count("undetermined") * 20 < count("judged"), "{e:#}");
                (e["stage"].as_str().unwrap().to_owned(), count("judged") + count("undetermined"))
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(judged("--samples 32 --stage vertex --lane vulkan"), [("vertex".to_owned(), 32)]);
    assert_eq!(judged("--samples 48 --stage compute --lane vulkan"), [("compute".to_owned(), 48)]);
    assert_eq!(judged("--quick --stage compute"), [("compute".to_owned(), 65536 / 8)]);
    let ran = run("check sphere --quick --samples 3").expect(2);
    assert!(ran.err.contains("'--quick' cannot be used with '--samples <N>'"), "{}", ran.err);
    run("check sphere --samples 0").expect(2);
}

#[test]
fn a_stage_that_a_suite_does_not_have_is_not_a_pass() {
    let ran = run("check hair --stage vertex").expect(2);
    assert!(ran.err.contains("suite `hair` did not run: it is no vertex suite"), "{}", ran.err);
    assert!(ran.out.contains("not run: 0 judged"), "{}", ran.out);
}

#[test]
fn a_required_lane_that_is_missing_is_an_error_with_the_remedy() {
    let ran = without_lanes("check sphere --samples 16 --require-lane vulkan").expect(2);
    assert_eq!(ran.out, "");
    assert_eq!(
        ran.err,
        "error: the required lane `vulkan` is not available: no Vulkan driver was found; install one, for example \
         `apt-get install mesa-vulkan-drivers libvulkan1` on Debian or Ubuntu\n"
    );
    run("check sphere --samples 16 --require-lane vulkan").expect(0);
}

#[test]
fn without_a_driver_the_embedded_lane_stands_in_and_the_run_says_so() {
    let ran = without_lanes("check sphere hair --samples 16").expect(0);
    assert!(ran.out.contains("embedded/compute") && !ran.out.contains("vulkan/"), "{}", ran.out);
    assert!(
        ran.out.contains("note: lane `vulkan` did not run: no Vulkan driver was found; install one"),
        "{}",
        ran.out
    );
    let json = without_lanes("check sphere --samples 16 --format json").expect(0).json();
    assert_eq!((&json["lanes"][0]["name"], &json["unavailable"][0]["name"]), (&"embedded".into(), &"vulkan".into()));
    // Beside a driver it runs only when it is named.
    let ran = run("check sphere --samples 16").expect(0);
    assert!(!ran.out.contains("embedded"), "{}", ran.out);
    let ran = run("check sphere --samples 16 --lane embedded").expect(0);
    assert!(ran.out.contains("embedded/compute") && !ran.out.contains("vulkan"), "{}", ran.out);
}

#[test]
fn the_embedded_lane_finds_what_the_driver_finds() {
    for (suite, shader) in
        [("sphere", "sphere_off.vert"), ("sphere", "sphere_unwritten.vert"), ("hair", "hair_last.geom")]
    {
        let check = format!("check {suite} --shader fixtures/alarms/{shader} --samples 304 --lane embedded");
        let ran = run(&check).expect(1);
        assert!(ran.out.contains("embedded/compute"), "{}", ran.out);
    }
}

#[test]
fn without_any_lane_nothing_is_checked_and_that_is_an_error() {
    let ran = without_lanes("check sphere --samples 16 --lane vulkan").expect(2);
    assert_eq!(ran.out, "");
    assert!(ran.err.contains("lane `vulkan` is not available: no Vulkan driver was found; install one"), "{}", ran.err);
    assert!(ran.err.ends_with("error: no lane can run here, so nothing was checked\n"), "{}", ran.err);
    let json = without_lanes("check sphere --samples 16 --lane vulkan --format json").expect(2).json();
    assert_eq!((&json["status"], &json["suites"]), (&"fail".into(), &Value::Array(Vec::new())));
    assert_eq!(json["unavailable"][0]["name"], "vulkan");
}

#[test]
fn lanes_tells_what_can_run_and_why_not() {
    let ran = run("lanes").expect(0);
    assert!(ran.out.starts_with("lane ") && ran.out.contains("  executor x front end\n"), "{}", ran.out);
    let vulkan = ran.out.lines().find(|line| line.starts_with("vulkan ")).unwrap();
    assert!(vulkan.contains("  compute vertex  ") && vulkan.ends_with(" x naga"), "{}", ran.out);
    let ran = without_lanes("lanes").expect(0);
    let mut lines = ran.out.lines().skip_while(|line| !line.starts_with("vulkan "));
    assert!(lines.next().is_some_and(|line| line.contains("  unavailable (")), "{}", ran.out);
    assert!(lines.any(|line| line.trim_start().starts_with("to get it: install one, for example")), "{}", ran.out);
    assert!(ran.out.lines().all(|line| line.chars().count() <= 100), "{}", ran.out);
    let json = without_lanes("lanes --format json").expect(0).json();
    let lanes = json["lanes"].as_array().unwrap();
    let of = |name: &str| lanes.iter().find(|lane| lane["name"] == name).unwrap();
    assert_eq!((&of("vulkan")["available"], &of("embedded")["available"]), (&false.into(), &true.into()));
    assert!(of("vulkan")["remedy"].as_str().unwrap().starts_with("install one"), "{json:#}");
    assert_eq!((&of("embedded")["executor"], &of("embedded")["front_end"]), (&"interpreter".into(), &"none".into()));
}

/// The profiles of the first lane of a run.
fn profiles(line: &str) -> (Value, Value, Value) {
    let json = run(&format!("check sphere --samples 16 --stage compute --format json {line}")).expect(0).json();
    let lane = &json["lanes"][0];
    (lane["promise"].clone(), lane["conformance"].clone(), lane["measured"].clone())
}

#[test]
fn a_lane_is_held_against_the_promises_of_its_api_and_a_measured_profile() {
    let lanes = run("lanes").expect(0).out;
    assert!(lanes.contains("API vulkan: promises vulkan-1.4, vulkan-cts; measured profile: "), "{lanes}");
    assert!(lanes.contains("API binary32: promises binary32; measured profile: none"), "{lanes}");
    let vulkan = |measured: Value| ("vulkan-1.4".into(), "vulkan-cts".into(), measured);
    // Which device is here decides what is the default.
    let own = if lanes.contains("Mesa 22.3.") { "llvmpipe-22.3.6".into() } else { Value::Null };
    assert_eq!(profiles(""), vulkan(own));
    assert_eq!(profiles("--profile none"), vulkan(Value::Null));
    assert_eq!(profiles("--profile llvmpipe-22.3.6"), vulkan("llvmpipe-22.3.6".into()));
    assert_eq!(profiles("--lane embedded"), ("binary32".into(), Value::Null, Value::Null));
    let text = run("check sphere --samples 16 --lane embedded --profile wgsl").expect(0).out;
    assert!(text.contains("\nnote: lane `embedded`: promises of binary32; measured profile wgsl\n"), "{text}");
}

#[test]
fn a_profile_of_calibrate_is_taken_and_a_damaged_one_refused_at_the_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let line = format!("calibrate --lane embedded --builtin exp2,pow,log2,mul --samples 5000 -o {}", path.display());
    let ran = run(&line).expect(0);
    let hint = format!("\nThe measured profile is in {0}; use it with `check --profile {0}`.\n", path.display());
    assert!(ran.out.ends_with(&hint), "{}", ran.out);
    let (_, _, measured) = profiles(&format!("--profile {}", path.display()));
    assert_eq!(measured, format!("interpreter of shadercheck {}", env!("CARGO_PKG_VERSION")));
    let text = fs::read_to_string(&path).unwrap();
    let damaged = text.replacen("samples = ", "sample = ", 2).replacen("sample = ", "samples = ", 1);
    fs::write(&path, damaged).unwrap();
    let ran = run(&format!("check sphere --samples 16 --profile {}", path.display())).expect(2);
    let at = text.lines().enumerate().filter(|(_, line)| line.starts_with("samples = ")).nth(1).unwrap().0 + 1;
    let said = format!("{}:{at}:1: unknown key `sample`; did you mean `samples`?", path.display());
    assert!(ran.err.contains(&said), "{}", ran.err);
    assert_eq!(ran.out, "");
    fs::write(&path, &text[..text.len() / 2]).unwrap();
    run(&format!("check sphere --samples 16 --profile {}", path.display())).expect(2);
    let ran = run("check sphere --profile llvmpip-22.3.6").expect(2);
    assert_eq!(ran.err, "error: there is no profile and no file `llvmpip-22.3.6`; did you mean `llvmpipe-22.3.6`?\n");
}

/// The findings of the first suite of a report, without the commands.
fn findings(ran: &Ran) -> Vec<Value> {
    let mut findings = ran.json()["suites"][0]["findings"].as_array().unwrap().clone();
    findings.iter_mut().for_each(|f| f["reproduce"] = Value::Null);
    findings
}

#[test]
fn the_reported_command_shows_the_same_failure() {
    for (suite, shader) in
        [("sphere", "sphere_swapped.vert"), ("sphere", "sphere_turn.vert"), ("hair", "hair_last.geom")]
    {
        let ran =
            run(&format!("check {suite} --shader fixtures/alarms/{shader} --samples 304 --format json")).expect(1);
        let mut shown = 0;
        for entry in ran.json()["suites"].as_array().unwrap() {
            for finding in entry["findings"].as_array().unwrap().iter().filter(|f| f["kind"] != "coverage") {
                shown += 1;
                let line = finding["reproduce"].as_str().unwrap();
                let again = run_reported(root(), line, &["--format", "json"]).expect(1);
                let json = again.json();
                assert_eq!(json["suites"].as_array().unwrap().len(), 1);
                assert_eq!(json["suites"][0]["stage"], entry["stage"]);
                let same = findings(&again).into_iter().find(|f| f["message"] == finding["message"]);
                let same =
                    same.unwrap_or_else(|| panic!("{line}\ndoes not show\n{}\n{}", finding["message"], again.out));
                assert_eq!(same["case"]["inputs"], finding["case"]["inputs"]);
                assert_eq!(same["samples"], 1);
            }
        }
        assert!(shown > 0, "{shader}: no finding but that of coverage");
    }
}

#[test]
fn a_case_is_run_as_it_is_given() {
    let one = "mc=3f800000,00000000,00000000,00000000,00000000,3f800000,00000000,00000000,\
               00000000,00000000,3f800000,00000000,00000000,00000000,00000000,3f800000";
    let case = format!("{one} parameter=3dcccccd,3e99999a");
    let ran: Ran = command(root(), "check sphere --stage compute --case").arg(&case).output().unwrap().into();
    assert!(ran.expect(0).out.contains("pass: 1 judged, 1 agreed"));
    let args = "check sphere --shader fixtures/alarms/sphere_off.vert --stage compute --case";
    let ran: Ran = command(root(), args).arg(&case).output().unwrap().into();
    let ran = ran.expect(1);
    assert!(ran.out.contains("\n  case       vec2 parameter = 0.1, 0.3\n"), "not shrunk: {}", ran.out);
    assert!(ran.out.contains("fail: 1 judged, 0 agreed, 1 deviated"), "{}", ran.out);
}

#[test]
fn a_case_that_does_not_fit_is_reported() {
    let zeros = ["00000000"; 16].join(",");
    for (case, said) in [
        (String::new(), "--case: the case of suite `sphere` has no inputs"),
        ("parameter".to_owned(), "--case: expected `name=` and hexadecimal words such as `t=3f000000`"),
        ("parameter=zz".to_owned(), "--case: `zz` is not a 32-bit word in eight hexadecimal digits"),
        (format!("mc={zeros} parametr=0"), "--case: "),
        (format!("mc={zeros} parametr={}", &zeros[..17]), "no input `parametr`; did you mean `parameter`?"),
        (format!("mc={zeros} parameter={}", &zeros[..8]), "--case: input `parameter` (vec2) has 2 words, not 1"),
        (format!("mc={zeros}"), "--case: input `parameter` (vec2) of the shader is missing"),
    ] {
        let ran: Ran = command(root(), "check sphere --case").arg(&case).output().unwrap().into();
        let ran = ran.expect(2);
        assert!(ran.err.contains(said), "{case}: {}", ran.err);
        assert_eq!(ran.out, "");
    }
    let ran = run("check --shipped --case t=00000000").expect(2);
    assert!(ran.err.contains("--case needs exactly one suite"), "{}", ran.err);
}

/// Exit status when nobody reads standard output, or neither that nor standard error; and what came
/// on standard error when it is read.
fn unread(args: &str, read_err: bool) -> (Option<i32>, String) {
    let mut child = command(root(), args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let mut err = String::new();
    let mut stderr = child.stderr.take().unwrap();
    if read_err {
        stderr.read_to_string(&mut err).unwrap();
    }
    drop(stderr);
    (child.wait().unwrap().code(), err)
}

#[test]
fn a_reader_that_goes_away_does_not_change_the_status() {
    let wrong = "check sphere --shader fixtures/alarms/sphere_off.vert --samples 64";
    for read_err in [true, false] {
        for format in ["text", "json"] {
            let status = |args: &str| unread(&format!("{args} --format {format}"), read_err);
            assert_eq!(status("check sphere --samples 64"), (Some(0), String::new()));
            assert_eq!(status(wrong), (Some(1), String::new()));
        }
        assert_eq!(unread("check spere", read_err).0, Some(2));
    }
}

#[test]
fn suite_files_are_found_below_a_folder() {
    let ran = run("check shaders/chapter9 --samples 32 --stage vertex --lane vulkan --format json").expect(0);
    let json = ran.json();
    let names: Vec<&str> = json["suites"].as_array().unwrap().iter().map(|s| s["suite"].as_str().unwrap()).collect();
    assert_eq!(names, ["cylinder", "joints", "morph", "morph_targets", "skinning", "sphere", "two_bones"]);
}
