//! What one thread computes of a block: expected values, bounds and flags of up to [`SLOTS`] samples at a time.

use std::ops::Range;
use std::sync::atomic::Ordering;

use super::columns::{Columns, flags_of, grow, turn};
use super::flags::{Flag, Flags, any_special};
use super::generate::{ByFormula, ExpectedFrom, Generator};
use super::inputs::Inputs;
use super::number::upward;
use base::value::{Batch, Scalar};
use chapter::exact::Exact;
use judge::profile::grid::MIN_NORMAL;
use judge::verdict::{Limiter, Limits, Meant, Reason, Roundoff, Wanted};
use lanes::Stage;
use number::twofold::WIDTH;
use number::wide;
use program::interp::SLOTS;
use property::encode;

/// A bound of this part of the size of an output makes it ill-conditioned.
const USELESS: f64 = 1.0 / 1024.0;
/// Shader and formula may be this part of an output apart: both are computed in binary64 or better.
const LAST_BITS: f64 = 1.0 / (1_u64 << 40) as f64;

/// Where a chunk of samples is written to.
pub(super) struct Part<'b> {
    pub expected: &'b mut [f64],
    pub nearest: &'b mut [u32],
    pub bound: &'b mut [f32],
    pub flags: &'b mut [Flags],
}

/// How much wider than in the order of the source a bound is where another order has none: so much may a device
/// gain or lose by another order of a few terms.
const WIDER: f64 = 16.0;

/// What one thread computes with.
pub(super) struct Worker<'g, 'a> {
    generator: &'g Generator<'a>,
    limiter: Option<Limiter<'g>>,
    limits: Limits,
    /// Bounds in the order of the source, for what has none otherwise.
    in_order: Option<(Limiter<'g>, Limits)>,
    meant: Option<(Meant<'g>, Option<Roundoff<'g>>)>,
    wanted: Option<Wanted<'g>>,
    values: Vec<f64>,
    /// How far what is expected may be off: by sample, then by word; empty where it is exact.
    slack: Vec<f64>,
    columns: Columns,
    /// Samples of which the quick phase is not sure.
    doubtful: Vec<usize>,
}

impl<'g, 'a> Worker<'g, 'a> {
    pub fn new(generator: &'g Generator<'a>) -> Self {
        let oracle = generator.subject.oracle();
        let bounded = generator.profile.is_some();
        Self {
            limiter: generator.profile.map(|profile| Limiter::new(oracle, profile, Stage::Compute)),
            limits: Limits::default(),
            in_order: generator
                .in_order
                .as_ref()
                .map(|profile| (Limiter::new(oracle, profile, Stage::Compute), Limits::default())),
            meant: matches!(generator.source, ExpectedFrom::Meaning)
                .then(|| (Meant::new(oracle), bounded.then(|| Roundoff::new(oracle)))),
            wanted: matches!(generator.source, ExpectedFrom::Reference)
                .then(|| Wanted::new(generator.subject.reference())),
            values: Vec::new(),
            slack: Vec::new(),
            columns: Columns::new(generator.outputs.words_of_sample()),
            doubtful: Vec::new(),
            generator,
        }
    }

    pub fn fill(&mut self, batch: &Batch, first: usize, mut part: Part<'_>) {
        self.inputs(batch, first, part.flags);
        match &self.generator.source {
            ExpectedFrom::Formula(by) => self.formula(by, batch, first, &mut part),
            ExpectedFrom::Reference => {
                self.reference(batch, first, &mut part);
                self.outputs(part.expected, part.flags);
            }
            ExpectedFrom::Meaning => {
                self.meaning(batch, first, &mut part);
                self.outputs(part.expected, part.flags);
            }
        }
        self.bounds(batch, first, &mut part);
    }

    fn formula(&mut self, by: &ByFormula, batch: &Batch, first: usize, part: &mut Part<'_>) {
        let ByFormula { exact, quick, routes, runs } = by;
        let width = self.columns.values.len();
        self.doubtful.clear();
        for at in (0..part.flags.len()).step_by(WIDTH) {
            let inputs = Inputs::new(batch, routes, first + at);
            let slots = WIDTH.min(part.flags.len() - at);
            let quick = quick.filter(|_| slots == WIDTH);
            if let (Some(quick), Some(case)) = (quick, inputs.case) {
                let Self { columns, generator, .. } = self;
                let all = wide(
                    #[inline(always)]
                    || {
                        inputs.give(case, runs, &mut columns.given);
                        columns.approach(quick, &generator.outputs)
                    },
                );
                if !all {
                    self.doubtful.extend(columns.unsure().map(|slot| at + slot));
                }
            } else {
                self.accurately(*exact, &inputs, &part.flags[at..at + slots]);
            }
            let Columns { values, nearest, flags, .. } = &self.columns;
            let to = at * width..(at + slots) * width;
            part.flags[at..].iter_mut().zip(flags).for_each(|(flags, &more)| flags.0 |= more as u16);
            turn(values, &mut part.expected[to.clone()]);
            turn(nearest, &mut part.nearest[to]);
        }
        let doubtful = std::mem::take(&mut self.doubtful);
        for rows in doubtful.chunks(WIDTH) {
            let mut special = [Flags::default(); WIDTH];
            rows.iter().zip(&mut special).for_each(|(&row, flags)| *flags = part.flags[row]);
            self.accurately(*exact, &Inputs::of(batch, routes, first, rows), &special);
            let Columns { values, nearest, flags, .. } = &self.columns;
            for (slot, &row) in rows.iter().enumerate() {
                part.flags[row].0 |= flags[slot] as u16;
                for word in 0..width {
                    part.expected[row * width + word] = values[word][slot];
                    part.nearest[row * width + word] = nearest[word][slot];
                }
            }
        }
        self.doubtful = doubtful;
    }

    /// Computes a formula in 100 bits.
    fn accurately(&mut self, exact: Exact, inputs: &Inputs<'_>, flags: &[Flags]) {
        let Self { columns, generator, .. } = self;
        let outputs = &generator.outputs;
        // Numbers that are finite are computed fast. Only where one is not has arithmetic to be careful.
        let fast = flags.iter().all(|flags| !flags.has(Flag::InputNan) && !flags.has(Flag::InputInfinite))
            && wide(
                #[inline(always)]
                || columns.evaluate::<false>(exact, inputs, outputs),
            );
        if !fast {
            columns.evaluate::<true>(exact, inputs, outputs);
        }
    }

    fn reference(&mut self, batch: &Batch, first: usize, part: &mut Part<'_>) {
        let Self { generator, wanted, slack, .. } = self;
        let Some(wanted) = wanted else { return };
        let outputs = &generator.outputs;
        let width = outputs.words.len();
        slack.clear();
        let rows = part.flags.len();
        wanted.look(batch, first, rows, &mut |row, words, off| {
            for (k, &word) in outputs.words.iter().enumerate() {
                let value = words.get(k).copied().unwrap_or(f64::NAN);
                put(part, row * width + k, value, outputs.scalars[word]);
                slack.push(off.get(k).copied().unwrap_or(0.0));
            }
        });
    }

    fn meaning(&mut self, batch: &Batch, first: usize, part: &mut Part<'_>) {
        let Self { generator, meant, values, slack, .. } = self;
        let outputs = &generator.outputs;
        let Some((meant, roundoff)) = meant else { return };
        meant.look(batch, first, &outputs.scalars, values);
        let width = outputs.words.len();
        for row in 0..part.flags.len() {
            for (k, &word) in outputs.words.iter().enumerate() {
                put(part, row * width + k, values[word * SLOTS + row], outputs.scalars[word]);
            }
        }
        let Some(roundoff) = roundoff else { return };
        roundoff.look(batch, first, values);
        slack.clear();
        for row in 0..part.flags.len() {
            slack.extend(outputs.words.iter().map(|&word| values[word * SLOTS + row]));
        }
    }

    /// Flags that follow from the inputs.
    fn inputs(&self, batch: &Batch, first: usize, flags: &mut [Flags]) {
        let [own, shared] = &self.generator.real;
        let stride = batch.invocation_record.words();
        let (mut case, mut invocation) = (first / batch.per_case, first % batch.per_case);
        let mut of_case = special_inputs(batch.case(case), shared);
        for (part, flags) in flags.chunks_mut(WIDTH).enumerate() {
            let first = first + part * WIDTH;
            // Most have none: that is found out for many at once.
            let special = match own.as_slice() {
                [run] if run.len() == stride => {
                    let words = &batch.invocations[first * stride..(first + flags.len()) * stride];
                    wide(
                        #[inline(always)]
                        || any_special(words),
                    )
                }
                _ => true,
            };
            for (k, flags) in flags.iter_mut().enumerate() {
                if invocation == batch.per_case {
                    (case, invocation) = (case + 1, 0);
                    of_case = special_inputs(batch.case(case), shared);
                }
                invocation += 1;
                flags.0 |= of_case.0;
                if special {
                    flags.0 |= special_inputs(batch.invocation(first + k), own).0;
                }
            }
        }
    }

    /// Flags that follow from what is expected; those of a formula are in its columns.
    fn outputs(&self, expected: &[f64], flags: &mut [Flags]) {
        let outputs = &self.generator.outputs;
        for (values, flags) in expected.chunks_exact(outputs.words_of_sample()).zip(flags) {
            for vertex in values.chunks_exact(outputs.words.len()) {
                for (field, range) in &outputs.fields {
                    let real = field.shape.scalar == Scalar::F32;
                    let (mut size, mut none) = (0.0, false);
                    vertex[range.clone()].iter().for_each(|&x| grow((&mut size, &mut none), x));
                    flags.0 |= flags_of((size, none), real) as u16;
                }
            }
        }
    }

    /// Bounds, and the flags that follow from them.
    fn bounds(&mut self, batch: &Batch, first: usize, part: &mut Part<'_>) {
        let outputs = &self.generator.outputs;
        let Some(limiter) = &mut self.limiter else { return };
        let by_formula = matches!(self.generator.source, ExpectedFrom::Formula(_));
        let mut apart_rows = 0;
        limiter.look(batch, first, &mut self.limits);
        if let Some(in_order) = &mut self.in_order {
            fall_back(&mut self.limits, in_order, batch, first);
        }
        let Limits { values, bounds, reasons, .. } = &self.limits;
        let stride = outputs.words_of_sample();
        for (row, flags) in part.flags.iter_mut().enumerate() {
            if let Some(reason) = reasons[row] {
                flags.set(match reason {
                    Reason::Domain | Reason::Undefined => Flag::NoValue,
                    Reason::NoPromise => Flag::NoPromise,
                    Reason::IllConditioned => Flag::IllConditioned,
                    Reason::Branch | Reason::TexelEdge | Reason::LongLoop => Flag::Branch,
                    Reason::Underflow => Flag::Underflow,
                    Reason::Overflow => Flag::Overflow,
                });
            }
            let vector = largest_input(batch, first + row);
            let mut is_apart = false;
            for vertex in 0..outputs.vertices {
                for (field, range) in &outputs.fields {
                    let at = row * stride + vertex * outputs.words.len();
                    let expected = &part.expected[at..][range.clone()];
                    let scale = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs())).max(vector);
                    for (k, &expected) in range.clone().zip(expected) {
                        let from = (vertex * outputs.width + outputs.words[k]) * SLOTS + row;
                        let apart = (values[from] - expected).abs();
                        let slack = self.slack.get(at + k).copied().unwrap_or(0.0);
                        let bound = bounds[from] + slack;
                        // What the tape starts from is not what is expected to the last bit, and where it is
                        // something else the shader is wrong: a bound does not make up for that.
                        let near = apart <= bound + LAST_BITS * scale;
                        is_apart |= apart.is_finite() && !near;
                        let real = field.shape.scalar == Scalar::F32;
                        let bound = if real && by_formula && near { bound + apart } else { bound };
                        let bound = if expected.is_finite() { upward(bound) } else { f32::INFINITY };
                        part.bound[at + k] = bound;
                        if bound.is_finite() && f64::from(bound) > USELESS * scale.max(MIN_NORMAL) {
                            flags.set(Flag::IllConditioned);
                        }
                    }
                }
            }
            apart_rows += u64::from(is_apart);
        }
        self.generator.apart.fetch_add(apart_rows, Ordering::Relaxed);
    }
}

/// Bounds where there are none, from the order of the source. Flags still say why there are none otherwise.
fn fall_back(limits: &mut Limits, in_order: &mut (Limiter<'_>, Limits), batch: &Batch, first: usize) {
    if limits.bounds.iter().all(|bound| bound.is_finite()) {
        return;
    }
    let (limiter, other) = in_order;
    limiter.look(batch, first, other);
    for (bound, other) in limits.bounds.iter_mut().zip(&other.bounds).filter(|(bound, _)| !bound.is_finite()) {
        *bound = WIDER * other;
    }
}

/// The flags of the words of an input that are numbers.
fn special_inputs(words: &[u32], runs: &[Range<usize>]) -> Flags {
    let mut flags = Flags::default();
    for run in runs {
        let words = &words[run.clone()];
        let special = wide(
            #[inline(always)]
            || any_special(words),
        );
        if special {
            words.iter().for_each(|&bits| flags.input(bits));
        }
    }
    flags
}

/// Writes a word of what is expected, with the nearest number of its own type.
fn put(part: &mut Part<'_>, at: usize, value: f64, scalar: Scalar) {
    let real = scalar == Scalar::F32;
    part.expected[at] = if value.is_nan() { f64::NAN } else { value };
    part.nearest[at] = if value.is_nan() && real { f32::NAN.to_bits() } else { encode(value, scalar) };
}

/// The largest component of the vectors among the inputs, which outputs are measured against.
fn largest_input(batch: &Batch, invocation: usize) -> f64 {
    let sides =
        [(&batch.invocation_record, batch.invocation(invocation)), (&batch.case_record, batch.case_of(invocation))];
    let mut most = 0.0_f64;
    for (record, words) in sides {
        for (k, field) in record.fields().iter().enumerate() {
            if field.shape.scalar == Scalar::F32 && field.shape.columns == 1 && field.shape.rows > 1 {
                let part = &words[record.range(k)];
                most = part.iter().fold(most, |most, &w| most.max(f64::from(f32::from_bits(w)).abs()));
            }
        }
    }
    most
}
