//! One fault of each kind, and who is blamed for it.

use std::sync::Arc;

use engine::adversary::{Adversary, Fault, Strategy};
use judge::formula::{Args, Formula, Kind, Param, Rule};
use judge::profile::{Op, Profile, Promises, by_name};

use base::text::SourceFile;
use base::value::{Batch, Field, Record, Shape};
use engine::suite::Suite;
use engine::suite::run::{Case, FindingKind, Prepared, Report};
use judge::verdict::diagnosis::{self, Origin, Suspected};
use judge::verdict::{
    BatchVerdict, Blame, Deviation, JudgeContext, Judges, Literals, Oracle, Reason, Reference, Verdict, dependences,
    judge_batch, judge_each,
};
use lanes::{Actual, Api, Description, Lane, LaneError, Runner, Stage, embedded};
use program::interp::{Dependence, Laws};
use program::lower::Target;
use program::{Kernel, Program};
use property::{Sample, Sampler};

use crate::support::{changed, replaced, report};

/// A shipped suite with another text in the place of a part of its shader, and every literal as it is written.
fn exactly(suite: &str, from: &str, to: &str) -> Prepared {
    changed(suite, |suite| Suite { literals: Literals::Exact, ..suite }, |text| text.replacen(from, to, 1))
}

fn check(prepared: &Prepared, lane: &dyn Lane, promises: Promises) -> Report {
    report(prepared, lane, Some(2048), promises)
}

/// A promise alone, without a conformance suite and without a measurement.
fn text(profile: &'static Profile) -> Promises {
    Promises { text: profile, conformance: None, measured: None }
}

fn vulkan() -> &'static Profile {
    by_name("vulkan-1.4").unwrap()
}

/// The first deviation of a report, with what is known about it.
#[track_caller]
fn deviation(report: &Report) -> (&Deviation, &Case) {
    let finding = report.findings.iter().find(|f| f.kind == FindingKind::Deviation);
    let finding = finding.unwrap_or_else(|| panic!("nothing deviates: {:?}", report.findings));
    let case = finding.case.as_ref().unwrap();
    (case.deviation.as_ref().unwrap(), case)
}

#[test]
fn a_typo_in_a_formula_is_the_shaders_fault() {
    let lane = embedded::open().unwrap();
    let wrong = replaced("sphere", "cos(ph)", "cos(th)");
    let report = check(&wrong, &*lane, Promises::of_api(Api::Binary32));
    let (deviation, case) = deviation(&report);
    assert_eq!(deviation.blame, Blame::Shader);
    assert!(case.diagnosis.literals.is_empty() && case.diagnosis.origin.is_none());
    assert_eq!(report.verdicts.shader_deviated, report.verdicts.deviated);
}

#[test]
fn short_digits_are_named_with_what_they_stand_for() {
    let lane = embedded::open().unwrap();
    let short = exactly("sphere", "6.28318530717958648", "6.283185");
    let report = check(&short, &*lane, Promises::of_api(Api::Binary32));
    let (deviation, case) = deviation(&report);
    assert_eq!(deviation.blame, Blame::Shader);
    let said: Vec<String> = case.diagnosis.literals.iter().map(ToString::to_string).collect();
    assert_eq!(said, ["`6.283185` (sphere.vert:11:14) stands for 2π, off by 3.1e-7"]);
    // Its binary32 alone, as near to 2π as binary32 comes, is no fault.
    let rounded = replaced("sphere", "6.28318530717958648", "6.283185307179586476925");
    let report = check(&rounded, &*lane, Promises::of_api(Api::Binary32));
    assert_eq!((report.verdicts.deviated, report.findings.len()), (0, 0), "{:?}", report.findings);
}

#[test]
fn a_built_in_off_by_twice_its_promise_is_named() {
    let right = replaced("sphere", "", "");
    let device = Adversary::lane(vulkan(), Stage::Compute, Strategy::Extreme, 1, false);
    let report = check(&right, &device, text(vulkan()));
    assert_eq!(report.verdicts.deviated, 0, "{:?}", report.findings);
    let faulty = device.with_fault(Fault { op: Op::Sin, factor: 2.0 });
    let report = check(&right, &faulty, text(vulkan()));
    let (deviation, case) = deviation(&report);
    assert_eq!(deviation.blame, Blame::Lane);
    let Some(Origin::BuiltIn { op, factor, place, .. }) = &case.diagnosis.origin else {
        panic!("{:?}", case.diagnosis)
    };
    assert_eq!(*op, Op::Sin);
    assert!((1.5..2.5).contains(factor), "{factor}");
    assert!(place.as_ref().unwrap().text.starts_with("sin("), "{place:?}");
    let divergence = case.diagnosis.divergence.as_ref().unwrap();
    assert!(divergence.place.text.starts_with("sin(") && !divergence.path, "{divergence:?}");
}

/// A lane that sees one bone less than there is.
struct Shortened(Box<dyn Lane>);

struct ShortenedRunner(Box<dyn Runner>);

impl Lane for Shortened {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        Ok(Box::new(ShortenedRunner(self.0.prepare(kernel, capacity)?)))
    }
}

impl Runner for ShortenedRunner {
    fn capacity(&self) -> usize {
        self.0.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let mut batch = batch.clone();
        if let Some(index) = batch.case_record.index_of("numberOfBones") {
            let (at, words) = (batch.case_record.range(index).start, batch.case_record.words());
            for case in batch.cases.chunks_exact_mut(words) {
                case[at] = case[at].saturating_sub(1);
            }
        }
        self.0.run(&batch)
    }
}

#[test]
fn a_lane_that_drops_the_last_bone_compiles_wrong() {
    let right = replaced("skinning", "", "");
    let report = check(&right, &Shortened(embedded::open().unwrap()), text(vulkan()));
    let (deviation, case) = deviation(&report);
    assert_eq!(deviation.blame, Blame::Lane);
    assert_eq!(case.diagnosis.origin, Some(Origin::Miscompilation));
    // The device leaves the loop a round early.
    assert!(case.diagnosis.divergence.as_ref().unwrap().path, "{:?}", case.diagnosis);
}

#[test]
fn sums_in_another_order_are_told_from_other_faults() {
    let strict = by_name("binary32").unwrap();
    let right = replaced("two_bones", "", "");
    let device = Adversary::lane(strict, Stage::Compute, Strategy::Random, 1, false);
    assert_eq!(check(&right, &device, text(strict)).verdicts.deviated, 0);
    let regrouped = device.with_laws(Laws::Order);
    let report = check(&right, &regrouped, text(strict));
    let (deviation, case) = deviation(&report);
    assert_eq!(deviation.blame, Blame::Lane);
    assert_eq!(case.diagnosis.origin, Some(Origin::Rearrangement));
    // The same device is right by a promise that allows it.
    let allowing = check(&right, &regrouped, text(vulkan()));
    assert_eq!(allowing.verdicts.deviated, 0, "{:?}", allowing.findings);
}

/// What judges keep from one batch does not show in the verdict on the next: right, wrong, and right again.
#[test]
fn judges_that_are_used_again_say_what_new_ones_say() {
    let strict = by_name("binary32").unwrap();
    let right = replaced("two_bones", "", "");
    let device = Adversary::lane(strict, Stage::Compute, Strategy::Random, 1, false);
    let wrong = Adversary::lane(strict, Stage::Compute, Strategy::Random, 1, false).with_laws(Laws::Order);
    let promises = text(strict);
    let context =
        JudgeContext { oracle: &right.oracle, reference: &right.reference, promises: &promises, stage: Stage::Compute };
    let kept = Judges::new(&context);
    let mut deviated = Vec::new();
    for (seed, lane) in [(1, &device), (2, &wrong), (3, &device), (2, &wrong)] {
        let batch = Sampler::new(right.plan.clone(), seed).batch(0, 300, 4);
        let actual = lane.prepare(&right.compute, batch.invocation_count()).unwrap().run(&batch).unwrap();
        let (again, new) = (kept.judge(&batch, &actual), judge_batch(&context, &batch, &actual));
        let of = |verdict: &BatchVerdict| {
            let failures = verdict.failures.iter().map(|failure| failure.invocation).collect::<Vec<_>>();
            let BatchVerdict { agreed, agreed_by, undetermined, max_ulp, .. } = *verdict;
            (agreed, agreed_by, undetermined, max_ulp.to_bits(), failures)
        };
        assert_eq!(of(&again), of(&new), "seed {seed}");
        assert_eq!(again.seen(), 1200);
        deviated.push(again.deviated);
    }
    assert!(deviated[0] == 0 && deviated[1] > 0 && deviated[2] == 0 && deviated[3] == deviated[1], "{deviated:?}");
}

/// A shader without the word `precise`, by a profile that allows another order: what another order explains is not laid on
/// a `precise` that was lost.
#[test]
fn another_order_that_is_allowed_is_no_lost_precise() {
    let strict = by_name("binary32").unwrap();
    let right = replaced("two_bones", "", "");
    let device = Adversary::lane(strict, Stage::Compute, Strategy::Random, 1, false).with_laws(Laws::Order);
    let batch = Sampler::new(right.plan.clone(), 1).batch(0, 256, 4);
    let actual = device.prepare(&right.compute, batch.invocation_count()).unwrap().run(&batch).unwrap();
    let by = [text(strict), text(vulkan())];
    let context =
        |promises| JudgeContext { oracle: &right.oracle, reference: &right.reference, promises, stage: Stage::Compute };
    let verdict = judge_batch(&context(&by[0]), &batch, &actual);
    let failure = verdict.failures.first().expect("another order shows in strict binary32");
    let alone = Sample::batch(&[Sample::of(&batch, failure.invocation)]);
    let suspected = Suspected {
        lane: &device,
        stage: Stage::Compute,
        kernel: &Program::compute_kernel,
        batch: &alone,
        deviation: &failure.deviation,
    };
    let origins = by.each_ref().map(|by| diagnosis::lane(&context(by), &right.program, &suspected).unwrap().origin);
    assert_eq!(origins, [Some(Origin::Rearrangement), Some(Origin::Miscompilation)]);
}

/// Verdicts on the embedded lane for single samples of a shipped suite.
fn verdicts(prepared: &Prepared, invocations: &[u32]) -> Vec<Verdict> {
    let batch = Batch {
        invocation_record: prepared.compute.invocation.clone(),
        case_record: prepared.compute.case.clone(),
        per_case: 1,
        invocations: invocations.to_vec(),
        cases: Vec::new(),
    };
    let lane = embedded::open().unwrap();
    let actual = lane.prepare(&prepared.compute, 64).unwrap().run(&batch).unwrap();
    let promises = text(vulkan());
    let Prepared { oracle, reference, .. } = prepared;
    judge_each(&JudgeContext { oracle, reference, promises: &promises, stage: Stage::Compute }, &batch, &actual)
}

#[test]
fn weights_below_the_range_of_binary32_are_a_matter_of_range() {
    let right = replaced("bone_weight", "", "");
    let bits = |d: f32, c: f32| [d.to_bits(), c.to_bits()];
    // (3 + 1)^-64 = 2^-128; (2.5 + 1)^-64 is a normal number.
    let found = verdicts(&right, &[bits(3.0, 64.0), bits(2.5, 64.0)].concat());
    let Verdict::Undetermined(doubt) = &found[0] else { panic!("{found:?}") };
    assert!(doubt.reason == Reason::Underflow && doubt.reason.is_range());
    let cause = doubt.cause.as_ref().unwrap();
    assert_eq!(cause.op, Some(Op::Pow));
    assert!(matches!(found[1], Verdict::Agree(_)), "{found:?}");
}

#[test]
fn a_tangent_of_length_zero_has_no_direction_whoever_computes_it() {
    let lane = embedded::open().unwrap();
    let report = check(&replaced("hair", "", ""), &*lane, Promises::of_api(Api::Binary32));
    assert_eq!(report.verdicts.deviated, 0, "{:?}", report.findings);
    let doubt = report.doubts.iter().find(|d| d.reason == Reason::Domain).unwrap();
    assert_eq!(doubt.op.map(|op| op.name()), Some("inversesqrt"));
    assert!(doubt.text.starts_with("normalize("), "{doubt}");
}

fn angle(args: &Args<'_>, out: &mut [f64]) {
    out[0] = args.vec3(0).dot(args.vec3(1)).clamp(-1.0, 1.0).acos();
}

static ANGLE: Formula = Formula {
    name: "angle",
    source: "the angle between two unit vectors",
    inputs: &[Param::new("a", Kind::Vec3), Param::new("b", Kind::Vec3)],
    outputs: &[Param::new("return", Kind::Float)],
    rule: Rule::Pointwise(angle),
};

/// Verdict and diagnosis for the angle of a vector with itself, by this expression.
fn angle_of(expression: &str, v: [f32; 3]) -> (Verdict, Option<Dependence>) {
    let source = format!("#version 150 core\nfloat angle(vec3 a, vec3 b) {{ return {expression}; }}\n");
    let target = Target::Function("angle".into());
    let program =
        Program::from_source(&SourceFile::new("angle.glsl", source), syntax::Stage::Library, |_| Ok(target)).unwrap();
    let (oracle, reference) = (Oracle::new(&program).unwrap(), Reference::new(&ANGLE, &program).unwrap());
    let promises = text(vulkan());
    let context = JudgeContext { oracle: &oracle, reference: &reference, promises: &promises, stage: Stage::Compute };
    let field = |name: &str| Field { name: name.into(), shape: Shape::VEC3 };
    let batch = Batch {
        invocation_record: Arc::new(Record::new(vec![field("a"), field("b")])),
        case_record: Arc::default(),
        per_case: 1,
        invocations: v.iter().chain(&v).map(|x| x.to_bits()).collect(),
        cases: Vec::new(),
    };
    let kernel = program.compute_kernel().unwrap();
    let actual = embedded::open().unwrap().prepare(&kernel, 1).unwrap().run(&batch).unwrap();
    let verdict = judge_each(&context, &batch, &actual).remove(0);
    (verdict, dependences(&oracle, &batch).remove(0))
}

#[test]
fn an_arc_cosine_past_one_is_the_shaders_fault_and_named() {
    // A vector of length 1 to within its rounding, whose product with itself is above 1.
    let v = [0.600_000_1_f32, 0.8, 0.0];
    let (verdict, found) = angle_of("acos(dot(a, b))", v);
    let Verdict::Undetermined(doubt) = &verdict else { panic!("{verdict:?}") };
    assert_eq!(doubt.reason, Reason::Undefined);
    let found = found.unwrap();
    assert!(found.args[0] > 1.0 && found.args[0] < 1.000_001, "{found:?}");
    assert!(found.of.why(&found.args).starts_with("`acos` of 1.00000"), "{found:?}");
    // Held in the domain, nothing is wrong; so near to its end nothing is decided either.
    let (held, _) = angle_of("acos(clamp(dot(a, b), -1.0, 1.0))", v);
    assert!(!matches!(held, Verdict::Deviate(_)), "{held:?}");
    let (within, _) = angle_of("acos(dot(a, b))", [0.6, 0.7, 0.0]);
    assert!(matches!(within, Verdict::Agree(_)), "{within:?}");
}

#[test]
fn what_the_rounding_of_a_literal_decides_is_undetermined() {
    // 0.123456 is no binary32 number: the author's comparison never holds, the device's does.
    let edited = replaced("bone_weight", "return", "if (d == 0.123456) return 2.0;\n  return");
    let bits = |d: f32| [d.to_bits(), 16.0_f32.to_bits()];
    let found = verdicts(&edited, &[bits(0.123456), bits(0.25)].concat());
    let Verdict::Undetermined(doubt) = &found[0] else { panic!("{found:?}") };
    assert_eq!(doubt.reason, Reason::Branch);
    assert!(matches!(found[1], Verdict::Agree(_)), "{found:?}");
    // A binary32 number is what it is on both sides: the shader deviates.
    let edited = replaced("bone_weight", "return", "if (d == 0.125) return 2.0;\n  return");
    let found = verdicts(&edited, &bits(0.125));
    assert!(matches!(&found[0], Verdict::Deviate(d) if d.blame == Blame::Shader), "{found:?}");
}

/// A lane that runs another text: what a compiler makes of the first one. It shows nothing of what comes on the way.
struct Compiled(Box<dyn Lane>, Program);

impl Lane for Compiled {
    fn description(&self) -> &Description {
        self.0.description()
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        match kernel.program.instrumented {
            true => Err(LaneError::Unsupported("traces".to_owned())),
            false => self.0.prepare(&self.1.compute_kernel().unwrap(), capacity),
        }
    }
}

#[test]
fn a_rounding_that_is_left_out_is_named_by_its_pair() {
    let program = |body: &str| {
        let text = format!("#version 450 core\nfloat f(float x) {{ {body} }}\n");
        let file = SourceFile::new("f.glsl", text);
        Program::from_source(&file, syntax::Stage::Library, |_| Ok(Target::Function("f".into()))).unwrap()
    };
    for (written, compiled, x, said) in [
        (
            "return unpackHalf2x16(packHalf2x16(vec2(x, 1.0))).x;",
            "return x;",
            0.100_1_f32,
            Some(["packHalf2x16(vec2(x, 1.0))", "unpackHalf2x16(packHalf2x16(vec2(x, 1.0)))"]),
        ),
        ("int i = int(x); return float(i) * 0.5;", "return x * 0.5;", 3.7, Some(["int(x)", "float(i)"])),
        ("return float(uint(x)) + 1.0;", "return x + 1.0;", 3.7, Some(["uint(x)", "float(uint(x))"])),
        // Another fault, beside a pair that is there and elsewhere.
        ("return float(int(x)) * 0.5;", "return x * 0.25;", 3.7, None),
        ("return x * 0.5;", "return x * 0.25;", 3.7, None),
    ] {
        let shader = program(written);
        let (oracle, reference) = (Oracle::new(&shader).unwrap(), Reference::nothing(&shader));
        let promises = text(vulkan());
        let stage = Stage::Compute;
        let context = JudgeContext { oracle: &oracle, reference: &reference, promises: &promises, stage };
        let batch = Batch {
            invocation_record: Arc::new(shader.invocation_record()),
            case_record: Arc::default(),
            per_case: 1,
            invocations: vec![x.to_bits()],
            cases: Vec::new(),
        };
        let lane = Compiled(embedded::open().unwrap(), program(compiled));
        let actual = lane.prepare(&shader.compute_kernel().unwrap(), 1).unwrap().run(&batch).unwrap();
        let Verdict::Deviate(deviation) = judge_each(&context, &batch, &actual).remove(0) else {
            panic!("{written}: as {compiled} it is not found")
        };
        let suspected =
            Suspected { lane: &lane, stage, kernel: &Program::compute_kernel, batch: &batch, deviation: &deviation };
        let origin = diagnosis::lane(&context, &shader, &suspected).unwrap().origin;
        match said {
            Some([there, back]) => {
                let Some(Origin::RoundingLeftOut { there: a, back: b }) = &origin else {
                    panic!("{written}: {origin:?}")
                };
                let texts = [a, b].map(|place| place.as_ref().map(|place| place.text.as_str()));
                assert_eq!(texts, [Some(there), Some(back)], "{written}");
            }
            None => assert_eq!(origin, Some(Origin::Miscompilation), "{written}"),
        }
    }
}
