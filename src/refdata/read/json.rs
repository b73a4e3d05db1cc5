//! JSON: reference files, and outputs as an object of lists, one entry for each sample.

use std::io::{BufReader, SeekFrom};

use serde_json::Value;

use super::{Column, Dataset, Load, Numbers, ReadError, Table};
use crate::refdata::array::Kind;
use crate::refdata::document::Document;

fn value(from: &mut dyn Load) -> Result<Value, ReadError> {
    from.seek(SeekFrom::Start(0))?;
    serde_json::from_reader(BufReader::new(from))
        .map_err(|error| ReadError::Damaged(format!("it is no JSON, cut off or damaged: {error}")))
}

pub(super) fn dataset(from: &mut dyn Load) -> Result<Dataset, ReadError> {
    of_value(&value(from)?)
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
        for (array, out) in document.arrays.iter().zip(&mut arrays) {
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
    }
    Ok(Dataset { document, arrays })
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
