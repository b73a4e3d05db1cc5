//! Numbers of 400 bits. The tests of crates that compute with any number include this file.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use astro_float::{BigFloat, Consts, RoundingMode};

use super::Real;

pub(crate) const BITS: usize = 400;
pub(crate) const ROUND: RoundingMode = RoundingMode::ToEven;

thread_local! {
    static NUMBERS: RefCell<Vec<BigFloat>> = const { RefCell::new(Vec::new()) };
    static CONSTS: RefCell<Consts> = RefCell::new(Consts::new().expect("there is memory for constants"));
}

/// A number of 400 bits. They live until [`Big::forget`], so that one can be copied as formulas ask for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Big(usize);

impl Big {
    pub fn new(number: BigFloat) -> Self {
        NUMBERS.with_borrow_mut(|all| {
            all.push(number);
            Self(all.len() - 1)
        })
    }

    pub fn of(x: f64) -> Self {
        if x.is_normal() || x == 0.0 || !x.is_finite() {
            return Self::new(BigFloat::from_f64(x, BITS));
        }
        // The library takes subnormal numbers for others.
        let mut number = BigFloat::from_f64(x * 2f64.powi(200), BITS);
        let exponent = number.exponent().unwrap_or_default();
        number.set_exponent(exponent - 200);
        Self::new(number)
    }

    pub fn get(self) -> BigFloat {
        NUMBERS.with_borrow(|all| all[self.0].clone())
    }

    pub fn forget() {
        NUMBERS.with_borrow_mut(Vec::clear);
    }

    /// Rounded towards what `f64` holds of it, for sizes alone.
    pub fn size(self) -> f64 {
        let number = self.get();
        if number.is_zero() {
            return 0.0;
        }
        let Some((words, _, _, exponent, _)) = number.as_raw_parts() else { return f64::NAN };
        let top = words[words.len() - 1] as f64 / 2f64.powi(64);
        let exponent = exponent.clamp(-1000, 1000);
        top * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2)
    }

    fn both(self, other: Self, f: impl FnOnce(&BigFloat, &BigFloat) -> BigFloat) -> Self {
        Self::new(f(&self.get(), &other.get()))
    }

    pub fn with(self, f: impl FnOnce(&BigFloat, &mut Consts) -> BigFloat) -> Self {
        Self::new(CONSTS.with_borrow_mut(|consts| f(&self.get(), consts)))
    }

    pub fn pi() -> Self {
        Self::new(CONSTS.with_borrow_mut(|consts| consts.pi(BITS, ROUND)))
    }
}

impl Add for Big {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        self.both(b, |a, b| a.add(b, BITS, ROUND))
    }
}

impl Sub for Big {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self.both(b, |a, b| a.sub(b, BITS, ROUND))
    }
}

impl Mul for Big {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        self.both(b, |a, b| a.mul(b, BITS, ROUND))
    }
}

impl Div for Big {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        self.both(b, |a, b| a.div(b, BITS, ROUND))
    }
}

impl Neg for Big {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(self.get().neg())
    }
}

impl Real for Big {
    type Mask = bool;

    fn exact(x: f64) -> Self {
        Self::of(x)
    }

    fn sqrt(self) -> Self {
        Self::new(self.get().sqrt(BITS, ROUND))
    }

    fn abs(self) -> Self {
        if self.get().is_negative() { -self } else { self }
    }

    fn sin_cos_pi(self) -> (Self, Self) {
        // Quarter turns are taken out: the sine of a rounded π is not 0.
        let half = self.size() * if self.get().is_negative() { -1.0 } else { 1.0 } * 2.0;
        let quarters = half.round_ties_even();
        let angle = (self - Self::of(quarters * 0.5)) * Self::pi();
        let (sin, cos) = (angle.with(|x, c| x.sin(BITS, ROUND, c)), angle.with(|x, c| x.cos(BITS, ROUND, c)));
        match quarters.rem_euclid(4.0) as u8 {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }

    fn pow(self, exponent: Self) -> Self {
        let log = self.with(|x, c| x.ln(BITS, ROUND, c));
        (log * exponent).with(|x, c| x.exp(BITS, ROUND, c))
    }

    fn less(self, other: Self) -> bool {
        self.get().cmp(&other.get()).is_some_and(|order| order < 0)
    }

    fn is_zero(self) -> bool {
        self.get().is_zero()
    }

    fn and(a: bool, b: bool) -> bool {
        a && b
    }

    fn or(a: bool, b: bool) -> bool {
        a || b
    }

    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }

    fn largest(self) -> f64 {
        if self.get().is_negative() { -self.size() } else { self.size() }
    }
}
