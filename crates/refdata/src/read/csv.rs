//! Tables with names in the first line. Lines that begin with `#` are comments; a reference file has its
//! document in one.

use std::io::{self, BufRead, BufReader, Read, SeekFrom};

use csv::ReaderBuilder;

use super::shared::Shared;
use super::windows::Windows;
use super::{Column, Load, MOST_TEXT, Numbers, ReadError, Table, Wanted, blocks};
use crate::array::WordType;
use crate::document::Document;
use crate::flags::{Flag, Flags};

/// The comment in the first line.
fn comment(from: &mut dyn Load) -> Result<Option<String>, ReadError> {
    from.seek(SeekFrom::Start(0))?;
    let mut first = String::new();
    let mut begin = BufReader::new(Read::take(&mut *from, MOST_TEXT));
    begin.read_line(&mut first).map_err(|e| ReadError::Damaged(format!("it is no text: {e}")))?;
    if first.len() as u64 == MOST_TEXT {
        return Err(ReadError::Damaged(format!("its first line has more than {MOST_TEXT} bytes")));
    }
    Ok(first.strip_prefix('#').map(|text| text.trim().to_owned()))
}

/// Lines, some at a time.
pub(super) struct Lines {
    lines: csv::StringRecordsIntoIter<BufReader<Short>>,
    /// Names of columns, and what they hold.
    columns: Vec<(String, Holds)>,
    row: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Holds {
    Binary32,
    Binary64,
    /// What nobody asks for.
    Unread,
}

/// Text whose lines are short enough to be held in memory.
struct Short {
    from: Shared,
    /// Bytes since the last end of a line.
    line: u64,
}

impl Read for Short {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let read = self.from.read(buf)?;
        match buf[..read].iter().rposition(|&byte| byte == b'\n') {
            Some(end) => self.line = (read - end) as u64,
            None => self.line += read as u64,
        }
        if self.line > MOST_TEXT {
            return Err(io::Error::new(io::ErrorKind::InvalidData, format!("a line of more than {MOST_TEXT} bytes")));
        }
        Ok(read)
    }
}

impl Lines {
    pub fn open(from: &Shared, wanted: &Wanted) -> Result<Self, ReadError> {
        let comment = comment(&mut from.at(0))?;
        // What binary32 columns hold is told by the document; without one, numbers are read as binary32.
        let document = comment.as_deref().and_then(|text| Document::read(text).ok());
        let double = |name: &str| {
            document.as_ref().is_some_and(|d| {
                let owner = d.arrays.iter().find(|a| (0..a.words()).any(|word| a.column(word) == name));
                owner.is_some_and(|array| array.dtype == WordType::F8)
            })
        };
        let mut builder = ReaderBuilder::new();
        let reader = builder.comment(Some(b'#')).trim(csv::Trim::All);
        let lines = Short { from: from.at(0), line: 0 };
        let mut reader = reader.from_reader(BufReader::with_capacity(1 << 20, lines));
        let headers = reader.headers().map_err(read_error)?.clone();
        let names: Vec<&str> = headers.iter().collect();
        let read = wanted.select(names.iter().map(|name| (*name, 1))).map_err(ReadError::Damaged)?;
        let holds = |(name, read): (&str, bool)| match (read, double(name)) {
            (false, _) => Holds::Unread,
            (true, true) => Holds::Binary64,
            (true, false) => Holds::Binary32,
        };
        let columns = names.iter().zip(read).map(|(&name, read)| (name.to_owned(), holds((name, read)))).collect();
        Ok(Self { lines: reader.into_records(), columns, row: 0 })
    }
}

impl Windows for Lines {
    fn next(&mut self, rows: usize) -> Result<Table, ReadError> {
        let mut texts: Vec<Vec<String>> = vec![Vec::new(); self.columns.len()];
        let mut read = 0;
        while read < rows {
            let Some(record) = self.lines.next() else { break };
            let record = record.map_err(read_error)?;
            let columns = texts.iter_mut().zip(&self.columns).zip(record.iter());
            for ((column, _), text) in columns.filter(|((_, (_, holds)), _)| *holds != Holds::Unread) {
                column.push(text.to_owned());
            }
            read += 1;
        }
        let mut table = Table::default();
        for ((name, holds), texts) in self.columns.iter().zip(texts) {
            let numbers = numbers(name, &texts, *holds == Holds::Binary64, self.row)?;
            table.columns.push(Column { name: name.clone(), width: 1, numbers });
        }
        self.row += read;
        Ok(table)
    }
}

fn numbers(name: &str, texts: &[String], double: bool, first: usize) -> Result<Numbers, ReadError> {
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
    let wrong = |row: usize| {
        ReadError::Damaged(format!("`{}` in column `{name}`, row {} is no number", texts[row], first + row + 1))
    };
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

fn read_error(error: csv::Error) -> ReadError {
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

pub(super) fn opened(from: &Shared) -> Result<(Document, blocks::Numbers), ReadError> {
    // Of a file that is no reference the names of columns are of no interest.
    let Some(first) = comment(&mut from.at(0))? else {
        return Err(ReadError::Schema("it does not begin with `# ` and the provenance of a reference file".into()));
    };
    let document = Document::read(&first).map_err(ReadError::Schema)?;
    let lines = Lines::open(from, &Wanted::reference(&document))?;
    Ok((document, blocks::Numbers::Columns(Box::new(lines))))
}
