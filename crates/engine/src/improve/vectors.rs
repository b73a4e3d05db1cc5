//! Formulas about vectors for which a better one is known: lengths that overflow or vanish, angles by their cosine,
//! differences of squares.
//!
//! They pass the same proof as formulas that were found. A vector of length 1 is meant exactly; what binary32 made of
//! it is the input.

use ::improve::{Binary, Id, Node, Term, Unary};

use super::algebra;
use super::lower::{Leaf, Lowering, opaque, width};
use super::places::{IsUnit, Known};
use syntax::ast::{BinaryOp, ExprId, ExprKind};
use syntax::real::Reals;
use syntax::symbols::CallTarget;
use syntax::{BuiltinFunction as F, Shader};

/// What an expression about vectors is, with its leaves and its other terms.
pub(super) fn known(
    shader: &Shader,
    reals: &Reals,
    is_unit: IsUnit<'_>,
    id: ExprId,
) -> Option<(Term, Vec<Leaf>, Known)> {
    let mut form = VectorForm { shader, is_unit, leaves: Lowering::new(shader, reals, false) };
    let (term, known) = form.of(id)?;
    Some((term, form.leaves.leaves, known))
}

struct VectorForm<'a> {
    shader: &'a Shader,
    is_unit: IsUnit<'a>,
    /// Collects leaves; its own term is not used.
    leaves: Lowering<'a>,
}

/// The leaves of a vector, by their numbers.
type Vector = Vec<u32>;

impl VectorForm<'_> {
    fn of(&mut self, id: ExprId) -> Option<(Term, Known)> {
        match &self.shader.expr(id).kind {
            ExprKind::Binary { op: BinaryOp::Sub, left, right, .. } => self.squares(*left, *right),
            ExprKind::Binary { op: BinaryOp::Div, left, right, .. } => {
                let of = self.argument(*right, F::Length)?;
                self.same(*left, of).then(|| self.direction(of)).flatten()
            }
            ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } => {
                let by = |vector: ExprId, factor: ExprId| {
                    let square = self.argument(factor, F::Inversesqrt)?;
                    self.square(square).filter(|of| self.same(vector, *of))
                };
                let of = by(*left, *right).or_else(|| by(*right, *left))?;
                self.direction(of)
            }
            ExprKind::Call { .. } => {
                if let Some(of) = self.argument(id, F::Length) {
                    return self.long(of);
                }
                if let Some(of) = self.argument(id, F::Sqrt).and_then(|square| self.square(square)) {
                    return self.long(of);
                }
                if let Some(of) = self.argument(id, F::Normalize) {
                    return self.direction(of);
                }
                if let Some(cosine) = self.argument(id, F::Acos) {
                    return self.angle(cosine);
                }
                let [a, b] = self.arguments(id, F::Distance)?;
                let (a, b) = (self.vector(a)?, self.vector(b)?);
                Some(lengths(|term| {
                    let (a, b) = (nodes(term, &a), nodes(term, &b));
                    algebra::zip(term, Binary::Sub, &a, &b).unwrap_or_default()
                }))
            }
            _ => None,
        }
    }

    /// The argument of a call of a function of one argument.
    fn argument(&self, id: ExprId, function: F) -> Option<ExprId> {
        match (&self.shader.expr(self.bare(id)).kind, self.shader.callee(self.bare(id))) {
            (ExprKind::Call { args, .. }, Some(CallTarget::Builtin(call)))
                if call.function == function && args.len() == 1 =>
            {
                Some(self.bare(args[0]))
            }
            _ => None,
        }
    }

    fn arguments(&self, id: ExprId, function: F) -> Option<[ExprId; 2]> {
        match (&self.shader.expr(self.bare(id)).kind, self.shader.callee(self.bare(id))) {
            (ExprKind::Call { args, .. }, Some(CallTarget::Builtin(call))) if call.function == function => {
                let [a, b] = args[..] else { return None };
                Some([self.bare(a), self.bare(b)])
            }
            _ => None,
        }
    }

    /// Without parentheses around it.
    fn bare(&self, id: ExprId) -> ExprId {
        match self.shader.expr(id).kind {
            ExprKind::Paren(inner) => self.bare(inner),
            _ => id,
        }
    }

    fn same(&self, a: ExprId, b: ExprId) -> bool {
        self.shader.text_of(self.bare(a)) == self.shader.text_of(self.bare(b))
    }

    /// The vector of which something is the square: `dot(v, v)`.
    fn square(&self, id: ExprId) -> Option<ExprId> {
        let [a, b] = self.arguments(id, F::Dot)?;
        self.same(a, b).then_some(a)
    }

    /// The components of a vector as leaves. Calls are not repeated for each component.
    fn vector(&mut self, id: ExprId) -> Option<Vector> {
        let id = self.bare(id);
        let count = width(self.shader.type_of(id)).filter(|count| *count > 1)?;
        if self.calls(id) {
            return None;
        }
        let text = self.shader.text_of(id).to_owned();
        let why = opaque(self.shader, id);
        let drawn = why.is_some().then(|| self.leaves.drawn(id)).flatten();
        let one = |k: usize| {
            let drawn = drawn.clone();
            drawn.map(|drawn| super::lower::Drawn { terms: vec![drawn.terms[k].clone()], ..drawn })
        };
        let parts = (0..count).map(|k| self.leaves.component(&text, k, count, why.clone(), one(k)));
        let parts: Vec<Id> = parts.collect();
        parts
            .into_iter()
            .map(|id| match self.leaves.term[id] {
                Node::Leaf(k) => Some(k),
                _ => None,
            })
            .collect()
    }

    fn calls(&self, id: ExprId) -> bool {
        let expr = self.shader.expr(id);
        let own = matches!(expr.kind, ExprKind::Call { .. } | ExprKind::Assign { .. } | ExprKind::Postfix { .. })
            && !matches!(self.shader.callee(id), Some(CallTarget::Constructor(_)));
        own || expr.children().into_iter().any(|child| self.calls(child))
    }

    /// `length(v)`
    fn long(&mut self, of: ExprId) -> Option<(Term, Known)> {
        let vector = self.vector(of)?;
        Some(lengths(|term| nodes(term, &vector)))
    }

    /// `normalize(v)`: each component in turn.
    fn direction(&mut self, of: ExprId) -> Option<(Term, Known)> {
        let vector = self.vector(of)?;
        let terms: Vec<Term> = match self.leaves.drawn(of) {
            Some(drawn) => drawn.terms,
            None => return None,
        };
        let leaves = self.leaves.drawn(of)?.leaves;
        let text = self.shader.text_of(of).to_owned();
        let opaque = Some(format!("the components of `{text}`"));
        let drawn = Some(super::lower::Drawn { terms, leaves });
        self.leaves.leaves.push(Leaf { text, opaque, of: None, drawn });
        let each = u32::try_from(self.leaves.leaves.len() - 1).ok()?;
        let term = made(|term| {
            let parts = nodes(term, &vector);
            let length = algebra::length(term, &parts);
            let each = algebra::add(term, Node::Leaf(each));
            algebra::binary(term, Binary::Div, each, length)
        });
        let other = made(|term| {
            let parts = nodes(term, &vector);
            let (most, over) = algebra::scaled(term, &parts);
            let each = algebra::add(term, Node::Leaf(each));
            let each = algebra::binary(term, Binary::Div, each, most);
            let length = algebra::length(term, &over);
            algebra::binary(term, Binary::Div, each, length)
        });
        let known = Known { meant: term.clone(), others: vec![other] };
        Some((term, known))
    }

    /// `acos(dot(a, b))` of vectors of length 1 is the angle of |a × b| and a · b, which has no digits to lose near 0.
    fn angle(&mut self, cosine: ExprId) -> Option<(Term, Known)> {
        let [a, b] = self.arguments(self.unclamped(cosine), F::Dot)?;
        let (a, b) = (self.unit(a)?, self.unit(b)?);
        let planar = a.0.len() == 2;
        if a.0.len() != b.0.len() || !(2..=3).contains(&a.0.len()) {
            return None;
        }
        let by_cosine = |exact: bool| {
            made(|term| {
                let side = |term: &mut Term, (leaves, scaled): &(Vector, bool)| {
                    let parts = nodes(term, leaves);
                    if exact || *scaled { algebra::normalized(term, &parts) } else { parts }
                };
                let (a, b) = (side(term, &a), side(term, &b));
                let cosine = algebra::dot(term, &a, &b);
                algebra::unary(term, Unary::Acos, cosine)
            })
        };
        let other = made(|term| {
            let (a, b) = (nodes(term, &a.0), nodes(term, &b.0));
            let cosine = algebra::dot(term, &a, &b);
            let sine = if planar {
                let (p, q) =
                    (algebra::binary(term, Binary::Mul, a[0], b[1]), algebra::binary(term, Binary::Mul, a[1], b[0]));
                let area = algebra::binary(term, Binary::Sub, p, q);
                algebra::unary(term, Unary::Abs, area)
            } else {
                let area = algebra::cross(term, &a, &b).unwrap_or_default();
                algebra::length(term, &area)
            };
            algebra::binary(term, Binary::Atan2, sine, cosine)
        });
        Some((by_cosine(false), Known { meant: by_cosine(true), others: vec![other] }))
    }

    /// The cosine inside of `clamp(c, -1.0, 1.0)`, or behind a local variable that is set once.
    fn unclamped(&self, id: ExprId) -> ExprId {
        let id = self.bare(id);
        if let ExprKind::Call { args, .. } = &self.shader.expr(id).kind
            && let Some(CallTarget::Builtin(call)) = self.shader.callee(id)
            && call.function == F::Clamp
            && let [inner, low, high] = args[..]
            && [(low, -1.0), (high, 1.0)].iter().all(|(end, value)| self.is_number(*end, *value))
        {
            return self.unclamped(inner);
        }
        let name = matches!(self.shader.expr(id).kind, ExprKind::Name(_));
        self.set_to(id).filter(|_| name).map_or(id, |value| self.unclamped(value))
    }

    /// What a local variable is set to, where that is once.
    fn set_to(&self, id: ExprId) -> Option<ExprId> {
        Lowering::new(self.shader, self.leaves.reals, true).initial(self.shader.symbol_of(id)?)
    }

    fn is_number(&self, id: ExprId, value: f64) -> bool {
        self.leaves.reals.get(id).is_some_and(|real| real.values() == [value])
    }

    /// A vector of length 1: what is normalised here, with `true`, or is known to be.
    fn unit(&mut self, id: ExprId) -> Option<(Vector, bool)> {
        if let Some(inside) = self.argument(id, F::Normalize) {
            return Some((self.vector(inside)?, true));
        }
        let is_unit = self.set_to(id).is_some_and(|value| self.argument(value, F::Normalize).is_some())
            || (self.is_unit)(self.shader.text_of(id));
        is_unit.then(|| Some((self.vector(id)?, false))).flatten()
    }

    /// `dot(a, a) - dot(b, b)`, and the same of lengths.
    fn squares(&mut self, left: ExprId, right: ExprId) -> Option<(Term, Known)> {
        let lengths = [left, right].map(|id| self.argument(id, F::Length));
        let squares = [left, right].map(|id| self.square(self.bare(id)));
        let (a, b, rooted) = match (lengths, squares) {
            ([Some(a), Some(b)], _) => (a, b, true),
            (_, [Some(a), Some(b)]) => (a, b, false),
            _ => return None,
        };
        let (a, b) = (self.vector(a)?, self.vector(b)?);
        if a.len() != b.len() {
            return None;
        }
        let own = made(|term| {
            let (a, b) = (nodes(term, &a), nodes(term, &b));
            let of = |term: &mut Term, v: &[Id]| {
                if rooted { algebra::length(term, v) } else { algebra::dot(term, v, v) }
            };
            let (a, b) = (of(term, &a), of(term, &b));
            algebra::binary(term, Binary::Sub, a, b)
        });
        let other = made(|term| {
            let (a, b) = (nodes(term, &a), nodes(term, &b));
            let less = algebra::zip(term, Binary::Sub, &a, &b).unwrap_or_default();
            let more = algebra::zip(term, Binary::Add, &a, &b).unwrap_or_default();
            let product = algebra::dot(term, &less, &more);
            if !rooted {
                return product;
            }
            let (a, b) = (algebra::length(term, &a), algebra::length(term, &b));
            let sum = algebra::binary(term, Binary::Add, a, b);
            algebra::binary(term, Binary::Div, product, sum)
        });
        Some((own.clone(), Known { meant: own, others: vec![other] }))
    }
}

/// A length, and the same without overflow.
fn lengths(vector: impl Fn(&mut Term) -> Vec<Id>) -> (Term, Known) {
    let own = made(|term| {
        let parts = vector(term);
        algebra::length(term, &parts)
    });
    let other = made(|term| {
        let parts = vector(term);
        let (most, over) = algebra::scaled(term, &parts);
        let length = algebra::length(term, &over);
        algebra::binary(term, Binary::Mul, most, length)
    });
    (own.clone(), Known { meant: own, others: vec![other] })
}

/// A term whose root is what `of` returns.
fn made(of: impl FnOnce(&mut Term) -> Id) -> Term {
    let mut term = Term::default();
    let root = of(&mut term);
    ::improve::rooted(&term, root)
}

fn nodes(term: &mut Term, leaves: &[u32]) -> Vec<Id> {
    leaves.iter().map(|k| algebra::add(term, Node::Leaf(*k))).collect()
}
