//! Operations on words, by the rules of WGSL, with a report where those rules paper over something.

use super::code::{Field, Reg, Register, Word1, Word2};
use super::domain::{Domain, Site};
use super::machine::Machine;
use super::meaning::HazardKind;
use super::slots::{Mask, SLOTS, Words};
use super::undefined::{Operand, Undefined};
use base::value::Scalar;

impl<D: Domain> Machine<'_, D> {
    #[inline]
    pub(super) fn word1(&mut self, op: Word1, to: Reg, a: Reg, site: Site) {
        let a = &self.words[a as usize];
        let (out, doubts) = (word1(op, a), doubts1(op, a));
        if let Some((kind, mask)) = doubts {
            self.report(kind, site, mask);
        }
        self.words[to as usize] = out;
    }

    #[inline]
    pub(super) fn word2(&mut self, op: Word2, to: Reg, args: [Reg; 2], site: Site) {
        let [a, b] = args.map(|reg| &self.words[reg as usize]);
        if let Some((question, signed)) = op.question() {
            self.domain.compare_words(site, question, signed, &self.active, a, b);
        }
        let (out, doubts) = (word2(op, a, b), doubts2(op, a, b));
        self.words[to as usize] = out;
        let args = operands(op, args);
        // An index is looked at again where it is used.
        let to = (op != Word2::Index).then_some(Register { scalar: Scalar::I32, reg: to });
        for (kind, mask) in doubts.into_iter().flatten() {
            self.undefined(Undefined { kind, site, what: None }, mask, to, args);
        }
    }

    #[inline]
    pub(super) fn field(&mut self, op: Field, to: Reg, args: [Reg; 4], site: Option<Site>) {
        let words = args.map(|reg| &self.words[reg as usize]);
        let outside = site.map_or(Mask::NONE, |_| doubts_of_field(op, words));
        self.words[to as usize] = field(op, words);
        if let Some(site) = site {
            let (offset, count) = bits_of(op);
            let found = Undefined { kind: HazardKind::BitField, site, what: None };
            let to = Register { scalar: Scalar::I32, reg: to };
            self.undefined(found, outside, Some(to), [args[offset], args[count]].map(Operand::Signed));
        }
    }
}

#[inline]
fn map(a: &Words, f: impl Fn(u32) -> u32) -> Words {
    let mut out = [0; SLOTS];
    for (out, &a) in out.iter_mut().zip(a) {
        *out = f(a);
    }
    out
}

#[inline]
fn signed(a: &Words, f: impl Fn(i32) -> i32) -> Words {
    map(a, |a| f(a.cast_signed()).cast_unsigned())
}

pub(super) fn word1(op: Word1, a: &Words) -> Words {
    match op {
        Word1::Not => map(a, |a| !a),
        Word1::LogicalNot => map(a, |a| u32::from(a == 0)),
        Word1::Negate => signed(a, i32::wrapping_neg),
        Word1::Abs => signed(a, i32::wrapping_abs),
        Word1::Sign => signed(a, i32::signum),
        Word1::TrailingZeros => map(a, u32::trailing_zeros),
        Word1::LeadingZeros => map(a, u32::leading_zeros),
        Word1::Ones => map(a, u32::count_ones),
        Word1::Reverse => map(a, u32::reverse_bits),
        Word1::FirstTrailing => map(a, |a| if a == 0 { u32::MAX } else { a.trailing_zeros() }),
        // The highest bit that differs from the sign; all ones when there is none.
        Word1::FirstLeadingSigned => map(a, |a| highest(if a >> 31 == 1 { !a } else { a })),
        Word1::FirstLeadingUnsigned => map(a, highest),
    }
}

fn highest(a: u32) -> u32 {
    a.checked_ilog2().unwrap_or(u32::MAX)
}

#[inline]
fn zip(a: &Words, b: &Words, f: impl Fn(u32, u32) -> u32) -> Words {
    let mut out = [0; SLOTS];
    for (slot, out) in out.iter_mut().enumerate() {
        *out = f(a[slot], b[slot]);
    }
    out
}

#[inline]
fn pairs(a: &Words, b: &Words, f: impl Fn(i32, i32) -> i32) -> Words {
    zip(a, b, |a, b| f(a.cast_signed(), b.cast_signed()).cast_unsigned())
}

#[inline]
fn ask(a: &Words, b: &Words, f: impl Fn(u32, u32) -> bool) -> Words {
    zip(a, b, |a, b| u32::from(f(a, b)))
}

pub(super) fn word2(op: Word2, a: &Words, b: &Words) -> Words {
    match op {
        Word2::AddSigned | Word2::AddUnsigned => zip(a, b, u32::wrapping_add),
        Word2::SubtractSigned | Word2::SubtractUnsigned => zip(a, b, u32::wrapping_sub),
        Word2::MultiplySigned | Word2::MultiplyUnsigned => zip(a, b, u32::wrapping_mul),
        // WGSL, 8.7: x / 0 is x, and so is the quotient that does not fit.
        Word2::DivideSigned => pairs(a, b, |a, b| a.checked_div(b).unwrap_or(a)),
        Word2::DivideUnsigned => zip(a, b, |a, b| a.checked_div(b).unwrap_or(a)),
        // x % 0 is 0, and so is the remainder whose quotient does not fit.
        Word2::RemainderSigned => pairs(a, b, |a, b| a.checked_rem(b).unwrap_or(0)),
        Word2::RemainderUnsigned => zip(a, b, |a, b| a.checked_rem(b).unwrap_or(0)),
        Word2::And => zip(a, b, |a, b| a & b),
        Word2::Or => zip(a, b, |a, b| a | b),
        Word2::Xor => zip(a, b, |a, b| a ^ b),
        // The lower five bits count.
        Word2::ShiftLeft => zip(a, b, u32::wrapping_shl),
        Word2::ShiftRightSigned => zip(a, b, |a, b| a.cast_signed().wrapping_shr(b).cast_unsigned()),
        Word2::ShiftRightUnsigned => zip(a, b, u32::wrapping_shr),
        Word2::Equal => ask(a, b, |a, b| a == b),
        Word2::NotEqual => ask(a, b, |a, b| a != b),
        Word2::LessSigned => ask(a, b, |a, b| a.cast_signed() < b.cast_signed()),
        Word2::LessUnsigned => ask(a, b, |a, b| a < b),
        Word2::LessEqualSigned => ask(a, b, |a, b| a.cast_signed() <= b.cast_signed()),
        Word2::LessEqualUnsigned => ask(a, b, |a, b| a <= b),
        Word2::MinSigned => pairs(a, b, i32::min),
        Word2::MinUnsigned => zip(a, b, u32::min),
        Word2::MaxSigned => pairs(a, b, i32::max),
        Word2::MaxUnsigned => zip(a, b, u32::max),
        Word2::Index => zip(a, b, |a, b| a.min(b.wrapping_sub(1))),
    }
}

/// Slots in which an operation on one word leaves its range.
pub(super) fn doubts1(op: Word1, a: &Words) -> Option<(HazardKind, Mask)> {
    match op {
        Word1::Negate | Word1::Abs => Some((HazardKind::Overflow, Mask::where_(|k| a[k].cast_signed() == i32::MIN))),
        Word1::Not
        | Word1::LogicalNot
        | Word1::Sign
        | Word1::TrailingZeros
        | Word1::LeadingZeros
        | Word1::Ones
        | Word1::Reverse
        | Word1::FirstTrailing
        | Word1::FirstLeadingSigned
        | Word1::FirstLeadingUnsigned => None,
    }
}

/// Slots in which an operation leaves its range. Unsigned sums and products wrap on purpose.
pub(super) fn doubts2(op: Word2, a: &Words, b: &Words) -> [Option<(HazardKind, Mask)>; 2] {
    let overflow = |f: fn(i32, i32) -> Option<i32>| {
        let mask = Mask::where_(|k| f(a[k].cast_signed(), b[k].cast_signed()).is_none());
        [Some((HazardKind::Overflow, mask)), None]
    };
    let zero = || Some((HazardKind::DivisionByZero, Mask::where_(|k| b[k] == 0)));
    match op {
        Word2::AddSigned => overflow(i32::checked_add),
        Word2::SubtractSigned => overflow(i32::checked_sub),
        Word2::MultiplySigned => overflow(i32::checked_mul),
        Word2::DivideSigned => {
            let mask = Mask::where_(|k| a[k].cast_signed() == i32::MIN && b[k].cast_signed() == -1);
            [zero(), Some((HazardKind::Quotient, mask))]
        }
        Word2::RemainderSigned => {
            let mask = Mask::where_(|k| a[k].cast_signed() < 0 || b[k].cast_signed() < 0);
            [zero(), Some((HazardKind::Remainder, mask))]
        }
        Word2::DivideUnsigned | Word2::RemainderUnsigned => [zero(), None],
        Word2::ShiftLeft | Word2::ShiftRightSigned | Word2::ShiftRightUnsigned => {
            [Some((HazardKind::Shift, Mask::where_(|k| b[k] >= 32))), None]
        }
        Word2::Index => [Some((HazardKind::Index, Mask::where_(|k| a[k] >= b[k]))), None],
        Word2::AddUnsigned
        | Word2::SubtractUnsigned
        | Word2::MultiplyUnsigned
        | Word2::And
        | Word2::Or
        | Word2::Xor
        | Word2::Equal
        | Word2::NotEqual
        | Word2::LessSigned
        | Word2::LessUnsigned
        | Word2::LessEqualSigned
        | Word2::LessEqualUnsigned
        | Word2::MinSigned
        | Word2::MinUnsigned
        | Word2::MaxSigned
        | Word2::MaxUnsigned => [None, None],
    }
}

/// Where offset and count of an operation on bit fields stand among its arguments.
fn bits_of(op: Field) -> (usize, usize) {
    match op {
        Field::ExtractSigned | Field::ExtractUnsigned => (1, 2),
        Field::Insert => (2, 3),
    }
}

/// Slots in which a bit field reaches outside of the word.
fn doubts_of_field(op: Field, args: [&Words; 4]) -> Mask {
    let (offset, count) = bits_of(op);
    Mask::where_(|k| u64::from(args[offset][k]) + u64::from(args[count][k]) > 32)
}

/// The operands of an operation, for messages: as the operation takes them.
fn operands(op: Word2, [a, b]: [Reg; 2]) -> [Operand; 2] {
    match op {
        Word2::DivideUnsigned | Word2::RemainderUnsigned => [Operand::Unsigned(a), Operand::Unsigned(b)],
        _ => [Operand::Signed(a), Operand::Signed(b)],
    }
}

/// WGSL, 17.3: offset and count are cut to the word.
fn field(op: Field, args: [&Words; 4]) -> Words {
    let mut out = [0; SLOTS];
    for (slot, out) in out.iter_mut().enumerate() {
        let [a, b, c, d] = args.map(|arg| arg[slot]);
        *out = match op {
            Field::ExtractSigned | Field::ExtractUnsigned => {
                let offset = b.min(32);
                let count = c.min(32 - offset);
                if count == 0 {
                    0
                } else {
                    // The field at the upper end, and back down with its sign or with zeros.
                    let up = a << (32 - offset - count);
                    match op {
                        Field::ExtractSigned => (up.cast_signed() >> (32 - count)).cast_unsigned(),
                        Field::ExtractUnsigned | Field::Insert => up >> (32 - count),
                    }
                }
            }
            Field::Insert => {
                let offset = c.min(32);
                let count = d.min(32 - offset);
                let ones = if count == 32 { u32::MAX } else { (1 << count) - 1 };
                let mask = if offset == 32 { 0 } else { ones << offset };
                (a & !mask) | (b.checked_shl(offset).unwrap_or(0) & mask)
            }
        };
    }
    out
}
