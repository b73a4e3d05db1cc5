//! Drivers that crash, hang, lose their device or give garbage, from the command line: each is told, the exit status is
//! 1, and the other lanes finish. Without lavapipe and glslang these tests fail, as those of the lanes do.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::binary::{Ran, command};

/// A product of an input and a uniform.
const PRODUCT: &str = "y = x * k + 1.0;";
/// A loop that ends for half of the uniforms alone.
const ENDLESS: &str = "y = x; while (y < k) { y *= 0.5; }";

/// A folder with a suite and its shader.
fn folder(body: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "#version 330\nin float x;\nuniform float k;\nout float y;\nvoid main() {{ {body} gl_Position = vec4(y); }}\n"
    );
    fs::write(folder.path().join("a.vert"), text).unwrap();
    let suite = "suite = \"a\"\ntitle = \"A number\"\nshader = \"a.vert\"\nstage = \"vertex\"\nsamples = 65536\nper_case = 4\n\
                 [[relations]]\nkind = \"range\"\noutputs = [\"y\"]\nrange = [-1e9, 1e9]\n\
                 [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n\
                 [[inputs]]\nnames = [\"k\"]\ngenerator = \"interval\"\nrange = [-1.0, 1.0]\n";
    fs::write(folder.path().join("a.suite.toml"), suite).unwrap();
    folder
}

/// A run whose processes of Vulkan lanes have a fault.
fn planted(folder: &Path, fault: &str, args: &str) -> Ran {
    let worker = folder.join("worker.sh");
    let text = format!("#!/bin/sh\nexec '{}' worker \"$@\" --plant {fault}\n", env!("CARGO_BIN_EXE_shadercheck"));
    fs::write(&worker, text).unwrap();
    fs::set_permissions(&worker, fs::Permissions::from_mode(0o755)).unwrap();
    command(folder, args).env("SHADERCHECK_WORKER", worker).output().unwrap().into()
}

/// The first lines of what is said of each lane and stage.
fn of<'r>(ran: &'r Ran, on: &str) -> &'r str {
    let line = ran.out.lines().find(|line| line.split_whitespace().nth(2) == Some(on));
    line.unwrap_or_else(|| panic!("nothing of {on}:\n{}\n{}", ran.out, ran.err))
}

const LANES: &str = "check a.suite.toml --plain --samples 512 --lane vulkan --lane vulkan-glslang --lane embedded";
const ON: [&str; 3] = ["vulkan/compute", "vulkan/vertex", "vulkan-glslang/vertex"];

#[test]
fn a_crash_is_reported_with_its_inputs_and_the_other_lanes_finish() {
    let folder = folder(PRODUCT);
    let ran = planted(folder.path(), "crash", LANES).expect(1);
    for on in ON {
        let line = of(&ran, on);
        assert!(line.starts_with("FAIL ") && line.contains("ended by signal 6 (abort)"), "{line}");
        assert!(line.contains(", at invocation ") && line.contains(" of 512, with k="), "{line}");
        // The invocation that is named is one that does it: its input is above a half.
        let x = line.rsplit("x=").next().unwrap();
        assert!(f32::from_bits(u32::from_str_radix(x, 16).unwrap()) > 0.5, "{line}");
    }
    assert!(of(&ran, "embedded/compute").starts_with("ok "), "{}", ran.out);
    assert_eq!(ran.out.matches("  reproduce  shadercheck check a.suite.toml --lane vulkan").count(), 3, "{}", ran.out);
}

/// Checks that a fault makes every Vulkan lane fail with these words, and no other lane.
fn reported(fault: &str, words: &str) {
    let folder = folder(PRODUCT);
    let ran = planted(folder.path(), fault, LANES).expect(1);
    for on in ON {
        let line = of(&ran, on);
        assert!(line.starts_with("FAIL ") && line.contains(words), "{line}");
    }
    assert!(of(&ran, "embedded/compute").starts_with("ok "), "{}", ran.out);
}

#[test]
fn garbage_is_no_result_and_the_other_lanes_finish() {
    reported("garbage", "was not written by this dispatch");
}

#[test]
fn a_lost_device_is_reported_and_the_other_lanes_finish() {
    reported("lost-device", "device lost: the device is lost");
    reported("out-of-memory", "out of memory: A device memory allocation has failed");
}

#[test]
fn a_driver_that_hangs_is_ended_and_the_invocation_without_end_is_named() {
    let folder = folder(ENDLESS);
    let lanes = "check a.suite.toml --plain --samples 64 --stage vertex --lane vulkan --lane vulkan-glslang";
    let ran = planted(folder.path(), "hang", lanes).expect(1);
    for on in &ON[1..] {
        let line = of(&ran, on);
        assert!(
            line.contains("gave no answer within 10 s, at invocation ") && line.contains(" of 64, with k="),
            "{line}"
        );
    }
}

#[test]
fn a_loop_without_end_is_reported_on_every_lane_in_little_memory() {
    let folder = folder(ENDLESS);
    let lanes = ["vulkan", "vulkan-glslang", "embedded"].map(|lane| format!(" --lane {lane}")).concat();
    let args = format!("check a.suite.toml --plain --samples 32{lanes}");
    // 6 GB of addresses for each process; without a limit the tapes of such loops took three times as much.
    let line = format!("ulimit -v 6000000; exec '{}' {args}", env!("CARGO_BIN_EXE_shadercheck"));
    let ran: Ran = Command::new("/bin/sh").args(["-c", &line]).current_dir(folder.path()).output().unwrap().into();
    let ran = ran.expect(1);
    for on in ["vulkan/compute", "vulkan/vertex", "vulkan-glslang/vertex", "embedded/compute"] {
        assert!(of(&ran, on).starts_with("FAIL "), "{}", ran.out);
    }
    assert!(ran.out.contains("a loop goes on after 65536 rounds"), "{}", ran.out);
}

/// The processes that serve the Vulkan lane of a run, by their numbers.
fn serving(parent: u32) -> Vec<u32> {
    let children = fs::read_to_string(format!("/proc/{parent}/task/{parent}/children")).unwrap_or_default();
    let served = |child: &u32| {
        let line = fs::read(format!("/proc/{child}/cmdline")).unwrap_or_default();
        line.split(|byte| *byte == 0).any(|word| word == b"vulkan")
    };
    children.split_whitespace().filter_map(|child| child.parse().ok()).filter(served).collect()
}

#[test]
fn a_process_that_is_killed_in_the_middle_is_reported_and_the_next_suite_runs() {
    let folder = folder(PRODUCT);
    let second = fs::read_to_string(folder.path().join("a.suite.toml")).unwrap().replace("\"a\"", "\"b\"");
    fs::write(folder.path().join("b.suite.toml"), second.replace("samples = 65536", "samples = 64")).unwrap();
    // So many samples that the run lasts until the process is killed, however fast the machine is.
    let args = "check a.suite.toml b.suite.toml --plain --lane vulkan --stage compute";
    let many = fs::read_to_string(folder.path().join("a.suite.toml")).unwrap();
    fs::write(folder.path().join("a.suite.toml"), many.replace("samples = 65536", "samples = 40000000")).unwrap();
    let mut run = command(folder.path(), args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let started = Instant::now();
    let child = loop {
        // To open a device takes less: a process that has been busy for half a second is in the middle of the run.
        let busy = |child: &u32| {
            let stat = fs::read_to_string(format!("/proc/{child}/stat")).unwrap_or_default();
            let after = stat.rsplit(')').next().unwrap_or_default();
            let ticks: u64 = after.split_whitespace().nth(11).and_then(|n| n.parse().ok()).unwrap_or(0);
            ticks >= 50
        };
        if let Some(child) = serving(run.id()).into_iter().find(busy) {
            break child;
        }
        assert!(run.try_wait().unwrap().is_none(), "the run ended before its process was busy");
        assert!(started.elapsed() < Duration::from_secs(120), "no process served the lane");
        std::thread::sleep(Duration::from_millis(5));
    };
    // The one of the shell: a small system has no other.
    assert!(Command::new("sh").args(["-c", &format!("kill -9 {child}")]).status().unwrap().success());
    let ran: Ran = run.wait_with_output().unwrap().into();
    let ran = ran.expect(1);
    let line = ran.out.lines().find(|line| line.contains(" a ")).unwrap_or_else(|| panic!("{}", ran.out));
    assert!(line.starts_with("FAIL ") && line.contains("ended by signal 9 (killed)"), "{line}");
    let line = ran.out.lines().find(|line| line.contains(" b ")).unwrap_or_else(|| panic!("{}", ran.out));
    assert!(line.starts_with("ok "), "{line}");
}
