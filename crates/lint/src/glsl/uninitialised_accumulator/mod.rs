//! D002: a sum that starts with no value.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::flow::Certainty;
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

use super::variable::with_zero;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D002"),
    name: "uninitialised-accumulator",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    for read in &file.flow().unassigned {
        if read.certainty == Certainty::Perhaps || !read.accumulates {
            continue;
        }
        let symbol = file.shader.symbol(read.symbol);
        let name = &symbol.name;
        let message =
            message!("`{name}` is accumulated without a first value", "`{name}` が初期値なしで累積されています");
        let mut found = findings
            .at(&file.file, read.span, message)
            .with_label(message!("undefined in the first round", "最初の回は未定義"))
            .with_why(message!(
                "the first round of the loop uses a value that nothing has written",
                "ループの最初の回では、まだ何も書き込まれていない値が使われます"
            ))
            .with_help(message!(
                "give `{name}` its first value before the loop",
                "ループの前で `{name}` に初期値を入れてください"
            ));
        if let Some(span) = symbol.span {
            found = found.with_related(&file.file, span, message!("declared without a value", "値のない宣言"));
        }
        findings.push(with_zero(found, file, read.symbol));
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
    fn sums_without_a_start_are_reported_once() {
        for body in [
            "float s; for (int i = 0; i < n; ++i) s += 1.0; c = vec4(s);",
            "float s; for (int i = 0; i < 4; ++i) for (int j = 0; j < 4; ++j) s = s + 1.0; c = vec4(s);",
            "int s; while (s < n) { s++; } c = vec4(s);",
            "vec3 s; int i = 0; do { s.xy *= 0.5; s.z = 1.0; } while (++i < n); c = vec4(s, 1.0);",
        ] {
            assert_eq!(reported("D001", body) + reported("D002", body), 1, "{body}");
        }
        assert_eq!(reported("D002", "float s; for (int i = 0; i < n; ++i) s += 1.0; c = vec4(s);"), 1);
    }

    #[test]
    fn sums_with_a_start_are_not() {
        for body in [
            "float s = 0.0; for (int i = 0; i < n; ++i) s += 1.0; c = vec4(s);",
            "float s; s = 0.0; for (int i = 0; i < n; ++i) s += 1.0; c = vec4(s);",
            "float s; for (int i = 0; i < n; ++i) { s = 0.0; s += 1.0; } c = vec4(1.0);",
            "float s; for (int i = 0; i < n; ++i) { if (i == 0) s = 1.0; else s += 1.0; } c = vec4(1.0);",
        ] {
            assert_eq!(reported("D002", body) + reported("D001", body), 0, "{body}");
        }
    }
}
