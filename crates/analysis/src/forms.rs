//! What rules share that look at the form of expressions: parents, values of variables that are written once, factors.

use std::collections::{BTreeSet, HashMap};

use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, ExprId, ExprKind};
use syntax::symbols::{CallTarget, SymbolId};
use syntax::types::Type;

use crate::numeric::{bare, constant};
use syntax::walk::initial_values;

/// Variables that are followed to what they are declared as, one in the other.
const MOST_NAMES: usize = 4;

/// The expressions of a shader with what stands around them.
pub struct Forms<'s> {
    shader: &'s Shader,
    parents: Vec<Option<ExprId>>,
    initial: HashMap<SymbolId, ExprId>,
}

impl<'s> Forms<'s> {
    /// Looks at all expressions.
    pub fn new(shader: &'s Shader) -> Self {
        let mut parents = vec![None; shader.arena().len()];
        for (id, expr) in shader.arena().iter() {
            expr.children().iter().for_each(|c| parents[c.index()] = Some(id));
        }
        Self { shader, parents, initial: initial_values(shader) }
    }

    /// What an expression is an operand of; parentheses do not count.
    pub fn parent(&self, id: ExprId) -> Option<ExprId> {
        let parent = self.parents[id.index()]?;
        if matches!(self.shader.expr(parent).kind, ExprKind::Paren(_)) { self.parent(parent) } else { Some(parent) }
    }

    /// All that an expression is a part of, from the inside.
    pub fn around(&self, id: ExprId) -> impl Iterator<Item = ExprId> {
        std::iter::successors(self.parent(id), |id| self.parent(*id))
    }

    /// What an expression stands for: without parentheses, and for a local variable that is written nowhere else what
    /// it is declared as.
    pub fn value(&self, id: ExprId) -> ExprId {
        let mut id = bare(self.shader, id);
        for _ in 0..MOST_NAMES {
            let Some(value) = self.shader.symbol_of(id).and_then(|s| self.initial.get(&s)) else { break };
            id = bare(self.shader, *value);
        }
        id
    }

    /// The variables in an expression, in those that it stands for too.
    pub fn symbols(&self, id: ExprId) -> BTreeSet<SymbolId> {
        let mut found = BTreeSet::new();
        let mut pending = vec![(id, 0)];
        while let Some((id, depth)) = pending.pop() {
            if let Some(symbol) = self.shader.symbol_of(id) {
                found.insert(symbol);
                if let (Some(value), true) = (self.initial.get(&symbol), depth < MOST_NAMES) {
                    pending.push((*value, depth + 1));
                }
            }
            pending.extend(self.shader.expr(id).children().into_iter().map(|c| (c, depth)));
        }
        found
    }

    /// The factors of a product of products and quotients: those above the line, and those below it.
    pub fn factors(&self, id: ExprId) -> (Vec<ExprId>, Vec<ExprId>) {
        let (mut above, mut below) = (Vec::new(), Vec::new());
        let mut pending = vec![(id, true)];
        while let Some((id, up)) = pending.pop() {
            let id = bare(self.shader, id);
            match self.shader.expr(id).kind {
                ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } => {
                    pending.extend([(right, up), (left, up)]);
                }
                ExprKind::Binary { op: BinaryOp::Div, op_span: _, left, right } => {
                    pending.extend([(right, !up), (left, up)]);
                }
                _ if up => above.push(id),
                _ => below.push(id),
            }
        }
        (above, below)
    }

    /// The vector whose square an expression is, or the difference of which it is the length: `dot(v, v)`, `length(v)`,
    /// `distance(a, b)`. Gives the two points between which it is the distance.
    pub fn between(&self, id: ExprId) -> Option<(ExprId, ExprId)> {
        let shader = self.shader;
        let (name, args) = builtin(shader, self.value(id), &["dot", "length", "distance"])?;
        let vector = match (name, args) {
            ("distance", [a, b]) => return Some((*a, *b)),
            ("length", [v]) => *v,
            ("dot", [v, w]) if shader.text_of(*v) == shader.text_of(*w) => *v,
            _ => return None,
        };
        match shader.expr(self.value(vector)).kind {
            ExprKind::Binary { op: BinaryOp::Sub, op_span: _, left, right } => Some((left, right)),
            _ => None,
        }
    }
}

/// The name and arguments of a call of one of these built-in functions, parentheses aside.
pub fn builtin<'s>(shader: &'s Shader, id: ExprId, names: &[&str]) -> Option<(&'s str, &'s [ExprId])> {
    let id = bare(shader, id);
    let ExprKind::Call { callee: Callee::Name(name), args } = &shader.expr(id).kind else { return None };
    let builtin = matches!(shader.callee(id), Some(CallTarget::Builtin(_)));
    (builtin && names.contains(&name.name.as_str())).then_some((name.name.as_str(), args.as_slice()))
}

/// The arguments of a constructor of this type, parentheses aside.
pub fn constructed<'s>(shader: &'s Shader, id: ExprId, ty: &Type) -> Option<&'s [ExprId]> {
    let id = bare(shader, id);
    match (&shader.expr(id).kind, shader.callee(id)) {
        (ExprKind::Call { callee: _, args }, Some(CallTarget::Constructor(to))) if to == ty => Some(args),
        _ => None,
    }
}

/// True when a name behind a dot after this is a member of a structure or block, and no swizzle.
pub fn is_member(shader: &Shader, base: ExprId) -> bool {
    !matches!(shader.type_of(base), Type::Vector(..) | Type::Scalar(_))
}

/// The matrix and the vector of a product `m * v`.
pub fn product(shader: &Shader, id: ExprId) -> Option<(ExprId, ExprId)> {
    let ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } = shader.expr(bare(shader, id)).kind else {
        return None;
    };
    let matrix = matches!(shader.type_of(left), Type::Matrix(..)) && matches!(shader.type_of(right), Type::Vector(..));
    matrix.then_some((left, right))
}

/// True for `x * x`, `dot(v, v)` and `pow(x, 2.0)`.
pub fn is_square(shader: &Shader, id: ExprId) -> bool {
    let id = bare(shader, id);
    let same = |a: ExprId, b: ExprId| shader.text_of(bare(shader, a)) == shader.text_of(bare(shader, b));
    match shader.expr(id).kind {
        ExprKind::Binary { op: BinaryOp::Mul, op_span: _, left, right } => same(left, right),
        _ => match builtin(shader, id, &["dot", "pow"]) {
            Some(("dot", [a, b])) => same(*a, *b),
            Some(("pow", [_, y])) => constant(shader, *y) == Some(2.0),
            _ => false,
        },
    }
}
