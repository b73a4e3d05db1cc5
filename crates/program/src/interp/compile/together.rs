//! All invocations of a dispatch as one program: one after the other, and between two barriers all of them.
//!
//! Whatever order races would need is looked for elsewhere, see [`group`](crate::interp::group): a shader without any gives
//! the same in every order. Code is written for each invocation, so that what it knows of itself is a constant, and most
//! places in memory are known while the code is written.

use std::collections::HashMap;
use std::rc::Rc;

use naga::valid::FunctionInfo;
use naga::{AddressSpace, Block, BuiltIn, Expression, Function, GlobalVariable, Handle, Statement};

use super::super::code::{Case, Inst, Reg, Register, Word1, Word2};
use super::super::integer;
use super::super::meaning::HazardKind;
use super::super::slots::SLOTS;
use super::{Compiler, Evaluated, Frame, InterpError, unsupported};
use base::value::Scalar;

/// Invocations of a workgroup at most; devices have 1,024, or a few more.
const LARGEST: u32 = 1 << 11;

/// Invocations of a dispatch at most.
const MOST: u64 = 1 << 16;

/// One invocation of a workgroup while its code is written.
struct Invocation<'m> {
    frame: Frame<'m>,
    own: HashMap<Handle<GlobalVariable>, Rc<[Register]>>,
}

type Own = HashMap<Handle<GlobalVariable>, Rc<[Register]>>;

/// Bytes of a text, with the function that they belong to.
pub(super) type Stretch = (Option<Handle<Function>>, Option<std::ops::Range<usize>>);

/// A call of a function, with its arguments and where its result goes.
type Call<'m> = (Option<Handle<Function>>, &'m Function, &'m FunctionInfo, Vec<Evaluated>, Rc<[Register]>);

impl<'m> Compiler<'m> {
    /// The code of all workgroups.
    pub(super) fn dispatch(
        &mut self,
        groups: [u32; 3],
        function: &'m Function,
        info: &'m FunctionInfo,
    ) -> Result<Vec<Inst>, InterpError> {
        let size = self.module.entry_points.iter().find(|p| std::ptr::eq(&raw const p.function, function));
        let size = size.map_or([1; 3], |point| point.workgroup_size);
        let of_group: u64 = size.iter().map(|&n| u64::from(n)).product();
        let all = groups.iter().fold(of_group, |all, &n| all.saturating_mul(u64::from(n)));
        let at = function.expressions.iter().next().map(|(handle, _)| function.expressions.get_span(handle));
        let at = function.body.span_iter().next().map(|(_, span)| *span).or(at).unwrap_or_default();
        if of_group > u64::from(LARGEST) {
            return Err(unsupported(format!("a workgroup of {of_group} invocations; {LARGEST} at most are run"), at));
        }
        if all > MOST {
            return Err(unsupported(format!("a dispatch of {all} invocations; {MOST} at most are run"), at));
        }
        let shared: Vec<_> = self.module.global_variables.iter().collect();
        let shared: Vec<_> = shared.into_iter().filter(|(_, v)| v.space == AddressSpace::WorkGroup).collect();
        let mut code = Vec::new();
        for group in places(groups) {
            for &(handle, _) in &shared {
                // The memory of a workgroup comes to life with it.
                if info[handle].is_empty() {
                    continue;
                }
                let site = self.declared(None, self.module.global_variables.get_span(handle));
                for &to in self.global(handle)?.iter() {
                    let begin = self.begin(to, HazardKind::Unset, site);
                    self.push(begin);
                }
            }
            let mut invocations = Vec::new();
            let mut owns = Vec::new();
            for local in places(size) {
                let arguments = self.built_ins(function, groups, group, size, local, at)?;
                invocations.push((None, function, info, arguments, Rc::from([])));
                owns.push(Own::new());
            }
            let body = self.all_of(invocations, owns)?.0;
            code.append(&mut self.code);
            code.push(Inst::Call { body });
        }
        Ok(code)
    }

    /// What an invocation is told about itself.
    fn built_ins(
        &mut self,
        function: &Function,
        groups: [u32; 3],
        group: [u32; 3],
        size: [u32; 3],
        local: [u32; 3],
        at: naga::Span,
    ) -> Result<Vec<Evaluated>, InterpError> {
        let mut values = Vec::new();
        for argument in &function.arguments {
            let built_in = match argument.binding {
                Some(naga::Binding::BuiltIn(built_in)) => built_in,
                _ => {
                    return Err(InterpError::internal(
                        "an argument of a compute stage that no built-in feeds".to_owned(),
                    ));
                }
            };
            let words = match built_in {
                BuiltIn::GlobalInvocationId => (0..3).map(|k| group[k] * size[k] + local[k]).collect(),
                BuiltIn::LocalInvocationId => local.to_vec(),
                BuiltIn::WorkGroupId => group.to_vec(),
                BuiltIn::NumWorkGroups => groups.to_vec(),
                BuiltIn::WorkGroupSize => size.to_vec(),
                BuiltIn::LocalInvocationIndex => vec![local[0] + size[0] * (local[1] + size[1] * local[2])],
                other => return Err(unsupported(format!("a dispatch with {other:?}"), at)),
            };
            values.push(Evaluated::Registers(words.into_iter().map(|w| self.word(w, Scalar::U32)).collect()));
        }
        Ok(values)
    }

    /// Writes what invocations do from their calls of a function to its end. Gives their own variables back.
    fn all_of(&mut self, calls: Vec<Call<'m>>, owns: Vec<Own>) -> Result<(Vec<Inst>, Vec<Own>), InterpError> {
        let Some(&(_, function, ..)) = calls.first() else { return Ok((Vec::new(), owns)) };
        let outside = std::mem::take(&mut self.code);
        let mut all = Vec::new();
        for ((handle, function, info, arguments, result), own) in calls.into_iter().zip(owns) {
            let before = std::mem::replace(&mut self.own, own);
            let frame = self.frame(handle, function, info, arguments, result)?;
            all.push(Invocation { frame, own: std::mem::replace(&mut self.own, before) });
        }
        self.together(&mut all, &function.body, true)?;
        let body = std::mem::replace(&mut self.code, outside);
        Ok((body, all.into_iter().map(|invocation| invocation.own).collect()))
    }

    /// Writes code of one invocation.
    fn within<T>(
        &mut self,
        invocation: &mut Invocation<'m>,
        write: impl FnOnce(&mut Self, &mut Frame<'m>) -> Result<T, InterpError>,
    ) -> Result<T, InterpError> {
        std::mem::swap(&mut self.own, &mut invocation.own);
        let result = write(self, &mut invocation.frame);
        std::mem::swap(&mut self.own, &mut invocation.own);
        result
    }

    /// Writes a block for all invocations: what holds no barrier for one after the other, what holds one for all together.
    /// The last block of a function may be left by some of them behind its last barrier.
    fn together(&mut self, all: &mut [Invocation<'m>], block: &'m Block, last: bool) -> Result<(), InterpError> {
        let statements: Vec<(&'m Statement, naga::Span)> = block.span_iter().map(|(s, &span)| (s, span)).collect();
        let tail = if last {
            statements.iter().rposition(|(s, _)| self.waits(s)).map_or(0, |k| k + 1)
        } else {
            statements.len()
        };
        let mut k = 0;
        while k < tail {
            let end = k + statements[k..tail].iter().take_while(|(s, _)| !self.waits(s) && !leaves(s, true)).count();
            for invocation in all.iter_mut() {
                self.within(invocation, |this, frame| this.in_turn(frame, &statements[k..end]))?;
            }
            if let Some(&(statement, span)) = statements[k..tail].get(end - k) {
                self.check_size(span)?;
                self.jointly(all, statement, span)?;
            }
            k = end + 1;
        }
        if tail < statements.len() {
            for invocation in all.iter_mut() {
                let outside = std::mem::take(&mut self.code);
                let (known, assigned) = (self.known.clone(), self.assigned.clone());
                self.within(invocation, |this, frame| this.in_turn(frame, &statements[tail..]))?;
                let body = std::mem::replace(&mut self.code, outside);
                // An invocation may have returned on the way.
                if statements[tail..].iter().any(|(s, _)| leaves(s, true)) {
                    self.known.retain(|variable, reg| known.get(variable) == Some(reg));
                    self.assigned = assigned;
                }
                self.push(Inst::Call { body });
            }
        }
        Ok(())
    }

    /// Writes statements of one invocation.
    fn in_turn(
        &mut self,
        frame: &mut Frame<'m>,
        statements: &[(&'m Statement, naga::Span)],
    ) -> Result<(), InterpError> {
        for &(statement, span) in statements {
            frame.span = span;
            self.check_size(span)?;
            self.statement(frame, statement, span, &[])?;
        }
        Ok(())
    }

    /// Writes a statement that all invocations take the same way through.
    fn jointly(
        &mut self,
        all: &mut [Invocation<'m>],
        statement: &'m Statement,
        span: naga::Span,
    ) -> Result<(), InterpError> {
        for invocation in all.iter_mut() {
            invocation.frame.span = span;
        }
        match statement {
            Statement::Block(block) => self.together(all, block, false)?,
            Statement::ControlBarrier(_) => {}
            Statement::If { condition, accept, reject } => {
                let condition = self.common(all, *condition, span)?;
                let before = self.known.clone();
                let mut ways = Vec::new();
                for block in [accept, reject] {
                    let rest = std::mem::replace(&mut self.known, before.clone());
                    let assigned = self.assigned.clone();
                    ways.push(self.block_of(all, block)?);
                    let after = std::mem::replace(&mut self.known, rest);
                    self.known.retain(|variable, reg| after.get(variable) == Some(reg));
                    self.assigned = assigned;
                }
                let (reject, accept) = (ways.pop().unwrap_or_default(), ways.pop().unwrap_or_default());
                self.push(Inst::If { condition, accept, reject });
            }
            Statement::Switch { selector, cases } => {
                let selector = self.common(all, *selector, span)?;
                let assigned = self.assigned.clone();
                let mut compiled = Vec::new();
                for case in cases {
                    self.known.clear();
                    let value = match case.value {
                        naga::SwitchValue::I32(value) => Some(value.cast_unsigned()),
                        naga::SwitchValue::U32(value) => Some(value),
                        naga::SwitchValue::Default => None,
                    };
                    let body = self.block_of(all, &case.body)?;
                    self.assigned = assigned.clone();
                    compiled.push(Case { value, body, fall_through: case.fall_through });
                }
                self.known.clear();
                self.push(Inst::Switch { selector, cases: compiled });
            }
            Statement::Loop { body, continuing, break_if } => {
                self.known.clear();
                let assigned = self.assigned.clone();
                let body = self.block_of(all, body)?;
                self.known.clear();
                self.assigned = assigned.clone();
                let outside = std::mem::take(&mut self.code);
                self.together(all, continuing, false)?;
                let break_if = break_if.map(|handle| self.common(all, handle, span)).transpose()?;
                let continuing = std::mem::replace(&mut self.code, outside);
                self.known.clear();
                self.assigned = assigned;
                let site = self.statement_site(&all[0].frame, span);
                self.push(Inst::Loop { body, continuing, break_if, site });
            }
            Statement::Break => self.push(Inst::Break),
            Statement::Continue => self.push(Inst::Continue),
            Statement::Return { value } => {
                if let Some(value) = *value {
                    for invocation in all.iter_mut() {
                        self.within(invocation, |this, frame| {
                            let from = this.registers(frame, value)?;
                            for (&to, from) in frame.result.clone().iter().zip(from.iter()) {
                                this.push(Inst::Store { to, from: from.reg });
                            }
                            Ok(())
                        })?;
                    }
                }
                self.push(Inst::Return);
            }
            Statement::WorkGroupUniformLoad { pointer, result } => {
                for invocation in all.iter_mut() {
                    self.within(invocation, |this, frame| {
                        let inner = this.pointee(frame, *pointer);
                        let site = this.statement_site(frame, span);
                        let len = super::types::count(this.module, &inner).map_err(|what| unsupported(what, span))?;
                        let place = this.pointer(frame, *pointer)?;
                        let loaded = this.load(frame, site, &place, len)?;
                        frame.values.insert(*result, Evaluated::Registers(loaded.into()));
                        Ok(())
                    })?;
                }
            }
            Statement::Call { function, arguments, result } => {
                self.call_of_all(all, *function, arguments, *result, span)?
            }
            _ => return Err(unsupported("a barrier in this kind of statement".to_owned(), span)),
        }
        Ok(())
    }

    fn block_of(&mut self, all: &mut [Invocation<'m>], block: &'m Block) -> Result<Vec<Inst>, InterpError> {
        let outside = std::mem::take(&mut self.code);
        self.together(all, block, false)?;
        Ok(std::mem::replace(&mut self.code, outside))
    }

    /// A value that all invocations have to agree on.
    fn common(
        &mut self,
        all: &mut [Invocation<'m>],
        handle: Handle<Expression>,
        span: naga::Span,
    ) -> Result<Reg, InterpError> {
        let mut values = Vec::new();
        for invocation in all.iter_mut() {
            values.push(self.within(invocation, |this, frame| this.single(frame, handle))?.reg);
        }
        let site = self.statement_site(&all[0].frame, span);
        let first = values[0];
        let mut others: Vec<Reg> = values.into_iter().filter(|&reg| reg != first).collect();
        others.sort_unstable();
        others.dedup();
        if !others.is_empty() {
            self.push(Inst::Agree { first, others, site });
        }
        Ok(first)
    }

    fn call_of_all(
        &mut self,
        all: &mut [Invocation<'m>],
        handle: Handle<Function>,
        arguments: &[Handle<Expression>],
        result: Option<Handle<Expression>>,
        span: naga::Span,
    ) -> Result<(), InterpError> {
        let function = &self.module.functions[handle];
        let info = &self.subject.info[handle];
        let (mut calls, mut owns, mut results) = (Vec::new(), Vec::new(), Vec::new());
        for invocation in all.iter_mut() {
            let values = self.within(invocation, |this, frame| {
                arguments.iter().map(|&a| this.value(frame, a)).collect::<Result<Vec<_>, _>>()
            })?;
            let registers = match &function.result {
                Some(result) => self.variable(result.ty, span)?,
                None => Rc::from([]),
            };
            results.push(registers.clone());
            calls.push((Some(handle), function, info, values, registers));
            owns.push(std::mem::take(&mut invocation.own));
        }
        let assigned = self.assigned.clone();
        let (body, owns) = self.all_of(calls, owns)?;
        self.known.clear();
        self.assigned = assigned;
        self.push(Inst::Call { body });
        for ((invocation, own), registers) in all.iter_mut().zip(owns).zip(results) {
            invocation.own = own;
            if let Some(result) = result {
                let copies = self.copies(&registers);
                invocation.frame.values.insert(result, Evaluated::Registers(copies.into()));
            }
        }
        Ok(())
    }

    /// True for a statement in which invocations wait for each other.
    fn waits(&self, statement: &Statement) -> bool {
        any(statement, &|s| match s {
            Statement::ControlBarrier(_) | Statement::WorkGroupUniformLoad { .. } => true,
            Statement::Call { function, .. } => {
                self.module.functions[*function].body.iter().any(|inner| self.waits(inner))
            }
            _ => false,
        })
    }

    /// The number in a register where it is known while the code of a dispatch is written.
    pub(super) fn number(&self, reg: Reg) -> Option<u32> {
        self.subject.dispatch.and_then(|_| self.numbers.get(&reg).copied())
    }

    pub(super) fn known_word1(&self, op: Word1, a: Register) -> Option<u32> {
        let a = [self.number(a.reg)?; SLOTS];
        integer::doubts1(op, &a).is_none().then(|| integer::word1(op, &a)[0])
    }

    pub(super) fn known_word2(&self, op: Word2, a: Reg, b: Reg) -> Option<u32> {
        let (a, b) = ([self.number(a)?; SLOTS], [self.number(b)?; SLOTS]);
        let clear = integer::doubts2(op, &a, &b).iter().all(Option::is_none);
        clear.then(|| integer::word2(op, &a, &b)[0])
    }
}

/// Places along three axes, x first.
fn places(size: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    let [x, y, z] = size;
    (0..z).flat_map(move |c| (0..y).flat_map(move |b| (0..x).map(move |a| [a, b, c])))
}

fn any(statement: &Statement, is: &dyn Fn(&Statement) -> bool) -> bool {
    let of = |block: &Block| block.iter().any(|inner| any(inner, is));
    is(statement)
        || match statement {
            Statement::Block(inner) => of(inner),
            Statement::If { accept, reject, .. } => of(accept) || of(reject),
            Statement::Switch { cases, .. } => cases.iter().any(|case| of(&case.body)),
            Statement::Loop { body, continuing, .. } => of(body) || of(continuing),
            _ => false,
        }
}

/// True for a statement that can lead out of its block. `open` is where a `break` leads further than the statement.
fn leaves(statement: &Statement, open: bool) -> bool {
    let of = |block: &Block, open: bool| block.iter().any(|inner| leaves(inner, open));
    match statement {
        Statement::Return { .. } | Statement::Kill => true,
        Statement::Break | Statement::Continue => open,
        Statement::Block(inner) => of(inner, open),
        Statement::If { accept, reject, .. } => of(accept, open) || of(reject, open),
        // `continue` leads out of a switch; one in a loop of its own is seen as leading there.
        Statement::Switch { cases, .. } => {
            cases.iter().any(|case| of(&case.body, false) || continues(&case.body, open))
        }
        Statement::Loop { body, continuing, .. } => of(body, false) || of(continuing, false),
        _ => false,
    }
}

/// True when a `continue` leads out of the block.
fn continues(block: &Block, open: bool) -> bool {
    open && block.iter().any(|statement| match statement {
        Statement::Continue => true,
        Statement::Block(inner) => continues(inner, open),
        Statement::If { accept, reject, .. } => continues(accept, open) || continues(reject, open),
        Statement::Switch { cases, .. } => cases.iter().any(|case| continues(&case.body, open)),
        _ => false,
    })
}
