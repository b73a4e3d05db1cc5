//! Records that a lane puts together itself.

use crate::{Actual, LaneError, Marks};
use program::OutputLayout;

/// Records of a batch that a lane puts together itself, as [`OutputLayout`] has them.
///
/// A record gets its canary when it is ended; a lane ends it when the device has said that it wrote it.
pub(super) struct Records<'a> {
    layout: &'a OutputLayout,
    words: Vec<u32>,
    count: usize,
    marks: Marks,
}

impl<'a> Records<'a> {
    /// Records of `count` invocations in which nothing is written.
    pub fn new(layout: &'a OutputLayout, count: usize, marks: Marks) -> Self {
        Self { layout, words: vec![marks.sentinel; layout.words() * count], count, marks }
    }

    /// The words of a vertex; `None` for one past the limit, which is counted and not stored. A pointwise program
    /// has one.
    pub fn vertex(&mut self, invocation: usize, vertex: usize, strip: u32) -> Option<&mut [u32]> {
        if vertex >= self.layout.max_vertices.unwrap_or(1) as usize {
            return None;
        }
        let at = invocation * self.layout.words() + self.layout.header_words() + vertex * self.layout.vertex_words();
        let words = &mut self.words[at..][..self.layout.vertex_words()];
        if self.layout.max_vertices.is_none() {
            return Some(words);
        }
        words[0] = strip;
        Some(&mut words[1..])
    }

    /// Ends the record of an invocation that emitted so many vertices and ended so many strips.
    pub fn end(&mut self, invocation: usize, emitted: u32, ended: u32) {
        let at = invocation * self.layout.words();
        self.words[at] = self.marks.canary ^ invocation as u32;
        if self.layout.max_vertices.is_some() {
            self.words[at + 1..][..2].copy_from_slice(&[emitted, ended]);
        }
    }

    /// The outputs, when all records were ended.
    ///
    /// # Errors
    /// [`LaneError::NotWritten`] otherwise.
    pub fn accept(self) -> Result<Actual, LaneError> {
        Actual::accept(self.layout, self.words, self.count, self.marks)
    }
}
