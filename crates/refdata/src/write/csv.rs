//! A table: the document in a comment, names, one line for each sample. Uniforms are repeated for every
//! sample of a case.

use std::io;

use super::text::{Text, Word};
use super::{Sink, Store};
use crate::array::{Array, Per, Role};
use crate::document::Document;
use crate::flags::Flags;
use crate::generate::Block;

pub(super) struct Csv<'s> {
    text: Text<'s>,
    arrays: Vec<Array>,
}

impl<'s> Csv<'s> {
    pub fn new(document: &Document, store: Box<dyn Store + 's>) -> io::Result<Self> {
        let mut text = Text::new(store, "# ", document, "\n")?;
        let columns = document.arrays.iter().flat_map(|array| (0..array.words()).map(|word| array.column(word)));
        let names: Vec<String> = ["index".to_owned()].into_iter().chain(columns).collect();
        text.write(&format!("{}\n", names.join(",")))?;
        Ok(Self { text, arrays: document.arrays.clone() })
    }
}

impl Sink for Csv<'_> {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        let mut line = String::new();
        for row in 0..block.rows {
            line.clear();
            line.push_str(&(block.first + row as u64).to_string());
            for (array, bytes) in self.arrays.iter().zip(&block.arrays) {
                let at = match array.per {
                    Per::Sample => row,
                    Per::Case => row / block.per_case,
                };
                for word in Word::row(array, bytes, at) {
                    line.push(',');
                    match (array.role, word) {
                        (Role::Flags, Word::U2(bits)) => line.push_str(&Flags(bits).to_string()),
                        _ => line.push_str(&word.decimal()),
                    }
                }
            }
            line.push('\n');
            self.text.write(&line)?;
        }
        Ok(())
    }

    fn finish(&mut self, document: &Document) -> io::Result<()> {
        self.text.finish(document)
    }
}
