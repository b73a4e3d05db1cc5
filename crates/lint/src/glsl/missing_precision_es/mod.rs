//! V009: a `float` of a fragment shader of GLSL ES without a precision.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;

use super::compile::behind_directives;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V009"),
    name: "missing-precision-es",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let edits = vec![Edit::insert(behind_directives(file), "precision mediump float;\n")];
    let title = message!("declare `precision mediump float;`", "`precision mediump float;` を宣言する");
    Some(found.with_fix(title, Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn the_precision_is_declared_behind_the_directives() {
        let text =
            |p: &str| format!("#version 300 es\n{p}out vec4 c;\nvoid main() {{ float x = 1.0; c = vec4(x); }}\n");
        assert_eq!(lint("a.frag", &text("")), (vec!["V009"], Some((Safety::Safe, text("precision mediump float;\n")))));
        assert!(lint("a.frag", &text("precision highp float;\n")).0.is_empty());
        assert!(
            !lint("a.vert", "#version 300 es\nvoid main() { float x = 1.0; gl_Position = vec4(x); }\n")
                .0
                .contains(&"V009")
        );
    }
}
