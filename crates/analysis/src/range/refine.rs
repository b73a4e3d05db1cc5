//! What conditions say about what they compare.

use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::types::{ScalarType, Type};

use super::eval::Machine;
use super::start::swizzle;
use super::value::{Evidence, Range, Sources};

impl Machine<'_> {
    /// Goes on where `condition` has the value `truth`.
    pub fn assume(&mut self, condition: ExprId, truth: bool) {
        let sources = self.look(condition).sources();
        // What the condition narrows is known behind it; in a loop it may bear the same mark already.
        let narrowed = self.narrow(condition, truth);
        self.state.path = self.state.path.and(sources.less(narrowed));
    }

    /// Gives the marks of what it narrowed.
    fn narrow(&mut self, condition: ExprId, truth: bool) -> Sources {
        let shader = self.shader;
        match &shader.expr(condition).kind {
            ExprKind::Paren(inner) => self.narrow(*inner, truth),
            ExprKind::Unary { op: UnaryOp::Not, op_span: _, operand } => self.narrow(*operand, !truth),
            ExprKind::Binary { op, op_span: _, left, right } => match (op, truth) {
                (BinaryOp::And, true) | (BinaryOp::Or, false) => {
                    let first = self.narrow(*left, truth);
                    first.and(self.narrow(*right, truth))
                }
                (BinaryOp::Less, true) | (BinaryOp::GreaterEqual, false) => self.below(*left, *right, true, truth),
                (BinaryOp::LessEqual, true) | (BinaryOp::Greater, false) => self.below(*left, *right, false, truth),
                (BinaryOp::Greater, true) | (BinaryOp::LessEqual, false) => self.below(*right, *left, true, truth),
                (BinaryOp::GreaterEqual, true) | (BinaryOp::Less, false) => self.below(*right, *left, false, truth),
                (BinaryOp::Equal, true) | (BinaryOp::NotEqual, false) => self.equal(*left, *right),
                (BinaryOp::NotEqual, true) | (BinaryOp::Equal, false) => {
                    let first = self.unequal(*left, *right);
                    first.and(self.unequal(*right, *left))
                }
                _ => Sources::NONE,
            },
            _ => Sources::NONE,
        }
    }

    /// `low < high` holds, or `low <= high`; or, when it is the opposite that is false, one is NaN.
    fn below(&mut self, low: ExprId, high: ExprId, strictly: bool, holds: bool) -> Sources {
        let (Some(a), Some(b)) = (self.range(low), self.range(high)) else { return Sources::NONE };
        let integer = self.is_integer(low) && self.is_integer(high);
        let nan = !holds;
        let mut below = Range { nan: a.nan && nan, ..a };
        if b.hi < a.hi || (strictly && b.hi == a.hi) {
            (below.hi, below.hi_by) = (if strictly { before(b.hi, integer) } else { b.hi }, Evidence::Bound);
        }
        let mut above = Range { nan: b.nan && nan, ..b };
        if a.lo > b.lo || (strictly && a.lo == b.lo) {
            (above.lo, above.lo_by) = (if strictly { -before(-a.lo, integer) } else { a.lo }, Evidence::Bound);
        }
        // A comparison with NaN is false, whatever the other side is.
        let mut narrowed = Sources::NONE;
        if holds || !b.nan {
            narrowed = narrowed.and(self.learn(low, below));
        }
        if holds || !a.nan {
            narrowed = narrowed.and(self.learn(high, above));
        }
        self.difference(low, high, strictly);
        narrowed
    }

    /// What a comparison of two expressions says about their difference.
    fn difference(&mut self, low: ExprId, high: ExprId, strictly: bool) {
        let (Some(l), Some(h)) = (self.keys.of(self.shader, low), self.keys.of(self.shader, high)) else { return };
        let mut positive = Range::of(0.0, f64::INFINITY, Evidence::Bound, Sources::ALL).or_nan();
        positive.nonzero = strictly;
        let negative = Range { lo: f64::NEG_INFINITY, hi: 0.0, ..positive };
        self.state.facts.insert(self.keys.of_binary(BinaryOp::Sub, h, l), positive);
        self.state.facts.insert(self.keys.of_binary(BinaryOp::Sub, l, h), negative);
    }

    fn equal(&mut self, left: ExprId, right: ExprId) -> Sources {
        let (Some(a), Some(b)) = (self.range(left), self.range(right)) else { return Sources::NONE };
        let (lo, hi) = (a.lo.max(b.lo), a.hi.min(b.hi));
        let both = Range { lo, hi, nan: false, nonzero: a.nonzero || b.nonzero, ..a }.vague();
        self.learn(left, both).and(self.learn(right, both))
    }

    fn unequal(&mut self, left: ExprId, right: ExprId) -> Sources {
        if let (Some(a), Some(b)) = (self.range(left), self.range(right))
            && b.single() == Some(0.0)
        {
            return self.learn(left, Range { nonzero: true, ..a });
        }
        Sources::NONE
    }

    /// The range of a scalar.
    fn range(&mut self, id: ExprId) -> Option<Range> {
        let value = self.look(id);
        match value.parts.as_slice() {
            [only] => Some(*only),
            _ => None,
        }
    }

    fn is_integer(&self, id: ExprId) -> bool {
        self.shader.type_of(id).scalar().is_some_and(ScalarType::is_integer)
    }

    /// Keeps the range of an expression until a variable in it is written. What is narrowed by the
    /// condition itself is as well known as before: only what else depends on the condition is not.
    fn learn(&mut self, id: ExprId, range: Range) -> Sources {
        if self.shader.fold(id).is_some() || range.lo > range.hi {
            return Sources::NONE;
        }
        let Some(key) = self.keys.of(self.shader, id) else { return Sources::NONE };
        let sources = Sources::narrowed(id.index());
        let range = Range { sources, ..range };
        self.keep(id, range);
        self.state.facts.insert(key, range);
        sources
    }

    /// Narrows a variable or a component of one, so that it stays narrow where branches meet.
    fn keep(&mut self, id: ExprId, range: Range) {
        let shader = self.shader;
        let (name, part) = match &shader.expr(id).kind {
            ExprKind::Paren(inner) => return self.keep(*inner, range),
            ExprKind::Name(_) => (id, Some(0)),
            ExprKind::Field { base, field } if matches!(shader.type_of(*base), Type::Vector(..)) => {
                (*base, swizzle(&field.name).next().flatten())
            }
            _ => return,
        };
        let (Some(symbol), Some(part)) = (shader.symbol_of(name), part) else { return };
        let mut value = self.state.vars.get(&symbol).cloned().unwrap_or_else(|| self.beginning(symbol));
        if let Some(slot) = value.parts.get_mut(part) {
            *slot = range;
            self.state.vars.insert(symbol, value);
        }
    }
}

/// The next number below.
fn before(x: f64, integer: bool) -> f64 {
    if integer {
        return x - 1.0;
    }
    #[expect(clippy::cast_possible_truncation, reason = "the next binary32 number is what is asked for")]
    let near = x as f32;
    let next = f64::from(near.next_down());
    // A number between two of binary32 is its own bound.
    if f64::from(near) == x { next } else { x }
}
