//! N015: a literal or shift outside what the type holds.

use crate::project::{Project, ShaderFile};
use crate::range::Range;
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Severity, message};
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, Literal};

use super::numeric::number;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N015"),
    name: "literal-out-of-range",
    severity: Severity::Warning,
    level: Level::Default,
    summary: "a literal does not fit into binary32, or a shift goes past the bits of an integer",
    page: Page {
        what: "Reports float literals above the greatest number of binary32, which become infinite, and those so small \
               that they become 0. Reports shifts by a number of bits that is always negative, or 32 and more. \
               Integers that do not fit into 32 bits are an error of the language and told as one.",
        why: "`1e40` is infinity: sums with it stay infinite, and its difference with itself is NaN. A shift past \
              the bits is undefined; devices give 0 or shift by the amount modulo 32.",
        bad: &[Example {
            name: "nearest.frag",
            text: "#version 330 core\nin vec2 p;\nout vec4 color;\nvoid main()\n{\n  float nearest = 1e40;\n  \
                   nearest = min(nearest, length(p));\n  color = vec4(nearest);\n}\n",
        }],
        good: &[Example {
            name: "nearest.frag",
            text: "#version 330 core\nin vec2 p;\nout vec4 color;\nvoid main()\n{\n  float nearest = 3.4e38;\n  \
                   nearest = min(nearest, length(p));\n  color = vec4(nearest);\n}\n",
        }],
        fix: "No fix: the number that is meant is not known.",
        references: &[
            "GLSL 4.60 specification, section 4.1.4 \"Floating-Point Variables\"",
            "GLSL 4.60 specification, section 5.9 \"Expressions\": shifts by at least the number of bits are undefined",
        ],
        ja: Japanese {
            summary: "リテラルが binary32 に収まらないか、シフト量が整数のビット数を超えています",
            what: "binary32 の最大値より大きく無限大になる浮動小数点リテラルと、小さすぎて 0 になるものを報告します。シフト量が常に負または 32 以上のシフトも報告します。32 ビットに収まらない整数は言語のエラーとして報告します。",
            why: "`1e40` は無限大です。それを含む和は無限大のままで、自分自身との差は NaN になります。ビット数以上のシフトは未定義です。0 になる装置も、32 で割った余りだけシフトする装置もあります。",
            fix: "自動修正（fix）はありません。本来の値が分からないためです。",
        },
    },
    check: Check::ShaderWith(check),
};

/// Bits of an integer.
const BITS: f64 = 32.0;

/// What binary32 makes of a literal that it cannot hold.
fn lost(value: f64) -> Option<f64> {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is what is asked for")]
    let single = value as f32;
    (single.is_infinite() || (single == 0.0 && value != 0.0)).then_some(f64::from(single))
}

fn amount(shader: &Shader, file: &ShaderFile, project: &Project, id: ExprId) -> Option<(ExprId, Range)> {
    let by = match shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Shl | BinaryOp::Shr, op_span: _, left: _, right } => right,
        ExprKind::Assign { op: Some(BinaryOp::Shl | BinaryOp::Shr), op_span: _, target: _, value } => value,
        _ => return None,
    };
    let observed = file.observed(project);
    let visits = observed.visits(id);
    let mut all = visits.iter().filter_map(|v| v.operands.get(1)).flat_map(|v| &v.parts);
    all.find(|r| r.lo >= BITS || r.hi < 0.0).map(|r| (by, *r))
}

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for (id, expr) in shader.arena().iter() {
        if let ExprKind::Literal(Literal::Float(value)) = expr.kind
            && let Some(becomes) = lost(value)
        {
            let (text, becomes) = (shader.text_of(id), number(becomes));
            findings.push(
                findings
                    .at(
                        &file.file,
                        expr.span,
                        message!("`{text}` does not fit into binary32", "`{text}` は binary32 に収まりません"),
                    )
                    .with_label(message!("becomes {becomes}", "{becomes} になります"))
                    .with_why(message!(
                        "binary32 holds numbers from about 1.4e-45 to 3.4e38",
                        "binary32 で表せるのは約 1.4e-45 から 3.4e38 までです"
                    ))
                    .with_help(message!("write a number of that range", "その範囲の数を書いてください")),
            );
        }
        if let Some((by, range)) = amount(shader, file, project, id) {
            let bits = number(range.lo);
            findings.push(
                findings
                    .at(
                        &file.file,
                        shader.expr(by).span,
                        message!("this shifts by {bits} bits, of 32", "32 ビットの値を {bits} ビットシフトしています"),
                    )
                    .with_label(message!("0 to 31 are defined", "定義されているのは 0 から 31 まで"))
                    .with_why(message!(
                        "a shift by a negative number of bits, or by 32 and more, is undefined",
                        "負のビット数や 32 以上のシフトは未定義です"
                    ))
                    .with_help(message!("shift by 0 to 31 bits", "0 から 31 ビットの範囲でシフトしてください")),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{lint, rings, shader, silent};
    use super::*;

    #[test]
    fn numbers_that_do_not_fit_are_told() {
        rings(
            "N015",
            Level::Default,
            &[
                "r = 1e40;",
                "r = -3.5e38;",
                "r = 1.0e-50;",
                "int i = 1 << 32; r = float(i);",
                "int i = 7; i >>= 40; r = float(i);",
                "const int k = 33; int i = int(s) << k; r = float(i);",
            ],
        );
        let found = lint("N015", Level::Default, &shader("#define BIG 1e40", "r = BIG;"));
        assert_eq!(found.len(), 1);
    }

    #[test]
    fn others_are_not() {
        silent(
            "N015",
            Level::Heuristic,
            &[
                "r = 3.4e38;",
                "r = 1e-40;",
                "r = 0.0e99;",
                "int i = 1 << 31; r = float(i);",
                "int i = 1 << int(s); r = float(i);",
            ],
        );
        let text = shader("", "double d = 1e300lf; r = float(d);").replace("330", "400");
        assert!(lint("N015", Level::Heuristic, &text).is_empty());
    }
}
