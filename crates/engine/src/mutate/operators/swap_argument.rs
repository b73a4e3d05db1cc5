//! Two arguments of one type exchanged, in calls and constructors.

use super::becomes;
use crate::mutate::{Code, Draft};
use syntax::ast::{Callee, ExprKind};
use syntax::symbols::Direction;

/// Functions for which the order of all their arguments does not matter.
const SYMMETRIC: [&str; 6] = ["min", "max", "dot", "distance", "equal", "notEqual"];

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for &id in &code.exprs {
        let ExprKind::Call { callee, args } = &code.shader.expr(id).kind else { continue };
        if matches!(callee, Callee::Name(name) if SYMMETRIC.contains(&name.name.as_str())) {
            continue;
        }
        let movable = |k: usize| code.direction(id, k) == Direction::In && code.is_plain(args[k]);
        for j in 1..args.len() {
            for i in 0..j {
                let same = code.shader.type_of(args[i]) == code.shader.type_of(args[j]);
                if !same || !movable(i) || !movable(j) {
                    continue;
                }
                let (a, b) = (code.shader.text_of(args[i]), code.shader.text_of(args[j]));
                let what = format!("arguments {} and {} are exchanged: {}", i + 1, j + 1, becomes(a, b));
                let edits = vec![code.replace(args[i], b), code.replace(args[j], a)];
                let clamp = matches!(callee, Callee::Name(name) if name.name == "clamp");
                // min(max(x, low), high)
                let identity =
                    (clamp && (i, j) == (0, 1)).then_some("clamp takes the larger of its first two arguments");
                drafts.push(Draft { edits, what, identity });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::{changes, identities};

    #[test]
    fn arguments_of_one_type_are_exchanged() {
        assert_eq!(
            changes("swap-argument", "vec2 f(vec2 a, vec2 b, float t) {\n  return mix(a, b, t);\n}"),
            ["return mix(b, a, t);"]
        );
        assert_eq!(changes("swap-argument", "vec2 f(float a) {\n  return vec2(a, 1.0);\n}"), ["return vec2(1.0, a);"]);
    }

    #[test]
    fn clamp_is_known_not_to_mind_its_first_two() {
        let text = "float f(float a) {\n  return clamp(a, 0.0, 1.0);\n}";
        assert_eq!((changes("swap-argument", text).len(), identities("swap-argument", text)), (3, 1));
    }

    #[test]
    fn symmetric_functions_and_equal_arguments_are_left_alone() {
        assert!(changes("swap-argument", "float f(vec2 a, vec2 b) {\n  return dot(a, b);\n}").is_empty());
        assert!(changes("swap-argument", "vec2 f(float a) {\n  return vec2(a, a);\n}").is_empty());
    }
}
