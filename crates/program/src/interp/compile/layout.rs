//! Where the scalars of a type lie in memory, in words: of 32 bits, or of 16 where a buffer has numbers of that size.

use std::sync::Arc;

use naga::{AddressSpace, ArraySize, GlobalVariable, Handle, Module, StorageAccess, Type, TypeInner};

use super::super::group::{Array, Leaf, MemoryShape, Space, Texels};
use super::wide::words;
use super::{image, types};
use base::value::Scalar;

/// Words of one memory that are still handled where its size is fixed.
const MAX_WORDS: u32 = 1 << 20;

/// How a memory is laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RegisterLayout {
    /// As a host fills it: by the offsets and strides of the module, in words of so many bytes.
    Host {
        /// 4, or 2.
        unit: u32,
    },
    /// One scalar after the other: no host sees it.
    Packed,
}

impl RegisterLayout {
    pub(super) fn of(module: &Module, variable: &GlobalVariable) -> Self {
        if variable.space == AddressSpace::WorkGroup {
            return Self::Packed;
        }
        Self::Host { unit: unit(module, variable.ty) }
    }

    /// Words of a scalar.
    fn scalar(self, scalar: naga::Scalar) -> u32 {
        match self {
            Self::Host { unit } => (u32::from(scalar.width) / unit).max(1),
            Self::Packed => words(Some(scalar)) as u32,
        }
    }

    /// Words from one element to the next, and the number of elements: `None` for an array that is as long as its
    /// memory. `None` for a type that has no elements of one kind.
    pub(super) fn elements(self, module: &Module, inner: &TypeInner) -> Option<(u32, Option<u32>)> {
        Some(match *inner {
            TypeInner::Vector { size, scalar } | TypeInner::ValuePointer { size: Some(size), scalar, .. } => {
                (self.scalar(scalar), Some(size as u32))
            }
            TypeInner::Matrix { columns, rows, scalar } => (self.column(rows, scalar), Some(columns as u32)),
            TypeInner::Array { base, size, stride } => {
                let stride = match self {
                    Self::Host { unit } => stride / unit,
                    Self::Packed => self.words(module, &module.types[base].inner).ok()?,
                };
                let len = match size {
                    ArraySize::Constant(len) => Some(len.get()),
                    ArraySize::Dynamic => None,
                    ArraySize::Pending(_) => return None,
                };
                (stride, len)
            }
            _ => return None,
        })
    }

    /// The distance of a member or element with a known index.
    pub(super) fn part(self, module: &Module, inner: &TypeInner, index: u32) -> Option<u32> {
        if let TypeInner::Struct { ref members, .. } = *inner {
            let member = members.get(index as usize)?;
            return match self {
                Self::Host { unit } => Some(member.offset / unit),
                Self::Packed => {
                    let words = |member: &naga::StructMember| self.words(module, &module.types[member.ty].inner).ok();
                    members[..index as usize].iter().map(words).sum()
                }
            };
        }
        let (stride, len) = self.elements(module, inner)?;
        len.is_none_or(|len| index < len).then(|| stride.saturating_mul(index))
    }

    fn column(self, rows: naga::VectorSize, scalar: naga::Scalar) -> u32 {
        let rows = match (self, rows) {
            (Self::Host { .. }, naga::VectorSize::Tri | naga::VectorSize::Quad) => 4,
            (Self::Host { .. } | Self::Packed, rows) => rows as u32,
        };
        rows * self.scalar(scalar)
    }

    /// Words that a value takes; those of a type without a fixed size up to its last member.
    fn words(self, module: &Module, inner: &TypeInner) -> Result<u32, String> {
        let mut leaves = Vec::new();
        self.leaves(module, inner, "", &[], 0, &mut leaves)?;
        Ok(leaves.iter().map(|leaf| leaf.offset + leaf_words(self, leaf)).max().unwrap_or(0))
    }

    /// The scalars of a type with their distances from its beginning. An array without a fixed size has none.
    pub(super) fn scalars(self, module: &Module, inner: &TypeInner) -> Result<Vec<(Scalar, u32)>, String> {
        let mut leaves = Vec::new();
        self.leaves(module, inner, "", &[], 0, &mut leaves)?;
        Ok(leaves.into_iter().map(|leaf| (leaf.scalar, leaf.offset)).collect())
    }

    fn leaves(
        self,
        module: &Module,
        inner: &TypeInner,
        name: &str,
        lens: &[u32],
        at: u32,
        all: &mut Vec<Leaf>,
    ) -> Result<(), String> {
        let of = |ty: Handle<Type>| &module.types[ty].inner;
        let whole: Arc<str> = Arc::from(name);
        let all_lens: Arc<[u32]> = Arc::from(lens);
        let mut push = |offset: u32, scalar: naga::Scalar, component: Option<u32>| -> Result<(), String> {
            if all.len() >= MAX_WORDS as usize {
                return Err(format!("memory of more than {MAX_WORDS} words"));
            }
            let step = self.scalar(naga::Scalar::U32);
            for half in 0..words(Some(scalar)) as u32 {
                all.push(Leaf {
                    name: if half == 0 { whole.clone() } else { Arc::from(format!("{whole} (upper half)")) },
                    offset: offset + half * step,
                    scalar: types::scalar_in_memory(scalar)?,
                    short: scalar.width == 2,
                    component,
                    lens: all_lens.clone(),
                });
            }
            Ok(())
        };
        match *inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => push(at, scalar, None)?,
            TypeInner::Vector { size, scalar } => {
                let step = self.scalar(scalar);
                (0..size as u32).try_for_each(|k| push(at + k * step, scalar, Some(k)))?;
            }
            TypeInner::Matrix { columns, rows, scalar } => {
                let (stride, step) = (self.column(rows, scalar), self.scalar(scalar));
                for column in 0..columns as u32 {
                    for row in 0..rows as u32 {
                        push(at + column * stride + row * step, scalar, Some(column * rows as u32 + row))?;
                    }
                }
            }
            TypeInner::Array { base, size: ArraySize::Constant(len), .. } => {
                let (stride, _) = self.elements(module, inner).ok_or("an array without a stride")?;
                let name = format!("{name}[]");
                let lens = [lens, &[len.get()]].concat();
                for k in 0..len.get() {
                    self.leaves(module, of(base), &name, &lens, at.saturating_add(k.saturating_mul(stride)), all)?;
                }
            }
            TypeInner::Array { size: ArraySize::Dynamic, .. } => {}
            TypeInner::Struct { ref members, .. } => {
                for (k, member) in members.iter().enumerate() {
                    let inside = member.name.clone().unwrap_or_else(|| format!("member {k}"));
                    let name = if name.is_empty() { inside } else { format!("{name}.{inside}") };
                    let offset = self.part(module, inner, k as u32).ok_or("a member without a place")?;
                    self.leaves(module, of(member.ty), &name, lens, at + offset, all)?;
                }
            }
            // What else cannot be in memory has a message there.
            ref other => {
                types::count(module, other)?;
            }
        }
        Ok(())
    }
}

/// Words that a scalar takes.
fn leaf_words(layout: RegisterLayout, leaf: &Leaf) -> u32 {
    match layout {
        RegisterLayout::Host { unit: 2 } if !leaf.short => 2,
        RegisterLayout::Host { .. } | RegisterLayout::Packed => 1,
    }
}

/// Bytes of a word of a buffer of this type: of its shortest scalar.
fn unit(module: &Module, ty: Handle<Type>) -> u32 {
    let halves = match module.types[ty].inner {
        TypeInner::Array { base, .. } => unit(module, base) == 2,
        TypeInner::Struct { ref members, .. } => members.iter().any(|member| unit(module, member.ty) == 2),
        ref inner => inner.scalar().is_some_and(|scalar| scalar.width == 2),
    };
    if halves { 2 } else { 4 }
}

/// The memory behind a variable.
pub(super) fn shape(module: &Module, handle: Handle<GlobalVariable>) -> Result<MemoryShape, String> {
    if let Some(image) = image::shape(module, handle) {
        return image;
    }
    let variable = &module.global_variables[handle];
    let layout = RegisterLayout::of(module, variable);
    let inner = &module.types[variable.ty].inner;
    let mut fixed = Vec::new();
    layout.leaves(module, inner, "", &[], 0, &mut fixed)?;
    let (mut at, mut ty) = (0, variable.ty);
    let mut path = String::new();
    let array = loop {
        match module.types[ty].inner {
            TypeInner::Array { base, size: ArraySize::Dynamic, .. } => {
                let inner = &module.types[ty].inner;
                let (stride, _) = layout.elements(module, inner).ok_or("an array without a stride")?;
                let mut leaves = Vec::new();
                layout.leaves(module, &module.types[base].inner, &path, &[], 0, &mut leaves)?;
                break Some(Array { name: path, offset: at, stride: stride.max(1), leaves });
            }
            TypeInner::Struct { ref members, .. } => {
                let Some((k, last)) = members.iter().enumerate().next_back() else { break None };
                at += layout.part(module, &module.types[ty].inner, k as u32).ok_or("a member without a place")?;
                path = last.name.clone().unwrap_or_default();
                ty = last.ty;
            }
            _ => break None,
        }
    };
    let space = match variable.space {
        AddressSpace::WorkGroup => Space::Workgroup,
        AddressSpace::Storage { access } => Space::Storage { writes: access.contains(StorageAccess::STORE) },
        _ => Space::Uniform,
    };
    let words = fixed
        .iter()
        .map(|leaf| leaf.offset + leaf_words(layout, leaf))
        .max()
        .unwrap_or(0)
        .max(array.as_ref().map_or(0, |a| a.offset));
    let unit = match layout {
        RegisterLayout::Host { unit } => unit,
        RegisterLayout::Packed => 4,
    };
    let name = variable.name.clone().unwrap_or_default();
    let axes = crate::build::axes_of_texels(&module.types[variable.ty]);
    let image = axes.map(|axes| Texels { channels: Vec::new(), axes, layered: false });
    Ok(MemoryShape { name, space, unit, words, fixed, array, image })
}
