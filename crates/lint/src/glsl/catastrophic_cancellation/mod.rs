//! N022: a difference of nearly equal numbers that a stable form avoids.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::{Observed, key};
use base::diagnostic::{Code, Message, Safety, Severity, message};
use base::text::Edit;
use reading::{Project, ShaderFile};
use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};

use analysis::numeric::{bare, calls, constant, in_place, is_plain, is_simple};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N022"),
    name: "catastrophic-cancellation",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

/// Below this, what is taken from 1 leaves enough digits.
const APART: f64 = 0.9;

/// A difference with its stable form, in words and, where it can be written, as text.
struct Found {
    place: ExprId,
    form: Message,
    text: Option<String>,
}

/// The operands of a difference.
fn difference(shader: &Shader, id: ExprId) -> Option<(ExprId, ExprId)> {
    match shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Sub, op_span: _, left, right } => Some((left, right)),
        _ => None,
    }
}

/// The factor of a square that is written as a product.
fn squared(shader: &Shader, id: ExprId) -> Option<ExprId> {
    let ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } = shader.expr(bare(shader, id)).kind else {
        return None;
    };
    let spelling = key(shader, left)?;
    (constant(shader, left).is_none() && key(shader, right) == Some(spelling)).then(|| bare(shader, left))
}

/// True when the right side of a difference is known to stay below 1.
fn apart(observed: &Observed, id: ExprId) -> bool {
    let mut all = observed.visits(id).iter().filter_map(|v| v.operands.get(1)).flat_map(|v| &v.parts).peekable();
    all.peek().is_some() && all.all(|r| r.hi < APART)
}

fn look(shader: &Shader, observed: &Observed, id: ExprId, roots: &[ExprId]) -> Option<Found> {
    let (left, right) = difference(shader, id)?;
    let simple = |e: ExprId| is_simple(shader, e).then(|| shader.text_of(e));
    if let (Some(a), Some(b)) = (squared(shader, left), squared(shader, right)) {
        let text = simple(a).zip(simple(b)).map(|(a, b)| in_place(shader, id, format!("({a} - {b}) * ({a} + {b})")));
        return Some(Found { place: id, form: message!("`(a - b) * (a + b)`", "`(a - b) * (a + b)`"), text });
    }
    if constant(shader, left) != Some(1.0) || apart(observed, id) {
        return None;
    }
    if let Some(x) = squared(shader, right) {
        if !roots.contains(&id) {
            return None;
        }
        let text = simple(x).map(|x| format!("(1.0 - {x}) * (1.0 + {x})"));
        return Some(Found { place: id, form: message!("`(1.0 - x) * (1.0 + x)`", "`(1.0 - x) * (1.0 + x)`"), text });
    }
    match &shader.expr(bare(shader, right)).kind {
        ExprKind::Call { callee: Callee::Name(name), args } if name.name == "cos" && args.len() == 1 => {
            let text = simple(bare(shader, args[0]))
                .map(|x| in_place(shader, id, format!("2.0 * sin(0.5 * {x}) * sin(0.5 * {x})")));
            let form = message!("`2.0 * sin(0.5 * x) * sin(0.5 * x)`", "`2.0 * sin(0.5 * x) * sin(0.5 * x)`");
            Some(Found { place: id, form, text })
        }
        _ => None,
    }
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    // A root whose argument may be negative is told as such.
    let inside = |id: ExprId| {
        let mut all = observed.visits(id).iter().filter_map(|v| v.operands.first()).flat_map(|v| &v.parts);
        all.all(|r| r.lo >= 0.0 || r.lo.is_infinite())
    };
    let roots: Vec<ExprId> = calls(shader, &["sqrt"])
        .filter(|c| inside(c.id))
        .filter_map(|c| Some(bare(shader, *c.args.first()?)))
        .collect();
    for (id, expr) in shader.arena().iter() {
        if shader.fold(id).is_some() {
            continue;
        }
        let Some(Found { place, form, text }) = look(shader, &observed, id, &roots) else { continue };
        let (en, ja) = (form.to_string(), form.in_lang(base::diagnostic::Lang::Ja).to_owned());
        let mut found = findings
            .at(
                &file.file,
                shader.expr(place).span,
                message!(
                    "this difference cancels where both sides are nearly equal",
                    "両辺がほぼ等しいところで桁落ちします"
                ),
            )
            .with_label(message!("loses digits", "桁が失われます"))
            .with_why(message!(
                "the rounding errors of both sides are left when the leading digits cancel",
                "上位の桁が打ち消し合うと、両辺の丸め誤差だけが残ります"
            ))
            .with_help(Message::new(format!("write {en}"), format!("{ja} と書いてください")));
        if let (Some(text), false) = (text, expr.from_macro)
            && is_plain(shader, &expr.children())
        {
            let edit = Edit::replace(expr.span, text);
            found = found.with_fix(message!("write the stable form", "安定な形で書く"), Safety::Unsafe, vec![edit]);
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{fixed, macro_has_no_fix, rings, silent};
    use super::*;

    #[test]
    fn differences_that_cancel_are_reported() {
        rings(
            "N022",
            Level::Strict,
            &[
                "r = 1.0 - cos(s);",
                "r = sqrt(1.0 - s * s);",
                "r = s * s - t * t;",
                "v = p * p - q * q;",
                "float c = clamp(s, 0.0, 1.0); r = sqrt(1.0 - c * c);",
            ],
        );
    }

    #[test]
    fn others_are_not() {
        silent(
            "N022",
            Level::Heuristic,
            &[
                "r = 1.0 - sin(s);",
                "r = 1.0 - s * s;",
                "r = s * s - 4.0 * t;",
                "float c = clamp(s, 0.0, 0.5); r = sqrt(1.0 - c * c);",
                "float a = clamp(s, 1.0, 3.0); r = 1.0 - cos(a);",
                "r = 2.0 - cos(s);",
                "r = s * t - t * s;",
            ],
        );
    }

    #[test]
    fn the_fix_is_the_stable_form() {
        assert_eq!(fixed("N022", "r = t * (1.0 - cos(s));"), "r = t * (2.0 * sin(0.5 * s) * sin(0.5 * s));");
        assert_eq!(fixed("N022", "r = sqrt(1.0 - s * s);"), "r = sqrt((1.0 - s) * (1.0 + s));");
        assert_eq!(fixed("N022", "r = p.x * p.x - p.y * p.y;"), "r = (p.x - p.y) * (p.x + p.y);");
        macro_has_no_fix("N022", "(1.0 - cos(a))");
    }
}
