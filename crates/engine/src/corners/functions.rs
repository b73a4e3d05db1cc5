//! From the built-in functions and operators of each language to their rows: one that has none does not compile.

use judge::profile::Op;
use naga::{BinaryOperator, MathFunction, UnaryOperator};
use syntax::BuiltinFunction;

/// Names of rows.
type Names = &'static [&'static str];

/// Defines a match on all variants of an enum, many in a line: `VARIANT ..: ROW ..;`.
macro_rules! rows {
    ($(#[$doc:meta])* $name:ident($of:ident) $($($variant:ident)+ : $($row:literal)*;)*) => {
        $(#[$doc])*
        pub fn $name(of: $of) -> Names {
            match of {
                $($($of::$variant)|+ => &[$($row),*],)*
            }
        }
    };
}

rows! {
    /// Those of a function of GLSL.
    of_function(BuiltinFunction)
    Radians: "radians"; Degrees: "degrees"; Sin: "sin"; Cos: "cos"; Tan: "tan"; Asin: "asin"; Acos: "acos";
    Sinh: "sinh"; Cosh: "cosh"; Tanh: "tanh"; Asinh: "asinh"; Acosh: "acosh"; Atanh: "atanh"; Atan: "atan" "atan2";
    Pow: "pow"; Exp: "exp"; Log: "log"; Exp2: "exp2"; Log2: "log2"; Sqrt: "sqrt"; Inversesqrt: "inversesqrt";
    Abs: "abs" "abs of int"; Sign: "sign" "sign of int"; Floor: "floor"; Trunc: "trunc"; Round: "round";
    RoundEven: "roundEven"; Ceil: "ceil"; Fract: "fract"; Mod: "mod"; Modf: "fraction of modf" "whole of modf";
    Min: "min" "min of int"; Max: "max" "max of uint"; Clamp: "clamp" "clamp of int"; Mix: "mix" "select";
    Step: "step"; Smoothstep: "smoothstep"; Isnan: "isnan"; Isinf: "isinf";
    FloatBitsToInt FloatBitsToUint: "bits of float"; IntBitsToFloat UintBitsToFloat: "float of bits"; Fma: "fma";
    Frexp: "fraction of frexp" "exponent of frexp"; Ldexp: "ldexp"; PackUnorm2x16: "packUnorm2x16";
    PackSnorm2x16: "packSnorm2x16"; PackHalf2x16: "packHalf2x16"; PackUnorm4x8: "packUnorm4x8";
    PackSnorm4x8: "packSnorm4x8"; UnpackUnorm2x16: "unpackUnorm2x16"; UnpackSnorm2x16: "unpackSnorm2x16";
    UnpackHalf2x16: "unpackHalf2x16"; UnpackUnorm4x8: "unpackUnorm4x8"; UnpackSnorm4x8: "unpackSnorm4x8";
    Length: "length"; Distance: "distance"; Dot: "dot"; Cross: "cross"; Normalize: "normalize";
    Faceforward: "faceforward"; Reflect: "reflect"; Refract: "refract"; MatrixCompMult OuterProduct: "*";
    Determinant: "determinant"; Inverse: "inverse"; LessThan: "<" "< of int" "< of uint"; LessThanEqual: "<=";
    GreaterThan: ">"; GreaterThanEqual: ">="; Equal: "=="; NotEqual: "!="; UaddCarry: "uaddCarry";
    UsubBorrow: "usubBorrow"; UmulExtended: "* of uint"; ImulExtended: "* of int";
    BitfieldExtract: "bitfieldExtract" "bitfieldExtract of int"; BitfieldInsert: "bitfieldInsert";
    BitfieldReverse: "bitfieldReverse"; BitCount: "bitCount"; FindLSB: "findLSB"; FindMSB: "findMSB";
    // Truth values, and components that change places.
    Transpose Any All Not:;
    // Numbers of 8, 16 and 64 bits: no lane but the embedded one runs them.
    PackDouble2x32 UnpackDouble2x32 Pack16 Pack32 Unpack8 Unpack16 Float16BitsToInt16 HalfBitsToInt16
    Float16BitsToUint16 HalfBitsToUint16 Int16BitsToFloat16 Int16BitsToHalf Uint16BitsToFloat16 Uint16BitsToHalf
    PackFloat2x16 UnpackFloat2x16:;
    // Memory: the order of invocations decides, and the sums wrap as those of integers do.
    AtomicCounter AtomicCounterIncrement AtomicCounterDecrement AtomicAdd AtomicMin AtomicMax AtomicAnd AtomicOr
    AtomicXor AtomicExchange AtomicCompSwap AtomicLoad AtomicStore AtomicCounterAdd AtomicCounterSubtract
    AtomicCounterMin AtomicCounterMax AtomicCounterAnd AtomicCounterOr AtomicCounterXor AtomicCounterExchange
    AtomicCounterCompSwap:;
    // Neighbours, and what a stage does.
    Ftransform DFdx DFdy Fwidth DFdxFine DFdyFine FwidthFine DFdxCoarse DFdyCoarse FwidthCoarse InterpolateAtCentroid
    InterpolateAtSample InterpolateAtOffset Noise1 Noise2 Noise3 Noise4 EmitVertex EndPrimitive EmitStreamVertex
    EndStreamPrimitive Barrier ControlBarrier MemoryBarrier MemoryBarrierAtomicCounter MemoryBarrierBuffer
    MemoryBarrierShared MemoryBarrierImage GroupMemoryBarrier:;
    // Invocations of a group.
    AnyInvocation AllInvocations AllInvocationsEqual AnyInvocationARB AllInvocationsARB AllInvocationsEqualARB
    SubgroupBarrier SubgroupMemoryBarrier SubgroupMemoryBarrierBuffer SubgroupMemoryBarrierShared
    SubgroupMemoryBarrierImage SubgroupElect SubgroupAll SubgroupAny SubgroupAllEqual SubgroupBroadcastFirst
    SubgroupQuadSwapHorizontal SubgroupQuadSwapVertical SubgroupQuadSwapDiagonal SubgroupBroadcast SubgroupShuffle
    SubgroupShuffleXor SubgroupShuffleUp SubgroupShuffleDown SubgroupRotate SubgroupQuadBroadcast
    SubgroupClusteredRotate SubgroupBallot SubgroupInverseBallot SubgroupBallotBitExtract SubgroupBallotBitCount
    SubgroupBallotInclusiveBitCount SubgroupBallotExclusiveBitCount SubgroupBallotFindLSB SubgroupBallotFindMSB
    SubgroupAdd SubgroupMul SubgroupMin SubgroupMax SubgroupInclusiveAdd SubgroupInclusiveMul SubgroupInclusiveMin
    SubgroupInclusiveMax SubgroupExclusiveAdd SubgroupExclusiveMul SubgroupExclusiveMin SubgroupExclusiveMax SubgroupAnd
    SubgroupOr SubgroupXor SubgroupInclusiveAnd SubgroupInclusiveOr SubgroupInclusiveXor SubgroupExclusiveAnd
    SubgroupExclusiveOr SubgroupExclusiveXor SubgroupClusteredAdd SubgroupClusteredMul SubgroupClusteredMin
    SubgroupClusteredMax SubgroupClusteredAnd SubgroupClusteredOr SubgroupClusteredXor:;
    // Textures and images: `texture` has their edges.
    TextureSize TextureQueryLevels TextureQueryLod TextureSamples SubpassLoad TexelFetch TexelFetchOffset Texture TextureOffset
    TextureLod TextureLodOffset TextureGrad TextureGradOffset TextureProj TextureProjOffset TextureProjLod
    TextureProjLodOffset TextureProjGrad TextureProjGradOffset TextureGather TextureGatherOffset TextureGatherOffsets
    Texture1D Texture1DProj Texture2D Texture2DProj Texture3D Texture3DProj TextureCube Texture1DLod Texture1DProjLod
    Texture2DLod Texture2DLodEXT Texture2DProjLod Texture3DLod Texture3DProjLod TextureCubeLod TextureCubeLodEXT
    Texture1DGradARB Texture2DGradARB Texture2DGradEXT Texture3DGradARB TextureCubeGradARB TextureCubeGradEXT
    Texture2DRect Texture2DRectProj Texture2DArray Texture1DArray Shadow1D Shadow1DProj Shadow2D Shadow2DProj
    Shadow1DLod Shadow1DProjLod Shadow2DLod Shadow2DProjLod Shadow2DRect Shadow2DRectProj ImageSamples ImageSize
    ImageLoad ImageStore ImageAtomicExchange ImageAtomicAdd ImageAtomicMin ImageAtomicMax ImageAtomicAnd ImageAtomicOr
    ImageAtomicXor ImageAtomicCompSwap:;
}

rows! {
    /// Those of a function of WGSL, and of SPIR-V that is read.
    of_math(MathFunction)
    Abs: "abs" "abs of int"; Min: "min" "min of int"; Max: "max" "max of uint"; Clamp: "clamp" "clamp of int";
    Saturate: "saturate"; Cos: "cos"; Cosh: "cosh"; Sin: "sin"; Sinh: "sinh"; Tan: "tan"; Tanh: "tanh"; Acos: "acos";
    Asin: "asin"; Atan: "atan"; Atan2: "atan2"; Asinh: "asinh"; Acosh: "acosh"; Atanh: "atanh"; Radians: "radians";
    Degrees: "degrees"; Ceil: "ceil"; Floor: "floor"; Round: "roundEven"; Fract: "fract"; Trunc: "trunc";
    Modf: "fraction of modf" "whole of modf"; Frexp: "fraction of frexp" "exponent of frexp"; Ldexp: "ldexp";
    Exp: "exp"; Exp2: "exp2"; Log: "log"; Log2: "log2"; Pow: "pow"; Dot: "dot"; Dot4I8Packed: "dot4I8Packed";
    Dot4U8Packed: "dot4U8Packed"; Outer: "*"; Cross: "cross"; Distance: "distance"; Length: "length";
    Normalize: "normalize"; FaceForward: "faceforward"; Reflect: "reflect"; Refract: "refract";
    Sign: "sign" "sign of int"; Fma: "fma"; Mix: "mix"; Step: "step"; SmoothStep: "smoothstep"; Sqrt: "sqrt";
    InverseSqrt: "inversesqrt"; Inverse: "inverse"; Determinant: "determinant"; QuantizeToF16: "quantizeToF16";
    CountTrailingZeros: "countTrailingZeros"; CountLeadingZeros: "countLeadingZeros"; CountOneBits: "bitCount";
    ReverseBits: "bitfieldReverse"; ExtractBits: "extractBits" "extractBits of int"; InsertBits: "insertBits";
    FirstTrailingBit: "findLSB"; FirstLeadingBit: "findMSB" "firstLeadingBit of uint"; Pack4x8snorm: "packSnorm4x8";
    Pack4x8unorm: "packUnorm4x8"; Pack2x16snorm: "packSnorm2x16"; Pack2x16unorm: "packUnorm2x16";
    Pack2x16float: "packHalf2x16"; Pack4xI8: "pack4xI8"; Pack4xU8: "pack4xU8"; Pack4xI8Clamp: "pack4xI8Clamp";
    Pack4xU8Clamp: "pack4xU8Clamp"; Unpack4x8snorm: "unpackSnorm4x8"; Unpack4x8unorm: "unpackUnorm4x8";
    Unpack2x16snorm: "unpackSnorm2x16"; Unpack2x16unorm: "unpackUnorm2x16"; Unpack2x16float: "unpackHalf2x16";
    Unpack4xI8: "unpack4xI8"; Unpack4xU8: "unpack4xU8";
    // Components that change places.
    Transpose:;
}

rows! {
    /// Those of an operator with two operands, with what a conversion does beside it.
    of_binary(BinaryOperator)
    Add: "+" "+ of int" "+ of uint"; Subtract: "-" "- of int" "- of uint";
    Multiply: "*" "* of int" "* of uint" "matrix * vector"; Divide: "/" "/ of int" "/ of uint";
    Modulo: "remainder" "% of int" "% of uint"; Equal: "=="; NotEqual: "!="; Less: "<" "< of int" "< of uint";
    LessEqual: "<="; Greater: ">"; GreaterEqual: ">="; And: "&"; ExclusiveOr: "^"; InclusiveOr: "|"; ShiftLeft: "<<";
    ShiftRight: ">>" ">> of int";
    // Truth values.
    LogicalAnd LogicalOr:;
}

rows! {
    /// Those of an operator with one operand.
    of_unary(UnaryOperator)
    Negate: "negate" "negate int"; BitwiseNot: "~";
    // Truth values.
    LogicalNot:;
}

rows! {
    /// Those of an operation that profiles bound.
    of_operation(Op)
    Add: "+"; Sub: "-"; Mul: "*"; Div: "/"; Rem: "remainder"; Mod: "mod"; Fma: "fma"; Neg: "negate"; Abs: "abs";
    Sign: "sign"; Min: "min"; Max: "max"; Step: "step"; Floor: "floor"; Ceil: "ceil"; Trunc: "trunc";
    RoundEven: "round" "roundEven"; Fract: "fract"; Ldexp: "ldexp"; Sqrt: "sqrt"; InverseSqrt: "inversesqrt";
    Radians: "radians"; Degrees: "degrees"; Sin: "sin"; Cos: "cos"; Tan: "tan"; Asin: "asin"; Acos: "acos";
    Atan: "atan"; Atan2: "atan2"; Sinh: "sinh"; Cosh: "cosh"; Tanh: "tanh"; Asinh: "asinh"; Acosh: "acosh";
    Atanh: "atanh"; Exp: "exp"; Exp2: "exp2"; Log: "log"; Log2: "log2"; Pow: "pow";
    Convert: "int of float" "uint of float" "float of int" "float of uint" "bool of float" "int of uint" "uint of int";
    Mix: "mix"; Clamp: "clamp" "saturate"; SmoothStep: "smoothstep"; Dot: "dot"; Length: "length";
    Distance: "distance"; Normalize: "normalize"; Cross: "cross"; Reflect: "reflect"; Refract: "refract";
    FaceForward: "faceforward"; MatrixProduct: "matrix * vector"; Determinant: "determinant"; Inverse: "inverse";
}
