//! V002: something that came with a later version.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::Profile;

use super::compile::explained;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V002"),
    name: "feature-needs-version",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
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
