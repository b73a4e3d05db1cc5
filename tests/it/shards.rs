//! `--shard` and `merge`: parts of a run together are the run, whatever their number, and whatever happens to
//! one of them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use engine::shard::{self, Sealed};
use serde_json::Value;

use crate::binary::{Ran, command, root, run};

/// All parts of a run in a folder of their own.
fn shards(folder: &Path, args: &str, count: u64) -> PathBuf {
    let folder = folder.join(format!("of{count}"));
    for index in 0..count {
        run(&format!("{args} --shard {index}/{count} --shard-dir {}", folder.display())).expect(0);
    }
    folder
}

fn merge(folder: &Path, more: &str) -> Ran {
    run(&format!("merge {} {more}", folder.display()))
}

/// The file of a part.
fn part(folder: &Path, index: u64, count: u64) -> PathBuf {
    folder.join(format!("shard-{index:05}-of-{count:05}.json"))
}

/// Runs a command whole and in parts, and compares what is printed, byte by byte.
fn same_in_parts(args: &str, counts: &[u64], status: i32) {
    let folder = tempfile::tempdir().unwrap();
    let whole = run(args).expect(status);
    let whole_json = run(&format!("{args} --format json")).expect(status);
    for &count in counts {
        let parts = shards(folder.path(), args, count);
        let merged = merge(&parts, "").expect(status);
        assert_eq!(merged.out, whole.out, "{args}, {count} shards");
        assert_eq!(merge(&parts, "--format json").expect(status).out, whole_json.out, "{args}, {count} shards");
    }
}

#[test]
fn shards_of_all_shipped_suites_are_the_run() {
    same_in_parts("check --shipped --lane embedded --samples 300", &[1, 2, 3, 7], 0);
}

#[test]
fn shards_on_a_driver_are_the_run() {
    same_in_parts("check sphere hermite --lane vulkan --samples 5000 --seed 3", &[2], 0);
}

#[test]
fn failures_are_shrunk_in_parts_as_in_the_run() {
    same_in_parts(
        "check sphere --shader fixtures/alarms/sphere_swapped.vert --lane embedded --samples 1001",
        &[1, 2, 3, 7, 16],
        1,
    );
}

#[test]
fn functions_are_fuzzed_in_parts() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("glow.glsl");
    let text = "float glow(vec3 p, vec3 lamp, float radius) { return exp(-distance(p, lamp) / radius); }\n\
                vec3 blend(vec3 a, vec3 b, float wa, float wb) { return (a * wa + b * wb) / (wa + wb); }\n\
                float twice(float x) { return 2.0 * x; }\n";
    fs::write(&file, text).unwrap();
    same_in_parts(&format!("fuzz {} --samples 2000 --notes --arbitrary", file.display()), &[1, 2, 5], 1);
    same_in_parts(&format!("fuzz {} --samples 2000", file.display()), &[2], 0);
}

#[test]
fn mutants_are_tested_in_parts() {
    same_in_parts("mutate hermite --operator sign,operand-order --samples 512 --lane embedded", &[1, 3], 0);
}

/// A part that is damaged or missing is refused, of whatever command.
fn faults_are_refused(args: &str) {
    let folder = tempfile::tempdir().unwrap();
    let parts = shards(folder.path(), args, 2);
    let second = part(&parts, 1, 2);
    let text = fs::read_to_string(&second).unwrap();
    let error = |what: &str| {
        let ran = merge(&parts, "").expect(2);
        assert!(ran.err.contains(what) && ran.out.is_empty(), "{args}: `{what}` is not in\n{}", ran.err);
    };
    // One digit of what was found: the last one of the text.
    let at = text.rfind(|c: char| c.is_ascii_digit()).unwrap();
    let other = if text.as_bytes()[at] == b'1' { "2" } else { "1" };
    fs::write(&second, format!("{}{other}{}", &text[..at], &text[at + 1..])).unwrap();
    error("the file is damaged: its checksum does not fit");
    fs::remove_file(&second).unwrap();
    error("of 2 shards 1 is missing: 1");
}

#[test]
fn programs_are_tried_in_parts() {
    let args = "torture --lane embedded --language glsl --samples 16 --programs 4";
    faults_are_refused(args);
}

#[test]
fn pairs_of_functions_are_compared_in_parts() {
    let folder = tempfile::tempdir().unwrap();
    let text = "float glow(float d, float r) { return exp(-d / r); }\nfloat twice(float x) { return 2.0 * x; }\n\
                vec3 mean(vec3 a, vec3 b) { return 0.5 * (a + b); }\nfloat root(float x) { return sqrt(x); }\n";
    let [first, second] = ["a.glsl", "b.glsl"].map(|name| folder.path().join(name));
    fs::write(&first, text).unwrap();
    fs::write(&second, text.replace("2.0 * x", "x + abs(x)")).unwrap();
    let args = format!("compare {} {} --lane embedded --samples 1000", first.display(), second.display());
    same_in_parts(&args, &[1, 2, 5], 1);
    same_in_parts(&format!("{args} --function mean"), &[2], 0);
    faults_are_refused(&args);
    for more in ["--case x=3f800000 --function twice", "--report-dir page"] {
        run(&format!("{args} --shard 0/2 {more}")).expect(2);
    }
}

#[test]
fn shaders_are_tuned_in_parts() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["all.frag", "none.frag", "distance.frag"] {
        fs::copy(root().join("fixtures/tune").join(name), folder.path().join(name)).unwrap();
    }
    // One that does not compile is a finding of the run, and of its parts.
    fs::write(folder.path().join("broken.frag"), "precision mediump float;\nvoid main() { gl_FragColor = x; }\n")
        .unwrap();
    let args = format!("tune {} --samples 512", folder.path().display());
    same_in_parts(&args, &[1, 3], 1);
    faults_are_refused(&args);
    run(&format!("{args} --shard 0/2 --fix")).expect(2);
}

#[test]
fn formulas_are_improved_in_parts() {
    let folder = tempfile::tempdir().unwrap();
    let texts = [
        ("a.glsl", "// shadercheck: x in [0.000001, 1]\nfloat growth(float x) { return exp(x) - 1.0; }\n"),
        ("b.glsl", "// shadercheck: x in [1, 1000000]\nfloat step1(float x) { return sqrt(x + 1.0) - sqrt(x); }\n"),
        ("c.glsl", "float twice(float x) { return 2.0 * x; }\n"),
    ];
    texts.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).unwrap());
    let args = format!("improve {} --samples 4096", folder.path().display());
    same_in_parts(&args, &[1, 2], 1);
    faults_are_refused(&args);
    run(&format!("{args} --shard 0/2 --fix")).expect(2);
}

#[test]
fn a_device_is_measured_in_parts() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("p.toml");
    let args = format!("calibrate --lane embedded --builtin sin,mul --samples 5000 --output {}", output.display());
    let whole = run(&args).expect(0);
    let profile = fs::read_to_string(&output).unwrap();
    for count in [1, 3] {
        fs::remove_file(&output).unwrap();
        let parts = shards(folder.path(), &args, count);
        assert_eq!(merge(&parts, "").expect(0).out, whole.out);
        assert_eq!(fs::read_to_string(&output).unwrap(), profile, "{count} shards");
    }
}

#[test]
fn the_order_and_the_grouping_of_a_merge_do_not_matter() {
    let folder = tempfile::tempdir().unwrap();
    let args = "check sphere bone_weight --shader fixtures/alarms/sphere_swapped.vert --lane embedded --samples 700";
    let args = args.replace(" bone_weight", "");
    let parts = shards(folder.path(), &args, 5);
    let joined = |name: &str, files: &[PathBuf]| {
        let out = folder.path().join(name);
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        run(&format!("merge {} --out {}", files.join(" "), out.display()));
        out
    };
    let part = |index| part(&parts, index, 5);
    let whole = fs::read(joined("whole", &[0, 1, 2, 3, 4].map(part))).unwrap();
    let backwards = fs::read(joined("backwards", &[4, 3, 2, 1, 0].map(part))).unwrap();
    assert!(whole == backwards, "the order of the files shows");
    // (4 + 1) + ((3 + 0) + 2), and 2 + (0 + (1 + (3 + 4))).
    let (a, b) = (joined("a", &[part(4), part(1)]), joined("b", &[part(3), part(0)]));
    let c = joined("c", &[b, part(2)]);
    assert!(fs::read(joined("abc", &[a, c])).unwrap() == whole, "the grouping shows");
    let mut nested = joined("d", &[part(3), part(4)]);
    for index in [1, 0, 2] {
        nested = joined(&format!("n{index}"), &[part(index), nested]);
    }
    assert!(fs::read(nested).unwrap() == whole, "the grouping shows");
}

#[test]
fn a_shard_that_is_missing_doubled_or_of_another_run_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let args = "check sphere --lane embedded --stage compute --samples 64";
    let parts = shards(folder.path(), args, 3);
    let error = |ran: Ran, part: &str| {
        let ran = ran.expect(2);
        assert!(ran.err.contains(part) && ran.out.is_empty(), "`{part}` is not in\n{}", ran.err);
    };
    let second = part(&parts, 1, 3);
    let text = fs::read_to_string(&second).unwrap();
    fs::remove_file(&second).unwrap();
    error(merge(&parts, ""), "of 3 shards 1 is missing: 1; run each again with --shard 1/3");

    fs::write(&second, &text).unwrap();
    fs::copy(&second, parts.join("shard-copy.json")).unwrap();
    error(merge(&parts, ""), "shard 1/3 is there twice: in `");
    fs::remove_file(parts.join("shard-copy.json")).unwrap();

    // A half-written file is not read as whole.
    fs::write(&second, &text[..text.len() / 2]).unwrap();
    error(merge(&parts, ""), "the file is damaged: it ends too early; remove it and run its shard again");
    fs::write(&second, text.replacen("\"agreed\":", "\"agreed\":1", 1)).unwrap();
    error(merge(&parts, ""), "the file is damaged: its checksum does not fit");
    fs::write(&second, text.replacen("\"schema_version\":1", "\"schema_version\":9", 1)).unwrap();
    error(merge(&parts, ""), "this is a result of schema version 9, and this version of the tool reads version 1");
    fs::write(&second, "{}").unwrap();
    error(merge(&parts, ""), "this is no result of a shard");

    fs::remove_file(&second).unwrap();
    let other = folder.path().join("other");
    run(&format!("{args} --seed 9 --shard 1/3 --shard-dir {}", other.display())).expect(0);
    fs::copy(part(&other, 1, 3), &second).unwrap();
    error(merge(&parts, ""), "the seed is `24301` in one and `9` in the other");
    fs::remove_dir_all(&other).unwrap();
    run(&format!(
        "check sphere --lane embedded --stage compute --samples 65 --shard 1/3 --shard-dir {}",
        other.display()
    ))
    .expect(0);
    fs::copy(part(&other, 1, 3), &second).unwrap();
    error(merge(&parts, ""), "--samples is `64` in one and `65` in the other");

    // Of another version of the tool: one of them, and all.
    for index in [1, 0, 2] {
        let file = part(&parts, index, 3);
        let text = if index == 1 { text.clone() } else { fs::read_to_string(&file).unwrap() };
        let mut sealed: Sealed<Value> = shard::open(&text).unwrap();
        sealed.identity.version = "0.0.1".to_owned();
        fs::write(&file, shard::seal(&sealed).unwrap()).unwrap();
        if index == 1 {
            error(merge(&parts, ""), "the version of the tool is `");
        }
    }
    error(merge(&parts, ""), "the results are of version 0.0.1 of the tool, and this is version ");

    error(merge(folder.path(), ""), "holds no results of shards");
    error(merge(&folder.path().join("gone"), ""), "cannot read");
}

#[test]
fn a_shard_that_is_none_and_a_folder_that_is_none_are_reported_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let error = |args: &str, part: &str| {
        let ran = run(args).expect(2);
        assert!(ran.err.contains(part), "`{part}` is not in\n{}", ran.err);
    };
    let hermite = "shaders/hair/hermite.glsl";
    for command in [
        "check sphere",
        "mutate sphere",
        &format!("fuzz {hermite}"),
        &format!("compare {hermite} {hermite}"),
        &format!("improve {hermite}"),
        "tune fixtures/tune/all.frag",
        "torture",
        "calibrate",
    ] {
        error(&format!("{command} --shard 4/4"), "there is no shard 4 of 4: shards are counted from 0");
        error(&format!("{command} --shard 0/0"), "a run in 0 shards does nothing");
        error(&format!("{command} --shard first"), "`first` is no shard; give I/N");
    }
    error("check sphere --samples 0 --shard 0/2", "0 is not in 1..");
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    error(
        &format!("check sphere --lane embedded --shard 0/2 --shard-dir {}", file.display()),
        "cannot make the folder",
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left behind");
}

#[test]
fn the_environment_names_the_shard() {
    let folder = tempfile::tempdir().unwrap();
    let args = format!(
        "check sphere --lane embedded --stage compute --samples 64 --shard auto --shard-dir {}",
        folder.path().display()
    );
    let with = |variables: &[(&str, &str)]| -> Ran {
        let mut command = command(root(), &args);
        for name in ["CI_NODE_INDEX", "CI_NODE_TOTAL", "SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX"] {
            command.env_remove(name);
        }
        command.envs(variables.iter().copied()).output().unwrap().into()
    };
    let ran = with(&[("JOB_COMPLETION_INDEX", "1"), ("SHADERCHECK_SHARD_COUNT", "2")]).expect(0);
    assert!(ran.out.starts_with("shard 1/2 is done: "), "{}", ran.out);
    let ran = with(&[("CI_NODE_INDEX", "1"), ("CI_NODE_TOTAL", "2")]).expect(0);
    assert!(ran.out.starts_with("shard 0/2 is done: "), "{}", ran.out);
    merge(folder.path(), "").expect(0);
    assert!(with(&[]).expect(2).err.contains("nothing says which shard this is"));
}

/// A run that is killed when this goes out of scope.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_killed_shard_goes_on_from_its_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    // Records are large: a batch has few samples, and there are many checkpoints.
    let args = "check skinning --lane embedded --samples 60000";
    let share = format!("{args} --shard 0/1 --shard-dir {}", folder.path().display());
    let checkpoint = folder.path().join("shard-00000-of-00001.checkpoint");
    let mut running = Running(command(root(), &share).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap());
    let begin = Instant::now();
    while !checkpoint.exists() {
        assert!(running.0.try_wait().unwrap().is_none(), "it ended without a checkpoint");
        assert!(begin.elapsed() < Duration::from_secs(300), "no checkpoint");
        std::thread::sleep(Duration::from_millis(5));
    }
    drop(running);
    assert!(!part(folder.path(), 0, 1).exists(), "it came to its end");
    assert!(merge(folder.path(), "").expect(2).err.contains("holds no results of shards"));
    let again = run(&share).expect(0);
    assert!(again.err.contains("shard 0/1 goes on from its checkpoint"), "{}", again.err);
    assert_eq!(merge(folder.path(), "").expect(0).out, run(args).expect(0).out);
    // A third time there is nothing to do.
    assert!(run(&share).expect(0).out.starts_with("shard 0/1 was done before: "));
}
