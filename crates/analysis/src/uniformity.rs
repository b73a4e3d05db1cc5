//! Which statements all invocations reach together: entry points are followed with the variables whose value may differ
//! from one invocation to the next (WGSL, section 15.2 "Uniformity"; GLSL 4.60, section 8.16).

use std::collections::{BTreeMap, BTreeSet};

use syntax::ast::{BinaryOp, Block, Callee, Condition, ExprId, ExprKind, Stmt, StmtKind};
use syntax::interface::Storage;
use syntax::symbols::{CallTarget, Direction, FunctionId, SymbolId, SymbolKind};
use syntax::wgsl::{EntryPoint, Module};
use syntax::{Shader, Stage};

use crate::entry::{builtin_value, inputs, root};
use crate::kernel::{Kernel, Split, Splits};

/// Calls inside calls that are followed.
const MOST_CALLS: usize = 12;

/// Statements and expressions that are looked at for one entry point.
const MOST_STEPS: usize = 100_000;

/// Invocations of the largest subgroups in use: who writes a kernel for a work group of no more counts on one subgroup.
const SUBGROUP: u64 = 64;

/// Why a value may differ from one invocation to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Varies(u8);

impl Varies {
    /// It does not.
    const NOT: Self = Self(0);
    /// It follows from the place of the invocation in the work group.
    const LOCAL: Self = Self(1);
    /// It follows from the work group, and is the same for all of it.
    const GROUP: Self = Self(2);
    /// It follows from data, or from inputs of the stage.
    const DATA: Self = Self(4);
    /// It follows from what an atomic function gives, which is another for each invocation.
    const ORDER: Self = Self(8);

    fn any(self) -> bool {
        self.0 & !Self::GROUP.0 != 0
    }

    /// True where nothing but the place in the whole dispatch makes the difference: a host that fills its work groups
    /// can see to it that a guard holds for all of each.
    pub fn by_dispatch_alone(self) -> bool {
        self == Self::LOCAL | Self::GROUP
    }
}

impl std::ops::BitOr for Varies {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl std::ops::BitOrAssign for Varies {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

/// A call that all invocations must make together, and what parts them before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Parted {
    /// The call.
    pub call: ExprId,
    /// The condition that is not the same for all.
    pub by: ExprId,
    /// Why it is not.
    pub why: Varies,
    /// What it is.
    pub what: Together,
}

/// What invocations have to do together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Together {
    /// A barrier, to which all invocations of a work group come.
    Barrier,
    /// A derivative, from neighbouring pixels.
    Derivative,
    /// An operation of a subgroup or quad, as WGSL has it.
    Subgroup,
}

impl Together {
    fn of(name: &str) -> Option<Self> {
        if is_barrier(name) {
            Some(Self::Barrier)
        } else if takes_derivatives(name) {
            Some(Self::Derivative)
        } else {
            (syntax::wgsl::is_builtin(name) && is_of_lanes(name)).then_some(Self::Subgroup)
        }
    }
}

/// The condition that parts invocations, and why; none while they are together.
type Reason = Option<(ExprId, Varies)>;

/// What differs between invocations.
#[derive(Clone, Default, PartialEq)]
struct State {
    varying: BTreeMap<SymbolId, Varies>,
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
    /// What is known of conditions in a kernel in GLSL; in WGSL, what the language says holds.
    splits: Option<&'s Splits>,
    /// A work group is taken to be one subgroup.
    one_subgroup: bool,
    state: State,
    jumps: Jumps,
    result: Varies,
    calls: Vec<FunctionId>,
    steps: usize,
    found: BTreeSet<Parted>,
}

/// The calls of an entry point that invocations may not make together, as WGSL has it.
pub fn parted(shader: &Shader, module: &Module, entry: &EntryPoint) -> BTreeSet<Parted> {
    let mut state = State::default();
    for input in inputs(shader, module, entry.item) {
        let together = entry.stage == Stage::Compute
            && matches!(
                builtin_value(shader, input.attributes),
                Some("workgroup_id" | "num_workgroups" | "subgroup_size" | "num_subgroups")
            );
        if !together {
            state.varying.insert(input.param, Varies::DATA);
        }
    }
    Walk::new(shader, None, state, entry.function).run(entry.function)
}

/// The barriers of a kernel in GLSL to which invocations of a work group may not come together. Conditions that are shown
/// to be the same for all of a group part nobody.
pub fn parted_barriers(shader: &Shader, kernel: &Kernel, splits: &Splits) -> BTreeSet<Parted> {
    let mut walk = Walk::new(shader, Some(splits), State::default(), kernel.function);
    walk.one_subgroup = kernel.invocations().is_none_or(|count| count <= SUBGROUP);
    for variable in &shader.interface().globals {
        let varies = variable.initializer.map_or(Varies::NOT, |value| walk.eval(value, None));
        walk.set(variable.symbol, varies, true);
    }
    walk.run(kernel.function)
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
    matches!(
        name,
        "workgroupBarrier"
            | "storageBarrier"
            | "textureBarrier"
            | "workgroupUniformLoad"
            | "barrier"
            | "controlBarrier"
    )
}

/// Why a built-in variable of GLSL differs between the invocations of a work group.
fn of_builtin(name: &str) -> Varies {
    match name {
        "gl_GlobalInvocationID" => Varies::LOCAL | Varies::GROUP,
        "gl_WorkGroupID" => Varies::GROUP,
        "gl_NumWorkGroups" | "gl_WorkGroupSize" | "gl_NumSubgroups" | "gl_SubgroupSize" => Varies::NOT,
        _ if name.starts_with("gl_Max") => Varies::NOT,
        _ => Varies::LOCAL,
    }
}

/// True for functions whose result is the same for all of a subgroup.
fn is_of_a_subgroup(name: &str) -> bool {
    let apart = ["Inclusive", "Exclusive", "Clustered", "Shuffle", "Quad", "Elect", "Partitioned", "Rotate"];
    name.starts_with("subgroup") && !apart.iter().any(|part| name.contains(part))
}

/// True for functions whose invocations give each other values.
fn is_of_lanes(name: &str) -> bool {
    name.starts_with("subgroup") || name.starts_with("quad")
}

/// True for what WGSL declares: functions, and types that are made of their arguments.
fn is_of_the_language(name: &str) -> bool {
    syntax::wgsl::is_builtin(name) || syntax::wgsl::is_type(name)
}

impl<'s> Walk<'s> {
    fn new(shader: &'s Shader, splits: Option<&'s Splits>, state: State, function: FunctionId) -> Self {
        let (jumps, result, found) = (Jumps::default(), Varies::NOT, BTreeSet::new());
        Self { shader, splits, one_subgroup: false, state, jumps, result, calls: vec![function], steps: 0, found }
    }

    fn run(mut self, function: FunctionId) -> BTreeSet<Parted> {
        if let Some(body) = body(self.shader, function) {
            self.block(&body.statements, None);
        }
        if self.steps > MOST_STEPS { BTreeSet::new() } else { self.found }
    }

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
                    let value = declarator.initializer.as_ref().map(|i| i.value);
                    let varies = value.map_or(Varies::NOT, |value| self.eval(value, here));
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
                self.state.add(&before);
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
                    self.result |= varies | parted_by(here);
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
        let shown = varies.0 & Varies::ORDER.0 == 0 && self.is_shown_the_same(condition);
        here.or((varies.any() && !shown).then_some((condition, varies)))
    }

    /// True where the numbers of the invocations show that a condition is the same for all of a work group.
    fn is_shown_the_same(&self, condition: ExprId) -> bool {
        let Some(splits) = self.splits else { return false };
        match &self.shader.expr(condition).kind {
            _ if splits.get(&condition) == Some(&Split::Together) => true,
            ExprKind::Paren(inner) => self.is_shown_the_same(*inner),
            ExprKind::Binary { op: BinaryOp::And | BinaryOp::Or, op_span: _, left, right } => {
                self.is_shown_the_same(*left) && self.is_shown_the_same(*right)
            }
            _ => false,
        }
    }

    fn branches(&mut self, branches: &[&'s Stmt], open: bool, inside: Reason) {
        let before = self.state.clone();
        let mut after = if open { before.clone() } else { State::default() };
        for branch in branches {
            self.state = before.clone();
            self.statement(branch, inside);
            after.add(&self.state);
        }
        self.state = after;
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
            self.state.add(&before);
            if self.state == before && around == inside {
                break;
            }
        }
        self.jumps.left = outer;
    }

    fn set(&mut self, symbol: SymbolId, varies: Varies, whole: bool) {
        if whole {
            self.state.varying.remove(&symbol);
        }
        if varies != Varies::NOT {
            *self.state.varying.entry(symbol).or_default() |= varies;
        }
    }

    /// Why the value may differ; calls inside are looked at.
    fn eval(&mut self, id: ExprId, here: Reason) -> Varies {
        self.steps += 1;
        if self.steps > MOST_STEPS {
            return Varies::NOT;
        }
        let shader = self.shader;
        match &shader.expr(id).kind {
            ExprKind::Name(_) => shader.symbol_of(id).map_or(Varies::NOT, |s| self.reads(s)),
            ExprKind::Binary { op: BinaryOp::And | BinaryOp::Or, op_span: _, left, right } => {
                let varies = self.eval(*left, here);
                let parts = varies.any() && !self.is_shown_the_same(*left);
                let inside = here.or(parts.then_some((*left, varies)));
                let other = self.eval(*right, inside);
                // One of them may part invocations whatever the host does.
                let apart = |v: Varies| v.any() && !v.by_dispatch_alone();
                varies | other | if apart(varies) || apart(other) { Varies::DATA } else { Varies::NOT }
            }
            ExprKind::Assign { op, op_span: _, target, value } => {
                let mut varies = self.eval(*value, here) | parted_by(here) | self.indices(*target, here);
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
                let varies = self.eval(*operand, here) | parted_by(here);
                if let Some((symbol, _)) = root(shader, *operand) {
                    self.set(symbol, varies, false);
                }
                varies
            }
            ExprKind::Call { callee, args } => self.call(id, callee, args, here),
            // Which element it is, and not which group, makes the difference.
            ExprKind::Index { base, index } if self.splits.is_some() => {
                let (index, base) = (self.eval(*index, here), self.eval(*base, here));
                base | if index.any() { index } else { Varies::NOT }
            }
            _ => shader.expr(id).children().into_iter().fold(Varies::NOT, |all, c| self.eval(c, here) | all),
        }
    }

    fn indices(&mut self, target: ExprId, here: Reason) -> Varies {
        match &self.shader.expr(target).kind {
            ExprKind::Paren(inner) => self.indices(*inner, here),
            ExprKind::Field { base, field: _ } => self.indices(*base, here),
            ExprKind::Index { base, index } => self.eval(*index, here) | self.indices(*base, here),
            _ => Varies::NOT,
        }
    }

    fn reads(&self, symbol: SymbolId) -> Varies {
        let info = self.shader.symbol(symbol);
        let own = || self.state.varying.get(&symbol).copied().unwrap_or_default();
        let if_any = |varies: bool| if varies { Varies::DATA } else { Varies::NOT };
        // In GLSL, an element that all invocations read is one value for them: its index decides.
        let by_index = self.splits.is_some();
        match info.kind {
            SymbolKind::Global(Storage::Global) if by_index => own(),
            SymbolKind::Global(Storage::Buffer) => if_any(!info.read_only && !by_index),
            SymbolKind::Global(Storage::Shared | Storage::Global) => if_any(!by_index),
            SymbolKind::Global(_) => Varies::NOT,
            SymbolKind::BlockMember(_) | SymbolKind::BlockInstance(_) if by_index => Varies::NOT,
            SymbolKind::Builtin if by_index => of_builtin(&info.name),
            _ => own(),
        }
    }

    fn call(&mut self, id: ExprId, callee: &'s Callee, args: &'s [ExprId], here: Reason) -> Varies {
        let shader = self.shader;
        let varies: Vec<Varies> = args.iter().map(|a| self.eval(*a, here)).collect();
        let any = varies.iter().fold(Varies::NOT, |all, v| all | *v);
        let Callee::Name(name) = callee else { return any };
        let name = name.name.as_str();
        if let Some(CallTarget::User(function)) = shader.callee(id) {
            return self.enter(*function, args, &varies, here);
        }
        // What nothing declares may give the same for all, whatever it gets.
        if self.splits.is_none() && shader.callee(id).is_none() && !is_of_the_language(name) {
            for arg in args.iter().filter(|arg| syntax::wgsl::is_address(shader, **arg)) {
                if let Some((symbol, _)) = root(shader, *arg) {
                    self.set(symbol, Varies::NOT, true);
                }
            }
            return Varies::NOT;
        }
        if let (Some((by, why)), Some(what)) = (here, Together::of(name))
            // In GLSL those that come to an operation of a subgroup are those that take part in it.
            && (self.splits.is_none() || what != Together::Subgroup)
        {
            self.found.insert(Parted { call: id, by, why, what });
        }
        match name {
            "workgroupUniformLoad" | "arrayLength" | "textureDimensions" | "textureNumLevels" => Varies::NOT,
            _ if name.starts_with("atomic") => any | Varies::DATA | Varies::ORDER,
            _ if self.splits.is_some() && name.starts_with("imageAtomic") => any | Varies::DATA | Varies::ORDER,
            _ if self.one_subgroup && is_of_a_subgroup(name) => Varies::NOT,
            _ if is_of_lanes(name) => any | Varies::DATA,
            _ => any,
        }
    }

    fn enter(&mut self, function: FunctionId, args: &'s [ExprId], varies: &[Varies], here: Reason) -> Varies {
        let shader = self.shader;
        let any = varies.iter().fold(Varies::NOT, |all, v| all | *v);
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
        // Pointers of WGSL are told as `inout`.
        for (param, arg) in params.iter().zip(args).filter(|(p, _)| p.direction != Direction::In) {
            let inner = param.symbol.map_or(Varies::NOT, |s| self.state.varying.get(&s).copied().unwrap_or_default());
            if let Some((symbol, _)) = root(shader, *arg) {
                let whole = param.direction == Direction::Out && matches!(shader.expr(*arg).kind, ExprKind::Name(_));
                self.set(symbol, inner, whole);
            }
        }
        returned
    }
}

impl State {
    /// Takes over what varies on another way.
    fn add(&mut self, other: &Self) {
        for (symbol, varies) in &other.varying {
            *self.varying.entry(*symbol).or_default() |= *varies;
        }
    }
}

/// What is written where invocations are parted differs for the reason that parts them.
fn parted_by(here: Reason) -> Varies {
    here.map_or(Varies::NOT, |(_, why)| why)
}
