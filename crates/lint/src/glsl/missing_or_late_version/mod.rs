//! V001: `#version` is not the first thing in the text.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V001"),
    name: "missing-or-late-version",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let text = file.file.text();
    let line = file.file.slice(found.span).to_owned();
    let end = text[found.span.end..].find('\n').map_or(text.len(), |n| found.span.end + n + 1);
    // A comment behind the directive stays where it is.
    let alone = text[found.span.end..end].trim().is_empty();
    let delete = if alone { Span::new(found.span.start, end) } else { found.span };
    let edits = vec![Edit::insert(0, format!("{line}\n")), Edit::delete(delete)];
    Some(found.with_fix(message!("move it to the first line", "一行目へ移す"), Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn the_version_moves_to_the_top() {
        let text = "#define A 1\n#version 150 // why\nvoid main() { gl_Position = vec4(A); }\n";
        let (codes, fixed) = lint("a.vert", text);
        assert_eq!(codes, ["V001"]);
        let (safety, fixed) = fixed.unwrap();
        assert_eq!(
            (safety, fixed.as_str()),
            (Safety::Safe, "#version 150\n#define A 1\n // why\nvoid main() { gl_Position = vec4(A); }\n")
        );
        assert!(lint("a.vert", &fixed).0.is_empty());
        assert!(lint("a.vert", "// c\n\n/* d */ #version 150\nvoid main() { gl_Position = vec4(1); }\n").0.is_empty());
    }
}
