//! T016: a constant index that no element has.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Severity};
use reading::ShaderFile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T016"),
    name: "constant-index-out-of-range",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(_: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    Some(found)
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    #[test]
    fn constant_indices_stay_inside() {
        let codes = |s: &str| {
            let text = format!(
                "#version 150\nconst int n = 4;\nuniform mat3 m;\nvoid main() {{ float a[n]; vec3 v = m[0]; {s} gl_Position = vec4(v, a[0]); }}\n"
            );
            run(&[Input::new(SourceFile::new("a.vert", text.as_str()))]).iter().map(|d| d.code.0).collect::<Vec<_>>()
        };
        for wrong in ["a[n] = 1.0;", "a[0] = v[3];", "v = m[3];", "a[-1] = 0.0;", "a[2 * 2] = 0.0;"] {
            assert_eq!(codes(wrong)[..1], ["T016"], "{wrong}");
        }
        for right in ["a[n - 1] = 1.0;", "a[0] = v[2];", "v = m[2];", "for (int i = 0; i < 9; i++) a[i] = 0.0;"] {
            assert!(!codes(right).contains(&"T016"), "{right}");
        }
    }
}
