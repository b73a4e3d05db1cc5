//! Findings survive: a signal ends a run early and what it found is reported, and so it is where the folder of a suite
//! takes no file.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::binary::{Ran, command, root};

/// Starts a command, sends it a signal after a while, and waits for its end.
fn signalled(mut command: Command, signal: &str, after: Duration) -> Output {
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(after);
    // Every shell has it; a machine need not have it as a program.
    let sent = Command::new("sh").args(["-c", &format!("kill -{signal} {}", child.id())]).status().unwrap();
    assert!(sent.success(), "the run ended before the signal");
    let begun = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(begun.elapsed() < Duration::from_secs(60), "it took {:?} to end", begun.elapsed());
    output
}

/// A folder with a suite of a wrong shader: half a sphere lies beside it.
fn wrong() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let shader =
        "#version 330\nin float x;\nout float y;\nvoid main() { y = x > 0.5 ? x + 1.0 : x; gl_Position = vec4(y); }\n";
    fs::write(folder.path().join("a.vert"), shader).unwrap();
    let suite = "suite = \"a\"\ntitle = \"A number\"\nshader = \"a.vert\"\nstage = \"vertex\"\nsamples = 65536\n\
                 reference = \"b.vert\"\n\
                 [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n";
    fs::write(folder.path().join("a.suite.toml"), suite).unwrap();
    fs::write(folder.path().join("b.vert"), shader.replace("x + 1.0", "x")).unwrap();
    folder
}

/// Names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_signal_ends_a_check_with_what_it_found() {
    for (signal, name, status) in [("INT", "SIGINT", 130), ("TERM", "SIGTERM", 143)] {
        // How far a run comes in some seconds depends on the machine.
        for seconds in [4, 16, 64] {
            let folder = wrong();
            let check = command(folder.path(), "check a.suite.toml --plain --lane embedded --samples 4000000000");
            let ran: Ran = signalled(check, signal, Duration::from_secs(seconds)).into();
            let ran = ran.expect(status);
            let reported = format!("error: the run was interrupted by {name}; this is what was found until then\n");
            assert!(ran.err.ends_with(&reported), "{}", ran.err);
            let left: Vec<String> = names(folder.path());
            assert!(
                left.iter().all(|name| ["a.regressions", "a.suite.toml", "a.vert", "b.vert"].contains(&name.as_str())),
                "{left:?}"
            );
            if ran.out.contains("FAIL  a ") {
                assert!(ran.out.contains("  reproduce  shadercheck check a.suite.toml"), "{}", ran.out);
                assert!(ran.out.lines().last().unwrap().starts_with("incomplete: "), "{}", ran.out);
                break;
            }
            assert!(seconds < 64, "nothing was judged in {seconds} s: {}", ran.out);
        }
    }
}

#[test]
fn a_signal_ends_a_run_whose_driver_hangs_and_its_processes() {
    let folder = wrong();
    let worker = folder.path().join("worker.sh");
    let text = format!("#!/bin/sh\nexec '{}' worker \"$@\" --plant hang\n", env!("CARGO_BIN_EXE_shadercheck"));
    fs::write(&worker, text).unwrap();
    fs::set_permissions(&worker, fs::Permissions::from_mode(0o755)).unwrap();
    let mut check = command(folder.path(), "check a.suite.toml --plain --lane vulkan --stage compute");
    check.env("SHADERCHECK_WORKER", &worker).env("SHADERCHECK_MARK", folder.path());
    let ran: Ran = signalled(check, "INT", Duration::from_secs(5)).into();
    let ran = ran.expect(130);
    assert!(!ran.out.contains("FAIL") && ran.err.contains("interrupted by SIGINT"), "no lane failed: {ran:?}");
    // Nothing that was started for the run is left.
    let mark = format!("SHADERCHECK_MARK={}", folder.path().display());
    let marked = |entry: &fs::DirEntry| {
        fs::read(entry.path().join("environ"))
            .is_ok_and(|bytes| bytes.split(|byte| *byte == 0).any(|variable| variable == mark.as_bytes()))
    };
    let left = || fs::read_dir("/proc").unwrap().filter_map(Result::ok).filter(marked).count();
    for _ in 0..30 {
        if left() == 0 {
            return;
        }
        std::thread::sleep(Duration::from_millis(200));
    }
    panic!("{} processes are left", left());
}

#[test]
fn a_signal_ends_fuzz_and_mutate_with_what_they_found() {
    let folder = tempfile::tempdir().unwrap();
    let text = "float f(float x) { return x + 1.0; }\nfloat g(float x) { return sqrt(x - 4.0); }\n";
    fs::write(folder.path().join("f.glsl"), text).unwrap();
    let fuzz = command(folder.path(), "fuzz f.glsl --lane embedded --samples 4000000000");
    let ran: Ran = signalled(fuzz, "INT", Duration::from_secs(5)).into();
    let ran = ran.expect(130);
    assert!(ran.out.contains("f ") && ran.out.contains(" samples"), "{}", ran.out);
    assert!(ran.err.contains("error: the run was interrupted by SIGINT"), "{}", ran.err);
    let mutate = command(root(), "mutate skinning --lane embedded --samples 4000000");
    let ran: Ran = signalled(mutate, "TERM", Duration::from_secs(5)).into();
    assert!(ran.expect(143).err.contains("error: the run was interrupted by SIGTERM"));
}

#[test]
fn a_signal_ends_tune_with_the_shaders_that_are_done_and_writes_none_of_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let own = fs::read_to_string(root().join("fixtures/tune/distance.frag")).unwrap();
    fs::write(folder.path().join("distance.frag"), &own).unwrap();
    let tune = command(folder.path(), "tune distance.frag --fix --samples 1048576");
    let ran: Ran = signalled(tune, "INT", Duration::from_secs(3)).into();
    let ran = ran.expect(130);
    assert!(ran.err.contains("error: the run was interrupted by SIGINT; this is what was found"), "{}", ran.err);
    assert_eq!(fs::read_to_string(folder.path().join("distance.frag")).unwrap(), own);
}

#[test]
fn a_signal_leaves_no_file_that_is_half_written() {
    let folder = tempfile::tempdir().unwrap();
    let generate = command(folder.path(), "refdata generate sphere --samples 400000000 -o sphere.npz");
    let output = signalled(generate, "INT", Duration::from_secs(4));
    assert_eq!(output.status.signal(), Some(2), "{output:?}");
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn findings_are_reported_where_the_folder_takes_no_file() {
    let (folder, open) = (wrong(), tempfile::tempdir().unwrap());
    fs::set_permissions(open.path(), fs::Permissions::from_mode(0o755)).unwrap();
    let run = |mode: u32| -> Ran {
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(mode)).unwrap();
        let mut check = command(folder.path(), "check a.suite.toml --plain --lane embedded --samples 256");
        if !is_root() {
            return check.output().unwrap().into();
        }
        // Nothing is forbidden to the owner of the machine, and others may not get into the folder of its build.
        let program = open.path().join("shadercheck");
        if !program.exists() {
            fs::copy(check.get_program(), &program).unwrap();
        }
        let mut other = Command::new(program);
        other.args(check.get_args()).current_dir(folder.path()).uid(65534).gid(65534);
        other.output().unwrap().into()
    };
    let ran = run(0o555).expect(1);
    assert!(ran.out.contains("FAIL  a ") && ran.out.contains("  reproduce  "), "{}", ran.out);
    assert!(ran.err.contains("warning: failing cases are not saved: "), "{}", ran.err);
    let ran = run(0o777).expect(1);
    assert!(!ran.err.contains("warning"), "{}", ran.err);
    assert!(names(folder.path()).contains(&"a.regressions".to_owned()));
}

fn is_root() -> bool {
    let output = Command::new("id").arg("-u").output().unwrap();
    output.stdout.starts_with(b"0")
}

#[test]
fn findings_are_reported_where_the_folder_of_reports_cannot_be_made() {
    let folder = wrong();
    fs::write(folder.path().join("report"), "a file").unwrap();
    let ran: Ran =
        command(folder.path(), "check a.suite.toml --plain --lane embedded --samples 256 --report-dir report")
            .output()
            .unwrap()
            .into();
    let ran = ran.expect(2);
    assert!(ran.out.contains("FAIL  a ") && ran.out.contains("  reproduce  "), "{}", ran.out);
    assert!(ran.err.contains("report"), "{}", ran.err);
}

#[test]
fn a_signal_ends_long_loops_on_their_way() {
    let folder = tempfile::tempdir().unwrap();
    // Every sample goes through as many rounds as are followed, in each of which something is done that has to be bounded.
    let text = "float f(float x, int n) {\n  float a = x;\n  for (int i = 0; i < 8000; ++i)\n    \
                a = sin(a * x) + cos(a) + float(n % (i + 1));\n  return a;\n}\n";
    fs::write(folder.path().join("f.glsl"), text).unwrap();
    for arguments in ["fuzz f.glsl", "compare f.glsl f.glsl"] {
        let run = command(folder.path(), &format!("{arguments} --lane embedded --samples 4000000"));
        let begun = Instant::now();
        let ran: Ran = signalled(run, "TERM", Duration::from_secs(10)).into();
        let took = begun.elapsed();
        let ran = ran.expect(143);
        assert!(took < Duration::from_secs(25), "{arguments}: {took:?}");
        assert!(ran.out.contains("SIGTERM") || ran.err.contains("SIGTERM"), "{arguments}: {ran:?}");
        assert!(!ran.out.contains("does not end"), "{arguments}: {}", ran.out);
    }
}
