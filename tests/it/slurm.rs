//! The scripts in `deploy/slurm`, with a stand-in for `sbatch`; `cargo xtask slurm-demo` runs them on a cluster.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use crate::binary::{Ran, root, run};

fn script(name: &str) -> Command {
    let mut command = Command::new(root().join("deploy/slurm").join(name));
    command.env("SHADERCHECK", env!("CARGO_BIN_EXE_shadercheck")).current_dir(root());
    command
}

/// An `sbatch` that writes down its arguments and numbers jobs from 41.
fn stand_in(folder: &Path) -> String {
    let path = folder.join("sbatch");
    let log = folder.join("log").display().to_string();
    let text = format!("#!/bin/sh\necho \"$@\" >> '{log}'\nexpr 40 + $(wc -l < '{log}')\n");
    fs::write(&path, text).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    format!("{}:{}", folder.display(), std::env::var("PATH").unwrap_or_default())
}

#[test]
fn submitting_makes_an_array_and_a_merge_that_waits_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = stand_in(folder.path());
    let dir = folder.path().join("results");
    let submit = |shards: &str, more: &[&str]| -> Ran {
        let mut command = script("submit.sh");
        command.arg(shards).arg(&dir).args(more).env("PATH", &path).env("SBATCH_OPTIONS", "--time=5 --exclusive");
        command.output().unwrap().into()
    };
    let ran = submit("8", &["check", "sphere", "--samples", "9"]).expect(0);
    assert_eq!(ran.out, "shards 41\nmerge 42\n");
    let log = fs::read_to_string(folder.path().join("log")).unwrap();
    let lines: Vec<&str> = log.lines().collect();
    let dir = dir.canonicalize().unwrap().display().to_string();
    for part in ["--array=0-7", "--time=5 --exclusive", &format!("shards.sh {dir} check sphere --samples 9")] {
        assert!(lines[0].contains(part), "`{part}`: {}", lines[0]);
    }
    for part in ["--dependency=afterok:41", "--time=5 --exclusive", &format!("merge.sh {dir}")] {
        assert!(lines[1].contains(part), "`{part}`: {}", lines[1]);
    }
    for wrong in ["0", "x", "-1", ""] {
        assert!(submit(wrong, &["check"]).expect(2).err.contains("is no number of shards"), "{wrong}");
    }
    assert!(submit("8", &[]).expect(2).err.contains("submit.sh SHARDS DIR COMMAND..."));
}

#[test]
fn tasks_and_their_merge_give_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["sphere", "--lane", "embedded", "--stage", "compute", "--samples", "100"];
    for (task, index) in [("3", 0), ("5", 1)] {
        let mut command = script("shards.sh");
        command.arg(folder.path()).arg("check").args(args).env("SLURM_ARRAY_TASK_ID", task);
        command.envs([("SLURM_ARRAY_TASK_MIN", "3"), ("SLURM_ARRAY_TASK_MAX", "5")]);
        command.envs([("SLURM_ARRAY_TASK_STEP", "2"), ("SLURM_ARRAY_TASK_COUNT", "2")]);
        command.env_remove("CI_NODE_INDEX");
        let ran = Ran::from(command.output().unwrap()).expect(0);
        assert!(ran.out.starts_with(&format!("shard {index}/2 is done: ")), "{}", ran.out);
    }
    let merged = Ran::from(script("merge.sh").arg(folder.path()).output().unwrap()).expect(0);
    let whole = run(&format!("check {}", args.join(" "))).expect(0);
    assert_eq!(merged.out, whole.out);
    assert_eq!(fs::read_to_string(folder.path().join("report.txt")).unwrap(), whole.out);
}

#[test]
fn tasks_write_parts_of_reference_data() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("data");
    let args = ["generate", "bone_weight", "--samples", "70000", "--profile", "none"];
    for task in ["0", "1"] {
        let mut command = script("shards.sh");
        command.arg(&dir).arg("refdata").args(args).env("SLURM_ARRAY_TASK_ID", task).env_remove("CI_NODE_INDEX");
        command.envs([("SLURM_ARRAY_TASK_MIN", "0"), ("SLURM_ARRAY_TASK_MAX", "1"), ("SLURM_ARRAY_TASK_COUNT", "2")]);
        Ran::from(command.output().unwrap()).expect(0);
    }
    let merged = Ran::from(script("merge.sh").arg(&dir).output().unwrap()).expect(0);
    let whole = folder.path().join("whole.npz");
    let whole = run(&format!("refdata {} -o {}", args.join(" "), whole.display())).expect(0);
    let (_, digest) = whole.out.trim().rsplit_once(' ').unwrap();
    assert!(
        merged.out.starts_with(&format!("bone_weight  70000 samples in 2 parts  sha256 {digest}\n")),
        "{}",
        merged.out
    );
}
