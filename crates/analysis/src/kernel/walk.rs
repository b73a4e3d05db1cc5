//! The statements of a kernel, walked for a whole work group.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::rc::Rc;

use base::text::Span;
use syntax::Shader;
use syntax::ast::{BinaryOp, Block, Condition, Declaration, ExprId, ExprKind, Stmt, StmtKind};
use syntax::symbols::{FunctionId, SymbolId};

use super::shared::{Beyond, Pending, Race, Step};
use super::split::Splits;
use super::value::{Number, Origin, Term, Terms, Value};
use super::{Kernel, MOST_LANES, body};

/// Expressions that are evaluated for one entry point.
const MOST_STEPS: usize = 20_000;

/// Rounds of a loop whose conditions are known.
const MOST_ROUNDS: usize = 40;

/// Rounds of a loop whose conditions are not known: the second shows what one round leaves to the next.
const OPEN_ROUNDS: usize = 2;

/// Calls inside calls that are followed.
const MOST_CALLS: usize = 12;

/// Where the walk is.
#[derive(Clone, Default)]
pub(super) struct State {
    pub env: HashMap<SymbolId, Value>,
    /// For each invocation: 0 is elsewhere, 1 here, 2 may be here.
    pub active: Rc<Vec<u8>>,
    /// Invocations that came back from the function.
    returned: Rc<Vec<u8>>,
    pub pending: Pending,
    /// What was decided on the way.
    pub atoms: Vec<(Term, bool)>,
}

/// A loop or a `switch`, with the states that leave it.
#[derive(Default)]
struct Frame {
    breaks: Vec<State>,
    continues: Vec<State>,
    is_loop: bool,
}

pub(super) struct Walk<'s> {
    pub shader: &'s Shader,
    pub size: [u32; 3],
    /// The number of the work group along each axis; of none, it may be any.
    pub group: Option<i64>,
    pub lanes: usize,
    pub terms: Terms,
    pub state: State,
    pub found: BTreeSet<Race>,
    /// Accesses past the end of an array, by their place.
    pub beyond: BTreeMap<Span, Beyond>,
    /// What is known of conditions.
    pub splits: Splits,
    /// Expressions around the one at hand that are evaluated on a condition.
    pub conditional: usize,
    /// Parameters that are pointers into shared memory.
    pub aliases: HashMap<SymbolId, (SymbolId, Vec<Step>)>,
    pub inputs: HashMap<(SymbolId, Option<String>), Value>,
    /// Barriers that were passed.
    pub barriers: usize,
    declared: HashMap<usize, SymbolId>,
    frames: Vec<Frame>,
    calls: Vec<FunctionId>,
    results: Vec<Option<Value>>,
    steps: usize,
}

impl<'s> Walk<'s> {
    /// Walks through a kernel with work groups of this size; none where they have too many invocations to be followed, or
    /// a single one.
    pub fn run(shader: &'s Shader, kernel: &Kernel, size: [u32; 3]) -> Option<Self> {
        Self::run_in(shader, kernel, size, None)
    }

    /// The same for the work group with a number along each axis; of none, for any.
    pub fn run_in(shader: &'s Shader, kernel: &Kernel, size: [u32; 3], group: Option<i64>) -> Option<Self> {
        let lanes = size.iter().try_fold(1_u32, |all, s| all.checked_mul(*s));
        let Some(2..=MOST_LANES) = lanes else { return None };
        let mut walk = Self::new(shader, kernel, size, group);
        if let Some(body) = body(shader, kernel.function) {
            walk.block(&body.statements);
        }
        Some(walk)
    }

    fn new(shader: &'s Shader, kernel: &Kernel, size: [u32; 3], group: Option<i64>) -> Self {
        let lanes = size.iter().map(|s| *s as usize).product();
        let declared = shader.symbols().filter_map(|(id, s)| Some((s.span?.start, id))).collect();
        let mut walk = Self {
            shader,
            size,
            group,
            lanes,
            terms: Terms::default(),
            state: State { active: Rc::new(vec![1; lanes]), returned: Rc::new(vec![0; lanes]), ..State::default() },
            found: BTreeSet::new(),
            beyond: BTreeMap::new(),
            splits: Splits::new(),
            conditional: 0,
            aliases: HashMap::new(),
            inputs: HashMap::new(),
            barriers: 0,
            declared,
            frames: Vec::new(),
            calls: vec![kernel.function],
            results: Vec::new(),
            steps: 0,
        };
        for (symbol, member, name) in &kernel.inputs {
            if let Some(value) = walk.builtin(name) {
                walk.inputs.insert((*symbol, member.clone()), value);
            }
        }
        walk
    }

    /// Counts a step; false when there were too many.
    pub fn step(&mut self) -> bool {
        self.steps += 1;
        self.steps <= MOST_STEPS
    }

    pub fn may_enter(&self, function: FunctionId) -> bool {
        self.calls.len() < MOST_CALLS && !self.calls.contains(&function)
    }

    /// Walks a function; its parameters have their values.
    pub fn run_function(&mut self, function: FunctionId, body: &'s Block) -> Option<Value> {
        let (active, returned) = (Rc::clone(&self.state.active), Rc::clone(&self.state.returned));
        let atoms = self.state.atoms.len();
        self.state.returned = Rc::new(vec![0; self.lanes]);
        let frames = std::mem::take(&mut self.frames);
        let results = std::mem::take(&mut self.results);
        self.calls.push(function);
        self.block(&body.statements);
        self.calls.pop();
        self.frames = frames;
        let own = std::mem::replace(&mut self.results, results);
        (self.state.active, self.state.returned) = (active, returned);
        self.state.atoms.truncate(atoms);
        match own.as_slice() {
            [Some(value)] => Some(value.clone()),
            // Which of the results it is, data decides.
            [Some(first), ..] if first.numbers().len() == 1 => {
                Some(Value::One(self.terms.fresh(Origin { uniform: false, data: false })))
            }
            _ => None,
        }
    }

    pub fn assign(&mut self, symbol: SymbolId, value: Value) {
        let active = Rc::clone(&self.state.active);
        let value = match (self.state.env.get(&symbol), &value) {
            (Some(Value::One(old)), Value::One(new)) => Value::One(self.terms.select(&active, new, old)),
            _ => value,
        };
        self.state.env.insert(symbol, value);
    }

    fn block(&mut self, statements: &'s [Stmt]) {
        for statement in statements {
            if self.is_dead() || !self.step() {
                return;
            }
            self.statement(statement);
        }
    }

    fn is_dead(&self) -> bool {
        self.state.active.iter().all(|a| *a == 0)
    }

    fn declare(&mut self, declaration: &'s Declaration) {
        for declarator in &declaration.declarators {
            let value = match &declarator.initializer {
                Some(initializer) => self.eval(initializer.value),
                None if self.shader.wgsl().is_some() => Value::One(Number::constant(0)),
                None => continue,
            };
            if let Some(symbol) = self.declared.get(&declarator.name.span.start).copied() {
                let vector = matches!(self.shader.symbol(symbol).ty, syntax::types::Type::Vector(..));
                if declarator.initializer.is_some() || !vector {
                    self.state.env.insert(symbol, value);
                }
            }
        }
    }

    fn statement(&mut self, statement: &'s Stmt) {
        match &statement.kind {
            StmtKind::Declaration(declaration) => self.declare(declaration),
            StmtKind::Expr(expr) => {
                self.eval(*expr);
            }
            StmtKind::Block(block) => self.block(&block.statements),
            StmtKind::If { condition, then, otherwise } => self.branch(*condition, then, otherwise.as_deref()),
            StmtKind::Switch { selector, body } => self.switch(*selector, body),
            StmtKind::For { init, condition, step, body, head_span: _ } => {
                self.statement(init);
                self.repeat(condition.as_ref(), None, *step, body);
            }
            StmtKind::While { condition, body } => self.repeat(Some(condition), None, None, body),
            StmtKind::DoWhile { body, condition } => self.repeat(None, Some(*condition), None, body),
            StmtKind::Return(value) => {
                let value = value.map(|v| self.eval(v));
                self.results.push(value);
                let returned: Vec<u8> =
                    self.state.active.iter().zip(self.state.returned.iter()).map(|(a, r)| *a.max(r)).collect();
                self.state.returned = Rc::new(returned);
                self.state.active = Rc::new(vec![0; self.lanes]);
            }
            StmtKind::Break | StmtKind::Continue => {
                let state = self.state.clone();
                let broken = statement.kind == StmtKind::Break;
                let frame = self.frames.iter_mut().rev().find(|f| broken || f.is_loop);
                if let Some(frame) = frame {
                    let into = if broken { &mut frame.breaks } else { &mut frame.continues };
                    into.push(state);
                }
                self.state.active = Rc::new(vec![0; self.lanes]);
            }
            StmtKind::Case(_)
            | StmtKind::Default
            | StmtKind::Discard
            | StmtKind::Empty
            | StmtKind::Precision(_)
            | StmtKind::Qualified(_)
            | StmtKind::Error => {}
        }
    }

    /// What is decided where a condition holds.
    fn atoms(&mut self, condition: &Number) -> Option<(Term, bool)> {
        condition.atom().filter(|(term, _)| self.terms.origin(*term).uniform)
    }

    /// The invocations that a condition lets through: known ones stay what they are, others may be there.
    fn masks(&self, condition: &Number) -> (Vec<u8>, Vec<u8>) {
        let known = condition.is_known();
        let pick = |wanted: bool| {
            let of = |(lane, active): (usize, &u8)| match (known, *active) {
                (_, 0) => 0,
                (false, _) => 2,
                (true, active) => {
                    if (condition.lane(lane) != 0) == wanted {
                        active
                    } else {
                        0
                    }
                }
            };
            self.state.active.iter().enumerate().map(of).collect()
        };
        (pick(true), pick(false))
    }

    fn branch(&mut self, condition: ExprId, then: &'s Stmt, otherwise: Option<&'s Stmt>) {
        let shader = self.shader;
        // `if (a && b)` is `if (a) { if (b) …`: what is known of one of them stays known.
        if let (ExprKind::Binary { op: BinaryOp::And, op_span: _, left, right }, None) =
            (&shader.expr(crate::numeric::bare(shader, condition)).kind, otherwise)
        {
            let (left, right) = (*left, *right);
            return self.split(left, |walk| walk.branch(right, then, None), |_| {});
        }
        self.split(
            condition,
            |walk| walk.statement(then),
            |walk| {
                if let Some(otherwise) = otherwise {
                    walk.statement(otherwise);
                }
            },
        );
    }

    fn split(&mut self, condition: ExprId, then: impl FnOnce(&mut Self), otherwise: impl FnOnce(&mut Self)) {
        let id = condition;
        let condition = self.number(condition);
        self.note_split(id, &condition);
        let (yes, no) = self.masks(&condition);
        let entry = self.state.clone();
        let atom = self.atoms(&condition);
        self.way(yes.clone(), atom, then);
        let after = std::mem::replace(&mut self.state, entry.clone());
        self.way(no, atom.map(|(term, truth)| (term, !truth)), otherwise);
        let other = std::mem::take(&mut self.state);
        let by = self.terms.origin_of(&condition);
        self.state = self.join(&entry, after, other, by, condition.is_known().then_some(yes.as_slice()));
    }

    /// Walks one way of a condition.
    fn way(&mut self, active: Vec<u8>, atom: Option<(Term, bool)>, walk: impl FnOnce(&mut Self)) {
        self.state.active = Rc::new(active);
        if let Some(atom) = atom {
            self.state.atoms.push(atom);
            self.state.pending.assume(&[atom]);
            if self.state.atoms.contains(&(atom.0, !atom.1)) {
                self.state.active = Rc::new(vec![0; self.lanes]);
            }
        }
        if !self.is_dead() {
            walk(self);
        }
    }

    /// The state behind two ways.
    fn join(&mut self, entry: &State, a: State, b: State, by: Origin, mask: Option<&[u8]>) -> State {
        let over = |s: &State| s.active.iter().all(|x| *x == 0);
        // Where all of the group go one way, the other is of no concern.
        if by.uniform || mask.is_some_and(|m| m.iter().zip(entry.active.iter()).all(|(m, e)| (*m == 0) == (*e == 0))) {
            if over(&a) && !over(&b) {
                return State { atoms: entry.atoms.clone(), ..b };
            }
            if over(&b) && !over(&a) {
                return State { atoms: entry.atoms.clone(), ..a };
            }
        }
        let mix = |lane: usize, a: u8, b: u8, entry: u8| match (a, b) {
            (0, 0) => 0,
            (0, one) | (one, 0) => {
                if mask.is_some_and(|m| m.get(lane).is_some()) {
                    one
                } else {
                    2
                }
            }
            _ => entry,
        };
        let active: Vec<u8> = (0..self.lanes).map(|l| mix(l, a.active[l], b.active[l], entry.active[l])).collect();
        let returned: Vec<u8> = a.returned.iter().zip(b.returned.iter()).map(|(a, b)| *a.max(b)).collect();
        let mut pending = a.pending;
        pending.join(&b.pending);
        let mut env = a.env;
        let mut changed: Vec<SymbolId> =
            env.iter().filter(|(symbol, value)| b.env.get(*symbol) != Some(*value)).map(|(s, _)| *s).collect();
        changed.sort_unstable();
        for symbol in changed {
            let (Some(one), Some(two)) = (env.get(&symbol).cloned(), b.env.get(&symbol).cloned()) else { continue };
            env.insert(symbol, self.either(&one, &two, by, mask));
        }
        State { env, active: Rc::new(active), returned: Rc::new(returned), pending, atoms: entry.atoms.clone() }
    }

    fn either(&mut self, one: &Value, two: &Value, by: Origin, mask: Option<&[u8]>) -> Value {
        let mut all = Vec::new();
        for (a, b) in one.numbers().iter().zip(two.numbers()) {
            all.push(match mask {
                _ if a == b => a.clone(),
                Some(mask) => self.terms.select(mask, a, b),
                None => {
                    let both = self.terms.both(a, b);
                    self.terms.fresh(Origin { uniform: by.uniform && both.uniform, data: by.data || both.data })
                }
            });
        }
        match (one, all.len()) {
            (Value::One(_), 1) => Value::One(all.swap_remove(0)),
            _ => Value::Vector(all),
        }
    }

    fn switch(&mut self, selector: ExprId, body: &'s Block) {
        let id = selector;
        let selector = self.number(selector);
        self.note_split(id, &selector);
        let by = self.terms.origin_of(&selector);
        let entry = self.state.clone();
        let active: Vec<u8> = entry.active.iter().map(|a| if *a == 0 { 0 } else { 2 }).collect();
        let is_label = |s: &Stmt| matches!(s.kind, StmtKind::Case(_) | StmtKind::Default);
        let starts = body
            .statements
            .iter()
            .enumerate()
            .filter(|(at, s)| is_label(s) && body.statements.get(at + 1).is_some_and(|next| !is_label(next)));
        let mut states = Vec::new();
        for (at, _) in starts {
            self.state = State { active: Rc::new(active.clone()), ..entry.clone() };
            self.frames.push(Frame::default());
            self.block(&body.statements[at + 1..]);
            let frame = self.frames.pop().unwrap_or_default();
            states.push(std::mem::take(&mut self.state));
            states.extend(frame.breaks);
        }
        self.state = entry;
        if !states.iter().any(|s| s.active.iter().any(|a| *a != 0)) {
            return;
        }
        self.leave(states, by);
    }

    /// Goes on behind a loop or a `switch` with what left it.
    fn leave(&mut self, states: Vec<State>, by: Origin) {
        let entry = self.state.clone();
        let mut merged: Option<State> = None;
        for state in states {
            merged = Some(match merged {
                None => state,
                Some(before) => self.join(&entry, before, state, by, None),
            });
        }
        let Some(merged) = merged else { return };
        let back = |(e, r): (&u8, &u8)| match (*e, *r) {
            (0, _) | (_, 1) => 0,
            (e, 0) => e,
            _ => 2,
        };
        let active = entry.active.iter().zip(merged.returned.iter()).map(back).collect();
        self.state = State { active: Rc::new(active), atoms: entry.atoms, ..merged };
    }

    fn repeat(
        &mut self,
        condition: Option<&'s Condition>,
        again: Option<ExprId>,
        step: Option<ExprId>,
        body: &'s Stmt,
    ) {
        let entry = self.state.clone();
        let (mut exits, mut by, mut open) = (Vec::new(), Origin { uniform: true, data: false }, 0);
        let mut test = |walk: &mut Self, id: ExprId, exits: &mut Vec<State>, open: &mut usize| {
            let number = walk.number(id);
            walk.note_split(id, &number);
            let own = walk.terms.origin_of(&number);
            by = Origin { uniform: by.uniform && own.uniform, data: by.data || own.data };
            let (yes, no) = walk.masks(&number);
            if no.iter().any(|l| *l != 0) {
                let mut out = walk.state.clone();
                out.active = Rc::new(no);
                exits.push(out);
            }
            if !number.is_known() {
                *open += 1;
            }
            walk.state.active = Rc::new(yes);
        };
        for round in 0..MOST_ROUNDS {
            let barriers = self.barriers;
            match condition {
                Some(Condition::Expr(id)) => test(self, *id, &mut exits, &mut open),
                Some(Condition::Declaration(_)) => open += 1,
                None => {}
            }
            if self.is_dead() {
                break;
            }
            self.frames.push(Frame { is_loop: true, ..Frame::default() });
            let before = self.state.clone();
            self.statement(body);
            let frame = self.frames.pop().unwrap_or_default();
            // A loop with a barrier inside is there to be run: that it has no round at all would be another matter.
            if round == 0 && self.barriers > barriers && open > 0 {
                exits.clear();
            }
            // A way out that data decides ends the rounds that are walked as well.
            open += usize::from(!frame.breaks.is_empty());
            exits.extend(frame.breaks);
            for state in frame.continues {
                let own = std::mem::take(&mut self.state);
                self.state = self.join(&before, own, state, Origin::default(), None);
            }
            self.state.atoms.clone_from(&before.atoms);
            if let Some(step) = step.filter(|_| !self.is_dead()) {
                self.eval(step);
            }
            if let Some(again) = again.filter(|_| !self.is_dead()) {
                test(self, again, &mut exits, &mut open);
            }
            if self.is_dead() || open >= OPEN_ROUNDS || !self.step() {
                break;
            }
        }
        if !self.is_dead() && (exits.is_empty() || open < OPEN_ROUNDS) {
            exits.push(std::mem::take(&mut self.state));
        }
        self.state = entry;
        if exits.is_empty() {
            // All came back from inside.
            self.state.active = Rc::new(vec![0; self.lanes]);
            return;
        }
        self.leave(exits, by);
    }
}
