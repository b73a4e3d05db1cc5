//! D008: a function that returns a value can end without one.

use crate::project::ShaderFile;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("D008"),
    name: "missing-return",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    for &function in &file.flow().falls_off {
        let info = file.shader.function_info(function);
        let (name, ty) = (&info.name.name, &info.return_type);
        let body = file.shader.function_syntax(info).and_then(|f| f.body.as_ref());
        let found = findings
            .at(
                &file.file,
                info.name.span,
                message!(
                    "`{name}` can end without returning a `{ty}`",
                    "`{name}` は `{ty}` を返さずに終わることがあります"
                ),
            )
            .with_label(message!("returns a `{ty}`", "`{ty}` を返す関数"))
            .with_why(message!(
                "a path reaches the end of the body without `return`, and the result is undefined there",
                "`return` なしで本体の終わりに至る経路があり、その場合の戻り値は未定義です"
            ))
            .with_help(message!("return a value at the end", "最後に値を返してください"));
        findings.push(match body {
            Some(body) => {
                let end = base::text::Span::new(body.span.end.saturating_sub(1), body.span.end);
                found.with_related(&file.file, end, message!("reached without `return`", "`return` なしでここに来る"))
            }
            None => found,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(body: &str) -> usize {
        let text = format!(
            "#version 150 core\nuniform int n;\nout vec4 c;\nfloat f(float x)\n{{\n  {body}\n}}\nvoid main(void)\n{{\n  c = vec4(f(1.0));\n}}\n"
        );
        messages("D008", "a.frag", &text).len()
    }

    #[test]
    fn a_path_without_return_is_reported() {
        for body in [
            "if (x > 0.0) return 1.0;",
            "for (int i = 0; i < n; ++i) if (x > 0.0) return x;",
            "if (x > 2.0) return x; while (true) { if (x > 0.0) break; }",
        ] {
            assert_eq!(reported(body), 1, "{body}");
        }
    }

    #[test]
    fn paths_that_return_or_end_are_not() {
        for body in [
            "return x;",
            "if (x > 0.0) return 1.0; else return 0.0;",
            "if (x > 0.0) return 1.0; discard;",
            "while (true) { if (x > 0.0) return 1.0; x += 1.0; }",
            "for (;;) { return x; }",
            "switch (n) { case 0: return 1.0; default: return 2.0; }",
            "switch (n) { case 0: return 1.0; case 1: return 2.0; }",
            "if (n == 0) return 1.0; else if (n == 1) return 2.0;",
            "do { return x; } while (false);",
        ] {
            assert_eq!(reported(body), 0, "{body}");
        }
    }

    #[test]
    fn libraries_are_judged_too() {
        assert_eq!(messages("D008", "a.glsl", "float f(float x) { if (x > 0.0) return x; }\n").len(), 1);
    }
}
