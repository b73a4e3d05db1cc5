//! Built-in functions as a table, spread into concrete signatures once.

use std::collections::HashMap;
use std::sync::OnceLock;

use super::super::symbols::Direction;
use super::super::types::{ScalarType, Type};
use super::textures;

/// One way to call a built-in function.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Signature {
    pub params: Vec<(Direction, Type)>,
    pub result: Type,
    /// Its last parameter is a bias of the level of detail: fragment shaders only.
    pub bias: bool,
}

/// Name, component types, sizes, form. In the form `T` is the vector of the size and component
/// type, `S` its component, `B`, `I`, `U`, `F` the `bvec`, `ivec`, `uvec`, `vec` of that size;
/// anything else is a type by its name. Component types: f(loat) d(ouble) i(nt) u(int) b(ool).
const TABLE: &[(&str, &str, &str, &str)] = &[
    // 8.1 angles and trigonometry
    ("radians degrees sin cos tan asin acos sinh cosh tanh asinh acosh atanh", "f", "1234", "T(T)"),
    ("atan", "f", "1234", "T(T)"),
    ("atan", "f", "1234", "T(T,T)"),
    // 8.2 exponentials
    ("pow", "f", "1234", "T(T,T)"),
    ("exp log exp2 log2", "f", "1234", "T(T)"),
    ("sqrt inversesqrt", "fd", "1234", "T(T)"),
    // 8.3 common functions
    ("abs sign", "fdi", "1234", "T(T)"),
    ("floor trunc round roundEven ceil fract", "fd", "1234", "T(T)"),
    ("mod", "fd", "1234", "T(T,T)"),
    ("mod", "fd", "234", "T(T,S)"),
    ("modf", "fd", "1234", "T(T,out T)"),
    ("min max", "fdiu", "1234", "T(T,T)"),
    ("min max", "fdiu", "234", "T(T,S)"),
    ("clamp", "fdiu", "1234", "T(T,T,T)"),
    ("clamp", "fdiu", "234", "T(T,S,S)"),
    ("mix", "fd", "1234", "T(T,T,T)"),
    ("mix", "fd", "234", "T(T,T,S)"),
    ("mix", "fdiub", "1234", "T(T,T,B)"),
    ("step", "fd", "1234", "T(T,T)"),
    ("step", "fd", "234", "T(S,T)"),
    ("smoothstep", "fd", "1234", "T(T,T,T)"),
    ("smoothstep", "fd", "234", "T(S,S,T)"),
    ("isnan isinf", "fd", "1234", "B(T)"),
    ("floatBitsToInt", "f", "1234", "I(T)"),
    ("floatBitsToUint", "f", "1234", "U(T)"),
    ("intBitsToFloat", "i", "1234", "F(T)"),
    ("uintBitsToFloat", "u", "1234", "F(T)"),
    ("fma", "fd", "1234", "T(T,T,T)"),
    ("frexp", "fd", "1234", "T(T,out I)"),
    ("ldexp", "fd", "1234", "T(T,I)"),
    // 8.4 packing
    ("packUnorm2x16 packSnorm2x16 packHalf2x16", "f", "1", "uint(vec2)"),
    ("packUnorm4x8 packSnorm4x8", "f", "1", "uint(vec4)"),
    ("unpackUnorm2x16 unpackSnorm2x16 unpackHalf2x16", "f", "1", "vec2(uint)"),
    ("unpackUnorm4x8 unpackSnorm4x8", "f", "1", "vec4(uint)"),
    ("packDouble2x32", "f", "1", "double(uvec2)"),
    ("unpackDouble2x32", "f", "1", "uvec2(double)"),
    // 8.5 geometric functions
    ("length", "fd", "1234", "S(T)"),
    ("distance dot", "fd", "1234", "S(T,T)"),
    ("cross", "fd", "3", "T(T,T)"),
    ("normalize", "fd", "1234", "T(T)"),
    ("faceforward", "fd", "1234", "T(T,T,T)"),
    ("reflect", "fd", "1234", "T(T,T)"),
    ("refract", "fd", "1234", "T(T,T,S)"),
    ("ftransform", "f", "1", "vec4()"),
    // 8.7 vector relations
    ("lessThan lessThanEqual greaterThan greaterThanEqual", "fdiu", "234", "B(T,T)"),
    ("equal notEqual", "fdiub", "234", "B(T,T)"),
    ("any all", "b", "234", "bool(T)"),
    ("not", "b", "234", "T(T)"),
    // 8.8 integers
    ("uaddCarry usubBorrow", "u", "1234", "T(T,T,out T)"),
    ("umulExtended", "u", "1234", "void(T,T,out T,out T)"),
    ("imulExtended", "i", "1234", "void(T,T,out T,out T)"),
    ("bitfieldExtract", "iu", "1234", "T(T,int,int)"),
    ("bitfieldInsert", "iu", "1234", "T(T,T,int,int)"),
    ("bitfieldReverse", "iu", "1234", "T(T)"),
    ("bitCount findLSB findMSB", "iu", "1234", "I(T)"),
    // 8.10 and 8.11 atomics
    ("atomicCounter atomicCounterIncrement atomicCounterDecrement", "u", "1", "uint(atomic_uint)"),
    ("atomicAdd atomicMin atomicMax atomicAnd atomicOr atomicXor atomicExchange", "iu", "1", "T(inout T,T)"),
    ("atomicCompSwap", "iu", "1", "T(inout T,T,T)"),
    (
        "atomicCounterAdd atomicCounterSubtract atomicCounterMin atomicCounterMax atomicCounterAnd atomicCounterOr \
         atomicCounterXor atomicCounterExchange",
        "u",
        "1",
        "uint(atomic_uint,uint)",
    ),
    ("atomicCounterCompSwap", "u", "1", "uint(atomic_uint,uint,uint)"),
    // 8.13 fragments
    ("dFdx dFdy fwidth dFdxFine dFdyFine fwidthFine dFdxCoarse dFdyCoarse fwidthCoarse", "f", "1234", "T(T)"),
    ("interpolateAtCentroid", "f", "1234", "T(T)"),
    ("interpolateAtSample", "f", "1234", "T(T,int)"),
    ("interpolateAtOffset", "f", "1234", "T(T,vec2)"),
    // 8.14 noise
    ("noise1", "f", "1234", "float(T)"),
    ("noise2", "f", "1234", "vec2(T)"),
    ("noise3", "f", "1234", "vec3(T)"),
    ("noise4", "f", "1234", "vec4(T)"),
    // 8.15 geometry, 8.16 and 8.17 barriers
    ("EmitVertex EndPrimitive", "f", "1", "void()"),
    ("EmitStreamVertex EndStreamPrimitive", "f", "1", "void(int)"),
    (
        "barrier memoryBarrier memoryBarrierAtomicCounter memoryBarrierBuffer memoryBarrierShared memoryBarrierImage \
         groupMemoryBarrier",
        "f",
        "1",
        "void()",
    ),
    // 8.19 group votes
    (
        "anyInvocation allInvocations allInvocationsEqual anyInvocationARB allInvocationsARB allInvocationsEqualARB",
        "f",
        "1",
        "bool(bool)",
    ),
];

/// Functions by name.
pub(super) type Table = HashMap<&'static str, Vec<Signature>>;

fn table() -> &'static Table {
    static TABLE_CELL: OnceLock<Table> = OnceLock::new();
    TABLE_CELL.get_or_init(|| {
        let mut all = Table::new();
        for (names, kinds, sizes, form) in TABLE {
            for kind in kinds.chars() {
                for size in sizes.bytes() {
                    let signature = spread(form, scalar(kind), size - b'0');
                    for name in names.split_whitespace() {
                        all.entry(name).or_default().push(signature.clone());
                    }
                }
            }
        }
        matrices(&mut all);
        textures::add(&mut all);
        all
    })
}

/// The signatures of a built-in function; none when there is no such function. `float` forms
/// come before `double` ones.
pub(crate) fn functions(name: &str) -> &'static [Signature] {
    table().get(name).map_or(&[], Vec::as_slice)
}

/// Names of all built-in functions.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    table().keys().copied()
}

fn scalar(kind: char) -> ScalarType {
    match kind {
        'd' => ScalarType::Double,
        'i' => ScalarType::Int,
        'u' => ScalarType::Uint,
        'b' => ScalarType::Bool,
        _ => ScalarType::Float,
    }
}

fn spread(form: &str, scalar: ScalarType, size: u8) -> Signature {
    let ty = |text: &str| match text {
        "T" => Type::vector(scalar, size),
        "S" => Type::Scalar(scalar),
        "B" => Type::vector(ScalarType::Bool, size),
        "I" => Type::vector(ScalarType::Int, size),
        "U" => Type::vector(ScalarType::Uint, size),
        "F" => Type::vector(ScalarType::Float, size),
        // A test proves that every other word of the table is a type.
        name => Type::from_name(name).unwrap_or(Type::Error),
    };
    let (result, params) = form.trim_end_matches(')').split_once('(').unwrap_or((form, ""));
    let params = params
        .split(',')
        .filter(|p| !p.is_empty())
        .map(|p| match p.split_once(' ') {
            Some(("out", name)) => (Direction::Out, ty(name)),
            Some((_, name)) => (Direction::InOut, ty(name)),
            None => (Direction::In, ty(p)),
        })
        .collect();
    Signature { params, result: ty(result), bias: false }
}

/// 8.6 matrix functions.
fn matrices(all: &mut Table) {
    let mut add = |name, params: &[Type], result: Type| {
        let params = params.iter().map(|t| (Direction::In, t.clone())).collect();
        all.entry(name).or_default().push(Signature { params, result, bias: false });
    };
    for s in [ScalarType::Float, ScalarType::Double] {
        for c in 2..=4 {
            for r in 2..=4 {
                let m = Type::Matrix(s, c, r);
                add("matrixCompMult", &[m.clone(), m.clone()], m.clone());
                add("outerProduct", &[Type::Vector(s, r), Type::Vector(s, c)], m.clone());
                add("transpose", std::slice::from_ref(&m), Type::Matrix(s, r, c));
                if c == r {
                    add("determinant", std::slice::from_ref(&m), Type::Scalar(s));
                    add("inverse", std::slice::from_ref(&m), m.clone());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_of_the_table_is_a_type() {
        let mut count = 0;
        for (name, signatures) in table() {
            count += 1;
            for s in signatures {
                assert!(!s.result.is_error() && s.params.iter().all(|(_, t)| !t.is_error()), "{name}: {s:?}");
            }
        }
        assert!(count > 150, "{count}");
    }

    #[test]
    fn sizes_and_directions_are_spread() {
        let mix = functions("mix");
        let vec3 = Type::VEC3;
        let want = Signature {
            params: vec![(Direction::In, vec3.clone()), (Direction::In, vec3.clone()), (Direction::In, Type::FLOAT)],
            result: vec3,
            bias: false,
        };
        assert!(mix.contains(&want));
        assert_eq!(functions("modf")[0].params[1].0, Direction::Out);
        assert_eq!(functions("atomicAdd")[0].params[0].0, Direction::InOut);
        assert!(functions("saturate").is_empty());
        assert_eq!(functions("cross")[0].result, Type::VEC3);
    }
}
