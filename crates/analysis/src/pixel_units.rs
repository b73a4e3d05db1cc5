//! What is known of an expression whose variables count pixels.

use syntax::ast::{BinaryOp, ExprId, ExprKind, UnaryOp};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, SymbolId, SymbolKind};
use syntax::types::Type;

use crate::forms::builtin;
use crate::names;
use crate::numeric::{bare, constant};
use crate::pixel_names::said;
use crate::pixels::Pixels;
use crate::pixels::Unit::{self, Free, Known, Unknown};

impl Pixels<'_> {
    /// What is known of an expression.
    pub fn unit(&self, id: ExprId) -> Unit {
        let shader = self.shader;
        if constant(shader, id).is_some() {
            return Free;
        }
        match &shader.expr(id).kind {
            ExprKind::Literal(_) => Free,
            ExprKind::Name(_) => match shader.symbol_of(id) {
                Some(symbol) => match self.of.get(&symbol) {
                    Some((power, seed)) => Known(*power, *seed),
                    None if shader.symbol(symbol).value.is_some() => Free,
                    None => Unknown,
                },
                None => Unknown,
            },
            ExprKind::Paren(inner)
            | ExprKind::Index { base: inner, .. }
            | ExprKind::Unary { op: UnaryOp::Plus | UnaryOp::Minus, operand: inner, .. } => self.unit(*inner),
            ExprKind::Field { base, field } => self.part(*base, &field.name),
            ExprKind::Binary { op: BinaryOp::Sub, left, right, .. }
                if self.is_rest(*left, *right) || self.is_rest(*right, *left) =>
            {
                Unknown
            }
            ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, left, right, .. } => {
                one_of([self.unit(*left), self.unit(*right)])
            }
            ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } => {
                match (self.unit(*left), self.unit(*right)) {
                    (Known(a, seed), Known(b, _)) => Known(a + b, seed),
                    (Known(a, seed), Free) | (Free, Known(a, seed)) => Known(a, seed),
                    (Free, Free) => Free,
                    // A share of a size.
                    (Known(1, seed), Unknown) if self.is_size(*left) && self.varies(*right) => Known(1, seed),
                    (Unknown, Known(1, seed)) if self.is_size(*right) && self.varies(*left) => Known(1, seed),
                    // A length in other units.
                    (Known(1, seed), Unknown) if self.is_along(seed) && !self.varies(*right) => Known(1, seed),
                    (Unknown, Known(1, seed)) if self.is_along(seed) && !self.varies(*left) => Known(1, seed),
                    _ => Unknown,
                }
            }
            ExprKind::Binary { op: BinaryOp::Div, left, right, .. } => match (self.unit(*left), self.unit(*right)) {
                (Known(a, seed), Known(b, _)) => Known(a - b, seed),
                (Known(a, seed), Free) => Known(a, seed),
                (Free, Known(b, seed)) => Known(-b, seed),
                (Free, Free) => Free,
                (Unknown, Known(-1, seed)) if self.is_size(*right) && self.varies(*left) => Known(1, seed),
                (Known(1, seed), Unknown) if self.is_along(seed) && !self.varies(*right) => Known(1, seed),
                _ => Unknown,
            },
            ExprKind::Ternary { yes, no, .. } => one_of([self.unit(*yes), self.unit(*no)]),
            ExprKind::Assign { op: None, value, .. } => self.unit(*value),
            ExprKind::Call { args, .. } => self.call(id, args),
            _ => Unknown,
        }
    }

    fn call(&self, id: ExprId, args: &[ExprId]) -> Unit {
        let shader = self.shader;
        if matches!(shader.callee(id), Some(CallTarget::Constructor(_))) {
            return one_of(args.iter().map(|arg| self.unit(*arg)));
        }
        let names = [
            "abs",
            "floor",
            "ceil",
            "round",
            "trunc",
            "min",
            "max",
            "clamp",
            "mix",
            "mod",
            "length",
            "distance",
            "dot",
            "pow",
            "sqrt",
            "inversesqrt",
            "normalize",
            "sign",
            "step",
            "smoothstep",
            "fract",
            "sin",
            "cos",
        ];
        let Some((name, args)) = builtin(shader, id, &names) else { return Unknown };
        let first = args.first().map_or(Unknown, |arg| self.unit(*arg));
        match (name, first) {
            // What ends at a constant is none of the large numbers.
            ("min" | "clamp", Known(..)) if args.last().is_some_and(|end| self.unit(*end) == Free) => Unknown,
            ("min" | "max" | "clamp" | "distance", _) => one_of(args.iter().map(|arg| self.unit(*arg))),
            ("mix", _) => one_of(args.iter().take(2).map(|arg| self.unit(*arg))),
            ("dot", Known(a, seed)) => match args.get(1).map(|arg| self.unit(*arg)) {
                Some(Known(b, _)) => Known(a + b, seed),
                _ => Unknown,
            },
            ("pow", Known(a, seed)) if args.get(1).and_then(|e| constant(shader, *e)) == Some(2.0) => {
                Known(2 * a, seed)
            }
            ("sqrt", Known(a, seed)) if a % 2 == 0 => Known(a / 2, seed),
            ("inversesqrt", Known(a, seed)) if a % 2 == 0 => Known(-a / 2, seed),
            ("normalize" | "sign" | "step" | "smoothstep" | "fract" | "sin" | "cos", Known(_, seed)) => Known(0, seed),
            ("abs" | "floor" | "ceil" | "round" | "trunc" | "mod" | "length", known) => known,
            _ => Unknown,
        }
    }

    /// Components of a vector. One of four that is called a size has the step from one texel to the next beside it.
    fn part(&self, base: ExprId, field: &str) -> Unit {
        let whole = self.unit(base);
        let Type::Vector(_, size) = self.shader.type_of(base) else { return Unknown };
        let Known(power, seed) = whole else { return whole };
        let last = field.chars().all(|c| "zwbapq".contains(c));
        match (names::of(self.shader, base), last && *size == 4) {
            (Some("gl_FragCoord"), true) => Unknown,
            (Some(_), true) if self.is_size(base) => Known(-power, seed),
            _ => whole,
        }
    }

    /// `x - clamp(x, …)`, `x - floor(x)`, and the same with a variable for the second: what is left is small.
    fn is_rest(&self, left: ExprId, right: ExprId) -> bool {
        let shader = self.shader;
        let text = shader.text_of(bare(shader, left));
        let mut at = bare(shader, right);
        for _ in 0..4 {
            at = match &shader.expr(at).kind {
                ExprKind::Name(_) => match shader.symbol_of(at).and_then(|symbol| self.initial(symbol).next()) {
                    Some(value) => bare(shader, value),
                    None => return false,
                },
                ExprKind::Field { base, .. } => bare(shader, *base),
                ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Sub, left, right, .. }
                    if self.unit(*right) == Free =>
                {
                    bare(shader, *left)
                }
                _ => break,
            };
        }
        if builtin(shader, at, &["floor", "round", "ceil", "trunc"]).is_some() {
            return true;
        }
        let cut = builtin(shader, at, &["clamp", "min", "max"]);
        cut.is_some_and(|(_, args)| args.iter().any(|arg| shader.text_of(bare(shader, *arg)) == text))
    }

    /// True for a difference that is small, for its magnitude, and for the larger of two.
    pub(super) fn is_left_over(&self, id: ExprId, depth: usize) -> bool {
        let id = bare(self.shader, id);
        let deeper = |id: &ExprId| depth < 4 && self.is_left_over(*id, depth + 1);
        match &self.shader.expr(id).kind {
            ExprKind::Name(_) => {
                self.shader.symbol_of(id).is_some_and(|symbol| self.initial(symbol).any(|value| deeper(&value)))
            }
            ExprKind::Field { base, .. } => deeper(base),
            ExprKind::Binary { op: BinaryOp::Sub, left, right, .. } => {
                self.is_rest(*left, *right) || self.is_rest(*right, *left)
            }
            _ => builtin(self.shader, id, &["abs", "min", "max"])
                .is_some_and(|(_, args)| !args.is_empty() && args.iter().all(deeper)),
        }
    }

    /// True for a uniform whose name says that it is a size in pixels, or a step.
    fn is_size(&self, id: ExprId) -> bool {
        let shader = self.shader;
        match &shader.expr(bare(shader, id)).kind {
            ExprKind::Name(name) => said(name).is_some() && shader.symbol_of(id).is_none_or(|s| self.is_uniform(s)),
            ExprKind::Field { base, .. } => self.is_size(*base),
            _ => false,
        }
    }

    fn is_uniform(&self, symbol: SymbolId) -> bool {
        matches!(self.shader.symbol(symbol).kind, SymbolKind::Global(Storage::Uniform) | SymbolKind::BlockMember(_))
    }

    /// True for what is computed from what a stage gets for each vertex or pixel.
    pub fn varies(&self, id: ExprId) -> bool {
        let shader = self.shader;
        match &shader.expr(id).kind {
            ExprKind::Name(_) => shader.symbol_of(id).is_some_and(|symbol| {
                matches!(
                    shader.symbol(symbol).kind,
                    SymbolKind::Global(Storage::In | Storage::Out) | SymbolKind::Local | SymbolKind::Param(_)
                )
            }),
            _ => shader.expr(id).children().into_iter().any(|child| self.varies(child)),
        }
    }
}

/// What values have of which each is what the others are; constants fit all.
fn one_of(units: impl IntoIterator<Item = Unit>) -> Unit {
    let join = |a: Unit, b: Unit| match (a, b) {
        (Free, other) | (other, Free) => other,
        (Known(x, seed), Known(y, _)) if x == y => Known(x, seed),
        _ => Unknown,
    };
    units.into_iter().reduce(join).unwrap_or(Unknown)
}
