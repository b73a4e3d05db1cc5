//! Whether two functions have the same bits on every conforming device.

use serde::{Deserialize, Serialize};

use super::ReadyPair;
use crate::InputValue;
use crate::reproducible::{FreePlace, Gathering, StrictBits};
use base::value::Batch;
use judge::profile::Profile;
use lanes::interrupt;
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
        // What was under way when the run was to end is not counted.
        if interrupt::asked() {
            return;
        }
        let sides = self.pair.sides;
        let bits = [StrictBits::of(&sides[0].executable, batch), StrictBits::of(&sides[1].executable, fed)];
        for (k, &[own, other]) in self.outputs.iter().enumerate() {
            for sample in 0..batch.invocation_count() {
                let of = |side: usize, output: usize| {
                    let range = &words[side][output].0;
                    bits[side].output(sample, range, sides[side].kernel.output.vertex.scalar_of(range.start))
                };
                let kind = if !of(0, own).eq(of(1, other)) {
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
