//! Every operation and built-in function that programs are made of, as a table.
//!
//! Types are letters: `F` `I` `U` `B` are a number or vector of N components, with a digit of so many; `f` `i` `u` `b` are
//! one number; `M` is a matrix of N columns and K rows, `T` one of K columns and N rows, `S` one of K by K, `V` a vector of
//! K. A sign behind a type is a guard, which keeps an argument where the operation is defined in every language.

use super::program::{Language, Scalar, Type};

/// An operation that random programs use: a row of [`OPERATIONS`].
#[derive(Debug)]
pub struct Operation {
    /// Its name in reports; those of one meaning have one name in both languages.
    pub name: &'static str,
    /// How GLSL writes it: `#0` is the first argument, `@T` the type of the result. Empty where it has none.
    pub glsl: &'static str,
    /// How WGSL writes it.
    pub wgsl: &'static str,
    /// Values of N, a digit each.
    pub sizes: &'static str,
    /// Type of the result.
    pub result: &'static str,
    /// Types of the arguments.
    pub arguments: &'static str,
}

impl Operation {
    /// How a language writes it; none where it has none.
    pub fn template(&self, language: Language) -> Option<&'static str> {
        let template = match language {
            Language::Glsl => self.glsl,
            Language::Wgsl => self.wgsl,
        };
        (!template.is_empty()).then_some(template)
    }

    /// The types of the arguments with their guards.
    pub fn arguments(&self) -> impl Iterator<Item = (Letter, Option<u8>)> {
        self.arguments.split(' ').filter(|token| !token.is_empty()).map(Letter::read)
    }

    /// The guard that it is; none of an ordinary operation.
    pub fn guard(&self) -> Option<u8> {
        self.name.strip_prefix("guard ").and_then(|sign| sign.bytes().next())
    }

    /// True where a result of floats is another number than every argument, in general.
    pub fn rounds(&self) -> bool {
        const EXACT: [&str; 21] = [
            "negate",
            "abs",
            "sign",
            "floor",
            "ceil",
            "trunc",
            "roundEven",
            "round",
            "min",
            "max",
            "clamp",
            "step",
            "saturate",
            "transpose",
            "guard 1",
            "guard h",
            "guard E",
            "guard +",
            "guard c",
            "guard C",
            "guard H",
        ];
        !EXACT.contains(&self.name) && !self.name.starts_with("select") && !self.name.starts_with("float of")
    }

    /// The values of N and K with which it gives a type: free ones are 0.
    pub fn giving(&self, ty: &Type) -> Option<(u8, u8)> {
        let (letter, _) = Letter::read(self.result);
        let (n, k) = letter.fit(ty)?;
        (n == 0 || self.allows(n)).then_some((n, k))
    }

    /// Whether N may be this.
    pub fn allows(&self, n: u8) -> bool {
        self.sizes.bytes().any(|digit| digit == b'0' + n)
    }
}

/// A type of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Letter {
    /// N components.
    Many(Scalar),
    /// A fixed number of components, whatever N is.
    Fixed(Scalar, u8),
    /// N columns and K rows.
    Matrix,
    /// K columns and N rows.
    Transposed,
    /// K by K.
    Square,
    /// K components.
    Rows,
}

impl Letter {
    fn read(token: &str) -> (Self, Option<u8>) {
        let mut bytes = token.bytes();
        let first = bytes.next().unwrap_or(b'f');
        let rest: Vec<u8> = bytes.collect();
        let digit = rest.first().copied().filter(|d| (b'1'..=b'4').contains(d) && rest.len() == 1 || rest.len() == 2);
        let scalar = match first.to_ascii_uppercase() {
            b'I' => Scalar::Int,
            b'U' => Scalar::Uint,
            b'B' => Scalar::Bool,
            _ => Scalar::Float,
        };
        // `F1` is a guard and no size: one number is a small letter.
        let size = digit.filter(|d| *d != b'1').map(|d| d - b'0');
        let guard = match size {
            Some(_) => rest.get(1).copied(),
            None => rest.first().copied(),
        };
        let letter = match (first, size) {
            (b'M', _) => Self::Matrix,
            (b'T', _) => Self::Transposed,
            (b'S', _) => Self::Square,
            (b'V', _) => Self::Rows,
            (_, Some(size)) => Self::Fixed(scalar, size),
            (first, None) if first.is_ascii_lowercase() => Self::Fixed(scalar, 1),
            _ => Self::Many(scalar),
        };
        (letter, guard)
    }

    /// The type for N and K.
    pub fn of(self, n: u8, k: u8) -> Type {
        match self {
            Self::Many(scalar) => Type::Value(scalar, n),
            Self::Fixed(scalar, size) => Type::Value(scalar, size),
            Self::Matrix => Type::Matrix(n, k),
            Self::Transposed => Type::Matrix(k, n),
            Self::Square => Type::Matrix(k, k),
            Self::Rows => Type::Value(Scalar::Float, k),
        }
    }

    fn fit(self, ty: &Type) -> Option<(u8, u8)> {
        match (self, ty) {
            (Self::Many(scalar), Type::Value(of, n)) if scalar == *of => Some((*n, 0)),
            (Self::Fixed(scalar, size), Type::Value(of, n)) if scalar == *of && size == *n => Some((0, 0)),
            (Self::Matrix, Type::Matrix(n, k)) => Some((*n, *k)),
            (Self::Transposed, Type::Matrix(k, n)) => Some((*n, *k)),
            (Self::Square, Type::Matrix(k, other)) if k == other => Some((0, *k)),
            (Self::Rows, Type::Value(Scalar::Float, k)) if *k > 1 => Some((0, *k)),
            _ => None,
        }
    }
}

const fn row(
    name: &'static str,
    glsl: &'static str,
    wgsl: &'static str,
    sizes: &'static str,
    result: &'static str,
    arguments: &'static str,
) -> Operation {
    Operation { name, glsl, wgsl, sizes, result, arguments }
}

/// One text for both languages.
const fn both(
    name: &'static str,
    text: &'static str,
    sizes: &'static str,
    result: &'static str,
    arguments: &'static str,
) -> Operation {
    row(name, text, text, sizes, result, arguments)
}

/// The table.
#[rustfmt::skip]
pub static OPERATIONS: &[Operation] = &[
    // Guards.
    both("guard 1", "clamp(#0, @T(-1.0), @T(1.0))", "1234", "F", "F"),
    both("guard h", "clamp(#0, @T(-0.9), @T(0.9))", "1234", "F", "F"),
    both("guard E", "clamp(#0, @T(-8.0), @T(8.0))", "1234", "F", "F"),
    both("guard +", "abs(#0)", "1234", "F", "F"),
    both("guard >", "(abs(#0) + @T(0.03125))", "1234", "F", "F"),
    both("guard 0", "(abs(#0) + @T(0.25))", "1234", "F", "F"),
    both("guard ^", "(abs(#0) + @T(1.0))", "1234", "F", "F"),
    both("guard n", "normalize(abs(#0) + @T(0.5))", "234", "F", "F"),
    both("guard v", "(abs(#0) + @T(0.5))", "234", "F", "F"),
    both("guard c", "clamp(#0, @T(-1000000.0), @T(1000000.0))", "1234", "F", "F"),
    both("guard C", "clamp(#0, @T(0.0), @T(1000000.0))", "1234", "F", "F"),
    both("guard H", "clamp(#0, @T(-60000.0), @T(60000.0))", "1234", "F", "F"),
    both("guard s", "(#0 & @T(31))", "1234", "I", "I"),
    both("guard s", "(#0 & @T(31))", "1234", "U", "U"),
    both("guard d", "((#0 & @T(15)) + @T(1))", "1234", "I", "I"),
    both("guard d", "((#0 & @T(15)) + @T(1))", "1234", "U", "U"),
    both("guard p", "(#0 & @T(32767))", "1234", "I", "I"),
    both("guard k", "(#0 & @T(15))", "1234", "I", "I"),
    both("guard k", "(#0 & @T(15))", "1234", "U", "U"),
    both("guard e", "((#0 & @T(7)) - @T(4))", "1234", "I", "I"),
    both("guard b", "(#0 & @T(1073741823))", "1234", "I", "I"),
    both("guard b", "(#0 & @T(1073741823))", "1234", "U", "U"),
    both("guard x", "(#0 & 1006582783u)", "1", "U", "U"),
    // Arithmetic.
    both("+", "(#0 + #1)", "1234", "F", "F F"),
    both("-", "(#0 - #1)", "1234", "F", "F F"),
    both("*", "(#0 * #1)", "1234", "F", "F F"),
    both("/", "(#0 / #1)", "1234", "F", "F F0"),
    both("negate", "(-#0)", "1234", "F", "F"),
    both("vector * number", "(#0 * #1)", "234", "F", "F f"),
    both("number * vector", "(#0 * #1)", "234", "F", "f F"),
    both("number - vector", "(#0 - #1)", "234", "F", "f F"),
    both("vector / number", "(#0 / #1)", "234", "F", "F f0"),
    both("+ of int", "(#0 + #1)", "1234", "I", "I I"),
    both("- of int", "(#0 - #1)", "1234", "I", "I I"),
    both("* of int", "(#0 * #1)", "1234", "I", "Ip Ip"),
    row("/ of int", "(#0 / #1)", "(#0 / #1)", "1234", "I", "I Id"),
    both("negate int", "(-#0)", "1234", "I", "I"),
    row("% of int", "(#0 % #1)", "(#0 % #1)", "1234", "I", "Ip Id"),
    row("% of negative int", "", "(#0 % #1)", "1234", "I", "I Id"),
    both("+ of uint", "(#0 + #1)", "1234", "U", "U U"),
    both("- of uint", "(#0 - #1)", "1234", "U", "U U"),
    both("* of uint", "(#0 * #1)", "1234", "U", "U U"),
    both("/ of uint", "(#0 / #1)", "1234", "U", "U Ud"),
    both("% of uint", "(#0 % #1)", "1234", "U", "U Ud"),
    both("& of int", "(#0 & #1)", "1234", "I", "I I"),
    both("| of int", "(#0 | #1)", "1234", "I", "I I"),
    both("^ of int", "(#0 ^ #1)", "1234", "I", "I I"),
    both("~ of int", "(~#0)", "1234", "I", "I"),
    both("& of uint", "(#0 & #1)", "1234", "U", "U U"),
    both("| of uint", "(#0 | #1)", "1234", "U", "U U"),
    both("^ of uint", "(#0 ^ #1)", "1234", "U", "U U"),
    both("~ of uint", "(~#0)", "1234", "U", "U"),
    both("<< of int", "(#0 << #1)", "1234", "I", "I Us"),
    both(">> of int", "(#0 >> #1)", "1234", "I", "I Us"),
    both("<< of uint", "(#0 << #1)", "1234", "U", "U Us"),
    both(">> of uint", "(#0 >> #1)", "1234", "U", "U Us"),
    row("<< by int", "(#0 << #1)", "", "1234", "I", "I Is"),
    // Comparison and logic.
    both("<", "(#0 < #1)", "1", "B", "F F"),
    both("<=", "(#0 <= #1)", "1", "B", "F F"),
    both(">", "(#0 > #1)", "1", "B", "F F"),
    both(">=", "(#0 >= #1)", "1", "B", "F F"),
    both("== of int", "(#0 == #1)", "1", "B", "I I"),
    both("!= of int", "(#0 != #1)", "1", "B", "I I"),
    both("< of int", "(#0 < #1)", "1", "B", "I I"),
    both(">= of int", "(#0 >= #1)", "1", "B", "I I"),
    both("< of uint", "(#0 < #1)", "1", "B", "U U"),
    both("> of uint", "(#0 > #1)", "1", "B", "U U"),
    both("== of uint", "(#0 == #1)", "1", "B", "U U"),
    row("lessThan", "lessThan(#0, #1)", "(#0 < #1)", "234", "B", "F F"),
    row("greaterThanEqual", "greaterThanEqual(#0, #1)", "(#0 >= #1)", "234", "B", "F F"),
    row("lessThan of int", "lessThan(#0, #1)", "(#0 < #1)", "234", "B", "I I"),
    row("equal of int", "equal(#0, #1)", "(#0 == #1)", "234", "B", "I I"),
    row("notEqual of uint", "notEqual(#0, #1)", "(#0 != #1)", "234", "B", "U U"),
    row("greaterThan of uint", "greaterThan(#0, #1)", "(#0 > #1)", "234", "B", "U U"),
    both("&&", "(#0 && #1)", "1", "B", "B B"),
    both("||", "(#0 || #1)", "1", "B", "B B"),
    row("^^", "(#0 ^^ #1)", "(#0 != #1)", "1", "B", "B B"),
    row("not", "(!#0)", "(!#0)", "1", "B", "B"),
    row("not of vector", "not(#0)", "(!#0)", "234", "B", "B"),
    both("any", "any(#0)", "234", "b", "B"),
    both("all", "all(#0)", "234", "b", "B"),
    row("select", "(#2 ? #1 : #0)", "select(#0, #1, #2)", "1", "F", "F F b"),
    row("select of vector by one", "(#2 ? #1 : #0)", "select(#0, #1, #2)", "234", "F", "F F b"),
    row("select of vector", "mix(#0, #1, #2)", "select(#0, #1, #2)", "234", "F", "F F B"),
    row("select of int", "(#2 ? #1 : #0)", "select(#0, #1, #2)", "1", "I", "I I b"),
    row("select of ints", "mix(#0, #1, #2)", "select(#0, #1, #2)", "234", "I", "I I B"),
    row("select of uint", "(#2 ? #1 : #0)", "select(#0, #1, #2)", "1", "U", "U U b"),
    // Functions of numbers, GLSL 4.60 section 8, WGSL section 17.
    both("abs", "abs(#0)", "1234", "F", "F"),
    both("sign", "sign(#0)", "1234", "F", "F"),
    both("floor", "floor(#0)", "1234", "F", "F"),
    both("ceil", "ceil(#0)", "1234", "F", "F"),
    both("trunc", "trunc(#0)", "1234", "F", "F"),
    row("roundEven", "roundEven(#0)", "round(#0)", "1234", "F", "F"),
    row("round", "round(#0)", "", "1234", "F", "F"),
    both("fract", "fract(#0)", "1234", "F", "F"),
    both("sqrt", "sqrt(#0)", "1234", "F", "F+"),
    row("inversesqrt", "inversesqrt(#0)", "inverseSqrt(#0)", "1234", "F", "F>"),
    both("exp", "exp(#0)", "1234", "F", "FE"),
    both("exp2", "exp2(#0)", "1234", "F", "FE"),
    both("log", "log(#0)", "1234", "F", "F>"),
    both("log2", "log2(#0)", "1234", "F", "F>"),
    both("sin", "sin(#0)", "1234", "F", "FE"),
    both("cos", "cos(#0)", "1234", "F", "FE"),
    both("tan", "tan(#0)", "1234", "F", "F1"),
    both("asin", "asin(#0)", "1234", "F", "F1"),
    both("acos", "acos(#0)", "1234", "F", "F1"),
    both("atan", "atan(#0)", "1234", "F", "F"),
    row("atan2", "atan(#0, #1)", "atan2(#0, #1)", "1234", "F", "F F0"),
    both("sinh", "sinh(#0)", "1234", "F", "FE"),
    both("cosh", "cosh(#0)", "1234", "F", "FE"),
    both("tanh", "tanh(#0)", "1234", "F", "FE"),
    both("asinh", "asinh(#0)", "1234", "F", "F"),
    both("acosh", "acosh(#0)", "1234", "F", "F^"),
    both("atanh", "atanh(#0)", "1234", "F", "Fh"),
    both("radians", "radians(#0)", "1234", "F", "F"),
    both("degrees", "degrees(#0)", "1234", "F", "F"),
    row("saturate", "", "saturate(#0)", "1234", "F", "F"),
    both("min", "min(#0, #1)", "1234", "F", "F F"),
    both("max", "max(#0, #1)", "1234", "F", "F F"),
    both("pow", "pow(#0, #1)", "1234", "F", "F> FE"),
    both("step", "step(#0, #1)", "1234", "F", "F F"),
    row("mod", "mod(#0, #1)", "", "1234", "F", "F F0"),
    row("%", "", "(#0 % #1)", "1234", "F", "F F0"),
    both("clamp", "clamp(#0, min(#1, #2), max(#1, #2))", "1234", "F", "F F F"),
    both("smoothstep", "smoothstep(-abs(#0) - @T(0.5), abs(#1) + @T(0.5), #2)", "1234", "F", "F F F"),
    both("mix", "mix(#0, #1, #2)", "1234", "F", "F F F"),
    both("mix by one", "mix(#0, #1, #2)", "234", "F", "F F f"),
    both("fma", "fma(#0, #1, #2)", "1234", "F", "F F F"),
    both("ldexp", "ldexp(#0, #1)", "1234", "F", "F Ie"),
    row("modf fract", "", "modf(#0).fract", "1234", "F", "F"),
    row("modf whole", "", "modf(#0).whole", "1234", "F", "F"),
    row("frexp fract", "", "frexp(#0).fract", "1234", "F", "F"),
    row("frexp exp", "", "frexp(#0).exp", "1234", "I", "F>"),
    row("quantizeToF16", "", "quantizeToF16(#0)", "1234", "F", "FH"),
    // Vectors.
    both("dot", "dot(#0, #1)", "234", "f", "F F"),
    both("length", "length(#0)", "234", "f", "F"),
    both("distance", "distance(#0, #1)", "234", "f", "F F"),
    both("cross", "cross(#0, #1)", "3", "F", "F F"),
    both("normalize", "normalize(#0)", "234", "F", "Fv"),
    row("faceforward", "faceforward(#0, #1, #2)", "faceForward(#0, #1, #2)", "234", "F", "F F F"),
    both("reflect", "reflect(#0, #1)", "234", "F", "F Fn"),
    both("refract", "refract(#0, #1, #2)", "234", "F", "Fn Fn f1"),
    row("dot of int", "", "dot(#0, #1)", "234", "i", "I I"),
    row("dot of uint", "", "dot(#0, #1)", "234", "u", "U U"),
    // Matrices.
    both("matrix * vector", "(#0 * #1)", "234", "V", "M F"),
    both("vector * matrix", "(#0 * #1)", "234", "F", "V M"),
    both("matrix * matrix", "(#0 * #1)", "234", "S", "M T"),
    both("matrix + matrix", "(#0 + #1)", "234", "M", "M M"),
    both("matrix - matrix", "(#0 - #1)", "234", "M", "M M"),
    both("matrix * number", "(#0 * #1)", "234", "M", "M f"),
    both("transpose", "transpose(#0)", "234", "T", "M"),
    both("determinant", "determinant(#0)", "234", "f", "S"),
    row("matrixCompMult", "matrixCompMult(#0, #1)", "", "234", "M", "M M"),
    row("outerProduct", "outerProduct(#0, #1)", "", "234", "M", "V F"),
    // Integers.
    both("abs of int", "abs(#0)", "1234", "I", "I"),
    both("sign of int", "sign(#0)", "1234", "I", "I"),
    both("min of int", "min(#0, #1)", "1234", "I", "I I"),
    both("max of int", "max(#0, #1)", "1234", "I", "I I"),
    both("min of uint", "min(#0, #1)", "1234", "U", "U U"),
    both("max of uint", "max(#0, #1)", "1234", "U", "U U"),
    both("clamp of int", "clamp(#0, min(#1, #2), max(#1, #2))", "1234", "I", "I I I"),
    both("clamp of uint", "clamp(#0, min(#1, #2), max(#1, #2))", "1234", "U", "U U U"),
    row("bitCount", "bitCount(#0)", "countOneBits(#0)", "1234", "I", "I"),
    row("bitCount of uint", "bitCount(#0)", "", "1234", "I", "U"),
    row("countOneBits of uint", "", "countOneBits(#0)", "1234", "U", "U"),
    row("findLSB", "findLSB(#0)", "firstTrailingBit(#0)", "1234", "I", "I"),
    row("findMSB", "findMSB(#0)", "firstLeadingBit(#0)", "1234", "I", "I"),
    row("findMSB of uint", "findMSB(#0)", "", "1234", "I", "U"),
    row("firstLeadingBit of uint", "", "firstLeadingBit(#0)", "1234", "U", "U"),
    row("firstTrailingBit of uint", "", "firstTrailingBit(#0)", "1234", "U", "U"),
    row("countLeadingZeros", "", "countLeadingZeros(#0)", "1234", "U", "U"),
    row("countTrailingZeros", "", "countTrailingZeros(#0)", "1234", "I", "I"),
    row("bitfieldReverse", "bitfieldReverse(#0)", "reverseBits(#0)", "1234", "U", "U"),
    row("bitfieldReverse of int", "bitfieldReverse(#0)", "reverseBits(#0)", "1234", "I", "I"),
    row("bitfieldExtract", "bitfieldExtract(#0, #1, #2)", "", "1234", "I", "I ik ik"),
    row("bitfieldExtract of uint", "bitfieldExtract(#0, #1, #2)", "", "1234", "U", "U ik ik"),
    row("bitfieldInsert", "bitfieldInsert(#0, #1, #2, #3)", "", "1234", "U", "U U ik ik"),
    row("bitfieldInsert of int", "bitfieldInsert(#0, #1, #2, #3)", "", "1234", "I", "I I ik ik"),
    row("extractBits", "", "extractBits(#0, #1, #2)", "1234", "I", "I uk uk"),
    row("extractBits of uint", "", "extractBits(#0, #1, #2)", "1234", "U", "U uk uk"),
    row("insertBits", "", "insertBits(#0, #1, #2, #3)", "1234", "U", "U U uk uk"),
    row("dot4U8Packed", "", "dot4U8Packed(#0, #1)", "1", "U", "U U"),
    row("dot4I8Packed", "", "dot4I8Packed(#0, #1)", "1", "I", "U U"),
    // Conversions.
    both("float of int", "@T(#0)", "1234", "F", "I"),
    both("float of uint", "@T(#0)", "1234", "F", "U"),
    both("float of bool", "@T(#0)", "1234", "F", "B"),
    both("int of float", "@T(#0)", "1234", "I", "Fc"),
    both("uint of float", "@T(#0)", "1234", "U", "FC"),
    both("int of uint", "@T(#0)", "1234", "I", "U"),
    both("uint of int", "@T(#0)", "1234", "U", "I"),
    both("int of bool", "@T(#0)", "1234", "I", "B"),
    both("uint of bool", "@T(#0)", "1234", "U", "B"),
    both("bool of int", "@T(#0)", "1234", "B", "I"),
    both("bool of uint", "@T(#0)", "1234", "B", "U"),
    row("bits of float", "floatBitsToInt(#0)", "bitcast<@T>(#0)", "1234", "I", "F"),
    row("bits of float as uint", "floatBitsToUint(#0)", "bitcast<@T>(#0)", "1234", "U", "F"),
    row("float of bits", "intBitsToFloat(#0)", "bitcast<@T>(#0)", "1234", "F", "Ib"),
    row("float of uint bits", "uintBitsToFloat(#0)", "bitcast<@T>(#0)", "1234", "F", "Ub"),
    row("packSnorm4x8", "packSnorm4x8(#0)", "pack4x8snorm(#0)", "1", "u", "F4"),
    row("packUnorm4x8", "packUnorm4x8(#0)", "pack4x8unorm(#0)", "1", "u", "F4"),
    row("packSnorm2x16", "packSnorm2x16(#0)", "pack2x16snorm(#0)", "1", "u", "F2"),
    row("packUnorm2x16", "packUnorm2x16(#0)", "pack2x16unorm(#0)", "1", "u", "F2"),
    row("packHalf2x16", "packHalf2x16(#0)", "pack2x16float(#0)", "1", "u", "F2H"),
    row("unpackSnorm4x8", "unpackSnorm4x8(#0)", "unpack4x8snorm(#0)", "4", "F", "u"),
    row("unpackUnorm4x8", "unpackUnorm4x8(#0)", "unpack4x8unorm(#0)", "4", "F", "u"),
    row("unpackSnorm2x16", "unpackSnorm2x16(#0)", "unpack2x16snorm(#0)", "2", "F", "u"),
    row("unpackUnorm2x16", "unpackUnorm2x16(#0)", "unpack2x16unorm(#0)", "2", "F", "u"),
    row("unpackHalf2x16", "unpackHalf2x16(#0)", "unpack2x16float(#0)", "2", "F", "ux"),
    row("pack4xU8", "", "pack4xU8(#0)", "4", "u", "U4"),
    row("pack4xI8", "", "pack4xI8(#0)", "4", "u", "I4"),
    row("pack4xU8Clamp", "", "pack4xU8Clamp(#0)", "4", "u", "U4"),
    row("pack4xI8Clamp", "", "pack4xI8Clamp(#0)", "4", "u", "I4"),
    row("unpack4xU8", "", "unpack4xU8(#0)", "4", "U", "u"),
    row("unpack4xI8", "", "unpack4xI8(#0)", "4", "I", "u"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_read() {
        assert_eq!(Letter::read("F1"), (Letter::Many(Scalar::Float), Some(b'1')));
        assert_eq!(Letter::read("f1"), (Letter::Fixed(Scalar::Float, 1), Some(b'1')));
        assert_eq!(Letter::read("F2H"), (Letter::Fixed(Scalar::Float, 2), Some(b'H')));
        assert_eq!(Letter::read("F4"), (Letter::Fixed(Scalar::Float, 4), None));
        assert_eq!(Letter::read("Ip"), (Letter::Many(Scalar::Int), Some(b'p')));
        assert_eq!(Letter::read("uk"), (Letter::Fixed(Scalar::Uint, 1), Some(b'k')));
    }

    #[test]
    fn every_guard_that_is_asked_for_is_there_for_its_type() {
        for operation in OPERATIONS {
            for (letter, guard) in operation.arguments() {
                let Some(guard) = guard else { continue };
                let ty = letter.of(if operation.allows(1) { 1 } else { 2 }, 2);
                let found = OPERATIONS.iter().any(|row| row.guard() == Some(guard) && row.giving(&ty).is_some());
                assert!(found, "{}: {}", operation.name, char::from(guard));
            }
        }
    }
}
