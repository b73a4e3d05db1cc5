//! Whole numbers of 64 bits: two words, the lower one first. Their operations become operations on words, so that whatever
//! looks at those looks at these as well.

use std::rc::Rc;

use naga::{BinaryOperator, MathFunction, Scalar as Type, ScalarKind, TypeInner, UnaryOperator};

use super::super::code::{Register, Word1, Word2};
use super::super::domain::{Binary, FromWords, Site};
use super::math::Args;
use super::{Compiler, InterpError, unsupported};
use base::value::Scalar::{self, Bool, F32, I32, U32};

/// The lower and the upper word.
type Wide = [Register; 2];

/// True for a whole number of 64 bits.
pub(super) fn is_wide(scalar: Option<Type>) -> bool {
    scalar.is_some_and(|s| s.width == 8 && matches!(s.kind, ScalarKind::Sint | ScalarKind::Uint))
}

/// Registers of one scalar.
pub(super) fn words(scalar: Option<Type>) -> usize {
    if is_wide(scalar) { 2 } else { 1 }
}

impl Compiler<'_> {
    /// A function of values whose components are whole numbers of 64 bits; a scalar stands for a vector of it.
    pub(super) fn wide_function(
        &mut self,
        site: Site,
        fun: MathFunction,
        args: &Args,
        first: &TypeInner,
        span: naga::Span,
    ) -> Result<Vec<Register>, InterpError> {
        let refuse = || unsupported(format!("`{fun:?}` of 64-bit integers"), span);
        let signed = first.scalar().is_some_and(|scalar| scalar.kind == ScalarKind::Sint);
        let count = args.iter().map(|arg| arg.len() / 2).max().unwrap_or(0);
        let mut all = Vec::new();
        for k in 0..count {
            let own = |arg: &Rc<[Register]>| {
                let at = if arg.len() == 2 { 0 } else { 2 * k };
                Some([*arg.get(at)?, *arg.get(at + 1)?])
            };
            let parts: Option<Vec<Wide>> = args.iter().map(own).collect();
            all.extend(parts.and_then(|parts| self.wide_math(site, fun, signed, &parts)).ok_or_else(refuse)?);
        }
        Ok(all)
    }

    pub(super) fn wide_number(&mut self, value: u64) -> Vec<Register> {
        #[expect(clippy::cast_possible_truncation, reason = "the two halves")]
        let halves = [value as u32, (value >> 32) as u32];
        halves.map(|half| self.word(half, U32)).to_vec()
    }

    fn low(&mut self, site: Site, op: Word2, a: Register, b: Register) -> Register {
        self.word2(site, op, a, b, U32)
    }

    fn of(&mut self, value: u32) -> Register {
        self.word(value, U32)
    }

    fn each_half(&mut self, a: Wide, b: Wide, mut f: impl FnMut(&mut Self, Register, Register) -> Register) -> Wide {
        [f(self, a[0], b[0]), f(self, a[1], b[1])]
    }

    fn choose(&mut self, condition: Register, a: Wide, b: Wide) -> Wide {
        self.each_half(a, b, |this, a, b| this.select(condition, a, b))
    }

    /// An operator on numbers that are both wide, but for the distance of a shift; `None` for operators that these have not.
    pub(super) fn wide_operator(
        &mut self,
        site: Site,
        op: BinaryOperator,
        signed: bool,
        a: Wide,
        b: &[Register],
    ) -> Option<Vec<Register>> {
        use BinaryOperator as Op;
        let pair = || <[Register; 2]>::try_from(b).ok();
        let whole = |wide: Wide| Some(wide.to_vec());
        match op {
            Op::ShiftLeft => whole(self.wide_left(site, a, *b.first()?)),
            Op::ShiftRight => whole(self.wide_right(site, signed, a, *b.first()?)),
            Op::Add => whole(self.wide_sum(site, a, pair()?)),
            Op::Subtract => whole(self.wide_difference(site, a, pair()?)),
            Op::Multiply => whole(self.wide_product(site, a, pair()?)),
            Op::Divide => whole(self.wide_quotient(site, signed, a, pair()?).0),
            Op::Modulo => whole(self.wide_quotient(site, signed, a, pair()?).1),
            Op::And => whole(self.each_half(a, pair()?, |this, a, b| this.low(site, Word2::And, a, b))),
            Op::InclusiveOr => whole(self.each_half(a, pair()?, |this, a, b| this.low(site, Word2::Or, a, b))),
            Op::ExclusiveOr => whole(self.each_half(a, pair()?, |this, a, b| this.low(site, Word2::Xor, a, b))),
            Op::Equal => Some(vec![self.wide_equal(site, a, pair()?)]),
            Op::NotEqual => {
                let equal = self.wide_equal(site, a, pair()?);
                Some(vec![self.word1(site, Word1::LogicalNot, equal, Bool)])
            }
            Op::Less => Some(vec![self.wide_less(site, signed, a, pair()?)]),
            Op::Greater => Some(vec![self.wide_less(site, signed, pair()?, a)]),
            Op::LessEqual | Op::GreaterEqual => {
                let (a, b) = if op == Op::LessEqual { (pair()?, a) } else { (a, pair()?) };
                let less = self.wide_less(site, signed, a, b);
                Some(vec![self.word1(site, Word1::LogicalNot, less, Bool)])
            }
            Op::LogicalAnd | Op::LogicalOr => None,
        }
    }

    pub(super) fn wide_unary(&mut self, site: Site, op: UnaryOperator, a: Wide) -> Option<Vec<Register>> {
        match op {
            UnaryOperator::Negate => Some(self.wide_negated(site, a).to_vec()),
            UnaryOperator::BitwiseNot => Some(a.map(|half| self.word1(site, Word1::Not, half, U32)).to_vec()),
            UnaryOperator::LogicalNot => None,
        }
    }

    /// A function of wide numbers; `None` for functions that these have not.
    fn wide_math(&mut self, site: Site, fun: MathFunction, signed: bool, args: &[Wide]) -> Option<Vec<Register>> {
        use MathFunction as Mf;
        let a = *args.first()?;
        let zero = self.of(0);
        let least = |this: &mut Self, a: Wide, b: Wide| {
            let less = this.wide_less(site, signed, b, a);
            this.choose(less, b, a)
        };
        let greatest = |this: &mut Self, a: Wide, b: Wide| {
            let less = this.wide_less(site, signed, a, b);
            this.choose(less, b, a)
        };
        let found = match fun {
            Mf::Abs if signed => self.wide_size(site, a).0,
            Mf::Abs => a,
            Mf::Sign => {
                let fill = self.wide_sign(site, a[1]);
                let any = self.low(site, Word2::Or, a[0], a[1]);
                let any = self.low(site, Word2::NotEqual, any, zero);
                [self.low(site, Word2::Or, fill, any), fill]
            }
            Mf::Min => least(self, a, *args.get(1)?),
            Mf::Max => greatest(self, a, *args.get(1)?),
            Mf::Clamp => {
                let raised = greatest(self, a, *args.get(1)?);
                least(self, raised, *args.get(2)?)
            }
            Mf::CountOneBits => {
                let [low, high] = a.map(|half| self.word1(site, Word1::Ones, half, U32));
                [self.low(site, Word2::AddUnsigned, low, high), zero]
            }
            Mf::ReverseBits => {
                let [low, high] = a.map(|half| self.word1(site, Word1::Reverse, half, U32));
                [high, low]
            }
            Mf::FirstTrailingBit => self.wide_first(site, Word1::FirstTrailing, a, [0, 32]),
            Mf::FirstLeadingBit => {
                // The highest bit that differs from the sign.
                let fill = if signed { self.wide_sign(site, a[1]) } else { zero };
                let [low, high] = a.map(|half| self.low(site, Word2::Xor, half, fill));
                self.wide_first(site, Word1::FirstLeadingUnsigned, [high, low], [32, 0])
            }
            _ => return None,
        };
        Some(found.to_vec())
    }

    /// The bit that is found in the first word, or else the one in the second, counted from where each begins; all ones where
    /// there is none.
    fn wide_first(&mut self, site: Site, op: Word1, [first, second]: Wide, begins: [u32; 2]) -> Wide {
        let (zero, none) = (self.of(0), self.of(u32::MAX));
        let [mut here, mut there] = [first, second].map(|word| self.word1(site, op, word, U32));
        for (found, begin) in [&mut here, &mut there].into_iter().zip(begins) {
            let begin = self.of(begin);
            *found = self.low(site, Word2::AddUnsigned, *found, begin);
        }
        let [is_here, is_there] = [first, second].map(|word| self.word2(site, Word2::NotEqual, word, zero, Bool));
        let else_there = self.choose(is_there, [there, zero], [none, none]);
        self.choose(is_here, [here, zero], else_there)
    }

    /// All ones for a negative number, else 0.
    fn wide_sign(&mut self, site: Site, high: Register) -> Register {
        let last = self.of(31);
        self.low(site, Word2::ShiftRightSigned, high, last)
    }

    fn wide_sum(&mut self, site: Site, a: Wide, b: Wide) -> Wide {
        let low = self.low(site, Word2::AddUnsigned, a[0], b[0]);
        let carry = self.low(site, Word2::LessUnsigned, low, a[0]);
        let high = self.low(site, Word2::AddUnsigned, a[1], b[1]);
        [low, self.low(site, Word2::AddUnsigned, high, carry)]
    }

    fn wide_difference(&mut self, site: Site, a: Wide, b: Wide) -> Wide {
        let low = self.low(site, Word2::SubtractUnsigned, a[0], b[0]);
        let borrowed = self.low(site, Word2::LessUnsigned, a[0], b[0]);
        let high = self.low(site, Word2::SubtractUnsigned, a[1], b[1]);
        [low, self.low(site, Word2::SubtractUnsigned, high, borrowed)]
    }

    fn wide_negated(&mut self, site: Site, a: Wide) -> Wide {
        let zero = self.of(0);
        self.wide_difference(site, [zero, zero], a)
    }

    /// The absolute value, and all ones where the number is negative.
    fn wide_size(&mut self, site: Site, a: Wide) -> (Wide, Register) {
        let sign = self.wide_sign(site, a[1]);
        let negated = self.wide_negated(site, a);
        (self.choose(Register { scalar: Bool, ..sign }, negated, a), sign)
    }

    fn wide_product(&mut self, site: Site, a: Wide, b: Wide) -> Wide {
        let (mask, half) = (self.of(0xffff), self.of(16));
        let parts = |this: &mut Self, word: Register| {
            [this.low(site, Word2::And, word, mask), this.low(site, Word2::ShiftRightUnsigned, word, half)]
        };
        let ([a0, a1], [b0, b1]) = (parts(self, a[0]), parts(self, b[0]));
        let mut product = |a, b| self.low(site, Word2::MultiplyUnsigned, a, b);
        let [low, cross, other, top] = [product(a0, b0), product(a1, b0), product(a0, b1), product(a1, b1)];
        let [whole, upper, lower] = [product(a[0], b[0]), product(a[0], b[1]), product(a[1], b[0])];
        // What the lower halves carry into the upper word, 16 bits at a time.
        let carried = self.low(site, Word2::ShiftRightUnsigned, low, half);
        let middle = self.low(site, Word2::AddUnsigned, cross, carried);
        let [below, above] = parts(self, middle);
        let middle = self.low(site, Word2::AddUnsigned, other, below);
        let carried = self.low(site, Word2::ShiftRightUnsigned, middle, half);
        let terms = [above, carried, upper, lower];
        let high = terms.into_iter().fold(top, |sum, term| self.low(site, Word2::AddUnsigned, sum, term));
        [whole, high]
    }

    /// Quotient and remainder, towards 0, bit by bit. A division by zero is told as one of words is, and gives what that gives.
    fn wide_quotient(&mut self, site: Site, signed: bool, a: Wide, b: Wide) -> (Wide, Wide) {
        let (zero, one) = (self.of(0), self.of(1));
        let any = self.low(site, Word2::Or, b[0], b[1]);
        self.low(site, Word2::DivideUnsigned, one, any);
        let ((size, sign), (divisor, other)) =
            if signed { (self.wide_size(site, a), self.wide_size(site, b)) } else { ((a, zero), (b, zero)) };
        let (mut quotient, mut rest) = ([zero; 2], [zero; 2]);
        for bit in (0..64_u32).rev() {
            let (word, distance) = (size[(bit / 32) as usize], self.of(bit % 32));
            let next = self.low(site, Word2::ShiftRightUnsigned, word, distance);
            let next = self.low(site, Word2::And, next, one);
            let over = self.wide_sign(site, rest[1]);
            let doubled = self.wide_sum(site, rest, rest);
            let doubled = [self.low(site, Word2::Or, doubled[0], next), doubled[1]];
            let less = self.wide_less(site, false, doubled, divisor);
            let fits = self.word1(site, Word1::LogicalNot, less, Bool);
            let over = self.word2(site, Word2::NotEqual, over, zero, Bool);
            let fits = self.word2(site, Word2::Or, fits, over, Bool);
            let reduced = self.wide_difference(site, doubled, divisor);
            rest = self.choose(fits, reduced, doubled);
            let set = self.low(site, Word2::ShiftLeft, Register { scalar: U32, ..fits }, distance);
            let half = &mut quotient[(bit / 32) as usize];
            *half = self.word2(site, Word2::Or, *half, set, U32);
        }
        if signed {
            let negative = self.word2(site, Word2::NotEqual, sign, other, Bool);
            let negated = [quotient, rest].map(|wide| self.wide_negated(site, wide));
            quotient = self.choose(negative, negated[0], quotient);
            rest = self.choose(Register { scalar: Bool, ..sign }, negated[1], rest);
        }
        let by_zero = self.word2(site, Word2::Equal, any, zero, Bool);
        (self.choose(by_zero, a, quotient), self.choose(by_zero, [zero; 2], rest))
    }

    fn wide_equal(&mut self, site: Site, a: Wide, b: Wide) -> Register {
        let [low, high] = self.each_half(a, b, |this, a, b| this.word2(site, Word2::Equal, a, b, Bool));
        self.word2(site, Word2::And, low, high, Bool)
    }

    fn wide_less(&mut self, site: Site, signed: bool, a: Wide, b: Wide) -> Register {
        let op = if signed { Word2::LessSigned } else { Word2::LessUnsigned };
        let less = self.word2(site, op, a[1], b[1], Bool);
        let equal = self.word2(site, Word2::Equal, a[1], b[1], Bool);
        let below = self.word2(site, Word2::LessUnsigned, a[0], b[0], Bool);
        let below = self.word2(site, Word2::And, equal, below, Bool);
        self.word2(site, Word2::Or, less, below, Bool)
    }

    /// A distance within one word, what is left of one word by it, and whether it goes beyond the word.
    fn wide_distance(&mut self, site: Site, by: Register) -> [Register; 3] {
        let (last, half) = (self.of(31), self.of(32));
        let within = self.low(site, Word2::And, by, last);
        let rest = self.low(site, Word2::SubtractUnsigned, last, within);
        let beyond = self.low(site, Word2::And, by, half);
        let zero = self.of(0);
        [within, rest, self.word2(site, Word2::NotEqual, beyond, zero, Bool)]
    }

    /// The lower six bits of the distance count.
    fn wide_left(&mut self, site: Site, a: Wide, by: Register) -> Wide {
        let ([within, rest, beyond], one, zero) = (self.wide_distance(site, by), self.of(1), self.of(0));
        let [low, high] = a.map(|half| self.low(site, Word2::ShiftLeft, half, within));
        // By two steps, since none may go beyond 31.
        let crossing = self.low(site, Word2::ShiftRightUnsigned, a[0], one);
        let crossing = self.low(site, Word2::ShiftRightUnsigned, crossing, rest);
        let high = self.low(site, Word2::Or, high, crossing);
        self.choose(beyond, [zero, low], [low, high])
    }

    fn wide_right(&mut self, site: Site, signed: bool, a: Wide, by: Register) -> Wide {
        let ([within, rest, beyond], one) = (self.wide_distance(site, by), self.of(1));
        let fill = if signed { self.wide_sign(site, a[1]) } else { self.of(0) };
        let op = if signed { Word2::ShiftRightSigned } else { Word2::ShiftRightUnsigned };
        let high = self.low(site, op, a[1], within);
        let low = self.low(site, Word2::ShiftRightUnsigned, a[0], within);
        let crossing = self.low(site, Word2::ShiftLeft, a[1], one);
        let crossing = self.low(site, Word2::ShiftLeft, crossing, rest);
        let low = self.low(site, Word2::Or, low, crossing);
        self.choose(beyond, [high, fill], [low, high])
    }

    /// To a wide number; `None` from a real one.
    pub(super) fn widened(&mut self, site: Site, a: Register) -> Option<Vec<Register>> {
        Some(match a.scalar {
            U32 | Bool => vec![Register { scalar: U32, ..a }, self.of(0)],
            I32 => vec![Register { scalar: U32, ..a }, self.wide_sign(site, a)],
            F32 => return None,
        })
    }

    /// From a wide number.
    pub(super) fn narrowed_to(&mut self, site: Site, signed: bool, a: Wide, target: Scalar) -> Register {
        match target {
            I32 | U32 => Register { scalar: target, ..a[0] },
            Bool => {
                let (any, zero) = (self.low(site, Word2::Or, a[0], a[1]), self.of(0));
                self.word2(site, Word2::NotEqual, any, zero, Bool)
            }
            F32 => {
                let high = self.reals_of(site, if signed { FromWords::Signed } else { FromWords::Unsigned }, a[1]);
                let low = self.reals_of(site, FromWords::Unsigned, a[0]);
                let step = self.real(4_294_967_296.0, None);
                let high = self.real2(site, Binary::Multiply, high, step);
                self.real2(site, Binary::Add, high, low)
            }
        }
    }
}
