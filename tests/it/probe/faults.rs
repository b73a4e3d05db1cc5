//! An operation that is wrong on one side is the first step at which two traces part.

use program::Probed;
use program::probe::{Step, Trace};

use super::{batch, driver, embedded_lane, function, run, trace};

const TEXT: &str = "float scaled(float v, float by) {
    return v * by + 0.125;
}
float f(float a, float b) {
    float s = 0.0;
    for (int i = 0; i < 3; i++) {
        s += scaled(a, b);
        a = a - b;
    }
    return sqrt(s * s) / (1.0 + b);
}";

/// The program with another operator in place of that of the point with this text.
fn mutated(probed: &Probed, text: &str, op: naga::BinaryOperator) -> Probed {
    let mut probed = probed.clone();
    let point = probed.points.iter().find(|point| probed.text(point) == text).unwrap();
    let function = &mut probed.program.module.functions[point.function.unwrap()];
    let naga::Expression::Binary { op: old, .. } = &mut function.expressions[point.expression.unwrap()] else {
        panic!("`{text}` is no operator")
    };
    assert_ne!(*old, op);
    *old = op;
    probed
}

fn near(a: &Step<u32>, b: &Step<u32>) -> bool {
    let number = |&word: &u32| f32::from_bits(word);
    a.values.iter().map(number).zip(b.values.iter().map(number)).all(|(a, b)| (a - b).abs() <= 1e-5 * a.abs())
}

fn traces(probed: &Probed) -> [Trace<u32>; 2] {
    let batch = batch(&probed.program, &[2.5, 0.75]);
    [embedded_lane(), driver()].map(|lane| trace(probed, &run(&*lane, &probed.program, &batch), 0))
}

#[test]
fn the_first_step_that_differs_is_the_one_that_is_wrong() {
    let probed = function(TEXT).probed(512).unwrap();
    let right = traces(&probed);
    assert_eq!(right[0].first_difference(&right[1], near), None);
    for (text, op, round) in [
        ("v * by", naga::BinaryOperator::Add, 0),
        ("v * by + 0.125", naga::BinaryOperator::Subtract, 0),
        ("a - b", naga::BinaryOperator::Add, 0),
        ("1.0 + b", naga::BinaryOperator::Subtract, 0),
    ] {
        let wrong = mutated(&probed, text, op);
        for (right, wrong) in right.iter().zip(traces(&wrong)) {
            let at = right.first_difference(&wrong, near).unwrap();
            assert_eq!(probed.text(&probed.points[right.steps[at].point]), text);
            assert_eq!(right.steps[..at].iter().filter(|s| s.point == right.steps[at].point).count(), round);
            assert!(at == 0 || near(&right.steps[at - 1], &wrong.steps[at - 1]));
        }
    }
}

#[test]
fn a_branch_that_goes_the_other_way_parts_the_traces() {
    let text = "float f(float a, float b) { if (a < b) return a * 2.0; return b * 3.0; }";
    let probed = function(text).probed(64).unwrap();
    let wrong = mutated(&probed, "a < b", naga::BinaryOperator::Greater);
    let (right, wrong) = (traces(&probed), traces(&wrong));
    // The operands of the comparison agree, and the way behind it does not.
    assert_eq!(right[0].first_difference(&wrong[1], near), Some(1));
    assert_eq!(right[0].first_difference(&right[1], near), None);
}

#[test]
fn a_trace_that_ends_early_differs_there() {
    let probed = function(TEXT).probed(512).unwrap();
    let [right, _] = traces(&probed);
    let mut short = right.clone();
    short.steps.truncate(4);
    assert_eq!(right.first_difference(&short, near), Some(4));
    assert_eq!(short.first_difference(&right, near), Some(4));
    short.cut = true;
    assert_eq!(right.first_difference(&short, near), None);
}
