//! A glance as a domain of numbers.

use super::super::definitions::Definitions;
use super::super::lowered::{SMALLEST, is_lower};
use super::super::model::Arg;
use super::{Column, Glance, MOST, SLOTS, ZEROS};
use crate::profile::grid::MIN_NORMAL;
use crate::profile::{Op, Unlisted};
use base::value::Scalar;
use program::interp::{
    Binary, Class, Comparison, Domain, FromWords, Guarded, Mask, Number, Site, ToWords, Unary, WordSource, Words,
};

/// Nodes of a glance, each of which may be several on a tape.
const ENOUGH: usize = MOST / 16;

impl Domain for Glance<'_> {
    type Column = Column;
    type Word = f64;

    fn begin(&mut self) {
        self.held.begin();
        (self.lost, self.given_up, self.erring) = (Mask::NONE, false, 0);
        self.chunk += 1;
        // Node 0 holds zeros: what a column holds that nobody wrote.
        if self.nodes.is_empty() {
            self.leaf(|value| value.fill(0.0));
        }
    }

    fn column(&mut self) -> Column {
        Column(0)
    }

    fn constant(&mut self, site: Option<Site>, value: f32, out: &mut Column) {
        let literal = site.and_then(|site| self.literals.get(site.index()).copied().flatten());
        let (value, slack) = literal.map_or((f64::from(value), 0.0), |literal| (literal.value, literal.slack));
        // A register with a constant has it in every chunk.
        let of = self.nodes[self.id(out) as usize];
        if of.constant.is_some_and(|constant| constant.to_bits() == value.to_bits()) {
            return;
        }
        let (id, _) = self.leaf(|v| v.fill(value));
        let node = &mut self.nodes[id as usize];
        (node.radius, node.constant) = (slack, Some(value));
        self.hold(out, id);
    }

    fn input(&mut self, _: WordSource, words: &Words, out: &mut Column) {
        let id = self.leaf_of_words(words);
        self.hold(out, id);
    }

    fn unary(&mut self, site: Site, op: Unary, active: &Mask, a: &Column, out: &mut Column) {
        let a = self.id(a);
        self.given_up |= is_lower(Some(site));
        let id = match Op::of_unary(op) {
            Ok(Op::Neg) => self.sum(Some(site), Op::Neg, a, a, (-1.0, 0.0)),
            Ok(op) => self.function1(site, op, active, a),
            Err(Unlisted::NormalScale) => self.normal_scale(site, active, a),
            Err(Unlisted::Determinant) => self.mark(Op::Determinant, a),
            Err(Unlisted::Inverse) => self.mark(Op::Inverse, a),
            Err(Unlisted::Narrow) => a,
            Err(Unlisted::Half | Unlisted::FrexpFraction) => {
                self.given_up = true;
                a
            }
        };
        self.hold(out, id);
    }

    fn binary(&mut self, site: Site, op: Binary, active: &Mask, a: &Column, b: &Column, out: &mut Column) {
        let (a, b) = (self.id(a), self.id(b));
        self.given_up |= is_lower(Some(site));
        let id = match Op::of_binary(op) {
            op @ Op::Add => self.sum(Some(site), op, a, b, (1.0, 1.0)),
            op @ Op::Sub => self.sum(Some(site), op, a, b, (1.0, -1.0)),
            op @ Op::Mul => self.product(site, op, a, b),
            op => self.function2(site, op, active, a, b),
        };
        self.hold(out, id);
    }

    fn scale(&mut self, _: Site, a: &Column, _: &Words, out: &mut Column) {
        self.given_up = true;
        let a = self.id(a);
        self.hold(out, a);
    }

    fn compare(&mut self, _: Site, op: Comparison, _: &Mask, a: &Column, b: &Column, out: &mut Words) {
        program::interp::compare(op, self.values(*a), self.values(*b), out);
    }

    fn classify(&mut self, _: Site, class: Class, _: &Mask, a: &Column, out: &mut Words) {
        program::interp::classify(class, self.values(*a), out);
    }

    fn words_of(&mut self, _: Site, op: ToWords, _: &Mask, a: &Column, out: &mut Words) -> Mask {
        program::interp::to_words(op, self.values(*a), out)
    }

    fn reals_of(&mut self, _: Site, op: FromWords, a: &Words, out: &mut Column) {
        let id = self.leaf_of_numbers(|value| program::interp::from_words(op, a, value));
        let at = id as usize;
        let value = self.value.get(at);
        let radius = match op {
            // Integers of up to 24 bits are kept whatever the rounding.
            FromWords::Signed | FromWords::Unsigned if value.iter().all(|v| f64::from(*v as f32) == *v) => 0.0,
            FromWords::Signed | FromWords::Unsigned => {
                let mut local = [0.0; SLOTS];
                self.model.local(Op::Convert, &[Arg { value, radius: &ZEROS }], value, &ZEROS, &mut local);
                local.into_iter().fold(0.0, f64::max)
            }
            FromWords::Bits => MIN_NORMAL,
            FromWords::HalfBits => SMALLEST,
        };
        self.nodes[at].radius = radius;
        self.given_up |= radius == f64::INFINITY;
        self.hold(out, id);
    }

    fn outside(&self, what: Guarded, active: &Mask, x: &Column, y: &Column) -> Mask {
        program::interp::outside(what, active, self.values(*x), self.values(*y))
    }

    fn shown(&self, column: &Column, slot: usize) -> f64 {
        self.values(*column)[slot]
    }

    fn is_full(&self) -> bool {
        self.held.made() >= ENOUGH
    }

    fn give_up(&mut self, _: Site, _: &Mask) {
        self.given_up = true;
    }

    fn copy(&mut self, from: &Column, to: &mut Column) {
        let id = self.id(from);
        self.hold(to, id);
    }

    fn merge(&mut self, mask: &Mask, from: &Column, to: &mut Column) {
        let (a, b) = (self.id(from), self.id(to));
        let id = self.select(mask, a, b);
        self.hold(to, id);
    }

    fn poison(&mut self, mask: &Mask, to: &mut Column) {
        let (mark, _) = self.leaf(|value| value.fill(f64::poison()));
        let id = if mask.is_full() { mark } else { self.select(mask, mark, self.id(to)) };
        self.hold(to, id);
    }

    fn word(&self, column: &Column, slot: usize) -> Option<f64> {
        let value = self.values(*column)[slot];
        (!value.is_poison()).then_some(value)
    }

    fn exact(word: u32, scalar: Scalar) -> f64 {
        <f64 as Number>::exact(word, scalar)
    }
}
