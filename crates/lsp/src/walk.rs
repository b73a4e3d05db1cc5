//! All types and blocks of a syntax tree, wherever they stand.

use base::text::Span;
use syntax::Shader;
use syntax::ast::{
    Block, Callee, Condition, Declaration, ExprKind, ItemKind, Stmt, StmtKind, StructSpecifier, TypeKind, TypeSpecifier,
};

/// What a tree has besides expressions.
#[derive(Default)]
pub(crate) struct Parts<'s> {
    /// Types as written, those of constructors included.
    pub types: Vec<&'s TypeSpecifier>,
    pub structs: Vec<&'s StructSpecifier>,
    /// Declarations of variables, parameters not included.
    pub declarations: Vec<&'s Declaration>,
    /// Places of statements, functions and blocks, each before what is inside it.
    pub spans: Vec<Span>,
    /// From `{` to `}`.
    pub bodies: Vec<Span>,
}

pub(crate) fn parts(shader: &Shader) -> Parts<'_> {
    let mut parts = Parts::default();
    for item in &shader.unit().items {
        parts.spans.push(item.span);
        match &item.kind {
            ItemKind::Declaration(d) => parts.declaration(d),
            ItemKind::Function(f) => {
                parts.ty(&f.return_type);
                f.params.iter().for_each(|p| parts.ty(&p.ty));
                f.body.iter().for_each(|b| parts.block(b));
            }
            ItemKind::Block(b) => {
                parts.bodies.push(b.body_span);
                b.members.iter().for_each(|m| parts.ty(&m.ty));
            }
            ItemKind::Qualified(_) | ItemKind::Precision(_) | ItemKind::Empty | ItemKind::Error => {}
        }
    }
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Call { callee: Callee::Type(ty), args: _ } = &expr.kind {
            parts.types.push(ty);
        }
    }
    parts
}

impl<'s> Parts<'s> {
    fn ty(&mut self, ty: &'s TypeSpecifier) {
        self.types.push(ty);
        if let TypeKind::Struct(s) = &ty.kind {
            self.structs.push(s);
            self.bodies.push(s.span);
            s.members.iter().for_each(|m| self.ty(&m.ty));
        }
    }

    fn declaration(&mut self, d: &'s Declaration) {
        self.ty(&d.ty);
        self.declarations.push(d);
    }

    fn block(&mut self, block: &'s Block) {
        self.bodies.push(block.span);
        self.spans.push(block.span);
        block.statements.iter().for_each(|s| self.statement(s));
    }

    fn condition(&mut self, condition: &'s Condition) {
        if let Condition::Declaration(d) = condition {
            self.declaration(d);
        }
    }

    fn statement(&mut self, stmt: &'s Stmt) {
        self.spans.push(stmt.span);
        match &stmt.kind {
            StmtKind::Declaration(d) => self.declaration(d),
            StmtKind::Block(b) | StmtKind::Switch { selector: _, body: b } => self.block(b),
            StmtKind::If { condition: _, then, otherwise } => {
                self.statement(then);
                otherwise.iter().for_each(|s| self.statement(s));
            }
            StmtKind::For { init, condition, step: _, body, head_span: _ } => {
                self.statement(init);
                condition.iter().for_each(|c| self.condition(c));
                self.statement(body);
            }
            StmtKind::While { condition, body } => {
                self.condition(condition);
                self.statement(body);
            }
            StmtKind::DoWhile { body, condition: _ } => self.statement(body),
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
}
