//! D015: a variable may be read before it has a value, if conditions do not belong together.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::flow::Certainty;
use base::diagnostic::{Code, Severity};
use reading::ShaderFile;

use super::uninitialised_read::diagnostic;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D015"),
    name: "maybe-uninitialised-read",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    for read in file.flow().unassigned.iter().filter(|r| r.certainty == Certainty::Perhaps) {
        let found = diagnostic(file, read, findings);
        findings.push(found);
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(code: &str, body: &str) -> usize {
        let text = format!("#version 150 core\nuniform int n;\nout vec4 c;\nvoid main(void)\n{{\n  {body}\n}}\n");
        messages(code, "a.frag", &text).len()
    }

    #[test]
    fn doubtful_reads_are_left_to_this_rule() {
        for body in [
            "float x; if (n > 0) x = 1.0; c = vec4(0.0); if (n > 0) c.x = x;",
            "float x; for (int i = 0; i < n; ++i) x = 1.0; c = vec4(x);",
            "float x; if (n == 0) x = 1.0; else if (n == 1) x = 2.0; c = vec4(x);",
        ] {
            assert_eq!((reported("D001", body), reported("D015", body)), (0, 1), "{body}");
        }
    }

    #[test]
    fn certain_reads_and_none_are_not_reported() {
        for body in [
            "float x; c = vec4(x);",
            "float x; for (int i = 0; i < 4; ++i) x = 1.0; c = vec4(x);",
            "float x; switch (n) { case 0: x = 1.0; break; default: x = 2.0; } c = vec4(x);",
        ] {
            assert_eq!(reported("D015", body), 0, "{body}");
        }
    }
}
