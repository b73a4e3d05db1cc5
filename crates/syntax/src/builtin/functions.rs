//! Built-in functions as a table, spread into concrete signatures once.

use std::collections::HashMap;
use std::fmt;
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

/// Functions with what their overloads look like: component types, sizes, form. In the form `T` is the vector of the
/// size and component type, `S` its component, `B`, `I`, `U`, `F` the `bvec`, `ivec`, `uvec`, `vec` of that size, `I16`,
/// `U16`, `F16` the same of 16 bits; anything else is a type by its name. Component types: f(loat) d(ouble) i(nt) u(int)
/// b(ool), and those of extensions: h(alf), c(har) s(hort) l(ong), and C S L without a sign.
macro_rules! functions {
    ($($($variant:ident $name:literal),* : $([$kinds:literal $sizes:literal $form:literal])*;)*) => {
        /// A built-in function, with all its overloads. What a call of one means is decided by this, and not by a name.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum BuiltinFunction {
            $($(#[doc = concat!("`", $name, "`")] $variant,)*)*
        }

        impl BuiltinFunction {
            /// All of them, in the order of the specification; those of textures come last.
            pub const ALL: &'static [Self] = &[$($(Self::$variant,)*)*];

            /// The name in GLSL.
            pub fn name(self) -> &'static str {
                match self {
                    $($(Self::$variant => $name,)*)*
                }
            }
        }

        /// Names, and the overloads that they share.
        const TABLE: &[(&[&str], &[[&str; 3]])] = &[$((&[$($name),*], &[$([$kinds, $sizes, $form]),*]),)*];
    };
}

functions! {
    // 8.1 angles and trigonometry
    Radians "radians", Degrees "degrees", Sin "sin", Cos "cos", Tan "tan", Asin "asin", Acos "acos", Sinh "sinh",
    Cosh "cosh", Tanh "tanh", Asinh "asinh", Acosh "acosh", Atanh "atanh": ["fh" "1234" "T(T)"];
    Atan "atan": ["fh" "1234" "T(T)"] ["fh" "1234" "T(T,T)"];
    // 8.2 exponentials
    Pow "pow": ["fh" "1234" "T(T,T)"];
    Exp "exp", Log "log", Exp2 "exp2", Log2 "log2": ["fh" "1234" "T(T)"];
    Sqrt "sqrt", Inversesqrt "inversesqrt": ["fdh" "1234" "T(T)"];
    // 8.3 common functions
    Abs "abs", Sign "sign": ["fdihcsl" "1234" "T(T)"];
    Floor "floor", Trunc "trunc", Round "round", RoundEven "roundEven", Ceil "ceil",
    Fract "fract": ["fdh" "1234" "T(T)"];
    Mod "mod": ["fdh" "1234" "T(T,T)"] ["fdh" "234" "T(T,S)"];
    Modf "modf": ["fdh" "1234" "T(T,out T)"];
    Min "min", Max "max": ["fdiuhcCsSlL" "1234" "T(T,T)"] ["fdiuhcCsSlL" "234" "T(T,S)"];
    Clamp "clamp": ["fdiuhcCsSlL" "1234" "T(T,T,T)"] ["fdiuhcCsSlL" "234" "T(T,S,S)"];
    Mix "mix": ["fdh" "1234" "T(T,T,T)"] ["fdh" "234" "T(T,T,S)"] ["fdiubhcCsSlL" "1234" "T(T,T,B)"];
    Step "step": ["fdh" "1234" "T(T,T)"] ["fdh" "234" "T(S,T)"];
    Smoothstep "smoothstep": ["fdh" "1234" "T(T,T,T)"] ["fdh" "234" "T(S,S,T)"];
    Isnan "isnan", Isinf "isinf": ["fdh" "1234" "B(T)"];
    FloatBitsToInt "floatBitsToInt": ["f" "1234" "I(T)"];
    FloatBitsToUint "floatBitsToUint": ["f" "1234" "U(T)"];
    IntBitsToFloat "intBitsToFloat": ["i" "1234" "F(T)"];
    UintBitsToFloat "uintBitsToFloat": ["u" "1234" "F(T)"];
    Fma "fma": ["fdh" "1234" "T(T,T,T)"];
    Frexp "frexp": ["fdh" "1234" "T(T,out I)"];
    Ldexp "ldexp": ["fdh" "1234" "T(T,I)"];
    // 8.4 packing
    PackUnorm2x16 "packUnorm2x16", PackSnorm2x16 "packSnorm2x16", PackHalf2x16 "packHalf2x16": ["f" "1" "uint(vec2)"];
    PackUnorm4x8 "packUnorm4x8", PackSnorm4x8 "packSnorm4x8": ["f" "1" "uint(vec4)"];
    UnpackUnorm2x16 "unpackUnorm2x16", UnpackSnorm2x16 "unpackSnorm2x16",
    UnpackHalf2x16 "unpackHalf2x16": ["f" "1" "vec2(uint)"];
    UnpackUnorm4x8 "unpackUnorm4x8", UnpackSnorm4x8 "unpackSnorm4x8": ["f" "1" "vec4(uint)"];
    PackDouble2x32 "packDouble2x32": ["f" "1" "double(uvec2)"];
    UnpackDouble2x32 "unpackDouble2x32": ["f" "1" "uvec2(double)"];
    // GL_EXT_shader_explicit_arithmetic_types, 8.4
    Pack16 "pack16": ["c" "2" "int16_t(T)"] ["C" "2" "uint16_t(T)"];
    Pack32 "pack32": ["c" "4" "int(T)"] ["C" "4" "uint(T)"] ["s" "2" "int(T)"] ["S" "2" "uint(T)"];
    Unpack8 "unpack8": ["s" "1" "i8vec2(T)"] ["S" "1" "u8vec2(T)"] ["i" "1" "i8vec4(T)"] ["u" "1" "u8vec4(T)"];
    Unpack16 "unpack16": ["i" "1" "i16vec2(T)"] ["u" "1" "u16vec2(T)"];
    PackFloat2x16 "packFloat2x16": ["h" "2" "uint(T)"];
    UnpackFloat2x16 "unpackFloat2x16": ["u" "1" "f16vec2(T)"];
    Float16BitsToInt16 "float16BitsToInt16", HalfBitsToInt16 "halfBitsToInt16": ["h" "1234" "I16(T)"];
    Float16BitsToUint16 "float16BitsToUint16", HalfBitsToUint16 "halfBitsToUint16": ["h" "1234" "U16(T)"];
    Int16BitsToFloat16 "int16BitsToFloat16", Int16BitsToHalf "int16BitsToHalf": ["s" "1234" "F16(T)"];
    Uint16BitsToFloat16 "uint16BitsToFloat16", Uint16BitsToHalf "uint16BitsToHalf": ["S" "1234" "F16(T)"];
    // 8.5 geometric functions
    Length "length": ["fdh" "1234" "S(T)"];
    Distance "distance", Dot "dot": ["fdh" "1234" "S(T,T)"];
    Cross "cross": ["fdh" "3" "T(T,T)"];
    Normalize "normalize": ["fdh" "1234" "T(T)"];
    Faceforward "faceforward": ["fdh" "1234" "T(T,T,T)"];
    Reflect "reflect": ["fdh" "1234" "T(T,T)"];
    Refract "refract": ["fdh" "1234" "T(T,T,S)"];
    Ftransform "ftransform": ["f" "1" "vec4()"];
    // 8.6 matrices; their forms follow from the sizes
    MatrixCompMult "matrixCompMult", OuterProduct "outerProduct", Transpose "transpose", Determinant "determinant",
    Inverse "inverse":;
    // 8.7 vector relations
    LessThan "lessThan", LessThanEqual "lessThanEqual", GreaterThan "greaterThan",
    GreaterThanEqual "greaterThanEqual": ["fdiuhcCsSlL" "234" "B(T,T)"];
    Equal "equal", NotEqual "notEqual": ["fdiubhcCsSlL" "234" "B(T,T)"];
    Any "any", All "all": ["b" "234" "bool(T)"];
    Not "not": ["b" "234" "T(T)"];
    // 8.8 integers
    UaddCarry "uaddCarry", UsubBorrow "usubBorrow": ["u" "1234" "T(T,T,out T)"];
    UmulExtended "umulExtended": ["u" "1234" "void(T,T,out T,out T)"];
    ImulExtended "imulExtended": ["i" "1234" "void(T,T,out T,out T)"];
    BitfieldExtract "bitfieldExtract": ["iu" "1234" "T(T,int,int)"];
    BitfieldInsert "bitfieldInsert": ["iu" "1234" "T(T,T,int,int)"];
    BitfieldReverse "bitfieldReverse": ["iu" "1234" "T(T)"];
    BitCount "bitCount", FindLSB "findLSB", FindMSB "findMSB": ["iulL" "1234" "I(T)"];
    // 8.10 and 8.11 atomics
    AtomicCounter "atomicCounter", AtomicCounterIncrement "atomicCounterIncrement",
    AtomicCounterDecrement "atomicCounterDecrement": ["u" "1" "uint(atomic_uint)"];
    AtomicAdd "atomicAdd", AtomicMin "atomicMin", AtomicMax "atomicMax", AtomicAnd "atomicAnd", AtomicOr "atomicOr",
    AtomicXor "atomicXor",
    AtomicExchange "atomicExchange": ["iulL" "1" "T(inout T,T)"] ["iulL" "1" "T(inout T,T,int,int,int)"];
    AtomicCompSwap "atomicCompSwap": ["iulL" "1" "T(inout T,T,T)"] ["iulL" "1" "T(inout T,T,T,int,int,int,int,int)"];
    // GL_KHR_memory_scope_semantics
    AtomicLoad "atomicLoad": ["iulL" "1" "T(inout T,int,int,int)"];
    AtomicStore "atomicStore": ["iulL" "1" "void(inout T,T,int,int,int)"];
    AtomicCounterAdd "atomicCounterAdd", AtomicCounterSubtract "atomicCounterSubtract",
    AtomicCounterMin "atomicCounterMin", AtomicCounterMax "atomicCounterMax", AtomicCounterAnd "atomicCounterAnd",
    AtomicCounterOr "atomicCounterOr", AtomicCounterXor "atomicCounterXor",
    AtomicCounterExchange "atomicCounterExchange": ["u" "1" "uint(atomic_uint,uint)"];
    AtomicCounterCompSwap "atomicCounterCompSwap": ["u" "1" "uint(atomic_uint,uint,uint)"];
    // 8.13 fragments
    DFdx "dFdx", DFdy "dFdy", Fwidth "fwidth", DFdxFine "dFdxFine", DFdyFine "dFdyFine", FwidthFine "fwidthFine",
    DFdxCoarse "dFdxCoarse", DFdyCoarse "dFdyCoarse", FwidthCoarse "fwidthCoarse": ["f" "1234" "T(T)"];
    InterpolateAtCentroid "interpolateAtCentroid": ["f" "1234" "T(T)"];
    InterpolateAtSample "interpolateAtSample": ["f" "1234" "T(T,int)"];
    InterpolateAtOffset "interpolateAtOffset": ["f" "1234" "T(T,vec2)"];
    // 8.14 noise
    Noise1 "noise1": ["f" "1234" "float(T)"];
    Noise2 "noise2": ["f" "1234" "vec2(T)"];
    Noise3 "noise3": ["f" "1234" "vec3(T)"];
    Noise4 "noise4": ["f" "1234" "vec4(T)"];
    // 8.15 geometry, 8.16 and 8.17 barriers
    EmitVertex "EmitVertex", EndPrimitive "EndPrimitive": ["f" "1" "void()"];
    EmitStreamVertex "EmitStreamVertex", EndStreamPrimitive "EndStreamPrimitive": ["f" "1" "void(int)"];
    MemoryBarrier "memoryBarrier": ["f" "1" "void()"] ["f" "1" "void(int,int,int)"];
    ControlBarrier "controlBarrier": ["f" "1" "void(int,int,int,int)"];
    Barrier "barrier", MemoryBarrierAtomicCounter "memoryBarrierAtomicCounter",
    MemoryBarrierBuffer "memoryBarrierBuffer", MemoryBarrierShared "memoryBarrierShared",
    MemoryBarrierImage "memoryBarrierImage", GroupMemoryBarrier "groupMemoryBarrier": ["f" "1" "void()"];
    // 8.19 group votes
    AnyInvocation "anyInvocation", AllInvocations "allInvocations", AllInvocationsEqual "allInvocationsEqual",
    AnyInvocationARB "anyInvocationARB", AllInvocationsARB "allInvocationsARB",
    AllInvocationsEqualARB "allInvocationsEqualARB": ["f" "1" "bool(bool)"];
    // GL_KHR_shader_subgroup
    SubgroupBarrier "subgroupBarrier", SubgroupMemoryBarrier "subgroupMemoryBarrier",
    SubgroupMemoryBarrierBuffer "subgroupMemoryBarrierBuffer",
    SubgroupMemoryBarrierShared "subgroupMemoryBarrierShared",
    SubgroupMemoryBarrierImage "subgroupMemoryBarrierImage": ["f" "1" "void()"];
    SubgroupElect "subgroupElect": ["f" "1" "bool()"];
    SubgroupAll "subgroupAll", SubgroupAny "subgroupAny": ["f" "1" "bool(bool)"];
    SubgroupAllEqual "subgroupAllEqual": ["fdiubhcCsSlL" "1234" "bool(T)"];
    SubgroupBroadcastFirst "subgroupBroadcastFirst", SubgroupQuadSwapHorizontal "subgroupQuadSwapHorizontal",
    SubgroupQuadSwapVertical "subgroupQuadSwapVertical",
    SubgroupQuadSwapDiagonal "subgroupQuadSwapDiagonal": ["fdiubhcCsSlL" "1234" "T(T)"];
    SubgroupBroadcast "subgroupBroadcast", SubgroupShuffle "subgroupShuffle", SubgroupShuffleXor "subgroupShuffleXor",
    SubgroupShuffleUp "subgroupShuffleUp", SubgroupShuffleDown "subgroupShuffleDown",
    SubgroupRotate "subgroupRotate", SubgroupQuadBroadcast "subgroupQuadBroadcast": ["fdiubhcCsSlL" "1234" "T(T,uint)"];
    SubgroupClusteredRotate "subgroupClusteredRotate": ["fdiubhcCsSlL" "1234" "T(T,uint,uint)"];
    SubgroupBallot "subgroupBallot": ["f" "1" "uvec4(bool)"];
    SubgroupInverseBallot "subgroupInverseBallot": ["f" "1" "bool(uvec4)"];
    SubgroupBallotBitExtract "subgroupBallotBitExtract": ["f" "1" "bool(uvec4,uint)"];
    SubgroupBallotBitCount "subgroupBallotBitCount", SubgroupBallotInclusiveBitCount "subgroupBallotInclusiveBitCount",
    SubgroupBallotExclusiveBitCount "subgroupBallotExclusiveBitCount", SubgroupBallotFindLSB "subgroupBallotFindLSB",
    SubgroupBallotFindMSB "subgroupBallotFindMSB": ["f" "1" "uint(uvec4)"];
    SubgroupAdd "subgroupAdd", SubgroupMul "subgroupMul", SubgroupMin "subgroupMin", SubgroupMax "subgroupMax",
    SubgroupInclusiveAdd "subgroupInclusiveAdd", SubgroupInclusiveMul "subgroupInclusiveMul",
    SubgroupInclusiveMin "subgroupInclusiveMin", SubgroupInclusiveMax "subgroupInclusiveMax",
    SubgroupExclusiveAdd "subgroupExclusiveAdd", SubgroupExclusiveMul "subgroupExclusiveMul",
    SubgroupExclusiveMin "subgroupExclusiveMin",
    SubgroupExclusiveMax "subgroupExclusiveMax": ["fdiuhcCsSlL" "1234" "T(T)"];
    SubgroupAnd "subgroupAnd", SubgroupOr "subgroupOr", SubgroupXor "subgroupXor",
    SubgroupInclusiveAnd "subgroupInclusiveAnd", SubgroupInclusiveOr "subgroupInclusiveOr",
    SubgroupInclusiveXor "subgroupInclusiveXor", SubgroupExclusiveAnd "subgroupExclusiveAnd",
    SubgroupExclusiveOr "subgroupExclusiveOr",
    SubgroupExclusiveXor "subgroupExclusiveXor": ["iubcCsSlL" "1234" "T(T)"];
    SubgroupClusteredAdd "subgroupClusteredAdd", SubgroupClusteredMul "subgroupClusteredMul",
    SubgroupClusteredMin "subgroupClusteredMin",
    SubgroupClusteredMax "subgroupClusteredMax": ["fdiuhcCsSlL" "1234" "T(T,uint)"];
    SubgroupClusteredAnd "subgroupClusteredAnd", SubgroupClusteredOr "subgroupClusteredOr",
    SubgroupClusteredXor "subgroupClusteredXor": ["iubcCsSlL" "1234" "T(T,uint)"];
    // 8.9 textures and 8.12 images; their forms follow from the types of samplers and images
    TextureSize "textureSize", TextureQueryLevels "textureQueryLevels", TextureQueryLod "textureQueryLod",
    SubpassLoad "subpassLoad", TextureSamples "textureSamples", TexelFetch "texelFetch", TexelFetchOffset "texelFetchOffset", Texture "texture",
    TextureOffset "textureOffset", TextureLod "textureLod", TextureLodOffset "textureLodOffset",
    TextureGrad "textureGrad", TextureGradOffset "textureGradOffset", TextureProj "textureProj",
    TextureProjOffset "textureProjOffset", TextureProjLod "textureProjLod",
    TextureProjLodOffset "textureProjLodOffset", TextureProjGrad "textureProjGrad",
    TextureProjGradOffset "textureProjGradOffset", TextureGather "textureGather",
    TextureGatherOffset "textureGatherOffset", TextureGatherOffsets "textureGatherOffsets", Texture1D "texture1D",
    Texture1DProj "texture1DProj", Texture2D "texture2D", Texture2DProj "texture2DProj", Texture3D "texture3D",
    Texture3DProj "texture3DProj", TextureCube "textureCube", Texture1DLod "texture1DLod",
    Texture1DProjLod "texture1DProjLod", Texture2DLod "texture2DLod", Texture2DLodEXT "texture2DLodEXT",
    Texture2DProjLod "texture2DProjLod", Texture3DLod "texture3DLod", Texture3DProjLod "texture3DProjLod",
    TextureCubeLod "textureCubeLod", TextureCubeLodEXT "textureCubeLodEXT", Texture1DGradARB "texture1DGradARB",
    Texture2DGradARB "texture2DGradARB", Texture2DGradEXT "texture2DGradEXT", Texture3DGradARB "texture3DGradARB",
    TextureCubeGradARB "textureCubeGradARB", TextureCubeGradEXT "textureCubeGradEXT", Texture2DRect "texture2DRect",
    Texture2DRectProj "texture2DRectProj", Texture2DArray "texture2DArray", Texture1DArray "texture1DArray",
    Shadow1D "shadow1D", Shadow1DProj "shadow1DProj", Shadow2D "shadow2D", Shadow2DProj "shadow2DProj",
    Shadow1DLod "shadow1DLod", Shadow1DProjLod "shadow1DProjLod", Shadow2DLod "shadow2DLod",
    Shadow2DProjLod "shadow2DProjLod", Shadow2DRect "shadow2DRect", Shadow2DRectProj "shadow2DRectProj",
    ImageSamples "imageSamples", ImageSize "imageSize", ImageLoad "imageLoad", ImageStore "imageStore",
    ImageAtomicExchange "imageAtomicExchange", ImageAtomicAdd "imageAtomicAdd", ImageAtomicMin "imageAtomicMin",
    ImageAtomicMax "imageAtomicMax", ImageAtomicAnd "imageAtomicAnd", ImageAtomicOr "imageAtomicOr",
    ImageAtomicXor "imageAtomicXor", ImageAtomicCompSwap "imageAtomicCompSwap":;
}

impl BuiltinFunction {
    /// The function of that name, in whichever version has one.
    pub fn from_name(name: &str) -> Option<Self> {
        static NAMES: OnceLock<HashMap<&'static str, BuiltinFunction>> = OnceLock::new();
        NAMES.get_or_init(|| Self::ALL.iter().map(|&function| (function.name(), function)).collect()).get(name).copied()
    }
}

impl fmt::Display for BuiltinFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Overloads by the name of the function.
pub(super) type Table = HashMap<&'static str, Vec<Signature>>;

fn table() -> &'static Table {
    static TABLE_CELL: OnceLock<Table> = OnceLock::new();
    TABLE_CELL.get_or_init(|| {
        let mut all = Table::new();
        for (names, forms) in TABLE {
            for [kinds, sizes, form] in *forms {
                for (kind, size) in kinds.chars().flat_map(|kind| sizes.bytes().map(move |size| (kind, size))) {
                    let signature = spread(form, scalar(kind), size - b'0');
                    names.iter().for_each(|name| all.entry(name).or_default().push(signature.clone()));
                }
            }
        }
        matrices(&mut all);
        textures::add(&mut all);
        all
    })
}

/// The signatures of a built-in function; none when there is no such function. `float` forms
/// come before `double` ones, and those of extensions last.
pub(crate) fn functions(name: &str) -> &'static [Signature] {
    table().get(name).map_or(&[], Vec::as_slice)
}

/// Names of all built-in functions.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    BuiltinFunction::ALL.iter().map(|function| function.name())
}

fn scalar(kind: char) -> ScalarType {
    match kind {
        'd' => ScalarType::Double,
        'i' => ScalarType::Int,
        'u' => ScalarType::Uint,
        'b' => ScalarType::Bool,
        'h' => ScalarType::Half,
        'c' => ScalarType::Int8,
        'C' => ScalarType::Uint8,
        's' => ScalarType::Int16,
        'S' => ScalarType::Uint16,
        'l' => ScalarType::Int64,
        'L' => ScalarType::Uint64,
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
        "I16" => Type::vector(ScalarType::Int16, size),
        "U16" => Type::vector(ScalarType::Uint16, size),
        "F16" => Type::vector(ScalarType::Half, size),
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
    for s in [ScalarType::Float, ScalarType::Double, ScalarType::Half] {
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
    fn every_function_has_overloads_and_is_found_by_its_name() {
        for &function in BuiltinFunction::ALL {
            assert!(!functions(function.name()).is_empty(), "{function}");
            assert_eq!(BuiltinFunction::from_name(function.name()), Some(function));
        }
        assert_eq!(table().len(), BuiltinFunction::ALL.len());
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
