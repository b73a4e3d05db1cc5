//! Tables with names in the first line. Lines that begin with `#` are comments; a reference file has its
//! document in one.

use std::io::{BufRead, BufReader, SeekFrom};

use csv::ReaderBuilder;

use super::{Column, Dataset, Load, Numbers, ReadError, Table};
use crate::refdata::array::{Kind, Role};
use crate::refdata::document::Document;
use crate::refdata::flags::{Flag, Flags};

/// The table and the comment before it.
pub(super) fn table(from: &mut dyn Load) -> Result<(Table, Option<String>), ReadError> {
    from.seek(SeekFrom::Start(0))?;
    let mut first = String::new();
    BufReader::new(&mut *from).read_line(&mut first).map_err(|e| ReadError::Damaged(format!("it is no text: {e}")))?;
    let comment = first.strip_prefix('#').map(|text| text.trim().to_owned());
    // What binary32 columns hold is told by the document; without one, numbers are read as binary32.
    let document = comment.as_deref().and_then(|text| Document::read(text).ok());
    let double = |name: &str| {
        document.as_ref().is_some_and(|d| {
            let owner = d.arrays.iter().find(|a| (0..a.words()).any(|word| a.column(word) == name));
            owner.is_some_and(|array| array.dtype == Kind::F8)
        })
    };
    from.seek(SeekFrom::Start(0))?;
    let mut reader = ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(BufReader::new(from));
    let headers = reader.headers().map_err(told)?.clone();
    let mut columns: Vec<(String, Vec<String>, bool)> =
        headers.iter().map(|name| (name.to_owned(), Vec::new(), double(name))).collect();
    for record in reader.records() {
        let record = record.map_err(told)?;
        for (column, text) in columns.iter_mut().zip(record.iter()) {
            column.1.push(text.to_owned());
        }
    }
    let mut table = Table::default();
    for (name, texts, double) in columns {
        let numbers = numbers(&name, &texts, double)?;
        table.columns.push(Column { name, width: 1, numbers });
    }
    Ok((table, comment))
}

fn numbers(name: &str, texts: &[String], double: bool) -> Result<Numbers, ReadError> {
    if name == "flags" {
        let bits = |text: &String| {
            let bit = |name: &str| Flag::ALL.into_iter().find(|flag| flag.name() == name);
            let mut flags = Flags::default();
            for name in text.split('|').filter(|name| !name.is_empty()) {
                flags.set(bit(name).ok_or_else(|| ReadError::Damaged(format!("there is no flag `{name}`")))?);
            }
            Ok(i64::from(flags.0))
        };
        return texts.iter().map(bits).collect::<Result<_, ReadError>>().map(Numbers::Whole);
    }
    let wrong =
        |row: usize| ReadError::Damaged(format!("`{}` in column `{name}`, row {} is no number", texts[row], row + 1));
    if let Ok(list) = texts.iter().map(|text| text.parse::<i64>()).collect::<Result<Vec<_>, _>>() {
        return Ok(Numbers::Whole(list));
    }
    let parse = |row: usize| texts[row].parse::<f64>().map_err(|_| wrong(row));
    if double {
        return (0..texts.len()).map(parse).collect::<Result<_, _>>().map(Numbers::F8);
    }
    let parse = |row: usize| texts[row].parse::<f32>().map(f32::to_bits).map_err(|_| wrong(row));
    (0..texts.len()).map(parse).collect::<Result<_, _>>().map(Numbers::F4)
}

fn told(error: csv::Error) -> ReadError {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            ReadError::Damaged(format!(
                "line {line} has {len} values, and the first line names {expected_len}: it is cut off or damaged"
            ))
        }
        _ => ReadError::Damaged(error.to_string()),
    }
}

pub(super) fn dataset(from: &mut dyn Load) -> Result<Dataset, ReadError> {
    let (table, comment) = table(from)?;
    let Some(comment) = comment else {
        return Err(ReadError::Schema("it does not begin with `# ` and the provenance of a reference file".into()));
    };
    let document = Document::read(&comment).map_err(ReadError::Schema)?;
    debug_assert!(document.arrays.iter().any(|array| array.role == Role::Flags), "flags are always written");
    Dataset::of_table(document, &table)
}
