//! Built-in functions. Those that the specifications define by a formula become the operations of
//! that formula, in its order.

use std::rc::Rc;

use naga::{MathFunction, TypeInner};

use super::super::code::{Constant, Field, Guarded, Inst, Register, Word1, Word2};
use super::super::domain::{Binary, Site, ToWords, Unary};
use super::{Compiler, InterpError, unsupported};
use base::value::Scalar;

pub(super) type Args = [Rc<[Register]>];

impl Compiler<'_> {
    pub(super) fn math(
        &mut self,
        site: Site,
        fun: MathFunction,
        args: &Args,
        first: &TypeInner,
        span: naga::Span,
    ) -> Result<Vec<Register>, InterpError> {
        self.math_of(site, fun, args, first).ok_or_else(|| unsupported(format!("`{fun:?}` of this type"), span))
    }

    /// `None` for types that have no such function.
    fn math_of(&mut self, site: Site, fun: MathFunction, args: &Args, first: &TypeInner) -> Option<Vec<Register>> {
        use MathFunction as Mf;
        let unary = |this: &mut Self, op| each(args, |v| Some(this.real1(site, op, real(v[0])?)));
        let guarded1 = |this: &mut Self, op, what| {
            each(args, |v| {
                let found = this.real1(site, op, real(v[0])?);
                Some(this.guard(site, what, found, [v[0], v[0]]))
            })
        };
        let guarded2 = |this: &mut Self, op, what| {
            each(args, |v| {
                let found = this.real2(site, op, real(v[0])?, real(v[1])?);
                Some(this.guard(site, what, found, [v[0], v[1]]))
            })
        };
        let bits = |this: &mut Self, signed, unsigned| {
            each(args, |v| match v[0].scalar {
                Scalar::I32 => Some(this.word1(site, signed, v[0], Scalar::I32)),
                Scalar::U32 => Some(this.word1(site, unsigned, v[0], Scalar::U32)),
                Scalar::F32 | Scalar::Bool => None,
            })
        };
        match fun {
            Mf::Cos => unary(self, Unary::Cos),
            Mf::Cosh => unary(self, Unary::Cosh),
            Mf::Sin => unary(self, Unary::Sin),
            Mf::Sinh => unary(self, Unary::Sinh),
            Mf::Tan => unary(self, Unary::Tan),
            Mf::Tanh => unary(self, Unary::Tanh),
            Mf::Acos => guarded1(self, Unary::Acos, Guarded::Acos),
            Mf::Asin => guarded1(self, Unary::Asin, Guarded::Asin),
            Mf::Atan => unary(self, Unary::Atan),
            Mf::Atan2 => guarded2(self, Binary::Atan2, Guarded::Atan2),
            Mf::Asinh => unary(self, Unary::Asinh),
            Mf::Acosh => guarded1(self, Unary::Acosh, Guarded::Acosh),
            Mf::Atanh => guarded1(self, Unary::Atanh, Guarded::Atanh),
            Mf::Radians => unary(self, Unary::Radians),
            Mf::Degrees => unary(self, Unary::Degrees),
            Mf::Ceil => unary(self, Unary::Ceil),
            Mf::Floor => unary(self, Unary::Floor),
            Mf::Round => unary(self, Unary::Round),
            Mf::Fract => unary(self, Unary::Fract),
            Mf::Trunc => unary(self, Unary::Trunc),
            Mf::Exp => unary(self, Unary::Exp),
            Mf::Exp2 => unary(self, Unary::Exp2),
            Mf::Log => guarded1(self, Unary::Log, Guarded::Log),
            Mf::Log2 => guarded1(self, Unary::Log2, Guarded::Log2),
            Mf::Pow => guarded2(self, Binary::Pow, Guarded::Pow),
            Mf::Sqrt => guarded1(self, Unary::Sqrt, Guarded::Sqrt),
            Mf::InverseSqrt => guarded1(self, Unary::InverseSqrt, Guarded::InverseSqrt),
            Mf::QuantizeToF16 => guarded1(self, Unary::Half, Guarded::Half),
            Mf::Abs
            | Mf::Sign
            | Mf::Min
            | Mf::Max
            | Mf::Clamp
            | Mf::Saturate
            | Mf::Modf
            | Mf::Frexp
            | Mf::Ldexp
            | Mf::Step
            | Mf::Fma
            | Mf::Mix
            | Mf::SmoothStep => self.composed(site, fun, args),
            Mf::Dot
            | Mf::Outer
            | Mf::Cross
            | Mf::Distance
            | Mf::Length
            | Mf::Normalize
            | Mf::FaceForward
            | Mf::Reflect
            | Mf::Refract
            | Mf::Inverse
            | Mf::Transpose
            | Mf::Determinant => self.geometric(site, fun, args, first),
            Mf::CountTrailingZeros => bits(self, Word1::TrailingZeros, Word1::TrailingZeros),
            Mf::CountLeadingZeros => bits(self, Word1::LeadingZeros, Word1::LeadingZeros),
            Mf::CountOneBits => bits(self, Word1::Ones, Word1::Ones),
            Mf::ReverseBits => bits(self, Word1::Reverse, Word1::Reverse),
            Mf::FirstTrailingBit => bits(self, Word1::FirstTrailing, Word1::FirstTrailing),
            Mf::FirstLeadingBit => bits(self, Word1::FirstLeadingSigned, Word1::FirstLeadingUnsigned),
            Mf::ExtractBits => each(args, |v| {
                let op = match v[0].scalar {
                    Scalar::I32 => Field::ExtractSigned,
                    Scalar::U32 => Field::ExtractUnsigned,
                    Scalar::F32 | Scalar::Bool => return None,
                };
                Some(self.field(Some(site), op, [v[0], v[1], v[2], v[2]]))
            }),
            Mf::InsertBits => each(args, |v| Some(self.field(Some(site), Field::Insert, [v[0], v[1], v[2], v[3]]))),
            Mf::Dot4I8Packed => Some(self.packed_dot(site, args, Field::ExtractSigned, Scalar::I32)),
            Mf::Dot4U8Packed => Some(self.packed_dot(site, args, Field::ExtractUnsigned, Scalar::U32)),
            Mf::Pack4x8snorm => Some(self.pack_fractions(site, args, 8, true)),
            Mf::Pack4x8unorm => Some(self.pack_fractions(site, args, 8, false)),
            Mf::Pack2x16snorm => Some(self.pack_fractions(site, args, 16, true)),
            Mf::Pack2x16unorm => Some(self.pack_fractions(site, args, 16, false)),
            Mf::Pack2x16float => Some(self.pack_halves(site, args)),
            Mf::Pack4xI8 | Mf::Pack4xU8 => Some(vec![self.pack(&args[0], 8)]),
            Mf::Pack4xI8Clamp => Some(self.pack_clamped(site, args, -128, 127)),
            Mf::Pack4xU8Clamp => Some(self.pack_clamped(site, args, 0, 255)),
            Mf::Unpack4x8snorm => Some(self.unpack_fractions(site, args, 8, true)),
            Mf::Unpack4x8unorm => Some(self.unpack_fractions(site, args, 8, false)),
            Mf::Unpack2x16snorm => Some(self.unpack_fractions(site, args, 16, true)),
            Mf::Unpack2x16unorm => Some(self.unpack_fractions(site, args, 16, false)),
            Mf::Unpack2x16float => Some(self.unpack_halves(site, args)),
            Mf::Unpack4xI8 => Some(self.unpack(args[0][0], 8, Field::ExtractSigned, Scalar::I32)),
            Mf::Unpack4xU8 => Some(self.unpack(args[0][0], 8, Field::ExtractUnsigned, Scalar::U32)),
        }
    }

    /// Functions that are several operations, or others for other types (GLSL 4.60, 8.3). `None` for the rest of them.
    fn composed(&mut self, site: Site, fun: MathFunction, args: &Args) -> Option<Vec<Register>> {
        use MathFunction as Mf;
        match fun {
            Mf::Abs => each(args, |v| match v[0].scalar {
                Scalar::F32 => Some(self.real1(site, Unary::Abs, v[0])),
                Scalar::I32 => Some(self.word1(site, Word1::Abs, v[0], Scalar::I32)),
                Scalar::U32 => Some(v[0]),
                Scalar::Bool => None,
            }),
            Mf::Sign => each(args, |v| match v[0].scalar {
                Scalar::F32 => Some(self.real1(site, Unary::Sign, v[0])),
                Scalar::I32 => Some(self.word1(site, Word1::Sign, v[0], Scalar::I32)),
                Scalar::U32 | Scalar::Bool => None,
            }),
            Mf::Min => each(args, |v| self.least(site, v[0], v[1])),
            Mf::Max => each(args, |v| self.greatest(site, v[0], v[1])),
            Mf::Clamp => each(args, |v| {
                let raised = self.greatest(site, v[0], v[1])?;
                let found = self.least(site, raised, v[2])?;
                Some(self.guard(site, Guarded::Clamp, found, [v[1], v[2]]))
            }),
            Mf::Saturate => {
                let (zero, one) = (self.real(0.0, None), self.real(1.0, None));
                each(args, |v| {
                    let raised = self.greatest(site, real(v[0])?, zero)?;
                    self.least(site, raised, one)
                })
            }
            Mf::Modf => {
                let whole = each(args, |v| Some(self.real1(site, Unary::Trunc, real(v[0])?)))?;
                let pairs = args[0].iter().zip(&whole);
                let mut all: Vec<Register> =
                    pairs.map(|(&x, &whole)| self.real2(site, Binary::Subtract, x, whole)).collect();
                all.extend(whole);
                Some(all)
            }
            Mf::Frexp => {
                let mut all = each(args, |v| Some(self.real1(site, Unary::FrexpFraction, real(v[0])?)))?;
                all.extend(args[0].iter().map(|&x| self.words_of(site, ToWords::FrexpExponent, x, Scalar::I32)));
                Some(all)
            }
            Mf::Ldexp => each(args, |v| {
                let to = self.temporary();
                self.push(Inst::Scale { to, a: real(v[0])?.reg, exponent: v[1].reg, site });
                Some(Register { scalar: Scalar::F32, reg: to })
            }),
            Mf::Step => each(args, |v| Some(self.real2(site, Binary::Step, real(v[0])?, real(v[1])?))),
            Mf::Fma => each(args, |v| {
                let product = self.real2(site, Binary::Multiply, real(v[0])?, real(v[1])?);
                Some(self.real2(site, Binary::Add, product, real(v[2])?))
            }),
            Mf::Mix => {
                let one = self.real(1.0, None);
                each(args, |v| {
                    let rest = self.real2(site, Binary::Subtract, one, real(v[2])?);
                    let x = self.real2(site, Binary::Multiply, real(v[0])?, rest);
                    let y = self.real2(site, Binary::Multiply, real(v[1])?, v[2]);
                    Some(self.real2(site, Binary::Add, x, y))
                })
            }
            Mf::SmoothStep => each(args, |v| {
                let found = self.smooth_step(site, real(v[0])?, real(v[1])?, real(v[2])?)?;
                Some(self.guard(site, Guarded::SmoothStep, found, [v[0], v[1]]))
            }),
            _ => None,
        }
    }

    /// The result of a function, with a note of the slots in which it is undefined. Constants show here already
    /// that it never is.
    pub(super) fn guard(&mut self, site: Site, what: Guarded, from: Register, args: [Register; 2]) -> Register {
        let to = Register { reg: self.temporary(), ..from };
        let regs = args.map(|register| register.reg);
        match from.scalar {
            Scalar::F32 => {
                if let [Some(x), Some(y)] = args.map(|register| self.constant_of(register))
                    && !what.is_outside(x, y)
                {
                    return from;
                }
                self.push(Inst::Guard { what, to: to.reg, from: from.reg, args: regs, site });
            }
            Scalar::I32 | Scalar::U32 | Scalar::Bool => {
                let signed = from.scalar == Scalar::I32;
                self.push(Inst::GuardWords { signed, to, from: from.reg, args: regs, site });
            }
        }
        to
    }

    /// The number that a register holds all the time.
    fn constant_of(&self, register: Register) -> Option<f64> {
        self.executable.constants.iter().find_map(|constant| match *constant {
            Constant::Real { to, value, .. } if to == register.reg => Some(f64::from(value)),
            Constant::Real { .. } | Constant::Word { .. } => None,
        })
    }

    fn least(&mut self, site: Site, a: Register, b: Register) -> Option<Register> {
        match a.scalar {
            Scalar::F32 => Some(self.real2(site, Binary::Min, a, b)),
            Scalar::I32 => Some(self.word2(site, Word2::MinSigned, a, b, Scalar::I32)),
            Scalar::U32 => Some(self.word2(site, Word2::MinUnsigned, a, b, Scalar::U32)),
            Scalar::Bool => None,
        }
    }

    fn greatest(&mut self, site: Site, a: Register, b: Register) -> Option<Register> {
        match a.scalar {
            Scalar::F32 => Some(self.real2(site, Binary::Max, a, b)),
            Scalar::I32 => Some(self.word2(site, Word2::MaxSigned, a, b, Scalar::I32)),
            Scalar::U32 => Some(self.word2(site, Word2::MaxUnsigned, a, b, Scalar::U32)),
            Scalar::Bool => None,
        }
    }

    /// t = clamp((x − low)/(high − low), 0, 1); t·t·(3 − 2t).
    fn smooth_step(&mut self, site: Site, low: Register, high: Register, x: Register) -> Option<Register> {
        let [zero, one, two, three] = [0.0, 1.0, 2.0, 3.0].map(|value| self.real(value, None));
        let above = self.real2(site, Binary::Subtract, x, low);
        let width = self.real2(site, Binary::Subtract, high, low);
        let ratio = self.real2(site, Binary::Divide, above, width);
        let raised = self.greatest(site, ratio, zero)?;
        let t = self.least(site, raised, one)?;
        let square = self.real2(site, Binary::Multiply, t, t);
        let twice = self.real2(site, Binary::Multiply, two, t);
        let rest = self.real2(site, Binary::Subtract, three, twice);
        Some(self.real2(site, Binary::Multiply, square, rest))
    }
}

fn real(register: Register) -> Option<Register> {
    (register.scalar == Scalar::F32).then_some(register)
}

/// Calls `f` with the components of all arguments, one after the other; a scalar stands for a vector
/// of it.
fn each(args: &Args, mut f: impl FnMut([Register; 4]) -> Option<Register>) -> Option<Vec<Register>> {
    let n = args.iter().map(|arg| arg.len()).max()?;
    (0..n)
        .map(|k| {
            let component = |arg: &Rc<[Register]>| if arg.len() == 1 { arg[0] } else { arg[k] };
            let last = component(args.last()?);
            let mut v = [last; 4];
            v.iter_mut().zip(args).for_each(|(v, arg)| *v = component(arg));
            f(v)
        })
        .collect()
}
