//! Whether an entry point stores by the number of its invocation without comparing that number with anything.

use std::collections::BTreeSet;

use syntax::Shader;
use syntax::ast::{BinaryOp, Declarator, ExprId, ExprKind};
use syntax::symbols::{CallTarget, SymbolId};

use super::Kernel;
use crate::entry::root;
use syntax::walk;

/// The first store whose index follows from the number of the invocation, where nothing limits that number.
pub fn unguarded_store(shader: &Shader, kernel: &Kernel) -> Option<ExprId> {
    let mut numbers: BTreeSet<SymbolId> = shader.builtin("gl_GlobalInvocationID").into_iter().collect();
    numbers.extend(kernel.inputs.iter().filter(|i| i.2 == "global_invocation_id").map(|i| i.0));
    spread(shader, &mut numbers);
    let mut store = None;
    for (id, expr) in shader.arena().iter() {
        let follows = |id: &ExprId| mentions(shader, &numbers, *id);
        match &expr.kind {
            ExprKind::Binary { op, left, right, .. } => {
                let limits =
                    matches!(op, BinaryOp::Less | BinaryOp::Greater | BinaryOp::LessEqual | BinaryOp::GreaterEqual);
                if limits && (follows(left) || follows(right)) {
                    return None;
                }
            }
            ExprKind::Call { args, .. } if args.iter().any(follows) => match shader.callee(id) {
                Some(CallTarget::Constructor(_)) => {}
                // A function of the text, or `min`, `select` and the like, may limit it.
                _ => return None,
            },
            ExprKind::Ternary { condition, .. } if follows(condition) => return None,
            ExprKind::Assign { target, .. } if indices(shader, *target).iter().any(follows) && store.is_none() => {
                store = Some(*target);
            }
            _ => {}
        }
    }
    store
}

/// Adds the variables that get a value from those that are there.
fn spread(shader: &Shader, numbers: &mut BTreeSet<SymbolId>) {
    let mut declared: Vec<&Declarator> = Vec::new();
    walk::declarators(shader, |d| declared.push(d));
    loop {
        let before = numbers.len();
        for declarator in &declared {
            let Some(value) = declarator.initializer.as_ref().map(|i| i.value) else { continue };
            if mentions(shader, numbers, value) {
                let own = |(_, s): &(SymbolId, &syntax::symbols::Symbol)| s.span == Some(declarator.name.span);
                numbers.extend(shader.symbols().find(own).map(|(id, _)| id));
            }
        }
        for (_, expr) in shader.arena().iter() {
            if let ExprKind::Assign { target, value, .. } = &expr.kind
                && mentions(shader, numbers, *value)
                && indices(shader, *target).is_empty()
            {
                numbers.extend(root(shader, *target).map(|(symbol, _)| symbol));
            }
        }
        if numbers.len() == before {
            return;
        }
    }
}

/// True where the value is made of one of the variables: what is read from an array is another number, and a remainder
/// has a limit of its own.
fn mentions(shader: &Shader, numbers: &BTreeSet<SymbolId>, id: ExprId) -> bool {
    match &shader.expr(id).kind {
        ExprKind::Name(_) => shader.symbol_of(id).is_some_and(|s| numbers.contains(&s)),
        ExprKind::Index { base, index: _ } => mentions(shader, numbers, *base),
        ExprKind::Binary { op: BinaryOp::Rem, .. } => false,
        _ => shader.expr(id).children().into_iter().any(|child| mentions(shader, numbers, child)),
    }
}

/// The indices on the way to a place.
fn indices(shader: &Shader, id: ExprId) -> Vec<ExprId> {
    match &shader.expr(id).kind {
        ExprKind::Index { base, index } => {
            let mut found = indices(shader, *base);
            found.push(*index);
            found
        }
        ExprKind::Field { base, .. } | ExprKind::Paren(base) => indices(shader, *base),
        _ => Vec::new(),
    }
}

/// The arrays that are indexed on the way to a place.
pub fn indexed_arrays(shader: &Shader, id: ExprId) -> Vec<ExprId> {
    match &shader.expr(id).kind {
        ExprKind::Index { base, index: _ } => {
            let mut found = indexed_arrays(shader, *base);
            found.push(*base);
            found
        }
        ExprKind::Field { base, .. } | ExprKind::Paren(base) => indexed_arrays(shader, *base),
        _ => Vec::new(),
    }
}
