//! V008: `##` or `#include`, which not every compiler has.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::TokenPlace;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V008"),
    name: "token-paste-or-include",
    severity: Severity::Warning,
    level: Level::Strict,
    summary: "## is used in a macro, which not every compiler has",
    page: Page {
        what: "Reports `##` in macros. `#include` is an error of the front end already.",
        why: "Desktop GLSL has `##` by custom rather than by specification, and GLSL ES does not have it: some compilers refuse it.",
        bad: &[Example {
            name: "a.vert",
            text: "#version 150 core\n#define LIGHT(i) light##i\nuniform vec4 light0;\nvoid main(void)\n{\n  gl_Position = LIGHT(0);\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 150 core\nuniform vec4 light0;\nvoid main(void)\n{\n  gl_Position = light0;\n}\n",
        }],
        fix: "There is no fix: the joined names must be written out.",
        references: &["GLSL 4.60 specification, section 3.3 \"Preprocessor\""],
        ja: Japanese {
            summary: "全てのコンパイラにはない ## を使っています",
            what: "マクロの中の `##` を報告します。`#include` は構文の誤りとして別に報告されます。",
            why: "`##` はデスクトップ版では慣習に近く、GLSL ES にはないため、受け付けないコンパイラがあります。",
            fix: "つないだ名前を書き下す必要があり、自動修正はありません（no fix）。",
        },
    },
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
