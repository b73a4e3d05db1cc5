//! D009: an `out` parameter that the function never writes.

use crate::project::ShaderFile;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D009"),
    name: "out-param-not-written",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "an `out` parameter is not written on any path through the function",
    page: Page {
        what: "Reports `out` parameters that no path to the end of the function writes. A parameter that is written \
               on some paths, such as the distance of a hit that is only there when the function returns true, is \
               not reported.",
        why: "The argument gets an undefined value when the function returns, and loses the one that it had.",
        bad: &[Example {
            name: "hit.frag",
            text: "#version 150 core\nin vec3 p;\nout vec4 color;\nbool hit(vec3 q, out float t)\n{\n  float u = dot(q, q);\n  \
                   return u < 1.0;\n}\nvoid main(void)\n{\n  float t;\n  color = hit(p, t) ? vec4(t) : vec4(0.0);\n}\n",
        }],
        good: &[Example {
            name: "hit.frag",
            text: "#version 150 core\nin vec3 p;\nout vec4 color;\nbool hit(vec3 q, out float t)\n{\n  t = dot(q, q);\n  \
                   return t < 1.0;\n}\nvoid main(void)\n{\n  float t;\n  color = hit(p, t) ? vec4(t) : vec4(0.0);\n}\n",
        }],
        fix: "No fix: write the parameter, or make it `in` or `inout`.",
        references: &["GLSL 4.60 specification, section 6.1.1 \"Function Calling Conventions\""],
        ja: Japanese {
            summary: "`out` 引数が、関数のどの経路でも書き込まれません",
            what: "関数の終わりに至るどの経路でも書き込まれない `out` 引数を報告します。交差したときだけ入る距離のように、一部の経路で書き込まれる引数は報告しません。",
            why: "関数から戻ると、実引数は元の値を失い、未定義の値になります。",
            fix: "修正はありません。引数に書き込むか、`in` または `inout` にしてください。",
        },
    },
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

    fn told(outer: &str) -> Vec<String> {
        messages(
            "D009",
            "a.frag",
            &format!("#version 150 core\nout vec4 c;\n{outer}\nvoid main(void) {{ c = vec4(1.0); }}\n"),
        )
    }

    #[test]
    fn parameters_that_are_never_written_are_told() {
        for function in ["void f(out float a) { }", "void f(out float a) { float b = 1.0; if (b > 0.0) return; }"] {
            assert_eq!(told(function), ["`f` never writes its `out` parameter `a`"], "{function}");
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
            assert_eq!(told(function), [""; 0], "{function}");
        }
    }
}
