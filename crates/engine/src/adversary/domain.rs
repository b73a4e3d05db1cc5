//! The device as numbers of the interpreter.

use std::sync::Arc;

use base::value::Scalar;
use judge::profile::Op;
use program::interp::{
    Binary, Binary32, Class, Column as Numbers, Comparison, Domain, FromWords, Mask, SLOTS, Site, ToWords, Unary,
    WordSource, Words,
};
use program::{Grade, Manner};
use property::mix;

use super::choice::Place;
use super::device::{Device, Normalize};

/// Binary32 numbers on a device that errs as far as it may.
#[derive(Clone, Debug)]
pub struct Adversary {
    device: Arc<Device>,
    /// What has no promise to break is done as the interpreter does it.
    strict: Binary32,
    /// Names the inputs of each slot.
    pub(super) invocations: Vec<u64>,
}

/// One number for each slot, and what it was before it was rounded.
#[derive(Clone, Debug, Default)]
pub struct Column {
    pub(super) values: Numbers<f32>,
    /// Exact products; NaN in slots where the number is none. Empty where none is.
    products: Vec<f64>,
    /// For the factor of `normalize` that is the inverse of a length: these lengths.
    lengths: Vec<f64>,
}

impl Column {
    /// The numbers.
    pub fn values(&self) -> &[f32; SLOTS] {
        self.values.values()
    }

    fn wide(&self, slot: usize) -> f64 {
        f64::from(self.values()[slot])
    }

    fn product(&self, slot: usize) -> Option<f64> {
        self.products.get(slot).copied().filter(|product| !product.is_nan())
    }

    /// Forgets what the numbers were before.
    pub(super) fn rounded(&mut self) {
        self.products.clear();
        self.lengths.clear();
    }
}

impl Adversary {
    /// Numbers on a device.
    pub fn new(device: Arc<Device>) -> Self {
        Self { device, strict: Binary32::default(), invocations: vec![0; SLOTS] }
    }

    fn place(&self, site: Site, slot: usize) -> Place {
        Place { site: site.index(), invocation: self.invocations[slot] }
    }

    /// An operand of an operation of lower precision: what has none of its own takes that of the operation.
    fn operand(&self, site: Site, active: &Mask, column: &Column) -> Option<Column> {
        (site.grade() != Grade::Full).then(|| {
            let mut own = column.clone();
            let values = own.values.values_mut();
            active.each(|slot| {
                values[slot] = self.device.lowered(site.grade(), None, 0.0, values[slot], self.place(site, slot));
            });
            // At lower precision nothing is fused.
            own.rounded();
            own
        })
    }

    /// Lowers the results of an operation.
    fn lower(&self, site: Site, op: Option<Op>, active: &Mask, argument: &Column, out: &mut Column) {
        if site.grade() == Grade::Full {
            return;
        }
        out.rounded();
        let values = out.values.values_mut();
        active.each(|slot| {
            let (argument, place) = (argument.wide(slot).abs(), self.place(site, slot));
            values[slot] = self.device.lowered(site.grade(), op, argument, values[slot], place);
        });
    }

    /// A sum or difference, of products before their rounding where they are fused.
    fn sum(&self, site: Site, op: Op, active: &Mask, a: &Column, b: &Column, out: &mut Column) {
        let values = out.values.values_mut();
        active.each(|slot| {
            let place = self.place(site, slot);
            let mut args = [a.wide(slot), b.wide(slot)];
            let products = [a.product(slot), b.product(slot)];
            if products != [None, None] && !site.is_precise() && self.device.fuses(args, place) {
                // One of two products is rounded.
                match products {
                    [Some(product), _] => args[0] = product,
                    [None, Some(product)] => args[1] = product,
                    [None, None] => {}
                }
            }
            values[slot] = self.device.apply(op, &args, place);
        });
    }

    fn product(&self, site: Site, active: &Mask, a: &Column, b: &Column, out: &mut Column) {
        let Column { values, products, .. } = out;
        let values = values.values_mut();
        let (x, lengths) = if a.lengths.is_empty() { (a, &b.lengths) } else { (b, &a.lengths) };
        if !lengths.is_empty() {
            active.each(|slot| {
                let args = [x.wide(slot), lengths[slot]];
                values[slot] = self.device.apply_in(Op::Div, Some(Op::Normalize), &args, self.place(site, slot));
            });
            return;
        }
        products.resize(SLOTS, f64::NAN);
        active.each(|slot| {
            let args = [a.wide(slot), b.wide(slot)];
            values[slot] = self.device.apply(Op::Mul, &args, self.place(site, slot));
            // Exact: 24 digits each.
            products[slot] = args[0] * args[1];
        });
    }

    /// 1/√x as the factor of `normalize`.
    fn normal_scale(&self, site: Site, active: &Mask, a: &Column, out: &mut Column) {
        let way = self.device.normalize();
        let Column { values, lengths, .. } = out;
        let values = values.values_mut();
        if way == Normalize::ByLength {
            lengths.resize(SLOTS, f64::NAN);
        }
        active.each(|slot| {
            let (x, place) = (a.wide(slot), self.place(site, slot));
            values[slot] = match way {
                Normalize::ByInverseSqrt => self.device.apply_in(Op::InverseSqrt, Some(Op::Normalize), &[x], place),
                Normalize::ByLength => {
                    lengths[slot] = f64::from(self.device.apply_in(Op::Sqrt, None, &[x], place));
                    (1.0 / lengths[slot]) as f32
                }
                Normalize::Free => self.device.wild(Op::Normalize, 1.0 / x.sqrt(), place),
            };
        });
    }
}

impl Domain for Adversary {
    type Column = Column;
    type Word = u32;

    fn begin(&mut self) {
        self.invocations.fill(0);
    }

    fn column(&mut self) -> Column {
        Column { values: self.strict.column(), ..Column::default() }
    }

    fn constant(&mut self, site: Option<Site>, value: f32, out: &mut Column) {
        out.rounded();
        self.strict.constant(site, value, &mut out.values);
    }

    fn input(&mut self, source: WordSource, words: &Words, out: &mut Column) {
        out.rounded();
        self.strict.input(source, words, &mut out.values);
        for (invocation, &word) in self.invocations.iter_mut().zip(words) {
            *invocation = mix(*invocation, u64::from(word));
        }
    }

    fn unary(&mut self, site: Site, op: Unary, active: &Mask, a: &Column, out: &mut Column) {
        if site.grade() != Grade::Full {
            let at = Site::done(
                site,
                Manner { grade: Grade::Full, precise: site.is_precise(), ties: site.is_open_at_ties() },
            );
            let own = self.operand(site, active, a);
            self.unary(at, op, active, own.as_ref().unwrap_or(a), out);
            // `normalize` ends with a product.
            return self.lower(site, Op::of_unary(op).ok(), active, a, out);
        }
        out.rounded();
        let free = match op {
            Unary::NormalScale => return self.normal_scale(site, active, a, out),
            Unary::Determinant => Some(Op::Determinant).filter(|&op| self.device.is_free(op)),
            Unary::Inverse => Some(Op::Inverse).filter(|&op| self.device.is_free(op)),
            _ => None,
        };
        let Column { values, products, .. } = out;
        match (Op::of_unary(op).ok(), free) {
            (Some(op), _) => {
                let values = values.values_mut();
                active.each(|slot| values[slot] = self.device.apply(op, &[a.wide(slot)], self.place(site, slot)));
            }
            (None, Some(op)) => {
                let values = values.values_mut();
                active.each(|slot| values[slot] = self.device.wild(op, a.wide(slot), self.place(site, slot)));
            }
            (None, None) => self.strict.unary(site, op, active, &a.values, values),
        }
        if op == Unary::Negate {
            products.extend(a.products.iter().map(|product| -product));
        }
    }

    fn binary(&mut self, site: Site, op: Binary, active: &Mask, a: &Column, b: &Column, out: &mut Column) {
        if site.grade() != Grade::Full {
            let at = Site::done(
                site,
                Manner { grade: Grade::Full, precise: site.is_precise(), ties: site.is_open_at_ties() },
            );
            let own = [a, b].map(|column| self.operand(site, active, column));
            self.binary(at, op, active, own[0].as_ref().unwrap_or(a), own[1].as_ref().unwrap_or(b), out);
            return self.lower(site, Some(Op::of_binary(op)), active, a, out);
        }
        out.rounded();
        match op {
            Binary::Add | Binary::Subtract => self.sum(site, Op::of_binary(op), active, a, b, out),
            Binary::Multiply => self.product(site, active, a, b, out),
            _ => {
                let values = out.values.values_mut();
                active.each(|slot| {
                    let args = [a.wide(slot), b.wide(slot)];
                    values[slot] = self.device.apply(Op::of_binary(op), &args, self.place(site, slot));
                });
            }
        }
    }

    fn scale(&mut self, site: Site, a: &Column, exponent: &Words, out: &mut Column) {
        out.rounded();
        for (slot, value) in out.values.values_mut().iter_mut().enumerate() {
            // Further powers lead out of binary32 as well, and these are exact in binary64.
            let power = exponent[slot].cast_signed().clamp(-400, 400);
            let exact = |args: &[f64]| args[0] * 2f64.powi(power);
            *value = self.device.apply_to(Op::Ldexp, &[a.wide(slot)], &exact, self.place(site, slot));
        }
        self.lower(site, Some(Op::Ldexp), &Mask::ALL, a, out);
    }

    fn compare(&mut self, site: Site, op: Comparison, active: &Mask, a: &Column, b: &Column, out: &mut Words) {
        let own = [a, b].map(|column| self.operand(site, active, column));
        let (a, b) = (own[0].as_ref().unwrap_or(a), own[1].as_ref().unwrap_or(b));
        active.each(|slot| {
            let [a, b] = self.device.compared([a.wide(slot), b.wide(slot)], self.place(site, slot));
            out[slot] = u32::from(op.holds(a, b));
        });
    }

    fn classify(&mut self, site: Site, class: Class, active: &Mask, a: &Column, out: &mut Words) {
        self.strict.classify(site, class, active, &a.values, out);
    }

    fn words_of(&mut self, site: Site, op: ToWords, active: &Mask, a: &Column, out: &mut Words) -> Mask {
        let mut seen = a.values.clone();
        let values = seen.values_mut();
        active.each(|slot| values[slot] = self.device.converted(a.wide(slot), self.place(site, slot)) as f32);
        self.strict.words_of(site, op, active, &seen, out)
    }

    fn reals_of(&mut self, site: Site, op: FromWords, a: &Words, out: &mut Column) {
        out.rounded();
        let number = match op {
            FromWords::Signed => |word: u32| f64::from(word.cast_signed()),
            FromWords::Unsigned => |word: u32| f64::from(word),
            FromWords::Bits | FromWords::HalfBits => return self.strict.reals_of(site, op, a, &mut out.values),
        };
        for (slot, value) in out.values.values_mut().iter_mut().enumerate() {
            let args = [number(a[slot])];
            *value = self.device.apply_to(Op::Convert, &args, &|args| args[0], self.place(site, slot));
        }
        let whole = out.clone();
        self.lower(site, Some(Op::Convert), &Mask::ALL, &whole, out);
    }

    fn copy(&mut self, from: &Column, to: &mut Column) {
        self.strict.copy(&from.values, &mut to.values);
        to.products.clone_from(&from.products);
        to.lengths.clone_from(&from.lengths);
    }

    fn merge(&mut self, mask: &Mask, from: &Column, to: &mut Column) {
        self.strict.merge(mask, &from.values, &mut to.values);
        // The factor of `normalize` is used where it is made, and by nothing else.
        to.lengths.clear();
        if !from.products.is_empty() || !to.products.is_empty() {
            to.products.resize(SLOTS, f64::NAN);
            mask.each(|slot| to.products[slot] = from.product(slot).unwrap_or(f64::NAN));
        }
    }

    fn poison(&mut self, mask: &Mask, to: &mut Column) {
        self.strict.poison(mask, &mut to.values);
        to.rounded();
    }

    fn word(&self, column: &Column, slot: usize) -> Option<u32> {
        self.strict.word(&column.values, slot)
    }

    fn exact(word: u32, scalar: Scalar) -> u32 {
        Binary32::exact(word, scalar)
    }
}
