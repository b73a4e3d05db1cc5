//! N025: a number that is added to all components of a position, `w` among them.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::types::Type;

use analysis::forms::{Forms, constructed, product};
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N025"),
    name: "scalar-added-to-position",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

/// True for a homogeneous position: `gl_Position`, and what a matrix makes of `vec4(…, 1.0)`.
fn is_position(shader: &Shader, forms: &Forms<'_>, id: ExprId) -> bool {
    let id = bare(shader, id);
    if *shader.type_of(id) != Type::VEC4 {
        return false;
    }
    match &shader.expr(id).kind {
        ExprKind::Name(name) if name == "gl_Position" => true,
        ExprKind::Field { base: _, field } if field.name == "gl_Position" => true,
        ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, op_span: _, left, right } => {
            is_position(shader, forms, *left) || is_position(shader, forms, *right)
        }
        _ => {
            let id = forms.value(id);
            let point = |v: ExprId| {
                let w = constructed(shader, forms.value(v), &Type::VEC4).and_then(|args| args.last().copied());
                w.is_some_and(|w| constant(shader, w) == Some(1.0)) || is_position(shader, forms, v)
            };
            product(shader, id).is_some_and(|(_, v)| point(v))
        }
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let sums: Vec<(ExprId, ExprId, ExprId)> = shader
        .arena()
        .iter()
        .filter_map(|(id, expr)| match expr.kind {
            ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, op_span: _, left, right } => Some((id, left, right)),
            ExprKind::Assign { op: Some(BinaryOp::Add | BinaryOp::Sub), op_span: _, target, value } => {
                Some((id, target, value))
            }
            _ => None,
        })
        .filter(|(_, left, right)| {
            let (left, right) = (shader.type_of(*left), shader.type_of(*right));
            (*left == Type::VEC4 && right.is_scalar()) || (left.is_scalar() && *right == Type::VEC4)
        })
        .collect();
    if sums.is_empty() {
        return;
    }
    let forms = Forms::new(shader);
    for (id, left, right) in sums {
        let (position, number) = if shader.type_of(left).is_scalar() { (right, left) } else { (left, right) };
        let zero = constant(shader, number) == Some(0.0);
        // Components that leave `w` out are as they were meant.
        let without_w = forms.parent(id).is_some_and(|p| match &shader.expr(p).kind {
            ExprKind::Field { base: _, field } => !field.name.contains(['w', 'q', 'a']),
            _ => constructed(shader, p, &Type::VEC3).is_some(),
        });
        if zero || without_w || !is_position(shader, &forms, position) {
            continue;
        }
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(number).span,
                    message!(
                        "this number is added to all components of a position, `w` among them",
                        "この数は位置の `w` を含む全成分に足されます"
                    ),
                )
                .with_label(message!("changes `w`", "`w` も変わります"))
                .with_why(message!(
                    "`x`, `y` and `z` are divided by `w` later, so that the point is moved and scaled",
                    "`x`、`y`、`z` は後で `w` で割られるので、点は動くだけでなく拡大縮小されます"
                ))
                .with_help(message!(
                    "add a vector with `w = 0`: `vec4(x, y, z, 0.0)`",
                    "`w = 0` のベクトル `vec4(x, y, z, 0.0)` を足してください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 150 core\nin vec4 place;\nuniform float s;\nuniform mat4 m;\nvoid main()\n{{\n  \
             gl_Position = m * vec4(place.xyz, 1.0);\n  {body}\n}}\n"
        );
        messages("N025", "a.vert", &text).len()
    }

    #[test]
    fn numbers_that_change_w_are_reported() {
        for body in [
            "gl_Position = gl_Position + s;",
            "gl_Position += s;",
            "gl_Position = m * vec4(place.xyz, 1.0) + vec4(s, 0.0, 0.0, 0.0) - s;",
            "vec4 p = m * vec4(place.xyz, 1.0); gl_Position = s + p;",
        ] {
            assert_eq!(count(body), 1, "{body}");
        }
    }

    #[test]
    fn others_are_not() {
        for body in [
            "gl_Position.xy += s;",
            "gl_Position.xyz = (gl_Position + s).xyz;",
            "gl_Position = gl_Position * s;",
            "gl_Position = gl_Position + vec4(s, s, s, 0.0);",
            "gl_Position = gl_Position + 0.0;",
            "gl_Position = place + s;",
        ] {
            assert_eq!(count(body), 0, "{body}");
        }
    }
}
