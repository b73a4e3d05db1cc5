//! Faults of an executor and of a front end, seen through several lanes: whose fault it is follows from groups.

use engine::suite::run::{FindingKind, Part, Peer, Prepared, Report, Request, cross_check};
use judge::profile::Promises;
use judge::verdict::diagnosis::{CrossCheck, Fault, Stand};
use lanes::{Api, Lane, embedded};

use crate::support::{self, Planted, prepared};

/// A lane: name, executor, front end, whose promises hold, and by how much it is off.
type Plan = (&'static str, &'static str, &'static str, Api, f32);

const STRICT: Api = Api::Binary32;

fn lanes(prepared: &Prepared, plans: &[Plan]) -> Vec<Planted> {
    let one = |&(name, executor, front_end, api, off): &Plan| {
        let lane = Planted::new(embedded::open().unwrap(), prepared).called(name, executor, front_end, api);
        if off == 0.0 { lane } else { lane.with(move |dispatch| dispatch.each(|_, _| true, |x| x + off)) }
    };
    plans.iter().map(one).collect()
}

fn request(prepared: &Prepared, lane: &dyn Lane) -> Request {
    support::request(prepared, Some(256), Promises::of_lane(lane.description()))
}

/// What the lanes say of the first deviation of each lane, in the order of the lanes; none for those without one.
fn cross_checks(suite: &str, plans: &[Plan]) -> Vec<Option<CrossCheck>> {
    let prepared = prepared(suite);
    let lanes = lanes(&prepared, plans);
    let promises: Vec<Promises> = lanes.iter().map(|lane| Promises::of_lane(lane.description())).collect();
    let ran = |lane: &Planted| support::part(&prepared, lane, &request(&prepared, lane)).unwrap();
    let mut parts: Vec<Part> = lanes.iter().map(ran).collect();
    let peers: Vec<Peer<'_>> = lanes.iter().zip(&promises).map(|(lane, promises)| Peer { lane, promises }).collect();
    cross_check(&prepared, &peers, &mut parts);
    let cross_check = |part: Part| {
        let report = part.report();
        let found = report.findings.iter().find(|finding| finding.kind == FindingKind::Deviation)?;
        let cross_check = found.case.as_ref().unwrap().diagnosis.cross_check.clone();
        Some(cross_check.unwrap_or_else(|| panic!("nobody was heard: {found:?}")))
    };
    parts.into_iter().map(cross_check).collect()
}

/// The same fault on every lane that deviates.
#[track_caller]
fn fault(suite: &str, plans: &[Plan]) -> Fault {
    let all: Vec<Option<CrossCheck>> = cross_checks(suite, plans);
    for (cross_check, plan) in all.iter().zip(plans) {
        assert_eq!(cross_check.is_some(), plan.4 != 0.0, "{plan:?}: {all:#?}");
    }
    let mut faults = all.into_iter().flatten().map(|cross_check| cross_check.fault);
    let first = faults.next().unwrap();
    assert!(faults.all(|fault| fault.name() == first.name()));
    first
}

#[test]
fn a_fault_of_an_executor_is_seen_through_two_front_ends() {
    let plans: [Plan; 4] = [
        ("a", "X", "naga", STRICT, 0.01),
        ("b", "X", "glslang", STRICT, 0.01),
        ("c", "Y", "naga", STRICT, 0.0),
        ("d", "Y", "glslang", STRICT, 0.0),
    ];
    let found = fault("morph", &plans);
    let Fault::Executor { executor, through, right } = &found else { panic!("{found}") };
    assert_eq!((executor.as_str(), through.len(), right.as_slice()), ("X", 2, &["Y".to_owned()][..]));
    // The list names the lane that is accused first, then all others with what they say.
    let cross_check = cross_checks("morph", &plans).remove(1).unwrap();
    let said: Vec<(&str, Stand)> = cross_check.witnesses.iter().map(|w| (w.lane, w.stand)).collect();
    assert_eq!(said, [("b", Stand::Wrong), ("a", Stand::Wrong), ("c", Stand::Right), ("d", Stand::Right)]);
    assert!(cross_check.witnesses.iter().all(|witness| witness.word.is_some()));
}

#[test]
fn a_fault_of_a_front_end_is_seen_on_two_executors() {
    let plans: [Plan; 4] = [
        ("a", "X", "naga", STRICT, 0.0),
        ("b", "X", "glslang", STRICT, 0.01),
        ("c", "Y", "naga", STRICT, 0.0),
        ("d", "Y", "glslang", STRICT, 0.01),
    ];
    for suite in ["morph", "hair"] {
        let found = fault(suite, &plans);
        let Fault::Translator { front_end, on, .. } = &found else { panic!("{suite}: {found}") };
        assert_eq!((front_end.as_str(), on.len()), ("glslang", 2));
    }
}

#[test]
fn lanes_of_one_group_are_one_witness() {
    let alone = fault("morph", &[("a", "X", "naga", STRICT, 0.01)]);
    assert_eq!(alone.name(), "one_group");
    let twice = fault("morph", &[("a", "X", "naga", STRICT, 0.01), ("b", "X", "naga", STRICT, 0.01)]);
    assert_eq!(twice, alone);
    assert!(twice.to_string().contains("one witness cannot tell them apart"), "{twice}");
}

#[test]
fn when_all_groups_agree_against_the_meaning_it_is_suspect() {
    let all = |other: f32| -> [Plan; 3] {
        [("a", "X", "naga", STRICT, 0.01), ("b", "Y", "Mesa", STRICT, other), ("c", "X", "Mesa", STRICT, 0.01)]
    };
    let alike = fault("morph", &all(0.01));
    assert_eq!(alike, Fault::Everyone { groups: 3, alike: true });
    assert!(alike.to_string().contains("our own meaning or bound is suspect"), "{alike}");
    assert_eq!(fault("morph", &all(0.02)), Fault::Everyone { groups: 3, alike: false });
}

#[test]
fn a_lane_whose_api_promises_nothing_still_bears_witness() {
    // OpenGL promises nothing for the sine: there the same fault is no deviation, and is seen all the same.
    let plans: [Plan; 3] =
        [("a", "X", "naga", STRICT, 0.01), ("b", "X", "Mesa", Api::OpenGl, 0.01), ("c", "Y", "Mesa", Api::OpenGl, 0.0)];
    let cross_check = cross_checks("sphere", &plans).remove(0).unwrap();
    assert_eq!(cross_check.fault.name(), "executor", "{cross_check:#?}");
    assert_eq!(cross_check.with(Stand::Wrong), ["a/compute", "b/compute"]);
    assert_eq!(cross_check.with(Stand::Right), ["c/compute"]);
}

#[test]
fn what_other_lanes_say_is_written_down_with_a_part() {
    let prepared = prepared("morph");
    let lanes = lanes(&prepared, &[("a", "X", "naga", STRICT, 0.01), ("b", "Y", "naga", STRICT, 0.0)]);
    let promises: Vec<Promises> = lanes.iter().map(|lane| Promises::of_lane(lane.description())).collect();
    let peers: Vec<Peer<'_>> = lanes.iter().zip(&promises).map(|(lane, promises)| Peer { lane, promises }).collect();
    let request = request(&prepared, &lanes[0]);
    let mut parts = [support::part(&prepared, &lanes[0], &request).unwrap()];
    cross_check(&prepared, &peers, &mut parts);
    // What is handed over is read back.
    let text = serde_json::to_string(&parts).unwrap();
    let [part]: [Part; 1] = serde_json::from_str(&text).unwrap();
    let [whole] = parts.map(Part::report);
    let collected = |report: &Report| -> Vec<Option<CrossCheck>> {
        report.findings.iter().filter_map(|f| Some(f.case.as_ref()?.diagnosis.cross_check.clone())).collect()
    };
    let merged = part.report();
    assert_eq!(collected(&merged), collected(&whole));
    assert!(
        collected(&merged).iter().flatten().any(|cross_check| cross_check.fault.name() == "executor"),
        "{:?}",
        collected(&merged)
    );
}
