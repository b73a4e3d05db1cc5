//! Comparisons of numbers that a device may flush to zero: no conforming device is accused, and a wrong one is.

use std::sync::Arc;

use engine::adversary::{Adversary, Strategy};
use judge::profile::{Profile, Promises, by_name};

use base::text::SourceFile;
use base::value::Batch;
use judge::verdict::{JudgeContext, Oracle, Reference, Verdict, judge_each};
use lanes::{Lane, Stage, embedded};
use program::Program;
use program::lower::Target;

/// Conditions on `x` and `y`. With the inputs of `TINY`, a flush of each changes its answer for some of them.
const CONDITIONS: [&str; 34] = [
    "x == y",
    "x != y",
    "x < y",
    "x <= y",
    "x > y",
    "x >= y",
    "!(x < y)",
    "-x < y",
    "x > 1e-40",
    "1e-40 >= y",
    "bool(x)",
    "bvec2(vec2(x, y)).x",
    "vec2(x, y) == vec2(y, x)",
    "vec3(x, y, 1.0) != vec3(0.0, y, 1.0)",
    "mat2(x, y, 1.0, 0.0) == mat2(0.0, y, 1.0, 0.0)",
    "all(equal(vec2(x, y), vec2(0.0)))",
    "any(notEqual(vec2(x, y), vec2(0.0)))",
    "lessThan(vec2(x, 1.0), vec2(y, 0.0)).x",
    "lessThanEqual(vec2(1.0, x), vec2(0.0, y)).y",
    "greaterThan(vec4(x), vec4(y)).w",
    "greaterThanEqual(vec2(x), vec2(y)).x",
    "mix(0.0, 1.0, x > y) > 0.5",
    "vec2(x, y).yx.y > 0.0",
    "abs(x) > 0.0",
    "max(x, 0.0) > 0.0",
    "min(x, y) < 0.0",
    "sign(x) != 0.0",
    "step(x, y) > 0.5",
    "floor(x) < 0.0",
    "ceil(x) > 0.5",
    "int(floor(x)) < 0",
    "int(ceil(x)) > 0",
    "floatBitsToInt(x) == 0",
    "(x != 0.0 ? 1.0 / x : 0.0) > 0.0",
];

const TINY: [[f32; 2]; 9] = [
    [1e-40, 0.0],
    [0.0, 1e-40],
    [-1e-40, 0.0],
    [0.0, -1e-40],
    [1e-40, 2e-40],
    [2e-40, 1e-40],
    [-1e-40, 1e-40],
    [1e-40, 1e-40],
    [1e-45, -3e-39],
];

/// Numbers that nobody flushes; each condition is also asked at a place where it is just about to change.
const NORMAL: [[f32; 2]; 8] =
    [[0.5, 0.25], [0.25, 0.5], [0.5, 0.5], [-0.5, 0.0], [0.0, 0.5], [0.0, 0.0], [1.2e-38, 0.0], [0.5, 0.500_000_06]];

fn program(condition: &str) -> Program {
    let text = format!("#version 450 core\nfloat f(float x, float y) {{ return {condition} ? 2.0 : 1.0; }}\n");
    let file = SourceFile::new("f.glsl", text);
    Program::from_source(&file, syntax::Stage::Library, |_| Ok(Target::Function("f".into())))
        .unwrap_or_else(|error| panic!("{condition}: {error:?}"))
}

fn batch(program: &Program, inputs: &[[f32; 2]]) -> Batch {
    Batch {
        invocation_record: Arc::new(program.invocation_record()),
        case_record: Arc::new(program.case_record()),
        per_case: 1,
        invocations: inputs.iter().flatten().map(|x| x.to_bits()).collect(),
        cases: Vec::new(),
    }
}

/// Verdicts on a lane that is held against a profile in a stage.
fn verdicts(program: &Program, profile: &'static Profile, on: (Stage, &dyn Lane), inputs: &[[f32; 2]]) -> Vec<Verdict> {
    let (stage, lane) = on;
    let (oracle, reference) = (Oracle::new(program).unwrap(), Reference::nothing(program));
    let promises = Promises { text: profile, conformance: None, measured: None };
    let context = JudgeContext { oracle: &oracle, reference: &reference, promises: &promises, stage };
    let batch = batch(program, inputs);
    let kernel = program.compute_kernel().unwrap();
    let actual = lane.prepare(&kernel, inputs.len()).unwrap().run(&batch).unwrap();
    judge_each(&context, &batch, &actual)
}

/// The first word of each invocation, as a lane gives it.
fn words(program: &Program, lane: &dyn Lane, inputs: &[[f32; 2]]) -> Vec<u32> {
    let kernel = program.compute_kernel().unwrap();
    let actual = lane.prepare(&kernel, inputs.len()).unwrap().run(&batch(program, inputs)).unwrap();
    (0..inputs.len()).map(|k| actual.vertex(k, 0)[0]).collect()
}

fn profiles() -> impl Iterator<Item = &'static Profile> {
    ["vulkan-1.4", "glsl-4.60", "wgsl", "binary32"].into_iter().map(|name| by_name(name).unwrap())
}

#[test]
fn a_device_that_flushes_the_operands_of_a_comparison_is_not_accused() {
    let mut wrong = Vec::new();
    for condition in CONDITIONS {
        let program = program(condition);
        for profile in profiles() {
            for stage in [Stage::Compute, Stage::Vertex, Stage::Geometry] {
                let (mut turned, mut seen) = (0, 0);
                let meant = words(&program, &*embedded::open().unwrap(), &TINY);
                for seed in 0..12 {
                    let strategy = Strategy::ALL[seed as usize % Strategy::ALL.len()];
                    let lane = Adversary::lane(profile, stage, strategy, seed, false);
                    let found = verdicts(&program, profile, (stage, &lane), &TINY);
                    turned += words(&program, &lane, &TINY).iter().zip(&meant).filter(|(a, b)| a != b).count();
                    for (inputs, verdict) in TINY.iter().zip(found) {
                        seen += 1;
                        match verdict {
                            Verdict::Agree(_) | Verdict::Undetermined(_) => {}
                            Verdict::Deviate(deviation) => {
                                let name = &profile.name;
                                wrong.push(format!("{name} {stage}: {condition} of {inputs:?}: {deviation}"));
                            }
                        }
                    }
                }
                // Where something may be flushed, some device gave another answer.
                let flushes = profile.name != "binary32";
                if (turned > 0) != flushes || seen == 0 {
                    wrong.push(format!("{} {stage}: {condition}: {turned} of {seen} are turned", profile.name));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong[..wrong.len().min(40)].join("\n"));
}

#[test]
fn a_wrong_answer_about_normal_numbers_is_held_against_the_device() {
    let mut wrong = Vec::new();
    for condition in CONDITIONS {
        let right = program(condition);
        let other = program(&format!("!({condition})"));
        for profile in profiles() {
            for stage in [Stage::Compute, Stage::Vertex, Stage::Geometry] {
                let lane = Adversary::lane(profile, stage, Strategy::Mixed, 3, false);
                for (inputs, verdict) in NORMAL.iter().zip(verdicts(&right, profile, (stage, &lane), &NORMAL)) {
                    if !matches!(verdict, Verdict::Agree(_)) {
                        wrong.push(format!("{} {stage}: {condition} of {inputs:?}: {verdict:?}", profile.name));
                    }
                }
                // A device that compares the other way round: its words, judged as those of the shader.
                let (oracle, reference) = (Oracle::new(&right).unwrap(), Reference::nothing(&right));
                let promises = Promises { text: profile, conformance: None, measured: None };
                let context = JudgeContext { oracle: &oracle, reference: &reference, promises: &promises, stage };
                let (batch, kernel) = (batch(&right, &NORMAL), other.compute_kernel().unwrap());
                let strict = embedded::open().unwrap();
                let actual = strict.prepare(&kernel, NORMAL.len()).unwrap().run(&batch).unwrap();
                for (inputs, verdict) in NORMAL.iter().zip(judge_each(&context, &batch, &actual)) {
                    if !matches!(verdict, Verdict::Deviate(_)) {
                        wrong.push(format!("{} {stage}: missed {condition} of {inputs:?}: {verdict:?}", profile.name));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong[..wrong.len().min(40)].join("\n"));
}

/// Decisions that rounding makes, with what a device may give of the first component on either side. The second one depends on
/// none.
const SIDES: [(&str, &[&str], &str); 8] = [
    ("x * 3.0 < 1.0 ? 5.0 : 7.0", &["5.0", "7.0"], "6.0"),
    ("floor(x * 3.0)", &["0.0", "1.0"], "0.5"),
    ("sign(x * 3.0 - 1.0)", &["-1.0", "0.0", "1.0"], "0.5"),
    ("step(1.0, x * 3.0) * 8.0", &["0.0", "8.0"], "4.0"),
    ("float(int(x * 3.0))", &["0.0", "1.0"], "0.25"),
    ("fract(x * 3.0) * 16.0", &["0.0", "15.9999999"], "8.0"),
    ("float(floatBitsToUint(x * 3.0) & 1u)", &["0.0", "1.0"], "2.0"),
    ("rounds(x)", &["3.0", "4.0"], "5.0"),
];

const LOOP: &str =
    "float rounds(float x) { float s = 0.0; for (float t = 0.0; t < 1.0; t += x) s += 1.0; return s; }\n";

#[test]
fn a_word_on_a_side_of_a_decision_is_right_and_one_beyond_all_of_them_is_wrong() {
    let third = [[1.0_f32 / 3.0, 0.75]];
    let program = |first: &str, second: &str| {
        let text = format!("#version 450 core\n{LOOP}vec2 f(float x, float y) {{ return vec2({first}, {second}); }}\n");
        let file = SourceFile::new("f.glsl", text);
        Program::from_source(&file, syntax::Stage::Library, |_| Ok(Target::Function("f".into()))).unwrap()
    };
    let profile = by_name("vulkan-1.4").unwrap();
    let promises = Promises { text: profile, conformance: None, measured: None };
    for (decision, sides, beyond) in SIDES {
        let right = program(decision, "y");
        let (oracle, reference) = (Oracle::new(&right).unwrap(), Reference::nothing(&right));
        let stage = Stage::Compute;
        let context = JudgeContext { oracle: &oracle, reference: &reference, promises: &promises, stage };
        let judged = |other: &Program| {
            let batch = batch(&right, &third);
            let lane = embedded::open().unwrap();
            let actual = lane.prepare(&other.compute_kernel().unwrap(), 1).unwrap().run(&batch).unwrap();
            judge_each(&context, &batch, &actual).remove(0)
        };
        for side in sides {
            let found = judged(&program(side, "y"));
            assert!(matches!(found, Verdict::Agree(_)), "{decision}: {side}: {found:?}");
            let found = judged(&program(side, "x"));
            assert!(matches!(found, Verdict::Deviate(_)), "{decision}: {side} beside another component: {found:?}");
        }
        let found = judged(&program(beyond, "y"));
        assert!(matches!(found, Verdict::Deviate(_)), "{decision}: {beyond}: {found:?}");
    }
}

#[test]
fn a_wrong_output_beside_a_tie_of_the_shader_and_its_reference_is_found() {
    let inputs = [[0.5_f32, 0.75], [0.1, 0.9], [1.0, 0.25]];
    let program = |returns: &str| {
        let text = format!("#version 450 core\nvec2 f(float x, float y) {{ {returns} }}\n");
        let file = SourceFile::new("f.glsl", text);
        Program::from_source(&file, syntax::Stage::Library, |_| Ok(Target::Function("f".into()))).unwrap()
    };
    let stepped = |second: &str| program(&format!("return vec2(floor(sqrt(x * x) * 2.0), {second});"));
    let expected = stepped("y");
    let promises = Promises { text: by_name("vulkan-1.4").unwrap(), conformance: None, measured: None };
    for (second, wrong) in [("y", false), ("x", true)] {
        let shader = stepped(second);
        let oracle = Oracle::new(&shader).unwrap();
        let reference = Reference::model(&expected, "the model", None, &shader).unwrap();
        let stage = Stage::Compute;
        let context = JudgeContext { oracle: &oracle, reference: &reference, promises: &promises, stage };
        let batch = batch(&shader, &inputs);
        let lane = embedded::open().unwrap();
        let actual = lane.prepare(&shader.compute_kernel().unwrap(), 3).unwrap().run(&batch).unwrap();
        for (inputs, verdict) in inputs.iter().zip(judge_each(&context, &batch, &actual)) {
            let found = matches!(verdict, Verdict::Deviate(_));
            assert!(found == wrong && (wrong || matches!(verdict, Verdict::Agree(_))), "{inputs:?}: {verdict:?}");
        }
    }
}
