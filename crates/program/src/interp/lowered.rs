//! Strict binary16 where a program asks for no more, and strict binary32 elsewhere.

use super::code::Guarded;
use super::domain::{Binary, Class, Comparison, Domain, FromWords, Site, ToWords, Unary, WordSource};
use super::halved;
use super::plain::{Binary32, Column};
use super::slots::{Mask, Words};
use crate::Grade;
use base::value::Scalar;

/// Operations of `mediump` and `lowp` in binary16, each rounded to nearest even, subnormals kept; all others in
/// [`Binary32`]. For executables that are [lowered](super::compile_lowered): in others nothing is.
///
/// Of sums, products, quotients and roots the rounding by way of binary32 is the one to binary16: 24 digits are enough
/// for twice 11 and two.
#[derive(Clone, Debug, Default)]
pub struct Half {
    wide: Binary32,
}

fn is_lower(site: Site) -> bool {
    site.grade() != Grade::Full
}

/// A column as an operation of a site takes or leaves it.
fn narrow(site: Site, active: &Mask, column: &mut Column<f32>) {
    if is_lower(site) {
        let values = column.values_mut();
        active.each(|slot| values[slot] = halved(values[slot]));
    }
}

/// An operand: literals and what no precision was stated for take that of the operation.
fn operand(site: Site, active: &Mask, column: &Column<f32>) -> Option<Column<f32>> {
    is_lower(site).then(|| {
        let mut own = column.clone();
        narrow(site, active, &mut own);
        own
    })
}

impl Domain for Half {
    type Column = Column<f32>;
    type Word = u32;

    fn outside(&self, what: Guarded, active: &Mask, x: &Column<f32>, y: &Column<f32>) -> Mask {
        self.wide.outside(what, active, x, y)
    }

    fn shown(&self, column: &Column<f32>, slot: usize) -> f64 {
        self.wide.shown(column, slot)
    }

    fn column(&mut self) -> Column<f32> {
        self.wide.column()
    }

    fn constant(&mut self, site: Option<Site>, value: f32, out: &mut Column<f32>) {
        self.wide.constant(site, value, out);
    }

    fn input(&mut self, source: WordSource, words: &Words, out: &mut Column<f32>) {
        self.wide.input(source, words, out);
    }

    fn unary(&mut self, site: Site, op: Unary, active: &Mask, a: &Column<f32>, out: &mut Column<f32>) {
        let own = operand(site, active, a);
        self.wide.unary(site, op, active, own.as_ref().unwrap_or(a), out);
        narrow(site, active, out);
    }

    fn binary(
        &mut self,
        site: Site,
        op: Binary,
        active: &Mask,
        a: &Column<f32>,
        b: &Column<f32>,
        out: &mut Column<f32>,
    ) {
        let own = [operand(site, active, a), operand(site, active, b)];
        self.wide.binary(site, op, active, own[0].as_ref().unwrap_or(a), own[1].as_ref().unwrap_or(b), out);
        narrow(site, active, out);
    }

    fn scale(&mut self, site: Site, a: &Column<f32>, exponent: &Words, out: &mut Column<f32>) {
        self.wide.scale(site, a, exponent, out);
        narrow(site, &Mask::ALL, out);
    }

    fn compare(
        &mut self,
        site: Site,
        op: Comparison,
        active: &Mask,
        a: &Column<f32>,
        b: &Column<f32>,
        out: &mut Words,
    ) {
        let own = [operand(site, active, a), operand(site, active, b)];
        self.wide.compare(site, op, active, own[0].as_ref().unwrap_or(a), own[1].as_ref().unwrap_or(b), out);
    }

    fn classify(&mut self, site: Site, class: Class, active: &Mask, a: &Column<f32>, out: &mut Words) {
        self.wide.classify(site, class, active, a, out);
    }

    fn words_of(&mut self, site: Site, op: ToWords, active: &Mask, a: &Column<f32>, out: &mut Words) -> Mask {
        let own = operand(site, active, a);
        self.wide.words_of(site, op, active, own.as_ref().unwrap_or(a), out)
    }

    fn reals_of(&mut self, site: Site, op: FromWords, a: &Words, out: &mut Column<f32>) {
        self.wide.reals_of(site, op, a, out);
        narrow(site, &Mask::ALL, out);
    }

    fn copy(&mut self, from: &Column<f32>, to: &mut Column<f32>) {
        self.wide.copy(from, to);
    }

    fn merge(&mut self, mask: &Mask, from: &Column<f32>, to: &mut Column<f32>) {
        self.wide.merge(mask, from, to);
    }

    fn poison(&mut self, mask: &Mask, to: &mut Column<f32>) {
        self.wide.poison(mask, to);
    }

    fn word(&self, column: &Column<f32>, slot: usize) -> Option<u32> {
        self.wide.word(column, slot)
    }

    fn exact(word: u32, scalar: Scalar) -> u32 {
        Binary32::exact(word, scalar)
    }
}
