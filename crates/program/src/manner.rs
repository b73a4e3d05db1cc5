//! How operations of a program are to be done: at which precision, and whether exactly as written.
//!
//! naga has no word for either, so it lies beside the module, by places in the author's text: the expressions of a module
//! have the places of those that they come from, whatever passes go over it.

use std::collections::HashMap;

use base::text::Span;
use syntax::ast::{ExprId, ExprKind, Precision, Unit};
use syntax::precision::Precisions;
use syntax::symbols::CallTarget;
use syntax::types::ScalarType;
use syntax::{BuiltinFunction, Shader};

/// A precision of numbers, the least first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Grade {
    /// `lowp`.
    Low,
    /// `mediump`.
    Medium,
    /// binary16, by the type: `f16` of WGSL.
    Half,
    /// binary32.
    #[default]
    Full,
}

impl Grade {
    fn of(precision: Option<Precision>) -> Self {
        match precision {
            Some(Precision::Low) => Self::Low,
            Some(Precision::Medium) => Self::Medium,
            Some(Precision::High) | None => Self::Full,
        }
    }
}

/// How an operation is to be done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Manner {
    /// The least precision at which it may be done.
    pub grade: Grade,
    /// Its operands and rounding stay as they are written.
    pub precise: bool,
    /// Halves are rounded in a direction that the implementation chooses: `round` of GLSL (4.60, 8.3).
    pub ties: bool,
}

/// The manners of a program.
#[derive(Clone, Debug, Default)]
pub struct Manners {
    values: HashMap<Span, Manner>,
    stores: HashMap<Span, Grade>,
}

impl Manners {
    /// Those of a shader.
    pub(crate) fn of(shader: &Shader) -> Self {
        Self::by(shader, &Precisions::of(shader))
    }

    /// Those of a shader whose precisions are these.
    pub fn by(shader: &Shader, precisions: &Precisions) -> Self {
        let mut all = Self::default();
        for (id, expr) in shader.arena().iter() {
            // What a macro makes stands at one place: only what is computed in real numbers has a say there.
            let real = shader.type_of(id).scalar() == Some(ScalarType::Float);
            let asks = matches!(expr.kind, ExprKind::Binary { .. } | ExprKind::Call { .. });
            if !matches!(expr.kind, ExprKind::Literal(_)) && (real || asks && precisions.of_expr(id).is_some()) {
                let ties =
                    matches!(shader.callee(id), Some(CallTarget::Builtin(c)) if c.function == BuiltinFunction::Round);
                all.value(expr.span, Manner { ties, ..of_expr(precisions, id) });
            }
            if matches!(expr.kind, ExprKind::Assign { .. }) {
                all.store(expr.span, Grade::of(precisions.of_store(id)));
            }
        }
        let grade = |symbol| Grade::of(precisions.of_symbol(symbol));
        for (_, function) in shader.functions() {
            for param in &function.params {
                if let Some(symbol) = param.symbol {
                    all.value(param.span, Manner { grade: grade(symbol), ..Manner::default() });
                }
            }
        }
        let places: HashMap<(usize, &str), _> =
            shader.symbols().filter_map(|(id, s)| Some(((s.span?.start, s.name.as_str()), id))).collect();
        each_declarator(shader.unit(), &mut |declarator| {
            let name = &declarator.name;
            if let Some(&symbol) = places.get(&(name.span.start, name.name.as_str())) {
                all.store(declarator.span, grade(symbol));
            }
        });
        all.values.retain(|_, manner| *manner != Manner::default());
        all.stores.retain(|_, grade| *grade != Grade::Full);
        all
    }

    /// Of what a macro makes, all has the place of its use: what is not sure to be lower is not.
    fn value(&mut self, span: Span, manner: Manner) {
        let found = self.values.entry(span).or_insert(manner);
        found.grade = found.grade.max(manner.grade);
        found.precise |= manner.precise;
        found.ties |= manner.ties;
    }

    fn store(&mut self, span: Span, grade: Grade) {
        let found = self.stores.entry(span).or_insert(grade);
        *found = (*found).max(grade);
    }

    /// How what stands at a place is computed.
    pub fn at(&self, span: Span) -> Manner {
        self.values.get(&span).copied().unwrap_or_default()
    }

    /// The precision of the variable that is written at a place.
    pub fn written_at(&self, span: Span) -> Grade {
        self.stores.get(&span).copied().unwrap_or_default()
    }

    /// True when something may be done in less than binary32.
    pub fn lower(&self) -> bool {
        !self.stores.is_empty() || self.values.values().any(|manner| manner.grade != Grade::Full)
    }

    /// True when something is `precise`.
    pub fn has_precise(&self) -> bool {
        self.values.values().any(|manner| manner.precise)
    }
}

fn of_expr(precisions: &Precisions, id: ExprId) -> Manner {
    Manner { grade: Grade::of(precisions.of_expr(id)), precise: precisions.is_precise(id), ties: false }
}

/// Calls `f` for the variables of all declarations, those in functions included.
fn each_declarator(unit: &Unit, f: &mut dyn FnMut(&syntax::ast::Declarator)) {
    use syntax::ast::{Block, Condition, ItemKind, Stmt, StmtKind};
    fn block(all: &Block, f: &mut dyn FnMut(&syntax::ast::Declarator)) {
        all.statements.iter().for_each(|s| statement(s, f));
    }
    fn statement(one: &Stmt, f: &mut dyn FnMut(&syntax::ast::Declarator)) {
        match &one.kind {
            StmtKind::Declaration(declaration) => declaration.declarators.iter().for_each(f),
            StmtKind::Block(body) | StmtKind::Switch { body, .. } => block(body, f),
            StmtKind::If { then, otherwise, .. } => {
                statement(then, f);
                otherwise.iter().for_each(|other| statement(other, f));
            }
            StmtKind::For { init, condition, body, .. } => {
                statement(init, f);
                if let Some(Condition::Declaration(declaration)) = condition {
                    declaration.declarators.iter().for_each(&mut *f);
                }
                statement(body, f);
            }
            StmtKind::While { body, condition } => {
                if let Condition::Declaration(declaration) = condition {
                    declaration.declarators.iter().for_each(&mut *f);
                }
                statement(body, f);
            }
            StmtKind::DoWhile { body, .. } => statement(body, f),
            _ => {}
        }
    }
    for item in &unit.items {
        match &item.kind {
            ItemKind::Declaration(declaration) => declaration.declarators.iter().for_each(&mut *f),
            ItemKind::Function(function) => function.body.iter().for_each(|body| block(body, f)),
            _ => {}
        }
    }
}
