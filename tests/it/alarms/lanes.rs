//! Faults of a device, planted between the device and what is accepted from it. A shader cannot have
//! them: a stale buffer, a record that was never written, a value that is wrong once.

use engine::suite::run::{Finding, FindingKind, Prepared, Report, run};
use judge::profile::Promises;
use judge::verdict::Blame;
use lanes::{Lane, LaneError, Stage, embedded, vulkan};

use crate::support::{Dispatch, Planted, prepared, request};

pub(super) type Fault = fn(&mut Dispatch<'_>);

/// Runs a shipped suite as [`reports_of`] does.
fn reports(suite: &str, fault: Fault) -> Vec<Result<Report, LaneError>> {
    reports_of(&prepared(suite), fault)
}

/// The Vulkan lane with a fault, in dispatches of at most `capacity` invocations.
pub(super) fn faulty(prepared: &Prepared, fault: Fault, capacity: usize) -> Planted {
    Planted::new(device(), prepared).with(fault).in_batches_of(capacity)
}

fn device() -> Box<dyn Lane> {
    vulkan::open().unwrap_or_else(|missing| panic!("these tests need a Vulkan driver: {missing}"))
}

/// Runs a suite in the stages that apply, on dispatches of at most 128 invocations.
pub(super) fn reports_of(prepared: &Prepared, fault: Fault) -> Vec<Result<Report, LaneError>> {
    reports_on(device(), prepared, fault)
}

/// The same on another lane.
fn reports_on(lane: Box<dyn Lane>, prepared: &Prepared, fault: Fault) -> Vec<Result<Report, LaneError>> {
    let lane = Planted::new(lane, prepared).with(fault).in_batches_of(128);
    let request = request(prepared, Some(512), Promises::of_lane(lane.description()));
    let vertex = prepared.vertex.is_some() && lane.description().stages.contains(&Stage::Vertex);
    let stages = if vertex { &[Stage::Compute, Stage::Vertex][..] } else { &[Stage::Compute] };
    stages.iter().map(|&stage| run(prepared, &lane, stage, &request, &mut |_| {})).collect()
}

/// The run fails in each stage, with a finding of this kind that holds `said`.
#[track_caller]
fn rings(suite: &str, fault: Fault, kind: FindingKind, said: &str) {
    ring(reports(suite, fault), kind, said);
}

#[track_caller]
fn ring(reports: Vec<Result<Report, LaneError>>, kind: FindingKind, said: &str) {
    assert!(!reports.is_empty(), "no stage ran");
    for report in reports {
        let report = report.unwrap();
        let messages: Vec<String> = report.findings.iter().map(|f| format!("{:?}: {}", f.kind, f.message)).collect();
        assert!(report.findings.iter().any(|f| f.kind == kind && f.message.contains(said)), "{messages:#?}");
        // The shader is right, and nothing that a lane does makes it wrong.
        assert_eq!(report.verdicts.shader_deviated, 0, "{messages:#?}");
        let blamed = |f: &Finding| f.case.as_ref().and_then(|c| c.deviation.as_ref()).map(|d| d.blame);
        assert!(report.findings.iter().filter_map(blamed).all(|blame| blame == Blame::Lane), "{messages:#?}");
    }
}

/// The lane gives no outputs at all.
#[track_caller]
fn refused(fault: Fault) {
    for report in reports("sphere", fault) {
        let error = report.map(|r| r.findings).unwrap_err();
        assert!(matches!(error, LaneError::NotWritten { .. }), "{error}");
        assert!(error.to_string().contains("was not written by this dispatch"), "{error}");
    }
}

/// Moves a binary32 word by one part in ten thousand of the size of a sphere.
fn nudge(word: &mut u32) {
    *word = (f32::from_bits(*word) + 1e-4).to_bits();
}

#[test]
fn a_lane_without_a_fault_passes() {
    for suite in ["sphere", "hair", "hermite"] {
        for report in reports(suite, |_| {}) {
            let report = report.unwrap();
            assert!(report.findings.is_empty(), "{:?}", report.findings);
            assert!(report.judged() >= 400);
        }
    }
}

#[test]
fn a_wrong_last_sample_of_a_batch_is_found() {
    // In every dispatch, whatever its size.
    let last = |b: &mut Dispatch<'_>| {
        let last = b.count - 1;
        nudge(&mut b.record(last)[1]);
    };
    // No operation of this shader may be off by more than a rounding; sine and cosine may.
    rings("morph", last, FindingKind::Deviation, "the lane deviates from the shader: `gl_Position.x` is ");
}

#[test]
fn what_is_not_promised_never_agrees() {
    // Vulkan promises nothing for the sine beyond π: any value is allowed there, and none is right.
    let far = |b: &mut Dispatch<'_>| (0..b.count).for_each(|i| b.record(i)[1] = 32_f32.to_bits());
    for report in reports("sphere", far) {
        let verdicts = report.unwrap().verdicts;
        let [_, no_promise, ..] = verdicts.undetermined;
        assert_eq!(verdicts.agreed, 0);
        assert!(verdicts.deviated > 128 && no_promise > 128, "{verdicts:?}");
    }
}

#[test]
fn a_wrong_last_vertex_is_found() {
    let last = |b: &mut Dispatch<'_>| {
        for i in 0..b.count {
            let last = b.layout.words() - b.layout.vertex_words() + 1;
            nudge(&mut b.record(i)[last]);
        }
    };
    rings("hair", last, FindingKind::Deviation, "of vertex 4 is ");
}

#[test]
fn a_wrong_w_is_found() {
    let w = |b: &mut Dispatch<'_>| (0..b.count).for_each(|i| nudge(&mut b.record(i)[4]));
    rings("sphere", w, FindingKind::Deviation, "`gl_Position.w` is ");
}

#[test]
fn nan_is_found() {
    let nan = |b: &mut Dispatch<'_>| (0..b.count).step_by(7).for_each(|i| b.record(i)[2] = f32::NAN.to_bits());
    rings("sphere", nan, FindingKind::Deviation, "`gl_Position.y` is nan");
    let vertex = |b: &mut Dispatch<'_>| (0..b.count).for_each(|i| b.record(i)[4] = f32::NAN.to_bits());
    rings("hair", vertex, FindingKind::Deviation, "`gl_Position.x` of vertex 0 is nan");
}

#[test]
fn a_wrong_zero_is_found() {
    // A distance of 0: no bound is small beside it, and what comes in its place is wrong all the same.
    let faults: [(Fault, &str); 3] = [
        (|b| on_zeros(b, 5.0), "is 5.0 (0x40a00000), expected 0.0"),
        (|b| on_zeros(b, 1e-3), "is 0.001 (0x3a83126f), expected 0.0"),
        (|b| on_zeros(b, f32::NAN), "is nan"),
    ];
    let distance = prepared("segment_distance");
    for (fault, said) in faults {
        // The root of what may be 0 is promised nothing by Vulkan, and all by strict binary32.
        let strict = embedded::open().unwrap_or_else(|missing| panic!("{missing}"));
        ring(reports_on(strict, &distance, fault), FindingKind::Deviation, said);
        // Relations look at ends that are 0.
        rings("hermite", fault, FindingKind::Relation, "the relation `hermite_tangents` does not hold");
    }
}

/// Puts `value` in place of the zeros of a function with one number as result.
fn on_zeros(b: &mut Dispatch<'_>, value: f32) {
    for i in 0..b.count {
        let word = &mut b.record(i)[1];
        if *word << 1 == 0 {
            *word = value.to_bits();
        }
    }
}

#[test]
fn an_output_that_is_not_written_is_found() {
    let unwritten = |b: &mut Dispatch<'_>| {
        let sentinel = b.marks.sentinel;
        (0..b.count).for_each(|i| b.record(i)[3] = sentinel);
    };
    rings("sphere", unwritten, FindingKind::Deviation, "`gl_Position.z` is not written");
}

#[test]
fn a_record_that_is_not_written_is_refused() {
    refused(|b| {
        let (last, sentinel) = (b.count - 1, b.marks.sentinel);
        b.record(last).fill(sentinel);
    });
}

#[test]
fn records_in_another_order_are_refused() {
    refused(|b| {
        let size = b.layout.words();
        b.words.rotate_left(size);
    });
}

#[test]
fn a_stale_buffer_is_refused() {
    refused(|b| {
        if b.before.len() >= b.words.len() {
            b.words.clone_from(&b.before);
        }
    });
}

#[test]
fn a_stale_buffer_that_bears_the_new_canary_is_found() {
    let stale = |b: &mut Dispatch<'_>| {
        let (size, marks) = (b.layout.words(), b.marks);
        if b.before.len() >= b.words.len() {
            let len = b.words.len();
            b.words.copy_from_slice(&b.before[..len]);
            for i in 0..b.count {
                b.words[i * size] = marks.canary ^ i as u32;
            }
        }
    };
    // What is left over from a dispatch before is no matter of the inputs, and comes back each time.
    rings("sphere", stale, FindingKind::Deviation, "the lane deviates from the shader: ");
}

#[test]
fn a_fault_that_does_not_come_back_is_found_all_the_same() {
    let once = |b: &mut Dispatch<'_>| {
        if b.number == 2 {
            b.record(40)[1] = 0x4200_0000;
        }
    };
    rings("morph", once, FindingKind::Flaky, "5 of 5 runs of the same inputs gave other bits than the first");
}

#[test]
fn a_relation_that_fails_alone_is_found() {
    // Wrong only where each invocation has uniforms of its own, which is how relations and samples at edges run.
    let uniforms = |b: &mut Dispatch<'_>| {
        if b.batch.per_case == 1 {
            (0..b.count).step_by(2).for_each(|i| nudge(&mut b.record(i)[1]));
        }
    };
    for report in reports("morph", uniforms) {
        let report = report.unwrap();
        assert_eq!(report.verdicts.agreed, 512, "the samples of the run share their uniforms");
        let ends = report.findings.iter().find(|f| f.message.contains("`morph_ends` does not hold"));
        let case = ends.and_then(|f| f.case.as_ref()).unwrap();
        let matrix = case.inputs.iter().find(|i| i.name == "mat4 mc").unwrap();
        assert!(matrix.bits.iter().enumerate().all(|(k, &w)| w == if k % 5 == 0 { 0x3f80_0000 } else { 0 }));
    }
}

#[test]
fn a_relation_that_fails_and_then_holds_is_found() {
    let large = |b: &mut Dispatch<'_>| {
        if b.batch.per_case == 1 && b.count == 128 {
            b.record(100)[1] = 0x4200_0000;
        }
    };
    // It holds in other places, and in this one it fails each time.
    rings("morph", large, FindingKind::Deviation, "the lane deviates from the shader: `gl_Position.x` is 32.0");
}
