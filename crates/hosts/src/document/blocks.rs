//! Blocks of code as a document marks them.

use base::text::{SourceFile, Span};

use crate::Literal;

/// A block.
pub struct Block {
    /// What the document says of it: the line of a fence, a class.
    pub tag: String,
    /// The text and its places.
    pub literal: Literal,
    /// Its place in the document.
    pub place: Span,
    /// Number among the blocks.
    pub order: usize,
    /// The headings that it stands under.
    pub section: Vec<usize>,
}

/// The blocks of a document, as a reader finds them.
pub struct Blocks<'f> {
    /// The document.
    pub file: &'f SourceFile,
    found: Vec<Block>,
    /// Level and number of the open headings.
    section: Vec<(usize, usize)>,
    headings: usize,
}

impl<'f> Blocks<'f> {
    pub fn new(file: &'f SourceFile) -> Self {
        Self { file, found: Vec::new(), section: Vec::new(), headings: 0 }
    }

    /// A heading; 1 is the highest level.
    pub fn heading(&mut self, level: usize) {
        self.section.retain(|(l, _)| *l < level);
        self.section.push((level, self.headings));
        self.headings += 1;
    }

    /// A block of code with what the document says of it.
    pub fn add(&mut self, tag: &str, literal: Literal) {
        let Some(place) = literal.place() else { return };
        let section = self.section.iter().map(|(_, number)| *number).collect();
        self.found.push(Block { tag: tag.to_owned(), literal, place, order: self.found.len(), section });
    }

    pub fn finish(mut self) -> Vec<Block> {
        self.found.sort_by_key(|b| b.place);
        for (order, block) in self.found.iter_mut().enumerate() {
            block.order = order;
        }
        self.found
    }
}
