//! What a machine hands out once a chunk is done.

use std::mem::take;

use super::POISON;
use super::code::{Executable, File};
use super::domain::Domain;
use super::machine::Machine;
use super::meaning::{Finding, Flags};
use super::slots::{SLOTS, Words};

/// An output word of one chunk.
#[derive(Debug)]
pub enum OutputColumn<'m, C> {
    /// A real number.
    Real(&'m C),
    /// An integer or boolean.
    Word(&'m Words),
}

impl Executable {
    /// For a geometry stage, the number of vertices that are stored.
    pub fn max_vertices(&self) -> Option<u32> {
        self.max_vertices
    }
}

/// What came out of the last chunk.
impl<D: Domain> Machine<'_, D> {
    /// The domain, with what it remembers.
    pub fn domain(&mut self) -> &mut D {
        &mut self.domain
    }

    /// The domain, to look at.
    pub fn as_domain(&self) -> &D {
        &self.domain
    }

    /// An output word of a vertex (0 for a pointwise program), in all slots.
    pub fn output(&self, vertex: usize, word: usize) -> OutputColumn<'_, D::Column> {
        let register = self.executable.outputs[word];
        let before = &self.executable.outputs[..word];
        let nth = before.iter().filter(|other| other.file() == register.file()).count();
        let reg = register.reg as usize;
        match (self.executable.max_vertices, register.file()) {
            (Some(_), File::Real) => OutputColumn::Real(&self.vertices[vertex].0[nth]),
            (Some(_), File::Word) => OutputColumn::Word(&self.vertices[vertex].1[nth]),
            (None, File::Real) => OutputColumn::Real(&self.reals[reg]),
            (None, File::Word) => OutputColumn::Word(&self.words[reg]),
        }
    }

    /// An output word of one slot, from its column; `None` when it was never written.
    pub fn word(&self, column: &OutputColumn<'_, D::Column>, word: usize, slot: usize) -> Option<D::Word> {
        match column {
            OutputColumn::Real(column) => self.domain.word(column, slot),
            OutputColumn::Word(words) => {
                let value = words[slot];
                (value != POISON).then(|| D::exact(value, self.executable.outputs[word].scalar))
            }
        }
    }

    /// True for a geometry stage, which emits vertices.
    pub fn is_emitting(&self) -> bool {
        self.executable.max_vertices.is_some()
    }

    /// Output words of one vertex.
    pub fn width(&self) -> usize {
        self.executable.outputs.len()
    }

    /// Vertices that are stored for each slot at most; 1 for a pointwise program.
    pub fn room(&self) -> usize {
        self.executable.max_vertices.unwrap_or(1) as usize
    }

    /// Vertices that each slot emitted, those past the limit included.
    pub fn emitted(&self) -> &Words {
        &self.emitted
    }

    /// Strips that each slot ended.
    pub fn ended(&self) -> &Words {
        &self.ended
    }

    /// The strip of a stored vertex in each slot.
    pub fn strip(&self, vertex: usize) -> &Words {
        &self.strips[vertex]
    }

    /// Rounds that all loops went through since the machine was made; slots that go side by side share theirs.
    pub fn rounds(&self) -> u64 {
        self.rounds
    }

    /// What each slot came upon.
    pub fn flags(&self) -> &[Flags; SLOTS] {
        &self.flags
    }

    /// Findings since the last call.
    pub fn take_findings(&mut self) -> Vec<Finding> {
        take(&mut self.findings)
    }
}
