//! V009: a `float` of a fragment shader of GLSL ES without a precision.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;

use super::compile::behind_directives;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V009"),
    name: "missing-precision-es",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a float of a GLSL ES fragment shader has no precision",
    page: Page {
        what: "Reports the first variable, parameter or return value of floats in a fragment shader of GLSL ES that has no precision of its own and no default precision above it.",
        why: "Fragment shaders of GLSL ES have no default precision of `float`: the shader does not compile.",
        bad: &[Example {
            name: "a.frag",
            text: "#version 300 es\nin vec3 normal;\nout vec4 color;\nvoid main(void)\n{\n  color = vec4(normal, 1.0);\n}\n",
        }],
        good: &[Example {
            name: "a.frag",
            text: "#version 300 es\nprecision mediump float;\nin vec3 normal;\nout vec4 color;\nvoid main(void)\n{\n  color = vec4(normal, 1.0);\n}\n",
        }],
        fix: "`precision mediump float;` is put behind the directives. Safe: the text did not compile, and every device has this precision.",
        references: &["GLSL ES 3.20 specification, section 4.7.4 \"Default Precision Qualifiers\""],
        ja: Japanese {
            summary: "GLSL ES のフラグメントシェーダの float に精度がありません",
            what: "GLSL ES のフラグメントシェーダで、自身の精度も既定の精度もない最初の浮動小数点の変数・引数・戻り値を報告します。",
            why: "GLSL ES のフラグメントシェーダの `float` には既定の精度がなく、コンパイルできません。",
            fix: "ディレクティブの後に `precision mediump float;` を書きます。元はコンパイルできず、この精度はどの機器にもあるので safe です。",
        },
    },
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
