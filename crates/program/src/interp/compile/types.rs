//! Types as sequences of scalars: matrices column by column, arrays element by element.

use naga::{ArraySize, Handle, Module, ScalarKind, Type, TypeInner};

use super::wide::words;
use base::value::Scalar;

/// Scalars of one variable that are still handled: more are a table that belongs into a texture.
pub(super) const MAX_SCALARS: usize = 1 << 14;

/// The scalar type, or its name when it is not handled.
pub(super) fn scalar(scalar: naga::Scalar) -> Result<Scalar, String> {
    match (scalar.kind, scalar.width) {
        // Numbers of binary16 are those of binary32 that it has: see `Grade::Half`.
        (ScalarKind::Float, 2 | 4) => Ok(Scalar::F32),
        (ScalarKind::Sint, 4) => Ok(Scalar::I32),
        (ScalarKind::Uint, 4) => Ok(Scalar::U32),
        // The halves of a number of 64 bits: see `wide`.
        (ScalarKind::Sint | ScalarKind::Uint, 8) => Ok(Scalar::U32),
        (ScalarKind::Bool, _) => Ok(Scalar::Bool),
        (ScalarKind::Float, width) => Err(format!("{}-bit floats", 8 * u32::from(width))),
        (ScalarKind::Sint | ScalarKind::Uint, width) => Err(format!("{}-bit integers", 8 * u32::from(width))),
        (ScalarKind::AbstractInt | ScalarKind::AbstractFloat, _) => Err("numbers of abstract type".to_owned()),
    }
}

/// The scalar type of what lies in memory: whole numbers of 16 bits are loaded as those of 32.
pub(super) fn scalar_in_memory(of: naga::Scalar) -> Result<Scalar, String> {
    match (of.kind, of.width) {
        (ScalarKind::Sint, 2) => Ok(Scalar::I32),
        (ScalarKind::Uint, 2) => Ok(Scalar::U32),
        _ => scalar(of),
    }
}

/// True for numbers of binary16, and for arrays of them.
pub(super) fn is_half(module: &Module, ty: Handle<Type>) -> bool {
    match module.types[ty].inner {
        TypeInner::Array { base, .. } => is_half(module, base),
        ref inner => inner.scalar() == Some(naga::Scalar::F16),
    }
}

/// Number of scalars of a type.
pub(super) fn count(module: &Module, inner: &TypeInner) -> Result<usize, String> {
    let of = |ty: Handle<Type>| count(module, &module.types[ty].inner);
    let n = match *inner {
        TypeInner::Scalar(s) => scalar(s).map(|_| words(Some(s)))?,
        TypeInner::Vector { size, scalar: s } => scalar(s).map(|_| size as usize * words(Some(s)))?,
        TypeInner::Matrix { columns, rows, scalar: s } => scalar(s).map(|_| columns as usize * rows as usize)?,
        TypeInner::Array { base, size, .. } => match size {
            ArraySize::Constant(len) => of(base)?.saturating_mul(len.get() as usize),
            ArraySize::Pending(_) => return Err("arrays whose size is a pipeline constant".to_owned()),
            ArraySize::Dynamic => return Err("arrays of run-time size".to_owned()),
        },
        TypeInner::Struct { ref members, .. } => {
            let mut sum = 0_usize;
            for member in members {
                sum = sum.saturating_add(of(member.ty)?);
            }
            sum
        }
        TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. } => return Err("pointers in variables".to_owned()),
        TypeInner::Atomic(_) => return Err("atomics".to_owned()),
        TypeInner::Image { .. } | TypeInner::Sampler { .. } => return Err("textures and samplers".to_owned()),
        TypeInner::BindingArray { .. } => return Err("arrays of buffers, textures or samplers".to_owned()),
        TypeInner::AccelerationStructure { .. } | TypeInner::RayQuery { .. } => return Err("ray queries".to_owned()),
        TypeInner::CooperativeMatrix { .. } => return Err("cooperative matrices".to_owned()),
    };
    if n > MAX_SCALARS { Err(format!("variables of more than {MAX_SCALARS} numbers")) } else { Ok(n) }
}

/// The scalars of a type, in order.
pub(super) fn scalars(module: &Module, inner: &TypeInner) -> Result<Vec<Scalar>, String> {
    count(module, inner)?;
    let mut all = Vec::new();
    push(module, inner, &mut all);
    Ok(all)
}

fn push(module: &Module, inner: &TypeInner, all: &mut Vec<Scalar>) {
    match *inner {
        TypeInner::Scalar(s) | TypeInner::Vector { scalar: s, .. } | TypeInner::Matrix { scalar: s, .. } => {
            let n = match *inner {
                TypeInner::Vector { size, .. } => size as usize,
                TypeInner::Matrix { columns, rows, .. } => columns as usize * rows as usize,
                _ => 1,
            };
            // `count` has refused every other scalar.
            all.extend(scalar(s).into_iter().flat_map(|of| std::iter::repeat_n(of, n * words(Some(s)))));
        }
        TypeInner::Array { base, size: ArraySize::Constant(len), .. } => {
            for _ in 0..len.get() {
                push(module, &module.types[base].inner, all);
            }
        }
        TypeInner::Struct { ref members, .. } => {
            members.iter().for_each(|member| push(module, &module.types[member.ty].inner, all));
        }
        // `count` has refused every other type.
        _ => {}
    }
}

/// What an index into a value of a type steps over: scalars of one element, and number of elements.
/// `None` for types that have no elements of one kind.
pub(super) fn elements(module: &Module, inner: &TypeInner) -> Option<(usize, usize)> {
    match *inner {
        TypeInner::Vector { size, scalar } | TypeInner::ValuePointer { size: Some(size), scalar, .. } => {
            Some((words(Some(scalar)), size as usize))
        }
        TypeInner::Matrix { columns, rows, .. } => Some((rows as usize, columns as usize)),
        TypeInner::Array { base, size: ArraySize::Constant(len), .. } => {
            Some((count(module, &module.types[base].inner).ok()?, len.get() as usize))
        }
        _ => None,
    }
}

/// First scalar and number of scalars of a member or element with a known index.
pub(super) fn part(module: &Module, inner: &TypeInner, index: u32) -> Option<(usize, usize)> {
    if let TypeInner::Struct { ref members, .. } = *inner {
        let of = |ty: Handle<Type>| count(module, &module.types[ty].inner).ok();
        let mut at = 0;
        for member in &members[..index as usize] {
            at += of(member.ty)?;
        }
        return Some((at, of(members.get(index as usize)?.ty)?));
    }
    let (stride, len) = elements(module, inner)?;
    ((index as usize) < len).then_some((stride * index as usize, stride))
}
