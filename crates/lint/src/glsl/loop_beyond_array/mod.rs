//! N031: a loop that indexes an array outside its elements.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{BinaryOp, Condition, Expr, ExprId, ExprKind, Stmt, StmtKind, UnaryOp};
use syntax::symbols::SymbolId;
use syntax::types::Type;

use super::walk::statements;
use analysis::numeric::{bare, constant};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N031"),
    name: "loop-beyond-array",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// A loop that counts up by 1, with the first and the last number.
struct Counted {
    symbol: SymbolId,
    first: f64,
    last: f64,
}

fn counted(shader: &Shader, stmt: &Stmt) -> Option<Counted> {
    let StmtKind::For { init, condition: Some(Condition::Expr(condition)), step: Some(step), body, head_span: _ } =
        &stmt.kind
    else {
        return None;
    };
    let StmtKind::Declaration(declaration) = &init.kind else { return None };
    let [declarator] = declaration.declarators.as_slice() else { return None };
    let first = constant(shader, declarator.initializer.as_ref()?.value)?;
    let (symbol, info) = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span))?;
    info.ty.scalar()?.is_integer().then_some(())?;
    let ExprKind::Binary { op, op_span: _, left, right } = shader.expr(bare(shader, *condition)).kind else {
        return None;
    };
    (shader.symbol_of(bare(shader, left)) == Some(symbol)).then_some(())?;
    let end = constant(shader, right)?;
    let last = match op {
        BinaryOp::Less => end - 1.0,
        BinaryOp::LessEqual => end,
        _ => return None,
    };
    let one_up = match shader.expr(bare(shader, *step)).kind {
        ExprKind::Postfix { increment: true, op_span: _, operand }
        | ExprKind::Unary { op: UnaryOp::Increment, op_span: _, operand } => shader.symbol_of(operand) == Some(symbol),
        ExprKind::Assign { op: Some(BinaryOp::Add), op_span: _, target, value } => {
            shader.symbol_of(target) == Some(symbol) && constant(shader, value) == Some(1.0)
        }
        _ => false,
    };
    // Written once in the head, and nowhere in the body.
    let written = shader.uses_of(symbol).filter(|u| u.access.writes()).all(|u| !body.span.contains(u.span.start));
    // A way out, or a condition on the number, may keep the last round away.
    let leaves = {
        let text = shader.file().slice(body.span);
        ["if", "?", "break", "return", "discard", "switch", "while", "&&"].iter().any(|word| text.contains(word))
    };
    (one_up && written && !leaves && first <= last).then_some(Counted { symbol, first, last })
}

/// How far an index is from the number: 0 for `i`, 1 for `i + 1`.
fn offset(shader: &Shader, index: ExprId, symbol: SymbolId) -> Option<f64> {
    let index = bare(shader, index);
    let is = |id: ExprId| shader.symbol_of(bare(shader, id)) == Some(symbol);
    match shader.expr(index).kind {
        ExprKind::Binary { op: BinaryOp::Add, op_span: _, left, right } if is(left) => constant(shader, right),
        ExprKind::Binary { op: BinaryOp::Add, op_span: _, left, right } if is(right) => constant(shader, left),
        ExprKind::Binary { op: BinaryOp::Sub, op_span: _, left, right } if is(left) => Some(-constant(shader, right)?),
        _ => is(index).then_some(0.0),
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut loops = Vec::new();
    statements(shader, |stmt| {
        if let (Some(counted), StmtKind::For { body, .. }) = (counted(shader, stmt), &stmt.kind) {
            loops.push((counted, body.span));
        }
    });
    let indexed = |(_, e): (ExprId, &Expr)| match e.kind {
        ExprKind::Index { base, index } => Some((e.span.start, base, index)),
        _ => None,
    };
    let all: Vec<(usize, ExprId, ExprId)> = shader.arena().iter().filter_map(indexed).collect();
    for (counted, body) in loops {
        for (_, base, index) in all.iter().copied().filter(|(start, ..)| body.contains(*start)) {
            let ty = shader.type_of(base);
            let (Some(size), Some(offset)) = (ty.index_count(), offset(shader, index, counted.symbol)) else {
                continue;
            };
            let (lo, hi) = (counted.first + offset, counted.last + offset);
            if !matches!(ty, Type::Array(..) | Type::Vector(..) | Type::Matrix(..))
                || (lo >= 0.0 && hi < f64::from(size))
            {
                continue;
            }
            let (wrong, text) = (if lo < 0.0 { lo } else { hi }, shader.text_of(base));
            findings.push(
                findings
                    .at(
                        &file.file,
                        shader.expr(index).span,
                        message!(
                            "this index comes to {wrong}, and `{text}` has {size} elements",
                            "この添字は {wrong} になりますが、`{text}` の要素は {size} 個です"
                        ),
                    )
                    .with_label(message!("from {lo} to {hi}", "{lo} から {hi} まで"))
                    .with_why(message!(
                        "reading beyond an array is undefined: it gives anything, and writing may change another variable",
                        "配列の外を読むと結果は未定義で、書き込むと別の変数が変わることがあります"
                    ))
                    .with_help(message!("let the loop end one element earlier", "ループの範囲を直してください")),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::numeric::testing::{rings, silent};
    use super::*;

    #[test]
    fn loops_that_leave_an_array_are_reported() {
        rings(
            "N031",
            Level::Default,
            &[
                "float k[3] = float[](1.0, 2.0, 3.0); for (int i = 0; i <= 3; ++i) r += k[i];",
                "float k[3] = float[](1.0, 2.0, 3.0); for (int i = 0; i < 3; i++) r += k[i + 1];",
                "float k[3] = float[](1.0, 2.0, 3.0); for (int i = 0; i < 3; i += 1) { r += k[i - 1]; }",
                "for (int i = 0; i < 4; ++i) r += p[i];",
            ],
        );
    }

    #[test]
    fn loops_inside_and_guarded_ones_are_not() {
        silent(
            "N031",
            Level::Heuristic,
            &[
                "float k[3] = float[](1.0, 2.0, 3.0); for (int i = 0; i < 3; ++i) r += k[i];",
                "float k[3] = float[](1.0, 2.0, 3.0); for (int i = 0; i < 2; ++i) r += k[i + 1];",
                "float k[3] = float[](1.0, 2.0, 3.0); for (int i = 0; i <= 3; ++i) { if (i < 3) r += k[i]; }",
                "float k[3] = float[](1.0, 2.0, 3.0); for (int i = 0; i <= 3; ++i) { if (s > 1.0) break; r += k[i]; }",
                "float k[3] = float[](1.0, 2.0, 3.0); for (int i = 0; i <= 4; ++i) { r += k[i]; i++; }",
            ],
        );
    }
}
