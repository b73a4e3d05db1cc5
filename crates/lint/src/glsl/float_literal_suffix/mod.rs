//! T007: a suffix that the version of the language does not have.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::{Profile, TokenKind, TokenPlace};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T007"),
    name: "float-literal-suffix",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let version = file.shader.version();
    let old = if version.profile == Profile::Es { version.number < 300 } else { version.number < 120 };
    if !old || version.span.is_none() {
        return;
    }
    for token in file.shader.tokens() {
        let text = file.file.slice(token.span);
        let float = !text.starts_with("0x") && !text.starts_with("0X") && text.ends_with(['f', 'F']);
        if token.kind != TokenKind::Number || token.place == TokenPlace::Inactive || !float {
            continue;
        }
        let suffix = Span::new(token.span.end - 1, token.span.end);
        findings.push(
            findings
                .at(
                    &file.file,
                    token.span,
                    message!(
                        "`{text}` has a suffix that this version does not know",
                        "`{text}` の接尾辞はこの版にはありません"
                    ),
                )
                .with_label(message!("suffix", "接尾辞"))
                .with_why(message!(
                    "the suffix came with GLSL 1.20 and GLSL ES 3.00",
                    "この接尾辞は GLSL 1.20 と GLSL ES 3.00 で加わりました"
                ))
                .with_fix(message!("remove the suffix", "接尾辞を削除する"), Safety::Safe, vec![Edit::delete(suffix)]),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn only_old_versions_lack_the_suffix() {
        let reported = |version: &str, value: &str| {
            let text = format!(
                "{version}precision mediump float;\nvoid main(void)\n{{\n  gl_FragColor = vec4({value});\n}}\n"
            );
            messages("T007", "a.frag", &text).len()
        };
        assert_eq!(reported("#version 100\n", "1.0f"), 1);
        assert_eq!(reported("#version 110\n", ".5F"), 1);
        assert_eq!(reported("#version 120\n", "1.0f"), 0);
        assert_eq!(reported("", "1.0f"), 0);
        assert_eq!(reported("#version 110\n", "1.0"), 0);
    }
}
