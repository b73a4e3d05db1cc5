//! D002: a sum that starts with no value.

use crate::flow::Certainty;
use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};

use super::variable::with_zero;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D002"),
    name: "uninitialised-accumulator",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "a variable is accumulated in a loop without a first value",
    page: Page {
        what: "Reports a variable to which a loop adds (`s += x`, `s = s * x`, `s++`) and that has no value before \
               the loop.",
        why: "The first round computes with an undefined value, and the error stays in the result. Drivers that warn \
              of reads before writes miss this one: from the second round on, the variable is written.",
        bad: &[Example {
            name: "blur.frag",
            text: "#version 150 core\nuniform sampler2D image;\nin vec2 tc;\nout vec4 color;\nvoid main(void)\n{\n  \
                   vec4 sum;\n  for (int i = -2; i <= 2; ++i)\n    sum += textureOffset(image, tc, ivec2(0)) * float(i + 3);\n  \
                   color = sum / 15.0;\n}\n",
        }],
        good: &[Example {
            name: "blur.frag",
            text: "#version 150 core\nuniform sampler2D image;\nin vec2 tc;\nout vec4 color;\nvoid main(void)\n{\n  \
                   vec4 sum = vec4(0.0);\n  for (int i = -2; i <= 2; ++i)\n    sum += textureOffset(image, tc, ivec2(0)) * float(i + 3);\n  \
                   color = sum / 15.0;\n}\n",
        }],
        fix: "Initialises a local variable with zero where it is declared. Unsafe: a product starts with one.",
        references: &["GLSL 4.60 specification, section 4.3 \"Storage Qualifiers\": undefined values"],
        ja: Japanese {
            summary: "初期値のない変数がループで累積されています",
            what: "ループの中で `s += x`、`s = s * x`、`s++` のように累積される変数のうち、ループの前に値のないものを報告します。",
            why: "最初の回が未定義の値で計算され、その誤りが結果に残ります。2 回目以降は書き込み済みになるため、ドライバの警告では見つかりません。",
            fix: "局所変数を宣言の場所で 0 に初期化します。unsafe: 積の初期値は 1 です。",
        },
    },
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

    fn told(code: &str, body: &str) -> usize {
        let text = format!("#version 150 core\nuniform int n;\nout vec4 c;\nvoid main(void)\n{{\n  {body}\n}}\n");
        messages(code, "a.frag", &text).len()
    }

    #[test]
    fn sums_without_a_start_are_told_once() {
        for body in [
            "float s; for (int i = 0; i < n; ++i) s += 1.0; c = vec4(s);",
            "float s; for (int i = 0; i < 4; ++i) for (int j = 0; j < 4; ++j) s = s + 1.0; c = vec4(s);",
            "int s; while (s < n) { s++; } c = vec4(s);",
            "vec3 s; int i = 0; do { s.xy *= 0.5; s.z = 1.0; } while (++i < n); c = vec4(s, 1.0);",
        ] {
            assert_eq!(told("D001", body) + told("D002", body), 1, "{body}");
        }
        assert_eq!(told("D002", "float s; for (int i = 0; i < n; ++i) s += 1.0; c = vec4(s);"), 1);
    }

    #[test]
    fn sums_with_a_start_are_not() {
        for body in [
            "float s = 0.0; for (int i = 0; i < n; ++i) s += 1.0; c = vec4(s);",
            "float s; s = 0.0; for (int i = 0; i < n; ++i) s += 1.0; c = vec4(s);",
            "float s; for (int i = 0; i < n; ++i) { s = 0.0; s += 1.0; } c = vec4(1.0);",
            "float s; for (int i = 0; i < n; ++i) { if (i == 0) s = 1.0; else s += 1.0; } c = vec4(1.0);",
        ] {
            assert_eq!(told("D002", body) + told("D001", body), 0, "{body}");
        }
    }
}
