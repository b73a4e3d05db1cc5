//! G007: an input of a geometry shader that is no array.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::ast::ExprKind;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G007"),
    name: "geom-input-not-array",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let name = file.file.slice(found.span).to_owned();
    let Some((id, _)) = shader.symbols().find(|(_, s)| s.span == Some(found.span)) else { return Some(found) };
    let indexed = shader.uses_of(id).all(|u| {
        shader.arena().iter().any(|(_, e)| matches!(&e.kind, ExprKind::Index { base, index: _ } if *base == u.expr))
    });
    let safety = if indexed { Safety::Safe } else { Safety::Unsafe };
    let edits = vec![Edit::insert(found.span.end, "[]")];
    Some(found.with_fix(message!("write `{name}[]`", "`{name}[]` と書く"), safety, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn brackets_are_added() {
        let text = |d: &str, u: &str| {
            format!(
                "#version 150\nlayout(points) in;\nlayout(points, max_vertices = 1) out;\nin vec3 {d};\nvoid main() {{ gl_Position = vec4({u}); EmitVertex(); }}\n"
            )
        };
        assert_eq!(lint("a.geom", &text("n", "n, 1.0")), (vec!["G007"], Some((Safety::Unsafe, text("n[]", "n, 1.0")))));
        assert_eq!(lint("a.geom", &text("n", "n[0]")).1.unwrap().0, Safety::Safe);
        assert!(!lint("a.geom", &text("n[]", "n[0], 1.0")).0.contains(&"G007"));
    }
}
