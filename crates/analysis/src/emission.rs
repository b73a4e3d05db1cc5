//! How many vertices a geometry stage emits.

use std::collections::BTreeSet;

use syntax::Shader;
use syntax::ast::{BinaryOp, Callee, Condition, ExprId, ExprKind, Stmt, StmtKind, UnaryOp};
use syntax::symbols::{CallTarget, SymbolId};

use syntax::walk::expressions;

/// Loops with more rounds than any `max_vertices` are not counted out.
const MOST_ROUNDS: u64 = 65_536;

/// The most vertices that `main` can emit; none when that is not known.
pub fn most(shader: &Shader) -> Option<u64> {
    Most { shader, calling: BTreeSet::new() }.function("main")
}

/// The vertices that `main` emits at least, whatever the input.
pub fn least(shader: &Shader) -> u64 {
    Least { shader, calling: BTreeSet::new() }.function("main")
}

/// The vertices that a statement emits at least.
pub fn least_of(shader: &Shader, statement: &Stmt) -> u64 {
    Least { shader, calling: BTreeSet::new() }.statement(statement)
}

/// Counts the most vertices that a piece of the shader can emit; none when that is not known.
struct Most<'s> {
    shader: &'s Shader,
    /// Functions being counted: a shader must not recurse, but a text may.
    calling: BTreeSet<String>,
}

impl<'s> Most<'s> {
    fn function(&mut self, name: &str) -> Option<u64> {
        // Overloads are not told apart: the largest counts.
        if !self.calling.insert(name.to_owned()) {
            return None;
        }
        let mut most = 0;
        for (_, info) in self.shader.functions().filter(|(_, f)| f.name.name == name) {
            let body = self.shader.function_syntax(info)?.body.as_ref()?;
            most = most.max(self.block(&body.statements)?);
        }
        self.calling.remove(name);
        Some(most)
    }

    fn block(&mut self, statements: &'s [Stmt]) -> Option<u64> {
        statements.iter().try_fold(0u64, |sum, s| sum.checked_add(self.statement(s)?))
    }

    fn statement(&mut self, stmt: &'s Stmt) -> Option<u64> {
        match &stmt.kind {
            StmtKind::Expr(e) => self.expression(*e),
            StmtKind::Declaration(d) => {
                let values = d.declarators.iter().filter_map(|d| d.initializer.as_ref());
                values.map(|i| i.value).try_fold(0u64, |sum, v| sum.checked_add(self.expression(v)?))
            }
            StmtKind::Block(block) => self.block(&block.statements),
            StmtKind::If { condition, then, otherwise } => {
                let head = self.expression(*condition)?;
                let then = self.statement(then)?;
                let otherwise = otherwise.as_deref().map_or(Some(0), |o| self.statement(o))?;
                head.checked_add(then.max(otherwise))
            }
            StmtKind::For { init, condition, step, body, head_span: _ } => {
                let head = match condition {
                    Some(Condition::Expr(c)) => self.expression(*c)?,
                    Some(Condition::Declaration(_)) => return None,
                    None => 0,
                };
                let step_emits = step.map_or(Some(0), |s| self.expression(s))?;
                let round = self.statement(body)?;
                if head + step_emits > 0 {
                    return None;
                }
                let init_emits = self.statement(init)?;
                let all = if round == 0 {
                    0
                } else {
                    round.checked_mul(rounds(self.shader, init, condition.as_ref(), *step, body)?)?
                };
                init_emits.checked_add(all)
            }
            StmtKind::While { condition, body } => {
                let head = match condition {
                    Condition::Expr(c) => self.expression(*c)?,
                    Condition::Declaration(_) => return None,
                };
                (head == 0 && self.statement(body)? == 0).then_some(0)
            }
            StmtKind::DoWhile { body, condition } => {
                (self.statement(body)? == 0 && self.expression(*condition)? == 0).then_some(0)
            }
            // All cases together: with fall-through each of them may run.
            StmtKind::Switch { selector, body } => {
                self.expression(*selector)?.checked_add(self.block(&body.statements)?)
            }
            StmtKind::Case(e) | StmtKind::Return(Some(e)) => self.expression(*e),
            StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Default
            | StmtKind::Return(None)
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard => Some(0),
            StmtKind::Error => None,
        }
    }

    fn expression(&mut self, root: ExprId) -> Option<u64> {
        let mut sum = 0u64;
        for id in expressions(self.shader, root) {
            let ExprKind::Call { callee: Callee::Name(name), args: _ } = &self.shader.expr(id).kind else { continue };
            let emits = match (self.shader.callee(id), name.name.as_str()) {
                (Some(CallTarget::Builtin(_)), "EmitVertex" | "EmitStreamVertex") => 1,
                (Some(CallTarget::User(_)), name) => self.function(name)?,
                (Some(CallTarget::Builtin(_) | CallTarget::Constructor(_)), _) => 0,
                (None, _) => return None,
            };
            sum = sum.checked_add(emits)?;
        }
        Some(sum)
    }
}

/// Counts the vertices that are surely emitted: behind what may leave, nothing is sure.
struct Least<'s> {
    shader: &'s Shader,
    calling: BTreeSet<String>,
}

impl<'s> Least<'s> {
    fn function(&mut self, name: &str) -> u64 {
        if !self.calling.insert(name.to_owned()) {
            return 0;
        }
        // Overloads are not told apart: the smallest counts.
        let shader = self.shader;
        let bodies: Vec<&[Stmt]> = shader
            .functions()
            .filter(|(_, f)| f.name.name == name)
            .filter_map(|(_, f)| Some(shader.function_syntax(f)?.body.as_ref()?.statements.as_slice()))
            .collect();
        let least = bodies.into_iter().map(|b| self.block(b)).min().unwrap_or(0);
        self.calling.remove(name);
        least
    }

    fn block(&mut self, statements: &'s [Stmt]) -> u64 {
        let mut sum = 0u64;
        for statement in statements {
            sum = sum.saturating_add(self.statement(statement));
            if leaves(statement) {
                break;
            }
        }
        sum
    }

    fn statement(&mut self, stmt: &'s Stmt) -> u64 {
        match &stmt.kind {
            StmtKind::Expr(e) | StmtKind::Return(Some(e)) => self.expression(*e),
            StmtKind::Block(block) => self.block(&block.statements),
            StmtKind::If { condition: _, then, otherwise } => {
                let otherwise = otherwise.as_deref().map_or(0, |o| self.statement(o));
                self.statement(then).min(otherwise)
            }
            StmtKind::For { init, condition, step, body, head_span: _ } => {
                let rounds = rounds(self.shader, init, condition.as_ref(), *step, body);
                match rounds {
                    Some(rounds) if !leaves(body) => self.statement(body).saturating_mul(rounds),
                    _ => 0,
                }
            }
            StmtKind::DoWhile { body, condition: _ } => self.statement(body),
            StmtKind::Declaration(_)
            | StmtKind::While { .. }
            | StmtKind::Switch { .. }
            | StmtKind::Case(_)
            | StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Default
            | StmtKind::Return(None)
            | StmtKind::Break
            | StmtKind::Continue
            | StmtKind::Discard
            | StmtKind::Error => 0,
        }
    }

    fn expression(&mut self, id: ExprId) -> u64 {
        let ExprKind::Call { callee: Callee::Name(name), args: _ } = &self.shader.expr(id).kind else { return 0 };
        match (self.shader.callee(id), name.name.as_str()) {
            (Some(CallTarget::Builtin(_)), "EmitVertex" | "EmitStreamVertex") => 1,
            (Some(CallTarget::User(_)), name) => self.function(name),
            _ => 0,
        }
    }
}

/// True when a statement may go elsewhere than behind its end.
fn leaves(stmt: &Stmt) -> bool {
    match &stmt.kind {
        StmtKind::Return(_) | StmtKind::Break | StmtKind::Continue | StmtKind::Discard | StmtKind::Error => true,
        StmtKind::Block(block) | StmtKind::Switch { selector: _, body: block } => block.statements.iter().any(leaves),
        StmtKind::If { condition: _, then, otherwise } => leaves(then) || otherwise.as_deref().is_some_and(leaves),
        StmtKind::For { init: _, condition: _, step: _, body, head_span: _ }
        | StmtKind::While { condition: _, body }
        | StmtKind::DoWhile { body, condition: _ } => leaves(body),
        StmtKind::Expr(_)
        | StmtKind::Declaration(_)
        | StmtKind::Case(_)
        | StmtKind::Empty
        | StmtKind::Precision(_)
        | StmtKind::Qualified(_)
        | StmtKind::Default => false,
    }
}

/// Rounds of `for (int i = a; i < b; i += c)` with constants, when the body leaves `i` alone.
pub fn rounds(
    shader: &Shader,
    init: &Stmt,
    condition: Option<&Condition>,
    step: Option<ExprId>,
    body: &Stmt,
) -> Option<u64> {
    let StmtKind::Declaration(declaration) = &init.kind else { return None };
    let [declarator] = declaration.declarators.as_slice() else { return None };
    let start = shader.fold(declarator.initializer.as_ref()?.value)?.as_integer()?;
    let (counter, _) = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span))?;
    let Some(Condition::Expr(condition)) = condition else { return None };
    let step_id = step?;
    let step = added(shader, step_id, counter)?;
    let step_span = shader.expr(step_id).span;
    let elsewhere = |at: usize| !step_span.contains(at) && !body.span.contains(at);
    let unknown = shader.uses_of(counter).any(|u| u.access.writes() && (u.from_macro || elsewhere(u.span.start)));
    if unknown || shader.expr(step_id).from_macro || body.span.is_empty() {
        return None;
    }
    let step = step + moved(shader, body, counter)?;
    if step == 0 {
        return None;
    }
    let ExprKind::Binary { op, op_span: _, left, right } = shader.expr(*condition).kind else { return None };
    if shader.symbol_of(left) != Some(counter) {
        return None;
    }
    let end = shader.fold(right).and_then(|c| c.as_integer()).or_else(|| vertices_in(shader, right))?;
    let distance = match (op, step > 0) {
        (BinaryOp::Less, true) => end - start,
        (BinaryOp::LessEqual, true) => end - start + 1,
        (BinaryOp::Greater, false) => start - end,
        (BinaryOp::GreaterEqual, false) => start - end + 1,
        _ => return None,
    };
    let rounds = u64::try_from(distance.max(0)).ok()?.div_ceil(step.unsigned_abs());
    (rounds <= MOST_ROUNDS).then_some(rounds)
}

/// What the body of a loop adds to the counter, whichever way it takes; none when that depends on the way.
fn moved(shader: &Shader, stmt: &Stmt, counter: SymbolId) -> Option<i64> {
    let writes = |at: base::text::Span| shader.uses_of(counter).any(|u| u.access.writes() && at.contains(u.span.start));
    match &stmt.kind {
        StmtKind::Block(block) => block.statements.iter().try_fold(0, |sum, s| Some(sum + moved(shader, s, counter)?)),
        StmtKind::If { condition, then, otherwise } if !writes(shader.expr(*condition).span) => {
            let then = moved(shader, then, counter)?;
            let otherwise = otherwise.as_deref().map_or(Some(0), |o| moved(shader, o, counter))?;
            (then == otherwise).then_some(then)
        }
        StmtKind::Expr(e) if writes(stmt.span) => added(shader, *e, counter),
        _ => (!writes(stmt.span)).then_some(0),
    }
}

/// The length of `gl_in`, which the primitive that comes in decides.
fn vertices_in(shader: &Shader, expr: ExprId) -> Option<i64> {
    let ExprKind::Method { base, .. } = &shader.expr(expr).kind else { return None };
    let input = shader.interface().geometry.input?;
    (shader.text_of(*base) == "gl_in").then(|| i64::from(input.value.vertices()))
}

/// What a step adds to the counter; never 0.
fn added(shader: &Shader, step: ExprId, counter: SymbolId) -> Option<i64> {
    let (target, by) = match shader.expr(step).kind {
        ExprKind::Unary { op: UnaryOp::Increment, op_span: _, operand } => (operand, 1),
        ExprKind::Unary { op: UnaryOp::Decrement, op_span: _, operand } => (operand, -1),
        ExprKind::Postfix { increment, op_span: _, operand } => (operand, if increment { 1 } else { -1 }),
        ExprKind::Assign { op: Some(BinaryOp::Add), op_span: _, target, value } => {
            (target, shader.fold(value)?.as_integer()?)
        }
        ExprKind::Assign { op: Some(BinaryOp::Sub), op_span: _, target, value } => {
            (target, -shader.fold(value)?.as_integer()?)
        }
        _ => return None,
    };
    (shader.symbol_of(target) == Some(counter) && by != 0).then_some(by)
}
