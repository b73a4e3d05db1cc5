//! Traces of small functions against values worked out by hand.

use judge::profile::Op;
use program::ProgramError;
use program::interp::{self, Binary64};
use program::probe::{MAX_WORDS, OperandSource, TraceError, What};

use super::{batch, driver, embedded_lane, function, read, run, trace};

const LOOP: &str = "float half_of(float v) {
    return v * 0.5;
}
float f(float x) {
    float s = x;
    for (int i = 0; i < 3; i++) {
        s = s * 2.0;
        if (s > 100.0) {
            s = s - 100.0;
        }
    }
    return half_of(s) + sin(x - x);
}";

fn step(text: &str, values: &[f32]) -> (String, Vec<f32>) {
    (text.to_owned(), values.to_vec())
}

#[test]
fn a_loop_a_branch_and_a_call_are_traced_in_order() {
    let probed = function(LOOP).probed(256).unwrap();
    let batch = batch(&probed.program, &[3.0, 20.0]);
    for lane in [embedded_lane(), driver()] {
        let actual = run(&*lane, &probed.program, &batch);
        // The branch is never taken for 3, and in the third round for 20.
        let trace_of_3 = trace(&probed, &actual, 0);
        assert_eq!(
            read(&probed, &trace_of_3),
            [
                step("s * 2.0", &[6.0]),
                step("s > 100.0", &[6.0, 100.0]),
                step("s * 2.0", &[12.0]),
                step("s > 100.0", &[12.0, 100.0]),
                step("s * 2.0", &[24.0]),
                step("s > 100.0", &[24.0, 100.0]),
                step("v * 0.5", &[12.0]),
                step("x - x", &[0.0]),
                step("sin(x - x)", &[0.0]),
                step("half_of(s) + sin(x - x)", &[12.0]),
            ]
        );
        assert!(!trace_of_3.cut);
        let trace_of_20 = read(&probed, &trace(&probed, &actual, 1));
        assert_eq!(trace_of_20.len(), 11);
        assert_eq!(trace_of_20[6], step("s - 100.0", &[60.0]));
        assert_eq!(f32::from_bits(actual.vertex(0, 0)[0]), 12.0);
        assert_eq!(f32::from_bits(actual.vertex(1, 0)[0]), 30.0);
    }
}

#[test]
fn points_know_their_place_their_operands_and_their_operations() {
    let probed = function(LOOP).probed(256).unwrap();
    let at = |text: &str| probed.points.iter().position(|point| probed.text(point) == text).unwrap();
    let (sine, difference, half) = (at("sin(x - x)"), at("x - x"), at("v * 0.5"));
    assert_eq!(probed.locate(&probed.points[sine]), "f.glsl:13:25");
    assert_eq!(probed.locate(&probed.points[half]), "f.glsl:3:12");
    assert_ne!(probed.points[half].function, probed.points[sine].function);
    let [ref operation] = probed.points[sine].operations[..] else { panic!() };
    assert_eq!((operation.name, operation.result), ("sin", Some(0)));
    assert_eq!(operation.operands, [OperandSource::Point { point: difference, component: 0 }]);
    assert_eq!(probed.points[half].operands, [vec![OperandSource::Leaf(0)], vec![OperandSource::Literal(0.5)]]);
    assert_eq!(probed.points[at("s > 100.0")].what, What::Comparison);
}

#[test]
fn operations_come_with_the_operands_that_they_had() {
    let text = "vec2 f(vec3 a, vec3 b, mat2 m) { return m * (max(a.zy, 0.25) / b.x) + dot(a, b) * vec2(1.0, a.y); }";
    let probed = function(text).probed(256).unwrap();
    let input = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1.0, 2.0, 3.0, 4.0];
    let actual = run(&*embedded_lane(), &probed.program, &batch(&probed.program, &input));
    let trace = trace(&probed, &actual, 0);
    let seen: Vec<(&str, Vec<f32>, f32)> = probed
        .applied(&trace)
        .into_iter()
        .map(|a| (a.name, a.operands.iter().map(|&w| f32::from_bits(w)).collect(), f32::from_bits(a.result)))
        .collect();
    let product = [0.75 + 3.0 * 0.5, 2.0 * 0.75 + 4.0 * 0.5];
    assert_eq!(
        seen,
        [
            ("max", vec![3.0, 0.25], 3.0),
            ("max", vec![2.0, 0.25], 2.0),
            ("div", vec![3.0, 4.0], 0.75),
            ("div", vec![2.0, 4.0], 0.5),
            // The product with the matrix and the inner product have intermediate values that are not seen.
            ("mul", vec![32.0, 1.0], 32.0),
            ("mul", vec![32.0, 2.0], 64.0),
            ("add", vec![product[0], 32.0], product[0] + 32.0),
            ("add", vec![product[1], 64.0], product[1] + 64.0),
        ]
    );
    let of = |name: &str| probed.points.iter().flat_map(|p| &p.operations).filter(|o| o.name == name).count();
    assert_eq!((of("mul"), of("add")), (4 + 3 + 2, 2 + 2 + 2));
}

#[test]
fn operations_have_the_names_of_profiles() {
    let text = "vec3 f(vec3 a, vec3 b, float t, mat3 m, int n) {
        vec3 c = cross(normalize(a), -b) + reflect(a, b) * distance(a, b) + mix(a, b, t) - clamp(a, b, vec3(t));
        c += refract(a, b, t) / length(b) + pow(abs(a), b) + atan(a, b) + inversesqrt(b) + step(a, b) + fract(c);
        c *= transpose(m) * faceforward(a, b, c) + exp2(log2(c)) + smoothstep(a, b, c) * float(n) * determinant(m);
        return sqrt(a) + floor(b) + fma(a, b, c);
    }";
    let probed = function(text).probed(1024).unwrap();
    let mut names: Vec<&str> = probed.points.iter().flat_map(|p| &p.operations).map(|o| o.name).collect();
    names.sort_unstable();
    names.dedup();
    for name in &names {
        assert!(Op::by_name(name).is_some(), "{name}");
    }
    for name in ["add", "neg", "sqrt", "max", "atan2", "refract", "faceforward", "convert", "fma", "determinant"] {
        assert!(names.contains(&name), "{name}");
    }
}

#[test]
fn a_trace_that_is_cut_says_so() {
    let long = function(LOOP).probed(256).unwrap();
    let batch = batch(&long.program, &[3.0]);
    let whole = trace(&long, &run(&*embedded_lane(), &long.program, &batch), 0);
    for lane in [embedded_lane(), driver()] {
        for words in [1, 7, 20, whole.words - 1, whole.words] {
            let probed = function(LOOP).probed(words).unwrap();
            let actual = run(&*lane, &probed.program, &batch);
            let cut = trace(&probed, &actual, 0);
            assert_eq!((cut.cut, cut.words), (words < whole.words, whole.words), "{words}");
            assert_eq!(cut.steps, whole.steps[..cut.steps.len()], "{words}");
            assert_eq!(cut.steps.len() == whole.steps.len(), !cut.cut);
            assert_eq!(cut.first_difference(&whole, |a, b| a == b), None);
            assert_eq!(f32::from_bits(actual.vertex(0, 0)[0]), 12.0);
        }
    }
}

#[test]
fn room_for_no_words_or_too_many_is_refused() {
    for words in [0, MAX_WORDS + 1] {
        let error = function(LOOP).probed(words).unwrap_err();
        assert!(matches!(error, ProgramError::Unsupported { .. }), "{error}");
    }
    let most = function(LOOP).probed(MAX_WORDS).unwrap();
    let batch = batch(&most.program, &[3.0]);
    assert_eq!(trace(&most, &run(&*embedded_lane(), &most.program, &batch), 0).steps.len(), 10);
}

#[test]
fn damaged_words_are_no_trace() {
    let probed = function(LOOP).probed(64).unwrap();
    let actual = run(&*embedded_lane(), &probed.program, &batch(&probed.program, &[3.0]));
    let words = actual.vertex(0, 0);
    assert!(probed.trace(words).is_ok());
    let damaged = |at: usize, word: u32| {
        let mut words = words.to_vec();
        words[at] = word;
        probed.trace(&words).unwrap_err()
    };
    // The function's own output is word 0.
    assert_eq!(damaged(1, 0), TraceError::Step { at: 0 });
    assert_eq!(damaged(1, 99.0_f32.to_bits()), TraceError::Step { at: 0 });
    assert_eq!(damaged(65, 1), TraceError::Step { at: 0 });
    assert!(matches!(probed.trace(&words[1..]), Err(TraceError::Length { found: 65, expected: 66 })));
    assert_eq!(probed.trace(&[f64::NAN; 66]), Err(TraceError::Count));
}

#[test]
fn binary64_has_the_same_steps() {
    let probed = function(LOOP).probed(256).unwrap();
    let batch = batch(&probed.program, &[0.3, 20.0]);
    let meaning = interp::run::<Binary64>(&probed.program, &batch).unwrap();
    let actual = run(&*embedded_lane(), &probed.program, &batch);
    for invocation in 0..2 {
        let wide = probed.trace(meaning.vertex(invocation, 0)).unwrap();
        let narrow = trace(&probed, &actual, invocation);
        let near = |a: f64, b: u32| (a - f64::from(f32::from_bits(b))).abs() <= 1e-6 * a.abs();
        let agree = |a: &[f64], b: &[u32]| a.len() == b.len() && a.iter().zip(b).all(|(&a, &b)| near(a, b));
        assert_eq!(wide.first_difference(&narrow, |a, b| agree(&a.values, &b.values)), None);
        assert_eq!(wide.steps.len(), 10 + invocation);
    }
}
