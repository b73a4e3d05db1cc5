//! Values as 32-bit words: loading from and storing to arrays of words, type by type.

use naga::{ArraySize, BinaryOperator, Expression, Handle, Literal, Module, ScalarKind, Type, TypeInner};

use super::builder::Builder;
use base::value::{Scalar, Shape};

type Expr = Handle<Expression>;

/// The shape of a naga type; `None` for types that cannot be captured word by word.
pub fn shape_of(module: &Module, ty: Handle<Type>) -> Option<Shape> {
    let scalar_of = |scalar: naga::Scalar| match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 2 | 4) => Some(Scalar::F32),
        (ScalarKind::Sint, 4) => Some(Scalar::I32),
        (ScalarKind::Uint, 4) => Some(Scalar::U32),
        (ScalarKind::Bool, _) => Some(Scalar::Bool),
        _ => None,
    };
    let half = |scalar: naga::Scalar| scalar == naga::Scalar::F16;
    match module.types[ty].inner {
        TypeInner::Scalar(scalar) => Some(Shape { half: half(scalar), ..Shape::vector(scalar_of(scalar)?, 1) }),
        TypeInner::Vector { size, scalar } => {
            Some(Shape { half: half(scalar), ..Shape::vector(scalar_of(scalar)?, size as u8) })
        }
        TypeInner::Matrix { columns, rows, scalar } => {
            let (columns, rows) = (columns as u8, rows as u8);
            Some(Shape { scalar: scalar_of(scalar)?, columns, rows, array: None, half: half(scalar) })
        }
        TypeInner::Array { base, size: ArraySize::Constant(len), .. } => {
            let element = shape_of(module, base)?;
            element.array.is_none().then(|| element.array_of(len.get()))
        }
        _ => None,
    }
}

/// Where the words of inputs come from.
#[derive(Clone, Copy, Debug)]
pub enum Supply<'a> {
    /// An array of words in storage.
    Storage(WordsAt),
    /// A uniform array of `vec4<u32>`, from a word that is the same for all invocations.
    Block {
        /// Pointer to the array.
        array: Expr,
        /// Index of the first word.
        first: u32,
    },
    /// These words, written as literals.
    Literals(&'a [u32]),
    /// Arguments of the entry point, one for each number or vector: its first word, and which argument.
    Arguments(&'a [(u32, u32)]),
}

/// An array of words and a place in it.
#[derive(Clone, Copy, Debug)]
pub struct WordsAt {
    /// Pointer to the array of words.
    pub array: Expr,
    /// Index of the first word.
    pub base: Expr,
}

/// A word of an array, or `None` where single words are not available.
fn word(b: &mut Builder, from: Supply<'_>, offset: u32) -> Option<Expr> {
    let pointer = match from {
        Supply::Storage(at) => {
            let index = b.offset(at.base, offset);
            b.element(at.array, index)
        }
        Supply::Block { array, first } => {
            let at = first + offset;
            let vector = b.member(array, at / 4);
            b.member(vector, at % 4)
        }
        Supply::Literals(_) | Supply::Arguments(_) => return None,
    };
    Some(b.load(pointer))
}

/// A literal with exactly these bits: numbers that a text cannot name are cast from an integer.
fn literal(b: &mut Builder, kind: ScalarKind, word: u32) -> Expr {
    let number = f32::from_bits(word);
    let literal = match kind {
        ScalarKind::Float if number.is_normal() || number == 0.0 => Literal::F32(number),
        ScalarKind::Float => {
            let bits = b.u32(word);
            return b.bitcast(bits, ScalarKind::Float);
        }
        ScalarKind::Sint => Literal::I32(word.cast_signed()),
        ScalarKind::Bool => Literal::Bool(word != 0),
        ScalarKind::Uint | ScalarKind::AbstractInt | ScalarKind::AbstractFloat => Literal::U32(word),
    };
    b.name(Expression::Literal(literal))
}

/// A real number of binary32 as one of a type, or one of a type as one of binary32.
fn of_width(b: &mut Builder, scalar: naga::Scalar, value: Expr) -> Expr {
    let (kind, convert) = (scalar.kind, Some(scalar.width));
    if scalar.kind == ScalarKind::Float { b.compute(Expression::As { expr: value, kind, convert }) } else { value }
}

/// Builds a value of type `ty` from the words that are supplied, beginning `offset` words in.
pub fn load(b: &mut Builder, module: &Module, from: Supply<'_>, offset: &mut u32, ty: Handle<Type>) -> Option<Expr> {
    if let (Supply::Arguments(arguments), TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. }) =
        (from, &module.types[ty].inner)
    {
        let (_, argument) = arguments.iter().find(|(first, _)| first == offset)?;
        *offset += shape_of(module, ty)?.words() as u32;
        let value = b.argument(*argument);
        // No attribute is a truth value: it comes as an integer.
        let truth = scalar.kind == ScalarKind::Bool;
        return Some(if truth {
            b.compute(Expression::As { expr: value, kind: ScalarKind::Bool, convert: Some(1) })
        } else {
            value
        });
    }
    let components = match module.types[ty].inner {
        TypeInner::Scalar(scalar) => {
            let at = *offset;
            *offset += 1;
            if let Supply::Literals(words) = from {
                let whole = literal(b, scalar.kind, *words.get(at as usize)?);
                return Some(of_width(b, scalar, whole));
            }
            let word = word(b, from, at)?;
            return Some(match scalar.kind {
                ScalarKind::Uint => word,
                ScalarKind::Bool => {
                    let zero = b.u32(0);
                    b.binary(BinaryOperator::NotEqual, word, zero)
                }
                kind => {
                    let whole = b.bitcast(word, kind);
                    of_width(b, scalar, whole)
                }
            });
        }
        TypeInner::Vector { size, scalar } => {
            let component = module.types.get(&Type { name: None, inner: TypeInner::Scalar(scalar) })?;
            (0..size as u8).map(|_| load(b, module, from, offset, component)).collect::<Option<Vec<_>>>()?
        }
        TypeInner::Matrix { columns, rows, scalar } => {
            let inner = TypeInner::Vector { size: rows, scalar };
            let column = module.types.get(&Type { name: None, inner })?;
            (0..columns as u8).map(|_| load(b, module, from, offset, column)).collect::<Option<Vec<_>>>()?
        }
        TypeInner::Array { base, size: ArraySize::Constant(len), .. } => {
            (0..len.get()).map(|_| load(b, module, from, offset, base)).collect::<Option<Vec<_>>>()?
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
                ScalarKind::Float => {
                    let whole = of_width(b, naga::Scalar::F32, value);
                    b.bitcast(whole, ScalarKind::Uint)
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
