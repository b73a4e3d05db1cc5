//! G008: a geometry shader without the layout of its input or output.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;

use super::compile::behind_directives;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("G008"),
    name: "missing-layout",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let geometry = &file.shader.interface().geometry;
    let mut lines = String::new();
    if geometry.input.is_none() {
        lines.push_str("layout(triangles) in;\n");
    }
    match (geometry.output.is_none(), geometry.max_vertices.is_none()) {
        (true, true) => lines.push_str("layout(triangle_strip, max_vertices = 3) out;\n"),
        (true, false) => lines.push_str("layout(triangle_strip) out;\n"),
        (false, true) => lines.push_str("layout(max_vertices = 3) out;\n"),
        (false, false) => {}
    }
    let edits = vec![Edit::insert(behind_directives(file), lines)];
    Some(found.with_fix(message!("declare it for triangles", "三角形として宣言する"), Safety::Unsafe, edits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glsl::testing::repaired as lint;

    #[test]
    fn what_is_missing_is_declared() {
        let text = |l: &str| format!("#version 150\n{l}void main() {{ gl_Position = vec4(1.0); EmitVertex(); }}\n");
        for missing in ["", "layout(lines) in;\n", "layout(lines) in;\nlayout(line_strip) out;\n"] {
            let (codes, fixed) = lint("a.geom", &text(missing));
            assert!(codes.contains(&"G008"), "{missing}");
            let (safety, fixed) = fixed.unwrap();
            assert_eq!(safety, Safety::Unsafe);
            assert!(!lint("a.geom", &fixed).0.contains(&"G008"), "{fixed}");
        }
        // Functions for another file need no layout.
        assert!(!lint("a.geom", "#version 150\nvoid f() { EmitVertex(); }\n").0.contains(&"G008"));
    }
}
