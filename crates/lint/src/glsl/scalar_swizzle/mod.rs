//! T008: a scalar is swizzled.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::ast::ExprKind;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T008"),
    name: "scalar-swizzle",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let swizzle = shader.arena().iter().find_map(|(id, e)| match &e.kind {
        ExprKind::Field { base, field } if field.span == found.span && !e.from_macro => Some((id, *base)),
        _ => None,
    });
    let Some((id, base)) = swizzle.filter(|s| !shader.expr(s.1).from_macro) else { return Some(found) };
    let (ty, span, inner) = (shader.type_of(id).to_string(), shader.expr(id).span, shader.expr(base).span);
    let edits = vec![Edit::insert(span.start, format!("{ty}(")), Edit::replace(Span::new(inner.end, span.end), ")")];
    Some(found.with_fix(message!("write `{ty}(…)`", "`{ty}(…)` と書く"), Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired_but_flow as lint;

    #[test]
    fn a_scalar_becomes_a_vector() {
        let shader =
            |v: &str, e: &str| format!("#version {v}\nuniform float f;\nvoid main() {{ gl_Position = {e}; }}\n");
        let (codes, fixed) = lint("a.vert", &shader("150", "(f * f).xxxx"));
        assert_eq!(
            (codes.as_slice(), fixed),
            (["T008"].as_slice(), Some((Safety::Safe, shader("150", "vec4((f * f))"))))
        );
        assert!(lint("a.vert", &shader("420", "f.xxxx")).0.is_empty());
        assert!(lint("a.vert", &shader("150", "vec4(f).xxxx")).0.is_empty());
    }
}
