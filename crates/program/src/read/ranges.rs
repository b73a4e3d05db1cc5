//! How large a number of the draw may be: an array that it indexes has an element for it.

use naga::valid::FunctionInfo;
use naga::{BinaryOperator as B, Expression as E, Function, FunctionArgument, Handle, Literal, Module, TypeInner};

/// A value that an expression depends on: an argument of a function, or a member of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Argument(u32),
    Member(u32, u32),
}

/// Where each flat argument of an entry point lies among those of its own function.
pub(super) fn numbers(module: &Module, arguments: &[FunctionArgument]) -> Vec<Option<Number>> {
    let mut all = Vec::new();
    for (k, argument) in (0_u32..).zip(arguments) {
        match &module.types[argument.ty].inner {
            TypeInner::Struct { members, .. } => {
                all.extend((0_u32..).zip(members).map(|(m, _)| Some(Number::Member(k, m))));
            }
            _ => all.push(Some(Number::Argument(k))),
        }
    }
    all
}

/// The largest number up to `most` that is no index outside of an array of the function.
pub(super) fn reach(module: &Module, function: &Function, info: &FunctionInfo, number: Number, most: u32) -> u32 {
    let mut reach = most;
    for (_, expression) in function.expressions.iter() {
        let E::Access { base, index } = *expression else { continue };
        let Some(length) = length(module, info, base) else { continue };
        let of = |n: u32| value(function, index, (number, n));
        let inside = |n: u32| of(n).is_some_and(|i| (0..i64::from(length)).contains(&i));
        reach = match of(0) {
            // What else the index comes from is not known here.
            None => reach.min(length.saturating_sub(1)),
            Some(_) => (0..=reach).take_while(|&n| inside(n)).last().unwrap_or(0),
        };
    }
    reach
}

/// Elements of what is indexed.
fn length(module: &Module, info: &FunctionInfo, base: Handle<E>) -> Option<u32> {
    let inner = info[base].ty.inner_with(&module.types);
    let inner = match inner {
        TypeInner::Pointer { base, .. } => &module.types[*base].inner,
        other => other,
    };
    match inner {
        TypeInner::Array { size: naga::ArraySize::Constant(n), .. } => Some(n.get()),
        TypeInner::Vector { size, .. } | TypeInner::ValuePointer { size: Some(size), .. } => Some(*size as u32),
        TypeInner::Matrix { columns, .. } => Some(*columns as u32),
        _ => None,
    }
}

/// A whole number that depends on nothing but one number of the draw.
fn value(function: &Function, expression: Handle<E>, number: (Number, u32)) -> Option<i64> {
    let of = |expression| value(function, expression, number);
    match function.expressions[expression] {
        E::Literal(Literal::I32(v)) => Some(i64::from(v)),
        E::Literal(Literal::U32(v)) => Some(i64::from(v)),
        E::FunctionArgument(k) => (number.0 == Number::Argument(k)).then_some(i64::from(number.1)),
        E::AccessIndex { base, index } => match function.expressions[base] {
            E::FunctionArgument(k) if number.0 == Number::Member(k, index) => Some(i64::from(number.1)),
            _ => None,
        },
        // A number that becomes binary32 on the way is not followed.
        E::As { expr, kind: naga::ScalarKind::Sint | naga::ScalarKind::Uint, convert: Some(4) } => of(expr),
        E::Binary { op, left, right } => binary(op, of(left)?, of(right)?),
        _ => None,
    }
}

fn binary(op: B, a: i64, b: i64) -> Option<i64> {
    let bits = |n: i64| u32::try_from(n).ok().filter(|n| *n < 32);
    match op {
        B::Add => a.checked_add(b),
        B::Subtract => a.checked_sub(b),
        B::Multiply => a.checked_mul(b),
        B::Divide => a.checked_div(b),
        B::Modulo => a.checked_rem(b),
        B::ShiftLeft => a.checked_shl(bits(b)?),
        B::ShiftRight => a.checked_shr(bits(b)?),
        B::And => Some(a & b),
        B::InclusiveOr => Some(a | b),
        B::ExclusiveOr => Some(a ^ b),
        _ => None,
    }
}
