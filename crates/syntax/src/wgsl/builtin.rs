//! Built-in functions (WGSL, section 17): which of GLSL's each is, and what the others return.

use super::super::BuiltinFunction as F;
use super::super::symbols::Direction;
use super::super::types::{OpaqueKind, OpaqueType, ScalarType, TextureDim, Type};

/// Functions that GLSL has under another name.
const OTHER_NAMES: &[(&str, F)] = &[
    ("atan2", F::Atan),
    ("countOneBits", F::BitCount),
    ("dpdx", F::DFdx),
    ("dpdxCoarse", F::DFdxCoarse),
    ("dpdxFine", F::DFdxFine),
    ("dpdy", F::DFdy),
    ("dpdyCoarse", F::DFdyCoarse),
    ("dpdyFine", F::DFdyFine),
    ("extractBits", F::BitfieldExtract),
    ("faceForward", F::Faceforward),
    ("firstLeadingBit", F::FindMSB),
    ("firstTrailingBit", F::FindLSB),
    ("insertBits", F::BitfieldInsert),
    ("inverseSqrt", F::Inversesqrt),
    ("pack2x16float", F::PackHalf2x16),
    ("pack2x16snorm", F::PackSnorm2x16),
    ("pack2x16unorm", F::PackUnorm2x16),
    ("pack4x8snorm", F::PackSnorm4x8),
    ("pack4x8unorm", F::PackUnorm4x8),
    ("reverseBits", F::BitfieldReverse),
    // Halves go to the even neighbour.
    ("round", F::RoundEven),
    ("unpack2x16float", F::UnpackHalf2x16),
    ("unpack2x16snorm", F::UnpackSnorm2x16),
    ("unpack2x16unorm", F::UnpackUnorm2x16),
    ("unpack4x8snorm", F::UnpackSnorm4x8),
    ("unpack4x8unorm", F::UnpackUnorm4x8),
];

/// Functions that both languages have under one name and with one meaning.
const SAME_NAMES: &[F] = &[
    F::Abs,
    F::Acos,
    F::Acosh,
    F::All,
    F::Any,
    F::Asin,
    F::Asinh,
    F::Atan,
    F::Atanh,
    F::Ceil,
    F::Clamp,
    F::Cos,
    F::Cosh,
    F::Cross,
    F::Degrees,
    F::Determinant,
    F::Distance,
    F::Dot,
    F::Exp,
    F::Exp2,
    F::Floor,
    F::Fma,
    F::Fract,
    F::Fwidth,
    F::FwidthCoarse,
    F::FwidthFine,
    F::Ldexp,
    F::Length,
    F::Log,
    F::Log2,
    F::Max,
    F::Min,
    F::Mix,
    F::Normalize,
    F::Pow,
    F::Radians,
    F::Reflect,
    F::Refract,
    F::Sign,
    F::Sin,
    F::Sinh,
    F::Smoothstep,
    F::Sqrt,
    F::Step,
    F::Tan,
    F::Tanh,
    F::Transpose,
    F::Trunc,
];

/// The function of GLSL with the same meaning.
pub(super) fn of_glsl(name: &str) -> Option<F> {
    let same = || SAME_NAMES.iter().copied().find(|f| f.name() == name);
    OTHER_NAMES.iter().find(|(n, _)| *n == name).map(|(_, f)| *f).or_else(same)
}

/// Functions that GLSL does not have, or has with other arguments.
pub const OWN: &[&str] = &[
    "arrayLength",
    "atomicAdd",
    "atomicAnd",
    "atomicCompareExchangeWeak",
    "atomicExchange",
    "atomicLoad",
    "atomicMax",
    "atomicMin",
    "atomicOr",
    "atomicStore",
    "atomicSub",
    "atomicXor",
    "bitcast",
    "countLeadingZeros",
    "countTrailingZeros",
    "dot4I8Packed",
    "dot4U8Packed",
    "frexp",
    "modf",
    "pack4xI8",
    "pack4xI8Clamp",
    "pack4xU8",
    "pack4xU8Clamp",
    "quantizeToF16",
    "saturate",
    "select",
    "storageBarrier",
    "textureBarrier",
    "textureDimensions",
    "textureGather",
    "textureGatherCompare",
    "textureLoad",
    "textureNumLayers",
    "textureNumLevels",
    "textureNumSamples",
    "textureSample",
    "textureSampleBaseClampToEdge",
    "textureSampleBias",
    "textureSampleCompare",
    "textureSampleCompareLevel",
    "textureSampleGrad",
    "textureSampleLevel",
    "textureStore",
    "unpack4xI8",
    "unpack4xU8",
    "workgroupBarrier",
    "workgroupUniformLoad",
];

/// Functions of subgroups and quads (WGSL, sections 17.12 and 17.13), without the word in front.
const OF_SUBGROUPS: &[&str] = &[
    "Add",
    "All",
    "And",
    "Any",
    "Ballot",
    "Barrier",
    "Broadcast",
    "BroadcastFirst",
    "Elect",
    "ExclusiveAdd",
    "ExclusiveMul",
    "InclusiveAdd",
    "InclusiveMul",
    "Max",
    "Min",
    "Mul",
    "Or",
    "Shuffle",
    "ShuffleDown",
    "ShuffleUp",
    "ShuffleXor",
    "Xor",
];
const OF_QUADS: &[&str] = &["Broadcast", "SwapDiagonal", "SwapX", "SwapY"];

/// True for a built-in function of any kind.
pub fn is_builtin(name: &str) -> bool {
    let among = |word: &str, names: &[&str]| name.strip_prefix(word).is_some_and(|rest| names.contains(&rest));
    OWN.contains(&name) || of_glsl(name).is_some() || among("subgroup", OF_SUBGROUPS) || among("quad", OF_QUADS)
}

/// Which way the arguments carry their values.
pub(super) fn directions(name: &str, count: usize) -> Vec<Direction> {
    let first = if name.starts_with("atomic") && name != "atomicLoad" { Direction::InOut } else { Direction::In };
    (0..count).map(|i| if i == 0 { first } else { Direction::In }).collect()
}

/// What a function returns that works on numbers, when its arguments agree on a component type.
pub(super) fn number(function: F, args: &[Type]) -> Type {
    let first = args.first().cloned().unwrap_or(Type::Error);
    // A vector decides over scalars beside it.
    let widest = args.iter().find(|t| matches!(t, Type::Vector(..))).cloned().unwrap_or_else(|| first.clone());
    let part = || first.scalar().map_or(Type::Error, Type::Scalar);
    match function {
        F::Dot => part(),
        F::Length | F::Distance | F::Determinant => Type::FLOAT,
        F::Any | F::All => Type::BOOL,
        F::Transpose => match first {
            Type::Matrix(s, c, r) => Type::Matrix(s, r, c),
            _ => Type::Error,
        },
        F::PackHalf2x16 | F::PackSnorm2x16 | F::PackUnorm2x16 | F::PackSnorm4x8 | F::PackUnorm4x8 => Type::UINT,
        F::UnpackHalf2x16 | F::UnpackSnorm2x16 | F::UnpackUnorm2x16 => Type::VEC2,
        F::UnpackSnorm4x8 | F::UnpackUnorm4x8 => Type::VEC4,
        F::BitfieldExtract | F::BitfieldInsert | F::Ldexp | F::Refract => first,
        _ => widest,
    }
}

/// What a function of section 17 returns that GLSL does not have.
pub(super) fn own(name: &str, args: &[Type]) -> Type {
    let first = args.first().cloned().unwrap_or(Type::Error);
    match name {
        "arrayLength" | "textureNumLayers" | "textureNumLevels" | "textureNumSamples" | "dot4U8Packed" | "pack4xI8"
        | "pack4xU8" | "pack4xI8Clamp" | "pack4xU8Clamp" => Type::UINT,
        "dot4I8Packed" => Type::INT,
        "unpack4xI8" => Type::Vector(ScalarType::Int, 4),
        "unpack4xU8" => Type::Vector(ScalarType::Uint, 4),
        "atomicStore" | "storageBarrier" | "textureBarrier" | "textureStore" | "workgroupBarrier" => Type::Void,
        "saturate" | "quantizeToF16" | "countLeadingZeros" | "countTrailingZeros" | "workgroupUniformLoad" => first,
        "atomicAdd" | "atomicAnd" | "atomicExchange" | "atomicLoad" | "atomicMax" | "atomicMin" | "atomicOr"
        | "atomicSub" | "atomicXor" => first,
        "textureSampleCompare" | "textureSampleCompareLevel" => Type::FLOAT,
        "textureGather" => match args {
            [Type::Opaque(_), ..] => Type::VEC4,
            [_, Type::Opaque(texture), ..] => Type::Vector(texture.scalar, 4),
            _ => Type::Error,
        },
        "textureGatherCompare" => Type::VEC4,
        "textureDimensions" => match first {
            Type::Opaque(texture) => dimensions(texture),
            _ => Type::Error,
        },
        _ if name.starts_with("textureSample") || name == "textureLoad" => match first {
            Type::Opaque(texture) if texture.shadow => Type::FLOAT,
            Type::Opaque(texture) => Type::Vector(texture.scalar, 4),
            _ => Type::Error,
        },
        _ => Type::Error,
    }
}

fn dimensions(texture: OpaqueType) -> Type {
    match (texture.kind, texture.dim) {
        (OpaqueKind::AtomicCounter, _) => Type::Error,
        (_, TextureDim::D1 | TextureDim::Buffer) => Type::UINT,
        (_, TextureDim::D2 | TextureDim::Cube | TextureDim::Rect | TextureDim::Subpass) => {
            Type::Vector(ScalarType::Uint, 2)
        }
        (_, TextureDim::D3) => Type::Vector(ScalarType::Uint, 3),
    }
}
