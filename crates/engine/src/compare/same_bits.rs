//! Whether two functions have the same bits on every conforming device.

use serde::{Deserialize, Serialize};

use super::ReadyPair;
use crate::InputValue;
use crate::reproducible::{FreePlace, Gathering};
use base::value::Batch;
use judge::profile::Profile;
use program::interp::{Binary32, Executable, FUEL, Machine, OutputColumn};
use property::Sample;

/// An output that both have.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SameBits {
    /// Its name in the first.
    pub output: String,
    /// Samples for which both have the same bits on every conforming device.
    pub same: u64,
    /// Samples with other bits in strict binary32, which is a conforming device.
    pub other: u64,
    /// Samples with the same bits there, and something that is left to devices.
    pub open: u64,
    /// Inputs with other bits, and the command that shows them.
    pub first: Option<(Vec<InputValue>, String)>,
    /// What is left to devices in each of the two.
    pub places: [Vec<FreePlace>; 2],
}

impl SameBits {
    /// True where no sample says otherwise.
    pub fn holds(&self) -> bool {
        self.same > 0 && self.other + self.open == 0
    }
}

/// Samples as they are counted.
pub(super) struct Bits<'a> {
    pair: &'a ReadyPair<'a>,
    gatherings: [Gathering<'a>; 2],
    /// For each output that both have, its number in each.
    outputs: Vec<[usize; 2]>,
    counts: Vec<[u64; 3]>,
    first: Vec<Option<Sample>>,
}

impl<'a> Bits<'a> {
    /// For devices that keep a profile. `pilot` is a batch of inputs of the first.
    pub(super) fn new(pair: &'a ReadyPair<'a>, profile: &'a Profile, pilot: &Batch) -> Self {
        let gatherings =
            [Gathering::new(pair.sides[0], profile, pilot), Gathering::new(pair.sides[1], profile, &pair.fed(pilot))];
        let words = gatherings.each_ref().map(Gathering::words);
        let number = |side: usize, start: usize| words[side].iter().position(|(own, _)| own.start == start);
        let outputs: Vec<[usize; 2]> = pair
            .reference
            .pairs()
            .iter()
            .filter_map(|(own, other)| Some([number(0, own.start)?, number(1, other.start)?]))
            .collect();
        let (counts, first) = (vec![[0; 3]; outputs.len()], vec![None; outputs.len()]);
        Self { pair, gatherings, outputs, counts, first }
    }

    /// Looks at a batch, which the second gets as `fed`.
    pub(super) fn see(&mut self, batch: &Batch, fed: &Batch) {
        let [first, second] = &mut self.gatherings;
        let words = [first.words(), second.words()];
        let fixed = [first.see(batch), second.see(fed)];
        let bits = [strict(&self.pair.sides[0].executable, batch), strict(&self.pair.sides[1].executable, fed)];
        for (k, &[own, other]) in self.outputs.iter().enumerate() {
            for sample in 0..batch.invocation_count() {
                let of = |side: usize, output: usize| {
                    let range = &words[side][output].0;
                    let all = bits[side][sample].iter();
                    all.flat_map(|vertex| range.clone().filter_map(|word| vertex.get(word).copied()))
                        .collect::<Vec<u32>>()
                };
                let kind = if of(0, own) != of(1, other) {
                    self.first[k].get_or_insert_with(|| Sample::of(batch, sample));
                    1
                } else if fixed[0][own][sample] && fixed[1][other][sample] {
                    0
                } else {
                    2
                };
                self.counts[k][kind] += 1;
            }
        }
    }

    pub(super) fn finish(self, reproduce: &dyn Fn(&Sample) -> String) -> Vec<SameBits> {
        let Self { pair, gatherings, outputs, counts, first } = self;
        let [ours, theirs] = gatherings.map(|gathering| gathering.finish(&|_| Vec::new()));
        let program = &pair.sides[0].program;
        let all = outputs.into_iter().zip(counts).zip(first);
        all.map(|(([own, other], [same, unlike, open]), first)| SameBits {
            output: ours[own].name.clone(),
            same,
            other: unlike,
            open,
            first: first.map(|sample| (InputValue::all(&sample, program), reproduce(&sample))),
            places: [ours[own].places.clone(), theirs[other].places.clone()],
        })
        .collect()
    }
}

/// The bits of strict binary32: by sample, by vertex, by word. One NaN is as good as another.
fn strict(executable: &Executable, batch: &Batch) -> Vec<Vec<Vec<u32>>> {
    let mut machine = Machine::new(executable, Binary32::default(), FUEL);
    let mut all = Vec::with_capacity(batch.invocation_count());
    let mut first = 0;
    let plain = |x: f32| if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() };
    while first < batch.invocation_count() {
        let slots = machine.run(batch, first);
        let of = |slot: usize, vertex: usize, word: usize| match machine.output(vertex, word) {
            OutputColumn::Real(column) => plain(column.values()[slot]),
            OutputColumn::Word(words) => words[slot],
        };
        for slot in 0..slots {
            let vertex = |vertex: usize| (0..machine.width()).map(|word| of(slot, vertex, word)).collect();
            all.push((0..machine.room()).map(vertex).collect());
        }
        first += slots;
    }
    all
}
