//! Values of constant expressions of any type (GLSL 4.60, 4.3.3), one operation at a time.

use super::ast::{BinaryOp, UnaryOp};
use super::builtin::BuiltinFunction as F;
use super::swizzle;
use super::types::{ArraySize, ScalarType, Type};

/// A value taken apart: components in order, columns of a matrix and members of a structure behind each
/// other. Integers and `bool` are exact; `float` is as exact as binary64, until it is [`rounded`].
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Type of the whole.
    pub ty: Type,
    /// Its scalars in order.
    pub parts: Vec<f64>,
}

/// Number of components, those of all elements of an array and all members of a structure.
fn components(ty: &Type) -> Option<usize> {
    match ty {
        Type::Array(element, ArraySize::Known(n)) => Some(components(element)? * *n as usize),
        Type::Struct(s) => s.fields.iter().map(|field| components(&field.ty)).sum(),
        _ => ty.components(),
    }
}

/// A value as another type: what an initialiser makes of it. `None` where nothing converts.
pub fn converted(value: Known, ty: &Type) -> Option<Known> {
    match (value.ty.scalar(), ty.scalar()) {
        (Some(_), Some(to)) if to.is_sized() => None,
        (Some(from), Some(to)) => {
            let parts = value.parts.iter().map(|&v| number(v, from, to)).collect();
            Some(Known { ty: value.ty.with_scalar(to), parts })
        }
        _ => Some(value),
    }
}

/// One number as another type.
fn number(value: f64, from: ScalarType, to: ScalarType) -> f64 {
    match to {
        _ if from == to => value,
        ScalarType::Bool => f64::from(u8::from(value != 0.0)),
        ScalarType::Int if value >= 2_147_483_648.0 => value - 4_294_967_296.0,
        ScalarType::Uint if value < 0.0 && from == ScalarType::Int => value + 4_294_967_296.0,
        ScalarType::Int | ScalarType::Uint => value.trunc(),
        ScalarType::Float | ScalarType::Double => value,
        // Nothing makes a value of these: see `constructed` and `converted`.
        _ => value,
    }
}

/// `op value`.
pub fn unary(op: UnaryOp, value: Known) -> Option<Known> {
    let each = |f: fn(f64) -> f64| value.parts.iter().map(|&v| f(v)).collect();
    let parts = match op {
        UnaryOp::Plus => value.parts.clone(),
        UnaryOp::Minus => each(|v| -v),
        UnaryOp::Not => each(|v| f64::from(u8::from(v == 0.0))),
        UnaryOp::Complement | UnaryOp::Increment | UnaryOp::Decrement => return None,
    };
    Some(Known { ty: value.ty, parts })
}

/// `value[k]`.
pub fn element(value: &Known, k: usize) -> Option<Known> {
    let ty = value.ty.indexed()?;
    let n = components(&ty)?;
    Some(Known { ty, parts: value.parts.get(k * n..(k + 1) * n)?.to_vec() })
}

/// `value.field`: a member or components.
pub fn field(value: &Known, name: &str) -> Option<Known> {
    if let Type::Struct(s) = &value.ty {
        let k = s.fields.iter().position(|field| field.name == name)?;
        let before = s.fields[..k].iter().map(|field| components(&field.ty)).sum::<Option<usize>>()?;
        let ty = s.fields[k].ty.clone();
        let parts = value.parts.get(before..before + components(&ty)?)?.to_vec();
        return Some(Known { ty, parts });
    }
    let picked: Option<Vec<usize>> = name.chars().map(swizzle::component).collect();
    let picked = picked?;
    let parts: Option<Vec<f64>> = picked.iter().map(|&k| value.parts.get(k).copied()).collect();
    Some(Known { ty: Type::vector(value.ty.scalar()?, u8::try_from(picked.len()).ok()?), parts: parts? })
}

/// One side of `?:`, as the type that both sides have.
pub(crate) fn chosen(condition: &Known, yes: &Known, no: &Known) -> Option<Known> {
    let side = if condition.parts == [0.0] { no } else { yes };
    match (yes.ty.scalar(), no.ty.scalar()) {
        (Some(a), Some(b)) => Some(with(side.clone(), a.max(b))),
        _ => Some(side.clone()),
    }
}

/// A value with its components in binary32, where they are `float`.
#[expect(clippy::cast_possible_truncation, reason = "rounding is what is wanted")]
pub fn rounded(value: Known) -> Known {
    if value.ty.scalar() != Some(ScalarType::Float) {
        return value;
    }
    Known { parts: value.parts.into_iter().map(|v| f64::from(v as f32)).collect(), ..value }
}

/// What a constructor makes of its arguments.
pub fn constructed(ty: &Type, values: &[Known]) -> Option<Known> {
    if let Type::Struct(s) = ty {
        let mut parts = Vec::new();
        for (value, field) in values.iter().zip(&s.fields) {
            parts.extend(converted(value.clone(), &field.ty)?.parts);
        }
        return (values.len() == s.fields.len()).then(|| Known { ty: ty.clone(), parts });
    }
    if let Type::Array(element, _) = ty {
        let mut parts = Vec::new();
        for value in values {
            parts.extend(converted(value.clone(), element)?.parts);
        }
        return Some(Known { ty: element.as_ref().clone().array(u32::try_from(values.len()).ok()?), parts });
    }
    // Numbers of other sizes are computed when the shader runs.
    let to = ty.scalar().filter(|to| !to.is_sized())?;
    let n = ty.components()?;
    let mut parts = Vec::new();
    for value in values {
        let from = value.ty.scalar()?;
        parts.extend(value.parts.iter().map(|&v| number(v, from, to)));
    }
    if let ([only], Type::Matrix(_, columns, rows)) = (values, ty) {
        let at = |c: u8, r: u8| match only.ty {
            Type::Matrix(_, cs, rs) if c < cs && r < rs => parts[usize::from(c) * usize::from(rs) + usize::from(r)],
            Type::Scalar(_) if c == r => parts[0],
            Type::Matrix(..) if c == r => 1.0,
            _ => 0.0,
        };
        let all = (0..*columns).flat_map(|c| (0..*rows).map(move |r| (c, r))).map(|(c, r)| at(c, r)).collect();
        return Some(Known { ty: ty.clone(), parts: all });
    }
    if parts.len() == 1 {
        parts = vec![parts[0]; n];
    }
    parts.truncate(n);
    (parts.len() == n).then(|| Known { ty: ty.clone(), parts })
}

/// `left op right`.
pub fn binary(op: BinaryOp, left: Known, right: Known) -> Option<Known> {
    use BinaryOp as B;
    let truth = |v: bool| Some(Known { ty: Type::BOOL, parts: vec![f64::from(u8::from(v))] });
    match op {
        B::And => return truth(left.parts == [1.0] && right.parts == [1.0]),
        B::Or => return truth(left.parts == [1.0] || right.parts == [1.0]),
        B::Xor => return truth(left.parts != right.parts),
        _ => {}
    }
    if let (Type::Array(..), Type::Array(..)) = (&left.ty, &right.ty) {
        return match op {
            B::Equal => truth(left.parts == right.parts),
            B::NotEqual => truth(left.parts != right.parts),
            _ => None,
        };
    }
    let to = left.ty.scalar()?.max(right.ty.scalar()?);
    let (a, b) = (with(left, to), with(right, to));
    match op {
        B::Equal => return truth(a.parts == b.parts),
        B::NotEqual => return truth(a.parts != b.parts),
        B::Less => return truth(a.parts[0] < b.parts[0]),
        B::Greater => return truth(a.parts[0] > b.parts[0]),
        B::LessEqual => return truth(a.parts[0] <= b.parts[0]),
        B::GreaterEqual => return truth(a.parts[0] >= b.parts[0]),
        _ => {}
    }
    if op == B::Mul
        && (matches!(a.ty, Type::Matrix(..)) || matches!(b.ty, Type::Matrix(..)))
        && !a.ty.is_scalar()
        && !b.ty.is_scalar()
    {
        return product(&a, &b);
    }
    let ty = if a.ty.is_scalar() { b.ty.clone() } else { a.ty.clone() };
    let n = ty.components()?;
    let part = |k: &Known, i: usize| k.parts[if k.parts.len() == 1 { 0 } else { i }];
    let integer = to.is_integer();
    let mut parts = Vec::new();
    for i in 0..n {
        let (x, y) = (part(&a, i), part(&b, i));
        let value = match op {
            B::Add => x + y,
            B::Sub => x - y,
            B::Mul => x * y,
            B::Div if integer => (y != 0.0).then(|| (x / y).trunc())?,
            B::Div => x / y,
            B::Rem => (y != 0.0).then(|| x % y)?,
            _ if integer => bits(op, x, y, to)?,
            _ => return None,
        };
        parts.push(if integer { wrapped(value, to) } else { value });
    }
    Some(Known { ty, parts })
}

fn with(value: Known, to: ScalarType) -> Known {
    let from = value.ty.scalar().unwrap_or(to);
    let parts = value.parts.iter().map(|&v| number(v, from, to)).collect();
    Known { ty: value.ty.with_scalar(to), parts }
}

#[expect(clippy::cast_possible_truncation, reason = "32 bits are kept, as the machine does")]
fn word(value: f64) -> u32 {
    (value as i64) as u32
}

fn wrapped(value: f64, ty: ScalarType) -> f64 {
    let word = word(value);
    if ty == ScalarType::Int { f64::from(word.cast_signed()) } else { f64::from(word) }
}

fn bits(op: BinaryOp, x: f64, y: f64, ty: ScalarType) -> Option<f64> {
    let (a, b) = (word(x), word(y));
    let result = match op {
        BinaryOp::BitAnd => a & b,
        BinaryOp::BitOr => a | b,
        BinaryOp::BitXor => a ^ b,
        BinaryOp::Shl if b < 32 => a << b,
        BinaryOp::Shr if b < 32 && ty == ScalarType::Int => (a.cast_signed() >> b).cast_unsigned(),
        BinaryOp::Shr if b < 32 => a >> b,
        _ => return None,
    };
    Some(f64::from(result))
}

/// Matrices times matrices and vectors; each sum in order.
fn product(a: &Known, b: &Known) -> Option<Known> {
    let scalar = a.ty.scalar()?;
    // A vector on the left is a row, on the right a column.
    let (rows, inner) = match a.ty {
        Type::Matrix(_, c, r) => (usize::from(r), usize::from(c)),
        _ => (1, a.parts.len()),
    };
    let columns = match b.ty {
        Type::Matrix(_, c, _) => usize::from(c),
        _ => 1,
    };
    let mut parts = Vec::new();
    for c in 0..columns {
        for r in 0..rows {
            parts.push((0..inner).map(|k| a.parts[k * rows + r] * b.parts[c * inner + k]).sum());
        }
    }
    let ty = match (&a.ty, &b.ty) {
        (Type::Matrix(..), Type::Matrix(..)) => {
            Type::Matrix(scalar, u8::try_from(columns).ok()?, u8::try_from(rows).ok()?)
        }
        _ => Type::Vector(scalar, u8::try_from(parts.len()).ok()?),
    };
    Some(Known { ty, parts })
}

/// What a built-in function gives.
pub fn function(name: F, values: Vec<Known>) -> Option<Known> {
    let first = values.first()?.clone();
    let truth =
        |ty: Type, parts: Vec<bool>| Known { ty, parts: parts.into_iter().map(|v| f64::from(u8::from(v))).collect() };
    match name {
        F::Any => return Some(truth(Type::BOOL, vec![first.parts.iter().any(|&v| v != 0.0)])),
        F::All => return Some(truth(Type::BOOL, vec![first.parts.iter().all(|&v| v != 0.0)])),
        F::Not => return Some(truth(first.ty, first.parts.iter().map(|&v| v == 0.0).collect())),
        _ => {}
    }
    if let Some(f) = compare(name) {
        let to = first.ty.scalar()?.max(values.get(1)?.ty.scalar()?);
        let (a, b) = (with(first, to), with(values[1].clone(), to));
        let parts = a.parts.iter().zip(&b.parts).map(|(x, y)| f(*x, *y)).collect();
        return Some(truth(a.ty.with_scalar(ScalarType::Bool), parts));
    }
    if name == F::Mix && values.get(2)?.ty.scalar() == Some(ScalarType::Bool) {
        let pick = |k: usize| if values[2].parts[k] != 0.0 { values[1].parts[k] } else { first.parts[k] };
        return Some(Known { ty: first.ty.clone(), parts: (0..first.parts.len()).map(pick).collect() });
    }
    let keeps = matches!(name, F::Abs | F::Sign | F::Min | F::Max | F::Clamp);
    let widest = values.iter().filter_map(|v| v.ty.scalar()).max()?;
    let to = if keeps || widest == ScalarType::Double { widest } else { ScalarType::Float };
    let values: Vec<Known> = values.into_iter().map(|v| with(v, to)).collect();
    let scalar = Type::Scalar(to);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let a = &values[0];
    let b = values.get(1);
    let geometric = match (name, b) {
        (F::Length, _) => Some((scalar, vec![dot(&a.parts, &a.parts).sqrt()])),
        (F::Normalize, _) => {
            let length = dot(&a.parts, &a.parts).sqrt();
            Some((a.ty.clone(), a.parts.iter().map(|v| v / length).collect()))
        }
        (F::Dot, Some(b)) => Some((scalar, vec![dot(&a.parts, &b.parts)])),
        (F::Distance, Some(b)) => {
            let d: Vec<f64> = a.parts.iter().zip(&b.parts).map(|(x, y)| x - y).collect();
            Some((scalar, vec![dot(&d, &d).sqrt()]))
        }
        (F::Cross, Some(b)) => {
            let (p, q) = (&a.parts, &b.parts);
            let at = |i: usize, j: usize| p[i] * q[j] - p[j] * q[i];
            Some((a.ty.clone(), vec![at(1, 2), at(2, 0), at(0, 1)]))
        }
        (F::Reflect, Some(b)) => {
            let d = 2.0 * dot(&b.parts, &a.parts);
            Some((a.ty.clone(), a.parts.iter().zip(&b.parts).map(|(i, n)| i - d * n).collect()))
        }
        (F::Refract, Some(b)) => {
            let eta = values.get(2)?.parts[0];
            let d = dot(&b.parts, &a.parts);
            let k = 1.0 - eta * eta * (1.0 - d * d);
            let each = |(i, n): (&f64, &f64)| if k < 0.0 { 0.0 } else { eta * i - (eta * d + k.sqrt()) * n };
            Some((a.ty.clone(), a.parts.iter().zip(&b.parts).map(each).collect()))
        }
        (F::Faceforward, Some(b)) => {
            let sign = if dot(&values.get(2)?.parts, &b.parts) < 0.0 { 1.0 } else { -1.0 };
            Some((a.ty.clone(), a.parts.iter().map(|v| sign * v).collect()))
        }
        (F::MatrixCompMult, Some(b)) => {
            Some((a.ty.clone(), a.parts.iter().zip(&b.parts).map(|(x, y)| x * y).collect()))
        }
        (F::OuterProduct, Some(b)) => {
            let ty = Type::Matrix(to, u8::try_from(b.parts.len()).ok()?, u8::try_from(a.parts.len()).ok()?);
            Some((ty, b.parts.iter().flat_map(|y| a.parts.iter().map(move |x| x * y)).collect()))
        }
        (F::Determinant, _) => Some((scalar, vec![eliminated(&a.parts)?.0])),
        (F::Inverse, _) => Some((a.ty.clone(), eliminated(&a.parts)?.1)),
        (F::Transpose, _) => {
            let Type::Matrix(_, columns, rows) = a.ty else { return None };
            let (c, r) = (usize::from(columns), usize::from(rows));
            let parts = (0..r).flat_map(|i| (0..c).map(move |j| (i, j))).map(|(i, j)| a.parts[j * r + i]).collect();
            Some((Type::Matrix(to, rows, columns), parts))
        }
        _ => None,
    };
    if let Some((ty, parts)) = geometric {
        return Some(Known { ty, parts });
    }
    let n = values.iter().map(|v| v.parts.len()).max()?;
    let ty = values.iter().find(|v| v.parts.len() == n)?.ty.clone();
    let mut parts = Vec::new();
    for i in 0..n {
        let args: Vec<f64> = values.iter().map(|v| v.parts[if v.parts.len() == 1 { 0 } else { i }]).collect();
        parts.push(of_numbers(name, &args)?);
    }
    Some(Known { ty, parts })
}

/// Determinant and inverse of a square matrix, by Gauss and Jordan with the greatest pivot.
fn eliminated(parts: &[f64]) -> Option<(f64, Vec<f64>)> {
    let n = (2..=4).find(|n| n * n == parts.len())?;
    // Columns are taken for rows: the determinant is the same, and the inverse comes out transposed
    // as it went in.
    let mut m: Vec<Vec<f64>> = parts.chunks(n).map(<[f64]>::to_vec).collect();
    let mut inverse: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let mut determinant = 1.0;
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| m[i][k].abs().total_cmp(&m[j][k].abs()))?;
        if m[pivot][k] == 0.0 {
            return None;
        }
        if pivot != k {
            determinant = -determinant;
            m.swap(pivot, k);
            inverse.swap(pivot, k);
        }
        let d = m[k][k];
        determinant *= d;
        for j in 0..n {
            m[k][j] /= d;
            inverse[k][j] /= d;
        }
        for i in (0..n).filter(|&i| i != k) {
            let factor = m[i][k];
            for j in 0..n {
                m[i][j] -= factor * m[k][j];
                inverse[i][j] -= factor * inverse[k][j];
            }
        }
    }
    Some((determinant, inverse.concat()))
}

fn compare(name: F) -> Option<fn(f64, f64) -> bool> {
    Some(match name {
        F::LessThan => |x, y| x < y,
        F::LessThanEqual => |x, y| x <= y,
        F::GreaterThan => |x, y| x > y,
        F::GreaterThanEqual => |x, y| x >= y,
        #[expect(clippy::float_cmp, reason = "the function compares exactly")]
        F::Equal => |x, y| x == y,
        #[expect(clippy::float_cmp, reason = "the function compares exactly")]
        F::NotEqual => |x, y| x != y,
        _ => return None,
    })
}

/// Functions of single numbers.
fn of_numbers(name: F, a: &[f64]) -> Option<f64> {
    let x = *a.first()?;
    Some(match (name, a) {
        (F::Sin, _) => number::SIN.value(x),
        (F::Cos, _) => number::COS.value(x),
        (F::Tan, _) => number::TAN.value(x),
        (F::Asin, _) => number::ASIN.value(x),
        (F::Acos, _) => number::ACOS.value(x),
        (F::Atan, [y, x]) => number::ATAN2.value(*y, *x),
        (F::Atan, _) => number::ATAN.value(x),
        (F::Sinh, _) => x.sinh(),
        (F::Cosh, _) => x.cosh(),
        (F::Tanh, _) => x.tanh(),
        (F::Asinh, _) => x.asinh(),
        (F::Acosh, _) => x.acosh(),
        (F::Atanh, _) => x.atanh(),
        (F::Radians, _) => x.to_radians(),
        (F::Degrees, _) => x.to_degrees(),
        (F::Exp, _) => number::EXP.value(x),
        (F::Log, _) => number::LN.value(x),
        (F::Exp2, _) => number::EXP2.value(x),
        (F::Log2, _) => number::LOG2.value(x),
        (F::Sqrt, _) => x.sqrt(),
        (F::Inversesqrt, _) => 1.0 / x.sqrt(),
        (F::Abs, _) => x.abs(),
        (F::Sign, _) => {
            if x == 0.0 {
                0.0
            } else {
                x.signum()
            }
        }
        (F::Floor, _) => x.floor(),
        (F::Ceil, _) => x.ceil(),
        (F::Trunc, _) => x.trunc(),
        (F::Round | F::RoundEven, _) => x.round_ties_even(),
        (F::Fract, _) => x - x.floor(),
        (F::Pow, [x, y]) => number::POW.value(*x, *y),
        (F::Mod, [x, y]) => x - y * (x / y).floor(),
        (F::Min, [x, y]) => x.min(*y),
        (F::Max, [x, y]) => x.max(*y),
        (F::Clamp, [x, low, high]) => x.max(*low).min(*high),
        (F::Mix, [x, y, t]) => x * (1.0 - t) + y * t,
        (F::Fma, [x, y, z]) => x.mul_add(*y, *z),
        (F::Step, [edge, x]) => f64::from(u8::from(x >= edge)),
        (F::Smoothstep, [low, high, x]) => {
            let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        }
        _ => return None,
    })
}
