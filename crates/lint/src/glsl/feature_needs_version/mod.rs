//! V002: something that came with a later version.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::{Edit, Span};
use syntax::Profile;

use super::compile::explained;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V002"),
    name: "feature-needs-version",
    severity: Severity::Error,
    level: Level::Default,
    summary: "something is used that came with a later version of the language",
    page: Page {
        what: "Reports words, functions, types, operators and qualifiers that the declared version does not have and that no enabled extension brings. When an extension is enabled that is not known here, nothing is reported, because it may bring anything.",
        why: "Strict compilers refuse the shader; others take it, so that it works on one machine only.",
        bad: &[Example {
            name: "a.vert",
            text: "#version 150 core\nlayout(location = 0) in vec4 position;\nvoid main(void)\n{\n  gl_Position = position;\n}\n",
        }],
        good: &[Example {
            name: "a.vert",
            text: "#version 330 core\nlayout(location = 0) in vec4 position;\nvoid main(void)\n{\n  gl_Position = position;\n}\n",
        }],
        fix: "The number of `#version` is raised to the one that is needed. Unsafe: the context must offer that version, and it may change other things.",
        references: &["GLSL 1.10 to 4.60 and GLSL ES 1.00 to 3.20 specifications, section 1.2 \"Changes\""],
        ja: Japanese {
            summary: "後のバージョンの機能を使っています",
            what: "宣言したバージョンになく、有効な拡張もない語・関数・型・演算子・修飾子を報告します。未知の拡張が有効なときは、何が増えるか分からないので報告しません。",
            why: "厳密なコンパイラは拒否し、他は受け付けるため、特定の環境だけで動くことになります。",
            fix: "`#version` の番号を必要なものに上げます。コンテキストがそのバージョンに対応している必要があり、他の意味も変わり得るので unsafe です。",
        },
    },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let found = explained(
        found,
        message!("the declared version does not have it", "宣言されたバージョンにはありません"),
        message!("declare a later version", "より新しいバージョンを宣言してください"),
    );
    let version = file.shader.version();
    let Some(span) = version.span.filter(|_| version.profile != Profile::Es) else { return Some(found) };
    let Some(wanted) = needed(&found.message) else { return Some(found) };
    let text = file.file.slice(span);
    let old = version.number.to_string();
    let Some(at) = text.find(&old) else { return Some(found) };
    let number = Span::new(span.start + at, span.start + at + old.len());
    let edits = vec![Edit::replace(number, wanted.to_string())];
    Some(found.with_fix(message!("declare version {wanted}", "バージョン {wanted} を宣言する"), Safety::Unsafe, edits))
}

/// The number in "… needs GLSL 3.30 …".
fn needed(message: &str) -> Option<u32> {
    let (_, rest) = message.split_once("needs GLSL ")?;
    let number: String = rest.chars().take_while(|c| c.is_ascii_digit() || *c == '.').filter(|c| *c != '.').collect();
    number.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn the_version_is_raised() {
        let text = |v: &str| {
            format!(
                "#version {v}\nint f(int a) {{ return a % 2; }}\nvoid main() {{ gl_Position = vec4(float(f(1))); }}\n"
            )
        };
        assert_eq!(lint("a.vert", &text("120")), (vec!["V002"], Some((Safety::Unsafe, text("130")))));
        assert!(lint("a.vert", &text("130")).0.is_empty());
        assert_eq!(needed("`x` needs GLSL 3.30 or `GL_Y`"), Some(330));
        assert_eq!(needed("`x` needs GLSL ES 3.00"), None);
        assert!(lint("a.vert", "#version 120\n#extension GL_EXT_unheard_of : enable\nuvec2 u;\nvoid main() { gl_Position = vec4(1); }\n").0.is_empty());
    }
}
