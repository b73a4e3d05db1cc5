//! N040: a small number that keeps a divisor from 0, and is 0 itself at `mediump`.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::precision::Precisions;
use syntax::symbols::CallTarget;
use syntax::{Const, Shader};

use analysis::forms::builtin;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N040"),
    name: "mediump-epsilon",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

/// Numbers nearer to 0 may be 0 (GLSL ES 3.00, 4.5.1).
const SMALLEST: f32 = 1.0 / 16384.0;
/// One step beside 1.
const STEP: f32 = 1.0 / 1024.0;

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !shader.has_precisions() {
        return;
    }
    let precisions = Precisions::of(shader);
    for (id, _) in shader.arena().iter() {
        let Some((value, other)) = guard(shader, id).filter(|_| precisions.is_lowered(id)) else { continue };
        if value >= STEP || !keeps_from_zero(shader, id) {
            continue;
        }
        let small = value < SMALLEST;
        // Of two numbers the larger one is what it is.
        let sum = matches!(shader.expr(id).kind, ExprKind::Binary { .. });
        let lost = sum && is_beside_one(shader, other);
        if !small && !lost {
            continue;
        }
        let span = shader.expr(id).span;
        let message = match small {
            true => message!(
                "{value:e} may be 0 at `mediump`, and keeps no divisor from 0",
                "`mediump` では {value:e} は 0 になり得るので、除数が 0 になるのを防げません"
            ),
            false => message!(
                "{value:e} is less than a step of `mediump` beside 1, and may be lost in this sum",
                "{value:e} は 1 の近くの `mediump` の刻みに満たず、この和では失われ得ます"
            ),
        };
        findings.push(
            findings
                .at(&file.file, span, message)
                .with_label(message!("a divisor", "除数"))
                .with_why(message!(
                    "GLSL ES promises of `mediump` numbers down to 6.1e-5, and steps of 0.00098 beside 1",
                    "GLSL ES が `mediump` に保証するのは 6.1e-5 以上の数と、1 の近くで 0.00098 の刻みだけです"
                ))
                .with_help(message!(
                    "take 0.001 or more, or declare what is computed here `highp`",
                    "0.001 以上にするか、ここで計算する値を `highp` で宣言してください"
                )),
        );
    }
}

fn constant(shader: &Shader, id: ExprId) -> Option<f32> {
    match shader.fold(id)? {
        Const::Float(v) => Some(v),
        _ => None,
    }
}

/// The small number of `x + small`, `max(x, small)`, and the other operand.
fn guard(shader: &Shader, id: ExprId) -> Option<(f32, ExprId)> {
    let (a, b) = match &shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Add, left, right, .. } => (*left, *right),
        ExprKind::Call { args, .. } if builtin(shader, id, &["max"]).is_some() => (*args.first()?, *args.get(1)?),
        _ => return None,
    };
    let small = |id| constant(shader, id).filter(|v| *v > 0.0);
    match (small(a), small(b)) {
        (None, Some(value)) if constant(shader, a).is_none() => Some((value, a)),
        (Some(value), None) if constant(shader, b).is_none() => Some((value, b)),
        _ => None,
    }
}

/// True where a value is divided by as it stands.
fn keeps_from_zero(shader: &Shader, id: ExprId) -> bool {
    let mut at = id;
    'up: loop {
        for (parent, expr) in shader.arena().iter() {
            match &expr.kind {
                ExprKind::Binary { op: BinaryOp::Div, right, .. } if *right == at => return true,
                ExprKind::Paren(inner) if *inner == at => {
                    at = parent;
                    continue 'up;
                }
                ExprKind::Assign { op: Some(BinaryOp::Div), value, .. } if *value == at => return true,
                ExprKind::Call { args, .. } if args.contains(&at) => {
                    if builtin(shader, parent, &["inversesqrt", "log", "log2"]).is_some() {
                        return true;
                    }
                    if !matches!(shader.callee(parent), Some(CallTarget::Constructor(_))) {
                        return false;
                    }
                    at = parent;
                    continue 'up;
                }
                _ => {}
            }
        }
        return false;
    }
}

/// True for a sum with a constant as large as 1 in it: its rounding is that of numbers near 1.
fn is_beside_one(shader: &Shader, id: ExprId) -> bool {
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) => is_beside_one(shader, *inner),
        ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, left, right, .. } => {
            let large = |id| constant(shader, id).is_some_and(|v| v.abs() >= 0.5);
            large(*left) || large(*right) || is_beside_one(shader, *left) || is_beside_one(shader, *right)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::messages;

    fn found(head: &str, body: &str) -> usize {
        let text = format!("{head}\nvarying vec3 c;\nvoid main() {{ {body} }}\n");
        messages("N040", "a.frag", &text).len()
    }

    #[test]
    fn numbers_that_are_zero_and_guard_a_divisor_are_found() {
        let mediump = "precision mediump float;\nconst float eps = 1e-6;";
        assert_eq!(found(mediump, "gl_FragColor = vec4(c.x / (6.0 * c.y + eps));"), 1);
        assert_eq!(found(mediump, "gl_FragColor = vec4(c.x / max(c.y, 1e-5));"), 1);
        assert_eq!(found(mediump, "gl_FragColor = vec4(c.x / (c.y + 1e-4));"), 0, "a number of its own");
        assert_eq!(found(mediump, "gl_FragColor = vec4(c.x / (1.0 - c.y + 1e-4));"), 1, "lost beside 1");
        assert_eq!(found(mediump, "gl_FragColor = vec4(c.x / (1.0 - c.y + 1e-3));"), 0);
        assert_eq!(found(mediump, "gl_FragColor = vec4(c.x / max(1e-4, 1.0 - c.y));"), 0, "the larger one");
        assert_eq!(found(mediump, "gl_FragColor = vec4(c.x + eps);"), 0, "no divisor");
    }

    #[test]
    fn highp_and_desktop_are_left_alone() {
        let body = "gl_FragColor = vec4(c.x / (c.y + 1e-6));";
        assert_eq!(found("precision highp float;", body), 0);
        assert_eq!(found("#version 120", body), 0);
    }
}
