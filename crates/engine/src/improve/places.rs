//! The expressions of a function that can be written in another way.

use ::improve::{Node, Term};

use super::lower::{Leaf, Lowering, MOST_NODES, is_float};
use super::vectors;
use base::text::Span;
use syntax::Const;
use syntax::Shader;
use syntax::ast::{BinaryOp, Block, Callee, Declaration, ExprId, ExprKind, Function, Stmt, StmtKind};
use syntax::real::Reals;

/// Operations below which nothing is looked for.
const LEAST_OPERATIONS: usize = 1;

/// What a hash multiplies with, at the least.
const HASH: f32 = 1000.0;

/// An expression that can be written in another way.
#[derive(Clone, Debug)]
pub struct Place {
    /// Its bytes in the text of the shader.
    pub span: Span,
    /// The expression as a term of real numbers.
    pub term: Term,
    /// What the leaves of the term are.
    pub leaves: Vec<Leaf>,
    /// Local variables that were written out.
    pub inlined: Vec<String>,
    /// Where another expression stands that needs an operand.
    pub is_operand: bool,
    /// Other terms for it that are known without a search.
    pub known: Option<Known>,
}

/// Other terms for what an expression means.
#[derive(Clone, Debug)]
pub struct Known {
    /// What it means: with vectors of length 1 where the text has what binary32 made of them.
    pub meant: Term,
    /// Terms that mean the same.
    pub others: Vec<Term>,
}

/// Whether the text of an input is a vector of length 1.
pub(super) type IsUnit<'a> = &'a dyn Fn(&str) -> bool;

/// The places of a function: those with known terms, then outermost expressions, each in the order of the text.
pub(super) fn places(shader: &Shader, function: &Function, reals: &Reals, is_unit: IsUnit<'_>) -> [Vec<Place>; 2] {
    let mut finder = PlaceFinder { shader, reals, is_unit, known: Vec::new(), places: Vec::new() };
    if let Some(body) = &function.body {
        finder.block(body);
    }
    [finder.known, finder.places]
}

struct PlaceFinder<'a> {
    shader: &'a Shader,
    reals: &'a Reals,
    is_unit: IsUnit<'a>,
    known: Vec<Place>,
    places: Vec<Place>,
}

impl PlaceFinder<'_> {
    fn block(&mut self, block: &Block) {
        block.statements.iter().for_each(|statement| self.statement(statement));
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Declaration(declaration) => self.declaration(declaration),
            StmtKind::Expr(id) => self.root(*id, false),
            StmtKind::Return(Some(id)) => self.root(*id, false),
            StmtKind::Block(block) => self.block(block),
            StmtKind::If { condition, then, otherwise } => {
                self.root(*condition, true);
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
                self.root(initializer.value, false);
            }
        }
    }

    fn root(&mut self, id: ExprId, is_operand: bool) {
        if self.is_hash(id) {
            return;
        }
        self.vectors(id, is_operand);
        self.expression(id, is_operand);
    }

    /// True of an expression of which a hash is made: a function times a large number that is not whole, of which all
    /// digits but the last are thrown away.
    fn is_hash(&self, id: ExprId) -> bool {
        let large = |id: ExprId| matches!(self.shader.fold(id), Some(Const::Float(value)) if value.abs() >= HASH && value.fract() != 0.0);
        let expr = self.shader.expr(id);
        match expr.kind {
            ExprKind::Binary { op: BinaryOp::Mul, left, right, .. } if large(left) || large(right) => true,
            _ => expr.children().into_iter().any(|child| self.is_hash(child)),
        }
    }

    /// Expressions about vectors whose other terms are known.
    fn vectors(&mut self, id: ExprId, is_operand: bool) {
        let expr = self.shader.expr(id);
        let found = (!expr.from_macro).then(|| vectors::known(self.shader, self.reals, self.is_unit, id)).flatten();
        if let Some((term, leaves, known)) = found {
            let (span, inlined) = (expr.span, Vec::new());
            self.known.push(Place { span, term, leaves, inlined, is_operand, known: Some(known) });
            return;
        }
        let operand = needs_operand(&expr.kind);
        expr.children().into_iter().for_each(|child| self.vectors(child, operand));
    }

    fn expression(&mut self, id: ExprId, is_operand: bool) {
        let expr = self.shader.expr(id);
        if let Some(place) = (!expr.from_macro).then(|| self.place(id, is_operand)).flatten() {
            self.places.push(place);
            return;
        }
        // In an arm that a condition chooses, inputs have less than their range.
        if let ExprKind::Ternary { condition, .. } = expr.kind {
            self.expression(condition, true);
            return;
        }
        let is_select =
            matches!(&expr.kind, ExprKind::Call { callee: Callee::Name(name), .. } if name.name == "select");
        if is_select && self.shader.wgsl().is_some() {
            return;
        }
        let operand = needs_operand(&expr.kind);
        expr.children().into_iter().for_each(|child| self.expression(child, operand));
    }

    fn place(&self, id: ExprId, is_operand: bool) -> Option<Place> {
        is_float(self.shader.type_of(id)).then_some(())?;
        // A variable is improved where it is declared.
        if self.reals.get(id).is_some() || is_name(self.shader, id) {
            return None;
        }
        let mut lowering = Lowering::new(self.shader, self.reals, false);
        lowering.expression(id)?;
        let Lowering { term, leaves, inlined, .. } = lowering;
        let operations = term.iter().filter(|node| matches!(node, Node::Unary(..) | Node::Binary(..))).count();
        let fits = operations > LEAST_OPERATIONS && term.len() <= MOST_NODES;
        let inlined = inlined.into_iter().map(|symbol| self.shader.symbol(symbol).name.clone()).collect();
        let span = self.shader.expr(id).span;
        (fits && !leaves.is_empty()).then_some(Place { span, term, leaves, inlined, is_operand, known: None })
    }
}

fn needs_operand(kind: &ExprKind) -> bool {
    !matches!(kind, ExprKind::Paren(_) | ExprKind::Call { .. } | ExprKind::Assign { .. })
}

fn is_name(shader: &Shader, id: ExprId) -> bool {
    match shader.expr(id).kind {
        ExprKind::Paren(inner) => is_name(shader, inner),
        ExprKind::Name(_) => true,
        _ => false,
    }
}
