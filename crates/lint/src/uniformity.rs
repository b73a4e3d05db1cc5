//! Which statements all invocations reach together (WGSL, section 15.2 "Uniformity"): entry points are followed with the
//! variables whose value may differ from one invocation to the next.

use std::collections::BTreeSet;

use base::text::Span;
use syntax::ast::{BinaryOp, Block, Callee, Condition, ExprId, ExprKind, Stmt, StmtKind};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, Direction, FunctionId, SymbolId, SymbolKind};
use syntax::wgsl::{EntryPoint, Module};
use syntax::{Shader, Stage};

use super::{builtin_value, inputs, root};

/// Calls inside calls that are followed.
const MOST_CALLS: usize = 12;

/// Statements and expressions that are looked at for one entry point.
const MOST_STEPS: usize = 100_000;

/// A call that all invocations must make together, and what parts them before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Parted {
    /// The call.
    pub call: ExprId,
    /// The condition that is not the same for all.
    pub by: Span,
    /// True for a barrier, false for a derivative.
    pub barrier: bool,
}

/// Where the condition stands that parts invocations; none while they are together.
type Reason = Option<Span>;

/// What differs between invocations.
#[derive(Clone, Default, PartialEq)]
struct State {
    varying: BTreeSet<SymbolId>,
}

/// What jumps leave behind them.
#[derive(Clone, Copy, Default)]
struct Jumps {
    /// Some invocations came back from the function.
    returned: Reason,
    /// Some left the loop, or its round.
    left: Reason,
}

struct Walk<'s> {
    shader: &'s Shader,
    state: State,
    jumps: Jumps,
    result: bool,
    calls: Vec<FunctionId>,
    steps: usize,
    found: BTreeSet<Parted>,
}

/// The calls of an entry point that invocations may not make together.
pub fn parted(shader: &Shader, module: &Module, entry: &EntryPoint) -> BTreeSet<Parted> {
    let mut state = State::default();
    for input in inputs(shader, module, entry.item) {
        let together = entry.stage == Stage::Compute
            && matches!(
                builtin_value(shader, input.attributes),
                Some("workgroup_id" | "num_workgroups" | "subgroup_size" | "num_subgroups")
            );
        if !together {
            state.varying.insert(input.param);
        }
    }
    let calls = vec![entry.function];
    let mut walk =
        Walk { shader, state, jumps: Jumps::default(), result: false, calls, steps: 0, found: BTreeSet::new() };
    if let Some(body) = body(shader, entry.function) {
        walk.block(&body.statements, None);
    }
    if walk.steps > MOST_STEPS { BTreeSet::new() } else { walk.found }
}

fn body(shader: &Shader, function: FunctionId) -> Option<&Block> {
    shader.function_syntax(shader.function_info(function))?.body.as_ref()
}

/// True for functions that compare an invocation with its neighbours.
fn takes_derivatives(name: &str) -> bool {
    matches!(name, "textureSample" | "textureSampleBias" | "textureSampleCompare")
        || ["dFdx", "dFdy", "fwidth"].iter().any(|f| name.starts_with(f))
}

fn is_barrier(name: &str) -> bool {
    matches!(name, "workgroupBarrier" | "storageBarrier" | "textureBarrier" | "workgroupUniformLoad")
}

impl<'s> Walk<'s> {
    fn block(&mut self, statements: &'s [Stmt], around: Reason) {
        for statement in statements {
            let here = around.or(self.jumps.returned).or(self.jumps.left);
            self.statement(statement, here);
        }
    }

    fn statement(&mut self, statement: &'s Stmt, here: Reason) {
        self.steps += 1;
        if self.steps > MOST_STEPS {
            return;
        }
        match &statement.kind {
            StmtKind::Declaration(declaration) => {
                for declarator in &declaration.declarators {
                    let varies = declarator.initializer.as_ref().is_some_and(|i| self.eval(i.value, here));
                    let symbols = self.shader.symbols();
                    let symbol = symbols.into_iter().find(|(_, s)| s.span == Some(declarator.name.span));
                    if let Some((symbol, _)) = symbol {
                        self.set(symbol, varies, true);
                    }
                }
            }
            StmtKind::Expr(expr) => {
                self.eval(*expr, here);
            }
            StmtKind::Block(block) => self.block(&block.statements, here),
            StmtKind::If { condition, then, otherwise } => {
                let inside = self.test(*condition, here);
                let mut branches: Vec<&'s Stmt> = vec![then];
                branches.extend(otherwise.as_deref());
                self.branches(&branches, otherwise.is_none(), inside);
            }
            StmtKind::Switch { selector, body } => {
                let inside = self.test(*selector, here);
                let outer = self.jumps.left.take();
                let before = self.state.clone();
                self.block(&body.statements, inside);
                self.join(before);
                self.jumps.left = outer;
            }
            StmtKind::For { init, condition, step, body, head_span: _ } => {
                self.statement(init, here);
                let condition = condition.as_ref().and_then(|c| match c {
                    Condition::Expr(id) => Some(*id),
                    Condition::Declaration(_) => None,
                });
                self.repeat(condition, None, *step, body, here);
            }
            StmtKind::While { condition, body } => {
                let condition = match condition {
                    Condition::Expr(id) => Some(*id),
                    Condition::Declaration(_) => None,
                };
                self.repeat(condition, None, None, body, here);
            }
            StmtKind::DoWhile { body, condition } => self.repeat(None, Some(*condition), None, body, here),
            StmtKind::Return(value) => {
                if let Some(value) = value {
                    let varies = self.eval(*value, here);
                    self.result |= varies || here.is_some();
                }
                self.jumps.returned = self.jumps.returned.or(here);
            }
            StmtKind::Break | StmtKind::Continue => self.jumps.left = self.jumps.left.or(here),
            StmtKind::Case(_)
            | StmtKind::Default
            | StmtKind::Discard
            | StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Error => {}
        }
    }

    /// Why invocations part at a condition.
    fn test(&mut self, condition: ExprId, here: Reason) -> Reason {
        let varies = self.eval(condition, here);
        here.or(varies.then(|| self.shader.expr(condition).span))
    }

    fn branches(&mut self, branches: &[&'s Stmt], open: bool, inside: Reason) {
        let before = self.state.clone();
        let mut after = if open { before.clone() } else { State::default() };
        for branch in branches {
            self.state = before.clone();
            self.statement(branch, inside);
            after.varying.append(&mut self.state.varying.clone());
        }
        self.state = after;
    }

    fn join(&mut self, mut other: State) {
        self.state.varying.append(&mut other.varying);
    }

    fn repeat(
        &mut self,
        condition: Option<ExprId>,
        again: Option<ExprId>,
        step: Option<ExprId>,
        body: &'s Stmt,
        here: Reason,
    ) {
        let outer = self.jumps.left.take();
        let mut around = here;
        // What one round finds to differ, differs in the next.
        for _ in 0..4 {
            let before = self.state.clone();
            let inside = match condition {
                Some(condition) => self.test(condition, around),
                None => around,
            };
            self.statement(body, inside);
            let inside = inside.or(self.jumps.left).or(self.jumps.returned);
            if let Some(step) = step {
                self.eval(step, inside);
            }
            let inside = match again {
                Some(again) => self.test(again, inside),
                None => inside,
            };
            around = around.or(inside);
            self.join(before.clone());
            if self.state == before && around == inside {
                break;
            }
        }
        self.jumps.left = outer;
    }

    fn set(&mut self, symbol: SymbolId, varies: bool, whole: bool) {
        if varies {
            self.state.varying.insert(symbol);
        } else if whole {
            self.state.varying.remove(&symbol);
        }
    }

    /// True when the value may differ; calls inside are looked at.
    fn eval(&mut self, id: ExprId, here: Reason) -> bool {
        self.steps += 1;
        if self.steps > MOST_STEPS {
            return false;
        }
        let shader = self.shader;
        match &shader.expr(id).kind {
            ExprKind::Name(_) => shader.symbol_of(id).is_some_and(|s| self.reads(s)),
            ExprKind::Binary { op: BinaryOp::And | BinaryOp::Or, op_span: _, left, right } => {
                let varies = self.eval(*left, here);
                let inside = here.or(varies.then(|| shader.expr(*left).span));
                self.eval(*right, inside) | varies
            }
            ExprKind::Assign { op, op_span: _, target, value } => {
                let mut varies = self.eval(*value, here) | here.is_some() | self.indices(*target, here);
                if op.is_some() {
                    varies |= self.eval(*target, here);
                }
                if let Some((symbol, _)) = root(shader, *target) {
                    let whole = matches!(shader.expr(*target).kind, ExprKind::Name(_));
                    self.set(symbol, varies, whole);
                }
                varies
            }
            ExprKind::Postfix { operand, .. } => {
                let varies = self.eval(*operand, here) | here.is_some();
                if let Some((symbol, _)) = root(shader, *operand) {
                    self.set(symbol, varies, false);
                }
                varies
            }
            ExprKind::Call { callee, args } => self.call(id, callee, args, here),
            _ => shader.expr(id).children().into_iter().fold(false, |all, c| self.eval(c, here) | all),
        }
    }

    fn indices(&mut self, target: ExprId, here: Reason) -> bool {
        match &self.shader.expr(target).kind {
            ExprKind::Paren(inner) => self.indices(*inner, here),
            ExprKind::Field { base, field: _ } => self.indices(*base, here),
            ExprKind::Index { base, index } => self.eval(*index, here) | self.indices(*base, here),
            _ => false,
        }
    }

    fn reads(&self, symbol: SymbolId) -> bool {
        let info = self.shader.symbol(symbol);
        match info.kind {
            SymbolKind::Global(Storage::Buffer) => !info.read_only,
            SymbolKind::Global(Storage::Shared | Storage::Global) => true,
            SymbolKind::Global(_) => false,
            _ => self.state.varying.contains(&symbol),
        }
    }

    fn call(&mut self, id: ExprId, callee: &'s Callee, args: &'s [ExprId], here: Reason) -> bool {
        let shader = self.shader;
        let varies: Vec<bool> = args.iter().map(|a| self.eval(*a, here)).collect();
        let any = varies.iter().any(|v| *v);
        let Callee::Name(name) = callee else { return any };
        let name = name.name.as_str();
        if let Some(CallTarget::User(function)) = shader.callee(id) {
            return self.enter(*function, args, &varies, here);
        }
        let barrier = is_barrier(name);
        if let Some(by) = here
            && (barrier || takes_derivatives(name))
        {
            self.found.insert(Parted { call: id, by, barrier });
        }
        match name {
            "workgroupUniformLoad" | "arrayLength" | "textureDimensions" | "textureNumLevels" => false,
            _ => any || name.starts_with("atomic"),
        }
    }

    fn enter(&mut self, function: FunctionId, args: &'s [ExprId], varies: &[bool], here: Reason) -> bool {
        let shader = self.shader;
        let any = varies.iter().any(|v| *v);
        let Some(body) = body(shader, function) else { return any };
        if self.calls.len() >= MOST_CALLS || self.calls.contains(&function) {
            return any;
        }
        let params = &shader.function_info(function).params;
        for (param, varies) in params.iter().zip(varies) {
            if let Some(symbol) = param.symbol {
                self.set(symbol, *varies, true);
            }
        }
        let (jumps, result) = (std::mem::take(&mut self.jumps), std::mem::take(&mut self.result));
        self.calls.push(function);
        self.block(&body.statements, here);
        self.calls.pop();
        self.jumps = jumps;
        let returned = std::mem::replace(&mut self.result, result);
        for (param, arg) in params.iter().zip(args).filter(|(p, _)| p.direction == Direction::InOut) {
            let inner = param.symbol.is_some_and(|s| self.state.varying.contains(&s));
            if let Some((symbol, _)) = root(shader, *arg) {
                self.set(symbol, inner, false);
            }
        }
        returned
    }
}
