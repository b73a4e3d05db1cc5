//! A statement dropped: an assignment of any kind, `EmitVertex()`, `EndPrimitive()`, the step of a
//! loop. A loop without its step may never end; runs of mutants bound the iterations of loops.

use crate::mutate::{Code, Draft};
use base::text::Edit;
use syntax::ast::ExprKind;
use syntax::ast::{Callee, UnaryOp};

pub(super) fn make(code: &Code<'_>, drafts: &mut Vec<Draft>) {
    for statement in &code.statements {
        let expr = code.shader.expr(statement.expr);
        let named = |wanted: &str| matches!(&expr.kind, ExprKind::Call { callee: Callee::Name(name), .. } if name.name == wanted);
        let changes = matches!(
            expr.kind,
            ExprKind::Assign { .. }
                | ExprKind::Postfix { .. }
                | ExprKind::Unary { op: UnaryOp::Increment | UnaryOp::Decrement, .. }
        );
        if !code.is_plain(statement.expr) || !(changes || named("EmitVertex") || named("EndPrimitive")) {
            continue;
        }
        // A lone `;` is a statement, so that a branch or loop does not take in the next one.
        let edit = Edit::replace(statement.span, if statement.step { "" } else { ";" });
        let mut draft = Draft::new(edit, format!("`{}` is dropped", code.shader.text_of(statement.expr)));
        if statement.last && named("EndPrimitive") {
            draft.identity = Some("the end of the shader ends the strip");
        }
        drafts.push(draft);
    }
}

#[cfg(test)]
mod tests {
    use crate::mutate::testing::{changes, geometry, identities};

    #[test]
    fn assignments_and_steps_are_dropped_and_declarations_stay() {
        let text = "float f(float a) {\n  float b = 1.0;\n  b += a;\n  if (a > 0.0)\n    b = a;\n  for (int i = 0; i < 3; ++i)\n    b++;\n  return b;\n}";
        assert_eq!(changes("drop-statement", text), [";", ";", "for (int i = 0; i < 3; )", ";"]);
    }

    #[test]
    fn emissions_are_dropped() {
        let text = geometry(
            "gl_Position = gl_in[0].gl_Position;\ngl_Position = 2.0 * gl_in[0].gl_Position;\nEmitVertex();\nEndPrimitive();",
        );
        assert_eq!(changes("drop-statement", &text), [";", ";", ";", ";"]);
        assert_eq!(identities("drop-statement", &text), 1);
    }
}
