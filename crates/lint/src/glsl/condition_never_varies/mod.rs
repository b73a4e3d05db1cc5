//! T031: comparisons of one value that decide each other, and comparisons that what is compared decides.

mod masked;

use std::cmp::Ordering;
use std::collections::HashSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::key;
use base::diagnostic::{Code, Message, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::symbols::CallTarget;
use syntax::types::ScalarType;

use analysis::forms::builtin;
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T031"),
    name: "condition-never-varies",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// A comparison `value op bound`, with the value first.
struct Compared {
    value: String,
    op: BinaryOp,
    bound: Bound,
    /// True inside of `any`.
    any: bool,
}

/// What a value is compared with: a number, or a multiple of an unsigned expression.
enum Bound {
    Number(f64),
    Multiple(f64, String),
}

fn number(shader: &Shader, id: ExprId) -> Option<f64> {
    let id = bare(shader, id);
    if let Some(value) = constant(shader, id) {
        return Some(value);
    }
    // A vector of equal components.
    let (ExprKind::Call { callee: _, args }, Some(CallTarget::Constructor(_))) =
        (&shader.expr(id).kind, shader.callee(id))
    else {
        return None;
    };
    let first = number(shader, *args.first()?)?;
    args.iter().all(|a| number(shader, *a) == Some(first)).then_some(first)
}

fn bound(shader: &Shader, id: ExprId) -> Option<Bound> {
    if let Some(value) = number(shader, id) {
        return Some(Bound::Number(value));
    }
    let id = bare(shader, id);
    if shader.type_of(id).scalar() != Some(ScalarType::Uint) {
        return None;
    }
    if let ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } = shader.expr(id).kind {
        for (factor, other) in [(left, right), (right, left)] {
            if let Some(factor) = constant(shader, factor) {
                return Some(Bound::Multiple(factor, key(shader, other)?));
            }
        }
    }
    Some(Bound::Multiple(1.0, key(shader, id)?))
}

fn compared(shader: &Shader, id: ExprId) -> Option<Compared> {
    let mut id = bare(shader, id);
    let any = builtin(shader, id, &["any"]).and_then(|(_, args)| args.first().copied());
    id = any.map_or(id, |inner| bare(shader, inner));
    let ExprKind::Binary { op, op_span: _, left, right } = shader.expr(id).kind else { return None };
    let turned = match op {
        BinaryOp::Less => BinaryOp::Greater,
        BinaryOp::Greater => BinaryOp::Less,
        BinaryOp::LessEqual => BinaryOp::GreaterEqual,
        BinaryOp::GreaterEqual => BinaryOp::LessEqual,
        _ => return None,
    };
    let (value, op, limit) = match (number(shader, left), number(shader, right)) {
        (Some(_), None) => (right, turned, left),
        _ => (left, op, right),
    };
    let (value, bound) = (key(shader, bare(shader, value))?, bound(shader, limit)?);
    Some(Compared { value, op, bound, any: any.is_some() })
}

/// What a condition always is.
fn decided(shader: &Shader, id: ExprId) -> Option<bool> {
    let ExprKind::Binary { op, op_span: _, left, right } = shader.expr(id).kind else { return None };
    let (a, b) = (compared(shader, left)?, compared(shader, right)?);
    if a.value != b.value || a.any != b.any {
        return None;
    }
    let above = |c: &Compared| matches!(c.op, BinaryOp::Greater | BinaryOp::GreaterEqual);
    let closed = |c: &Compared| matches!(c.op, BinaryOp::LessEqual | BinaryOp::GreaterEqual);
    let (low, high) = match (above(&a), above(&b)) {
        (true, false) => (a, b),
        (false, true) => (b, a),
        _ => return None,
    };
    // How the lower bound stands to the upper one.
    let order = match (&low.bound, &high.bound) {
        (Bound::Number(l), Bound::Number(h)) => l.partial_cmp(h)?,
        (Bound::Multiple(l, of), Bound::Multiple(h, other)) if of == other => match l.partial_cmp(h)? {
            // Both are 0 where the number is.
            Ordering::Greater if !closed(&low) || !closed(&high) => Ordering::Greater,
            Ordering::Equal => Ordering::Equal,
            _ => return None,
        },
        _ => return None,
    };
    let touch = order == Ordering::Equal;
    match op {
        BinaryOp::Or if order == Ordering::Less || (touch && (closed(&low) || closed(&high))) => Some(true),
        BinaryOp::And if !low.any && (order == Ordering::Greater || (touch && !(closed(&low) && closed(&high)))) => {
            Some(false)
        }
        _ => None,
    }
}

/// True for `x <= c || c <= x`, which is false for NaN alone: whoever negates it asks for that.
fn is_number(shader: &Shader, id: ExprId) -> bool {
    let ExprKind::Binary { op: BinaryOp::Or, op_span: _, left, right } = shader.expr(id).kind else { return false };
    let (Some(a), Some(b)) = (compared(shader, left), compared(shader, right)) else { return false };
    matches!((a.bound, b.bound), (Bound::Number(a), Bound::Number(b)) if a == b)
}

/// What a comparison of an unsigned number with a written 0 always is.
fn of_unsigned(shader: &Shader, id: ExprId) -> Option<bool> {
    let ExprKind::Binary { op, op_span: _, left, right } = shader.expr(id).kind else { return None };
    let zero = |id: ExprId| {
        let expr = shader.expr(bare(shader, id));
        matches!(expr.kind, ExprKind::Literal(_)) && !expr.from_macro && constant(shader, id) == Some(0.0)
    };
    let unsigned = |id: ExprId| {
        // In a text that something else fills in, a literal may be what a name of the author stands for.
        shader.type_of(id).scalar() == Some(ScalarType::Uint) && shader.fold(id).is_none()
    };
    match op {
        BinaryOp::GreaterEqual if unsigned(left) && zero(right) => Some(true),
        BinaryOp::LessEqual if zero(left) && unsigned(right) => Some(true),
        BinaryOp::Less if unsigned(left) && zero(right) => Some(false),
        BinaryOp::Greater if zero(left) && unsigned(right) => Some(false),
        _ => None,
    }
}

/// Label, reason and help, in English and Japanese.
type Reason = [(&'static str, &'static str); 3];

const BOUNDS: Reason = [
    ("decided by the bounds", "境界だけで決まる"),
    (
        "the ranges that the two comparisons leave cover everything, or have nothing in common",
        "二つの比較の範囲を合わせると全体になるか、共通部分がありません",
    ),
    (
        "look at `&&` and `||`, `any` and `all`, and the order of the bounds",
        "`&&` と `||`、`any` と `all`、境界の順序を確かめてください",
    ),
];

const UNSIGNED: Reason = [
    ("an unsigned number is never below 0", "符号なしの数は 0 を下回らない"),
    (
        "what would be negative wraps to a large number, and passes the test",
        "負になるはずの値は大きな数に回り込み、この判定では分かりません",
    ),
    (
        "compare before subtracting (`a >= b` for `a - b >= 0`), or compute with signed numbers",
        "引く前に比べるか（`a - b >= 0` なら `a >= b`）、符号付きの数で計算してください",
    ),
];

const MASK: Reason = [
    ("the mask decides it", "マスクだけで決まる"),
    (
        "`&` leaves only bits of its mask, and `|` sets all of them: the constant has another bit",
        "`&` はマスクのビットだけを残し、`|` はマスクのビットを全て立てますが、定数はそれと異なるビットを持ちます",
    ),
    (
        "compare with a value that the mask leaves, such as the mask itself or 0",
        "マスク自身や 0 など、マスクを通した後に取りうる値と比べてください",
    ),
];

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let negated: HashSet<ExprId> = shader
        .arena()
        .iter()
        .filter_map(|(_, expr)| match expr.kind {
            ExprKind::Unary { op: UnaryOp::Not, operand, .. } => Some(bare(shader, operand)),
            _ => None,
        })
        .collect();
    for (id, expr) in shader.arena().iter() {
        if negated.contains(&id) && is_number(shader, id) {
            continue;
        }
        let by_mask = masked::decided(shader, id).map(|always| (always, MASK));
        let of_unsigned = || of_unsigned(shader, id).map(|always| (always, UNSIGNED));
        let by_bounds = || decided(shader, id).map(|always| (always, BOUNDS));
        let found = by_bounds().or_else(of_unsigned).or(by_mask).filter(|_| !expr.from_macro);
        let Some((always, reason)) = found else { continue };
        let message = if always {
            message!("this condition is always true", "この条件は常に真です")
        } else {
            message!("this condition is never true", "この条件は決して真になりません")
        };
        let [label, why, help] = reason.map(|(en, ja)| Message::new(en, ja));
        findings.push(findings.at(&file.file, expr.span, message).with_label(label).with_why(why).with_help(help));
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use crate::Level;

    #[test]
    fn bounds_that_decide_are_reported() {
        rings(
            "T031",
            Level::Default,
            &[
                "if (s >= 0.0 || s <= 1.0) r = 1.0;",
                "if (s > 1.0 && s < 0.0) r = 1.0;",
                "if (0.0 < s || 1.0 > s) r = 1.0;",
                "if (s <= 0.0 || 0.0 <= s) r = 1.0;",
                "if (!(s >= 0.0 || s <= 1.0)) r = 1.0;",
            ],
        );
        let wgsl = |line: &str| {
            crate::wgsl::testing::count("T031", &format!("fn f(v: vec2f, i: u32, n: u32) -> bool {{ return {line}; }}"))
        };
        assert_eq!(wgsl("any(v >= vec2f(0.0)) || any(v <= vec2f(1.0))"), 1);
        assert_eq!(wgsl("i >= 4 * n && i < n"), 1);
        assert_eq!(wgsl("i - n >= 0"), 1, "unsigned");
        assert_eq!(wgsl("i - n < 0u"), 1);
        assert_eq!(wgsl("i32(i) - i32(n) >= 0"), 0);
        assert_eq!(wgsl("i > 0u"), 0);
        assert_eq!(wgsl("i >= n && i < 4 * n"), 0);
        assert_eq!(wgsl("all(v >= vec2f(0.0)) && all(v <= vec2f(1.0))"), 0);
        assert_eq!(wgsl("any(v < vec2f(0.0)) || any(v > vec2f(1.0))"), 0);
    }

    #[test]
    fn a_mask_that_decides_is_reported() {
        let glsl = |line: &str| {
            let text = format!(
                "#version 450\nlayout(constant_id = 0) const uint SPEC = 2u;\nconst uint FOLLOWS = SPEC + 1u;\nconst uint BIT = 4u;\n\
                 layout(location = 0) flat in uint m;\nlayout(location = 1) flat in int i;\n\
                 layout(location = 0) out vec4 c;\nvoid main() {{ c = vec4({line} ? 1.0 : 0.0); }}\n"
            );
            let found = crate::run(&[crate::Input::new(base::text::SourceFile::new("a.frag", text))]);
            found.iter().filter(|d| d.code.0 == "T031").count()
        };
        let wgsl = |line: &str| {
            let text = format!(
                "override SPEC = 2u;\noverride FOLLOWS = SPEC + 1u;\nconst BIT = 4u;\nfn f(m: u32, i: i32) -> bool {{ return {line}; }}"
            );
            crate::wgsl::testing::count("T031", &text)
        };
        for count in [&glsl as &dyn Fn(&str) -> usize, &wgsl] {
            let wrong = [
                "(m & 4u) != 1u",
                "(i & 2) == 1",
                "1 == (2 & i)",
                "(m & BIT) == 2u",
                "(m | 4u) == 3u",
                "(i & 1) == -1",
                "(m & BIT) == BIT + 1u",
            ];
            wrong.iter().for_each(|line| assert_eq!(count(line), 1, "{line}"));
            let right = [
                "(m & 4u) == 4u",
                "(i & 5) != 1",
                "(m & 4u) != 0u",
                "(i & -2) == -4",
                "(m | 4u) == 7u",
                "(m & SPEC) == 1u",
                "(m & FOLLOWS) == 4u",
                "(m & (BIT - 4u)) == 1u",
                "(m ^ 4u) == 1u",
                "(m & 6u) >= 1u",
            ];
            right.iter().for_each(|line| assert_eq!(count(line), 0, "{line}"));
        }
    }

    #[test]
    fn ranges_are_not() {
        silent(
            "T031",
            Level::Heuristic,
            &[
                "if (s >= 0.0 && s <= 1.0) r = 1.0;",
                "if (s < 0.0 || s > 1.0) r = 1.0;",
                "if (s >= 1.0 && s <= 1.0) r = 1.0;",
                "if (s > 0.0 || t < 1.0) r = 1.0;",
                // False for NaN alone, which is what is asked.
                "if (!(s <= 0.0 || 0.0 <= s)) r = 1.0;",
            ],
        );
    }
}
