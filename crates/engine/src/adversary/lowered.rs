//! Functions of `mediump` on the worst device: none that keeps what GLSL ES and Vulkan promise is accused.

use super::{Adversary, Strategy};
use base::text::SourceFile;
use base::value::Batch;
use judge::profile::{Promises, by_name};
use judge::verdict::{BatchVerdict, JudgeContext, Oracle, Reference, judge_batch};
use lanes::{Api, Lane, Stage};
use program::Program;
use program::lower::Target;
use property::Stream;

/// Functions of two numbers: sums that cancel, squares, functions, comparisons, conversions, loops, mixed precisions.
const FUNCTIONS: &[&str] = &[
    "float f(float x, float y) { return x * y + 0.1; }",
    "float f(float x, float y) { return (x - y) * (x + y) / (abs(x) + abs(y) + 1e-3); }",
    "float f(float x, float y) { return length(vec2(x, y)); }",
    "float f(float x, float y) { return normalize(vec3(x, y, 1.0)).x; }",
    "float f(float x, float y) { return fract(x) + floor(y) * 0.25; }",
    "float f(float x, float y) { return sin(x) * cos(y) + exp2(-abs(x)); }",
    "float f(float x, float y) { return x > 0.3 ? x * 2.0 : mix(x, y, 0.25); }",
    "float f(float x, float y) { float s = 0.0; for (int i = 0; i < 4; ++i) { s += x * float(i) - y; } return s; }",
    "float f(float x, float y) { highp float a = x * 3.0; return a + y; }",
    "float f(highp float x, float y) { highp float a = x * x; return a * 0.001 + y; }",
    "float f(float x, float y) { return sqrt(abs(x)) + inversesqrt(abs(y) + 1.0); }",
    "float f(float x, float y) { lowp float c = clamp(x, 0.0, 1.0); return c * y; }",
    "float f(float x, float y) { return dot(vec3(x, y, 1e-6), vec3(y, x, 1.0)); }",
    "float f(float x, float y) { return log2(abs(x) + 1.0) * pow(abs(y) + 0.5, 2.0); }",
    "float f(float x, float y) { return smoothstep(-1.0, 2.0, x) + step(y, 0.5); }",
    "float f(float x, float y) { return atan(x, abs(y) + 0.1) + float(int(x * 8.0)); }",
];

fn program(function: &str) -> Program {
    let text = format!("#version 310 es\nprecision mediump float;\n{function}\n");
    let file = SourceFile::new("f.glsl", text);
    Program::from_source(&file, syntax::Stage::Library, |_| Ok(Target::Function("f".to_owned()))).unwrap()
}

/// The verdict on a device, by what is promised of `mediump` or by binary32.
fn verdict(function: &str, strategy: Strategy, seed: u64, count: usize, lowered: bool) -> BatchVerdict {
    let program = program(function);
    let kernel = program.compute_kernel().unwrap();
    let lane = Adversary::lane(by_name("vulkan-1.4").unwrap(), Stage::Compute, strategy, seed, false).lowering();
    let mut stream = Stream::new(seed);
    let mut batch = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), 1, count);
    for _ in 0..2 * count {
        let size = 2f64.powi(stream.below(14) as i32 - 7);
        batch.invocations.push(((stream.between(-1.0, 1.0) * size) as f32).to_bits());
    }
    let actual = lane.prepare(&kernel, count).unwrap().run(&batch).unwrap();
    let oracle = if lowered { Oracle::lowered(&program) } else { Oracle::new(&program) }.unwrap();
    let (reference, promises) = (Reference::nothing(&program), Promises::of_api(Api::Vulkan));
    let context = JudgeContext { oracle: &oracle, reference: &reference, promises: &promises, stage: Stage::Compute };
    judge_batch(&context, &batch, &actual)
}

#[test]
fn no_device_that_keeps_its_promises_of_mediump_is_accused() {
    let mut agreed = 0;
    for function in FUNCTIONS {
        for (seed, strategy) in Strategy::ALL.into_iter().enumerate() {
            let found = verdict(function, strategy, seed as u64, 4096, true);
            assert_eq!(found.deviated, 0, "{function} {strategy:?}: {:?}", found.failures.first());
            agreed += found.agreed;
        }
    }
    let all = (FUNCTIONS.len() * Strategy::ALL.len() * 4096) as u64;
    assert!(agreed * 2 > all, "of most samples something is known: {agreed} of {all}");
}

#[test]
fn the_same_device_breaks_the_promises_of_binary32() {
    for function in FUNCTIONS {
        let found = verdict(function, Strategy::Extreme, 5, 1024, false);
        assert!(found.deviated > 0, "{function}");
    }
}
