//! Warnings of surveys: a lane that is worse than its device was, and bounds that tell nothing.

use std::sync::Arc;

use base::text::SourceFile;
use engine::suite::run::{DEFAULT_SEED, Entry, FindingKind, Outcome, Status, Summary};
use judge::profile::{Profile, Promises, by_name, parse};
use lanes::{Lane, Stage};
use report::check::{finding, json, line, totals};

use super::lanes::{Fault, faulty};
use crate::support::{self, Dispatch, prepared};

const SAMPLES: u64 = 2048;

/// A run of one suite in the compute stage, without its relations, of which other tests tell.
fn ran(suite: &str, fault: Fault, measured: Option<Arc<Profile>>) -> Summary {
    let mut prepared = prepared(suite);
    let lane = faulty(&prepared, fault, SAMPLES as usize);
    prepared.relations.clear();
    let promises = Promises { measured, ..Promises::of_api(lane.description().api) };
    let report = support::report(&prepared, &lane, Some(SAMPLES), promises);
    let entry = Entry {
        suite: suite.to_owned(),
        shader: report.shader.clone(),
        on: Some(("vulkan", Stage::Compute)),
        outcome: Outcome::Ran(Box::new(report)),
    };
    Summary { seed: DEFAULT_SEED, entries: vec![entry], ..Summary::default() }
}

/// The kinds of all findings.
fn kinds(summary: &Summary) -> Vec<FindingKind> {
    let Outcome::Ran(report) = &summary.entries[0].outcome else { panic!("it ran") };
    report.findings.iter().map(|finding| finding.kind).collect()
}

/// The measurement of the device of these tests.
fn own_profile() -> Option<Arc<Profile>> {
    let profile = Promises::of_lane(faulty(&prepared("sphere"), |_| {}, 1).description()).measured;
    assert!(profile.is_some(), "these tests need a device that was measured");
    profile
}

/// A profile that is like the text of Vulkan, but for one line.
fn profile(line: &str) -> Option<Arc<Profile>> {
    let text = format!("name = \"test\"\nrevision = \"1\"\nextends = \"vulkan-1.4\"\n{line}\n");
    let read = parse(&SourceFile::new("test.toml", text), &|name| by_name(name).cloned());
    Some(Arc::new(read.unwrap_or_else(|error| panic!("{error}"))))
}

/// Three times the largest bound that the device has under these inputs, relative to the point.
fn worse(b: &mut Dispatch<'_>) {
    for i in 0..b.count {
        let record = b.record(i);
        let size = record[1..5].iter().fold(0.0_f32, |size, &w| size.max(f32::from_bits(w).abs()));
        record[1] = (f32::from_bits(record[1]) + 1e-5 * size).to_bits();
    }
}

#[test]
fn a_lane_that_is_worse_than_it_was_measured_is_warned_of() {
    let summary = ran("sphere", worse, own_profile());
    assert_eq!(kinds(&summary), [FindingKind::Quality]);
    assert_eq!(summary.status(), Status::Pass);
    let entry = &summary.entries[0];
    let Outcome::Ran(report) = &entry.outcome else { panic!("it ran") };
    assert!(report.failing.is_empty(), "a warning saves no case");
    assert!(line(entry, false).starts_with("ok "), "{}", line(entry, false));
    assert_eq!(finding(&summary.entries, 0, false), "");
    let warning = "warning: sphere on vulkan/compute: outside measured, inside promise: `gl_Position.x` is off by ";
    assert_eq!(totals(&summary, false).matches(warning).count(), 1, "{}", totals(&summary, false));
    let json: serde_json::Value = serde_json::from_str(&json(&summary)).unwrap();
    let suite = &json["suites"][0];
    assert_eq!((&json["status"], &suite["findings"][0]["severity"]), (&"pass".into(), &"warning".into()));
    assert_eq!(suite["findings"][0]["kind"], "quality");
    let beyond = &suite["survey"]["beyond_measured"];
    assert_eq!(beyond["samples"], report.findings[0].count);
    assert!(report.findings[0].count > SAMPLES / 2, "{}", report.findings[0].count);
    assert_eq!(beyond["worst"]["component"], "gl_Position.x");
    let worst = &beyond["worst"];
    let figure = |key: &str| worst[key].as_f64().unwrap();
    assert!(figure("ratio") > 3.0 && figure("error") > 3.0 * figure("bound"), "{worst}");
}

#[test]
fn a_lane_beyond_its_promise_is_an_error_and_no_warning() {
    let far = |b: &mut Dispatch<'_>| (0..b.count).for_each(|i| b.record(i)[1] ^= 0x8000_0000);
    let summary = ran("morph", far, own_profile());
    assert_eq!(summary.status(), Status::Fail);
    let kinds = kinds(&summary);
    assert!(kinds.contains(&FindingKind::Deviation) && !kinds.contains(&FindingKind::Quality), "{kinds:?}");
}

#[test]
fn a_device_is_as_it_was_measured() {
    for suite in engine::suite::shipped() {
        let summary = ran(suite.name, |_| {}, own_profile());
        assert_eq!(kinds(&summary), [], "{}: {}", suite.name, totals(&summary, false));
        let Outcome::Ran(report) = &summary.entries[0].outcome else { panic!("it ran") };
        let survey = report.survey.as_ref().unwrap();
        // Cases are whole, and may not fill the last of the samples.
        assert!(survey.invocations > SAMPLES - 64, "{}: {}", suite.name, survey.invocations);
        assert_eq!((survey.beyond, &survey.worst_beyond), (0, &None));
        // A profile without bounds would find nothing either.
        let words = survey.tightest().words;
        assert!(words > SAMPLES / 2, "{}: {words} words have a bound", suite.name);
        assert_eq!(survey.tightest().profile, own_profile().unwrap().name);
    }
}

#[test]
fn bounds_that_allow_anything_are_warned_of() {
    for (allowed, rings) in [("abs(1)", true), ("ulp(3)", false)] {
        let measured = profile(&format!("[operations]\nsqrt = \"{allowed}\""));
        let summary = ran("segment_distance", |_| {}, measured);
        let wanted: &[FindingKind] = if rings { &[FindingKind::VacuousBound] } else { &[] };
        assert_eq!(kinds(&summary), wanted, "{allowed}: {}", totals(&summary, false));
        assert_eq!(summary.status(), Status::Pass);
        let warning = "warning: segment_distance on vulkan/compute: bounds by `test` are too wide to test much: ";
        assert_eq!(totals(&summary, false).contains(warning), rings);
    }
}

#[test]
fn a_measured_profile_makes_bounds_tight() {
    let survey = |summary: &Summary| match &summary.entries[0].outcome {
        Outcome::Ran(report) => report.survey.clone().unwrap(),
        other => panic!("{other:?}"),
    };
    let measured = survey(&ran("sphere", |_| {}, own_profile()));
    let promised = survey(&ran("sphere", |_| {}, None));
    assert_eq!(promised.measured, None);
    assert_eq!(promised.promise, measured.promise);
    let tight = measured.tightest().median_over_largest().unwrap();
    let wide = promised.tightest().median_over_largest().unwrap();
    assert!(tight < 5.0 && wide > 100.0, "{tight} {wide}");
    assert!(measured.tightest().words > promised.tightest().words, "nothing is promised for sin beyond π");
}
