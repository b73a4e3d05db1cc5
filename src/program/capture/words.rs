//! Values as 32-bit words: loading from and storing to arrays of words, type by type.

use naga::{ArraySize, BinaryOperator, Expression, Handle, Module, ScalarKind, Type, TypeInner};

use super::builder::Builder;
use crate::value::{Scalar, Shape};

type Expr = Handle<Expression>;

/// The shape of a naga type; `None` for types that cannot be captured word by word.
pub fn shape_of(module: &Module, ty: Handle<Type>) -> Option<Shape> {
    let scalar_of = |scalar: naga::Scalar| match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) => Some(Scalar::F32),
        (ScalarKind::Sint, 4) => Some(Scalar::I32),
        (ScalarKind::Uint, 4) => Some(Scalar::U32),
        (ScalarKind::Bool, _) => Some(Scalar::Bool),
        _ => None,
    };
    match module.types[ty].inner {
        TypeInner::Scalar(scalar) => Some(Shape::vector(scalar_of(scalar)?, 1)),
        TypeInner::Vector { size, scalar } => Some(Shape::vector(scalar_of(scalar)?, size as u8)),
        TypeInner::Matrix { columns, rows, scalar } => {
            Some(Shape { scalar: scalar_of(scalar)?, columns: columns as u8, rows: rows as u8, array: None })
        }
        TypeInner::Array { base, size: ArraySize::Constant(len), .. } => {
            let element = shape_of(module, base)?;
            element.array.is_none().then(|| element.array_of(len.get()))
        }
        _ => None,
    }
}

/// Where words come from.
#[derive(Clone, Copy, Debug)]
pub struct WordsAt {
    /// Pointer to the array of words.
    pub array: Expr,
    /// Index of the first word.
    pub base: Expr,
}

/// Builds a value of type `ty` from the words at `at`, beginning `offset` words in.
pub fn load(b: &mut Builder, module: &Module, at: WordsAt, offset: &mut u32, ty: Handle<Type>) -> Option<Expr> {
    let components = match module.types[ty].inner {
        TypeInner::Scalar(scalar) => {
            let index = b.offset(at.base, *offset);
            let pointer = b.element(at.array, index);
            *offset += 1;
            let word = b.load(pointer);
            return Some(match scalar.kind {
                ScalarKind::Uint => word,
                ScalarKind::Bool => {
                    let zero = b.u32(0);
                    b.binary(BinaryOperator::NotEqual, word, zero)
                }
                kind => b.bitcast(word, kind),
            });
        }
        TypeInner::Vector { size, scalar } => {
            let component = module.types.get(&Type { name: None, inner: TypeInner::Scalar(scalar) })?;
            (0..size as u8).map(|_| load(b, module, at, offset, component)).collect::<Option<Vec<_>>>()?
        }
        TypeInner::Matrix { columns, rows, scalar } => {
            let inner = TypeInner::Vector { size: rows, scalar };
            let column = module.types.get(&Type { name: None, inner })?;
            (0..columns as u8).map(|_| load(b, module, at, offset, column)).collect::<Option<Vec<_>>>()?
        }
        TypeInner::Array { base, size: ArraySize::Constant(len), .. } => {
            (0..len.get()).map(|_| load(b, module, at, offset, base)).collect::<Option<Vec<_>>>()?
        }
        _ => return None,
    };
    Some(b.compute(Expression::Compose { ty, components }))
}

/// Stores the words of a value of type `ty` at `at`, beginning `offset` words in.
pub fn store(b: &mut Builder, module: &Module, at: WordsAt, offset: &mut u32, ty: Handle<Type>, value: Expr) {
    let (count, part) = match module.types[ty].inner {
        TypeInner::Scalar(scalar) => {
            let word = match scalar.kind {
                ScalarKind::Uint => value,
                ScalarKind::Bool => {
                    let (one, zero) = (b.u32(1), b.u32(0));
                    b.compute(Expression::Select { condition: value, accept: one, reject: zero })
                }
                _ => b.bitcast(value, ScalarKind::Uint),
            };
            let index = b.offset(at.base, *offset);
            let pointer = b.element(at.array, index);
            b.store(pointer, word);
            *offset += 1;
            return;
        }
        TypeInner::Vector { size, scalar } => (size as u32, TypeInner::Scalar(scalar)),
        TypeInner::Matrix { columns, rows, scalar } => (columns as u32, TypeInner::Vector { size: rows, scalar }),
        TypeInner::Array { base, size: ArraySize::Constant(len), .. } => {
            for k in 0..len.get() {
                let element = b.member(value, k);
                store(b, module, at, offset, base, element);
            }
            return;
        }
        // `shape_of` has refused every other type before.
        _ => return,
    };
    let Some(part) = module.types.get(&Type { name: None, inner: part }) else { return };
    for k in 0..count {
        let component = b.member(value, k);
        store(b, module, at, offset, part, component);
    }
}

/// Makes sure that the scalar and column types that [`load`] and [`store`] look up are in the module.
pub fn insert_parts(module: &mut Module, ty: Handle<Type>) {
    let inner = module.types[ty].inner.clone();
    let mut add = |inner| {
        module.types.insert(Type { name: None, inner }, naga::Span::UNDEFINED);
    };
    match inner {
        TypeInner::Vector { scalar, .. } => add(TypeInner::Scalar(scalar)),
        TypeInner::Matrix { rows, scalar, .. } => {
            add(TypeInner::Scalar(scalar));
            add(TypeInner::Vector { size: rows, scalar });
        }
        TypeInner::Array { base, .. } => insert_parts(module, base),
        _ => {}
    }
}
