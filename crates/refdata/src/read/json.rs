//! JSON: reference files, and outputs as an object of lists, one entry for each sample.

mod block;
mod columns;

use std::io::{BufReader, Read};
use std::marker::PhantomData;

use serde::Deserializer as _;
use serde::de::{DeserializeOwned, DeserializeSeed, IgnoredAny};
use serde_json::Deserializer;
use serde_json::value::RawValue;

use super::blocks::{Blocks, Numbers as Where};
use super::shared::Shared;
use super::{Column, Dataset, MOST_TEXT, Numbers, ReadError, Table};
use crate::array::WordType;
use crate::document::Document;

fn damaged(error: impl std::fmt::Display) -> ReadError {
    ReadError::Damaged(format!("it is no JSON, cut off or damaged: {error}"))
}

/// JSON that holds something else than it should, or none.
fn read_error(error: serde_json::Error) -> ReadError {
    if error.is_data() { ReadError::Damaged(error.to_string()) } else { damaged(error) }
}

/// A text in JSON, of which one value is in memory at a time.
pub(super) struct Values {
    from: BufReader<Shared>,
    /// A byte that was read and not used.
    ahead: Option<u8>,
    /// Blocks that were read.
    read: usize,
    /// The list of blocks has ended.
    ended: bool,
}

impl Values {
    /// The next byte that is no blank.
    fn byte(&mut self) -> Result<u8, ReadError> {
        loop {
            let byte = match self.ahead.take() {
                Some(byte) => byte,
                None => {
                    let mut byte = [0];
                    self.from.read_exact(&mut byte).map_err(damaged)?;
                    byte[0]
                }
            };
            if !byte.is_ascii_whitespace() {
                return Ok(byte);
            }
        }
    }

    fn expect(&mut self, wanted: u8) -> Result<(), ReadError> {
        let found = self.byte()?;
        if found == wanted {
            return Ok(());
        }
        Err(damaged(format!("`{}` where `{}` should be", char::from(found), char::from(wanted))))
    }

    /// A text, a list or an object: its end is seen without looking at what follows.
    fn seeded<'de, T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, ReadError> {
        let first = [self.byte()?];
        let from = first.as_slice().chain(&mut self.from);
        seed.deserialize(&mut Deserializer::from_reader(from)).map_err(read_error)
    }

    fn value<T: DeserializeOwned>(&mut self) -> Result<T, ReadError> {
        self.seeded(PhantomData)
    }

    /// Goes over a value of any kind.
    fn skip(&mut self) -> Result<(), ReadError> {
        let first = self.byte()?;
        self.ahead = Some(first);
        if matches!(first, b'"' | b'[' | b'{') {
            return self.value::<IgnoredAny>().map(|_| ());
        }
        loop {
            let byte = self.byte()?;
            if matches!(byte, b',' | b'}' | b']') {
                self.ahead = Some(byte);
                return Ok(());
            }
        }
    }

    /// Goes to the value of a member of the object that begins here; false when there is none.
    fn find(&mut self, name: &str) -> Result<bool, ReadError> {
        loop {
            match self.byte()? {
                b'{' | b',' => {}
                b'}' => return Ok(false),
                other => return Err(damaged(format!("`{}` where a member should be", char::from(other)))),
            }
            match self.byte()? {
                b'}' => return Ok(false),
                other => self.ahead = Some(other),
            }
            let member: String = self.value()?;
            self.expect(b':')?;
            if member == name {
                return Ok(true);
            }
            self.skip()?;
        }
    }

    /// The arrays of the next block; none after the last one.
    pub fn next(&mut self, document: &Document) -> Result<Option<Vec<Vec<u8>>>, ReadError> {
        if self.ended {
            return Ok(None);
        }
        match self.byte()? {
            b']' => {
                // There may be other members behind them.
                let end = self.byte()?;
                if !matches!(end, b'}' | b',') {
                    return Err(damaged(format!("`{}` where `}}` should be", char::from(end))));
                }
                self.ended = true;
                return Ok(None);
            }
            b',' if self.read > 0 => {}
            other => self.ahead = Some(other),
        }
        let arrays = self.seeded(block::Arrays::new(document, self.read))?;
        self.read += 1;
        Ok(Some(arrays))
    }
}

/// A reference file, block by block. Its provenance may stand before or after them.
pub(super) fn opened(from: &Shared) -> Result<(Document, Where), ReadError> {
    let none = || ReadError::Schema("it has no `provenance`, which a reference file has".into());
    found(from)?.ok_or_else(none)
}

/// The same; nothing of a file without a provenance.
fn found(from: &Shared) -> Result<Option<(Document, Where)>, ReadError> {
    let begin = || Values { from: BufReader::with_capacity(1 << 16, from.at(0)), ahead: None, read: 0, ended: false };
    let mut values = begin();
    let first = values.byte()?;
    values.ahead = Some(first);
    if first != b'{' || !values.find("provenance")? {
        return Ok(None);
    }
    let provenance: Box<RawValue> = values.value()?;
    if provenance.get().len() as u64 > MOST_TEXT {
        return Err(ReadError::Schema(format!("its provenance has more than {MOST_TEXT} bytes")));
    }
    let document = Document::read(provenance.get()).map_err(ReadError::Schema)?;
    if !values.find("blocks")? {
        // They may stand before it.
        values = begin();
        if !values.find("blocks")? {
            return Err(ReadError::Damaged("it has no `blocks`".into()));
        }
    }
    values.expect(b'[')?;
    Ok(Some((document, Where::Values(values))))
}

/// Outputs: an object whose members are lists of numbers or of lists of numbers, one entry for each sample;
/// or a reference file.
pub(super) fn table(from: &Shared) -> Result<Table, ReadError> {
    if let Some((document, numbers)) = found(from)? {
        return Ok(of_dataset(&Dataset::of(&mut Blocks::of(document, numbers)?)?));
    }
    let mut from = Deserializer::from_reader(BufReader::with_capacity(1 << 16, from.at(0)));
    let columns = from.deserialize_any(columns::Columns).and_then(|columns| from.end().map(|()| columns));
    let table = Table { columns: columns.map_err(read_error)? };
    if table.columns.is_empty() {
        return Err(ReadError::Damaged(
            "outputs in JSON are an object of lists, such as {\"gl_Position\": [[0.0, 1.0, 0.0, 1.0]]}".into(),
        ));
    }
    Ok(table)
}

fn of_dataset(dataset: &Dataset) -> Table {
    let column = |(array, bytes): (&crate::Array, &Vec<u8>)| {
        let words = bytes.chunks_exact(array.dtype.bytes());
        let whole = |b: &[u8]| b.iter().rev().fold(0_u64, |n, &byte| n << 8 | u64::from(byte));
        let numbers = match array.dtype {
            WordType::F4 => Numbers::F4(words.map(|b| whole(b) as u32).collect()),
            WordType::F8 => Numbers::F8(words.map(|b| f64::from_bits(whole(b))).collect()),
            WordType::I4 => Numbers::Whole(words.map(|b| i64::from((whole(b) as u32).cast_signed())).collect()),
            WordType::U4 | WordType::U2 => Numbers::Whole(words.map(|b| whole(b).cast_signed()).collect()),
        };
        Column { name: array.name.clone(), width: array.words(), numbers }
    };
    Table { columns: dataset.document.arrays.iter().zip(&dataset.arrays).map(column).collect() }
}
