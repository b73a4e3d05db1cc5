//! Walks over the declarations and expressions of a shader.

use std::collections::{HashMap, HashSet};

use crate::Shader;
use crate::ast::{Condition, Declaration, Declarator, ExprId, ItemKind, Stmt, StmtKind};
use crate::symbols::{SymbolId, SymbolKind};

/// Calls `visit` for every variable that is declared outside structures and blocks: global and local.
pub fn declarators<'s>(shader: &'s Shader, mut visit: impl FnMut(&'s Declarator)) {
    let mut declared: Vec<&'s Declaration> = Vec::new();
    for item in &shader.unit().items {
        if let ItemKind::Declaration(declaration) = &item.kind {
            declared.push(declaration);
        }
    }
    statements(shader, |stmt| match &stmt.kind {
        StmtKind::Declaration(declaration)
        | StmtKind::For { condition: Some(Condition::Declaration(declaration)), .. }
        | StmtKind::While { condition: Condition::Declaration(declaration), .. } => declared.push(declaration),
        _ => {}
    });
    declared.iter().flat_map(|d| &d.declarators).for_each(&mut visit);
}

/// The value of each local variable that is given one where it is declared, and is written nowhere else.
pub fn initial_values(shader: &Shader) -> HashMap<SymbolId, ExprId> {
    let written: HashSet<SymbolId> = shader.uses().iter().filter(|u| u.access.writes()).map(|u| u.symbol).collect();
    let locals: HashMap<usize, SymbolId> = shader
        .symbols()
        .filter(|(id, s)| s.kind == SymbolKind::Local && !written.contains(id))
        .filter_map(|(id, s)| Some((s.span?.start, id)))
        .collect();
    let mut values = HashMap::new();
    declarators(shader, |d| {
        if let (Some(symbol), Some(value)) = (locals.get(&d.name.span.start), &d.initializer) {
            values.insert(*symbol, value.value);
        }
    });
    values
}

/// True when a statement of a function could not be read.
pub fn has_errors(shader: &Shader) -> bool {
    let mut found = false;
    statements(shader, |stmt| found |= stmt.kind == StmtKind::Error);
    found
}

/// Calls `visit` for every statement of every function, those inside other statements included.
pub fn statements<'s>(shader: &'s Shader, mut visit: impl FnMut(&'s Stmt)) {
    let mut pending: Vec<&'s Stmt> = Vec::new();
    for item in &shader.unit().items {
        if let ItemKind::Function(function) = &item.kind {
            pending.extend(function.body.iter().flat_map(|b| &b.statements));
        }
    }
    while let Some(stmt) = pending.pop() {
        visit(stmt);
        match &stmt.kind {
            StmtKind::Block(block) | StmtKind::Switch { selector: _, body: block } => pending.extend(&block.statements),
            StmtKind::If { condition: _, then, otherwise } => {
                pending.push(then);
                pending.extend(otherwise.as_deref());
            }
            StmtKind::For { init, condition: _, step: _, body, head_span: _ } => {
                pending.extend([init.as_ref(), body.as_ref()]);
            }
            StmtKind::While { condition: _, body } | StmtKind::DoWhile { body, condition: _ } => pending.push(body),
            StmtKind::Declaration(_)
            | StmtKind::Empty
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
