//! P003: a scalar that is multiplied into a matrix before a vector.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::types::Type;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("P003"),
    name: "scalar-matrix-vector-order",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() {
        return;
    }
    let product = |id: ExprId| match shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } => Some((left, right)),
        _ => None,
    };
    for (id, expr) in shader.arena().iter() {
        let Some((left, vector)) = product(id) else { continue };
        let Some((first, second)) = product(left) else { continue };
        let (first_ty, second_ty) = (shader.type_of(first), shader.type_of(second));
        let scales = match (first_ty, second_ty) {
            (Type::Matrix(..), other) | (other, Type::Matrix(..)) => other.is_scalar(),
            _ => false,
        };
        let entries = shader.type_of(left).components().unwrap_or_default();
        let Type::Vector(_, components) = *shader.type_of(vector) else { continue };
        if !scales || entries <= usize::from(components) {
            continue;
        }
        let mut found = findings
            .at(
                &file.file,
                expr.span,
                message!(
                    "the scalar is multiplied into {entries} entries instead of {components}",
                    "スカラが {components} 成分ではなく {entries} 個の要素に掛けられています"
                ),
            )
            .with_label(message!("formed from the left", "左から計算される"))
            .with_why(message!(
                "a product is formed from the left, and the scalar meets the matrix first",
                "積は左から計算されるため、スカラがまず行列に掛けられます"
            ))
            .with_help(message!("scale the vector", "ベクトルの方に掛けてください"));
        let spans = [second, vector].map(|e| shader.expr(e));
        if !expr.from_macro && spans.iter().all(|e| !e.from_macro) {
            let edits = vec![Edit::insert(spans[0].span.start, "("), Edit::insert(spans[1].span.end, ")")];
            found = found.with_fix(
                message!("multiply the last two first", "後ろの 2 因子を先に掛ける"),
                Safety::Unsafe,
                edits,
            );
        }
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn scaled_matrices_are_reported() {
        let reported = |expr: &str| {
            let text = format!(
                "#version 150 core\nin vec4 v;\nuniform mat4 a;\nuniform float s;\nvoid main(void)\n{{\n  gl_Position = {expr};\n}}\n"
            );
            messages("P003", "a.vert", &text).len()
        };
        for expr in ["a * s * v", "s * a * v", "a * 2.0 * vec4(v.xyz, 1.0)"] {
            assert_eq!(reported(expr), 1, "{expr}");
        }
        for expr in ["a * (s * v)", "a * v * s", "s * (a * v)", "(a * s) * v", "a * v"] {
            assert_eq!(reported(expr), 0, "{expr}");
        }
    }
}
