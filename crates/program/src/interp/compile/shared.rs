//! Memory that the invocations of a dispatch share: loads, stores, atomic functions and barriers.

use std::rc::Rc;

use naga::{AtomicFunction, Barrier, Expression, GlobalVariable, Handle, Module, TypeInner};

use super::super::code::{Inst, Reg, Register};
use super::super::domain::Site;
use super::super::group::{Combine, Extent, MemoryAccess, MemoryOp, Step};
use super::layout::RegisterLayout;
use super::wide::is_wide;
use super::{Compiler, Evaluated, Frame, InterpError, Memory, Pointer, unsupported};
use base::value::Scalar;

impl<'m> Compiler<'m> {
    /// A pointer to a whole variable.
    pub(super) fn shared(&self, global: Handle<GlobalVariable>) -> Evaluated {
        let index = self.subject.shared.iter().position(|&own| own == global).unwrap_or_default() as u32;
        let layout = RegisterLayout::of(self.module, &self.module.global_variables[global]);
        let memory = Some(Memory { index, layout, steps: Vec::new() });
        Evaluated::Pointer(Pointer { variable: Rc::from([]), constant: false, offset: 0, indices: Vec::new(), memory })
    }

    /// A part of memory with a known index.
    pub(super) fn shared_part(
        &mut self,
        frame: &Frame<'m>,
        pointer: &Pointer,
        base: Handle<Expression>,
        inner: &TypeInner,
        index: u32,
    ) -> Result<Evaluated, InterpError> {
        let refused = || unsupported("this kind of access".to_owned(), frame.span);
        let layout = pointer.memory.as_ref().map(|memory| memory.layout).ok_or_else(refused)?;
        // What is behind the elements that there are is found where it is used.
        if let TypeInner::Array { size: naga::ArraySize::Dynamic, .. } = inner {
            let (site, reg) = (self.site(frame, base), self.word(index, Scalar::U32).reg);
            return Self::shared_element(self.module, frame, pointer, inner, reg, site);
        }
        let at = layout.part(self.module, inner, index).ok_or_else(refused)?;
        Ok(Evaluated::Pointer(Pointer { offset: pointer.offset + at as usize, ..pointer.clone() }))
    }

    /// A part of memory with an index of each slot's own.
    pub(super) fn shared_element(
        module: &Module,
        frame: &Frame<'m>,
        pointer: &Pointer,
        inner: &TypeInner,
        reg: u32,
        site: Site,
    ) -> Result<Evaluated, InterpError> {
        let refused = || unsupported("this kind of access".to_owned(), frame.span);
        let mut pointer = pointer.clone();
        let memory = pointer.memory.as_mut().ok_or_else(refused)?;
        let (stride, len) = memory.layout.elements(module, inner).ok_or_else(refused)?;
        let len = len.map_or(Extent::Elements, Extent::Fixed);
        memory.steps.push(Step { reg, stride, len, site });
        Ok(Evaluated::Pointer(pointer))
    }

    fn access(pointer: &Pointer, op: MemoryOp, inner: &TypeInner, site: Site) -> Result<Inst, InterpError> {
        let outside = || InterpError::internal("a place outside of memory".to_owned());
        let memory = pointer.memory.as_ref().ok_or_else(outside)?;
        Ok(Inst::Memory(MemoryAccess {
            memory: memory.index,
            offset: u32::try_from(pointer.offset).map_err(|_| outside())?,
            steps: memory.steps.clone(),
            op,
            atomic: matches!(inner, TypeInner::Atomic(_)),
            site,
        }))
    }

    /// Where the scalars of a type lie behind a pointer.
    fn places(&self, pointer: &Pointer, inner: &TypeInner) -> Result<Vec<(Scalar, u32)>, String> {
        let layout = pointer.memory.as_ref().map_or(RegisterLayout::Packed, |memory| memory.layout);
        layout.scalars(self.module, inner)
    }

    pub(super) fn load_shared(
        &mut self,
        site: Site,
        pointer: &Pointer,
        inner: &TypeInner,
    ) -> Result<Vec<Register>, String> {
        let places = self.places(pointer, inner)?;
        let parts: Vec<(Register, u32)> =
            places.into_iter().map(|(scalar, at)| (Register { scalar, reg: self.temporary() }, at)).collect();
        let loaded = parts.iter().map(|(to, _)| *to).collect();
        let inst = Self::access(pointer, MemoryOp::Load(parts), inner, site).map_err(|error| error.to_string())?;
        self.push(inst);
        Ok(loaded)
    }

    pub(super) fn store_shared(
        &mut self,
        frame: &Frame<'m>,
        pointer: &Pointer,
        inner: &TypeInner,
        value: &[Register],
    ) -> Result<(), InterpError> {
        let places = self.places(pointer, inner).map_err(|what| unsupported(what, frame.span))?;
        let parts = value.iter().zip(places).map(|(from, (_, at))| (*from, at)).collect();
        let site = self.statement_site(frame, frame.span);
        let inst = Self::access(pointer, MemoryOp::Store(parts), inner, site)?;
        self.push(inst);
        Ok(())
    }

    /// An atomic function, with the value before as its result.
    pub(super) fn atomic(
        &mut self,
        frame: &mut Frame<'m>,
        pointer: Handle<Expression>,
        function: &AtomicFunction,
        value: Handle<Expression>,
        result: Option<Handle<Expression>>,
    ) -> Result<(), InterpError> {
        let inner = self.pointee(frame, pointer);
        let place = self.pointer(frame, pointer)?;
        if place.memory.is_none() {
            return Err(unsupported("atomics".to_owned(), frame.span));
        }
        if matches!(inner, TypeInner::Scalar(of) | TypeInner::Atomic(of) if is_wide(Some(of))) {
            return Err(unsupported("atomics of 64-bit integers".to_owned(), frame.span));
        }
        let value = self.single(frame, value)?;
        let (op, compare) = self.combine(frame, function)?;
        let before = result.map(|_| Register { reg: self.temporary(), ..value });
        let exchanged = compare.is_some().then(|| self.temporary());
        let site = self.statement_site(frame, frame.span);
        let op = MemoryOp::Atomic { op, value, compare, before, exchanged };
        // GLSL has functions and not types that are atomic.
        let Inst::Memory(access) = Self::access(&place, op, &inner, site)? else { return Ok(()) };
        self.push(Inst::Memory(MemoryAccess { atomic: true, ..access }));
        if let (Some(result), Some(before)) = (result, before) {
            let mut all = vec![before];
            all.extend(exchanged.map(|reg| Register { scalar: Scalar::Bool, reg }));
            frame.values.insert(result, Evaluated::Registers(all.into()));
        }
        Ok(())
    }

    /// What an atomic function does, with the value that it compares with.
    pub(super) fn combine(
        &mut self,
        frame: &mut Frame<'m>,
        function: &AtomicFunction,
    ) -> Result<(Combine, Option<Reg>), InterpError> {
        Ok(match *function {
            AtomicFunction::Add => (Combine::Add, None),
            AtomicFunction::Subtract => (Combine::Subtract, None),
            AtomicFunction::And => (Combine::And, None),
            AtomicFunction::ExclusiveOr => (Combine::Xor, None),
            AtomicFunction::InclusiveOr => (Combine::Or, None),
            AtomicFunction::Min => (Combine::Min, None),
            AtomicFunction::Max => (Combine::Max, None),
            AtomicFunction::Exchange { compare } => {
                let compare = compare.map(|handle| self.single(frame, handle)).transpose()?;
                (Combine::Exchange, compare.map(|register| register.reg))
            }
        })
    }

    pub(super) fn barrier(&mut self, frame: &Frame<'m>, barrier: Barrier, span: naga::Span) -> Result<(), InterpError> {
        if self.subject.shared.is_empty() {
            return Err(unsupported("barriers".to_owned(), span));
        }
        let site = self.statement_site(frame, span);
        self.push(Inst::Barrier { orders: barrier, site });
        Ok(())
    }

    /// One value for the whole workgroup, between two barriers (WGSL, 17.11).
    pub(super) fn uniform_load(
        &mut self,
        frame: &mut Frame<'m>,
        pointer: Handle<Expression>,
        result: Handle<Expression>,
        span: naga::Span,
    ) -> Result<(), InterpError> {
        let inner = self.pointee(frame, pointer);
        let place = self.pointer(frame, pointer)?;
        if place.memory.is_none() {
            return Err(unsupported("loading for a whole workgroup".to_owned(), span));
        }
        self.barrier(frame, Barrier::WORK_GROUP, span)?;
        let site = self.statement_site(frame, span);
        let loaded = self.load_shared(site, &place, &inner).map_err(|what| unsupported(what, span))?;
        self.barrier(frame, Barrier::WORK_GROUP, span)?;
        frame.values.insert(result, Evaluated::Registers(loaded.into()));
        Ok(())
    }

    /// The number of elements of an array that is as long as its memory.
    pub(super) fn array_length(
        &mut self,
        frame: &mut Frame<'m>,
        array: Handle<Expression>,
        span: naga::Span,
    ) -> Result<Register, InterpError> {
        let place = self.pointer(frame, array)?;
        let Some(memory) = place.memory else {
            return Err(unsupported("arrays of run-time size".to_owned(), span));
        };
        let to = self.temporary();
        self.push(Inst::Length { memory: memory.index, of: Extent::Elements, to });
        Ok(Register { scalar: Scalar::U32, reg: to })
    }
}
