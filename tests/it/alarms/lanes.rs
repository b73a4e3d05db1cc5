//! Faults of a device, planted between the device and what is accepted from it. A shader cannot have
//! them: a stale buffer, a record that was never written, a value that is wrong once.

use std::cell::RefCell;
use std::rc::Rc;

use shadercheck::bound::profile::Rulings;
use shadercheck::lane::{Actual, Description, Lane, LaneError, Marks, Runner, Stage, embedded, vulkan};
use shadercheck::program::{Kernel, OutputLayout};
use shadercheck::suite::run::{DEFAULT_SEED, Finding, FindingKind, Prepared, Report, Request, prepare, run};
use shadercheck::suite::{find, parse};
use shadercheck::text::SourceFile;
use shadercheck::value::Batch;
use shadercheck::verdict::Blame;

/// What one dispatch left in the output buffer.
pub(super) struct Buffer {
    /// Number of this dispatch of the runner, from 0.
    dispatch: usize,
    /// Invocations.
    pub(super) count: usize,
    /// Invocations that share uniforms.
    per_case: usize,
    layout: OutputLayout,
    words: Vec<u32>,
    marks: Marks,
    /// The words of the dispatch before.
    before: Vec<u32>,
}

impl Buffer {
    /// Record of an invocation.
    pub(super) fn record(&mut self, invocation: usize) -> &mut [u32] {
        let size = self.layout.words();
        &mut self.words[invocation * size..][..size]
    }
}

pub(super) type Fault = fn(&mut Buffer);

/// A lane with a fault.
struct Faulty {
    lane: Box<dyn Lane>,
    fault: Fault,
    capacity: usize,
    /// Outputs of the suite's shader. Kernels with other outputs, which look into a failure, have no
    /// fault: it would not be the one that was planted.
    layout: OutputLayout,
}

struct FaultyRunner {
    runner: Box<dyn Runner>,
    fault: Fault,
    capacity: usize,
    layout: OutputLayout,
    dispatch: Rc<RefCell<usize>>,
    before: Vec<u32>,
}

impl Lane for Faulty {
    fn description(&self) -> &Description {
        self.lane.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        if kernel.output != self.layout {
            return self.lane.prepare(kernel, capacity);
        }
        Ok(Box::new(FaultyRunner {
            runner: self.lane.prepare(kernel, capacity)?,
            fault: self.fault,
            capacity: self.capacity,
            layout: kernel.output.clone(),
            dispatch: Rc::default(),
            before: Vec::new(),
        }))
    }
}

impl Runner for FaultyRunner {
    fn capacity(&self) -> usize {
        self.runner.capacity().min(self.capacity)
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let actual = self.runner.run(batch)?;
        let marks = Marks::random();
        let words = raw(&actual, &self.layout, marks);
        let mut buffer = Buffer {
            dispatch: self.dispatch.replace_with(|n| *n + 1),
            count: actual.count(),
            per_case: batch.per_case,
            layout: self.layout.clone(),
            before: std::mem::replace(&mut self.before, words.clone()),
            words,
            marks,
        };
        (self.fault)(&mut buffer);
        Actual::accept(&self.layout, buffer.words, buffer.count, marks)
    }
}

/// The output buffer from which `actual` was read, with other marks.
pub(crate) fn raw(actual: &Actual, layout: &OutputLayout, marks: Marks) -> Vec<u32> {
    let mut words = Vec::with_capacity(actual.count() * layout.words());
    for invocation in 0..actual.count() {
        words.push(marks.canary ^ invocation as u32);
        if layout.max_vertices.is_some() {
            words.extend([actual.emitted(invocation), actual.ended_strips(invocation)]);
        }
        for vertex in 0..actual.stored(invocation) {
            if layout.max_vertices.is_some() {
                words.push(actual.strip(invocation, vertex));
            }
            let value = |&word: &u32| if actual.is_unwritten(word) { marks.sentinel } else { word };
            words.extend(actual.vertex(invocation, vertex).iter().map(value));
        }
        words.resize((invocation + 1) * layout.words(), marks.sentinel);
    }
    words
}

/// A shipped suite, made ready.
pub(crate) fn prepared(suite: &str) -> Prepared {
    let shipped = find(suite).unwrap();
    let suite = parse(&SourceFile::new(shipped.path, shipped.toml)).unwrap();
    prepare(&suite, &SourceFile::new(shipped.shader_name, shipped.shader_text)).unwrap()
}

/// Runs a shipped suite as [`reports_of`] does.
fn reports(suite: &str, fault: Fault) -> Vec<Result<Report, LaneError>> {
    reports_of(&prepared(suite), fault)
}

/// The Vulkan lane with a fault, in dispatches of at most `capacity` invocations.
pub(super) fn faulty(prepared: &Prepared, fault: Fault, capacity: usize) -> impl Lane + use<> {
    let lane = vulkan::open().unwrap_or_else(|missing| panic!("these tests need a Vulkan driver: {missing}"));
    Faulty { lane, fault, capacity, layout: prepared.program.output_layout() }
}

/// Runs a suite in the stages that apply, on dispatches of at most 128 invocations.
pub(super) fn reports_of(prepared: &Prepared, fault: Fault) -> Vec<Result<Report, LaneError>> {
    let lane = vulkan::open().unwrap_or_else(|missing| panic!("these tests need a Vulkan driver: {missing}"));
    reports_on(lane, prepared, fault)
}

/// The same on another lane.
fn reports_on(lane: Box<dyn Lane>, prepared: &Prepared, fault: Fault) -> Vec<Result<Report, LaneError>> {
    let lane = Faulty { lane, fault, capacity: 128, layout: prepared.program.output_layout() };
    let request = Request {
        samples: Some(512),
        seed: DEFAULT_SEED,
        quick: true,
        replay: Vec::new(),
        replay_only: false,
        rulings: Rulings::of_lane(lane.description()),
        arguments: prepared.suite.name.clone(),
    };
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
    let last = |b: &mut Buffer| {
        let last = b.count - 1;
        nudge(&mut b.record(last)[1]);
    };
    // No operation of this shader may be off by more than a rounding; sine and cosine may.
    rings("morph", last, FindingKind::Deviation, "the lane deviates from the shader: `gl_Position.x` is ");
}

#[test]
fn what_is_not_promised_never_agrees() {
    // Vulkan promises nothing for the sine beyond π: any value is allowed there, and none is right.
    let far = |b: &mut Buffer| (0..b.count).for_each(|i| b.record(i)[1] = 32_f32.to_bits());
    for report in reports("sphere", far) {
        let verdicts = report.unwrap().verdicts;
        let [_, no_promise, ..] = verdicts.undetermined;
        assert_eq!(verdicts.agreed, 0);
        assert!(verdicts.deviated > 128 && no_promise > 128, "{verdicts:?}");
    }
}

#[test]
fn a_wrong_last_vertex_is_found() {
    let last = |b: &mut Buffer| {
        for i in 0..b.count {
            let last = b.layout.words() - b.layout.vertex_words() + 1;
            nudge(&mut b.record(i)[last]);
        }
    };
    rings("hair", last, FindingKind::Deviation, "of vertex 4 is ");
}

#[test]
fn a_wrong_w_is_found() {
    let w = |b: &mut Buffer| (0..b.count).for_each(|i| nudge(&mut b.record(i)[4]));
    rings("sphere", w, FindingKind::Deviation, "`gl_Position.w` is ");
}

#[test]
fn nan_is_found() {
    let nan = |b: &mut Buffer| (0..b.count).step_by(7).for_each(|i| b.record(i)[2] = f32::NAN.to_bits());
    rings("sphere", nan, FindingKind::Deviation, "`gl_Position.y` is nan");
    let vertex = |b: &mut Buffer| (0..b.count).for_each(|i| b.record(i)[4] = f32::NAN.to_bits());
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
fn on_zeros(b: &mut Buffer, value: f32) {
    for i in 0..b.count {
        let word = &mut b.record(i)[1];
        if *word << 1 == 0 {
            *word = value.to_bits();
        }
    }
}

#[test]
fn an_output_that_is_not_written_is_found() {
    let unwritten = |b: &mut Buffer| {
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
    let stale = |b: &mut Buffer| {
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
    let once = |b: &mut Buffer| {
        if b.dispatch == 2 {
            b.record(40)[1] = 0x4200_0000;
        }
    };
    rings("morph", once, FindingKind::Flaky, "5 of 5 runs of the same inputs gave other bits than the first");
}

#[test]
fn a_relation_that_fails_alone_is_found() {
    // Wrong only where each invocation has uniforms of its own, which is how relations and samples at edges run.
    let uniforms = |b: &mut Buffer| {
        if b.per_case == 1 {
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
    let large = |b: &mut Buffer| {
        if b.per_case == 1 && b.count == 128 {
            b.record(100)[1] = 0x4200_0000;
        }
    };
    // It holds in other places, and in this one it fails each time.
    rings("morph", large, FindingKind::Deviation, "the lane deviates from the shader: `gl_Position.x` is 32.0");
}
