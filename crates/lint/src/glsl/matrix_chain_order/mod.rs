//! P002: a product of matrices that is applied to a vector from the wrong end.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::types::Type;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("P002"),
    name: "matrix-chain-order",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if !file.is_sound() {
        return;
    }
    for (id, expr) in shader.arena().iter() {
        let Some((left, vector)) = product(shader, id) else { continue };
        if !matches!(shader.type_of(vector), Type::Vector(..)) {
            continue;
        }
        let mut matrices = Vec::new();
        let mut rest = left;
        while let Some((before, last)) = product(shader, rest) {
            matrices.push(last);
            rest = before;
        }
        matrices.push(rest);
        matrices.reverse();
        let size = |id: ExprId| match shader.type_of(id) {
            Type::Matrix(_, columns, rows) => Some((u32::from(*columns), u32::from(*rows))),
            _ => None,
        };
        let Some(sizes) = matrices.iter().map(|m| size(*m)).collect::<Option<Vec<_>>>() else { continue };
        if sizes.len() < 2 {
            continue;
        }
        let (now, then) = (cost_from_left(&sizes), cost_from_right(&sizes));
        if now <= then {
            continue;
        }
        let open: Vec<usize> = matrices[1..].iter().map(|m| shader.expr(*m).span.start).collect();
        let close = shader.expr(vector).span.end;
        let mut found = findings
            .at(
                &file.file,
                expr.span,
                message!(
                    "{now} multiplications instead of {then}: the matrices are multiplied first",
                    "乗算が {then} 回で済むところ {now} 回かかります。行列どうしが先に掛けられています"
                ),
            )
            .with_label(message!("formed from the left", "左から計算される"))
            .with_why(message!(
                "a product is formed from the left, so that whole matrices are multiplied for every invocation",
                "積は左から計算されるため、呼び出しごとに行列どうしの積が作られます"
            ))
            .with_help(message!(
                "multiply the vector first, or pass the product of the matrices as a uniform",
                "ベクトルに近い側から掛けるか、行列の積を uniform で渡してください"
            ));
        if !expr.from_macro && !matrices.iter().any(|m| shader.expr(*m).from_macro) && !shader.expr(vector).from_macro {
            let mut edits: Vec<Edit> = open.iter().map(|at| Edit::insert(*at, "(")).collect();
            edits.push(Edit::insert(close, ")".repeat(open.len())));
            found =
                found.with_fix(message!("multiply the vector first", "ベクトルを先に掛ける"), Safety::Unsafe, edits);
        }
        findings.push(found);
    }
}

fn product(shader: &Shader, id: ExprId) -> Option<(ExprId, ExprId)> {
    match shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } => Some((left, right)),
        _ => None,
    }
}

/// Multiplications for `a * b * v` from the left; sizes are columns and rows.
fn cost_from_left(sizes: &[(u32, u32)]) -> u32 {
    let rows = sizes[0].1;
    let products: u32 = sizes.windows(2).map(|w| rows * w[0].0 * w[1].0).sum();
    products + rows * sizes[sizes.len() - 1].0
}

/// Multiplications when each matrix meets a vector.
fn cost_from_right(sizes: &[(u32, u32)]) -> u32 {
    sizes.iter().map(|(columns, rows)| columns * rows).sum()
}

#[cfg(test)]
mod tests {
    use super::super::testing::found;
    use base::text::EditList;

    fn fixed(expr: &str) -> Option<(String, String)> {
        let text = format!(
            "#version 150 core\nin vec4 v;\nuniform mat4 a;\nuniform mat4 b;\nuniform mat4 c;\nuniform float s;\nvoid main(void)\n{{\n  gl_Position = {expr};\n}}\n"
        );
        let reported = found("P002", "a.vert", &text);
        let first = reported.first()?;
        let edits: EditList = first.fix.clone()?.edits.into_iter().collect();
        let after = edits.apply(&text).unwrap().text;
        let line = after.lines().nth(8)?.trim().trim_start_matches("gl_Position = ").trim_end_matches(';').to_owned();
        Some((first.message.split(':').next()?.to_owned(), line))
    }

    #[test]
    fn chains_are_counted_and_turned() {
        let reported = |expr: &str| fixed(expr).unwrap();
        let wanted = |count: &str, text: &str| (count.to_owned(), text.to_owned());
        assert_eq!(reported("a * b * v"), wanted("80 multiplications instead of 32", "a * (b * v)"));
        assert_eq!(reported("a * b * c * v"), wanted("144 multiplications instead of 48", "a * (b * (c * v))"));
        assert_eq!(
            reported("a * b * vec4(v.xyz, 1.0) + v"),
            wanted("80 multiplications instead of 32", "a * (b * vec4(v.xyz, 1.0)) + v")
        );
        for expr in ["a * (b * v)", "(a * b) * v", "a * v", "v * a * b", "a * s * v", "a * v * s", "a * b * c[0] + v"] {
            assert_eq!(fixed(expr).is_some(), expr.starts_with("a * b * c"), "{expr}");
        }
    }
}
