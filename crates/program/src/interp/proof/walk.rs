//! The instructions of a kernel, gone through for an invocation of which nothing is known but where it is.

use std::collections::{BTreeSet, HashMap, HashSet};

use naga::{Barrier, BuiltIn};
use number::linear::{Constraint, Polynomial, Unknown};

use super::super::code::{Case, Constant, Executable, File, Inst, Reg, Touch};
use super::super::domain::Site;
use super::super::group::MemoryOp;
use super::accesses::Seen;
use super::formula::Formula;
use super::phases::Phases;
use super::values::{MOST_CASES, Value};
use super::variables::{Fact, HALF, Interval, Meaning, Scope, Variables, Why};
use super::words::from_bits;
use crate::Written;

/// Instructions that are gone through, each as often as it is.
const MOST_STEPS: usize = 100_000;

/// Accesses that are noted.
const MOST_ACCESSES: usize = 3_000;

/// Questions to the solver on the way.
const MOST_QUESTIONS: usize = 2_000;

/// What is assumed of a kernel beyond its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Assumed {
    /// No sum or product of an index leaves 32 bits.
    Fits,
    /// No number of the host by which something is divided is 0.
    Divisor,
}

/// Where an invocation is.
#[derive(Clone)]
pub(super) struct State {
    pub env: HashMap<Reg, Value>,
    pub path: Vec<Fact>,
    pub phases: Phases,
    pub alive: bool,
}

/// What is left early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Loop,
    Switch,
    Call,
}

pub(super) struct Frame {
    pub kind: Kind,
    /// States that left it, and that went to its next round.
    pub left: Vec<State>,
    pub next: Vec<State>,
    /// Some invocations of a workgroup may leave it, or a round of it, where others do not.
    pub varied: bool,
    /// Conditions around on which invocations of a workgroup may differ.
    pub varying: usize,
    /// It is gone through round by round.
    pub unrolled: bool,
    /// Conditions around that are not known.
    pub open: usize,
}

pub(super) struct Walk<'e> {
    pub executable: &'e Executable,
    pub size: [u32; 3],
    pub variables: Variables,
    pub state: State,
    pub frames: Vec<Frame>,
    pub accesses: Vec<Seen>,
    pub assumed: BTreeSet<Assumed>,
    /// Rounds of loops around.
    pub rounds: Vec<Unknown>,
    /// Numbers of rounds of loops that are gone through round by round.
    pub unrolled: Vec<u32>,
    /// Accesses are not noted.
    pub silent: usize,
    /// Conditions around on which invocations of a workgroup may differ.
    pub varying: usize,
    /// Conditions around that are not known.
    pub open: usize,
    pub questions: usize,
    /// A barrier that not all invocations may reach.
    pub divergent: Option<Site>,
    /// Barriers that are passed.
    pub barriers: Vec<Site>,
    /// A barrier that is left out, at all places into which it was expanded.
    pub ignored: Vec<Site>,
    /// Memories that are asked for their length.
    pub asked: BTreeSet<u32>,
    /// It was too much.
    pub exhausted: bool,
    /// An unrolled loop leaves early by something that is not known.
    pub undecided: bool,
    pub written: HashSet<u32>,
    pub resolved: HashMap<usize, (Value, Polynomial)>,
    pub steps: usize,
}

impl<'e> Walk<'e> {
    pub(super) fn new(executable: &'e Executable, size: [u32; 3], axes: [bool; 3], ignored: Vec<Site>) -> Self {
        let mut written = HashSet::new();
        super::super::shape::each(&executable.draft.body, &mut |inst| {
            if let Inst::Memory(access) = inst
                && !matches!(access.op, MemoryOp::Load(_))
            {
                written.insert(access.memory);
            }
        });
        let state = State { env: HashMap::new(), path: Vec::new(), phases: Phases::begin(), alive: true };
        let mut walk = Self {
            executable,
            size,
            variables: Variables::default(),
            state,
            frames: Vec::new(),
            accesses: Vec::new(),
            assumed: BTreeSet::new(),
            rounds: Vec::new(),
            unrolled: Vec::new(),
            silent: 0,
            varying: 0,
            open: 0,
            questions: MOST_QUESTIONS,
            divergent: None,
            barriers: Vec::new(),
            ignored,
            asked: BTreeSet::new(),
            exhausted: false,
            undecided: false,
            written,
            resolved: HashMap::new(),
            steps: 0,
        };
        walk.places(axes);
        for constant in &executable.constants {
            if let Constant::Word { to, value } = *constant {
                walk.state.env.insert(to, Value::Number(Polynomial::constant(from_bits(value))));
            }
        }
        walk.numbers();
        walk
    }

    /// Goes through the kernel.
    pub(super) fn run(&mut self) {
        let executable = self.executable;
        self.block(&executable.draft.body);
    }

    pub(super) fn named(&mut self, meaning: Meaning, scope: Scope, interval: Interval) -> Polynomial {
        Polynomial::unknown(self.variables.named(meaning, scope, interval))
    }

    /// The numbers of an invocation and its workgroup; along axes of which nothing asks, there is one workgroup.
    fn places(&mut self, axes: [bool; 3]) {
        for axis in 0..3 {
            let size = i128::from(self.size[axis]);
            let local = self.named(Meaning::Local(axis), Scope::Invocation, (Some(0), Some(size - 1)));
            let most = if axes[axis] { None } else { Some(1) };
            let most = most.unwrap_or(HALF - 1);
            let groups = self.named(Meaning::Groups(axis), Scope::Dispatch, (Some(1), Some(most)));
            let most = if axes[axis] { None } else { Some(0) };
            let most = most.unwrap_or(HALF - 1);
            let group = self.named(Meaning::Group(axis), Scope::Group, (Some(0), Some(most)));
            // An axis has fewer than 2^31 invocations: APIs allow far fewer.
            let global = self.named(Meaning::Global(axis), Scope::Invocation, (Some(0), Some(HALF - 1)));
            let is = Constraint::equal(&global, &group.times(size).plus(&local));
            let below = Constraint::less(&global, &groups.times(size));
            let unknown = |meaning| self.variables.find(meaning);
            if let (Some(g), Some(w)) = (unknown(Meaning::Global(axis)), unknown(Meaning::Group(axis))) {
                let less = Constraint::less(&group, &groups);
                self.variables.get_mut(g).facts.extend([Fact::Is(is), Fact::Is(below)]);
                self.variables.get_mut(w).facts.push(Fact::Is(less));
            }
        }
    }

    /// Gives the built-in values their registers.
    fn numbers(&mut self) {
        let executable = self.executable;
        for (built_in, registers) in &executable.numbers {
            for (axis, register) in registers.iter().enumerate() {
                let find =
                    |walk: &Self, meaning| walk.variables.find(meaning).map(Polynomial::unknown).unwrap_or_default();
                let [x, y, _] = self.size.map(i128::from);
                let value = match built_in {
                    BuiltIn::LocalInvocationId => find(self, Meaning::Local(axis)),
                    BuiltIn::LocalInvocationIndex => {
                        let all = find(self, Meaning::Local(0)).plus_times(&find(self, Meaning::Local(1)), x);
                        all.plus_times(&find(self, Meaning::Local(2)), x * y)
                    }
                    BuiltIn::GlobalInvocationId if self.size[axis] == 1 => find(self, Meaning::Group(axis)),
                    BuiltIn::GlobalInvocationId => find(self, Meaning::Global(axis)),
                    BuiltIn::WorkGroupId => find(self, Meaning::Group(axis)),
                    BuiltIn::WorkGroupSize => Polynomial::constant(i128::from(self.size[axis])),
                    BuiltIn::NumWorkGroups => find(self, Meaning::Groups(axis)),
                    BuiltIn::SubgroupSize | BuiltIn::NumSubgroups => {
                        let meaning = Meaning::Open(Why::Subgroup, None);
                        Polynomial::unknown(self.variables.fresh(meaning, Scope::Dispatch, (Some(1), Some(1024))))
                    }
                    _ => {
                        let meaning = Meaning::Open(Why::Subgroup, None);
                        Polynomial::unknown(self.variables.fresh(meaning, Scope::Invocation, (Some(0), Some(1023))))
                    }
                };
                // A single place is 0.
                let value = match built_in {
                    BuiltIn::LocalInvocationId if self.size[axis] == 1 => Polynomial::constant(0),
                    _ => value,
                };
                self.state.env.insert(register.reg, Value::Number(value));
            }
        }
    }

    pub(super) fn block(&mut self, block: &'e [Inst]) {
        for inst in block {
            self.steps += 1;
            self.exhausted |= self.steps > MOST_STEPS || self.accesses.len() > MOST_ACCESSES;
            if !self.state.alive || self.exhausted || self.undecided {
                return;
            }
            self.step(inst);
        }
    }

    fn step(&mut self, inst: &'e Inst) {
        match inst {
            Inst::Word1 { op, to, a, site } => {
                let value = self.word1(*op, *a, *site);
                self.set(*to, value);
            }
            Inst::Word2 { op, to, a, b, site } => {
                let value = self.word2(*op, *a, *b, *site);
                self.set(*to, value);
            }
            Inst::Copy { to, from } | Inst::Store { to, from } => {
                if to.file() == File::Word {
                    let value = self.value(*from);
                    self.set(to.reg, value);
                }
            }
            Inst::GuardWords { to, from, .. } => {
                let value = self.value(*from);
                self.set(to.reg, value);
            }
            Inst::Begin { to, zero, site } => {
                if to.file() == File::Word {
                    let zeroed = self.executable.written == Written::Wgsl;
                    let value = if zeroed {
                        self.value(*zero)
                    } else {
                        self.open(Why::Operation, Some(*site), Scope::Invocation)
                    };
                    self.set(to.reg, value);
                }
            }
            Inst::Select { to, condition, accept, reject } if to.file() == File::Word => {
                let value = self.selected(*condition, *accept, *reject);
                self.set(to.reg, value);
            }
            Inst::Compare { to, .. } | Inst::Classify { to, .. } => {
                self.set(*to, Value::Truth(Formula::Open(Scope::Invocation)));
            }
            Inst::If { condition, accept, reject } => self.branch(*condition, accept, reject),
            Inst::Switch { selector, cases } => self.switch(*selector, cases),
            Inst::Loop { body, continuing, break_if, site } => self.repeat(body, continuing, *break_if, *site),
            Inst::Call { body } => {
                self.frames.push(self.frame(Kind::Call));
                self.block(body);
                let end = std::mem::replace(&mut self.state, dead());
                self.leave(end);
            }
            Inst::Memory(access) => self.access(access),
            Inst::Length { memory, of, to } => {
                self.asked.insert(*memory);
                let value = self.extent(*memory, *of);
                self.set(*to, Value::Number(value));
            }
            Inst::Barrier { orders, site } => self.barrier(inst, *orders, *site),
            Inst::Fence { orders } => self.state.phases.fence(*orders),
            Inst::Break => self.jump(&[Kind::Loop, Kind::Switch], true),
            Inst::Continue => self.jump(&[Kind::Loop], false),
            Inst::Return => self.jump(&[Kind::Call], true),
            Inst::Kill => self.state.alive = false,
            Inst::ToWords { site, .. } => self.forget(inst, Why::Real, Some(*site)),
            Inst::Texel { site, .. } => self.forget(inst, Why::Element, Some(*site)),
            Inst::Field { site, .. } => self.forget(inst, Why::Operation, *site),
            Inst::Subgroup(own) => self.forget(inst, Why::Subgroup, Some(own.site)),
            other => self.forget(other, Why::Element, None),
        }
    }

    /// Nothing is known of what an instruction writes.
    fn forget(&mut self, inst: &Inst, why: Why, site: Option<Site>) {
        for reg in words_written(inst) {
            let value = self.open(why, site, Scope::Invocation);
            self.set(reg, value);
        }
    }

    pub(super) fn set(&mut self, to: Reg, value: Value) {
        self.state.env.insert(to, value);
    }

    pub(super) fn assume(&mut self, condition: &Formula, truth: bool) {
        let parts = condition.alternatives(truth);
        if parts.is_empty() {
            self.state.alive = false;
        }
        self.state.path.extend(Fact::of(parts));
    }

    fn branch(&mut self, condition: Reg, accept: &'e [Inst], reject: &'e [Inst]) {
        let condition = self.truth(condition);
        if let Formula::Known(truth) = condition {
            return self.block(if truth { accept } else { reject });
        }
        let scope = condition.scope(&self.variables);
        let varies = usize::from(scope == Scope::Invocation);
        self.varying += varies;
        self.open += 1;
        let entry = self.state.clone();
        self.assume(&condition, true);
        self.block(accept);
        let accepted = std::mem::replace(&mut self.state, entry);
        self.assume(&condition, false);
        self.block(reject);
        let rejected = std::mem::replace(&mut self.state, dead());
        self.varying -= varies;
        self.open -= 1;
        self.state = self.joined(vec![accepted, rejected], scope);
    }

    fn switch(&mut self, selector: Reg, cases: &'e [Case]) {
        let selector = self.number(selector);
        let is =
            |case: &Case| case.value.map(|value| Formula::equal(&selector, &Polynomial::constant(from_bits(value))));
        let none = cases.iter().filter_map(is).fold(Formula::Known(true), |all, own| all.and(own.not()));
        let scope = self.variables.scope(&selector);
        let varies = usize::from(scope == Scope::Invocation);
        let entry = self.state.clone();
        self.frames.push(self.frame(Kind::Switch));
        self.varying += varies;
        self.open += usize::from(selector.as_constant().is_none());
        let (mut falling, mut done) = (dead(), Vec::new());
        for case in cases {
            self.state = entry.clone();
            self.assume(&is(case).unwrap_or_else(|| none.clone()), true);
            let own = std::mem::replace(&mut self.state, dead());
            self.state = self.joined(vec![own, falling], scope);
            self.block(&case.body);
            let end = std::mem::replace(&mut self.state, dead());
            falling = dead();
            if case.fall_through { falling = end } else { done.push(end) }
        }
        done.push(falling);
        if cases.iter().all(|case| case.value.is_some()) {
            self.state = entry;
            self.assume(&none, true);
            done.push(std::mem::replace(&mut self.state, dead()));
        }
        self.varying -= varies;
        self.open -= usize::from(selector.as_constant().is_none());
        let mut frame = self.frames.pop();
        done.extend(frame.iter_mut().flat_map(|frame| std::mem::take(&mut frame.left)));
        let varied = frame.is_some_and(|frame| frame.varied);
        self.state = self.joined(done, if varied { Scope::Invocation } else { scope });
    }

    pub(super) fn frame(&self, kind: Kind) -> Frame {
        let (left, next) = (Vec::new(), Vec::new());
        Frame { kind, left, next, varied: false, varying: self.varying, unrolled: false, open: self.open }
    }

    /// Leaves the innermost frame by its end and by all ways out.
    fn leave(&mut self, end: State) {
        let Some(frame) = self.frames.pop() else { return };
        let mut all = frame.left;
        all.push(end);
        self.state = self.joined(all, if frame.varied { Scope::Invocation } else { Scope::Group });
    }

    /// Goes to the end of what is around, or to the next round of a loop.
    fn jump(&mut self, to: &[Kind], out: bool) {
        let state = std::mem::replace(&mut self.state, dead());
        let Some(at) = self.frames.iter().rposition(|frame| to.contains(&frame.kind)) else { return };
        let varying = self.varying;
        // Whatever is around inside of it is left as well.
        for frame in &mut self.frames[at..] {
            frame.varied |= varying > frame.varying;
        }
        let leaves = |k: usize| self.frames[k].unrolled && (out || k > at) && self.open > self.frames[k].open;
        self.undecided |= (at..self.frames.len()).any(leaves);
        let frame = &mut self.frames[at];
        if out { frame.left.push(state) } else { frame.next.push(state) }
    }

    /// One state of several.
    pub(super) fn joined(&mut self, states: Vec<State>, scope: Scope) -> State {
        let mut states: Vec<State> = states.into_iter().filter(|state| state.alive).collect();
        if states.len() < 2 {
            return states.pop().unwrap_or_else(dead);
        }
        let shortest = states.iter().map(|state| state.path.len()).min().unwrap_or(0);
        let common = (0..shortest).find(|&k| states.iter().any(|s| s.path[k] != states[0].path[k])).unwrap_or(shortest);
        let mut env = HashMap::with_capacity(states[0].env.len());
        for (reg, value) in &states[0].env {
            let values: Option<Vec<&Value>> = states.iter().map(|state| state.env.get(reg)).collect();
            let Some(values) = values else { continue };
            if values.iter().all(|own| *own == value) {
                env.insert(*reg, value.clone());
                continue;
            }
            if states.len() > MOST_CASES {
                let open = self.open(Why::Operation, None, Scope::Invocation);
                env.insert(*reg, open);
                continue;
            }
            let cases = states.iter().zip(values).map(|(state, own)| (state.path[common..].to_vec(), own.clone()));
            env.insert(*reg, self.one(cases.collect(), scope));
        }
        let mut phases = states[0].phases.clone();
        states[1..].iter().for_each(|state| phases = phases.joined(&state.phases));
        let path = states[0].path[..common].to_vec();
        State { env, path, phases, alive: true }
    }

    fn barrier(&mut self, inst: &Inst, orders: Barrier, site: Site) {
        if orders == Barrier::SUB_GROUP {
            return;
        }
        if self.varying > 0 || self.frames.iter().any(|frame| frame.varied) {
            if self.silent == 0 {
                self.divergent.get_or_insert(site);
            }
            return;
        }
        if !self.barriers.contains(&site) {
            self.barriers.push(site);
        }
        if !self.ignored.contains(&site) {
            let id = (std::ptr::from_ref(inst) as usize, self.unrolled.clone());
            self.state.phases.pass(id, &self.rounds, orders);
        }
    }
}

/// Nowhere.
pub(super) fn dead() -> State {
    State { env: HashMap::new(), path: Vec::new(), phases: Phases::begin(), alive: false }
}

/// The word registers that an instruction writes.
pub(super) fn words_written(inst: &Inst) -> Vec<Reg> {
    let mut found = Vec::new();
    // A copy, for the registers are only lent to be changed.
    inst.clone().registers(&mut |touch, file, reg| {
        if (touch, file) == (Touch::Write, File::Word) {
            found.push(*reg);
        }
    });
    found
}
