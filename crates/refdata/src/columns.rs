//! What a formula gives for samples side by side, column by column.

use super::flags::Flag;
use super::generate::Outputs;
use super::inputs::Inputs;
use base::value::Scalar;
use chapter::exact::Exact;
use chapter::exact::quick::{Given, Near, Quick};
use judge::profile::grid::MIN_NORMAL;
use number::twofold::{Twofold, WIDTH};

/// What a formula gives for samples side by side.
pub(super) struct Columns {
    /// By word; the one NaN where there is no value.
    pub values: Vec<[f64; WIDTH]>,
    /// The nearest binary32.
    pub nearest: Vec<[u32; WIDTH]>,
    /// Flags that follow from the values, and the marks of the formula.
    pub flags: [u64; WIDTH],
    fast: Vec<Twofold<false>>,
    safe: Vec<Twofold<true>>,
    /// Inputs of the quick phase.
    pub given: Given,
    /// What it finds.
    near: Near,
}

/// The columns of a formula in one of the two kinds of arithmetic.
pub(super) trait Room<const SAFE: bool> {
    fn room(&mut self) -> &mut [Twofold<SAFE>];
}

impl Room<false> for Columns {
    #[inline(always)]
    fn room(&mut self) -> &mut [Twofold<false>] {
        &mut self.fast
    }
}

impl Room<true> for Columns {
    #[inline(always)]
    fn room(&mut self) -> &mut [Twofold<true>] {
        &mut self.safe
    }
}

impl Columns {
    pub fn new(words: usize) -> Self {
        Self {
            values: vec![[0.0; WIDTH]; words],
            nearest: vec![[0; WIDTH]; words],
            flags: [0; WIDTH],
            fast: vec![Twofold::of([0.0; WIDTH]); words],
            safe: vec![Twofold::of([0.0; WIDTH]); words],
            given: Given::default(),
            near: Near::default(),
        }
    }

    /// Computes the formula. True when all values are finite.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn evaluate<const SAFE: bool>(&mut self, exact: Exact, inputs: &Inputs<'_>, outputs: &Outputs) -> bool
    where
        Self: Room<SAFE>,
    {
        let marks = exact.evaluate(inputs, self.room());
        let mut finite = true;
        for word in 0..self.values.len() {
            let column = self.room()[word];
            column.rounded_32(&mut self.nearest[word]);
            for slot in 0..WIDTH {
                let value = column.rounded()[slot];
                finite &= value.abs() < f64::INFINITY;
                self.values[word][slot] = if value.is_nan() { f64::NAN } else { value };
                let nearest = self.nearest[word][slot];
                self.nearest[word][slot] = if value.is_nan() { f32::NAN.to_bits() } else { nearest };
            }
        }
        self.flag([&marks.segment_end, &marks.degenerate], outputs);
        finite
    }

    /// Computes the formula's quick phase for samples of one case. True when all values are sure.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn approach(&mut self, quick: Quick, outputs: &Outputs) -> bool {
        let Self { given, near, values, nearest, .. } = self;
        quick.evaluate(given, near, values, nearest);
        let (sure, marks) = (near.sure, [near.segment_end, near.degenerate]);
        self.flag([&marks[0], &marks[1]], outputs);
        let mut all = u64::MAX;
        for slot in 0..WIDTH {
            self.flags[slot] &= sure[slot];
            all &= sure[slot];
        }
        all == u64::MAX
    }

    /// Samples of which the quick phase is not sure.
    pub fn unsure(&self) -> impl Iterator<Item = usize> {
        self.near.sure.into_iter().enumerate().filter(|(_, sure)| *sure == 0).map(|(slot, _)| slot)
    }

    /// Flags that follow from the values, and the marks of the formula.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn flag(&mut self, [segment_end, degenerate]: [&[u64; WIDTH]; 2], outputs: &Outputs) {
        for slot in 0..WIDTH {
            self.flags[slot] =
                (segment_end[slot] & Flag::SegmentEnd as u64) | (degenerate[slot] & Flag::Degenerate as u64);
        }
        for vertex in 0..outputs.vertices {
            let first = vertex * outputs.words.len();
            for (field, range) in &outputs.fields {
                let real = field.shape.scalar == Scalar::F32;
                let words = &self.values[first + range.start..first + range.end];
                let (mut size, mut none) = ([0.0; WIDTH], [false; WIDTH]);
                for column in words {
                    for slot in 0..WIDTH {
                        grow((&mut size[slot], &mut none[slot]), column[slot]);
                    }
                }
                for slot in 0..WIDTH {
                    self.flags[slot] |= flags_of((size[slot], none[slot]), real);
                }
            }
        }
    }
}

/// The largest size of some numbers, and whether one is missing, with one more of them.
#[inline(always)]
pub(super) fn grow((size, none): (&mut f64, &mut bool), x: f64) {
    // NaN is not greater.
    *size = if x.abs() > *size { x.abs() } else { *size };
    *none |= x.is_nan();
}

/// The bits of the flags of an output of this size, without branches.
#[inline(always)]
pub(super) fn flags_of((size, none): (f64, bool), real: bool) -> u64 {
    let flag = |flag: Flag, holds: bool| flag as u64 & u64::from(holds).wrapping_neg();
    let infinite = size == f64::INFINITY;
    let of_size = flag(Flag::Infinite, infinite)
        | flag(Flag::Overflow, (size > f64::from(f32::MAX)) & !infinite)
        | flag(Flag::Underflow, (size > 0.0) & (size < MIN_NORMAL));
    flag(Flag::NoValue, none) | (of_size & u64::from(real).wrapping_neg())
}

/// Writes columns as rows, as many as there is room for.
#[inline]
pub(super) fn turn<X: Copy>(columns: &[[X; WIDTH]], rows: &mut [X]) {
    // Four components are what most have: their places are known when this is compiled.
    if let [x, y, z, w] = columns {
        for (slot, row) in rows.as_chunks_mut::<4>().0.iter_mut().enumerate().take(WIDTH) {
            *row = [x[slot], y[slot], z[slot], w[slot]];
        }
        return;
    }
    for (slot, row) in rows.chunks_exact_mut(columns.len().max(1)).enumerate().take(WIDTH) {
        row.iter_mut().zip(columns).for_each(|(out, column)| *out = column[slot]);
    }
}
