//! What a lane wrote.

use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::LaneError;
use crate::OutputLayout;

/// Random words of one dispatch, by which its writing is told from anything else.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Marks {
    /// The first word of the record of invocation `i` must be `canary ^ i`.
    pub canary: u32,
    /// What output buffers and output variables hold before the shader writes them: a quiet NaN
    /// with a random payload, which arithmetic on numbers cannot give.
    pub sentinel: u32,
}

impl Marks {
    /// New random marks.
    pub fn random() -> Self {
        // The standard library seeds each `RandomState` anew; no stronger randomness is needed.
        let bits = RandomState::new().hash_one(0_u8);
        Self { canary: bits as u32, sentinel: 0x7fc0_0001 | ((bits >> 32) as u32 & 0x003f_ffff) }
    }

    /// A random word of the same kind as a sentinel that is another one: what a buffer holds before a dispatch whose
    /// shader writes the sentinel itself.
    pub fn blank(sentinel: u32) -> u32 {
        let word = Self::random().sentinel;
        if word == sentinel { word ^ 2 } else { word }
    }
}

/// Outputs of a batch as a device wrote them: words, bit by bit.
///
/// Only a lane can make one, from the buffer that it read back. What the formula says and what the
/// shader means are other types, and the judge takes this one alone for a lane's word.
#[derive(Debug)]
pub struct Actual {
    layout: OutputLayout,
    words: Vec<u32>,
    count: usize,
    marks: Marks,
    /// Invocations of the batch that were left out, in rising order.
    absent: Vec<usize>,
}

impl Actual {
    /// Takes the words that were read back after a dispatch of `count` invocations.
    ///
    /// # Errors
    /// [`LaneError::NotWritten`] when a record does not bear the canary of this dispatch.
    pub fn accept(layout: &OutputLayout, words: Vec<u32>, count: usize, marks: Marks) -> Result<Self, LaneError> {
        let size = layout.words();
        for invocation in 0..count {
            let found = words.get(invocation * size).copied().unwrap_or(marks.sentinel);
            let expected = marks.canary ^ invocation as u32;
            if found != expected || words.len() < (invocation + 1) * size {
                return Err(LaneError::NotWritten { invocation, count, found, expected });
            }
        }
        Ok(Self { layout: layout.clone(), words, count, marks, absent: Vec::new() })
    }

    /// The words and the marks, to be accepted again in another process.
    pub fn into_words(self) -> (Vec<u32>, Marks) {
        (self.words, self.marks)
    }

    /// The same with other words, for an engine that errs on purpose; whoever accepts it next looks at each record.
    pub fn altered(mut self, word: impl Fn(u32) -> u32) -> Self {
        self.words.iter_mut().for_each(|w| *w = word(*w));
        self
    }

    /// The same with invocations, in rising order, that were left out: they have no outputs, and no say.
    pub fn without(mut self, absent: Vec<usize>) -> Self {
        let size = self.layout.words();
        absent.iter().for_each(|&k| self.words[k * size..][..size].fill(0));
        Self { absent, ..self }
    }

    /// The outputs of a batch all invocations of which were left out.
    pub fn none(layout: &OutputLayout, count: usize) -> Self {
        let (words, absent) = (vec![0; layout.words() * count], (0..count).collect());
        Self { layout: layout.clone(), words, count, marks: Marks::random(), absent }
    }

    /// True for an invocation that was left out: what it does is undefined, and the executor fails at it.
    pub fn is_absent(&self, invocation: usize) -> bool {
        self.absent.binary_search(&invocation).is_ok()
    }

    /// Number of invocations.
    pub fn count(&self) -> usize {
        self.count
    }

    /// How records are laid out.
    pub fn layout(&self) -> &OutputLayout {
        &self.layout
    }

    /// True for the word that stands where the shader wrote nothing.
    pub fn is_unwritten(&self, word: u32) -> bool {
        word == self.marks.sentinel
    }

    fn record(&self, invocation: usize) -> &[u32] {
        let size = self.layout.words();
        &self.words[invocation * size..][..size]
    }

    /// Number of vertices that the invocation emitted, those past the limit included; 1 for a
    /// pointwise program.
    pub fn emitted(&self, invocation: usize) -> u32 {
        if self.layout.max_vertices.is_some() { self.record(invocation)[1] } else { 1 }
    }

    /// Number of vertices that are stored.
    pub fn stored(&self, invocation: usize) -> usize {
        self.emitted(invocation).min(self.layout.max_vertices.unwrap_or(1)) as usize
    }

    /// Number of times that the invocation ended a strip; 0 for a pointwise program.
    pub fn ended_strips(&self, invocation: usize) -> u32 {
        if self.layout.max_vertices.is_some() { self.record(invocation)[2] } else { 0 }
    }

    /// Where the output words of a vertex lie in a record.
    fn words_of(&self, vertex: usize) -> Range<usize> {
        let (size, start) = (self.layout.vertex_words(), self.layout.header_words());
        let strip = usize::from(self.layout.max_vertices.is_some());
        start + vertex * size + strip..start + (vertex + 1) * size
    }

    /// Output words of a stored vertex.
    pub fn vertex(&self, invocation: usize, vertex: usize) -> &[u32] {
        &self.record(invocation)[self.words_of(vertex)]
    }

    /// One word of a vertex for several invocations, each with the place in `to` that it goes to.
    ///
    /// # Panics
    /// Where an invocation has not stored that vertex: a defect of the caller.
    pub fn gather(
        &self,
        vertex: usize,
        word: usize,
        invocations: impl Iterator<Item = (usize, usize)>,
        to: &mut [u32],
    ) {
        let (at, size) = (self.words_of(vertex).start + word, self.layout.words());
        for (place, invocation) in invocations {
            to[place] = self.words[invocation * size + at];
        }
    }

    /// Number of the strip of a stored vertex, from 0; 0 for a pointwise program.
    pub fn strip(&self, invocation: usize, vertex: usize) -> u32 {
        if self.layout.max_vertices.is_none() {
            return 0;
        }
        self.record(invocation)[self.layout.header_words() + vertex * self.layout.vertex_words()]
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use base::value::{Field, Record, Shape};

    fn layout(max_vertices: Option<u32>) -> OutputLayout {
        let vertex = Record::new(vec![Field { name: "d".into(), shape: Shape::FLOAT }]);
        OutputLayout { vertex: Arc::new(vertex), max_vertices }
    }

    const MARKS: Marks = Marks { canary: 0xabcd_0000, sentinel: 0x7fc0_1235 };

    #[test]
    fn a_record_that_was_not_written_is_an_error() {
        let words = vec![0xabcd_0000, 1, 0xabcd_0001, 2, MARKS.sentinel, MARKS.sentinel];
        let error = Actual::accept(&layout(None), words, 3, MARKS).unwrap_err();
        assert!(matches!(error, LaneError::NotWritten { invocation: 2, count: 3, .. }));
    }

    #[test]
    fn a_stale_buffer_is_an_error() {
        let older = Marks { canary: 0x1111_0000, ..MARKS };
        let words = vec![0x1111_0000, 1, 0x1111_0001, 2];
        assert!(Actual::accept(&layout(None), words.clone(), 2, older).is_ok());
        assert!(Actual::accept(&layout(None), words, 2, MARKS).is_err());
    }

    #[test]
    fn a_short_buffer_is_an_error() {
        assert!(Actual::accept(&layout(None), vec![0xabcd_0000, 1, 0xabcd_0001], 2, MARKS).is_err());
    }

    #[test]
    fn vertices_past_the_limit_are_counted_but_not_stored() {
        let words = vec![0xabcd_0000, 5, 1, 0, 10, 1, 11];
        let actual = Actual::accept(&layout(Some(2)), words, 1, MARKS).unwrap();
        assert_eq!((actual.emitted(0), actual.stored(0), actual.ended_strips(0)), (5, 2, 1));
        assert_eq!((actual.vertex(0, 1), actual.strip(0, 0), actual.strip(0, 1)), (&[11_u32][..], 0, 1));
    }

    #[test]
    fn marks_differ_from_dispatch_to_dispatch_and_the_sentinel_is_nan() {
        let (a, b) = (Marks::random(), Marks::random());
        assert_ne!(a, b);
        assert!(f32::from_bits(a.sentinel).is_nan() && f32::from_bits(b.sentinel).is_nan());
    }
}
