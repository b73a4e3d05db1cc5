//! The operations that a profile makes promises about, and their exact values.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use program::interp::{Binary, Unary};

/// Monotone in each argument where it is defined.
const MONOTONE: u8 = 1;
/// Values of no form that binary64 holds: next to a binary32 number they may be off it by less than binary64 tells, as e^x is
/// next to 1.
const INEXACT: u8 = 2;

/// Operations with their names, their numbers of scalar arguments, `-` where they have none, and what else holds for them.
macro_rules! operations {
    (@arity -) => { None };
    (@arity $arity:literal) => { Some($arity) };
    ($($op:ident $name:literal $arity:tt $($flag:ident)*;)*) => {
        /// An operation on binary32 numbers, as profiles list them.
        ///
        /// Some are scalar: they have an exact value ([`Op::exact`]) and can be measured. The others take vectors or are made of
        /// several operations; a profile says by which formula they are bounded, and whoever propagates errors expands them.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[expect(missing_docs, reason = "each operation is called as GLSL calls it; `glsl` gives the expression")]
        pub enum Op {
            $($op,)*
        }

        impl Op {
            /// All operations, in the order of the tables.
            pub const ALL: [Self; [$(Self::$op),*].len()] = [$(Self::$op),*];

            /// Name in profiles and on the command line.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$op => $name,)*
                }
            }

            /// Number of scalar arguments; `None` for operations on vectors and for those that are not one
            /// operation of the device.
            pub fn arity(self) -> Option<usize> {
                match self {
                    $(Self::$op => operations!(@arity $arity),)*
                }
            }

            fn flags(self) -> u8 {
                match self {
                    $(Self::$op => 0 $(| $flag)*,)*
                }
            }
        }
    };
}

operations! {
    Add "add" 2 MONOTONE; Sub "sub" 2 MONOTONE; Mul "mul" 2 MONOTONE; Div "div" 2; Rem "rem" 2; Mod "mod" 2;
    Fma "fma" 3 MONOTONE; Neg "neg" 1 MONOTONE; Abs "abs" 1; Sign "sign" 1 MONOTONE; Min "min" 2 MONOTONE;
    Max "max" 2 MONOTONE; Step "step" 2 MONOTONE; Floor "floor" 1 MONOTONE; Ceil "ceil" 1 MONOTONE;
    Trunc "trunc" 1 MONOTONE; RoundEven "roundEven" 1 MONOTONE; Fract "fract" 1; Ldexp "ldexp" -;
    Sqrt "sqrt" 1 MONOTONE; InverseSqrt "inversesqrt" 1 MONOTONE INEXACT; Radians "radians" 1 MONOTONE INEXACT;
    Degrees "degrees" 1 MONOTONE INEXACT; Sin "sin" 1 INEXACT; Cos "cos" 1 INEXACT; Tan "tan" 1 INEXACT;
    Asin "asin" 1 MONOTONE INEXACT; Acos "acos" 1 MONOTONE INEXACT; Atan "atan" 1 MONOTONE INEXACT;
    Atan2 "atan2" 2 INEXACT; Sinh "sinh" 1 MONOTONE INEXACT; Cosh "cosh" 1 INEXACT; Tanh "tanh" 1 MONOTONE INEXACT;
    Asinh "asinh" 1 MONOTONE INEXACT; Acosh "acosh" 1 MONOTONE INEXACT; Atanh "atanh" 1 MONOTONE INEXACT;
    Exp "exp" 1 MONOTONE INEXACT; Exp2 "exp2" 1 MONOTONE INEXACT; Log "log" 1 MONOTONE INEXACT;
    Log2 "log2" 1 MONOTONE INEXACT; Pow "pow" 2 MONOTONE INEXACT; Convert "convert" -; Mix "mix" -; Clamp "clamp" -;
    SmoothStep "smoothstep" -; Dot "dot" -; Length "length" -; Distance "distance" -; Normalize "normalize" -;
    Cross "cross" -; Reflect "reflect" -; Refract "refract" -; FaceForward "faceforward" -;
    MatrixProduct "matrix-product" -; Determinant "determinant" -; Inverse "inverse" -;
}

/// What the interpreter does to one number that profiles do not list as one operation on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unlisted {
    /// 1/√x of the square of a length.
    NormalScale,
    /// A mark on a determinant.
    Determinant,
    /// A mark on a component of an inverse.
    Inverse,
    /// To a lower precision.
    Narrow,
    /// To binary16.
    Half,
    /// The fraction of `frexp`.
    FrexpFraction,
}

use Op::*;

/// A function of one number on columns: arguments, and where the values go.
pub type ColumnFunction = fn(&[f64], &mut [f64]);

impl Op {
    /// The operation of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|op| op.name() == name)
    }

    /// True where it is monotone in each argument, as far as it is defined.
    pub fn is_monotone(self) -> bool {
        self.flags() & MONOTONE != 0
    }

    /// True where its values are of no form that binary64 holds.
    pub fn is_inexact(self) -> bool {
        self.flags() & INEXACT != 0
    }

    /// What the interpreter does to one number.
    pub fn of_unary(op: Unary) -> Result<Self, Unlisted> {
        macro_rules! alike {
            ($($op:ident)*) => { match op {
                $(Unary::$op => Ok($op),)*
                Unary::Negate => Ok(Neg),
                Unary::Round => Ok(RoundEven),
                Unary::NormalScale => Err(Unlisted::NormalScale),
                Unary::Determinant => Err(Unlisted::Determinant),
                Unary::Inverse => Err(Unlisted::Inverse),
                Unary::Narrow => Err(Unlisted::Narrow),
                Unary::Half => Err(Unlisted::Half),
                Unary::FrexpFraction => Err(Unlisted::FrexpFraction),
            } };
        }
        alike!(Abs Sign Floor Ceil Trunc Fract Sqrt InverseSqrt Exp Exp2 Log Log2 Sin Cos Tan Asin Acos Atan Sinh Cosh Tanh
            Asinh Acosh Atanh Radians Degrees)
    }

    /// What the interpreter does to two numbers.
    pub fn of_binary(op: Binary) -> Self {
        match op {
            Binary::Add => Add,
            Binary::Subtract => Sub,
            Binary::Multiply => Mul,
            Binary::Divide => Div,
            Binary::Remainder => Rem,
            Binary::Min => Min,
            Binary::Max => Max,
            Binary::Pow => Pow,
            Binary::Atan2 => Atan2,
            Binary::Step => Step,
        }
    }

    /// The value in real numbers, in binary64 with an error below 2 ULP of binary64 for the functions
    /// and correctly rounded for the arithmetic: below 2^-27 ULP of binary32. NaN where the
    /// specifications define no value, and for operations without [`Op::arity`].
    ///
    /// `args` holds at least as many numbers as the arity; missing ones count as NaN.
    #[inline]
    pub fn exact(self, args: &[f64]) -> f64 {
        let at = |k: usize| args.get(k).copied().unwrap_or(f64::NAN);
        let (x, y) = (at(0), at(1));
        let defined = |condition: bool, value: f64| if condition { value } else { f64::NAN };
        match self {
            Add => x + y,
            Sub => x - y,
            Mul => x * y,
            Div => defined(y != 0.0, x / y),
            // `%` of f64 is exact: no quotient is rounded.
            Rem => defined(y != 0.0, x % y),
            Mod => defined(y != 0.0, floored_remainder(x, y)),
            Fma => x.mul_add(y, at(2)),
            Neg => -x,
            Abs => x.abs(),
            Sign => {
                if x == 0.0 {
                    0.0
                } else {
                    x.signum()
                }
            }
            Min => x.min(y),
            Max => x.max(y),
            Step => f64::from(u8::from(y >= x)),
            Floor => x.floor(),
            Ceil => x.ceil(),
            Trunc => x.trunc(),
            RoundEven => x.round_ties_even(),
            Fract => x - x.floor(),
            Sqrt => defined(x >= 0.0, x.sqrt()),
            InverseSqrt => defined(x > 0.0, 1.0 / x.sqrt()),
            Radians => x * (std::f64::consts::PI / 180.0),
            Degrees => x * (180.0 / std::f64::consts::PI),
            Sin => number::SIN.value(x),
            Cos => number::COS.value(x),
            Tan => number::TAN.value(x),
            Asin => number::ASIN.value(x),
            Acos => number::ACOS.value(x),
            Atan => number::ATAN.value(x),
            Atan2 => defined(x != 0.0 || y != 0.0, number::ATAN2.value(x, y)),
            Sinh => x.sinh(),
            Cosh => x.cosh(),
            Tanh => x.tanh(),
            Asinh => inverse_sinh(x),
            Acosh => defined(x >= 1.0, inverse_cosh(x)),
            Atanh => defined(x.abs() < 1.0, inverse_tanh(x)),
            Exp => number::EXP.value(x),
            Exp2 => number::EXP2.value(x),
            Log => defined(x > 0.0, number::LN.value(x)),
            Log2 => defined(x > 0.0, number::LOG2.value(x)),
            // GLSL 4.60, 8.2: undefined for x < 0, and for x = 0 with y <= 0.
            Pow => defined(x > 0.0 || (x == 0.0 && y > 0.0), number::POW.value(x, y)),
            Ldexp | Convert | Mix | Clamp | SmoothStep | Dot | Length | Distance | Normalize | Cross | Reflect
            | Refract | FaceForward | MatrixProduct | Determinant | Inverse => f64::NAN,
        }
    }

    /// [`Op::exact`] of a function of one argument, for a column of arguments: the same bits.
    pub fn column(self) -> Option<ColumnFunction> {
        fn logarithm(function: number::Unary, x: &[f64], out: &mut [f64]) {
            function.column(x, out);
            // The logarithm of zero is undefined.
            x.iter().zip(out).filter(|(x, _)| **x == 0.0).for_each(|(_, out)| *out = f64::NAN);
        }
        // One closure for each: the compiler resolves the operation in it.
        macro_rules! columns {
            ($($op:ident)*) => { match self {
                Sin => Some(|x, out| number::SIN.column(x, out)),
                Cos => Some(|x, out| number::COS.column(x, out)),
                Tan => Some(|x, out| number::TAN.column(x, out)),
                Asin => Some(|x, out| number::ASIN.column(x, out)),
                Acos => Some(|x, out| number::ACOS.column(x, out)),
                Atan => Some(|x, out| number::ATAN.column(x, out)),
                Exp => Some(|x, out| number::EXP.column(x, out)),
                Exp2 => Some(|x, out| number::EXP2.column(x, out)),
                Log => Some(|x, out| logarithm(number::LN, x, out)),
                Log2 => Some(|x, out| logarithm(number::LOG2, x, out)),
                $($op => Some(|x, out| number::map(x, out, |x| $op.exact(&[x]))),)*
                _ => None,
            } };
        }
        columns!(Neg Abs Sign Floor Ceil Trunc RoundEven Fract Sqrt InverseSqrt Radians Degrees Sinh Cosh Tanh Asinh
            Acosh Atanh)
    }

    /// The number by whose binade errors are tabulated: the argument of a function of one, and for
    /// others what their error depends on: the exponent y·log2(x) of `pow`, the quotient otherwise.
    pub fn key(self, args: &[f64]) -> f64 {
        match (self, args) {
            (Pow, [x, y, ..]) => y * x.log2(),
            (Atan2 | Div | Rem | Mod, [x, y, ..]) => x / y,
            (Add | Sub | Mul | Fma, _) => self.exact(args),
            (_, [x, ..]) => *x,
            (_, []) => f64::NAN,
        }
    }
}

/// x − y·⌊x/y⌋ without a rounded quotient.
fn floored_remainder(x: f64, y: f64) -> f64 {
    let r = x % y;
    if r != 0.0 && (r < 0.0) != (y < 0.0) { r + y } else { r }
}

/// The standard library's `asinh` loses relative accuracy for small arguments on some platforms.
fn inverse_sinh(x: f64) -> f64 {
    let a = x.abs();
    // a + a²/(1 + √(a² + 1)) is √(a² + 1) + a − 1 without cancellation.
    (a + a * a / (1.0 + (a * a + 1.0).sqrt())).ln_1p().copysign(x)
}

fn inverse_cosh(x: f64) -> f64 {
    // x − 1 is exact for binary32 arguments near 1, where the result is small.
    let t = x - 1.0;
    (t + (t * (x + 1.0)).sqrt()).ln_1p()
}

fn inverse_tanh(x: f64) -> f64 {
    let a = x.abs();
    (0.5 * (2.0 * a / (1.0 - a)).ln_1p()).copysign(x)
}

/// By name.
impl Serialize for Op {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Op {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let name = String::deserialize(from)?;
        Self::by_name(&name).ok_or_else(|| D::Error::custom(format!("there is no operation `{name}`")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operation_is_listed_once_under_its_name() {
        for (k, op) in Op::ALL.into_iter().enumerate() {
            assert_eq!(op as usize, k);
            assert_eq!(Op::by_name(op.name()), Some(op));
        }
        assert_eq!(Op::by_name("sine"), None);
    }

    #[test]
    fn functions_of_one_argument_have_columns_with_the_same_values() {
        let x = [0.3, 1.7, -2.0, 0.0, -0.0, 1.0, 1e30];
        for op in Op::ALL {
            assert_eq!(op.column().is_some(), op.arity() == Some(1), "{op:?}");
            let Some(column) = op.column() else { continue };
            let mut values = [7.0; 7];
            column(&x, &mut values);
            for (x, value) in x.into_iter().zip(values) {
                let exact = op.exact(&[x]);
                assert!(value.to_bits() == exact.to_bits() || (value.is_nan() && exact.is_nan()), "{op:?} {x}");
            }
        }
    }

    #[test]
    fn hyperbolic_inverses_keep_relative_accuracy_near_their_zeros() {
        // Series: asinh x = x − x³/6, atanh x = x + x³/3, acosh(1 + t) = √(2t)·(1 − t/12).
        for x in [1e-9, -3e-6, 2e-4_f64] {
            assert!((inverse_sinh(x) / (x - x.powi(3) / 6.0) - 1.0).abs() < 1e-15, "{x}");
            assert!((inverse_tanh(x) / (x + x.powi(3) / 3.0) - 1.0).abs() < 1e-15, "{x}");
        }
        let t = 2f64.powi(-23);
        assert!((inverse_cosh(1.0 + t) / ((2.0 * t).sqrt() * (1.0 - t / 12.0)) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn values_that_no_specification_defines_are_no_numbers() {
        for (op, args) in [
            (Div, [1.0, 0.0]),
            (Sqrt, [-1.0, 0.0]),
            (InverseSqrt, [0.0, 0.0]),
            (Asin, [1.5, 0.0]),
            (Acosh, [0.5, 0.0]),
            (Log2, [0.0, 0.0]),
            (Pow, [-1.0, 2.0]),
            (Pow, [0.0, 0.0]),
            (Atan2, [0.0, 0.0]),
            (Dot, [1.0, 1.0]),
        ] {
            assert!(op.exact(&args).is_nan(), "{op:?}");
        }
    }

    #[test]
    fn mod_follows_the_sign_of_the_divisor_and_rem_that_of_the_dividend() {
        assert_eq!((Mod.exact(&[-1.0, 3.0]), Rem.exact(&[-1.0, 3.0])), (2.0, -1.0));
        assert_eq!((Mod.exact(&[1.0, -3.0]), Rem.exact(&[1.0, -3.0])), (-2.0, 1.0));
    }
}
