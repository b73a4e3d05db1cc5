//! V008: `##` or `#include`, which not every compiler has.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::TokenPlace;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V008"),
    name: "token-paste-or-include",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    for token in file.shader.tokens() {
        if token.place != TokenPlace::Directive || file.file.slice(token.span) != "##" {
            continue;
        }
        findings.push(
            findings
                .at(
                    &file.file,
                    token.span,
                    message!("not every compiler joins tokens with `##`", "`##` で語をつなげないコンパイラがあります"),
                )
                .with_label(message!("joins two tokens", "二つの語をつなぐ"))
                .with_why(message!("GLSL ES does not have it", "GLSL ES にはありません"))
                .with_help(message!("write the joined names out", "つないだ名前を書き下してください")),
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
    fn only_macros_that_are_compiled_count() {
        assert_eq!(
            count("a.vert", "#define A(x) a##x\nvoid main() { float A(1) = 1.0; gl_Position = vec4(a1); }\n"),
            1
        );
        assert_eq!(count("a.vert", "#if 0\n#define A(x) a##x\n#endif\nvoid main() { gl_Position = vec4(1.0); }\n"), 0);
    }
}
