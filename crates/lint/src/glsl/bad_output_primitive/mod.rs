//! G009: an input primitive stands where an output primitive is needed.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G009"),
    name: "bad-output-primitive",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let strip = if file.file.slice(found.span).starts_with("line") { "line_strip" } else { "triangle_strip" };
    let edits = vec![Edit::replace(found.span, strip)];
    Some(found.with_fix(message!("write `{strip}`", "`{strip}` と書く"), Safety::Safe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn the_strip_is_written() {
        let text = |i: &str, o: &str| {
            format!(
                "#version 150\nlayout({i}) in;\nlayout({o}, max_vertices = 1) out;\nvoid main() {{ gl_Position = gl_in[0].gl_Position; EmitVertex(); }}\n"
            )
        };
        for (wrong, right) in [("triangles", "triangle_strip"), ("lines_adjacency", "line_strip")] {
            let (codes, fixed) = lint("a.geom", &text("points", wrong));
            assert!(codes.contains(&"G009"));
            assert_eq!(fixed, Some((Safety::Safe, text("points", right))));
        }
        assert!(!lint("a.geom", &text("points", "points")).0.contains(&"G009"));
    }
}
