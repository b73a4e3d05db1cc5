//! `fuzz --prove`: what is called verified is shown by no dispatch to be wrong, and kernels without a fault have none.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::binary::{root, run_in};

fn proved(path: &str, status: i32) -> Value {
    run_in(root(), &format!("fuzz {path} --prove --format json")).expect(status).json()
}

/// Each kernel with its memories and their verdicts.
fn verdicts(report: &Value) -> BTreeMap<String, Vec<(String, String)>> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let file = |kernel: &Value| text(&kernel["at"]).rsplit('/').next().unwrap().split(':').next().unwrap().to_owned();
    let of = |kernel: &Value| {
        let memories = kernel["memories"].as_array().unwrap();
        memories.iter().map(|own| (text(&own["name"]), text(&own["verdict"]))).collect()
    };
    report["kernels"].as_array().unwrap().iter().map(|kernel| (file(kernel), of(kernel))).collect()
}

fn all_are(verdicts: &[(String, String)], wanted: &str) -> bool {
    verdicts.iter().all(|(_, own)| own == wanted)
}

#[test]
fn planted_faults_are_shown_and_their_twins_are_verified() {
    let (right, wrong) = (proved("fixtures/proofs/right", 0), proved("fixtures/proofs/wrong", 1));
    for (name, own) in verdicts(&right) {
        assert!(all_are(&own, "verified"), "{name}: {own:?}");
    }
    for (name, own) in verdicts(&wrong) {
        let idle = name.starts_with("idle");
        assert_eq!(own.iter().any(|(_, verdict)| verdict == "fault"), !idle, "{name}: {own:?}");
    }
    for kernel in right["kernels"].as_array().unwrap().iter().chain(wrong["kernels"].as_array().unwrap()) {
        let at = kernel["at"].as_str().unwrap();
        let idle = kernel["idle_barriers"].as_array().unwrap().len();
        assert_eq!(idle, usize::from(at.contains("wrong/idle")), "{at}");
    }
}

#[test]
fn no_dispatch_shows_a_fault_of_what_is_verified() {
    let mut share = Vec::new();
    // The texts in the folder `reference` are parts of shaders.
    let shipped: Vec<String> = std::fs::read_dir(root().join("shaders/kernels"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".comp") || name.ends_with(".wgsl"))
        .map(|name| format!("shaders/kernels/{name}"))
        .collect();
    for (folder, status) in [(&shipped.join(" ")[..], 0), ("fixtures/kernels/right", 0), ("fixtures/kernels/wrong", 1)]
    {
        let report = proved(folder, status);
        let (mut decided, mut count) = (0, 0);
        for kernel in report["kernels"].as_array().unwrap() {
            for own in kernel["memories"].as_array().unwrap() {
                assert_eq!(own["contradicted"], false, "{}: {own}", kernel["at"]);
                count += 1;
                decided += usize::from(own["verdict"] != "not_decided");
                assert!(status == 1 || own["verdict"] != "fault", "{}: {own}", kernel["at"]);
            }
        }
        share.push((folder.to_owned(), decided, count));
    }
    for (folder, decided, count) in &share {
        // What is decided today; more is welcome.
        assert!(decided * 100 >= count * 50, "{folder}: {decided} of {count}");
    }
}

#[test]
fn kernels_with_a_race_or_a_stray_index_are_not_verified() {
    let report = proved("fixtures/kernels/wrong", 1);
    let all = verdicts(&report);
    for (name, kind, ..) in crate::kernels::WRONG {
        if matches!(kind, "race" | "index") {
            assert!(!all_are(&all[name], "verified"), "{name}: {:?}", all[name]);
        }
    }
}

#[test]
fn what_is_not_linear_is_not_decided_and_nothing_is_lost() {
    let report = proved("fixtures/kernels/right/histogram.wgsl", 0);
    let reasons: Vec<&str> = report["kernels"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|kernel| kernel["memories"].as_array().unwrap())
        .filter_map(|own| own["message"].as_str())
        .collect();
    assert!(!reasons.is_empty() && reasons.iter().all(|why| why.contains("index")), "{reasons:?}");
    let text = run_in(root(), "fuzz fixtures/proofs/wrong/race.wgsl --prove").expect(1);
    assert!(text.out.contains("fault: race on `result[0]`"), "{}", text.out);
}
