//! N017: the cosine at a light that is a factor of a colour, also where the surface faces away.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::symbols::SymbolKind;
use syntax::words::words;

use analysis::forms::{Forms, builtin};
use analysis::names;
use analysis::numeric::{BuiltinCall, around, bare, calls};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N017"),
    name: "cosine-not-clamped",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// The name of the direction that an expression is, behind `normalize` and signs.
fn named(shader: &Shader, id: ExprId) -> Option<&str> {
    let id = bare(shader, id);
    if let ExprKind::Unary { op: UnaryOp::Minus, op_span: _, operand } = shader.expr(id).kind {
        return named(shader, operand);
    }
    match builtin(shader, id, &["normalize"]) {
        Some((_, [inner])) => named(shader, *inner),
        _ => names::of(shader, id),
    }
}

/// True for the scalar product of a normal and the direction to a light.
fn is_cosine_at_light(shader: &Shader, call: &BuiltinCall<'_>) -> bool {
    let [a, b] = call.args else { return false };
    let (Some(a), Some(b)) = (named(shader, *a), named(shader, *b)) else { return false };
    let is_light = |name: &str| {
        let words = words(name);
        words.iter().any(|w| w.starts_with("light") || w.starts_with("lamp") || w.starts_with("sun")) || name == "L"
    };
    let is_normal = |name: &str| names::is_normal(name) && !is_light(name);
    (is_normal(a) && is_light(b)) || (is_light(a) && is_normal(b))
}

/// True for a value that is a factor of a vector, as it is.
fn weighs(shader: &Shader, forms: &Forms<'_>, id: ExprId) -> bool {
    let Some(parent) = forms.parent(id) else { return false };
    match shader.expr(parent).kind {
        ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } => {
            let other = if bare(shader, left) == id { right } else { left };
            let ty = shader.type_of(other);
            // A scale of the normal, as in a reflection, may be negative.
            let geometric = named(shader, other).is_some_and(|n| names::is_direction(n) || n.len() == 1);
            if shader.type_of(parent).is_scalar() {
                weighs(shader, forms, parent)
            } else {
                !ty.is_scalar() && !geometric
            }
        }
        _ => false,
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let cosines: Vec<BuiltinCall<'_>> = calls(shader, &["dot"]).filter(|c| is_cosine_at_light(shader, c)).collect();
    if cosines.is_empty() {
        return;
    }
    let forms = Forms::new(shader);
    for call in cosines {
        // The product itself, or the variable that holds it and is used for nothing else.
        let mut all = shader.arena().iter().map(|(id, _)| id).filter(|id| {
            let local = shader.symbol_of(*id).is_some_and(|s| shader.symbol(s).kind == SymbolKind::Local);
            local && forms.value(*id) == call.id
        });
        let direct = weighs(shader, &forms, call.id);
        let held =
            all.next().is_some_and(|first| weighs(shader, &forms, first) && all.all(|id| weighs(shader, &forms, id)));
        if !direct && !held {
            continue;
        }
        let mut found = findings
            .at(
                &file.file,
                shader.expr(call.id).span,
                message!(
                    "this cosine is negative where the surface faces away from the light",
                    "この余弦は、面が光と反対を向くところで負になります"
                ),
            )
            .with_label(message!("weighs a colour as it is", "そのまま色の重みになっています"))
            .with_why(message!(
                "a negative weight takes light away that other terms add",
                "負の重みは、他の項が加えた光を差し引いてしまいます"
            ))
            .with_help(message!("cut it off at 0: `max(dot(n, l), 0.0)`", "0 で切ってください: `max(dot(n, l), 0.0)`"));
        if let Some(edits) = around(shader, call.id, call.id, "max(", ", 0.0)") {
            found = found.with_fix(message!("cut the cosine off at 0", "余弦を 0 で切る"), Safety::Unsafe, edits);
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{lint, shader};
    use super::*;

    fn count(body: &str) -> usize {
        lint("N017", Level::Strict, &shader("uniform vec3 lightDir;\nuniform vec3 paint;\nin vec3 normal;", body)).len()
    }

    #[test]
    fn cosines_that_weigh_colours_as_they_are_are_reported() {
        for body in [
            "v = dot(normal, lightDir) * paint;",
            "v = paint * s * dot(normalize(normal), normalize(-lightDir));",
            "float d = dot(lightDir, normal); v = d * paint + q;",
        ] {
            assert_eq!(count(body), 1, "{body}");
        }
    }

    #[test]
    fn others_are_not() {
        for body in [
            "v = max(dot(normal, lightDir), 0.0) * paint;",
            "float d = dot(lightDir, normal); v = clamp(d, 0.0, 1.0) * paint;",
            "float d = dot(lightDir, normal); if (d > 0.0) v = d * paint;",
            "float d = dot(lightDir, normal); d = max(d, 0.0); v = d * paint;",
            "v = 2.0 * dot(lightDir, normal) * normal - lightDir;",
            "v = paint * (0.5 * dot(lightDir, normal) + 0.5);",
            "v = dot(normal, q) * paint;",
        ] {
            assert_eq!(count(body), 0, "{body}");
        }
    }
}
