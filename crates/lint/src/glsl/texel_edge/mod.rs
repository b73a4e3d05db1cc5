//! N032: a texel that is looked up at its edge.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};
use syntax::symbols::CallTarget;
use syntax::types::{ScalarType, Type};

use analysis::forms::{Forms, builtin};
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N032"),
    name: "texel-edge",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

/// Functions that take coordinates from 0 to 1.
const LOOKUPS: [&str; 7] =
    ["texture", "textureLod", "texture2D", "texture1D", "texture2DLod", "texture2DLodEXT", "texture1DLod"];

/// True for a whole number that is made of an integer, as a float or vector of floats.
fn is_whole(shader: &Shader, forms: &Forms<'_>, id: ExprId) -> bool {
    let id = forms.value(id);
    let ty = shader.type_of(id);
    if ty.scalar().is_some_and(ScalarType::is_integer) {
        return constant(shader, id).is_none();
    }
    match (&shader.expr(id).kind, shader.callee(id)) {
        (ExprKind::Call { callee: Callee::Type(_), args }, Some(CallTarget::Constructor(_))) => {
            let whole = |a: &ExprId| shader.type_of(*a).scalar().is_some_and(ScalarType::is_integer);
            args.iter().all(whole) && args.iter().any(|a| constant(shader, *a).is_none())
        }
        _ => false,
    }
}

/// The quotient of a whole number, in coordinates or in a component of them.
fn edge(shader: &Shader, forms: &Forms<'_>, id: ExprId) -> Option<ExprId> {
    let id = forms.value(id);
    match &shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Div, op_span: _, left, right } => {
            let size = shader.type_of(*right).scalar().is_some_and(ScalarType::is_floating);
            (size && is_whole(shader, forms, *left)).then_some(id)
        }
        ExprKind::Call { callee: Callee::Type(_), args } if matches!(shader.type_of(id), Type::Vector(..)) => {
            args.iter().find_map(|a| edge(shader, forms, bare(shader, *a)))
        }
        _ => None,
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let lookups: Vec<ExprId> = shader
        .arena()
        .iter()
        .filter_map(|(id, _)| builtin(shader, id, &LOOKUPS).filter(|_| bare(shader, id) == id)?.1.get(1).copied())
        .collect();
    if lookups.is_empty() {
        return;
    }
    let forms = Forms::new(shader);
    for coordinates in lookups {
        let Some(quotient) = edge(shader, &forms, coordinates) else { continue };
        let text = shader.text_of(quotient);
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(coordinates).span,
                    message!(
                        "`{text}` is the edge of a texel, not its centre",
                        "`{text}` はテクセルの中心ではなく端です"
                    ),
                )
                .with_label(message!("between two texels", "2 つのテクセルの間"))
                .with_why(message!(
                    "at the edge, rounding decides which of two texels is read, and a filter mixes both",
                    "端では、どちらのテクセルが読まれるかが丸めで決まり、フィルタは両方を混ぜます"
                ))
                .with_help(message!(
                    "add half a texel: `(float(i) + 0.5) / size`; or read by index with `texelFetch`",
                    "半テクセルを足すか（`(float(i) + 0.5) / size`）、`texelFetch` で添字を使って読んでください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use super::*;

    #[test]
    fn edges_of_texels_are_reported() {
        rings(
            "N032",
            Level::Strict,
            &[
                "int i = int(s); v = texture(image, vec2(float(i) / 64.0, 0.5)).rgb;",
                "ivec2 i = ivec2(p.xy); v = texture(image, vec2(i) / t).rgb;",
                "int i = int(s); float u = float(i) / t; v = texture(image, vec2(u, 0.5)).rgb;",
            ],
        );
    }

    #[test]
    fn centres_and_offsets_are_not() {
        silent(
            "N032",
            Level::Heuristic,
            &[
                "int i = int(s); v = texture(image, vec2((float(i) + 0.5) / 64.0, 0.5)).rgb;",
                "int i = int(s); v = texture(image, p.xy + vec2(float(i), 0.0) / 64.0).rgb;",
                "int i = int(s); v = texelFetch(image, ivec2(i, 0), 0).rgb;",
                "v = texture(image, p.xy / s).rgb;",
            ],
        );
    }
}
