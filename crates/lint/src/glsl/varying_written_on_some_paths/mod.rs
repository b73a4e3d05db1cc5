//! D018: a value for the next stage is written on some paths only.

use base::diagnostic::{Code, Severity};
use reading::ShaderFile;
use syntax::Stage;

use super::output_written_on_some_paths::report;
use crate::rule::{Check, Findings, Level, Pages, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D018"),
    name: "varying-written-on-some-paths",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    if file.shader.stage() != Stage::Fragment {
        report(file, findings, |name| !name.starts_with("gl_"));
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn each_output_is_reported_by_one_rule() {
        let text = |body: &str| {
            format!("#version 150 core\nin vec4 p;\nuniform bool b;\nout vec3 v;\nvoid main(void)\n{{\n  {body}\n}}\n")
        };
        let reported = |body: &str| ["D004", "D018"].map(|code| messages(code, "a.vert", &text(body)).len());
        assert_eq!(reported("gl_Position = p; if (b) v = p.xyz;"), [0, 1]);
        assert_eq!(reported("if (b) gl_Position = p; v = p.xyz;"), [1, 0]);
        assert_eq!(reported("gl_Position = p; if (b) v = p.xyz; else v = -p.xyz;"), [0, 0]);
    }
}
