//! JSON: reference files, and outputs as an object of lists, one entry for each sample.

use std::io::{BufReader, Read, SeekFrom};

use serde::de::DeserializeOwned;
use serde_json::Value;

use super::blocks::Numbers as Where;
use super::shared::Shared;
use super::{Column, Dataset, Load, Numbers, ReadError, Table};
use crate::refdata::array::Kind;
use crate::refdata::document::Document;

fn damaged(error: impl std::fmt::Display) -> ReadError {
    ReadError::Damaged(format!("it is no JSON, cut off or damaged: {error}"))
}

fn value(from: &mut dyn Load) -> Result<Value, ReadError> {
    from.seek(SeekFrom::Start(0))?;
    serde_json::from_reader(BufReader::new(from)).map_err(damaged)
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
    fn value<T: DeserializeOwned>(&mut self) -> Result<T, ReadError> {
        let first = [self.byte()?];
        let from = first.as_slice().chain(&mut self.from);
        T::deserialize(&mut serde_json::Deserializer::from_reader(from)).map_err(damaged)
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
        let block: Value = self.value()?;
        let mut arrays = vec![Vec::new(); document.arrays.len()];
        block_of(&block, self.read, document, &mut arrays)?;
        self.read += 1;
        Ok(Some(arrays))
    }
}

/// A reference file whose provenance stands before its blocks is read block by block, and others as a whole.
pub(super) fn opened(from: &Shared) -> Result<(Document, Where), ReadError> {
    let mut values = Values { from: BufReader::with_capacity(1 << 16, from.at(0)), ahead: None, read: 0, ended: false };
    if values.byte()? != b'{' {
        let whole = of_value(&value(&mut from.at(0))?)?;
        return Ok((whole.document, Where::Whole(whole.arrays)));
    }
    let first: String = values.value()?;
    values.expect(b':')?;
    if first == "provenance" {
        let provenance: Value = values.value()?;
        let document = Document::read(&provenance.to_string()).map_err(ReadError::Schema)?;
        values.expect(b',')?;
        if values.value::<String>()? == "blocks" {
            values.expect(b':')?;
            values.expect(b'[')?;
            return Ok((document, Where::Values(values)));
        }
    }
    let Dataset { document, arrays } = of_value(&value(&mut from.at(0))?)?;
    Ok((document, Where::Whole(arrays)))
}

fn of_value(value: &Value) -> Result<Dataset, ReadError> {
    let Some(provenance) = value.get("provenance") else {
        return Err(ReadError::Schema("it has no `provenance`, which a reference file has".into()));
    };
    let document = Document::read(&provenance.to_string()).map_err(ReadError::Schema)?;
    let blocks = value.get("blocks").and_then(Value::as_array);
    let blocks = blocks.ok_or_else(|| ReadError::Damaged("it has no `blocks`".into()))?;
    let mut arrays = vec![Vec::new(); document.arrays.len()];
    for (number, block) in blocks.iter().enumerate() {
        block_of(block, number, &document, &mut arrays)?;
    }
    Ok(Dataset { document, arrays })
}

/// Adds the bits of a block to the arrays.
fn block_of(block: &Value, number: usize, document: &Document, arrays: &mut [Vec<u8>]) -> Result<(), ReadError> {
    for (array, out) in document.arrays.iter().zip(arrays) {
        let wrong = |why: &str| ReadError::Damaged(format!("`{}` of block {number}: {why}", array.name));
        let bits = block.pointer("/arrays").and_then(|a| a.get(&array.name)).and_then(|a| a.get("bits"));
        let rows = bits.and_then(Value::as_array).ok_or_else(|| wrong("there is none"))?;
        for row in rows {
            let one = std::slice::from_ref(row);
            let words = row.as_array().map_or(one, Vec::as_slice);
            if words.len() != array.words() {
                return Err(wrong("a row has another number of words"));
            }
            for word in words {
                let bits = word.as_str().filter(|text| text.len() == 2 * array.dtype.bytes());
                let bits = bits.and_then(|text| u64::from_str_radix(text, 16).ok());
                let bits = bits.ok_or_else(|| wrong("these are no bits"))?;
                out.extend_from_slice(&bits.to_le_bytes()[..array.dtype.bytes()]);
            }
        }
    }
    Ok(())
}

/// Outputs: an object whose members are lists of numbers or of lists of numbers, one entry for each sample;
/// or a reference file.
pub(super) fn table(from: &mut dyn Load) -> Result<Table, ReadError> {
    let value = value(from)?;
    if value.get("provenance").is_some() {
        return Ok(of_dataset(&of_value(&value)?));
    }
    let mut table = Table::default();
    match &value {
        Value::Object(members) => {
            for (name, list) in members {
                if let Some(list) = list.as_array() {
                    table.columns.push(column(name, list)?);
                }
            }
        }
        Value::Array(list) => table.columns.push(column("", list)?),
        _ => {}
    }
    if table.columns.is_empty() {
        return Err(ReadError::Damaged(
            "outputs in JSON are an object of lists, such as {\"gl_Position\": [[0.0, 1.0, 0.0, 1.0]]}".into(),
        ));
    }
    Ok(table)
}

fn column(name: &str, list: &[Value]) -> Result<Column, ReadError> {
    let mut numbers = Vec::new();
    let mut width = None;
    for (row, entry) in list.iter().enumerate() {
        let before = numbers.len();
        flatten(entry, &mut numbers)
            .map_err(|text| ReadError::Damaged(format!("`{name}`, entry {row}: `{text}` is no number")))?;
        let words = numbers.len() - before;
        if *width.get_or_insert(words) != words {
            return Err(ReadError::Damaged(format!("`{name}`, entry {row} has another number of words")));
        }
    }
    Ok(Column { name: name.to_owned(), width: width.unwrap_or(1), numbers: Numbers::F8(numbers) })
}

fn flatten(value: &Value, out: &mut Vec<f64>) -> Result<(), String> {
    match value {
        Value::Array(list) => list.iter().try_for_each(|value| flatten(value, out)),
        Value::Number(number) => {
            out.push(number.as_f64().unwrap_or(f64::NAN));
            Ok(())
        }
        // JSON has no literal for these.
        Value::Null => {
            out.push(f64::NAN);
            Ok(())
        }
        Value::String(text) => {
            out.push(text.parse().map_err(|_| text.clone())?);
            Ok(())
        }
        Value::Bool(_) | Value::Object(_) => Err(value.to_string()),
    }
}

fn of_dataset(dataset: &Dataset) -> Table {
    let column = |(array, bytes): (&crate::refdata::Array, &Vec<u8>)| {
        let words = bytes.chunks_exact(array.dtype.bytes());
        let whole = |b: &[u8]| b.iter().rev().fold(0_u64, |n, &byte| n << 8 | u64::from(byte));
        let numbers = match array.dtype {
            Kind::F4 => Numbers::F4(words.map(|b| whole(b) as u32).collect()),
            Kind::F8 => Numbers::F8(words.map(|b| f64::from_bits(whole(b))).collect()),
            Kind::I4 => Numbers::Whole(words.map(|b| i64::from((whole(b) as u32).cast_signed())).collect()),
            Kind::U4 | Kind::U2 => Numbers::Whole(words.map(|b| whole(b).cast_signed()).collect()),
        };
        Column { name: array.name.clone(), width: array.words(), numbers }
    };
    Table { columns: dataset.document.arrays.iter().zip(&dataset.arrays).map(column).collect() }
}
