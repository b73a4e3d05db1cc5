//! T017: integers as arguments of built-in functions of floats.

use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind, UnaryOp};
use syntax::types::ScalarType;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::context::{Context, Contexts, integer_literal};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T017"),
    name: "ambiguous-overload-int-args",
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
        let Some(text) = integer_literal(shader, id) else {
            if let (Some(Context::Builtin(name)), true) = (contexts.of(id), is_computed(shader, id)) {
                computed(file, id, name, findings);
            }
            continue;
        };
        let Some(Context::Builtin(name)) = contexts.of(id) else { continue };
        let edit = Edit::insert(expr.span.end, ".0");
        findings.push(
            findings
                .at(
                    &file.file,
                    expr.span,
                    message!("integer `{text}` is passed to `{name}`", "整数 `{text}` が `{name}` に渡されています"),
                )
                .with_label(message!("`{name}` computes with floats here", "ここでは浮動小数点数の計算"))
                .with_why(message!(
                    "the function is found by implicit conversion only, about which drivers disagree",
                    "暗黙の変換によって関数が選ばれますが、その結果はドライバによって異なることがあります"
                ))
                .with_fix(message!("write `{text}.0`", "`{text}.0` と書く"), Safety::Safe, vec![edit]),
        );
    }
}

/// True for an integer that is no literal, inside of parentheses and signs.
fn is_computed(shader: &Shader, id: ExprId) -> bool {
    let around = matches!(
        shader.expr(id).kind,
        ExprKind::Paren(_) | ExprKind::Unary { op: UnaryOp::Minus | UnaryOp::Plus, .. } | ExprKind::Literal(_)
    );
    !around && matches!(shader.type_of(id).scalar(), Some(ScalarType::Int | ScalarType::Uint))
}

fn computed(file: &ShaderFile, id: ExprId, name: &str, findings: &mut Findings<'_>) {
    let ty = file.shader.type_of(id).to_string();
    findings.push(
        findings
            .at(
                &file.file,
                file.shader.expr(id).span,
                message!(
                    "`{name}` is given `{ty}`, and computes with floats",
                    "浮動小数点数で計算する `{name}` に `{ty}` を渡しています"
                ),
            )
            .with_label(message!("becomes a float", "浮動小数点数になる"))
            .with_why(message!(
                "the function is found by implicit conversion only, about which drivers disagree",
                "暗黙の変換によって関数が選ばれますが、その結果はドライバによって異なることがあります"
            ))
            .with_help(message!("write the conversion: `float(…)`", "`float(…)` と変換を書いてください")),
    );
}

#[cfg(test)]
mod tests {
    use super::super::testing::messages;

    #[test]
    fn integers_among_floats_are_reported() {
        let reported = |statement: &str| {
            let text = format!(
                "#version 150 core\nuniform sampler2D s;\nuniform int n;\nin vec2 t;\nout vec4 c;\nvoid main(void)\n{{\n  float x = t.x; int i = n; c = vec4(0.0);\n  {statement}\n}}\n"
            );
            messages("T017", "a.frag", &text).len()
        };
        assert_eq!(reported("x = pow(2, 3);"), 2);
        assert_eq!(reported("x = step(n + 1, i);"), 2, "no literals");
        assert_eq!(reported("x = max(x, -(n));"), 1);
        for statement in ["x = max(x, 0);", "x = clamp(x, -1, 1.0);", "c = mix(c, c, 1);"] {
            assert_eq!(reported(statement), 1, "{statement}");
        }
        for statement in [
            "x = max(x, 0.0);",
            "i = max(i, 0);",
            "x = float(max(n, 0));",
            "c = texelFetch(s, ivec2(0), 0);",
            "c = vec4(textureSize(s, 0), 0.0, 1.0);",
            "c = textureOffset(s, t, ivec2(1, 0));",
        ] {
            assert_eq!(reported(statement), 0, "{statement}");
        }
    }
}
