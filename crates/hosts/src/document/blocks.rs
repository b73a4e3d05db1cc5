//! Blocks of code as a document marks them.

use base::text::{SourceFile, Span};
use syntax::Stage;

use super::{Listing, Place};
use crate::{Literal, script};

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
    /// True for a text that scripts of a page take as it is.
    pub whole: bool,
}

/// The blocks of a document, as a reader finds them.
pub struct Blocks<'f> {
    /// The document.
    pub file: &'f SourceFile,
    found: Vec<Block>,
    /// Level and number of the open headings.
    section: Vec<(usize, usize)>,
    headings: usize,
    /// Places of scripts that a page runs.
    scripts: Vec<Span>,
}

impl<'f> Blocks<'f> {
    pub fn new(file: &'f SourceFile) -> Self {
        Self { file, found: Vec::new(), section: Vec::new(), headings: 0, scripts: Vec::new() }
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
        self.found.push(Block { tag: tag.to_owned(), literal, place, order: self.found.len(), section, whole: false });
    }

    /// A text that scripts of the page take as it is.
    pub fn add_whole(&mut self, tag: &str, place: Span) {
        let before = self.found.len();
        self.add(tag, Literal::part(self.file, place));
        self.found[before..].iter_mut().for_each(|block| block.whole = true);
    }

    /// A script that a page runs.
    pub fn run(&mut self, place: Span) {
        self.scripts.push(place);
    }

    /// The scripts of the page, in the place of all else spaces; none where they have nothing to do with shaders.
    pub fn script(&self) -> Option<Listing> {
        let (file, first) = (self.file, self.scripts.first()?);
        if !self.scripts.iter().any(|place| script::concerns_shaders(file.slice(*place))) {
            return None;
        }
        let mut literal = Literal::part(file, Span::new(0, file.text().len()));
        let mut text: Vec<u8> = file.text().bytes().map(|b| if b == b'\n' { b } else { b' ' }).collect();
        self.scripts.iter().for_each(|place| text[place.range()].copy_from_slice(file.slice(*place).as_bytes()));
        literal.text = String::from_utf8(text).ok()?;
        Some(Listing {
            name: format!("{}:{}", file.name(), file.position(first.start).line),
            called: None,
            literal,
            stage: Stage::Library,
            partial: false,
            whole: true,
            place: Place { document: file.name().to_owned(), order: self.found.len(), section: Vec::new() },
        })
    }

    pub fn finish(mut self) -> Vec<Block> {
        self.found.sort_by_key(|b| b.place);
        for (order, block) in self.found.iter_mut().enumerate() {
            block.order = order;
        }
        self.found
    }
}
