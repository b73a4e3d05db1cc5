//! Where a text stands that is a part of a file.

use base::text::SourceFile;

use crate::literal::Literal;

/// Where the text of a shader stands.
#[derive(Clone, Debug)]
pub struct Origin {
    /// The host file.
    pub host: SourceFile,
    /// The literals.
    pub literal: Literal,
}

/// Where a listing stands in its document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Path of the document.
    pub document: String,
    /// Number of its first block.
    pub order: usize,
    /// The headings that it stands under, the outermost first.
    pub section: Vec<usize>,
}

impl Place {
    /// How many headings two listings have in common.
    pub fn shared(&self, other: &Self) -> usize {
        self.section.iter().zip(&other.section).take_while(|(a, b)| a == b).count()
    }
}
