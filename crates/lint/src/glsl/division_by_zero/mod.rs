//! N009: division by what can be zero.

use crate::project::{Project, ShaderFile};
use crate::range::{Evidence, Range};
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};

use super::numeric::calls;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N009"),
    name: "division-by-zero",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "a number is divided by what can be 0",
    page: Page {
        what: "Reports `a / b`, `a % b` and `mod(a, b)` when the text shows that `b` can be 0: a constant, what \
               `max(…, 0.0)` or `clamp` cut off at 0, a declared range with 0, a count such as `gl_InstanceID`. With \
               `--level strict`, divisors are reported as well that pass through 0, as a sine does. A divisor of which \
               nothing is known is not reported.",
        why: "An integer divided by 0 is undefined. A floating-point number divided by 0 is infinite or NaN where the \
              device follows IEEE 754, which it need not.",
        bad: &[Example {
            name: "shade.frag",
            text: "#version 330 core\nin float depth;\nout vec4 color;\nvoid main()\n{\n  \
                   color = vec4(1.0 / max(depth, 0.0));\n}\n",
        }],
        good: &[Example {
            name: "shade.frag",
            text: "#version 330 core\nin float depth;\nout vec4 color;\nvoid main()\n{\n  \
                   color = vec4(1.0 / max(depth, 1e-6));\n}\n",
        }],
        fix: "No fix: what the quotient should be is not known.",
        references: &[
            "GLSL 4.60 specification, section 4.7.1 \"Range and Precision\": dividing by 0 need not give infinity",
            "GLSL 4.60 specification, section 5.9 \"Expressions\": integer division by 0 is undefined",
        ],
        ja: Japanese {
            summary: "除数が 0 になりえます",
            what: "`b` が 0 になりうることが本文から分かる `a / b`、`a % b`、`mod(a, b)` を報告します。定数、`max(…, 0.0)` や `clamp` で 0 に制限したもの、0 を含むと宣言した範囲、`gl_InstanceID` のような番号などです。`--level strict` では、正弦のように 0 を通過する除数も報告します。何も分からない除数は報告しません。",
            why: "整数を 0 で割った結果は未定義です。浮動小数点数を 0 で割ると、IEEE 754 に従う装置では無限大か NaN になりますが、従うとは限りません。",
            fix: "自動修正（fix）はありません。商をいくつにすべきか分からないためです。",
        },
    },
    check: Check::ShaderWith(check),
};

fn level(divisor: &Range) -> Option<Level> {
    if divisor.shows_zero() {
        return Some(Level::Default);
    }
    let through = divisor.goes_below(0.0, Evidence::Nature) && divisor.goes_above(0.0, Evidence::Nature);
    (through && !divisor.excludes_zero()).then_some(Level::Strict)
}

/// All divisions: the expression and its divisor.
fn divisions(shader: &Shader) -> impl Iterator<Item = (ExprId, ExprId)> {
    let operators = shader.arena().iter().filter_map(|(id, expr)| match expr.kind {
        ExprKind::Binary { op: BinaryOp::Div | BinaryOp::Rem, op_span: _, left: _, right } => Some((id, right)),
        ExprKind::Assign { op: Some(BinaryOp::Div | BinaryOp::Rem), op_span: _, target: _, value } => Some((id, value)),
        _ => None,
    });
    operators.chain(calls(shader, &["mod"]).filter_map(|c| Some((c.id, *c.args.get(1)?))))
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let observed = file.observed(project);
    for (id, divisor) in divisions(shader) {
        let all = observed.visits(id).iter().filter_map(|v| v.operands.get(1)).flat_map(|v| &v.parts);
        let Some(level) = all.filter_map(level).min() else { continue };
        let integer = shader.type_of(divisor).scalar().is_some_and(|s| s.is_integer());
        let why = if integer {
            message!("an integer divided by 0 is undefined", "整数を 0 で割った結果は未定義です")
        } else {
            message!("the quotient is infinite or NaN, or anything else", "商は無限大か NaN、あるいは別の値になります")
        };
        findings.push_at(
            level,
            findings
                .at(
                    &file.file,
                    shader.expr(divisor).span,
                    message!("this divisor can be 0", "この除数は 0 になりえます"),
                )
                .with_label(message!("0 is possible", "0 になりえます"))
                .with_why(why)
                .with_help(message!(
                    "keep the divisor away from 0, or divide only where it is not 0",
                    "除数が 0 にならないようにするか、0 でないところだけで割ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use super::*;

    #[test]
    fn divisors_that_can_be_zero_are_told() {
        rings(
            "N009",
            Level::Default,
            &[
                "r = 1.0 / max(s, 0.0);",
                "r = s / 0.0;",
                "r = s / declared;",
                "r /= clamp(s, 0.0, 1.0);",
                "v = p / max(q, 0.0);",
                "int i = 7; int j = 0; r = float(i / j);",
                "r = mod(s, 0.0);",
                "for (int i = 0; i < 4; ++i) r += 1.0 / float(i);",
                "for (int i = 0; i < 4; ++i) r += float(7 % i);",
            ],
        );
        rings("N009", Level::Strict, &["r = cos(s) / sin(t);", "r = 1.0 / dot(normalize(p), normalize(q));"]);
    }

    #[test]
    fn others_are_not() {
        silent(
            "N009",
            Level::Heuristic,
            &[
                "r = s / t;",
                "v = p / length(p);",
                "r = 1.0 / (1.0 + max(s, 0.0));",
                "r = s / max(t, 1e-6);",
                "float d = max(s, 0.0); if (d > 0.0) r = 1.0 / d;",
                "float d = max(s, 0.0); if (d != 0.0) r = 1.0 / d;",
                "float d = max(s, 0.0); r = d == 0.0 ? 0.0 : 1.0 / d;",
                "for (int i = 1; i < 4; ++i) r += 1.0 / float(i);",
                "for (int i = 0; i < 4; ++i) r += float(i) / 4.0;",
                "int n = 0; for (int i = 0; i < 4; ++i) { if (p.x > float(i)) ++n; } if (n > 0) r = 1.0 / float(n);",
                "r = 1.0 / (0.1 + s * s);",
                "float sum = 0.0; for (int i = 0; i < 4; ++i) sum += 1.0; r = 1.0 / sum;",
            ],
        );
    }
}
