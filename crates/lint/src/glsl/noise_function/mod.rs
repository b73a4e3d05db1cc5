//! V007: a built-in noise function is called.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::ast::{Callee, ExprKind};
use syntax::symbols::CallTarget;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V007"),
    name: "noise-function",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for (id, expr) in shader.arena().iter() {
        let ExprKind::Call { callee: Callee::Name(name), args: _ } = &expr.kind else { continue };
        let noise = matches!(name.name.as_str(), "noise1" | "noise2" | "noise3" | "noise4");
        if !noise || !matches!(shader.callee(id), Some(CallTarget::Builtin(_))) {
            continue;
        }
        let name_text = &name.name;
        findings.push(
            findings
                .at(
                    &file.file,
                    name.span,
                    message!("`{name_text}` gives 0 on most devices", "`{name_text}` は多くの機器で 0 を返します"),
                )
                .with_label(message!("built-in noise", "組み込みのノイズ"))
                .with_why(message!("no device has to implement it", "どの機器にも実装の義務がありません"))
                .with_help(message!(
                    "write a noise function, or look it up in a texture",
                    "ノイズ関数を書くか、テクスチャを引いてください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::strict_count;

    /// Findings of this rule at the strict level.
    fn count(name: &str, text: &str) -> usize {
        strict_count(super::RULE.code, name, text)
    }

    #[test]
    fn only_the_built_in_functions_count() {
        assert_eq!(
            count("a.frag", "#version 120\nvoid main() { gl_FragColor = noise4(1.0) + vec4(noise1(2.0)); }\n"),
            2
        );
        assert_eq!(
            count(
                "a.frag",
                "#version 150\nout vec4 c;\nfloat noise1(vec2 p) { return p.x; }\nvoid main() { c = vec4(noise1(vec2(1.0))); }\n"
            ),
            0
        );
    }
}
