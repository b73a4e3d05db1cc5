//! What conditions in front of a place say of variables: `if (x >= width) return;` and `if (x < width) { … }`.

use base::text::Span;
use syntax::Shader;
use syntax::ast::{BinaryOp, Block, ExprId, ExprKind, ItemKind, Stmt, StmtKind};

use super::sum::{Factor, Product, product};
use crate::numeric::bare;

/// A variable that is less than a product in a part of the text.
#[derive(Clone, Debug)]
pub struct Bound {
    /// The variable, or a part of one.
    pub of: Factor,
    /// It is less than this.
    pub below: Product,
    /// Where.
    pub within: Span,
    /// The comparison.
    pub condition: ExprId,
}

/// All bounds of variables that nothing writes after their declaration.
pub fn bounds(shader: &Shader) -> Vec<Bound> {
    let mut found = Vec::new();
    for item in &shader.unit().items {
        if let ItemKind::Function(function) = &item.kind {
            function.body.iter().for_each(|body| block(shader, body, &mut found));
        }
    }
    found.retain(|bound: &Bound| bound.of.symbol.is_some_and(|symbol| !shader.is_written(symbol)));
    found
}

fn block(shader: &Shader, body: &Block, found: &mut Vec<Bound>) {
    for stmt in &body.statements {
        statement(shader, stmt, body.span.end, found);
    }
}

fn statement(shader: &Shader, stmt: &Stmt, end: usize, found: &mut Vec<Bound>) {
    match &stmt.kind {
        StmtKind::Block(inner) | StmtKind::Switch { selector: _, body: inner } => block(shader, inner, found),
        StmtKind::If { condition, then, otherwise } => {
            if leaves(then) && otherwise.is_none() {
                let rest = Span { start: stmt.span.end, end };
                compared(shader, *condition, false, rest, found);
            } else {
                compared(shader, *condition, true, then.span, found);
            }
            statement(shader, then, then.span.end, found);
            if let Some(otherwise) = otherwise {
                statement(shader, otherwise, otherwise.span.end, found);
            }
        }
        StmtKind::For { body, .. } | StmtKind::While { body, .. } | StmtKind::DoWhile { body, .. } => {
            statement(shader, body, body.span.end, found);
        }
        _ => {}
    }
}

/// True for a statement behind which nothing of its block runs.
fn leaves(stmt: &Stmt) -> bool {
    match &stmt.kind {
        StmtKind::Return(_) | StmtKind::Continue | StmtKind::Break | StmtKind::Discard => true,
        StmtKind::Block(block) => block.statements.last().is_some_and(leaves),
        _ => false,
    }
}

/// Bounds that hold where a condition is true, or where it is false.
fn compared(shader: &Shader, condition: ExprId, holds: bool, within: Span, found: &mut Vec<Bound>) {
    let ExprKind::Binary { op, left, right, .. } = shader.expr(bare(shader, condition)).kind else { return };
    let (smaller, larger) = match (op, holds) {
        (BinaryOp::And, true) | (BinaryOp::Or, false) => {
            compared(shader, left, holds, within, found);
            return compared(shader, right, holds, within, found);
        }
        (BinaryOp::Less, true) | (BinaryOp::GreaterEqual, false) => (left, right),
        (BinaryOp::Greater, true) | (BinaryOp::LessEqual, false) => (right, left),
        _ => return,
    };
    let own = product(shader, smaller);
    if let Some(of) = own.only().filter(|_| own.times > 0.0) {
        let limit = product(shader, larger);
        let below = Product { times: limit.times / own.times, ..limit };
        found.push(Bound { of: of.clone(), below, within, condition });
    }
}
