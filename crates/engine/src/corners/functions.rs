//! From the built-in functions and operators of each language to their rows: one that has none does not compile.

use judge::profile::Op;
use naga::{BinaryOperator, MathFunction, UnaryOperator};
use syntax::BuiltinFunction;

/// Names of rows.
type Names = &'static [&'static str];

/// Those of a function of GLSL.
pub fn of_function(function: BuiltinFunction) -> Names {
    use BuiltinFunction as F;
    match function {
        F::Radians => &["radians"],
        F::Degrees => &["degrees"],
        F::Sin => &["sin"],
        F::Cos => &["cos"],
        F::Tan => &["tan"],
        F::Asin => &["asin"],
        F::Acos => &["acos"],
        F::Sinh => &["sinh"],
        F::Cosh => &["cosh"],
        F::Tanh => &["tanh"],
        F::Asinh => &["asinh"],
        F::Acosh => &["acosh"],
        F::Atanh => &["atanh"],
        F::Atan => &["atan", "atan2"],
        F::Pow => &["pow"],
        F::Exp => &["exp"],
        F::Log => &["log"],
        F::Exp2 => &["exp2"],
        F::Log2 => &["log2"],
        F::Sqrt => &["sqrt"],
        F::Inversesqrt => &["inversesqrt"],
        F::Abs => &["abs", "abs of int"],
        F::Sign => &["sign", "sign of int"],
        F::Floor => &["floor"],
        F::Trunc => &["trunc"],
        F::Round => &["round"],
        F::RoundEven => &["roundEven"],
        F::Ceil => &["ceil"],
        F::Fract => &["fract"],
        F::Mod => &["mod"],
        F::Modf => &["fraction of modf", "whole of modf"],
        F::Min => &["min", "min of int"],
        F::Max => &["max", "max of uint"],
        F::Clamp => &["clamp", "clamp of int"],
        F::Mix => &["mix", "select"],
        F::Step => &["step"],
        F::Smoothstep => &["smoothstep"],
        F::Isnan => &["isnan"],
        F::Isinf => &["isinf"],
        F::FloatBitsToInt | F::FloatBitsToUint => &["bits of float"],
        F::IntBitsToFloat | F::UintBitsToFloat => &["float of bits"],
        F::Fma => &["fma"],
        F::Frexp => &["fraction of frexp", "exponent of frexp"],
        F::Ldexp => &["ldexp"],
        F::PackUnorm2x16 => &["packUnorm2x16"],
        F::PackSnorm2x16 => &["packSnorm2x16"],
        F::PackHalf2x16 => &["packHalf2x16"],
        F::PackUnorm4x8 => &["packUnorm4x8"],
        F::PackSnorm4x8 => &["packSnorm4x8"],
        F::UnpackUnorm2x16 => &["unpackUnorm2x16"],
        F::UnpackSnorm2x16 => &["unpackSnorm2x16"],
        F::UnpackHalf2x16 => &["unpackHalf2x16"],
        F::UnpackUnorm4x8 => &["unpackUnorm4x8"],
        F::UnpackSnorm4x8 => &["unpackSnorm4x8"],
        F::Length => &["length"],
        F::Distance => &["distance"],
        F::Dot => &["dot"],
        F::Cross => &["cross"],
        F::Normalize => &["normalize"],
        F::Faceforward => &["faceforward"],
        F::Reflect => &["reflect"],
        F::Refract => &["refract"],
        F::MatrixCompMult | F::OuterProduct => &["*"],
        F::Determinant => &["determinant"],
        F::Inverse => &["inverse"],
        F::LessThan => &["<", "< of int", "< of uint"],
        F::LessThanEqual => &["<="],
        F::GreaterThan => &[">"],
        F::GreaterThanEqual => &[">="],
        F::Equal => &["=="],
        F::NotEqual => &["!="],
        F::UaddCarry => &["uaddCarry"],
        F::UsubBorrow => &["usubBorrow"],
        F::UmulExtended => &["* of uint"],
        F::ImulExtended => &["* of int"],
        F::BitfieldExtract => &["bitfieldExtract", "bitfieldExtract of int"],
        F::BitfieldInsert => &["bitfieldInsert"],
        F::BitfieldReverse => &["bitfieldReverse"],
        F::BitCount => &["bitCount"],
        F::FindLSB => &["findLSB"],
        F::FindMSB => &["findMSB"],
        // Truth values, and components that change places.
        F::Transpose | F::Any | F::All | F::Not => &[],
        // Numbers of 8, 16 and 64 bits: no lane but the embedded one runs them.
        F::PackDouble2x32
        | F::UnpackDouble2x32
        | F::Pack16
        | F::Pack32
        | F::Unpack8
        | F::Unpack16
        | F::Float16BitsToInt16
        | F::HalfBitsToInt16
        | F::Float16BitsToUint16
        | F::HalfBitsToUint16
        | F::Int16BitsToFloat16
        | F::Int16BitsToHalf
        | F::Uint16BitsToFloat16
        | F::Uint16BitsToHalf
        | F::PackFloat2x16
        | F::UnpackFloat2x16 => &[],
        // Memory: the order of invocations decides, and the sums wrap as those of integers do.
        F::AtomicCounter
        | F::AtomicCounterIncrement
        | F::AtomicCounterDecrement
        | F::AtomicAdd
        | F::AtomicMin
        | F::AtomicMax
        | F::AtomicAnd
        | F::AtomicOr
        | F::AtomicXor
        | F::AtomicExchange
        | F::AtomicCompSwap
        | F::AtomicCounterAdd
        | F::AtomicCounterSubtract
        | F::AtomicCounterMin
        | F::AtomicCounterMax
        | F::AtomicCounterAnd
        | F::AtomicCounterOr
        | F::AtomicCounterXor
        | F::AtomicCounterExchange
        | F::AtomicCounterCompSwap => &[],
        // Neighbours, and what a stage does.
        F::Ftransform
        | F::DFdx
        | F::DFdy
        | F::Fwidth
        | F::DFdxFine
        | F::DFdyFine
        | F::FwidthFine
        | F::DFdxCoarse
        | F::DFdyCoarse
        | F::FwidthCoarse
        | F::InterpolateAtCentroid
        | F::InterpolateAtSample
        | F::InterpolateAtOffset
        | F::Noise1
        | F::Noise2
        | F::Noise3
        | F::Noise4
        | F::EmitVertex
        | F::EndPrimitive
        | F::EmitStreamVertex
        | F::EndStreamPrimitive
        | F::Barrier
        | F::MemoryBarrier
        | F::MemoryBarrierAtomicCounter
        | F::MemoryBarrierBuffer
        | F::MemoryBarrierShared
        | F::MemoryBarrierImage
        | F::GroupMemoryBarrier => &[],
        // Invocations of a group.
        F::AnyInvocation
        | F::AllInvocations
        | F::AllInvocationsEqual
        | F::AnyInvocationARB
        | F::AllInvocationsARB
        | F::AllInvocationsEqualARB
        | F::SubgroupBarrier
        | F::SubgroupMemoryBarrier
        | F::SubgroupMemoryBarrierBuffer
        | F::SubgroupMemoryBarrierShared
        | F::SubgroupMemoryBarrierImage
        | F::SubgroupElect
        | F::SubgroupAll
        | F::SubgroupAny
        | F::SubgroupAllEqual
        | F::SubgroupBroadcastFirst
        | F::SubgroupQuadSwapHorizontal
        | F::SubgroupQuadSwapVertical
        | F::SubgroupQuadSwapDiagonal
        | F::SubgroupBroadcast
        | F::SubgroupShuffle
        | F::SubgroupShuffleXor
        | F::SubgroupShuffleUp
        | F::SubgroupShuffleDown
        | F::SubgroupRotate
        | F::SubgroupQuadBroadcast
        | F::SubgroupClusteredRotate
        | F::SubgroupBallot
        | F::SubgroupInverseBallot
        | F::SubgroupBallotBitExtract
        | F::SubgroupBallotBitCount
        | F::SubgroupBallotInclusiveBitCount
        | F::SubgroupBallotExclusiveBitCount
        | F::SubgroupBallotFindLSB
        | F::SubgroupBallotFindMSB
        | F::SubgroupAdd
        | F::SubgroupMul
        | F::SubgroupMin
        | F::SubgroupMax
        | F::SubgroupInclusiveAdd
        | F::SubgroupInclusiveMul
        | F::SubgroupInclusiveMin
        | F::SubgroupInclusiveMax
        | F::SubgroupExclusiveAdd
        | F::SubgroupExclusiveMul
        | F::SubgroupExclusiveMin
        | F::SubgroupExclusiveMax
        | F::SubgroupAnd
        | F::SubgroupOr
        | F::SubgroupXor
        | F::SubgroupInclusiveAnd
        | F::SubgroupInclusiveOr
        | F::SubgroupInclusiveXor
        | F::SubgroupExclusiveAnd
        | F::SubgroupExclusiveOr
        | F::SubgroupExclusiveXor
        | F::SubgroupClusteredAdd
        | F::SubgroupClusteredMul
        | F::SubgroupClusteredMin
        | F::SubgroupClusteredMax
        | F::SubgroupClusteredAnd
        | F::SubgroupClusteredOr
        | F::SubgroupClusteredXor => &[],
        // Textures and images: `texture` has their edges.
        F::TextureSize
        | F::TextureQueryLevels
        | F::TextureQueryLod
        | F::TextureSamples
        | F::TexelFetch
        | F::TexelFetchOffset
        | F::Texture
        | F::TextureOffset
        | F::TextureLod
        | F::TextureLodOffset
        | F::TextureGrad
        | F::TextureGradOffset
        | F::TextureProj
        | F::TextureProjOffset
        | F::TextureProjLod
        | F::TextureProjLodOffset
        | F::TextureProjGrad
        | F::TextureProjGradOffset
        | F::TextureGather
        | F::TextureGatherOffset
        | F::TextureGatherOffsets
        | F::Texture1D
        | F::Texture1DProj
        | F::Texture2D
        | F::Texture2DProj
        | F::Texture3D
        | F::Texture3DProj
        | F::TextureCube
        | F::Texture1DLod
        | F::Texture1DProjLod
        | F::Texture2DLod
        | F::Texture2DLodEXT
        | F::Texture2DProjLod
        | F::Texture3DLod
        | F::Texture3DProjLod
        | F::TextureCubeLod
        | F::TextureCubeLodEXT
        | F::Texture1DGradARB
        | F::Texture2DGradARB
        | F::Texture2DGradEXT
        | F::Texture3DGradARB
        | F::TextureCubeGradARB
        | F::TextureCubeGradEXT
        | F::Texture2DRect
        | F::Texture2DRectProj
        | F::Texture2DArray
        | F::Texture1DArray
        | F::Shadow1D
        | F::Shadow1DProj
        | F::Shadow2D
        | F::Shadow2DProj
        | F::Shadow1DLod
        | F::Shadow1DProjLod
        | F::Shadow2DLod
        | F::Shadow2DProjLod
        | F::Shadow2DRect
        | F::Shadow2DRectProj
        | F::ImageSamples
        | F::ImageSize
        | F::ImageLoad
        | F::ImageStore
        | F::ImageAtomicExchange
        | F::ImageAtomicAdd
        | F::ImageAtomicMin
        | F::ImageAtomicMax
        | F::ImageAtomicAnd
        | F::ImageAtomicOr
        | F::ImageAtomicXor
        | F::ImageAtomicCompSwap => &[],
    }
}

/// Those of a function of WGSL, and of SPIR-V that is read.
pub fn of_math(function: MathFunction) -> Names {
    use MathFunction as M;
    match function {
        M::Abs => &["abs", "abs of int"],
        M::Min => &["min", "min of int"],
        M::Max => &["max", "max of uint"],
        M::Clamp => &["clamp", "clamp of int"],
        M::Saturate => &["saturate"],
        M::Cos => &["cos"],
        M::Cosh => &["cosh"],
        M::Sin => &["sin"],
        M::Sinh => &["sinh"],
        M::Tan => &["tan"],
        M::Tanh => &["tanh"],
        M::Acos => &["acos"],
        M::Asin => &["asin"],
        M::Atan => &["atan"],
        M::Atan2 => &["atan2"],
        M::Asinh => &["asinh"],
        M::Acosh => &["acosh"],
        M::Atanh => &["atanh"],
        M::Radians => &["radians"],
        M::Degrees => &["degrees"],
        M::Ceil => &["ceil"],
        M::Floor => &["floor"],
        M::Round => &["roundEven"],
        M::Fract => &["fract"],
        M::Trunc => &["trunc"],
        M::Modf => &["fraction of modf", "whole of modf"],
        M::Frexp => &["fraction of frexp", "exponent of frexp"],
        M::Ldexp => &["ldexp"],
        M::Exp => &["exp"],
        M::Exp2 => &["exp2"],
        M::Log => &["log"],
        M::Log2 => &["log2"],
        M::Pow => &["pow"],
        M::Dot => &["dot"],
        M::Dot4I8Packed => &["dot4I8Packed"],
        M::Dot4U8Packed => &["dot4U8Packed"],
        M::Outer => &["*"],
        M::Cross => &["cross"],
        M::Distance => &["distance"],
        M::Length => &["length"],
        M::Normalize => &["normalize"],
        M::FaceForward => &["faceforward"],
        M::Reflect => &["reflect"],
        M::Refract => &["refract"],
        M::Sign => &["sign", "sign of int"],
        M::Fma => &["fma"],
        M::Mix => &["mix"],
        M::Step => &["step"],
        M::SmoothStep => &["smoothstep"],
        M::Sqrt => &["sqrt"],
        M::InverseSqrt => &["inversesqrt"],
        M::Inverse => &["inverse"],
        M::Determinant => &["determinant"],
        M::QuantizeToF16 => &["quantizeToF16"],
        M::CountTrailingZeros => &["countTrailingZeros"],
        M::CountLeadingZeros => &["countLeadingZeros"],
        M::CountOneBits => &["bitCount"],
        M::ReverseBits => &["bitfieldReverse"],
        M::ExtractBits => &["extractBits", "extractBits of int"],
        M::InsertBits => &["insertBits"],
        M::FirstTrailingBit => &["findLSB"],
        M::FirstLeadingBit => &["findMSB", "firstLeadingBit of uint"],
        M::Pack4x8snorm => &["packSnorm4x8"],
        M::Pack4x8unorm => &["packUnorm4x8"],
        M::Pack2x16snorm => &["packSnorm2x16"],
        M::Pack2x16unorm => &["packUnorm2x16"],
        M::Pack2x16float => &["packHalf2x16"],
        M::Pack4xI8 => &["pack4xI8"],
        M::Pack4xU8 => &["pack4xU8"],
        M::Pack4xI8Clamp => &["pack4xI8Clamp"],
        M::Pack4xU8Clamp => &["pack4xU8Clamp"],
        M::Unpack4x8snorm => &["unpackSnorm4x8"],
        M::Unpack4x8unorm => &["unpackUnorm4x8"],
        M::Unpack2x16snorm => &["unpackSnorm2x16"],
        M::Unpack2x16unorm => &["unpackUnorm2x16"],
        M::Unpack2x16float => &["unpackHalf2x16"],
        M::Unpack4xI8 => &["unpack4xI8"],
        M::Unpack4xU8 => &["unpack4xU8"],
        // Components that change places.
        M::Transpose => &[],
    }
}

/// Those of an operator with two operands, with what a conversion does beside it.
pub fn of_binary(operator: BinaryOperator) -> Names {
    use BinaryOperator as B;
    match operator {
        B::Add => &["+", "+ of int", "+ of uint"],
        B::Subtract => &["-", "- of int", "- of uint"],
        B::Multiply => &["*", "* of int", "* of uint", "matrix * vector"],
        B::Divide => &["/", "/ of int", "/ of uint"],
        B::Modulo => &["remainder", "% of int", "% of uint"],
        B::Equal => &["=="],
        B::NotEqual => &["!="],
        B::Less => &["<", "< of int", "< of uint"],
        B::LessEqual => &["<="],
        B::Greater => &[">"],
        B::GreaterEqual => &[">="],
        B::And => &["&"],
        B::ExclusiveOr => &["^"],
        B::InclusiveOr => &["|"],
        B::ShiftLeft => &["<<"],
        B::ShiftRight => &[">>", ">> of int"],
        // Truth values.
        B::LogicalAnd | B::LogicalOr => &[],
    }
}

/// Those of an operator with one operand.
pub fn of_unary(operator: UnaryOperator) -> Names {
    match operator {
        UnaryOperator::Negate => &["negate", "negate int"],
        UnaryOperator::BitwiseNot => &["~"],
        // Truth values.
        UnaryOperator::LogicalNot => &[],
    }
}

/// Those of an operation that profiles bound.
pub fn of_operation(op: Op) -> Names {
    match op {
        Op::Add => &["+"],
        Op::Sub => &["-"],
        Op::Mul => &["*"],
        Op::Div => &["/"],
        Op::Rem => &["remainder"],
        Op::Mod => &["mod"],
        Op::Fma => &["fma"],
        Op::Neg => &["negate"],
        Op::Abs => &["abs"],
        Op::Sign => &["sign"],
        Op::Min => &["min"],
        Op::Max => &["max"],
        Op::Step => &["step"],
        Op::Floor => &["floor"],
        Op::Ceil => &["ceil"],
        Op::Trunc => &["trunc"],
        Op::RoundEven => &["round", "roundEven"],
        Op::Fract => &["fract"],
        Op::Ldexp => &["ldexp"],
        Op::Sqrt => &["sqrt"],
        Op::InverseSqrt => &["inversesqrt"],
        Op::Radians => &["radians"],
        Op::Degrees => &["degrees"],
        Op::Sin => &["sin"],
        Op::Cos => &["cos"],
        Op::Tan => &["tan"],
        Op::Asin => &["asin"],
        Op::Acos => &["acos"],
        Op::Atan => &["atan"],
        Op::Atan2 => &["atan2"],
        Op::Sinh => &["sinh"],
        Op::Cosh => &["cosh"],
        Op::Tanh => &["tanh"],
        Op::Asinh => &["asinh"],
        Op::Acosh => &["acosh"],
        Op::Atanh => &["atanh"],
        Op::Exp => &["exp"],
        Op::Exp2 => &["exp2"],
        Op::Log => &["log"],
        Op::Log2 => &["log2"],
        Op::Pow => &["pow"],
        Op::Convert => &[
            "int of float",
            "uint of float",
            "float of int",
            "float of uint",
            "bool of float",
            "int of uint",
            "uint of int",
        ],
        Op::Mix => &["mix"],
        Op::Clamp => &["clamp", "saturate"],
        Op::SmoothStep => &["smoothstep"],
        Op::Dot => &["dot"],
        Op::Length => &["length"],
        Op::Distance => &["distance"],
        Op::Normalize => &["normalize"],
        Op::Cross => &["cross"],
        Op::Reflect => &["reflect"],
        Op::Refract => &["refract"],
        Op::FaceForward => &["faceforward"],
        Op::MatrixProduct => &["matrix * vector"],
        Op::Determinant => &["determinant"],
        Op::Inverse => &["inverse"],
    }
}
