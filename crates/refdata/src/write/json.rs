//! JSON: the document, and for each block and array the bits as texts with the decimals beside them.

use std::io;

use super::text::{Text, Word};
use super::{Sink, Store};
use crate::array::{Array, Per, Role};
use crate::document::Document;
use crate::flags::Flags;
use crate::generate::Block;

pub(super) struct Json<'s> {
    text: Text<'s>,
    arrays: Vec<Array>,
    first: bool,
}

impl<'s> Json<'s> {
    pub fn new(document: &Document, store: Box<dyn Store + 's>) -> io::Result<Self> {
        let text = Text::new(store, "{\"provenance\": ", document, ",\n\"blocks\": [")?;
        Ok(Self { text, arrays: document.arrays.clone(), first: true })
    }

    fn list(&mut self, array: &Array, bytes: &[u8], rows: usize, show: &dyn Fn(Word) -> String) -> io::Result<()> {
        for row in 0..rows {
            let words: Vec<String> = Word::row(array, bytes, row).map(show).collect();
            let words = words.join(", ");
            let comma = if row == 0 { "" } else { ",\n    " };
            match array.shape.is_empty() {
                true => self.text.write(&format!("{comma}{words}"))?,
                false => self.text.write(&format!("{comma}[{words}]"))?,
            }
        }
        Ok(())
    }
}

impl Sink for Json<'_> {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        let comma = if std::mem::take(&mut self.first) { "" } else { "," };
        let Block { first, rows, .. } = block;
        self.text.write(&format!("{comma}\n{{\"first\": {first}, \"rows\": {rows}, \"arrays\": {{"))?;
        for (k, (array, bytes)) in self.arrays.clone().iter().zip(&block.arrays).enumerate() {
            let rows = match array.per {
                Per::Sample => block.rows,
                Per::Case => block.cases,
            };
            let comma = if k == 0 { "" } else { "," };
            self.text.write(&format!("{comma}\n  \"{}\": {{\"bits\": [", array.name))?;
            self.list(array, bytes, rows, &|word| format!("\"{}\"", word.hex()))?;
            self.text.write("],\n   \"value\": [")?;
            self.list(array, bytes, rows, &|word| match (array.role, word) {
                (Role::Flags, Word::U2(bits)) => format!("\"{}\"", Flags(bits)),
                _ if word.is_finite() => word.decimal(),
                _ => format!("\"{}\"", word.decimal()),
            })?;
            self.text.write("]}")?;
        }
        self.text.write("}}")
    }

    fn finish(&mut self, document: &Document) -> io::Result<()> {
        self.text.write("\n]}\n")?;
        self.text.finish(document)
    }
}
