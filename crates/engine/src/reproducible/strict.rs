//! What strict binary32 gives, which lanes and other functions are held against.

use std::ops::Range;

use base::value::{Batch, Scalar};
use program::interp::{Binary32, Executable, FUEL, Machine, OutputColumn};

/// The output words of each sample of a batch, vertex after vertex.
pub(crate) struct StrictBits {
    words: Vec<u32>,
    /// Words of a vertex, and vertices of a sample.
    width: usize,
    pub(crate) room: usize,
}

impl StrictBits {
    pub(crate) fn of(executable: &Executable, batch: &Batch) -> Self {
        let mut machine = Machine::new(executable, Binary32::default(), FUEL);
        let (width, room) = (machine.width(), machine.room());
        let mut words = Vec::with_capacity(batch.invocation_count() * width * room);
        let mut first = 0;
        while first < batch.invocation_count() {
            let slots = machine.run(batch, first);
            for slot in 0..slots {
                let places = (0..room).flat_map(|vertex| (0..width).map(move |word| (vertex, word)));
                words.extend(places.map(|(vertex, word)| match machine.output(vertex, word) {
                    OutputColumn::Real(column) => column.values()[slot].to_bits(),
                    OutputColumn::Word(words) => words[slot],
                }));
            }
            first += slots;
        }
        Self { words, width, room }
    }

    /// The words of a vertex.
    pub(crate) fn vertex(&self, sample: usize, vertex: usize) -> &[u32] {
        let first = (sample * self.room + vertex) * self.width;
        &self.words[first..first + self.width]
    }

    /// An output of a sample, in all of its vertices. Any NaN is as good as another.
    pub(crate) fn output(&self, sample: usize, words: &Range<usize>, scalar: Scalar) -> impl Iterator<Item = u32> {
        let plain = move |word: u32| match scalar {
            Scalar::F32 if f32::from_bits(word).is_nan() => f32::NAN.to_bits(),
            _ => word,
        };
        (0..self.room).flat_map(move |vertex| self.vertex(sample, vertex)[words.clone()].iter().map(move |w| plain(*w)))
    }
}
