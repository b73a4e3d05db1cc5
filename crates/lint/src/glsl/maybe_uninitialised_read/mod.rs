//! D015: a variable may be read before it has a value, if conditions do not belong together.

use crate::flow::Certainty;
use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity};

use super::uninitialised_read::tell;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D015"),
    name: "maybe-uninitialised-read",
    severity: Severity::Warning,
    level: Level::Strict,
    summary: "a variable has no value on a path that the conditions may or may not rule out",
    page: Page {
        what: "Reports reads that D001 leaves out: some path of the text leads to the place without a value, but that \
               path may never be taken. The usual cases are two conditions that belong together, a chain of `else if` \
               or a `switch` that names all values, and a loop that always has a round.",
        why: "If the path is taken after all, because a new value or an empty list comes from the host, the result is \
              undefined. A first value costs nothing and ends the doubt.",
        bad: &[Example {
            name: "kind.frag",
            text: "#version 150 core\nuniform int kind;\nout vec4 color;\nvoid main(void)\n{\n  vec3 c;\n  \
                   switch (kind) {\n  case 0: c = vec3(1.0); break;\n  case 1: c = vec3(0.5); break;\n  }\n  \
                   color = vec4(c, 1.0);\n}\n",
        }],
        good: &[Example {
            name: "kind.frag",
            text: "#version 150 core\nuniform int kind;\nout vec4 color;\nvoid main(void)\n{\n  vec3 c = vec3(0.0);\n  \
                   switch (kind) {\n  case 0: c = vec3(1.0); break;\n  case 1: c = vec3(0.5); break;\n  }\n  \
                   color = vec4(c, 1.0);\n}\n",
        }],
        fix: "Initialises a local variable with zero where it is declared. Unsafe: zero may not be what is meant.",
        references: &["GLSL 4.60 specification, section 4.3 \"Storage Qualifiers\": undefined values"],
        ja: Japanese {
            summary: "条件しだいで、変数に値のない経路があります",
            what: "D001 が報告しない読み出しのうち、値がないまま来る経路が文面上あるものを報告します。その経路は実際には通らないかもしれません。互いに関連する二つの条件、すべての値を挙げた `else if` の列や `switch`、必ず 1 回は回るループが典型です。",
            why: "新しい値や空のリストがホストから渡されてその経路を通ると、結果は未定義になります。初期値を与えておけばその心配はなくなります。",
            fix: "局所変数を宣言の場所で 0 に初期化します。unsafe: 0 が意図した値とは限りません。",
        },
    },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    for read in file.flow().unassigned.iter().filter(|r| r.certainty == Certainty::Perhaps) {
        let found = tell(file, read, findings);
        findings.push(found);
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
    fn doubtful_reads_are_left_to_this_rule() {
        for body in [
            "float x; if (n > 0) x = 1.0; c = vec4(0.0); if (n > 0) c.x = x;",
            "float x; for (int i = 0; i < n; ++i) x = 1.0; c = vec4(x);",
            "float x; if (n == 0) x = 1.0; else if (n == 1) x = 2.0; c = vec4(x);",
        ] {
            assert_eq!((told("D001", body), told("D015", body)), (0, 1), "{body}");
        }
    }

    #[test]
    fn certain_reads_and_none_are_not_told() {
        for body in [
            "float x; c = vec4(x);",
            "float x; for (int i = 0; i < 4; ++i) x = 1.0; c = vec4(x);",
            "float x; switch (n) { case 0: x = 1.0; break; default: x = 2.0; } c = vec4(x);",
        ] {
            assert_eq!(told("D015", body), 0, "{body}");
        }
    }
}
