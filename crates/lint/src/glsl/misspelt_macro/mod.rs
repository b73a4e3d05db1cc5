//! V012: a name that is nearly one of the language's own macros, which no compiler defines.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::TokenKind;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V012"),
    name: "misspelt-macro",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

/// Long names that compilers define, which nothing else looks like.
const KNOWN: [&str; 4] = ["GL_FRAGMENT_PRECISION_HIGH", "GL_core_profile", "GL_compatibility_profile", "GL_es_profile"];

/// Characters that may differ.
const SLIPS: usize = 3;

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for token in shader.tokens().iter().filter(|token| token.kind == TokenKind::Word) {
        let name = file.file.slice(token.span);
        if !name.starts_with("GL_") {
            continue;
        }
        let Some(meant) = KNOWN.into_iter().find(|known| *known != name && apart(name, known) <= SLIPS) else {
            continue;
        };
        findings.push(
            findings
                .at(
                    &file.file,
                    token.span,
                    message!("no compiler defines `{name}`", "`{name}` を定義するコンパイラはありません"),
                )
                .with_label(message!("`{meant}` is meant", "`{meant}` の誤りです"))
                .with_why(message!(
                    "what it asks is never true, so that the other branch is taken everywhere",
                    "条件が真になることはなく、どこでも他方の分岐が選ばれます"
                ))
                .with_help(message!("write `{meant}`", "`{meant}` と書いてください"))
                .with_fix(
                    message!("write `{meant}`", "`{meant}` と書く"),
                    Safety::Unsafe,
                    vec![Edit::replace(token.span, meant)],
                ),
        );
    }
}

/// How many characters have to be put in, left out or replaced to make one of the other.
fn apart(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut before = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = before + usize::from(x != *y);
            before = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(before + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::{messages, repaired};

    fn text(name: &str) -> String {
        format!(
            "#ifdef {name}\nprecision highp float;\n#else\nprecision mediump float;\n#endif\n\
             void main() {{ gl_FragColor = vec4(1.0); }}\n"
        )
    }

    #[test]
    fn a_slip_in_a_macro_of_the_language_is_found_and_repaired() {
        let right = text("GL_FRAGMENT_PRECISION_HIGH");
        for wrong in ["GL_FRAGMENT_PRESICISON_HIGH", "GL_FRAGMENT_PRECISON_HIGH"] {
            assert_eq!(repaired("a.frag", &text(wrong)), (vec!["V012"], Some((Safety::Unsafe, right.clone()))));
        }
        assert!(repaired("a.frag", &right).0.is_empty());
    }

    #[test]
    fn other_macros_are_left_alone() {
        for name in
            ["GL_ES", "GL_OES_standard_derivatives", "GL_FRAGMENT_SHADER", "HIGH_PRECISION", "GL_VERTEX_PRECISION"]
        {
            assert_eq!(messages("V012", "a.frag", &text(name)).len(), 0, "{name}");
        }
    }
}
