//! N015: a literal or shift outside what the type holds.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::range::Range;
use base::diagnostic::{Code, Severity, message};
use reading::{Project, ShaderFile};
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, Literal};

use analysis::numeric::number;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N015"),
    name: "literal-out-of-range",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::AnyWith(check),
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
    let (shifted, by) = match shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Shl | BinaryOp::Shr, op_span: _, left, right } => (left, right),
        ExprKind::Assign { op: Some(BinaryOp::Shl | BinaryOp::Shr), op_span: _, target, value } => (target, value),
        _ => return None,
    };
    // Integers of extensions, such as `uint64_t`, have other numbers of bits.
    if shader.type_of(shifted).is_error() || shader.type_of(shifted).scalar().is_some_and(|s| s.bits() != 32) {
        return None;
    }
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
        // WGSL takes the number of bits modulo 32.
        if file.is_wgsl() {
            continue;
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
    fn numbers_that_do_not_fit_are_reported() {
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
    fn wider_integers_of_extensions_have_more_bits() {
        let text = |one: &str| {
            format!(
                "#version 450\n#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require\nlayout(local_size_x = 8) in;\n\
                 layout(binding = 0) buffer D {{ uint d[]; }};\nvoid main() {{ d[0] = uint({one} << 63); }}\n"
            )
        };
        let found = |text: &str| super::super::testing::found("N015", "a.comp", text).len();
        assert_eq!(found(&text("uint64_t(1)")), 0);
        assert_eq!(found(&text("uint(1)")), 1);
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
