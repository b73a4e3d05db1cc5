//! A lane that gives other bits for the same inputs: told as such, and not shrunk.

use engine::suite::run::{Finding, FindingKind, Prepared, Report};
use judge::profile::Promises;
use judge::verdict::Blame;
use lanes::{Lane as _, embedded};

use crate::support::{self, Planted, prepared, replaced};

/// A run on the interpreter, of which some dispatches have another first output; with the number of dispatches.
fn report(prepared: &Prepared, change: fn(usize, f32) -> f32) -> (Report, usize) {
    let lane = Planted::new(embedded::open().unwrap(), prepared).with(move |dispatch| {
        let number = dispatch.of_lane;
        dispatch.each(|_, _| true, |x| change(number, x));
    });
    let report = support::report(prepared, &lane, Some(512), Promises::of_lane(lane.description()));
    (report, lane.dispatches())
}

fn of_kind(report: &Report, kind: FindingKind) -> Vec<&Finding> {
    report.findings.iter().filter(|finding| finding.kind == kind).collect()
}

#[test]
fn a_lane_that_repeats_itself_is_not_flaky() {
    let (right, _) = report(&prepared("morph"), |_, x| x);
    assert!(right.findings.is_empty(), "{:?}", right.findings);
    let repeated = right.repeated.unwrap();
    assert_eq!((repeated.samples, repeated.different), (256, 0));
    // What is wrong each time is wrong, and not flaky.
    let (wrong, _) = report(&prepared("morph"), |_, x| x + 0.5);
    assert!(of_kind(&wrong, FindingKind::Flaky).is_empty(), "{:?}", wrong.findings);
    assert!(!of_kind(&wrong, FindingKind::Deviation).is_empty());
}

#[test]
fn outputs_that_change_from_run_to_run_are_reported_and_not_shrunk() {
    // The first dispatch is wrong, and from then on every third.
    let (report, dispatches) = report(&prepared("morph"), |k, x| if k % 3 == 0 { x + 0.5 } else { x });
    let flaky = of_kind(&report, FindingKind::Flaky);
    let reported =
        flaky.iter().find(|f| f.message.contains(" of 5 runs of the same inputs gave other bits than the first"));
    let reported = reported.unwrap_or_else(|| panic!("{:?}", report.findings));
    assert!(reported.message.starts_with("flaky: ") && reported.message.ends_with("the lane is not deterministic"));
    let case = reported.case.as_ref().unwrap();
    assert_eq!((case.rounds, case.tried), (0, 0));
    assert!(case.deviation.as_ref().is_none_or(|deviation| deviation.blame == Blame::Lane));
    assert!(reported.reproduce.as_ref().unwrap().contains(" --case "));
    assert!(of_kind(&report, FindingKind::Deviation).is_empty(), "{:?}", report.findings);
    assert!(dispatches < 100, "{dispatches} dispatches: something was shrunk");
    assert_eq!(report.verdicts.shader_deviated, 0);
}

#[test]
fn bits_that_change_within_the_bounds_are_found_as_well() {
    // The last bit: every verdict stays as it is.
    let (report, _) = report(&prepared("sphere"), |k, x| f32::from_bits(x.to_bits() ^ (k as u32 & 1)));
    let flaky = of_kind(&report, FindingKind::Flaky);
    let again = " of 256 samples gave other bits when the same batch ran again";
    assert!(flaky.iter().any(|finding| finding.message.contains(again)), "{:?}", report.findings);
    assert_eq!(report.repeated.unwrap().different, 256);
}

#[test]
fn a_wrong_shader_is_found_on_a_flaky_lane_too() {
    let prepared = replaced("sphere", "cos(ph)", "cos(th)");
    let (report, _) = report(&prepared, |k, x| if k % 2 == 0 { x } else { x + 1.0 });
    assert!(!of_kind(&report, FindingKind::Flaky).is_empty(), "{:?}", report.findings);
    let shader = of_kind(&report, FindingKind::Deviation);
    let blamed = |f: &&Finding| f.case.as_ref().and_then(|c| c.deviation.as_ref()).map(|d| d.blame);
    assert!(shader.iter().any(|finding| blamed(finding) == Some(Blame::Shader)), "{:?}", report.findings);
}
