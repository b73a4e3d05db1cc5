//! Statements and calls.

use std::collections::HashMap;
use std::rc::Rc;

use naga::valid::FunctionInfo;
use naga::{Block, Expression, Function, Handle, Statement, SwitchValue};

use super::super::code::{Case, File, Inst, Place, Reached, Reg, Register};
use super::super::domain::Site;
use super::super::meaning::HazardKind;
use super::{Compiler, Evaluated, Frame, InterpError, unsupported};
use crate::NO_RETURN;

/// Deepest chain of calls; naga allows no recursion.
const MAX_DEPTH: usize = 128;

type Known = HashMap<(File, Reg), Reg>;

impl<'m> Compiler<'m> {
    /// Expands a function. Gives its instructions.
    pub(super) fn function(
        &mut self,
        handle: Option<Handle<Function>>,
        function: &'m Function,
        info: &'m FunctionInfo,
        arguments: Vec<Evaluated>,
        result: Rc<[Register]>,
    ) -> Result<Vec<Inst>, InterpError> {
        let outside = std::mem::take(&mut self.code);
        let mut frame = self.frame(handle, function, info, arguments, result)?;
        self.statements(&mut frame, &function.body)?;
        Ok(std::mem::replace(&mut self.code, outside))
    }

    /// A call of a function whose variables have come to life.
    pub(super) fn frame(
        &mut self,
        handle: Option<Handle<Function>>,
        function: &'m Function,
        info: &'m FunctionInfo,
        arguments: Vec<Evaluated>,
        result: Rc<[Register]>,
    ) -> Result<Frame<'m>, InterpError> {
        let mut frame = Frame {
            handle,
            function,
            info,
            arguments,
            locals: HashMap::new(),
            values: HashMap::new(),
            result,
            span: naga::Span::UNDEFINED,
        };
        self.narrow_arguments(&mut frame);
        for (local, variable) in function.local_variables.iter() {
            let registers = self.variable(variable.ty, function.local_variables.get_span(local))?;
            frame.locals.insert(local, registers.clone());
            // Variables of the front ends hold what an expression gives, but for the arguments of `out` parameters.
            let name = variable.name.as_deref().unwrap_or("sc_");
            let kind = if name == NO_RETURN { HazardKind::NoReturn } else { HazardKind::Unset };
            let authors = !name.starts_with("sc_") || name.starts_with("sc_argument") || kind == HazardKind::NoReturn;
            let Some(init) = variable.init else {
                let site = self.declared(handle, function.local_variables.get_span(local));
                for &to in registers.iter() {
                    let begin = self.begin(to, kind, site);
                    self.push(begin);
                    if !authors {
                        self.unset.remove(&super::key(to));
                    }
                }
                continue;
            };
            let initial = self.registers(&mut frame, init)?.to_vec();
            for (&to, from) in registers.iter().zip(initial) {
                // A slot outside of this call has no such variable: no mask is needed.
                self.push(Inst::Copy { to, from: from.reg });
                self.known.insert(super::key(to), from.reg);
            }
        }
        Ok(frame)
    }

    /// Parameters of lower precision take what they are given as numbers of it.
    fn narrow_arguments(&mut self, frame: &mut Frame<'m>) {
        if !self.subject.lowered {
            return;
        }
        for (handle, expression) in frame.function.expressions.iter() {
            let &Expression::FunctionArgument(index) = expression else { continue };
            let site = self.site(frame, handle);
            if let Some(Evaluated::Registers(registers)) = frame.arguments.get(index as usize).cloned() {
                frame.arguments[index as usize] = Evaluated::Registers(self.narrowed(site, &registers).into());
            }
        }
    }

    /// A block of its own.
    fn block(&mut self, frame: &mut Frame<'m>, block: &'m Block) -> Result<Vec<Inst>, InterpError> {
        let outside = std::mem::take(&mut self.code);
        self.statements(frame, block)?;
        Ok(std::mem::replace(&mut self.code, outside))
    }

    /// A block that may or may not be run: what is known behind it is what both ways agree on.
    fn branch(&mut self, frame: &mut Frame<'m>, block: &'m Block, before: &Known) -> Result<Vec<Inst>, InterpError> {
        let rest = std::mem::replace(&mut self.known, before.clone());
        let assigned = self.assigned.clone();
        let code = self.block(frame, block)?;
        let after = std::mem::replace(&mut self.known, rest);
        self.known.retain(|variable, reg| after.get(variable) == Some(reg));
        self.assigned = assigned;
        Ok(code)
    }

    fn statements(&mut self, frame: &mut Frame<'m>, block: &'m Block) -> Result<(), InterpError> {
        for (k, (statement, &span)) in block.span_iter().enumerate() {
            frame.span = span;
            self.check_size(span)?;
            self.reach(span, None);
            self.statement(frame, statement, span, &block[k + 1..])?;
        }
        Ok(())
    }

    /// Counts the slots that get here, where that is asked for.
    fn reach(&mut self, span: naga::Span, branch: Option<bool>) {
        let counted = self.counted(span, branch);
        self.code.extend(counted);
    }

    fn counted(&mut self, span: naga::Span, branch: Option<bool>) -> Option<Inst> {
        if !self.subject.covered || !span.is_defined() {
            return None;
        }
        self.executable.reached.push(Reached { span, branch });
        Some(Inst::Reach { at: self.executable.reached.len() as u32 - 1 })
    }

    pub(super) fn statement(
        &mut self,
        frame: &mut Frame<'m>,
        statement: &'m Statement,
        span: naga::Span,
        rest: &'m [Statement],
    ) -> Result<(), InterpError> {
        let refuse = |what: &str| Err(unsupported(what.to_owned(), span));
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone() {
                    let value = self.expression(frame, handle)?;
                    frame.values.insert(handle, value);
                }
            }
            Statement::Block(block) => self.statements(frame, block)?,
            Statement::If { condition, accept, reject } => {
                let condition = self.single(frame, *condition)?.reg;
                if let Some(known) = self.number(condition).filter(|_| !self.subject.covered) {
                    return self.statements(frame, if known != 0 { accept } else { reject });
                }
                let before = self.known.clone();
                let mut accept = self.branch(frame, accept, &before)?;
                let mut reject = self.branch(frame, reject, &before)?;
                for (code, branch) in [(&mut accept, true), (&mut reject, false)] {
                    code.splice(0..0, self.counted(span, Some(branch)));
                }
                self.push(Inst::If { condition, accept, reject });
            }
            Statement::Switch { selector, cases } => {
                let selector = self.single(frame, *selector)?.reg;
                let before = self.known.clone();
                let mut compiled = Vec::new();
                let mut falls = false;
                for case in cases {
                    // Behind a case that falls through, nothing is known but what no case changes.
                    let entry = if falls { Known::new() } else { before.clone() };
                    let value = match case.value {
                        SwitchValue::I32(value) => Some(value.cast_unsigned()),
                        SwitchValue::U32(value) => Some(value),
                        SwitchValue::Default => None,
                    };
                    let body = self.branch(frame, &case.body, &entry)?;
                    compiled.push(Case { value, body, fall_through: case.fall_through });
                    falls = case.fall_through;
                }
                self.push(Inst::Switch { selector, cases: compiled });
            }
            Statement::Loop { body, continuing, break_if } => {
                // A later round knows nothing of what an earlier one has changed.
                self.known.clear();
                let outside = std::mem::take(&mut self.code);
                let assigned = self.assigned.clone();
                self.statements(frame, body)?;
                let body = std::mem::take(&mut self.code);
                // Slots get to the end of a round on several ways.
                self.known.clear();
                self.assigned = assigned.clone();
                self.statements(frame, continuing)?;
                let break_if = break_if.map(|b| self.single(frame, b)).transpose()?.map(|register| register.reg);
                let continuing = std::mem::replace(&mut self.code, outside);
                self.known.clear();
                self.assigned = assigned;
                let site = self.statement_site(frame, span);
                self.push(Inst::Loop { body, continuing, break_if, site });
            }
            Statement::Break => self.push(Inst::Break),
            Statement::Continue => self.push(Inst::Continue),
            Statement::Return { value } => {
                if let Some(value) = value {
                    let from = self.registers(frame, *value)?;
                    for (&to, from) in frame.result.clone().iter().zip(from.iter()) {
                        self.push(Inst::Store { to, from: from.reg });
                    }
                }
                self.push(Inst::Return);
            }
            Statement::Kill => self.push(Inst::Kill),
            Statement::Store { pointer, value } => {
                let inner = self.pointee(frame, *pointer);
                let pointer = self.pointer(frame, *pointer)?;
                let value = self.registers(frame, *value)?;
                let value = match self.written(frame, span) {
                    Some(site) => Rc::from(self.narrowed(site, &value)),
                    None => value,
                };
                if pointer.memory.is_some() {
                    self.store_shared(frame, &pointer, &inner, &value)?;
                } else {
                    self.store(frame, &pointer, &value)?;
                }
            }
            Statement::Call { function, arguments, result } => {
                self.call(frame, *function, arguments, rest, *result, span)?;
            }
            Statement::ControlBarrier(barrier) => self.barrier(frame, *barrier, span)?,
            Statement::MemoryBarrier(orders) if !self.subject.shared.is_empty() => {
                self.push(Inst::Fence { orders: *orders });
            }
            // A single invocation does everything in order.
            Statement::MemoryBarrier(_) if self.subject.dispatch.is_some() => {}
            Statement::MemoryBarrier(_) => return refuse("memory barriers"),
            Statement::ImageStore { image, coordinate, array_index, value } => {
                self.store_texel(frame, *image, (*coordinate, *array_index), *value, span)?;
            }
            Statement::Atomic { pointer, fun, value, result } => {
                self.atomic(frame, *pointer, fun, *value, *result)?;
            }
            Statement::ImageAtomic { image, coordinate, array_index, fun, value } => {
                self.atomic_texel(frame, *image, (*coordinate, *array_index), fun, *value, span)?;
            }
            Statement::WorkGroupUniformLoad { pointer, result } => {
                self.uniform_load(frame, *pointer, *result, span)?;
            }
            Statement::RayQuery { .. } => return refuse("ray queries"),
            Statement::RayPipelineFunction(_) => return refuse("ray tracing"),
            Statement::SubgroupBallot { .. }
            | Statement::SubgroupGather { .. }
            | Statement::SubgroupCollectiveOperation { .. } => self.subgroup(frame, statement, span)?,
            Statement::CooperativeStore { .. } => return refuse("cooperative matrices"),
        }
        Ok(())
    }

    pub(super) fn statement_site(&mut self, frame: &Frame<'m>, span: naga::Span) -> Site {
        let sites = &mut self.executable.sites;
        let mut new = || {
            sites.push(Place { function: frame.handle, expression: None, span });
            Site::new(sites.len() - 1)
        };
        match self.subject.dispatch {
            None => new(),
            // All invocations share the places of their code.
            Some(_) => *self.statements.entry((frame.handle, span.to_range())).or_insert_with(new),
        }
    }

    fn call(
        &mut self,
        frame: &mut Frame<'m>,
        handle: Handle<Function>,
        arguments: &[Handle<Expression>],
        rest: &'m [Statement],
        result: Option<Handle<Expression>>,
        span: naga::Span,
    ) -> Result<(), InterpError> {
        let function = &self.module.functions[handle];
        if self.subject.max_vertices.is_some() && arguments.is_empty() {
            let inst = match function.name.as_deref() {
                Some("EmitVertex") => Some(Inst::EmitVertex),
                Some("EndPrimitive") => Some(Inst::EndPrimitive),
                _ => None,
            };
            if let Some(inst) = inst {
                // The outputs are undefined behind it.
                self.known.clear();
                self.push(inst);
                return Ok(());
            }
        }
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(unsupported("chains of calls so deep".to_owned(), span));
        }
        let values = arguments.iter().map(|&a| self.value(frame, a)).collect::<Result<Vec<_>, _>>()?;
        let registers = match &function.result {
            Some(result) => self.variable(result.ty, span)?,
            None => Rc::from([]),
        };
        let assigned = self.assigned.clone();
        let body =
            self.function(Some(handle), function, &self.subject.info[handle], values.clone(), registers.clone())?;
        self.depth -= 1;
        self.known.clear();
        // Slots may have returned before they wrote.
        self.assigned = assigned;
        self.push(Inst::Call { body });
        self.note_overlaps(frame, function, arguments, &values, rest, span);
        if let Some(result) = result {
            // The registers of the result are written again when this call is run again.
            let copies = self.copies(&registers);
            let site = self.site(frame, result);
            let copies = self.narrowed(site, &copies);
            frame.values.insert(result, Evaluated::Registers(copies.into()));
        }
        Ok(())
    }

    /// Copies to temporaries.
    pub(super) fn copies(&mut self, registers: &[Register]) -> Vec<Register> {
        let mut copies = Vec::with_capacity(registers.len());
        for register in registers {
            let to = Register { reg: self.temporary(), ..*register };
            self.push(Inst::Copy { to, from: register.reg });
            copies.push(to);
        }
        copies
    }
}
