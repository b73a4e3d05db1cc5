//! N046: an index made of a number that reaches its end, where the array has no element any more.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::{Project, ShaderFile};
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::{CallTarget, SymbolId};
use syntax::types::{ArraySize, ScalarType, Type};
use syntax::walk;

use std::collections::HashMap;

use analysis::numeric::bare;
use analysis::range::{Evidence, Range};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N046"),
    name: "index-at-closed-end",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
};

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut known: Option<HashMap<SymbolId, ExprId>> = None;
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Index { base, index } = expr.kind else { continue };
        let Some(count) = elements(shader.type_of(base)) else { continue };
        let values = known.get_or_insert_with(|| walk::initial_values(shader));
        // Rounds of a loop and other whole numbers are compared with each other in ways that a range does not show.
        let Some(real) = converted(shader, values, index) else { continue };
        let observed = file.observed(project);
        let visits = observed.visits(id).iter().filter_map(|v| v.operands.first()?.parts.first());
        // The end itself, and not what lies far behind it: such an index is kept inside by other means.
        let at_end = |range: &&Range| range.goes_above(count - 1.0, Evidence::Nature) && range.hi < count + 1.0;
        if visits.clone().next().is_none() || visits.clone().find(at_end).is_none() {
            continue;
        }
        let (text, last) = (shader.text_of(real), count - 1.0);
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(index).span,
                    message!(
                        "this index can be {count}, and there are {count} elements",
                        "このインデックスは {count} になり得ますが、要素は {count} 個です"
                    ),
                )
                .with_label(message!("0 to {count}", "0 から {count} まで"))
                .with_why(message!(
                    "`{text}` reaches its greatest value, which is rounded to the element behind the last",
                    "`{text}` は最大値に達し、丸めると最後の要素の次を指します"
                ))
                .with_help(message!(
                    "bound the index itself: `min(…, {last})`",
                    "インデックス自体を制限してください: `min(…, {last})`"
                )),
        );
    }
}

/// The elements, columns or components of a type with a known number of them.
fn elements(ty: &Type) -> Option<f64> {
    match ty {
        Type::Array(_, ArraySize::Known(count)) => Some(f64::from(*count)),
        Type::Vector(_, count) | Type::Matrix(_, count, _) => Some(f64::from(*count)),
        _ => None,
    }
}

/// The real number of which an index is made, by a constructor, here or where a variable gets its one value.
fn converted(shader: &Shader, values: &HashMap<SymbolId, ExprId>, index: ExprId) -> Option<ExprId> {
    let index = bare(shader, index);
    if let Some(value) = shader.symbol_of(index).and_then(|symbol| values.get(&symbol)) {
        return converted(shader, values, *value);
    }
    let ExprKind::Call { args, .. } = &shader.expr(index).kind else { return None };
    let [real] = args.as_slice() else { return None };
    let whole =
        matches!(shader.callee(index), Some(CallTarget::Constructor(Type::Scalar(ScalarType::Int | ScalarType::Uint))));
    (whole && shader.type_of(*real).scalar().is_some_and(ScalarType::is_floating)).then_some(*real)
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn count(body: &str) -> usize {
        let text = format!(
            "#version 330 core\nuniform float t;\nuniform vec3 palette[8];\nout vec4 color;\nvoid main()\n{{\n  {body}\n}}\n"
        );
        messages("N046", "a.frag", &text).len()
    }

    #[test]
    fn an_index_that_reaches_the_number_of_elements_is_reported() {
        for body in [
            "color = vec4(palette[int(clamp(t, 0.0, 1.0) * 8.0)], 1.0);",
            "float share = min(max(t, 0.0), 1.0); int k = int(share * 8.0); color = vec4(palette[k], 1.0);",
            "color = vec4(palette[int((sin(t) * 0.5 + 0.5) * 8.0)], 1.0);",
            "color = vec4(0.0); color[int(clamp(t, 0.0, 4.0))] = 1.0;",
        ] {
            assert_eq!(count(body), 1, "{body}");
        }
    }

    #[test]
    fn others_are_not() {
        for body in [
            "color = vec4(palette[int(clamp(t, 0.0, 1.0) * 7.0)], 1.0);",
            "color = vec4(palette[min(int(clamp(t, 0.0, 1.0) * 8.0), 7)], 1.0);",
            "color = vec4(palette[int(fract(t) * 8.0)], 1.0);",
            "color = vec4(palette[int(t * 8.0)], 1.0);",
            "color = vec4(palette[int(mod(t, 8.0))], 1.0);",
            "color = vec4(palette[int(clamp(t, 0.0, 0.999) * 8.0)], 1.0);",
            "float share = clamp(t, 0.0, 1.0); if (share < 1.0) color = vec4(palette[int(share * 8.0)], 1.0);",
        ] {
            assert_eq!(count(body), 0, "{body}");
        }
    }
}
