//! Where the scalars of a value lie in a buffer.

use naga::{ArraySize, Handle, Module, Type, TypeInner, VectorSize};

/// Byte offsets of the scalars of a value of type `ty` that begins at `start`, in the order in which
/// values are taken apart: members, elements, columns, components.
pub(super) fn byte_offsets(module: &Module, ty: Handle<Type>, start: u32, offsets: &mut Vec<u32>) {
    let mut run = |at: u32, count: u32| offsets.extend((0..count).map(|k| at + 4 * k));
    match module.types[ty].inner {
        TypeInner::Scalar(_) => run(start, 1),
        TypeInner::Vector { size, .. } => run(start, size as u32),
        TypeInner::Matrix { columns, rows, .. } => {
            // A column is aligned like a vector of its length: two components to 8 bytes, more to 16.
            let stride = if rows == VectorSize::Bi { 8 } else { 16 };
            (0..columns as u32).for_each(|column| run(start + column * stride, rows as u32));
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
