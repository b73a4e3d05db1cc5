//! Outputs that cross zero: a relative error beside a zero says nothing where the absolute one is a few roundings.

use super::name::Named;
use super::scan::ROUNDS;
use super::subject::Ready;
use base::value::{Batch, Record, Scalar};
use program::interp::{Binary64, Machine, OutputColumn, SLOTS};
use property::{Sample, Stream};

/// The part of an output's usual size that it may be off by: a few roundings.
const ROUNDINGS: f64 = 1.0 / (1_u64 << 18) as f64;

/// Samples of which the usual size of an output comes.
pub const PILOT: usize = 256;

/// How much more than a rounding of the inputs those on the way may move the output. `exp(x) - 1` beside 0 loses many
/// thousand times as much as its input has, for want of a better formula; `x - y` of inputs that are nearly equal does not.
const MORE: f64 = 1024.0;

/// Neighbours of the inputs that are tried.
const NEIGHBOURS: u64 = 6;

/// The usual size of each output word of the first vertex: the median over samples.
pub fn sizes(ready: &Ready, batch: &Batch) -> Vec<f64> {
    let mut wide = Machine::new(&ready.executable, Binary64::default(), ROUNDS);
    let all: Vec<usize> = (0..batch.invocation_count()).collect();
    let mut found = vec![Vec::new(); ready.kernel.output.vertex.words()];
    for chunk in all.chunks(SLOTS) {
        let count = wide.run_some(batch, chunk);
        wide.take_findings();
        for (word, found) in found.iter_mut().enumerate() {
            if let OutputColumn::Real(column) = wide.output(0, word) {
                found.extend(column.values()[..count].iter().map(|x| x.abs()).filter(|x| x.is_finite()));
            }
        }
    }
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    found.into_iter().map(median).collect()
}

/// True where an output is off by no more than roundings of its usual size, and has so steep a way through zero that inputs
/// off by their own rounding move it about as far: no other formula would keep more digits.
pub(super) fn crosses(named: &Named, sizes: &[f64], wide: &mut Machine<'_, Binary64>, sample: &Sample) -> bool {
    let error = (f64::from(named.strict) - named.meaning).abs();
    let usual = sizes.get(named.place.1).copied().unwrap_or(0.0);
    if named.meaning == 0.0 || error > usual * ROUNDINGS {
        return false;
    }
    let beside: Vec<Sample> = (0..NEIGHBOURS).map(|k| neighbour(sample, k)).collect();
    let batch = Sample::batch(&beside);
    let count = wide.run_some(&batch, &(0..beside.len()).collect::<Vec<_>>());
    let (vertex, word) = named.place;
    let OutputColumn::Real(found) = wide.output(vertex, word) else { return false };
    let moved = found.values()[..count].iter().map(|value| (value - named.meaning).abs());
    let moved = moved.filter(|far| far.is_finite()).fold(0.0, f64::max);
    wide.take_findings();
    error <= MORE * moved
}

/// A sample with each number at one of its neighbours in binary32: all above, all below, then by chance.
fn neighbour(sample: &Sample, k: u64) -> Sample {
    let mut near = sample.clone();
    let mut stream = Stream::new(k);
    let mut step = |words: &mut [u32], record: &Record| {
        for (word, bits) in words.iter_mut().enumerate() {
            let x = f32::from_bits(*bits);
            if record.scalar_of(word) != Scalar::F32 || x == 0.0 || !x.is_finite() {
                continue;
            }
            let up = match k {
                0 => true,
                1 => false,
                _ => stream.one_in(2),
            };
            *bits = if up { x.next_up() } else { x.next_down() }.to_bits();
        }
    };
    step(&mut near.invocation, &sample.invocation_record);
    step(&mut near.case, &sample.case_record);
    near
}
