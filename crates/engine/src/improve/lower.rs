//! Expressions of a shader as terms: what is a number of binary32 and made of operations that rules know, with local
//! variables that are set once written out.

use ::improve::{Binary, Id, Node, Term, Unary};

use base::text::Span;
use syntax::ast::{BinaryOp, Block, Declaration, ExprId, ExprKind, Function, Stmt, StmtKind, UnaryOp};
use syntax::real::Reals;
use syntax::symbols::{CallTarget, SymbolId, SymbolKind};
use syntax::types::{ScalarType, Type};
use syntax::{BuiltinFunction as F, Shader};

/// Operations below which nothing is looked for.
const LEAST_OPERATIONS: usize = 1;

/// Nodes of a term beyond which an expression is left alone.
const MOST_NODES: usize = 160;

/// Denominators of multiples of π that constants are taken for.
const PARTS_OF_PI: [f64; 12] = [1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 90.0, 180.0, 360.0, 720.0];

/// A constant that is so near to a multiple of π, as part of its size, is one.
const NEAR_PI: f64 = 2e-7;

/// A part of a term that is no operation that rules know.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Its text.
    pub text: String,
    /// An input, or why its values are not known.
    pub opaque: Option<String>,
}

/// An expression that can be written in another way.
#[derive(Clone, Debug)]
pub struct Place {
    /// Its bytes in the text of the shader.
    pub span: Span,
    /// What it is.
    pub term: Term,
    /// What the leaves of the term are.
    pub leaves: Vec<Leaf>,
    /// Local variables that were written out.
    pub inlined: Vec<String>,
    /// Where another expression stands that needs an operand.
    pub is_operand: bool,
}

/// The places of a function, outermost expressions first in the order of the text.
pub fn places(shader: &Shader, function: &Function, reals: &Reals) -> Vec<Place> {
    let mut finder = Finder { shader, reals, places: Vec::new() };
    if let Some(body) = &function.body {
        finder.block(body);
    }
    finder.places
}

struct Finder<'a> {
    shader: &'a Shader,
    reals: &'a Reals,
    places: Vec<Place>,
}

impl Finder<'_> {
    fn block(&mut self, block: &Block) {
        block.statements.iter().for_each(|statement| self.statement(statement));
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Declaration(declaration) => self.declaration(declaration),
            StmtKind::Expr(id) => self.expression(*id, false),
            StmtKind::Return(Some(id)) => self.expression(*id, false),
            StmtKind::Block(block) => self.block(block),
            StmtKind::If { condition, then, otherwise } => {
                self.expression(*condition, true);
                self.statement(then);
                if let Some(otherwise) = otherwise {
                    self.statement(otherwise);
                }
            }
            StmtKind::For { body, .. } | StmtKind::While { body, .. } | StmtKind::DoWhile { body, .. } => {
                self.statement(body);
            }
            StmtKind::Switch { body, .. } => self.block(body),
            _ => {}
        }
    }

    fn declaration(&mut self, declaration: &Declaration) {
        for declarator in &declaration.declarators {
            if let Some(initializer) = &declarator.initializer {
                self.expression(initializer.value, false);
            }
        }
    }

    fn expression(&mut self, id: ExprId, is_operand: bool) {
        let expr = self.shader.expr(id);
        if let Some(place) = (!expr.from_macro).then(|| self.place(id, is_operand)).flatten() {
            self.places.push(place);
            return;
        }
        let operand = !matches!(expr.kind, ExprKind::Paren(_) | ExprKind::Call { .. } | ExprKind::Assign { .. });
        expr.children().into_iter().for_each(|child| self.expression(child, operand));
    }

    fn place(&self, id: ExprId, is_operand: bool) -> Option<Place> {
        is_float(self.shader.type_of(id)).then_some(())?;
        if self.reals.get(id).is_some() {
            return None;
        }
        let mut lowering = Lowering {
            shader: self.shader,
            reals: self.reals,
            term: Term::default(),
            leaves: Vec::new(),
            inlined: Vec::new(),
        };
        lowering.expression(id)?;
        let Lowering { term, leaves, inlined, .. } = lowering;
        let operations = term.iter().filter(|node| matches!(node, Node::Unary(..) | Node::Binary(..))).count();
        let fits = operations > LEAST_OPERATIONS && term.len() <= MOST_NODES;
        let inlined = inlined.into_iter().map(|symbol| self.shader.symbol(symbol).name.clone()).collect();
        (fits && !leaves.is_empty()).then(|| Place {
            span: self.shader.expr(id).span,
            term,
            leaves,
            inlined,
            is_operand,
        })
    }
}

fn is_float(ty: &Type) -> bool {
    matches!(ty, Type::Scalar(ScalarType::Float))
}

struct Lowering<'a> {
    shader: &'a Shader,
    reals: &'a Reals,
    term: Term,
    leaves: Vec<Leaf>,
    inlined: Vec<SymbolId>,
}

impl Lowering<'_> {
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

    fn expression(&mut self, id: ExprId) -> Option<Id> {
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
                let op = match op {
                    BinaryOp::Add => Binary::Add,
                    BinaryOp::Sub => Binary::Sub,
                    BinaryOp::Mul => Binary::Mul,
                    BinaryOp::Div => Binary::Div,
                    _ => return self.leaf(id),
                };
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
    fn initial(&self, symbol: SymbolId) -> Option<ExprId> {
        let local = self.shader.symbol(symbol);
        if local.kind != SymbolKind::Local || !is_float(&local.ty) || self.shader.is_written(symbol) {
            return None;
        }
        let span = local.span?;
        let value = declared(self.shader, span)?;
        let (stays, same) = (self.stays(value), self.is_scalar(value));
        (stays && same).then_some(value)
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
        let text = self.shader.text_of(id).to_owned();
        let opaque = opaque(self.shader, id);
        let k = self.leaves.iter().position(|leaf| leaf.text == text).unwrap_or_else(|| {
            self.leaves.push(Leaf { text, opaque });
            self.leaves.len() - 1
        });
        self.add(Node::Leaf(u32::try_from(k).ok()?))
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
        let unary = match function {
            F::Sin => Some(Unary::Sin),
            F::Cos => Some(Unary::Cos),
            F::Tan => Some(Unary::Tan),
            F::Asin => Some(Unary::Asin),
            F::Acos => Some(Unary::Acos),
            F::Atan if args.len() == 1 => Some(Unary::Atan),
            F::Sinh => Some(Unary::Sinh),
            F::Cosh => Some(Unary::Cosh),
            F::Tanh => Some(Unary::Tanh),
            F::Asinh => Some(Unary::Asinh),
            F::Acosh => Some(Unary::Acosh),
            F::Atanh => Some(Unary::Atanh),
            F::Exp => Some(Unary::Exp),
            F::Log => Some(Unary::Log),
            F::Exp2 => Some(Unary::Exp2),
            F::Log2 => Some(Unary::Log2),
            F::Sqrt => Some(Unary::Sqrt),
            F::Inversesqrt => Some(Unary::InverseSqrt),
            F::Abs => Some(Unary::Abs),
            _ => None,
        };
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

/// Why the values of an expression are not known; nothing for an input or a part of one.
fn opaque(shader: &Shader, id: ExprId) -> Option<String> {
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
