//! N023: a test for NaN or infinity that a compiler may leave out.

mod cut;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::key;
use base::diagnostic::{Code, Message, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};

use analysis::forms::builtin;
use analysis::numeric::bare;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N023"),
    name: "nan-test-removed",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Less, equal, greater: what two numbers can be to each other.
const ALL: u8 = 0b111;

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut found: Vec<(ExprId, Message)> = Vec::new();
    for (id, expr) in shader.arena().iter() {
        if matches!(expr.kind, ExprKind::Paren(_)) {
            continue;
        }
        found.extend(tested(shader, id).map(|what| (id, what)));
    }
    // The whole says it for its parts.
    let spans: Vec<_> = found.iter().map(|(id, _)| shader.expr(*id).span).collect();
    let inside = |id: &ExprId| {
        let span = shader.expr(*id).span;
        spans.iter().any(|of| *of != span && of.start <= span.start && span.end <= of.end)
    };
    let (bits, ja) = match shader.wgsl() {
        Some(_) => (
            "bitcast<u32>(x) & 0x7fffffffu",
            "ビットで調べてください: NaN なら `(bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u`",
        ),
        None => (
            "floatBitsToUint(x) & 0x7fffffffu",
            "ビットで調べてください: NaN なら `(floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u`",
        ),
    };
    for (id, _) in shader.arena().iter() {
        let Some(what) = cut::relied_on(shader, id).filter(|_| !matches!(shader.expr(id).kind, ExprKind::Paren(_)))
        else {
            continue;
        };
        let found = findings
            .at(&file.file, shader.expr(id).span, what)
            .with_label(message!(
                "relies on which operand is given for NaN",
                "NaN のときどちらの引数が返るかに頼っています"
            ))
            .with_why(why_cut(shader))
            .with_help(message!(
                "keep the argument of the function in its domain, such as `sqrt(max(x, 0.0))`",
                "`sqrt(max(x, 0.0))` のように、関数の引数を定義域に収めてください"
            ));
        findings.push(found);
    }
    for (id, what) in found.iter().filter(|(id, _)| !inside(id)) {
        findings.push(
            findings
                .at(&file.file, shader.expr(*id).span, what.clone())
                .with_label(message!("may be left out", "省かれることがあります"))
                .with_why(why(shader))
                .with_help(Message::new(
                    format!("test the bits, `({bits}) > 0x7f800000u` for NaN, or keep the value from arising"),
                    format!("{ja}。または、値が生じないようにしてください"),
                )),
        );
    }
}

fn why(shader: &Shader) -> Message {
    if shader.wgsl().is_some() {
        message!(
            "WGSL lets an implementation assume that there is no NaN and no infinity",
            "WGSL の処理系は NaN も無限大もないものと仮定できます"
        )
    } else {
        message!(
            "GLSL does not require NaN to be generated or kept, and `precise` does not change that: a compiler may take the \
             answer for known",
            "GLSL は NaN の生成も保持も要求せず、`precise` でも変わりません。コンパイラは答えを既知とみなせます"
        )
    }
}

fn why_cut(shader: &Shader) -> Message {
    if shader.wgsl().is_some() {
        message!(
            "WGSL lets an implementation assume that there is no NaN, and give either operand where one is",
            "WGSL の処理系は NaN がないものと仮定でき、NaN のときはどちらの引数を返してもかまいません"
        )
    } else {
        message!(
            "GLSL leaves the result of `min`, `max` and `clamp` undefined where an operand is NaN: devices give either",
            "GLSL では引数が NaN のときの `min`、`max`、`clamp` の結果は未定義で、装置によって異なります"
        )
    }
}

/// What is tested, where it is NaN or infinity.
fn tested(shader: &Shader, id: ExprId) -> Option<Message> {
    if let Some((name, _)) = builtin(shader, id, &["isnan", "isinf"]) {
        return Some(message!("`{name}` may always be false", "`{name}` は常に偽かもしれません"));
    }
    match &shader.expr(id).kind {
        ExprKind::Binary { op, left, right, .. } => match op {
            BinaryOp::Equal | BinaryOp::NotEqual => itself(shader, id, *op, [*left, *right]),
            BinaryOp::Or | BinaryOp::And => every_order(shader, id, *op),
            _ => None,
        },
        _ => None,
    }
}

/// A comparison whose answer is known of all numbers: `x != x`, `x * 0.0 == 0.0`.
fn itself(shader: &Shader, id: ExprId, op: BinaryOp, sides: [ExprId; 2]) -> Option<Message> {
    let floating = |id: ExprId| shader.type_of(id).scalar().is_some_and(|scalar| scalar.is_floating());
    let [left, right] = sides.map(|side| bare(shader, side));
    let known = || sides.iter().any(|side| shader.fold(*side).is_some());
    let same = key(shader, left).is_some_and(|key_of| Some(key_of) == key(shader, right)) && !known();
    let nothing = |product: ExprId, other: ExprId| is_zero(shader, other) && is_product_with_zero(shader, product);
    if !floating(left) || !(same || nothing(left, right) || nothing(right, left)) {
        return None;
    }
    let (text, always) = (shader.text_of(id), op == BinaryOp::Equal);
    Some(match always {
        true => message!("`{text}` may always be true", "`{text}` は常に真かもしれません"),
        false => message!("`{text}` may always be false", "`{text}` は常に偽かもしれません"),
    })
}

fn is_zero(shader: &Shader, id: ExprId) -> bool {
    shader.fold(id).and_then(syntax::Const::as_f64) == Some(0.0)
}

fn is_product_with_zero(shader: &Shader, id: ExprId) -> bool {
    match shader.expr(bare(shader, id)).kind {
        ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } => {
            is_zero(shader, left) != is_zero(shader, right) && shader.fold(id).is_none()
        }
        _ => false,
    }
}

/// `x < y || x > y || x == y`, and the conjunction of the negated: known of all numbers.
fn every_order(shader: &Shader, id: ExprId, op: BinaryOp) -> Option<Message> {
    let mut parts = Vec::new();
    gather(shader, id, op, &mut parts);
    let mut pair = None;
    let mut covered = 0;
    for part in parts {
        let comparison = match (op, &shader.expr(part).kind) {
            (BinaryOp::Or, _) => part,
            (_, ExprKind::Unary { op: UnaryOp::Not, operand, .. }) => bare(shader, *operand),
            _ => return None,
        };
        let (sides, order) = compared(shader, comparison)?;
        match &pair {
            None => pair = Some(sides),
            Some(before) if *before == sides => {}
            Some(_) => return None,
        }
        covered |= order;
    }
    let text = shader.text_of(id);
    (covered == ALL).then(|| match op {
        BinaryOp::Or => message!("`{text}` may always be true", "`{text}` は常に真かもしれません"),
        _ => message!("`{text}` may always be false", "`{text}` は常に偽かもしれません"),
    })
}

fn gather(shader: &Shader, id: ExprId, op: BinaryOp, into: &mut Vec<ExprId>) {
    let id = bare(shader, id);
    match &shader.expr(id).kind {
        ExprKind::Binary { op: own, left, right, .. } if *own == op => {
            gather(shader, *left, op, into);
            gather(shader, *right, op, into);
        }
        _ => into.push(id),
    }
}

/// The two numbers that are compared, in one order, and what they may be to each other.
fn compared(shader: &Shader, id: ExprId) -> Option<([String; 2], u8)> {
    let ExprKind::Binary { op, left, right, .. } = &shader.expr(id).kind else { return None };
    let order: u8 = match op {
        BinaryOp::Less => 0b100,
        BinaryOp::Equal => 0b010,
        BinaryOp::Greater => 0b001,
        BinaryOp::LessEqual => 0b110,
        BinaryOp::GreaterEqual => 0b011,
        BinaryOp::NotEqual => 0b101,
        _ => return None,
    };
    if !shader.type_of(*left).scalar().is_some_and(|scalar| scalar.is_floating()) {
        return None;
    }
    let spelled = |side: ExprId| {
        let side = bare(shader, side);
        shader
            .fold(side)
            .and_then(syntax::Const::as_f64)
            .map(|value| format!("{value:?}"))
            .or_else(|| key(shader, side))
    };
    let [a, b] = [spelled(*left)?, spelled(*right)?];
    let swapped = order >> 2 | order & 0b010 | (order & 1) << 2;
    Some(if a <= b { ([a, b], order) } else { ([b, a], swapped) })
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use crate::Level;
    use crate::glsl::testing::strict_count;

    #[test]
    fn tests_that_no_number_passes_are_found() {
        rings(
            "N023",
            Level::Strict,
            &[
                "if (s != s) r = 1.0;",
                "if (!(s == s)) r = 1.0;",
                "if (isnan(s)) r = 1.0;",
                "if (any(isinf(p))) r = 1.0;",
                "if (!(s < 0.0 || s > 0.0 || s == 0.0)) r = 1.0;",
                "if (!(s < 0.0 || 0.0 < s || s == 0.0)) r = 1.0;",
                "if (!(s <= t || s >= t)) r = 1.0;",
                "if (!(s < 0.0) && !(s > 0.0) && !(s == 0.0)) r = 1.0;",
                "r = s * 0.0 == 0.0 ? s : 0.0;",
            ],
        );
    }

    #[test]
    fn tests_that_tell_numbers_apart_are_not() {
        silent(
            "N023",
            Level::Heuristic,
            &[
                "if (s != t) r = 1.0;",
                "int i = int(s); if (i != i) r = 1.0;",
                "if (s < 0.0 || s > 0.0) r = 1.0;",
                "if (s < 0.0 || t > 0.0 || s == 0.0) r = 1.0;",
                "if (!(s < 0.0) && !(s > 1.0)) r = 1.0;",
                "if ((floatBitsToUint(s) & 0x7fffffffu) > 0x7f800000u) r = 1.0;",
                "r = s * t == 0.0 ? s : 0.0;",
            ],
        );
    }

    #[test]
    fn what_only_nan_is_cut_by_is_found() {
        rings(
            "N023",
            Level::Strict,
            &[
                "r = max(sqrt(s), 0.0);",
                "r = max(0.0, inversesqrt(s));",
                "r = clamp(acos(s), 0.0, 3.14159265);",
                "r = max(pow(s, t), 0.0);",
                "v = clamp(normalize(p), -1.0, 1.0);",
                "v = max(sqrt(p), vec3(0.0));",
                "r = min(s / t, 3.4e38);",
            ],
        );
        silent(
            "N023",
            Level::Heuristic,
            &[
                "r = max(sqrt(s), 0.1);",
                "r = sqrt(max(s, 0.0));",
                "r = max(sqrt(max(s, 0.0)), 0.0);",
                "r = max(dot(p, q), 0.0);",
                "r = clamp(acos(s), 0.0, 1.0);",
                "r = max(s, 0.0);",
                "r = clamp(log(s), 0.0, 3.4e38);",
                "r = max(sqrt(dot(p, p)), 0.0);",
                "r = min(sqrt(s), 1.0);",
            ],
        );
    }

    #[test]
    fn wgsl_is_read_too() {
        let cut = "fn f(x: f32) -> f32 { return max(inverseSqrt(x), 0.0); }\n";
        assert_eq!(strict_count(super::RULE.code, "a.wgsl", cut), 1);
        let text = "fn is_nan(x: f32) -> bool { return x != x; }\n";
        assert_eq!(strict_count(super::RULE.code, "a.wgsl", text), 1);
        let bits = "fn is_nan(x: f32) -> bool { return (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u; }\n";
        assert_eq!(strict_count(super::RULE.code, "a.wgsl", bits), 0);
    }
}
