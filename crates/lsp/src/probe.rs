//! A function cut off at one of its expressions, so that whoever can run functions says something about that expression.

use base::text::{Edit, EditList, SourceFile, Span};
use syntax::Shader;
use syntax::Stage;
use syntax::ast::{Block, ExprId, ExprKind, Function, ItemKind, Stmt, StmtKind};
use syntax::types::{ScalarType, Type};
use syntax::wgsl::ModuleItem;

use crate::unit::Unit;
use crate::workspace::Workspace;

/// What the function is called that gives an expression.
const NAME: &str = "shadercheck_probe";

/// A text with a function whose result is what is asked for. Lines are those of the shader.
#[derive(Clone, Debug)]
pub struct Probe {
    /// The text.
    pub file: SourceFile,
    /// Its stage.
    pub stage: Stage,
    /// The function.
    pub function: String,
}

impl Workspace {
    /// What gives the expression of `float`s at a place as the result of a function: the function itself on its name, or
    /// else one that ends where the expression stands. None for texts with errors.
    pub fn probe(&self, name: &str, offset: usize) -> Option<Probe> {
        let unit = self.units_of(name).into_iter().find(|u| u.errors == 0)?;
        let shader = &unit.shader;
        let at = |span: Span| unit.place_in(name, span).is_some_and(|s| s.start <= offset && offset <= s.end);
        let functions = shader.unit().items.iter().enumerate().filter_map(|(index, item)| match &item.kind {
            ItemKind::Function(f) if f.body.is_some() => Some((index, f, item.span)),
            _ => None,
        });
        for (index, function, span) in functions {
            if at(function.name.span) {
                let own =
                    Probe { file: unit.file().clone(), stage: shader.stage(), function: function.name.name.clone() };
                return (function.name.name != "main").then_some(own);
            }
            if at(span) {
                let id = innermost(unit, &at)?;
                return cut(shader, (index, function), id);
            }
        }
        None
    }
}

/// The smallest expression at a place; of a call that is named there, the call.
fn innermost(unit: &Unit, at: &impl Fn(Span) -> bool) -> Option<ExprId> {
    let here = unit.shader.arena().iter().filter(|(_, e)| !e.span.is_empty() && at(e.span));
    here.min_by_key(|(id, e)| (e.span.len(), id.index())).map(|(id, _)| id)
}

/// The function with the expression as its result.
fn cut(shader: &Shader, (index, function): (usize, &Function), id: ExprId) -> Option<Probe> {
    let ty = match (shader.type_of(id), shader.wgsl()) {
        (Type::Scalar(ScalarType::Float), Some(_)) => "f32".to_owned(),
        (Type::Vector(ScalarType::Float, size), Some(_)) => format!("vec{size}<f32>"),
        (ty @ (Type::Scalar(ScalarType::Float) | Type::Vector(ScalarType::Float, _)), None) => ty.to_string(),
        _ => return None,
    };
    let expr = shader.expr(id);
    if expr.from_macro {
        return None;
    }
    // What is written has no value before.
    if matches!(expr.kind, ExprKind::Literal(_)) {
        return None;
    }
    let body = function.body.as_ref()?;
    let mut found = Found { target: expr.span, place: None, returns: Vec::new() };
    found.block(body);
    let (stmt, in_block) = found.place?;
    let nothing = format!("return {ty}(0);");
    // Kept in one line, so that lines stay those of the shader.
    let text = shader.text_of(id).split_whitespace().collect::<Vec<_>>().join(" ");
    let (open, close) = if in_block { ("", "") } else { ("{ ", " }") };
    let mut edits = EditList::new();
    edits.push(Edit::replace(function.name.span, NAME));
    match shader.wgsl() {
        None => edits.push(Edit::replace(function.return_type.span, ty)),
        Some(module) => {
            let is = |one: &&ModuleItem| matches!(one, ModuleItem::Function { item, .. } if *item == index);
            let head = module.items.iter().find(is)?;
            // An entry point becomes a function: values of the pipeline are parameters.
            head.attributes().for_each(|a| edits.push(Edit::replace(a.span, " ".repeat(a.span.len()))));
            match head {
                ModuleItem::Function { returns: Some((_, written)), .. } => {
                    edits.push(Edit::replace(written.span, ty));
                }
                _ => edits.push(Edit::insert(function.params_span.end, format!(" -> {ty}"))),
            }
        }
    }
    for span in found.returns {
        let lines = "\n".repeat(shader.file().slice(span).matches('\n').count());
        let result = if span == stmt { format!("return {text};") } else { nothing.clone() };
        edits.push(Edit::replace(span, result + &lines));
    }
    if !edits.edits().iter().any(|e| e.span == stmt) {
        edits.push(Edit::insert(stmt.start, format!("{open}if (true) {{ return {text}; }} ")));
        if !close.is_empty() {
            edits.push(Edit::insert(stmt.end, close));
        }
    }
    // Nothing gets past a last `return`.
    if !matches!(body.statements.last().map(|s| &s.kind), Some(StmtKind::Return(_))) {
        edits.push(Edit::insert(body.span.end.checked_sub(1)?, nothing));
    }
    let changed = edits.apply(shader.file().text()).ok()?;
    let file = SourceFile::new(shader.file().name(), changed.text);
    Some(Probe { file, stage: shader.stage(), function: NAME.to_owned() })
}

/// The statement that an expression stands in, and the ways out of the function.
struct Found {
    target: Span,
    /// The innermost statement, and whether it stands directly in a block.
    place: Option<(Span, bool)>,
    returns: Vec<Span>,
}

impl Found {
    fn block(&mut self, block: &Block) {
        block.statements.iter().for_each(|s| self.statement(s, true));
    }

    fn statement(&mut self, stmt: &Stmt, in_block: bool) {
        let inside = stmt.span.start <= self.target.start && self.target.end <= stmt.span.end;
        if inside && !matches!(stmt.kind, StmtKind::Block(_)) {
            self.place = Some((stmt.span, in_block));
        }
        match &stmt.kind {
            StmtKind::Block(b) | StmtKind::Switch { selector: _, body: b } => self.block(b),
            StmtKind::If { condition: _, then, otherwise } => {
                self.statement(then, false);
                otherwise.iter().for_each(|s| self.statement(s, false));
            }
            StmtKind::For { body, .. } | StmtKind::While { body, .. } | StmtKind::DoWhile { body, .. } => {
                self.statement(body, false);
            }
            StmtKind::Return(_) => self.returns.push(stmt.span),
            _ => {}
        }
    }
}
