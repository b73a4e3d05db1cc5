//! Domains that carry values and nothing else: binary64 and strict binary32.

use std::marker::PhantomData;
use std::sync::Arc;

use super::code::Guarded;
use super::domain::{Binary, Class, Comparison, Domain, FromWords, Site, ToWords, Unary, WordSource};
use super::slots::{Mask, SLOTS, Words};
use crate::Grade;
use base::value::Scalar;
use number::half;

/// A type of floating-point numbers.
pub trait Number:
    Copy
    + Default
    + PartialOrd
    + Send
    + Sync
    + std::fmt::Debug
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::Div<Output = Self>
    + std::ops::Neg<Output = Self>
    + std::ops::Rem<Output = Self>
    + 'static
{
    /// What an output word is handed out as.
    type Word: Copy + Default + Send + Sync + std::fmt::Debug;
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;

    /// The nearest number; every operation without a method of its own is computed in binary64 and
    /// rounded here.
    fn nearest(x: f64) -> Self;
    /// Exact.
    fn widen(self) -> f64;
    /// |x|.
    fn size(self) -> Self;
    /// √x, correctly rounded.
    fn root(self) -> Self;
    /// The output word.
    fn word(self) -> Self::Word;
    /// An exact word as an output word.
    fn exact(word: u32, scalar: Scalar) -> Self::Word;
    /// True when the number is the mark of what was never written.
    fn is_poison(self) -> bool;
    /// The mark of what was never written: a quiet NaN with a payload of its own.
    fn poison() -> Self;
    /// The number as one of binary16 where numbers have digits to lose: the nearest; `None` for real numbers.
    fn halved(self) -> Option<Self>;

    /// A function on all slots, each result rounded once.
    fn column(function: &number::Unary, a: &[Self; SLOTS], out: &mut [Self; SLOTS]);
    /// A function of two numbers on all slots, each result rounded once.
    fn columns(function: &number::Binary, a: &[Self; SLOTS], b: &[Self; SLOTS], out: &mut [Self; SLOTS]);
}

/// Binary32 numbers as binary64 numbers.
#[inline]
fn widened(from: &[f32; SLOTS]) -> [f64; SLOTS] {
    let mut to = [0.0; SLOTS];
    number::map(from, &mut to, f64::from);
    to
}

/// Binary64 numbers rounded to binary32.
#[inline]
fn narrowed(from: &[f64; SLOTS], to: &mut [f32; SLOTS]) {
    number::map(from, to, |x| x as f32);
}

impl Number for f64 {
    type Word = Self;
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline]
    fn nearest(x: f64) -> Self {
        x
    }
    #[inline]
    fn widen(self) -> f64 {
        self
    }
    #[inline]
    fn size(self) -> Self {
        self.abs()
    }
    #[inline]
    fn root(self) -> Self {
        self.sqrt()
    }
    #[inline]
    fn word(self) -> f64 {
        self
    }
    #[inline]
    fn exact(word: u32, scalar: Scalar) -> f64 {
        match scalar {
            Scalar::F32 => Self::from(f32::from_bits(word)),
            Scalar::I32 => Self::from(word.cast_signed()),
            Scalar::U32 | Scalar::Bool => Self::from(word),
        }
    }
    #[inline]
    fn is_poison(self) -> bool {
        self.to_bits() == 0x7ffa_b479_2000_0000
    }
    #[inline]
    fn poison() -> Self {
        // The binary32 mark, widened.
        Self::from_bits(0x7ffa_b479_2000_0000)
    }
    #[inline]
    fn halved(self) -> Option<Self> {
        None
    }

    fn column(function: &number::Unary, a: &[Self; SLOTS], out: &mut [Self; SLOTS]) {
        function.column(a, out);
    }
    fn columns(function: &number::Binary, a: &[Self; SLOTS], b: &[Self; SLOTS], out: &mut [Self; SLOTS]) {
        function.column(a, b, out);
    }
}

impl Number for f32 {
    type Word = u32;
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline]
    fn nearest(x: f64) -> Self {
        x as Self
    }
    #[inline]
    fn widen(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn size(self) -> Self {
        self.abs()
    }
    #[inline]
    fn root(self) -> Self {
        self.sqrt()
    }
    #[inline]
    fn word(self) -> u32 {
        self.to_bits()
    }
    #[inline]
    fn exact(word: u32, _: Scalar) -> u32 {
        word
    }
    #[inline]
    fn is_poison(self) -> bool {
        self.to_bits() == super::POISON
    }
    #[inline]
    fn poison() -> Self {
        Self::from_bits(super::POISON)
    }
    #[inline]
    fn halved(self) -> Option<Self> {
        Some(super::halved(self))
    }

    fn column(function: &number::Unary, a: &[Self; SLOTS], out: &mut [Self; SLOTS]) {
        let mut wide = [0.0; SLOTS];
        function.column(&widened(a), &mut wide);
        narrowed(&wide, out);
    }
    fn columns(function: &number::Binary, a: &[Self; SLOTS], b: &[Self; SLOTS], out: &mut [Self; SLOTS]) {
        let mut wide = [0.0; SLOTS];
        function.column(&widened(a), &widened(b), &mut wide);
        narrowed(&wide, out);
    }
}

/// Values of one type of numbers, each operation rounded to nearest even.
#[derive(Clone, Debug, Default)]
pub struct Plain<T> {
    /// Numbers in the place of literals, by the number of their site; NaN where there is none.
    literals: Option<Arc<[f64]>>,
    /// `%` in the steps of its definition.
    stepwise: bool,
    numbers: PhantomData<T>,
}

impl<T> Plain<T> {
    /// The domain with other numbers in the place of literals: by the number of their site, NaN where
    /// the literal stays.
    pub fn with_literals(literals: Arc<[f64]>) -> Self {
        Self { literals: Some(literals), stepwise: false, numbers: PhantomData }
    }

    /// The domain with `x % y` as `x - y * trunc(x / y)`, each step rounded, instead of the exact remainder: the two
    /// are far apart where `x / y` is near a whole number or has more digits than T.
    pub fn stepwise(self) -> Self {
        Self { stepwise: true, ..self }
    }
}

/// Real semantics: every operation in binary64.
pub type Binary64 = Plain<f64>;

/// Strict binary32: source order, every operation correctly rounded or, for functions, rounded once
/// from binary64; subnormals kept.
pub type Binary32 = Plain<f32>;

/// One number for each slot.
#[derive(Clone, Debug, Default)]
pub struct Column<T>(Box<[T]>);

impl<T> Column<T> {
    /// The numbers.
    #[inline]
    pub fn values(&self) -> &[T; SLOTS] {
        // A default column only marks a place and is never read: see `Domain::Column`.
        self.0.first_chunk().expect("a column has a number for each slot")
    }

    /// The numbers, to be changed.
    #[inline]
    pub fn values_mut(&mut self) -> &mut [T; SLOTS] {
        self.0.first_chunk_mut().expect("a column has a number for each slot")
    }
}

#[inline]
fn map<T: Copy>(a: &Column<T>, out: &mut Column<T>, f: impl Fn(T) -> T) {
    number::map(a.values(), out.values_mut(), f);
}

#[inline]
fn zip<T: Copy>(a: &Column<T>, b: &Column<T>, out: &mut Column<T>, f: impl Fn(T, T) -> T) {
    number::map_pairs(a.values(), b.values(), out.values_mut(), f);
}

/// A function with exact results, on all slots.
#[inline]
fn exact<T: Number>(a: &Column<T>, out: &mut Column<T>, f: impl Fn(f64) -> f64) {
    number::map(a.values(), out.values_mut(), |x| T::nearest(f(x.widen())));
}

/// Fraction and exponent of x = f·2^e with ½ ≤ |f| < 1; x itself and 0 for 0 and what is not finite.
pub(super) fn frexp(x: f64) -> (f64, i32) {
    if x == 0.0 || !x.is_finite() {
        return (x, 0);
    }
    // A subnormal number is first brought into the normal range.
    let (x, shift) = if x.abs() < f64::MIN_POSITIVE { (x * 2f64.powi(64), 64) } else { (x, 0) };
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i32 - 1022;
    let fraction = f64::from_bits(x.to_bits() & !(0x7ff << 52) | 1022 << 52);
    (fraction, exponent - shift)
}

/// x·2^e, rounded once.
fn ldexp(x: f64, e: i32) -> f64 {
    // Within binary64 a power of two beyond its range is taken in three steps; two of them are exact.
    let e = e.clamp(-2400, 2400);
    let third = e / 3;
    x * 2f64.powi(third) * 2f64.powi(third) * 2f64.powi(e - 2 * third)
}

/// What an operation of binary16 gives. Of sums, products, quotients and roots the rounding by way of binary32 is the one
/// to binary16: see [`Half`](super::Half).
#[inline]
fn narrow<T: Number>(site: Site, active: &Mask, out: &mut Column<T>) {
    if site.grade() == Grade::Half {
        let out = out.values_mut();
        active.each(|slot| out[slot] = out[slot].halved().unwrap_or(out[slot]));
    }
}

/// Active slots from which on a column as a whole is quicker than the slots one by one. The results
/// are the same.
const WORTH_A_COLUMN: usize = SLOTS / 8;

/// The largest binary32 numbers that are integers of 32 bits: 2^31 − 2^7 and 2^32 − 2^8.
const LARGEST_SIGNED: f64 = 2_147_483_520.0;
const LARGEST_UNSIGNED: f64 = 4_294_967_040.0;

/// Converts numbers to words. Gives the slots whose value does not fit.
pub fn to_words(op: ToWords, a: &[f64; SLOTS], out: &mut Words) -> Mask {
    for (out, &x) in out.iter_mut().zip(a) {
        // `as` clamps and takes NaN to 0. Too large numbers become the largest binary32 that fits (WGSL, 15.7.6, since
        // February 2025), which is below the largest integer.
        *out = match op {
            ToWords::Signed => ((if x > LARGEST_SIGNED { LARGEST_SIGNED } else { x }) as i32).cast_unsigned(),
            ToWords::Unsigned => (if x > LARGEST_UNSIGNED { LARGEST_UNSIGNED } else { x }) as u32,
            ToWords::Bits => (x as f32).to_bits(),
            ToWords::HalfBits => u32::from(half::to_bits(x)),
            ToWords::FrexpExponent => frexp(x).1.cast_unsigned(),
            // A conversion gives 0 for NaN, which need not lie in the range.
            ToWords::Texel { low, high } => {
                (if x.is_nan() { low } else { (x.floor() as i32).clamp(low, high) }).cast_unsigned()
            }
        };
    }
    match op {
        ToWords::Signed => Mask::where_(|k| !(-2_147_483_648.0..2_147_483_648.0).contains(&a[k].trunc())),
        // GLSL 4.60, 5.4.1: converting a negative number is undefined, whatever is left of it.
        ToWords::Unsigned => Mask::where_(|k| !(0.0..4_294_967_296.0).contains(&a[k])),
        ToWords::Bits | ToWords::HalfBits | ToWords::FrexpExponent | ToWords::Texel { .. } => Mask::NONE,
    }
}

/// The `active` slots in which the result of a function is undefined.
pub fn outside<T: Number>(what: Guarded, active: &Mask, x: &[T; SLOTS], y: &[T; SLOTS]) -> Mask {
    let at = |slot: usize| what.is_outside(x[slot].widen(), y[slot].widen());
    // Hardly ever any: one look at all slots without branches.
    let some = (0..SLOTS).fold(false, |some, slot| some | at(slot));
    if some { Mask::where_(at).and(*active) } else { Mask::NONE }
}

/// Answers a question about two numbers in every slot: 1 for yes, 0 for no.
pub fn compare<T: Number>(op: Comparison, a: &[T; SLOTS], b: &[T; SLOTS], out: &mut Words) {
    for (slot, out) in out.iter_mut().enumerate() {
        *out = u32::from(op.holds(a[slot], b[slot]));
    }
}

/// The same of what kind of number it is.
pub fn classify<T: Number>(class: Class, a: &[T; SLOTS], out: &mut Words) {
    for (out, x) in out.iter_mut().zip(a) {
        let x = x.widen();
        *out = u32::from(match class {
            Class::Nan => x.is_nan(),
            Class::Infinite => x.is_infinite(),
        });
    }
}

/// Converts words to numbers.
pub fn from_words(op: FromWords, a: &Words, out: &mut [f64; SLOTS]) {
    for (out, &word) in out.iter_mut().zip(a) {
        *out = match op {
            FromWords::Signed => f64::from(word.cast_signed()),
            FromWords::Unsigned => f64::from(word),
            FromWords::Bits => f64::from(f32::from_bits(word)),
            FromWords::HalfBits => half::from_bits(word as u16),
        };
    }
}

/// Replaces numbers by the nearest binary16.
pub fn to_half(values: &mut [f64; SLOTS]) {
    for value in values {
        *value = half::from_bits(half::to_bits(*value));
    }
}

impl<T: Number> Domain for Plain<T> {
    type Column = Column<T>;
    type Word = T::Word;

    fn outside(&self, what: Guarded, active: &Mask, x: &Column<T>, y: &Column<T>) -> Mask {
        outside(what, active, x.values(), y.values())
    }

    fn shown(&self, column: &Column<T>, slot: usize) -> f64 {
        column.values()[slot].widen()
    }

    fn column(&mut self) -> Column<T> {
        Column(vec![T::ZERO; SLOTS].into_boxed_slice())
    }

    fn constant(&mut self, site: Option<Site>, value: f32, out: &mut Column<T>) {
        let literals = self.literals.as_deref().unwrap_or_default();
        let literal = site.and_then(|site| literals.get(site.index())).filter(|literal| !literal.is_nan());
        out.values_mut().fill(T::nearest(literal.copied().unwrap_or(f64::from(value))));
    }

    fn input(&mut self, _: WordSource, words: &Words, out: &mut Column<T>) {
        for (out, &word) in out.values_mut().iter_mut().zip(words) {
            *out = T::nearest(f64::from(f32::from_bits(word)));
        }
    }

    fn unary(&mut self, site: Site, op: Unary, active: &Mask, a: &Column<T>, out: &mut Column<T>) {
        // Functions of the mathematical library cost more than looking at the mask.
        let slow = |a: &Column<T>, out: &mut Column<T>, f: fn(f64) -> f64| {
            let (a, out) = (a.values(), out.values_mut());
            active.each(|slot| out[slot] = T::nearest(f(a[slot].widen())));
        };
        let fast = |a: &Column<T>, out: &mut Column<T>, f: number::Unary| {
            let (a, out) = (a.values(), out.values_mut());
            if active.count() >= WORTH_A_COLUMN {
                T::column(&f, a, out);
            } else {
                active.each(|slot| out[slot] = T::nearest(f.value(a[slot].widen())));
            }
        };
        match op {
            Unary::Negate => map(a, out, |x| -x),
            Unary::Abs => map(a, out, T::size),
            Unary::Sign => map(a, out, |x| {
                if x > T::ZERO {
                    T::ONE
                } else if x < T::ZERO {
                    -T::ONE
                } else {
                    x
                }
            }),
            Unary::Floor => exact(a, out, f64::floor),
            Unary::Ceil => exact(a, out, f64::ceil),
            Unary::Round => exact(a, out, f64::round_ties_even),
            Unary::Trunc => exact(a, out, f64::trunc),
            Unary::Fract => exact(a, out, |x| x - x.floor()),
            Unary::Sqrt => map(a, out, T::root),
            Unary::InverseSqrt | Unary::NormalScale => map(a, out, |x| T::nearest(1.0 / x.widen().sqrt())),
            Unary::Exp => fast(a, out, number::EXP),
            Unary::Exp2 => fast(a, out, number::EXP2),
            Unary::Log => fast(a, out, number::LN),
            Unary::Log2 => fast(a, out, number::LOG2),
            Unary::Sin => fast(a, out, number::SIN),
            Unary::Cos => fast(a, out, number::COS),
            Unary::Tan => fast(a, out, number::TAN),
            Unary::Asin => fast(a, out, number::ASIN),
            Unary::Acos => fast(a, out, number::ACOS),
            Unary::Atan => fast(a, out, number::ATAN),
            Unary::Sinh => slow(a, out, f64::sinh),
            Unary::Cosh => slow(a, out, f64::cosh),
            Unary::Tanh => slow(a, out, f64::tanh),
            Unary::Asinh => slow(a, out, f64::asinh),
            Unary::Acosh => slow(a, out, f64::acosh),
            Unary::Atanh => slow(a, out, f64::atanh),
            Unary::Radians => slow(a, out, f64::to_radians),
            Unary::Degrees => slow(a, out, f64::to_degrees),
            Unary::Half => slow(a, out, |x| half::from_bits(half::to_bits(x))),
            Unary::FrexpFraction => slow(a, out, |x| frexp(x).0),
            Unary::Determinant | Unary::Inverse | Unary::Narrow => self.copy(a, out),
        }
        narrow(site, active, out);
    }

    fn binary(&mut self, site: Site, op: Binary, active: &Mask, a: &Column<T>, b: &Column<T>, out: &mut Column<T>) {
        let fast = |a: &Column<T>, b: &Column<T>, out: &mut Column<T>, f: number::Binary| {
            let (a, b, out) = (a.values(), b.values(), out.values_mut());
            if active.count() >= WORTH_A_COLUMN {
                T::columns(&f, a, b, out);
            } else {
                active.each(|slot| out[slot] = T::nearest(f.value(a[slot].widen(), b[slot].widen())));
            }
        };
        match op {
            Binary::Add => zip(a, b, out, |a, b| a + b),
            Binary::Subtract => zip(a, b, out, |a, b| a - b),
            Binary::Multiply => zip(a, b, out, |a, b| a * b),
            Binary::Divide => zip(a, b, out, |a, b| a / b),
            Binary::Remainder if self.stepwise => {
                zip(a, b, out, |a, b| a - b * T::nearest((a / b).widen().trunc()));
            }
            Binary::Remainder => zip(a, b, out, |a, b| a % b),
            Binary::Min => zip(a, b, out, |a, b| if b < a { b } else { a }),
            Binary::Max => zip(a, b, out, |a, b| if a < b { b } else { a }),
            Binary::Pow => fast(a, b, out, number::POW),
            Binary::Atan2 => fast(a, b, out, number::ATAN2),
            Binary::Step => zip(a, b, out, |a, b| if b < a { T::ZERO } else { T::ONE }),
        }
        narrow(site, active, out);
    }

    fn scale(&mut self, site: Site, a: &Column<T>, exponent: &Words, out: &mut Column<T>) {
        let a = a.values();
        for (slot, out) in out.values_mut().iter_mut().enumerate() {
            *out = T::nearest(ldexp(a[slot].widen(), exponent[slot].cast_signed()));
        }
        narrow(site, &Mask::ALL, out);
    }

    fn compare(&mut self, _: Site, op: Comparison, _: &Mask, a: &Column<T>, b: &Column<T>, out: &mut Words) {
        compare(op, a.values(), b.values(), out);
    }

    fn classify(&mut self, _: Site, class: Class, _: &Mask, a: &Column<T>, out: &mut Words) {
        classify(class, a.values(), out);
    }

    fn words_of(&mut self, _: Site, op: ToWords, _: &Mask, a: &Column<T>, out: &mut Words) -> Mask {
        let wide: [f64; SLOTS] = std::array::from_fn(|slot| a.values()[slot].widen());
        to_words(op, &wide, out)
    }

    fn reals_of(&mut self, _: Site, op: FromWords, a: &Words, out: &mut Column<T>) {
        let mut wide = [0.0; SLOTS];
        from_words(op, a, &mut wide);
        for (out, wide) in out.values_mut().iter_mut().zip(wide) {
            *out = T::nearest(wide);
        }
    }

    fn copy(&mut self, from: &Column<T>, to: &mut Column<T>) {
        to.values_mut().copy_from_slice(from.values());
    }

    fn merge(&mut self, mask: &Mask, from: &Column<T>, to: &mut Column<T>) {
        mask.merge(from.values(), to.values_mut());
    }

    fn poison(&mut self, mask: &Mask, to: &mut Column<T>) {
        mask.merge(&[T::poison(); SLOTS], to.values_mut());
    }

    fn word(&self, column: &Column<T>, slot: usize) -> Option<T::Word> {
        let value = column.values()[slot];
        (!value.is_poison()).then(|| value.word())
    }

    fn exact(word: u32, scalar: Scalar) -> T::Word {
        T::exact(word, scalar)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The function in the slots of a mask, and 7 in the others.
    fn masked<T: Number>(op: Unary, mask: &Mask) -> Vec<f64> {
        let mut domain = Plain::<T>::default();
        let (mut a, mut out) = (domain.column(), domain.column());
        for (slot, a) in a.values_mut().iter_mut().enumerate() {
            *a = T::nearest(slot as f64 * 0.11 - 9.0);
        }
        let mut result = domain.column();
        result.values_mut().fill(T::nearest(7.0));
        domain.unary(Site::new(0), op, mask, &a, &mut out);
        domain.merge(mask, &out, &mut result);
        result.values().map(Number::widen).to_vec()
    }

    #[test]
    fn a_slot_has_the_same_result_whichever_others_are_active() {
        for op in [Unary::Sin, Unary::Exp2, Unary::Log2, Unary::Atan, Unary::Floor] {
            let bits = |x: &Vec<f64>, slot: usize| x[slot].to_bits();
            for (all, one) in [
                (masked::<f64>(op, &Mask::ALL), masked::<f64>(op, &Mask::where_(|slot| slot == 99))),
                (masked::<f32>(op, &Mask::ALL), masked::<f32>(op, &Mask::where_(|slot| slot == 99))),
            ] {
                assert_eq!(bits(&all, 99), bits(&one, 99), "{op:?}");
                assert_ne!(bits(&all, 98), bits(&one, 98), "{op:?}: another slot is not computed");
            }
        }
    }

    #[test]
    fn functions_in_binary32_are_rounded_once_from_binary64() {
        let sine = masked::<f32>(Unary::Sin, &Mask::ALL);
        for (slot, sine) in sine.into_iter().enumerate() {
            let x = (slot as f64 * 0.11 - 9.0) as f32;
            // No tie is within the errors of the two references.
            assert_eq!(sine, f64::from(f64::from(x).sin() as f32), "{x}");
        }
    }

    #[test]
    fn frexp_and_ldexp_undo_each_other_down_to_the_smallest_number() {
        for x in [1.0, -0.75, 1e300, 5e-324, 3e-310, f64::MAX] {
            let (fraction, exponent) = frexp(x);
            assert!((0.5..1.0).contains(&fraction.abs()), "{x}");
            assert_eq!(ldexp(fraction, exponent), x);
        }
        assert_eq!(frexp(8.0), (0.5, 4));
        assert_eq!(frexp(0.0), (0.0, 0));
    }

    #[test]
    fn the_marks_of_unwritten_values_are_one_and_the_same_nan() {
        assert!(f64::poison().is_poison() && f32::poison().is_poison() && f64::poison().is_nan());
        assert!(!f64::NAN.is_poison() && !f32::NAN.is_poison());
        assert_eq!((f64::poison() as f32).to_bits(), super::super::POISON, "narrowed");
    }
}
