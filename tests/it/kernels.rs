//! Compute stages as whole dispatches: each kernel of `fixtures/kernels/right` is silent, and its twin in `wrong`, which
//! has one fault, is found with the kind of the fault and its place.

use std::collections::BTreeSet;
use std::fs;

use serde_json::Value;

use crate::binary::{root, run_in};

fn fuzzed(folder: &str, name: &str, status: i32) -> Value {
    let command = format!("fuzz fixtures/kernels/{folder}/{name} --lane embedded --samples 16 --format json");
    run_in(root(), &command).expect(status).json()
}

/// Findings and warnings of dispatches: kind, severity, line.
fn told(report: &Value) -> Vec<(String, String, u64)> {
    let functions = report["files"][0]["functions"].as_array().unwrap();
    let all = functions.iter().flat_map(|function| function["findings"].as_array().unwrap());
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let line = |finding: &Value| {
        let at = text(&finding["at"]);
        at.rsplit(':').nth(1).unwrap().parse().unwrap()
    };
    all.filter(|finding| finding["severity"] != "note")
        .map(|finding| (text(&finding["kind"]), text(&finding["severity"]), line(finding)))
        .collect()
}

/// The wrong twins: the fault that each has, whether it fails the run, and a line that is named.
const WRONG: [(&str, &str, bool, u64); 14] = [
    // A barrier that is missing behind a step of the sum.
    ("sum.wgsl", "race", true, 21),
    // Elements behind the last one are not filled.
    ("tail.comp", "unset", true, 18),
    // Written and read in one step.
    ("scan.comp", "race", true, 17),
    // No guard for the tail.
    ("transpose.wgsl", "index", false, 21),
    // Counted without an atomic function.
    ("histogram.wgsl", "race", false, 11),
    // The blur reads what it writes.
    ("blur.comp", "race", true, 14),
    // One off in the guard.
    ("particles.wgsl", "index", true, 12),
    // The next tile is loaded while others still read the last one.
    ("product.comp", "race", true, 20),
    // Who has no element leaves before the barrier.
    ("reverse.wgsl", "divergence", true, 13),
    // An index behind the end, after a wait that depends on what is in memory.
    ("ticket.wgsl", "index", true, 27),
    // One more than there are for each workgroup; a host may have room for it.
    ("blocks.wgsl", "index", false, 9),
    // The element before the first; its twin selects another value there.
    ("select.wgsl", "index", true, 12),
    // One off in the guard of an array with nine elements for each of the dispatch.
    ("gradients.wgsl", "index", true, 20),
    // Pairs overlap.
    ("sort.wgsl", "race", true, 18),
];

#[test]
fn kernels_that_are_right_are_silent() {
    for (name, ..) in WRONG {
        let report = fuzzed("right", name, 0);
        assert_eq!(told(&report), [], "{name}");
        let dispatches = report["files"][0]["functions"][0]["dispatches"].as_u64().unwrap();
        assert!(dispatches >= 2, "{name}: {dispatches}");
    }
}

#[test]
fn each_wrong_kernel_is_found_by_kind_and_place() {
    for (name, kind, fails, line) in WRONG {
        let report = fuzzed("wrong", name, i32::from(fails));
        let told = told(&report);
        let severity = if fails { "finding" } else { "warning" };
        let wanted = (kind.to_owned(), severity.to_owned(), line);
        assert!(told.contains(&wanted), "{name}: {told:?}");
        // One fault is no reason to tell another.
        let kinds: BTreeSet<&str> =
            told.iter().filter(|(_, severity, _)| severity == "finding").map(|(kind, ..)| &**kind).collect();
        assert!(kinds.is_subset(&BTreeSet::from([kind])), "{name}: {told:?}");
    }
}

#[test]
fn every_kernel_has_its_twin() {
    let names = |folder: &str| -> BTreeSet<String> {
        let entries = fs::read_dir(root().join("fixtures/kernels").join(folder)).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    };
    let listed: BTreeSet<String> = WRONG.iter().map(|(name, ..)| (*name).to_owned()).collect();
    assert_eq!((names("right"), names("wrong")), (listed.clone(), listed));
}

#[test]
fn a_race_is_told_with_both_places_and_what_the_host_did() {
    let report = run_in(root(), "fuzz fixtures/kernels/wrong/sum.wgsl --lane embedded").expect(1);
    for part in [
        "race on `part[16]`: invocation 0 reads it, and invocation 16 writes it at fixtures/kernels/wrong/sum.wgsl:21:13, with no barrier between",
        "at         fixtures/kernels/wrong/sum.wgsl:21:30: `part[local.x + half]`",
        "workgroups = 1",
        "elements of `values` = 1",
        "16 dispatches",
    ] {
        assert!(report.out.contains(part), "{part}\n{}", report.out);
    }
}

#[test]
fn what_is_not_judged_is_told() {
    let head = "@group(0) @binding(0) var<storage, read_write> a: array<u32>;\n\
                @group(0) @binding(1) var<storage, read> b: array<u32>;\n";
    let id = "@builtin(global_invocation_id) id: vec3u";
    for (size, body, flag, told) in [
        (
            256,
            "if (id.x >= arrayLength(&a)) { return; } for (var i = 0u; i < 16000u; i++) { a[id.x] ^= i; }",
            "",
            "went on for too long and were cut off: the rest of them is not judged",
        ),
        (
            64,
            "if (id.x < arrayLength(&b)) { a[b[id.x] * b[id.x]] = 1u; }",
            "--notes",
            "no index into `a` is judged: no rule was found for its length",
        ),
        (
            4096,
            "if (id.x < arrayLength(&a)) { a[id.x] = 1u; }",
            "",
            "a workgroup of 4096 invocations; 2048 at most are run",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let text = format!("{head}@compute @workgroup_size({size}) fn main({id}) {{ {body} }}\n");
        fs::write(folder.path().join("a.wgsl"), &text).unwrap();
        let ran = run_in(folder.path(), &format!("fuzz a.wgsl --lane embedded --samples 16 {flag}"));
        assert!(ran.out.contains(told), "{told}\n{text}\n{}{}", ran.out, ran.err);
    }
}
