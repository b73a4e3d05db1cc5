//! Where the scalars of a value lie in a buffer.

use naga::{ArraySize, Handle, Module, ScalarKind, Type, TypeInner, VectorSize};

use base::value::Scalar;

/// Byte offsets of the scalars of a value of type `ty` that begins at `start`, in the order in which
/// values are taken apart: members, elements, columns, components.
pub(super) fn byte_offsets(module: &Module, ty: Handle<Type>, start: u32, offsets: &mut Vec<u32>) {
    let mut run = |at: u32, count: u32, width: u32| offsets.extend((0..count).map(|k| at + width * k));
    match module.types[ty].inner {
        TypeInner::Scalar(_) => run(start, 1, 4),
        TypeInner::Vector { size, scalar } => run(start, size as u32, scalar.width.into()),
        TypeInner::Matrix { columns, rows, scalar } => {
            let width = u32::from(scalar.width);
            // A column is aligned like a vector of its length: two components to two, more to four.
            let stride = width * if rows == VectorSize::Bi { 2 } else { 4 };
            (0..columns as u32).for_each(|column| run(start + column * stride, rows as u32, width));
        }
        TypeInner::Array { base, size: ArraySize::Constant(len), stride } => {
            (0..len.get()).for_each(|k| byte_offsets(module, base, start + k * stride, offsets));
        }
        TypeInner::Struct { ref members, .. } => {
            members.iter().for_each(|member| byte_offsets(module, member.ty, start + member.offset, offsets));
        }
        // `Program` has refused uniforms of other types.
        _ => {}
    }
}

/// The same with what each scalar is. `None` for a type that has others than those of 32 bits, or no end.
pub(super) fn words(module: &Module, ty: Handle<Type>, start: u32) -> Option<Vec<(u32, Scalar)>> {
    let (mut offsets, mut scalars) = (Vec::new(), Vec::new());
    kinds(module, ty, &mut scalars)?;
    byte_offsets(module, ty, start, &mut offsets);
    (offsets.len() == scalars.len()).then(|| offsets.into_iter().zip(scalars).collect())
}

fn kinds(module: &Module, ty: Handle<Type>, all: &mut Vec<Scalar>) -> Option<()> {
    let kind = |scalar: naga::Scalar| match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) => Some(Scalar::F32),
        (ScalarKind::Sint, 4) => Some(Scalar::I32),
        (ScalarKind::Uint, 4) => Some(Scalar::U32),
        _ => None,
    };
    match module.types[ty].inner {
        TypeInner::Scalar(scalar) => all.push(kind(scalar)?),
        TypeInner::Vector { size, scalar } => all.extend(std::iter::repeat_n(kind(scalar)?, size as usize)),
        TypeInner::Matrix { columns, rows, scalar } => {
            all.extend(std::iter::repeat_n(kind(scalar)?, columns as usize * rows as usize));
        }
        TypeInner::Array { base, size: ArraySize::Constant(len), .. } => {
            for _ in 0..len.get() {
                kinds(module, base, all)?;
            }
        }
        TypeInner::Struct { ref members, .. } => members.iter().try_for_each(|m| kinds(module, m.ty, all))?,
        _ => return None,
    }
    Some(())
}
