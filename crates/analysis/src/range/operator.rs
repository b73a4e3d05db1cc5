//! Infix and prefix operators on values.

use syntax::ast::BinaryOp;
use syntax::types::{ScalarType, Type};

use super::transfer as t;
use super::value::{Evidence, Range, Value};

/// `a op b` for numbers; `same` when both are one expression.
pub fn binary(op: BinaryOp, a: &Value, b: &Value, ty: &Type, same: bool) -> Value {
    let n = match ty {
        Type::Scalar(_) => 1,
        Type::Vector(_, n) => usize::from(*n),
        Type::Matrix(..) | Type::Error | Type::Void | Type::Opaque(_) | Type::Struct(_) | Type::Array(..) => 0,
    };
    let sources = a.sources().and(b.sources());
    if n == 0 {
        return Value { made_from: a.made_from | b.made_from, ..Value::opaque(sources) };
    }
    let scalar = ty.scalar().unwrap_or(ScalarType::Float);
    let one = |i: usize| match (a.part(i), b.part(i)) {
        (Some(x), Some(y)) => fit(component(op, x, y, scalar, same), scalar),
        // A matrix is on one side.
        (None, _) | (_, None) => Range::unknown(sources),
    };
    let mut result = Value::new((0..n).map(one).collect());
    result.made_from = a.made_from | b.made_from;
    result
}

fn component(op: BinaryOp, a: Range, b: Range, scalar: ScalarType, same: bool) -> Range {
    let sources = a.sources.and(b.sources);
    let integer = scalar.is_integer();
    match op {
        BinaryOp::Add if same => t::mul(a, Range::exactly(2.0)),
        BinaryOp::Add => t::add(a, b),
        // The same number less itself is 0, unless it is infinite.
        BinaryOp::Sub if same => {
            let mut zero = Range { sources, ..Range::exactly(0.0) };
            zero.nan = !integer && (a.nan || !a.is_finite());
            zero
        }
        BinaryOp::Sub => t::sub(a, b),
        BinaryOp::Mul if same => t::square(a),
        BinaryOp::Mul => t::mul(a, b),
        BinaryOp::Div if integer && b.excludes_zero() && (b.lo > 0.0 || b.hi < 0.0) => {
            t::stepped(t::div(a, b), f64::trunc)
        }
        BinaryOp::Div if integer => Range::unknown(sources),
        BinaryOp::Div => t::div(a, b),
        BinaryOp::Rem => remainder(a, b),
        BinaryOp::BitAnd if a.lo >= 0.0 && b.lo >= 0.0 => Range::of(0.0, a.hi.min(b.hi), Evidence::Bound, sources),
        BinaryOp::Shr if a.lo >= 0.0 => Range::of(0.0, a.hi, Evidence::Bound, sources),
        BinaryOp::BitAnd | BinaryOp::BitOr | BinaryOp::BitXor | BinaryOp::Shl | BinaryOp::Shr => {
            Range::unknown(sources)
        }
        BinaryOp::Less
        | BinaryOp::Greater
        | BinaryOp::LessEqual
        | BinaryOp::GreaterEqual
        | BinaryOp::Equal
        | BinaryOp::NotEqual => compare(op, a, b),
        BinaryOp::And | BinaryOp::Xor | BinaryOp::Or => logic(op, a, b),
    }
}

fn remainder(a: Range, b: Range) -> Range {
    let sources = a.sources.and(b.sources);
    // With a negative operand the result is undefined.
    if a.lo < 0.0 || b.lo <= 0.0 {
        return Range::unknown(sources);
    }
    let hi = if a.hi < b.lo { a.hi } else { b.hi - 1.0 };
    let mut r = Range::of(0.0, hi, Evidence::Bound, sources);
    // A count that begins at 0 comes by.
    if a.lo == 0.0 {
        r.lo_by = a.lo_by;
    }
    r
}

fn compare(op: BinaryOp, a: Range, b: Range) -> Range {
    let sources = a.sources.and(b.sources);
    let (always, never) = match op {
        BinaryOp::Less => (a.hi < b.lo, a.lo >= b.hi),
        BinaryOp::LessEqual => (a.hi <= b.lo, a.lo > b.hi),
        BinaryOp::Greater => (a.lo > b.hi, a.hi <= b.lo),
        BinaryOp::GreaterEqual => (a.lo >= b.hi, a.hi < b.lo),
        BinaryOp::Equal => (a.single().is_some() && a.single() == b.single(), a.hi < b.lo || b.hi < a.lo),
        _ => (a.hi < b.lo || b.hi < a.lo, a.single().is_some() && a.single() == b.single()),
    };
    match (always, never) {
        (true, false) if !a.nan && !b.nan => Range { sources, ..Range::exactly(1.0) },
        (false, true) if !a.nan && !b.nan => Range { sources, ..Range::exactly(0.0) },
        _ => Range::truth(sources),
    }
}

fn logic(op: BinaryOp, a: Range, b: Range) -> Range {
    let sources = a.sources.and(b.sources);
    let value = match (op, a.single(), b.single()) {
        (BinaryOp::And, Some(0.0), _) | (BinaryOp::And, _, Some(0.0)) => Some(0.0),
        (BinaryOp::Or, Some(1.0), _) | (BinaryOp::Or, _, Some(1.0)) => Some(1.0),
        (BinaryOp::And, Some(1.0), Some(1.0)) => Some(1.0),
        (BinaryOp::Or, Some(0.0), Some(0.0)) => Some(0.0),
        (BinaryOp::Xor, Some(x), Some(y)) => Some(if x == y { 0.0 } else { 1.0 }),
        _ => None,
    };
    value.map_or_else(|| Range::truth(sources), |v| Range { sources, ..Range::exactly(v) })
}

/// An integer that leaves its type wraps round.
pub fn fit(r: Range, scalar: ScalarType) -> Range {
    let inside = match scalar {
        ScalarType::Int => !r.is_finite() || (r.lo >= f64::from(i32::MIN) && r.hi <= f64::from(i32::MAX)),
        ScalarType::Uint => r.lo >= 0.0 && (r.hi.is_infinite() || r.hi <= f64::from(u32::MAX)),
        ScalarType::Bool | ScalarType::Half | ScalarType::Float | ScalarType::Double => return r,
        small if small.is_small_integer() => {
            let most = f64::from(1u32 << small.bits());
            let (low, high) = if small.is_signed() { (-most / 2.0, most / 2.0 - 1.0) } else { (0.0, most - 1.0) };
            r.lo >= low && r.hi <= high
        }
        _ => return Range { nan: false, ..Range::unknown(r.sources) },
    };
    let mut fitted = if inside { r } else { Range::unknown(r.sources) };
    if scalar.is_unsigned() {
        fitted.lo = fitted.lo.max(0.0);
    }
    fitted.nan = false;
    fitted
}

/// A number as another scalar type, as constructors convert it.
pub fn convert(r: Range, from: ScalarType, to: ScalarType) -> Range {
    match to {
        ScalarType::Bool if r.excludes_zero() && !r.nan => Range { sources: r.sources, ..Range::exactly(1.0) },
        ScalarType::Bool if r.single() == Some(0.0) => Range { sources: r.sources, ..Range::exactly(0.0) },
        ScalarType::Bool => Range::truth(r.sources),
        // What is infinite there need not be here.
        ScalarType::Half if from != ScalarType::Half => Range::unknown(r.sources),
        ScalarType::Half | ScalarType::Float | ScalarType::Double => r,
        _ if from.is_floating() => fit(t::stepped(r, f64::trunc), to),
        _ => fit(r, to),
    }
}
