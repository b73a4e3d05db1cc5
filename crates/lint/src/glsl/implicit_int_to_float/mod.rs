//! T006: an integer literal where a float is wanted.

use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::context::{Context, Contexts, integer_literal};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T006"),
    name: "implicit-int-to-float",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Shader(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() {
        return;
    }
    let contexts = Contexts::new(shader);
    for (id, expr) in shader.arena().iter() {
        let Some(text) = integer_literal(shader, id) else { continue };
        if !matches!(contexts.of(id), Some(Context::Converted)) {
            continue;
        }
        let edit = Edit::insert(expr.span.end, ".0");
        findings.push(
            findings
                .at(
                    &file.file,
                    expr.span,
                    message!("integer `{text}` is converted to a float", "整数 `{text}` が浮動小数点数に変換されます"),
                )
                .with_label(message!("a float is wanted here", "浮動小数点数が必要な場所"))
                .with_why(message!(
                    "GLSL ES and GLSL 1.10 have no implicit conversion, and some drivers refuse it elsewhere",
                    "GLSL ES と GLSL 1.10 には暗黙の変換がなく、他の版でも受け付けないドライバがあります"
                ))
                .with_fix(message!("write `{text}.0`", "`{text}.0` と書く"), Safety::Safe, vec![edit]),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    fn reported(statement: &str) -> usize {
        let text = format!(
            "#version 150 core\nuniform int n;\n#define K 3\nout vec4 c;\nfloat f(float x) {{ return x; }}\nvoid main(void)\n{{\n  float x = 1.0; int i = 0; c = vec4(0.0);\n  {statement}\n}}\n"
        );
        messages("T006", "a.frag", &text).len()
    }

    #[test]
    fn converted_literals_are_reported() {
        for statement in
            ["x = 2;", "float y = 3;", "x = x * 2;", "c = c / 2;", "x = f(2);", "x += (1);", "x = -1;", "c *= 2;"]
        {
            assert_eq!(reported(statement), 1, "{statement}");
        }
    }

    #[test]
    fn integers_and_constructors_are_not() {
        for statement in [
            "i = 2;",
            "c = vec4(1);",
            "x = float(2);",
            "x = 2.0;",
            "c[1] = 1.0;",
            "x = pow(x, 2);",
            "x = K;",
            "if (n == 1) x = 1.0;",
            "x = float(n + 1);",
            "ivec2 v = ivec2(1) + 2;",
        ] {
            assert_eq!(reported(statement), 0, "{statement}");
        }
    }
}
