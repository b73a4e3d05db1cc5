//! D009: an `out` parameter that the function never writes.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D009"),
    name: "out-param-not-written",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    for &(function, index) in &file.flow().unwritten {
        let info = file.shader.function_info(function);
        let param = &info.params[index];
        let Some(name) = &param.name else { continue };
        let (function, span, name) = (&info.name.name, name.span, &name.name);
        findings.push(
            findings
                .at(
                    &file.file,
                    span,
                    message!(
                        "`{function}` never writes its `out` parameter `{name}`",
                        "`{function}` は `out` 引数 `{name}` に書き込みません"
                    ),
                )
                .with_label(message!("stays undefined", "未定義のまま"))
                .with_why(message!(
                    "an `out` parameter starts without a value and is copied to the argument at the end",
                    "`out` 引数は値のない状態で始まり、最後に実引数へ書き戻されます"
                ))
                .with_help(message!(
                    "write `{name}`, or make it `in` or `inout`",
                    "`{name}` に書き込むか、`in` または `inout` にしてください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(outer: &str) -> Vec<String> {
        messages(
            "D009",
            "a.frag",
            &format!("#version 150 core\nout vec4 c;\n{outer}\nvoid main(void) {{ c = vec4(1.0); }}\n"),
        )
    }

    #[test]
    fn parameters_that_are_never_written_are_reported() {
        for function in ["void f(out float a) { }", "void f(out float a) { float b = 1.0; if (b > 0.0) return; }"] {
            assert_eq!(reported(function), ["`f` never writes its `out` parameter `a`"], "{function}");
        }
    }

    #[test]
    fn parameters_that_may_be_written_are_not() {
        for function in [
            "void f(out float a) { a = 1.0; }",
            "bool f(float x, out float a) { if (x < 0.0) return false; a = x; return true; }",
            "void f(out vec4 a) { a.x = 1.0; }",
            "void g(out float b) { b = 1.0; } void f(out float a) { g(a); }",
            "void f(out float a[2]) { a[0] = 1.0; }",
            "void f(out float a) { discard; }",
            "void f(inout float a) { }",
            "void f(out float a);",
        ] {
            assert_eq!(reported(function), [""; 0], "{function}");
        }
    }
}
