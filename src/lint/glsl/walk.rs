//! Walks over the declarations and expressions of a shader.

use crate::glsl::Shader;
use crate::glsl::ast::{Condition, Declaration, Declarator, ExprId, ItemKind, Stmt, StmtKind};

/// Calls `visit` for every variable that is declared outside structures and blocks: global and local.
pub fn declarators<'s>(shader: &'s Shader, mut visit: impl FnMut(&'s Declarator)) {
    let mut pending: Vec<&'s Stmt> = Vec::new();
    let mut declared: Vec<&'s Declaration> = Vec::new();
    for item in &shader.unit().items {
        match &item.kind {
            ItemKind::Declaration(declaration) => declared.push(declaration),
            ItemKind::Function(function) => pending.extend(function.body.iter().flat_map(|b| &b.statements)),
            ItemKind::Block(_)
            | ItemKind::Qualified(_)
            | ItemKind::Precision(_)
            | ItemKind::Empty
            | ItemKind::Error => {}
        }
    }
    while let Some(stmt) = pending.pop() {
        match &stmt.kind {
            StmtKind::Declaration(declaration) => declared.push(declaration),
            StmtKind::Block(block) | StmtKind::Switch { selector: _, body: block } => pending.extend(&block.statements),
            StmtKind::If { condition: _, then, otherwise } => {
                pending.push(then);
                pending.extend(otherwise.as_deref());
            }
            StmtKind::For { init, condition, step: _, body, head_span: _ } => {
                pending.extend([init.as_ref(), body.as_ref()]);
                if let Some(Condition::Declaration(declaration)) = condition {
                    declared.push(declaration);
                }
            }
            StmtKind::While { condition, body } => {
                pending.push(body);
                if let Condition::Declaration(declaration) = condition {
                    declared.push(declaration);
                }
            }
            StmtKind::DoWhile { body, condition: _ } => pending.push(body),
            StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Expr(_)
            | StmtKind::Case(_)
            | StmtKind::Default
            | StmtKind::Return(_)
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard
            | StmtKind::Error => {}
        }
    }
    declared.iter().flat_map(|d| &d.declarators).for_each(&mut visit);
}

/// An expression and all below it, in no certain order.
pub fn expressions(shader: &Shader, root: ExprId) -> Vec<ExprId> {
    let mut all = vec![root];
    let mut next = 0;
    while let Some(&id) = all.get(next) {
        all.extend(shader.expr(id).children());
        next += 1;
    }
    all
}
