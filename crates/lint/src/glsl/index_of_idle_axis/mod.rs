//! K006: an index that a guard holds at 0.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{bounds, kernels, plain};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{Callee, ExprId, ExprKind};
use syntax::types::{ArraySize, Type};

use analysis::forms::Forms;
use analysis::numeric::bare;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K006"),
    name: "index-of-idle-axis",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// An array of runtime length with its index: `data[i]`, and `load(data, i)` by a macro of the host.
fn indexed(shader: &Shader, id: ExprId) -> Option<(ExprId, ExprId)> {
    let (array, index) = match &shader.expr(id).kind {
        ExprKind::Index { base, index } => (*base, *index),
        ExprKind::Call { callee: Callee::Name(_), args } if shader.callee(id).is_none() => match args.as_slice() {
            [array, index, ..] => (*array, *index),
            _ => return None,
        },
        _ => return None,
    };
    matches!(shader.type_of(array), Type::Array(_, ArraySize::Unsized)).then_some((array, index))
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let kernels = kernels(shader);
    if kernels.is_empty() {
        return;
    }
    // `if (z >= 1) return;`
    let idle: Vec<_> =
        bounds(shader).into_iter().filter(|b| b.below.factors.is_empty() && b.below.times <= 1.0).collect();
    if idle.is_empty() {
        return;
    }
    let forms = Forms::new(shader);
    let mut told = BTreeSet::new();
    for (id, expr) in shader.arena().iter() {
        let Some((array, index)) = indexed(shader, id) else { continue };
        let variable = plain(shader, index);
        let text = shader.text_of(variable);
        let guard = idle.iter().find(|b| b.of.text == text && b.within.contains(expr.span.start));
        let value = plain(shader, forms.value(variable));
        let number = kernels.iter().any(|kernel| {
            kernel.axis_of(shader, value, "global_invocation_id", "gl_GlobalInvocationID").is_some()
                || kernel.axis_of(shader, value, "workgroup_id", "gl_WorkGroupID").is_some()
        });
        let Some(guard) = guard.filter(|_| number && !expr.from_macro) else { continue };
        if !told.insert((shader.text_of(array), text)) {
            continue;
        }
        let name = shader.text_of(bare(shader, array));
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(index).span,
                    message!(
                        "`{text}` is 0 here in every invocation: all of them get to one element of `{name}`",
                        "`{text}` はここでは常に 0 で、すべてのインベケーションが `{name}` の同じ要素に触れます"
                    ),
                )
                .with_related(
                    &file.file,
                    shader.expr(guard.condition).span,
                    message!("what holds `{text}` at 0", "`{text}` を 0 に限る条件"),
                )
                .with_why(message!(
                    "an index is written to tell elements apart, and this one does not",
                    "添字は要素を区別するためのものですが、これは区別しません"
                ))
                .with_help(message!(
                    "index by the axis that varies, or write 0",
                    "変化する軸を使うか、0 と書いてください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::default_count;
    use super::*;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 450\nlayout(local_size_x = 8) in;\nlayout(std430, binding = 0) buffer D {{ float data[]; }};\n\
             layout(std430, binding = 1) readonly buffer B {{ float bias[]; }};\n\
             void main()\n{{\n int x = int(gl_GlobalInvocationID.x);\n int z = int(gl_GlobalInvocationID.z);\n {body}\n}}\n"
        );
        default_count(RULE.code, "a.comp", &text)
    }

    #[test]
    fn indices_that_are_0_are_reported() {
        assert_eq!(count("if (x >= 99 || z >= 1) return; data[x] = bias[z];"), 1);
        assert_eq!(count("if (x < 99 && z < 1) data[x] = bias[z];"), 1);
    }

    #[test]
    fn others_are_not() {
        assert_eq!(count("if (x >= 99 || z >= 1) return; data[x] = bias[x];"), 0);
        assert_eq!(count("if (x >= 99 || z >= 2) return; data[x] = bias[z];"), 0);
        assert_eq!(count("if (x >= 99 || z >= 1) return; data[z * 99 + x] = bias[0];"), 0);
        assert_eq!(count("if (x < 99 && z < 1) data[x] = 1.0; data[x] = bias[z];"), 0);
    }
}
