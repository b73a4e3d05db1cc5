//! Operators and functions of integers, conversions and packing.

use super::super::Corner::*;
use super::super::Row;
use super::{ARITHMETIC, BITS, COMPARISON, CONVERSION, INTEGERS, PACKING, all, only, row, same};

#[rustfmt::skip]
pub(super) static ROWS: &[Row] = &[
    // Operators on integers.
    row("+ of int", same("x + y"), "i i i", ARITHMETIC, &[
        all(Overflow, "max 1 = min"),
        all(Zero, "0 0 = 0"),
    ]),
    row("- of int", same("x - y"), "i i i", ARITHMETIC, &[
        all(Overflow, "min 1 = max"),
        all(Equal, "7 7 = 0"),
    ]),
    row("* of int", same("x * y"), "i i i", ARITHMETIC, &[
        all(Overflow, "65536 65536 = 0; min -1 = min"),
        all(Zero, "0 -5 = 0"),
    ]),
    row("/ of int", same("x / y"), "i i i", ARITHMETIC, &[
        only("GH", Range, "1 0 = any; min -1 = any"),
        only("W", Range, "1 0 = 1; min -1 = min; -5 0 = -5"),
        all(Zero, "0 3 = 0"),
        all(Equal, "-7 2 = -3; 7 7 = 1"),
    ]),
    row("% of int", same("x % y"), "i i i", ARITHMETIC, &[
        only("GH", Range, "1 0 = any"),
        only("G", Range, "min -1 = any; -7 2 = any; 7 -2 = any"),
        only("W", Range, "1 0 = 0; min -1 = 0; -7 2 = -1; 7 -2 = 1"),
        all(Zero, "0 3 = 0"),
        all(Equal, "7 7 = 0"),
    ]),
    row("negate int", same("-x"), "i i", ARITHMETIC, &[
        all(Overflow, "min = min"),
        all(Zero, "0 = 0"),
    ]),
    row("+ of uint", same("x + y"), "u u u", ARITHMETIC, &[
        all(Overflow, "max 1 = 0"),
        all(Zero, "0 0 = 0"),
    ]),
    row("- of uint", same("x - y"), "u u u", ARITHMETIC, &[
        all(Overflow, "0 1 = max"),
        all(Equal, "7 7 = 0"),
    ]),
    row("* of uint", same("x * y"), "u u u", ARITHMETIC, &[
        all(Overflow, "65536 65536 = 0; max max = 1"),
        all(Zero, "0 5 = 0"),
    ]),
    row("/ of uint", same("x / y"), "u u u", ARITHMETIC, &[
        only("GH", Range, "1 0 = any"),
        only("W", Range, "1 0 = 1; 5 0 = 5"),
        all(Zero, "0 3 = 0"),
        all(Equal, "7 7 = 1; max 2 = 2147483647"),
    ]),
    row("% of uint", same("x % y"), "u u u", ARITHMETIC, &[
        only("GH", Range, "1 0 = any"),
        only("W", Range, "1 0 = 0; 5 0 = 0"),
        all(Zero, "0 3 = 0"),
        all(Equal, "7 7 = 0; max 2 = 1"),
    ]),
    row("< of int", same("x < y"), "b i i", COMPARISON, &[
        all(Overflow, "min max = true; max min = false"),
        all(Equal, "-3 -3 = false"),
    ]),
    row("< of uint", same("x < y"), "b u u", COMPARISON, &[
        all(Overflow, "max 0 = false; 2147483648 1 = false"),
        all(Equal, "3 3 = false"),
    ]),
    row("&", same("x & y"), "u u u", BITS, &[all(Equal, "max max = max; 0xf0f0 0x0ff0 = 0xf0")]),
    row("|", same("x | y"), "u u u", BITS, &[all(Zero, "0 0 = 0; 0xf000 0x000f = 0xf00f")]),
    row("^", same("x ^ y"), "u u u", BITS, &[all(Equal, "max max = 0; 0xff 0x0f = 0xf0")]),
    row("~", same("~x"), "u u", BITS, &[all(Zero, "0 = max; max = 0")]),
    row("<<", same("x << y"), "u u u", BITS, &[
        only("G", Range, "1 32 = any; 1 33 = any"),
        only("WH", Range, "1 32 = 1; 1 33 = 2"),
        all(Overflow, "3 31 = 0x80000000"),
        all(Zero, "5 0 = 5"),
    ]),
    row(">>", same("x >> y"), "u u u", BITS, &[
        only("G", Range, "8 32 = any"),
        only("WH", Range, "8 32 = 8; 8 33 = 4"),
        all(Overflow, "max 31 = 1"),
        all(Zero, "5 0 = 5"),
    ]),
    row(">> of int", ["x >> y", "x >> y", "x >> y"], "i i u", BITS, &[
        only("G", Range, "8 32 = any"),
        only("WH", Range, "-8 33 = -4"),
        all(Overflow, "min 31 = -1"),
        all(Zero, "-5 0 = -5; -8 1 = -4"),
    ]),
    // Functions of integers.
    row("abs of int", same("abs(x)"), "i i", ["8.3", "17.5", "intrinsic functions"], &[
        all(Overflow, "min = min"),
        all(Zero, "0 = 0; -7 = 7"),
    ]),
    row("sign of int", ["sign(x)", "sign(x)", ""], "i i", ["8.3", "17.5", ""], &[
        all(Overflow, "min = -1; max = 1"),
        all(Zero, "0 = 0"),
    ]),
    row("min of int", same("min(x, y)"), "i i i", ["8.3", "17.5", "intrinsic functions"], &[
        all(Overflow, "min max = min"),
        all(Equal, "-3 -3 = -3"),
    ]),
    row("max of uint", same("max(x, y)"), "u u u", ["8.3", "17.5", "intrinsic functions"], &[
        all(Overflow, "max 0 = max; 2147483648 1 = 2147483648"),
        all(Equal, "3 3 = 3"),
    ]),
    row("clamp of int", same("clamp(x, y, z)"), "i i i i", ["8.3", "17.5", "intrinsic functions"], &[
        only("GH", Range, "5 7 3 = any"),
        only("W", Range, "5 7 3 = 3"),
        all(Equal, "1 2 2 = 2; min -1 1 = -1; max -1 1 = 1"),
    ]),
    row("bitCount", ["bitCount(x)", "countOneBits(x)", ""], "i i", INTEGERS, &[
        all(Zero, "0 = 0"),
        all(Overflow, "-1 = 32; min = 1"),
    ]),
    row("findLSB", ["findLSB(x)", "firstTrailingBit(x)", ""], "i i", INTEGERS, &[
        all(Zero, "0 = -1"),
        all(Overflow, "min = 31; -1 = 0"),
    ]),
    row("findMSB", ["findMSB(x)", "firstLeadingBit(x)", ""], "i i", INTEGERS, &[
        all(Zero, "0 = -1; -1 = -1"),
        all(Overflow, "max = 30; min = 30; -2 = 0"),
    ]),
    row("firstLeadingBit of uint", ["", "firstLeadingBit(x)", "firstbithigh(x)"], "u u", INTEGERS, &[
        all(Zero, "0 = max"),
        all(Overflow, "max = 31; 1 = 0"),
    ]),
    row("countLeadingZeros", ["", "countLeadingZeros(x)", ""], "u u", INTEGERS, &[
        all(Zero, "0 = 32"),
        all(Overflow, "max = 0; 1 = 31"),
    ]),
    row("countTrailingZeros", ["", "countTrailingZeros(x)", ""], "u u", INTEGERS, &[
        all(Zero, "0 = 32"),
        all(Overflow, "max = 0; 2147483648 = 31"),
    ]),
    row("bitfieldReverse", ["bitfieldReverse(x)", "reverseBits(x)", "reversebits(x)"], "u u", INTEGERS, &[
        all(Zero, "0 = 0"),
        all(Overflow, "1 = 2147483648; max = max"),
    ]),
    row("bitfieldExtract", ["bitfieldExtract(x, y, z)", "", ""], "u u i i", INTEGERS, &[
        all(Range, "255 1 32 = any; 255 -1 2 = any; 255 2 -1 = any"),
        all(Zero, "max 0 0 = 0; max 32 0 = 0"),
        all(Equal, "max 0 32 = max; 240 4 4 = 15"),
    ]),
    row("bitfieldExtract of int", ["bitfieldExtract(x, y, z)", "", ""], "i i i i", INTEGERS, &[
        all(Range, "255 1 32 = any"),
        all(Zero, "-1 0 0 = 0"),
        all(Equal, "-5 0 32 = -5; 240 4 4 = -1"),
    ]),
    row("extractBits", ["", "extractBits(x, y, z)", ""], "u u u u", INTEGERS, &[
        all(Range, "255 1 32 = 127; 255 40 4 = 0"),
        all(Zero, "max 0 0 = 0"),
        all(Equal, "max 0 32 = max; 240 4 4 = 15"),
    ]),
    row("extractBits of int", ["", "extractBits(x, y, z)", ""], "i i u u", INTEGERS, &[
        all(Range, "-1 1 32 = -1; 255 40 4 = 0"),
        all(Zero, "-1 0 0 = 0"),
        all(Equal, "-5 0 32 = -5; 240 4 4 = -1"),
    ]),
    row("bitfieldInsert", ["bitfieldInsert(x, y, z, w)", "", ""], "u u u i i", INTEGERS, &[
        all(Range, "0 255 28 8 = any"),
        all(Zero, "7 max 0 0 = 7"),
        all(Equal, "7 max 0 32 = max; 0 15 4 4 = 240"),
    ]),
    row("insertBits", ["", "insertBits(x, y, z, w)", ""], "u u u u u", INTEGERS, &[
        all(Range, "0 255 28 8 = 0xf0000000; 7 255 40 4 = 7"),
        all(Zero, "7 max 0 0 = 7"),
        all(Equal, "7 max 0 32 = max; 0 15 4 4 = 240"),
    ]),
    row("uaddCarry", ["uaddCarry(x, y, carry)", "", ""], "u u u", INTEGERS, &[
        all(Overflow, "max 1 = 0; max max = 4294967294"),
        all(Zero, "0 0 = 0"),
    ]),
    row("usubBorrow", ["usubBorrow(x, y, carry)", "", ""], "u u u", INTEGERS, &[
        all(Overflow, "0 1 = max"),
        all(Equal, "7 7 = 0"),
    ]),
    row("dot4U8Packed", ["", "dot4U8Packed(x, y)", ""], "u u u", INTEGERS, &[
        all(Overflow, "max max = 260100"),
        all(Zero, "0 max = 0"),
    ]),
    row("dot4I8Packed", ["", "dot4I8Packed(x, y)", ""], "i u u", INTEGERS, &[
        all(Overflow, "0x80808080 0x80808080 = 65536; max max = 4"),
        all(Zero, "0 max = 0"),
    ]),
    // Conversions.
    row("int of float", ["int(x)", "i32(x)", "int(x)"], "i f", CONVERSION, &[
        all(Subnormal, "1e-40 = 0; -1e-40 = 0"),
        only("GH", Range, "3e9 = any; -3e9 = any; 2147483648 = any"),
        only("W", Range, "3e9 = 2147483520; -3e9 = min; 2147483648 = 2147483520"),
        all(Absorption, "0.99999994 = 0; -0.99999994 = 0"),
        all(Zero, "-0 = 0"),
        all(Equal, "-2147483648 = min; 2147483520 = 2147483520; -1.5 = -1"),
    ]),
    row("uint of float", ["uint(x)", "u32(x)", "uint(x)"], "u f", CONVERSION, &[
        all(Subnormal, "1e-40 = 0"),
        only("GH", Range, "5e9 = any; -1 = any; 4294967296 = any"),
        only("W", Range, "5e9 = 4294967040; -1 = 0; 4294967296 = 4294967040"),
        all(Absorption, "0.99999994 = 0"),
        all(Zero, "-0 = 0"),
        all(Equal, "4294967040 = 4294967040; 1.5 = 1"),
    ]),
    row("float of int", ["float(x)", "f32(x)", "float(x)"], "f i", CONVERSION, &[
        all(Tie, "16777217 = 16777216 | 16777218; -16777219 = -16777218 | -16777220"),
        all(Overflow, "max = 2147483648 | 2147483520; min = -2147483648"),
        all(Zero, "0 = 0"),
        all(Equal, "16777216 = 16777216"),
    ]),
    row("float of uint", ["float(x)", "f32(x)", "float(x)"], "f u", CONVERSION, &[
        all(Tie, "16777217 = 16777216 | 16777218"),
        all(Overflow, "max = 4294967296 | 4294967040"),
        all(Zero, "0 = 0"),
        all(Equal, "16777216 = 16777216"),
    ]),
    row("bool of float", ["bool(x)", "bool(x)", "bool(x)"], "b f", CONVERSION, &[
        all(Subnormal, "1e-40 = true | false"),
        all(Zero, "0 = false; -0 = false"),
        all(Equal, "0.5 = true; -1 = true"),
    ]),
    row("int of uint", ["int(x)", "i32(x)", "int(x)"], "i u", CONVERSION, &[
        all(Overflow, "max = -1; 2147483648 = min"),
        all(Zero, "0 = 0"),
    ]),
    row("uint of int", ["uint(x)", "u32(x)", "uint(x)"], "u i", CONVERSION, &[
        all(Overflow, "-1 = max; min = 2147483648"),
        all(Zero, "0 = 0"),
    ]),
    row("bits of float", ["floatBitsToUint(x)", "bitcast<u32>(x)", "asuint(x)"], "u f", ["8.3", "17.2", "intrinsic functions"], &[
        all(Subnormal, "1e-40 = 0x116c2 | 0"),
        all(Overflow, "max = 0x7f7fffff"),
        all(Zero, "0 = 0"),
        all(Equal, "1 = 0x3f800000; -1.5 = 0xbfc00000"),
    ]),
    row("float of bits", ["uintBitsToFloat(x)", "bitcast<f32>(x)", "asfloat(x)"], "f u", ["8.3", "17.2", "intrinsic functions"], &[
        all(Subnormal, "1 ~ 0"),
        all(NotANumber, "0x7fc00000 = any; 0xffffffff = any"),
        all(Infinity, "0x7f800000 = any"),
        all(Overflow, "0x7f7fffff = max"),
        all(Zero, "0 = 0; 0x80000000 = 0"),
        all(Equal, "0x3f800000 = 1"),
    ]),
    // Packing.
    row("packSnorm4x8", ["packSnorm4x8(x)", "pack4x8snorm(x)", ""], "u f4", PACKING, &[
        only("G", Tie, "0.5 0 0 0 = 0x3f | 0x40; -0.5 0 0 0 = 0xc1 | 0xc0"),
        only("W", Tie, "0.5 0 0 0 = 0x40; -0.5 0 0 0 = 0xc1"),
        all(Subnormal, "1e-40 0 0 0 = 0"),
        all(Range, "2 0 0 -2 = 0x8100007f; max 0 0 -max = 0x8100007f"),
        all(Zero, "-0 0 -0 0 = 0"),
        all(Equal, "1 -1 1 -1 = 0x817f817f"),
    ]),
    row("packUnorm4x8", ["packUnorm4x8(x)", "pack4x8unorm(x)", ""], "u f4", PACKING, &[
        only("G", Tie, "0.5 0 0 0 = 0x7f | 0x80"),
        only("W", Tie, "0.5 0 0 0 = 0x80"),
        all(Subnormal, "1e-40 0 0 0 = 0"),
        all(Range, "2 0 0 -2 = 0xff; max 0 0 -max = 0xff"),
        all(Zero, "-0 0 -0 0 = 0"),
        all(Equal, "1 0 1 0 = 0x00ff00ff"),
    ]),
    row("packSnorm2x16", ["packSnorm2x16(x)", "pack2x16snorm(x)", ""], "u f2", PACKING, &[
        only("G", Tie, "0.5 0 = 0x3fff | 0x4000; -0.5 0 = 0xc001 | 0xc000"),
        only("W", Tie, "0.5 0 = 0x4000; -0.5 0 = 0xc001"),
        all(Subnormal, "1e-40 0 = 0"),
        all(Range, "2 -2 = 0x80017fff"),
        all(Zero, "-0 0 = 0"),
        all(Equal, "1 -1 = 0x80017fff"),
    ]),
    row("packUnorm2x16", ["packUnorm2x16(x)", "pack2x16unorm(x)", ""], "u f2", PACKING, &[
        only("G", Tie, "0.5 0 = 0x7fff | 0x8000"),
        only("W", Tie, "0.5 0 = 0x8000"),
        all(Subnormal, "1e-40 0 = 0"),
        all(Range, "2 -2 = 0xffff"),
        all(Zero, "-0 0 = 0"),
        all(Equal, "1 1 = 0xffffffff"),
    ]),
    row("packHalf2x16", ["packHalf2x16(x)", "pack2x16float(x)", ""], "u f2", PACKING, &[
        all(Tie, "1.00048828125 0 = 0x3c00 | 0x3c01"),
        all(Subnormal, "1e-40 0 = 0"),
        all(SubnormalHalf, "5.9604645e-8 0 = 1 | 0; 6.1035156e-5 0 = 0x400"),
        only("G", Overflow, "65536 0 = 0x7c00 | 0x7bff; 65504 0 = 0x7bff"),
        only("W", Overflow, "65536 0 = any; 65504 0 = 0x7bff"),
        all(Zero, "0 0 = 0"),
        all(Equal, "1 1 = 0x3c003c00"),
    ]),
    row("unpackSnorm4x8", ["unpackSnorm4x8(x).x", "unpack4x8snorm(x).x", ""], "f u", PACKING, &[
        all(Range, "0x80 ~ -1; 0x81 ~ -1; 0x7f ~ 1"),
        all(Zero, "0 = 0"),
    ]),
    row("unpackUnorm4x8", ["unpackUnorm4x8(x).x", "unpack4x8unorm(x).x", ""], "f u", PACKING, &[
        all(Range, "0xff ~ 1; 0x80 ~ 0.5019608"),
        all(Zero, "0 = 0"),
    ]),
    row("unpackSnorm2x16", ["unpackSnorm2x16(x).x", "unpack2x16snorm(x).x", ""], "f u", PACKING, &[
        all(Range, "0x8000 ~ -1; 0x8001 ~ -1; 0x7fff ~ 1"),
        all(Zero, "0 = 0"),
    ]),
    row("unpackUnorm2x16", ["unpackUnorm2x16(x).x", "unpack2x16unorm(x).x", ""], "f u", PACKING, &[
        all(Range, "0xffff ~ 1; 0x8000 ~ 0.5000076"),
        all(Zero, "0 = 0"),
    ]),
    row("unpackHalf2x16", ["unpackHalf2x16(x).x", "unpack2x16float(x).x", ""], "f u", PACKING, &[
        all(SubnormalHalf, "1 ~ 0; 0x3ff ~ 0"),
        all(NotANumber, "0x7e00 = any"),
        all(Infinity, "0x7c00 = any"),
        all(Overflow, "0x7bff = 65504"),
        all(Zero, "0 = 0; 0x8000 = 0"),
        all(Equal, "0x3c00 = 1"),
    ]),
    row("pack4xI8Clamp", ["", "pack4xI8Clamp(x)", ""], "u i4", PACKING, &[
        all(Range, "200 -200 127 -128 = 0x807f807f"),
        all(Zero, "0 0 0 0 = 0"),
    ]),
    row("pack4xU8Clamp", ["", "pack4xU8Clamp(x)", ""], "u u4", PACKING, &[
        all(Range, "256 255 max 0 = 0x00ffffff"),
        all(Zero, "0 0 0 0 = 0"),
    ]),
    row("pack4xI8", ["", "pack4xI8(x)", ""], "u i4", PACKING, &[
        all(Overflow, "256 -1 128 0 = 0x0080ff00"),
        all(Zero, "0 0 0 0 = 0"),
    ]),
    row("pack4xU8", ["", "pack4xU8(x)", ""], "u u4", PACKING, &[
        all(Overflow, "256 255 max 0 = 0x00ffff00"),
        all(Zero, "0 0 0 0 = 0"),
    ]),
    row("unpack4xI8", ["", "unpack4xI8(x).x", ""], "i u", PACKING, &[
        all(Range, "0x80 = -128; 0xff = -1; 0x7f = 127"),
        all(Zero, "0 = 0"),
    ]),
    row("unpack4xU8", ["", "unpack4xU8(x).x", ""], "u u", PACKING, &[
        all(Range, "0xff = 255; 0x1ff = 255"),
        all(Zero, "0 = 0"),
    ]),
];
