//! V009: a `float` of a fragment shader of GLSL ES, or a sampler in any stage, without a precision.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::types::OpaqueType;

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
    // A sampler has the name of its type; vectors and matrices are made of `float`.
    let name = found.file.slice(found.span);
    let ty = if OpaqueType::from_name(name).is_some() { name } else { "float" };
    let edits = vec![Edit::insert(behind_directives(file), format!("precision mediump {ty};\n"))];
    let title = message!("declare `precision mediump {ty};`", "`precision mediump {ty};` を宣言する");
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
        let sampler = |p: &str, ty: &str| {
            format!("#version 300 es\n{p}uniform {ty} t;\nvoid main() {{ gl_Position = texture(t, vec3(1.0)); }}\n")
        };
        let fixed = sampler("precision mediump sampler3D;\n", "sampler3D");
        assert_eq!(lint("a.vert", &sampler("", "sampler3D")), (vec!["V009"], Some((Safety::Safe, fixed))));
        for (p, ty) in [("", "samplerCube"), ("", "highp sampler3D"), ("precision lowp sampler3D;\n", "sampler3D")] {
            assert!(lint("a.vert", &sampler(p, ty)).0.is_empty(), "{p}{ty}");
        }
        assert!(
            !lint("a.vert", "#version 300 es\nvoid main() { float x = 1.0; gl_Position = vec4(x); }\n")
                .0
                .contains(&"V009")
        );
    }
}
