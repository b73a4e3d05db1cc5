//! `out` arguments that are one variable: the order in which they are copied back is undefined (GLSL 4.60, 6.1.1).

use std::rc::Rc;

use naga::{Expression, Function, Handle, Module, Statement};

use super::super::code::{Inst, Reg, Register};
use super::{Compiler, Evaluated, Frame, Pointer, types};
use crate::fuel::blocks;

/// Scalars of a variable that a call writes.
struct OutTarget {
    /// Which argument.
    argument: usize,
    to: Pointer,
    len: usize,
}

/// When two targets are one place.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Meeting {
    Always,
    /// Where two indices are equal.
    Equal([Reg; 2]),
    Never,
}

impl<'m> Compiler<'m> {
    /// Notes behind a call that the values of `out` arguments are undefined where two of them are one place. `rest` is
    /// what stands behind the call: it begins with the copies of arguments that are not passed as they are.
    pub(super) fn note_overlaps(
        &mut self,
        frame: &mut Frame<'m>,
        function: &Function,
        arguments: &[Handle<Expression>],
        values: &[Evaluated],
        rest: &'m [Statement],
        span: naga::Span,
    ) {
        let passed: Vec<usize> = (0..values.len()).filter(|&k| matches!(values[k], Evaluated::Pointer(_))).collect();
        if passed.len() < 2 {
            return;
        }
        // Who reads through both finds the same in both.
        if !passed.iter().any(|&k| writes(self.module, function, k)) {
            return;
        }
        let mut targets = Vec::new();
        for k in passed {
            targets.extend(self.targets(frame, k, arguments[k], &values[k], rest));
        }
        for (k, one) in targets.iter().enumerate() {
            for other in targets[k + 1..].iter().filter(|other| other.argument != one.argument) {
                let equal = match meeting(one, other) {
                    Meeting::Never => continue,
                    Meeting::Always => None,
                    Meeting::Equal(indices) => Some(indices),
                };
                let site = self.statement_site(frame, span);
                for argument in [one.argument, other.argument] {
                    for register in self.passed_registers(frame, arguments[argument], &values[argument]) {
                        self.push(Inst::Overlap { of: register, equal, site });
                    }
                }
            }
        }
    }

    /// What an argument writes: its own variable, or those that it is copied back to.
    fn targets(
        &mut self,
        frame: &mut Frame<'m>,
        argument: usize,
        handle: Handle<Expression>,
        value: &Evaluated,
        rest: &'m [Statement],
    ) -> Vec<OutTarget> {
        let mut all = Vec::new();
        for statement in rest {
            match statement {
                Statement::Emit(_) => {}
                Statement::Store { pointer, value } if loads(frame, *value, handle) => {
                    let expressions = &frame.function.expressions;
                    let whole = matches!(
                        expressions[*pointer],
                        Expression::GlobalVariable(_) | Expression::LocalVariable(_) | Expression::FunctionArgument(_)
                    );
                    // The place of a part is known already: it was looked up before the call.
                    let known = whole || frame.values.contains_key(pointer);
                    if let Some(Evaluated::Pointer(to)) = known.then(|| self.value(frame, *pointer).ok()).flatten() {
                        all.push(OutTarget { argument, to, len: self.pointed(frame, *pointer) });
                    }
                }
                Statement::Store { .. } => {}
                _ => break,
            }
        }
        match value {
            Evaluated::Pointer(to) if all.is_empty() => {
                vec![OutTarget { argument, to: to.clone(), len: self.pointed(frame, handle) }]
            }
            Evaluated::Pointer(_) | Evaluated::Registers(_) | Evaluated::Image(_) => all,
        }
    }

    /// The scalars that the function itself writes.
    fn passed_registers(&self, frame: &Frame<'m>, handle: Handle<Expression>, value: &Evaluated) -> Vec<Register> {
        let Evaluated::Pointer(pointer) = value else { return Vec::new() };
        let registers = pointer.variable.get(pointer.offset..pointer.offset + self.pointed(frame, handle));
        registers.filter(|_| pointer.indices.is_empty()).map(<[Register]>::to_vec).unwrap_or_default()
    }

    /// Scalars that a pointer leads to.
    fn pointed(&self, frame: &Frame<'m>, pointer: Handle<Expression>) -> usize {
        types::count(self.module, &self.pointee(frame, pointer)).unwrap_or_default()
    }
}

/// True for a value that is made of what a pointer leads to, and of nothing else.
fn loads(frame: &Frame<'_>, value: Handle<Expression>, from: Handle<Expression>) -> bool {
    let expressions = &frame.function.expressions;
    let same = |pointer: Handle<Expression>| {
        pointer == from
            || matches!((&expressions[pointer], &expressions[from]),
                (Expression::LocalVariable(a), Expression::LocalVariable(b)) if a == b)
    };
    match expressions[value] {
        Expression::Load { pointer } => same(pointer) || part_of(frame, pointer).is_some_and(same),
        Expression::AccessIndex { base, .. }
        | Expression::Swizzle { vector: base, .. }
        | Expression::As { expr: base, .. } => loads(frame, base, from),
        _ => false,
    }
}

/// True where a function, or one that it calls, writes through its argument number `argument`.
fn writes(module: &Module, function: &Function, argument: usize) -> bool {
    let root = |mut pointer: Handle<Expression>| loop {
        match function.expressions[pointer] {
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => pointer = base,
            Expression::FunctionArgument(k) => break Some(k as usize),
            _ => break None,
        }
    };
    let is_own = |pointer: Handle<Expression>| root(pointer) == Some(argument);
    let is_write = |statement: &Statement| match statement {
        Statement::Store { pointer, .. } | Statement::Atomic { pointer, .. } => is_own(*pointer),
        Statement::Call { function, arguments, .. } => {
            let callee = &module.functions[*function];
            arguments.iter().enumerate().any(|(k, passed)| is_own(*passed) && writes(module, callee, k))
        }
        _ => false,
    };
    let mut open = vec![&function.body];
    while let Some(block) = open.pop() {
        if block.iter().any(is_write) {
            return true;
        }
        open.extend(block.iter().flat_map(blocks));
    }
    false
}

/// What a pointer to a part is made from.
fn part_of(frame: &Frame<'_>, pointer: Handle<Expression>) -> Option<Handle<Expression>> {
    match frame.function.expressions[pointer] {
        Expression::AccessIndex { base, .. } => Some(part_of(frame, base).unwrap_or(base)),
        _ => None,
    }
}

fn meeting(a: &OutTarget, b: &OutTarget) -> Meeting {
    // Places in shared memory are told apart while they are written.
    if a.to.memory.is_some() || b.to.memory.is_some() {
        return Meeting::Never;
    }
    if !Rc::ptr_eq(&a.to.variable, &b.to.variable) && a.to.variable.first() != b.to.variable.first() {
        return Meeting::Never;
    }
    let range = |t: &OutTarget| t.to.offset..t.to.offset + t.len;
    let meet = |a: std::ops::Range<usize>, b: std::ops::Range<usize>| a.start < b.end && b.start < a.end;
    match (&a.to.indices[..], &b.to.indices[..]) {
        ([], []) if meet(range(a), range(b)) => Meeting::Always,
        ([i], [j]) if i.stride == j.stride && meet(range(a), range(b)) => Meeting::Equal([i.reg, j.reg]),
        // Whatever the index, the element is a part of the other.
        ([], [j]) if a.to.offset <= b.to.offset && range(a).end >= b.to.offset + j.stride * j.len => Meeting::Always,
        ([i], []) if b.to.offset <= a.to.offset && range(b).end >= a.to.offset + i.stride * i.len => Meeting::Always,
        _ => Meeting::Never,
    }
}
