//! Random programs from the command line: what is printed, parts of a run, and what a signal leaves.

use serde_json::Value;

use crate::binary::{root, run_in};

const RUN: &str = "torture --lane embedded --language glsl --samples 16 --seed 1";

fn torture(arguments: &str, status: i32) -> Value {
    run_in(root(), &format!("{RUN} {arguments} --format json")).expect(status).json()
}

#[test]
fn forty_programs_of_a_fixed_seed_are_judged_and_nothing_is_found() {
    let report = torture("--programs 40", 0);
    assert_eq!((&report["schema"], &report["programs"]), (&"shadercheck.torture".into(), &40.into()));
    assert_eq!(report["findings"], Value::Array(Vec::new()), "{report:#}");
    assert!(report["agreed"].as_u64().unwrap() > 400 && report["vacuous"].as_u64().unwrap() < 10, "{report:#}");
    assert_eq!(report["lanes"][0]["programs"], 40);
}

#[test]
fn parts_merge_to_the_run_and_are_done_once() {
    let folder = tempfile::tempdir().unwrap();
    let shards = folder.path().join("shards");
    let shards = shards.to_str().unwrap();
    for index in 0..2 {
        let part = format!("--programs 12 --shard {index}/2 --shard-dir {shards}");
        torture(&part, 0);
        let again = run_in(root(), &format!("{RUN} {part}")).expect(0);
        assert!(again.out.contains("was done before"), "{}", again.out);
    }
    let merged = run_in(root(), &format!("merge {shards} --format json")).expect(0).json();
    assert_eq!(merged, torture("--programs 12", 0));
}

#[test]
fn a_lane_that_is_unknown_is_told() {
    run_in(root(), "torture --lane nowhere").expect(2);
    run_in(root(), "torture --programs 0").expect(2);
}
