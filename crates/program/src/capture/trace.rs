//! The trace of a probed program, written straight to the output buffer: a private array of that size
//! takes the compiler of a driver about a hundred times as long.

use naga::{
    AddressSpace, BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal, Module, Range,
    ScalarKind, Span, Statement,
};

use super::builder::{Builder, add_global};
use super::compute::Harness;
use crate::fuel::blocks_mut;
use crate::probe::TRACE;
use crate::{Port, PortAt, Program};

/// Where the record of the invocation starts, in a private variable.
pub(super) struct Direct {
    record: Handle<GlobalVariable>,
}

/// Stores to the variable that go to the buffer.
struct Redirect {
    trace: Handle<GlobalVariable>,
    outputs: Handle<GlobalVariable>,
    record: Handle<GlobalVariable>,
    /// Words of the record before the trace.
    before: u32,
}

impl Direct {
    /// Redirects the trace of a program that has one.
    pub(super) fn insert(program: &Program, module: &mut Module, harness: &Harness) -> Option<Self> {
        let index = program.outputs.iter().position(Self::writes)?;
        let PortAt::Global(trace) = program.outputs[index].at else { return None };
        let words: usize = program.outputs[..index].iter().map(|port| port.field.shape.words()).sum();
        let record = add_global(module, "sc_start", AddressSpace::Private, None, harness.types.u32);
        let before = (program.output_layout().header_words() + words) as u32;
        let redirect = Redirect { trace, outputs: harness.outputs, record, before };
        for (_, function) in module.functions.iter_mut() {
            let body = std::mem::take(&mut function.body);
            function.body = redirect.block(body, function);
        }
        Some(Self { record })
    }

    /// True for an output that is written while the program runs, and not behind it.
    pub(super) fn writes(port: &Port) -> bool {
        port.field.name == TRACE
    }

    /// Sets the start of the record.
    pub(super) fn begin(&self, b: &mut Builder, record: Handle<Expression>) {
        let pointer = b.global(self.record);
        b.store(pointer, record);
    }
}

impl Redirect {
    fn block(&self, block: Block, function: &mut Function) -> Block {
        let mut body = Block::new();
        for (mut statement, span) in block.span_into_iter() {
            for inner in blocks_mut(&mut statement) {
                *inner = self.block(std::mem::take(inner), function);
            }
            match statement {
                Statement::Store { pointer, value } if self.index(function, pointer).is_some() => {
                    if let Some(index) = self.index(function, pointer) {
                        self.store(function, &mut body, index, value);
                    }
                }
                // Pointers into the variable are of no use any more.
                Statement::Emit(range) if range.clone().all(|e| self.index(function, e).is_some()) => {}
                other => body.push(other, span),
            }
        }
        body
    }

    /// The index of an element of the variable.
    fn index(&self, function: &Function, pointer: Handle<Expression>) -> Option<Handle<Expression>> {
        let Expression::Access { base, index } = function.expressions[pointer] else { return None };
        matches!(function.expressions[base], Expression::GlobalVariable(global) if global == self.trace)
            .then_some(index)
    }

    fn store(&self, function: &mut Function, body: &mut Block, index: Handle<Expression>, value: Handle<Expression>) {
        let add = |left, right| Expression::Binary { op: BinaryOperator::Add, left, right };
        let pointer = function.expressions.append(Expression::GlobalVariable(self.record), Span::UNDEFINED);
        let before = function.expressions.append(Expression::Literal(Literal::U32(self.before)), Span::UNDEFINED);
        let outputs = function.expressions.append(Expression::GlobalVariable(self.outputs), Span::UNDEFINED);
        let mut compute = |expression| {
            let handle = function.expressions.append(expression, Span::UNDEFINED);
            body.push(Statement::Emit(Range::new_from_bounds(handle, handle)), Span::UNDEFINED);
            handle
        };
        let word = compute(Expression::As { expr: value, kind: ScalarKind::Uint, convert: None });
        let record = compute(Expression::Load { pointer });
        let start = compute(add(record, before));
        let at = compute(add(start, index));
        let pointer = compute(Expression::Access { base: outputs, index: at });
        body.push(Statement::Store { pointer, value: word }, Span::UNDEFINED);
    }
}
