//! Expressions of a shader as terms: what is a number of binary32 and made of operations that rules know, with local
//! variables that are set once written out.

use ::improve::{Binary, Component, Id, Node, Term, Unary};

use base::text::Span;
use syntax::BuiltinFunction as F;
use syntax::Shader;
use syntax::ast::{BinaryOp, ExprId, ExprKind, Function, StmtKind, UnaryOp};
use syntax::real::Reals;
use syntax::swizzle::component;
use syntax::symbols::{CallTarget, SymbolId, SymbolKind};
use syntax::types::{ScalarType, Type};

use super::algebra;

/// Nodes of a term beyond which an expression is left alone.
pub(super) const MOST_NODES: usize = 160;

/// Denominators of multiples of π that constants are taken for.
const PARTS_OF_PI: [f64; 12] = [1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 90.0, 180.0, 360.0, 720.0];

/// A constant that is so near to a multiple of π, as part of its size, is one.
const NEAR_PI: f64 = 2e-7;

/// A part of a term that is no operation that rules know.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Leaf {
    /// Its text.
    pub text: String,
    /// An input, or why its values are not known.
    pub opaque: Option<String>,
    /// The vector that it is a component of.
    pub of: Option<Component>,
    /// How its values follow from inputs, where it is none itself.
    pub drawn: Option<Drawn>,
}

/// Values that follow from others.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// One term; as many as a vector has components where the leaf stands for each of them in turn.
    pub terms: Vec<Term>,
    /// What the terms are made of.
    pub leaves: Vec<Leaf>,
}

pub(super) fn is_float(ty: &Type) -> bool {
    matches!(ty, Type::Scalar(ScalarType::Float))
}

/// Components of a vector of binary32, or 1 of a number.
pub(super) fn width(ty: &Type) -> Option<usize> {
    match ty {
        Type::Scalar(ScalarType::Float) => Some(1),
        Type::Vector(ScalarType::Float, n) => Some(usize::from(*n)),
        _ => None,
    }
}

/// A text that a component can be taken of.
pub(super) fn as_base(text: &str) -> String {
    let plain = text.chars().all(|c| c.is_alphanumeric() || "_.[]".contains(c));
    if plain { text.to_owned() } else { format!("({text})") }
}

/// Writes expressions out as terms.
pub(super) struct Lowering<'a> {
    pub(super) shader: &'a Shader,
    pub(super) reals: &'a Reals,
    pub(super) term: Term,
    pub(super) leaves: Vec<Leaf>,
    pub(super) inlined: Vec<SymbolId>,
    /// Vectors are written out in components, for their values; else what reduces one to a number is a leaf.
    pub(super) in_components: bool,
}

impl<'a> Lowering<'a> {
    pub(super) fn new(shader: &'a Shader, reals: &'a Reals, in_components: bool) -> Self {
        Self { shader, reals, term: Term::default(), leaves: Vec::new(), inlined: Vec::new(), in_components }
    }

    fn add(&mut self, node: Node) -> Option<Id> {
        Some(self.term.add(node))
    }

    fn number(&mut self, value: f64) -> Option<Id> {
        self.add(Node::number(value))
    }

    fn binary(&mut self, op: Binary, a: Id, b: Id) -> Option<Id> {
        self.add(Node::Binary(op, [a, b]))
    }

    /// A constant: a multiple of π, or of its reciprocal, where it is one.
    fn constant(&mut self, value: f64) -> Option<Id> {
        for (part, over) in [(value / std::f64::consts::PI, false), (value * std::f64::consts::PI, true)] {
            let found = PARTS_OF_PI.iter().find(|q| {
                let p = (part * **q).round();
                p != 0.0 && p.abs() <= 720.0 && ((part * **q - p) / p).abs() <= NEAR_PI
            });
            // 1 is no 22/7 of π: short numbers are what they are.
            if let Some(q) = found.filter(|_| value.fract() != 0.0) {
                let p = (part * q).round();
                let (p, q, pi) = (self.number(p)?, self.number(*q)?, self.add(Node::Pi)?);
                let part = self.binary(Binary::Div, p, q)?;
                return if over { self.binary(Binary::Div, part, pi) } else { self.binary(Binary::Mul, part, pi) };
            }
        }
        self.number(value)
    }

    pub(super) fn expression(&mut self, id: ExprId) -> Option<Id> {
        if let Some(real) = self.reals.get(id).and_then(|real| real.values().first().copied()) {
            return self.constant(real);
        }
        match &self.shader.expr(id).kind {
            ExprKind::Paren(inner) => self.expression(*inner),
            ExprKind::Name(_) => self.name(id),
            ExprKind::Unary { op: UnaryOp::Minus, operand, .. } => {
                let x = self.scalar(*operand)?;
                self.add(Node::Unary(Unary::Neg, x))
            }
            ExprKind::Unary { op: UnaryOp::Plus, operand, .. } => self.scalar(*operand),
            ExprKind::Binary { op, left, right, .. } => {
                let Some(op) = arithmetic(*op) else { return self.leaf(id) };
                if !self.is_scalar(*left) || !self.is_scalar(*right) {
                    return self.leaf(id);
                }
                let (a, b) = (self.expression(*left)?, self.expression(*right)?);
                self.binary(op, a, b)
            }
            ExprKind::Call { args, .. } => self.call(id, args),
            _ => self.leaf(id),
        }
    }

    fn is_scalar(&self, id: ExprId) -> bool {
        is_float(self.shader.type_of(id)) || self.reals.get(id).is_some_and(|real| real.values().len() == 1)
    }

    fn scalar(&mut self, id: ExprId) -> Option<Id> {
        if self.is_scalar(id) { self.expression(id) } else { None }
    }

    /// A variable: what it was set to, where it is set once and that is known.
    fn name(&mut self, id: ExprId) -> Option<Id> {
        let Some(symbol) = self.shader.symbol_of(id) else { return self.leaf(id) };
        match self.initial(symbol) {
            Some(value) => {
                if !self.inlined.contains(&symbol) {
                    self.inlined.push(symbol);
                }
                self.expression(value)
            }
            None => self.leaf(id),
        }
    }

    /// What a local variable is declared as, where nothing that it is made of is ever set to something else.
    pub(super) fn initial(&self, symbol: SymbolId) -> Option<ExprId> {
        let local = self.shader.symbol(symbol);
        let number = is_float(&local.ty) || (self.in_components && width(&local.ty).is_some());
        if local.kind != SymbolKind::Local || !number || self.shader.is_written(symbol) {
            return None;
        }
        let span = local.span?;
        let value = declared(self.shader, span)?;
        let same = if is_float(&local.ty) { self.is_scalar(value) } else { *self.shader.type_of(value) == local.ty };
        (same && self.stays(value)).then_some(value)
    }

    fn stays(&self, id: ExprId) -> bool {
        let own = match &self.shader.expr(id).kind {
            ExprKind::Name(_) => self.shader.symbol_of(id).is_none_or(|symbol| {
                let local = self.shader.symbol(symbol);
                // Names of inner blocks may mean something else where the expression is used.
                let visible = local.kind != SymbolKind::Local || self.initial(symbol).is_some();
                visible && !self.shader.is_written(symbol)
            }),
            ExprKind::Assign { .. } | ExprKind::Postfix { .. } => false,
            ExprKind::Call { .. } => {
                matches!(self.shader.callee(id), Some(CallTarget::Builtin(_) | CallTarget::Constructor(_)))
            }
            _ => true,
        };
        own && self.shader.expr(id).children().into_iter().all(|child| self.stays(child))
    }

    fn leaf(&mut self, id: ExprId) -> Option<Id> {
        if !is_float(self.shader.type_of(id)) {
            return None;
        }
        if self.in_components
            && let Some(parts) = self.written_out(id)
        {
            return parts.first().copied();
        }
        let text = self.shader.text_of(id).to_owned();
        let k = match self.leaves.iter().position(|leaf| leaf.text == text) {
            Some(k) => k,
            None => {
                let opaque = opaque(self.shader, id);
                let drawn = opaque.is_some().then(|| self.drawn(id)).flatten();
                self.leaves.push(Leaf { text, opaque, drawn, ..Leaf::default() });
                self.leaves.len() - 1
            }
        };
        self.add(Node::Leaf(u32::try_from(k).ok()?))
    }

    /// How the values of an expression follow from inputs, where they do.
    pub(super) fn drawn(&self, id: ExprId) -> Option<Drawn> {
        if self.in_components {
            return None;
        }
        let mut values = Self::new(self.shader, self.reals, true);
        let roots = values.parts(id)?;
        let known = values.leaves.iter().any(|leaf| leaf.opaque.is_none()) && values.term.len() <= 4 * MOST_NODES;
        known.then(|| Drawn {
            terms: roots.into_iter().map(|root| ::improve::rooted(&values.term, root)).collect(),
            leaves: values.leaves.clone(),
        })
    }

    /// The components of a vector, or a number.
    pub(super) fn parts(&mut self, id: ExprId) -> Option<Vec<Id>> {
        if self.is_scalar(id) {
            return Some(vec![self.expression(id)?]);
        }
        let count = width(self.shader.type_of(id))?;
        if let Some(real) = self.reals.get(id).filter(|real| real.values().len() == count) {
            let values = real.values().to_vec();
            return values.into_iter().map(|value| self.constant(value)).collect();
        }
        if let Some(parts) = self.written_out(id) {
            return Some(parts);
        }
        let vector = self.shader.text_of(id).to_owned();
        let opaque = opaque(self.shader, id);
        Some((0..count).map(|index| self.component(&vector, index, count, opaque.clone(), None)).collect())
    }

    /// A component of a vector that is a leaf.
    pub(super) fn component(
        &mut self,
        vector: &str,
        index: usize,
        count: usize,
        opaque: Option<String>,
        drawn: Option<Drawn>,
    ) -> Id {
        let text = format!("{}.{}", as_base(vector), &"xyzw"[index..=index]);
        let k = self.leaves.iter().position(|leaf| leaf.text == text).unwrap_or_else(|| {
            let of = Some(Component { vector: vector.to_owned(), index, count });
            self.leaves.push(Leaf { text, opaque, of, drawn });
            self.leaves.len() - 1
        });
        algebra::add(&mut self.term, Node::Leaf(k as u32))
    }

    /// What an expression about vectors is in components; none where it is a leaf.
    fn written_out(&mut self, id: ExprId) -> Option<Vec<Id>> {
        match &self.shader.expr(id).kind {
            ExprKind::Paren(inner) => self.parts(*inner),
            ExprKind::Name(_) => {
                let value = self.initial(self.shader.symbol_of(id)?)?;
                self.parts(value)
            }
            ExprKind::Unary { op: UnaryOp::Minus, operand, .. } => {
                let parts = self.parts(*operand)?;
                Some(parts.into_iter().map(|x| algebra::unary(&mut self.term, Unary::Neg, x)).collect())
            }
            ExprKind::Binary { op, left, right, .. } => {
                let op = arithmetic(*op)?;
                let (a, b) = (self.parts(*left)?, self.parts(*right)?);
                algebra::zip(&mut self.term, op, &a, &b)
            }
            ExprKind::Field { base, field } => {
                let count = width(self.shader.type_of(*base)).filter(|count| *count > 1)?;
                let chosen: Vec<usize> = field.name.chars().map(component).collect::<Option<_>>()?;
                let inner = self.written_out(*base);
                let parts = match inner {
                    Some(parts) => parts,
                    None if chosen.len() > 1 => self.parts(*base)?,
                    // A component of an input goes by its own name.
                    None => return None,
                };
                chosen.iter().map(|k| parts.get(*k).copied().filter(|_| *k < count)).collect()
            }
            ExprKind::Call { args, .. } => self.call_in_components(id, args),
            _ => None,
        }
    }

    fn call_in_components(&mut self, id: ExprId, args: &[ExprId]) -> Option<Vec<Id>> {
        let count = width(self.shader.type_of(id))?;
        let function = match self.shader.callee(id)? {
            CallTarget::Constructor(_) => {
                let parts: Vec<Id> = args
                    .iter()
                    .map(|arg| self.parts(*arg))
                    .collect::<Option<Vec<_>>>()?
                    .into_iter()
                    .flatten()
                    .collect();
                return match parts[..] {
                    [one] => Some(vec![one; count]),
                    _ => (parts.len() >= count).then(|| parts[..count].to_vec()),
                };
            }
            CallTarget::Builtin(call) => call.function,
            CallTarget::User(_) => return None,
        };
        let known = matches!(
            function,
            F::Dot | F::Length | F::Distance | F::Normalize | F::Cross | F::Mix | F::Min | F::Max | F::Abs
        );
        if !known {
            return None;
        }
        let args: Vec<Vec<Id>> = args.iter().map(|arg| self.parts(*arg)).collect::<Option<_>>()?;
        let term = &mut self.term;
        match (function, &args[..]) {
            (F::Dot, [a, b]) => Some(vec![algebra::dot(term, a, b)]),
            (F::Length, [a]) => Some(vec![algebra::length(term, a)]),
            (F::Distance, [a, b]) => {
                let way = algebra::zip(term, Binary::Sub, a, b)?;
                Some(vec![algebra::length(term, &way)])
            }
            (F::Normalize, [a]) => Some(algebra::normalized(term, a)),
            (F::Cross, [a, b]) => algebra::cross(term, a, b),
            (F::Mix, [a, b, t]) => {
                let one = vec![algebra::add(term, Node::number(1.0))];
                let rest = algebra::zip(term, Binary::Sub, &one, t)?;
                let (first, second) =
                    (algebra::zip(term, Binary::Mul, a, &rest)?, algebra::zip(term, Binary::Mul, b, t)?);
                algebra::zip(term, Binary::Add, &first, &second)
            }
            (F::Min, [a, b]) => algebra::zip(term, Binary::Min, a, b),
            (F::Max, [a, b]) => algebra::zip(term, Binary::Max, a, b),
            (F::Abs, [a]) => Some(a.iter().map(|x| algebra::unary(term, Unary::Abs, *x)).collect()),
            _ => None,
        }
    }

    fn call(&mut self, id: ExprId, args: &[ExprId]) -> Option<Id> {
        let all_scalar = args.iter().all(|arg| self.is_scalar(*arg));
        let function = match self.shader.callee(id) {
            Some(CallTarget::Constructor(ty)) if is_float(ty) && args.len() == 1 && all_scalar => {
                return self.expression(args[0]);
            }
            Some(CallTarget::Builtin(call)) if all_scalar => call.function,
            _ => return self.leaf(id),
        };
        // Rules call functions of one number as GLSL does.
        let unary = Unary::by_name(function.name()).filter(|_| args.len() == 1);
        if let Some(of) = unary {
            let x = self.scalar(*args.first()?)?;
            return self.add(Node::Unary(of, x));
        }
        let known =
            matches!(function, F::Atan | F::Pow | F::Min | F::Max | F::Clamp | F::Mix | F::Radians | F::Degrees);
        if !known {
            return self.leaf(id);
        }
        let args: Vec<Id> = args.iter().map(|arg| self.scalar(*arg)).collect::<Option<_>>()?;
        match (function, &args[..]) {
            (F::Atan, [a, b]) => self.binary(Binary::Atan2, *a, *b),
            (F::Pow, [a, b]) => self.binary(Binary::Pow, *a, *b),
            (F::Min, [a, b]) => self.binary(Binary::Min, *a, *b),
            (F::Max, [a, b]) => self.binary(Binary::Max, *a, *b),
            (F::Clamp, [x, low, high]) => {
                let above = self.binary(Binary::Max, *x, *low)?;
                self.binary(Binary::Min, above, *high)
            }
            (F::Mix, [a, b, t]) => {
                let one = self.number(1.0)?;
                let rest = self.binary(Binary::Sub, one, *t)?;
                let (first, second) = (self.binary(Binary::Mul, *a, rest)?, self.binary(Binary::Mul, *b, *t)?);
                self.binary(Binary::Add, first, second)
            }
            (F::Radians | F::Degrees, [x]) => {
                let (half, pi) = (self.number(180.0)?, self.add(Node::Pi)?);
                let (by, over) = if function == F::Radians { (pi, half) } else { (half, pi) };
                let product = self.binary(Binary::Mul, *x, by)?;
                self.binary(Binary::Div, product, over)
            }
            _ => None,
        }
    }
}

fn arithmetic(op: BinaryOp) -> Option<Binary> {
    match op {
        BinaryOp::Add => Some(Binary::Add),
        BinaryOp::Sub => Some(Binary::Sub),
        BinaryOp::Mul => Some(Binary::Mul),
        BinaryOp::Div => Some(Binary::Div),
        _ => None,
    }
}

/// Why the values of an expression are not known; nothing for an input or a part of one.
pub(super) fn opaque(shader: &Shader, id: ExprId) -> Option<String> {
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) => opaque(shader, *inner),
        ExprKind::Field { base, .. } => opaque(shader, *base),
        ExprKind::Index { base, index } if shader.fold(*index).is_some() => opaque(shader, *base),
        ExprKind::Name(name) => {
            let symbol = shader.symbol_of(id).map(|symbol| shader.symbol(symbol))?;
            let written = shader.symbol_of(id).is_some_and(|symbol| shader.is_written(symbol));
            match symbol.kind {
                SymbolKind::Local => Some(format!("`{name}` is set in the function")),
                _ if written => Some(format!("`{name}` is set on the way")),
                _ => None,
            }
        }
        ExprKind::Call { .. } => Some(match shader.callee(id) {
            Some(CallTarget::User(_)) => "the call of a function".to_owned(),
            Some(CallTarget::Builtin(call)) => format!("`{}`", call.function.name()),
            _ => "a constructor".to_owned(),
        }),
        ExprKind::Ternary { .. } => Some("a choice".to_owned()),
        _ => Some("an operation that no rule is about".to_owned()),
    }
}

/// The initialiser of the declarator whose name stands at a place.
fn declared(shader: &Shader, span: Span) -> Option<ExprId> {
    let mut found = None;
    for item in &shader.unit().items {
        if let syntax::ast::ItemKind::Function(Function { body: Some(body), .. }) = &item.kind {
            // A variable of the outermost block is seen until the end of the function.
            for statement in &body.statements {
                let StmtKind::Declaration(declaration) = &statement.kind else { continue };
                let one = declaration.declarators.iter().find(|declarator| declarator.name.span == span);
                found = found.or_else(|| one.and_then(|one| one.initializer.as_ref()).map(|initial| initial.value));
            }
        }
    }
    found
}
