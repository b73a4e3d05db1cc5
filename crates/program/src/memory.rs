//! Storage blocks of one invocation: what they hold before it runs goes in, and what they hold behind it
//! comes out.
//!
//! Each invocation gets memory of its own, as if it were dispatched alone. What invocations tell each other
//! is not run so: a program that waits for others, or shares memory in its group, stays as it is.

use naga::{
    AddressSpace, AtomicFunction, BinaryOperator as B, Block, Expression, Function, GlobalVariable, Handle, Literal,
    MathFunction, Module, Range, Span, Statement, StructMember, Type, TypeInner,
};

use super::fuel::blocks_mut;
use super::{Entry, Port, PortAt, Program, ProgramError, capture, validate};
use base::diagnostic::Diagnostic;
use base::value::{Field, Shape};

/// Elements of an array that is as long as its buffer, where one invocation runs alone.
pub const LENGTH: u32 = 4;

/// A storage block.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pub global: Handle<GlobalVariable>,
    /// Values inside: name, indices on the way, shape.
    pub parts: Vec<(String, Vec<u32>, Shape)>,
    /// False for one that is only read.
    pub written: bool,
    /// Said where it is not fed.
    pub diagnostic: Diagnostic,
    /// True when something inside cannot be fed.
    pub partial: bool,
    /// True for one that is as long as its buffer.
    pub open: bool,
}

impl Program {
    /// The program with its storage blocks as inputs and outputs; the same program when it has none, when its
    /// invocations need each other, and when it looks behind the elements that an array gets here.
    ///
    /// # Errors
    /// [`ProgramError::Internal`] for a module that does not come out valid.
    pub fn with_memory_inside(self) -> Result<Self, ProgramError> {
        let before = self.clone();
        match self.fed_from_memory() {
            // An index that is known can lie behind the elements that there are.
            Err(ProgramError::Internal(_)) if before.memory.iter().any(|m| m.open) => Ok(before),
            other => other,
        }
    }

    /// True for a variable that is used where the program is entered: a text may declare memory that it does without.
    pub(super) fn uses(&self, global: Handle<GlobalVariable>) -> bool {
        let info = match self.entry {
            Entry::Function(function) => &self.info[function],
            Entry::Point(entry) => self.info.get_entry_point(entry),
        };
        !info[global].is_empty()
    }

    fn fed_from_memory(mut self) -> Result<Self, ProgramError> {
        let memory = std::mem::take(&mut self.memory);
        self.memory = memory.into_iter().filter(|memory| self.uses(memory.global)).collect();
        let alone = self.memory.iter().all(|m| !m.partial) && !self.memory.is_empty();
        let single = |b: &naga::BuiltIn| !matches!(b, naga::BuiltIn::NumWorkGroups | naga::BuiltIn::SubgroupSize);
        if !alone || !self.built_ins.iter().all(|(_, b)| single(b)) || needs_others(&self.module) {
            return Ok(self);
        }
        let mut module = self.module.clone();
        for memory in std::mem::take(&mut self.memory) {
            let inner = plain(&mut module, self.module.global_variables[memory.global].ty);
            let variable = &mut module.global_variables[memory.global];
            variable.space = AddressSpace::Private;
            variable.binding = None;
            variable.ty = inner;
            let after = memory.written.then(|| {
                let name = format!("{}_after", module.global_variables[memory.global].name.clone().unwrap_or_default());
                capture::add_global(&mut module, &name, AddressSpace::Private, None, inner)
            });
            for (name, path, shape) in memory.parts {
                let ty = path.iter().fold(inner, |ty, &k| inside(&mut module, ty, k));
                let at = |global| match path[..] {
                    [] => PortAt::Global(global),
                    _ => PortAt::Part { global, path: path.clone() },
                };
                let port =
                    |global| Port { field: Field { name: name.clone(), shape }, ty, at: at(global), backing: None };
                self.inputs.push(port(memory.global));
                self.outputs.extend(after.map(port));
                self.instrumented |= after.is_some();
            }
            if let Some(after) = after {
                let function = match self.entry {
                    Entry::Point(entry) => &mut module.entry_points[entry].function,
                    Entry::Function(function) => &mut module.functions[function],
                };
                copy_at_end(function, memory.global, after);
            }
        }
        for (_, function) in module.functions.iter_mut() {
            rewrite(function)?;
        }
        for point in &mut module.entry_points {
            rewrite(&mut point.function)?;
        }
        self.info = validate(&module)?;
        self.module = module;
        Ok(self)
    }
}

/// True when invocations of a subgroup see each other's values, or ask which of it they are.
pub(super) fn uses_subgroups(module: &Module) -> bool {
    use naga::BuiltIn::{NumSubgroups, SubgroupId, SubgroupInvocationId, SubgroupSize};
    let sees = |f: &Function| {
        let of = |s: &Statement| {
            matches!(
                s,
                Statement::SubgroupBallot { .. }
                    | Statement::SubgroupGather { .. }
                    | Statement::SubgroupCollectiveOperation { .. }
            )
        };
        any(&f.body, &of)
    };
    let told = |of: &Option<naga::Binding>| {
        let Some(naga::Binding::BuiltIn(built_in)) = of else { return false };
        matches!(built_in, NumSubgroups | SubgroupId | SubgroupInvocationId | SubgroupSize)
    };
    module.functions.iter().any(|(_, f)| sees(f))
        || module
            .entry_points
            .iter()
            .any(|e| sees(&e.function) || e.function.arguments.iter().any(|a| told(&a.binding)))
}

/// True when invocations wait for each other or share variables.
fn needs_others(module: &Module) -> bool {
    let shared = module.global_variables.iter().any(|(_, v)| v.space == AddressSpace::WorkGroup);
    let waits = |f: &Function| any(&f.body, &|s| matches!(s, Statement::ControlBarrier(_)));
    shared
        || uses_subgroups(module)
        || module.functions.iter().any(|(_, f)| waits(f))
        || module.entry_points.iter().any(|e| waits(&e.function))
}

fn any(block: &Block, is: &dyn Fn(&Statement) -> bool) -> bool {
    block.iter().any(|statement| {
        is(statement)
            || match statement {
                Statement::Block(inner) => any(inner, is),
                Statement::If { accept, reject, .. } => any(accept, is) || any(reject, is),
                Statement::Loop { body, continuing, .. } => any(body, is) || any(continuing, is),
                Statement::Switch { cases, .. } => cases.iter().any(|c| any(&c.body, is)),
                _ => false,
            }
    })
}

/// The type without atomic numbers and without open ends.
pub(super) fn plain(module: &mut Module, ty: Handle<Type>) -> Handle<Type> {
    let old = module.types[ty].clone();
    let (name, inner) = match old.inner {
        TypeInner::Atomic(scalar) => (None, TypeInner::Scalar(scalar)),
        TypeInner::Array { base, size, stride } => {
            let size = match size {
                naga::ArraySize::Dynamic => {
                    naga::ArraySize::Constant(std::num::NonZeroU32::MIN.saturating_add(LENGTH - 1))
                }
                other => other,
            };
            (old.name, TypeInner::Array { base: plain(module, base), size, stride })
        }
        TypeInner::Struct { members, span } => {
            let mut end = span;
            let mut changed = Vec::new();
            for member in &members {
                let ty = plain(module, member.ty);
                end = end.max(member.offset + module.types[ty].inner.size(module.to_ctx()));
                changed.push(StructMember { ty, ..member.clone() });
            }
            // Values of the type keep it.
            if changed.iter().zip(&members).all(|(new, old)| new.ty == old.ty) {
                return ty;
            }
            (old.name, TypeInner::Struct { members: changed, span: end.next_multiple_of(16) })
        }
        _ => return ty,
    };
    module.types.insert(Type { name, inner }, Span::UNDEFINED)
}

/// The type of a part.
pub(super) fn inside(module: &mut Module, ty: Handle<Type>, index: u32) -> Handle<Type> {
    let inner = match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => return members.get(index as usize).map_or(ty, |m| m.ty),
        TypeInner::Array { base, .. } => return *base,
        TypeInner::Matrix { rows, scalar, .. } => TypeInner::Vector { size: *rows, scalar: *scalar },
        TypeInner::Vector { scalar, .. } => TypeInner::Scalar(*scalar),
        _ => return ty,
    };
    module.types.insert(Type { name: None, inner }, Span::UNDEFINED)
}

/// Copies a variable wherever the function ends.
fn copy_at_end(function: &mut Function, from: Handle<GlobalVariable>, to: Handle<GlobalVariable>) {
    let source = function.expressions.append(Expression::GlobalVariable(from), Span::UNDEFINED);
    let target = function.expressions.append(Expression::GlobalVariable(to), Span::UNDEFINED);
    let Function { body, expressions, .. } = function;
    let mut copy = || {
        let value = expressions.append(Expression::Load { pointer: source }, Span::UNDEFINED);
        let mut block = Block::new();
        block.push(Statement::Emit(Range::new_from_bounds(value, value)), Span::UNDEFINED);
        block.push(Statement::Store { pointer: target, value }, Span::UNDEFINED);
        block
    };
    before_returns(body, &mut copy);
    if !matches!(body.last(), Some(Statement::Return { .. })) {
        let at = body.len();
        body.splice(at..at, copy());
    }
}

/// Puts statements in front of each `return`.
fn before_returns(block: &mut Block, made: &mut dyn FnMut() -> Block) {
    for statement in block.iter_mut() {
        match statement {
            Statement::Block(inner) => before_returns(inner, made),
            Statement::If { accept, reject, .. } => {
                before_returns(accept, made);
                before_returns(reject, made);
            }
            Statement::Switch { cases, .. } => cases.iter_mut().for_each(|case| before_returns(&mut case.body, made)),
            Statement::Loop { body, .. } => before_returns(body, made),
            _ => {}
        }
    }
    let ends = matches!(block.last(), Some(Statement::Return { .. }));
    if ends {
        let at = block.len() - 1;
        block.splice(at..at, made());
    }
}

/// Lengths become numbers, and atomic functions ordinary ones: nobody else is there.
fn rewrite(function: &mut Function) -> Result<(), ProgramError> {
    let lengths: Vec<Handle<Expression>> = function
        .expressions
        .iter()
        .filter(|(_, e)| matches!(e, Expression::ArrayLength(_)))
        .map(|(handle, _)| handle)
        .collect();
    for &handle in &lengths {
        function.expressions[handle] = Expression::Literal(Literal::U32(LENGTH));
    }
    if !lengths.is_empty() {
        not_emitted(&mut function.body, &lengths);
    }
    without_atomics(function)
}

/// Takes expressions out of what statements evaluate: a number is there without that.
fn not_emitted(block: &mut Block, all: &[Handle<Expression>]) {
    let mut changed = Block::new();
    for (statement, span) in std::mem::take(block).span_into_iter() {
        match statement {
            Statement::Emit(range) => {
                let handles: Vec<Handle<Expression>> = range.collect();
                for run in handles.split(|handle| all.contains(handle)) {
                    if let (Some(&first), Some(&last)) = (run.first(), run.last()) {
                        changed.push(Statement::Emit(Range::new_from_bounds(first, last)), span);
                    }
                }
            }
            mut other => {
                blocks_mut(&mut other).into_iter().for_each(|inner| not_emitted(inner, all));
                changed.push(other, span);
            }
        }
    }
    *block = changed;
}

/// Atomic functions become ordinary ones.
pub(super) fn without_atomics(function: &mut Function) -> Result<(), ProgramError> {
    let mut body = std::mem::take(&mut function.body);
    block(&mut body, function)?;
    function.body = body;
    Ok(())
}

fn block(all: &mut Block, function: &mut Function) -> Result<(), ProgramError> {
    let mut changed = Block::new();
    for (statement, span) in std::mem::take(all).span_into_iter() {
        match statement {
            Statement::MemoryBarrier(_) => {}
            Statement::Atomic { pointer, fun, value, result } => {
                single(&mut changed, function, (pointer, fun, value, result), span)?;
            }
            mut other => {
                for inner in blocks_mut(&mut other) {
                    block(inner, function)?;
                }
                changed.push(other, span);
            }
        }
    }
    *all = changed;
    Ok(())
}

type Atomic = (Handle<Expression>, AtomicFunction, Handle<Expression>, Option<Handle<Expression>>);

/// Reads, computes and writes.
fn single(block: &mut Block, function: &mut Function, atomic: Atomic, span: Span) -> Result<(), ProgramError> {
    let (pointer, fun, value, result) = atomic;
    let Some(before) = result else {
        return Err(ProgramError::internal("an atomic function without its value".to_owned()));
    };
    let compared = matches!(function.expressions[before], Expression::AtomicResult { comparison: true, .. });
    if compared {
        // The value before is the first member of the result, and the only one that is looked at.
        let members: Vec<Handle<Expression>> = function
            .expressions
            .iter()
            .filter(|(_, e)| matches!(e, Expression::AccessIndex { base, .. } if *base == before))
            .map(|(handle, _)| handle)
            .collect();
        for handle in members {
            // `x & x` is `x`, of either sign.
            function.expressions[handle] = Expression::Binary { op: B::And, left: before, right: before };
        }
    }
    function.expressions[before] = Expression::Load { pointer };
    block.push(Statement::Emit(Range::new_from_bounds(before, before)), span);
    let mut add = |e: Expression| {
        let handle = function.expressions.append(e, span);
        block.push(Statement::Emit(Range::new_from_bounds(handle, handle)), span);
        handle
    };
    let math = |fun| Expression::Math { fun, arg: before, arg1: Some(value), arg2: None, arg3: None };
    let binary = |op| Expression::Binary { op, left: before, right: value };
    let after = match fun {
        AtomicFunction::Add => add(binary(B::Add)),
        AtomicFunction::Subtract => add(binary(B::Subtract)),
        AtomicFunction::And => add(binary(B::And)),
        AtomicFunction::ExclusiveOr => add(binary(B::ExclusiveOr)),
        AtomicFunction::InclusiveOr => add(binary(B::InclusiveOr)),
        AtomicFunction::Min => add(math(MathFunction::Min)),
        AtomicFunction::Max => add(math(MathFunction::Max)),
        AtomicFunction::Exchange { compare: None } => value,
        AtomicFunction::Exchange { compare: Some(compare) } => {
            let condition = add(Expression::Binary { op: B::Equal, left: before, right: compare });
            add(Expression::Select { condition, accept: value, reject: before })
        }
    };
    block.push(Statement::Store { pointer, value: after }, span);
    Ok(())
}
