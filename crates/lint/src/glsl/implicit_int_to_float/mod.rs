//! T006: an integer literal where a float is wanted.

use crate::project::ShaderFile;
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;

use super::context::{Context, Contexts, integer_literal};
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T006"),
    name: "implicit-int-to-float",
    severity: Severity::Info,
    level: Level::Strict,
    summary: "an integer literal is converted to a float by itself",
    page: Page {
        what: "Reports integer literals that initialise, are assigned to, returned as, combined with or passed to a \
            function of the shader as floats. Constructors such as `vec4(1)` convert by definition, and are not \
            reported; arguments of built-in functions are left to T017.",
        why: "GLSL 1.10 and GLSL ES have no such conversion, and some drivers refuse it in shaders of newer versions.",
        bad: &[Example {
            name: "scale.frag",
            text: "#version 150 core\nout vec4 color;\nvoid main(void)\n{\n  float \
            h = 2;\n  color = vec4(h);\n}\n",
        }],
        good: &[Example {
            name: "scale.frag",
            text: "#version 150 core\nout vec4 color;\nvoid main(void)\n{\n  \
            float h = 2.0;\n  color = vec4(h);\n}\n",
        }],
        fix: "Appends `.0`. Safe: the value is the same.",
        references: &["GLSL 4.60 specification, section 4.1.10 \"Implicit Conversions\""],
        ja: Japanese {
            summary: "整数リテラルが暗黙に浮動小数点数へ変換されています",
            what: "浮動小数点数の初期化、代入、戻り値、演算、シェーダの関数の引数に使われている整数リテラルを報告します。`vec4(1)` のようなコンストラクタは変換そのものなので報告しません。組み込み関数の引数は T017 が扱います。",
            why: "GLSL 1.10 と GLSL ES にはこの変換がなく、新しい版でも受け付けないドライバがあります。",
            fix: "`.0` を付けます。safe: 値は同じです。",
        },
    },
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

    fn told(statement: &str) -> usize {
        let text = format!(
            "#version 150 core\nuniform int n;\n#define K 3\nout vec4 c;\nfloat f(float x) {{ return x; }}\nvoid main(void)\n{{\n  float x = 1.0; int i = 0; c = vec4(0.0);\n  {statement}\n}}\n"
        );
        messages("T006", "a.frag", &text).len()
    }

    #[test]
    fn converted_literals_are_told() {
        for statement in
            ["x = 2;", "float y = 3;", "x = x * 2;", "c = c / 2;", "x = f(2);", "x += (1);", "x = -1;", "c *= 2;"]
        {
            assert_eq!(told(statement), 1, "{statement}");
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
            assert_eq!(told(statement), 0, "{statement}");
        }
    }
}
