//! Columns of Apache Parquet, some rows at a time.

use std::io::{BufReader, Read};

use bytes::Bytes;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};

use super::blocks::Numbers as Where;
use super::shared::Shared;
use super::windows::Windows;
use super::{Column, Numbers, ReadError, Table, Wanted};
use crate::document::{Document, SCHEMA};

impl Length for Shared {
    fn len(&self) -> u64 {
        self.length()
    }
}

impl ChunkReader for Shared {
    type T = BufReader<Self>;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        Ok(BufReader::new(self.at(start)))
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        let mut bytes = Vec::new();
        self.at(start).take(length as u64).read_to_end(&mut bytes)?;
        if bytes.len() != length {
            return Err(ParquetError::EOF(format!("{} of {length} bytes", bytes.len())));
        }
        Ok(bytes.into())
    }
}

fn damaged(error: ParquetError) -> ReadError {
    ReadError::Damaged(format!("it is no Parquet file, cut off or damaged: {error}"))
}

/// The next values of a column.
fn values<T: DataType>(reader: &mut ColumnReaderImpl<T>, rows: usize) -> Result<Vec<T::T>, ParquetError> {
    let mut list = Vec::new();
    while list.len() < rows {
        let (_, read, _) = reader.read_records(rows - list.len(), None, None, &mut list)?;
        if read == 0 {
            return Err(ParquetError::EOF(format!("{} of {rows} values", list.len())));
        }
    }
    Ok(list)
}

/// Rows of all groups, read as they are asked for: a group of a few bytes may have any number of rows.
pub(super) struct Groups {
    reader: SerializedFileReader<Shared>,
    next: usize,
    /// Readers of the columns of the current group, and its rows that are left.
    current: Vec<Option<ColumnReader>>,
    left: usize,
    /// Names of the columns, and whether they are read.
    columns: Vec<(String, bool)>,
}

impl Groups {
    /// Opens a file of which the columns are read that `choose` says, given their names and widths.
    fn open(from: &Shared, choose: impl FnOnce(&[String]) -> Result<Vec<bool>, String>) -> Result<Self, ReadError> {
        let reader = SerializedFileReader::new(from.at(0)).map_err(damaged)?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        // The name alone where it has no parents: dots in it are its own.
        let names: Vec<String> = schema.columns().iter().map(|column| column.name().to_owned()).collect();
        let chosen = choose(&names).map_err(ReadError::Damaged)?;
        for (at, column) in schema.columns().iter().enumerate().filter(|(at, _)| chosen[*at]) {
            let name = &names[at];
            if column.max_def_level() > 0 && column.max_rep_level() > 0 {
                return Err(ReadError::Damaged(format!(
                    "the column `{name}` has lists; one column for each word is read"
                )));
            }
            if column.max_def_level() > 0 {
                let nulls = (0..reader.num_row_groups()).any(|group| {
                    let chunk = reader.metadata().row_group(group).column(at);
                    chunk.statistics().and_then(|s| s.null_count_opt()).is_none_or(|nulls| nulls > 0)
                });
                if nulls {
                    return Err(ReadError::Damaged(format!("the column `{name}` has rows without a value")));
                }
            }
        }
        let columns = names.into_iter().zip(chosen).collect();
        Ok(Self { reader, next: 0, current: Vec::new(), left: 0, columns })
    }

    /// Opens outputs.
    pub fn outputs(from: &Shared, wanted: &Wanted) -> Result<Self, ReadError> {
        Self::open(from, |names| wanted.select(names.iter().map(|name| (&**name, 1))))
    }

    /// The document of a reference file.
    fn document(&self) -> Option<String> {
        let pairs = self.reader.metadata().file_metadata().key_value_metadata();
        pairs.and_then(|list| list.iter().find(|pair| pair.key == SCHEMA)?.value.clone())
    }

    /// Goes on to the next group.
    fn begin(&mut self) -> Result<(), ReadError> {
        let wrong = |rows: i64| ReadError::Damaged(format!("a group of it has {rows} rows: it is damaged"));
        let rows = self.reader.metadata().row_group(self.next).num_rows();
        self.left = usize::try_from(rows).map_err(|_| wrong(rows))?;
        let group = self.reader.get_row_group(self.next).map_err(damaged)?;
        let open = |(at, (_, read)): (usize, &(String, bool))| {
            read.then(|| group.get_column_reader(at).map_err(damaged)).transpose()
        };
        self.current = self.columns.iter().enumerate().map(open).collect::<Result<_, _>>()?;
        self.next += 1;
        Ok(())
    }

    /// The next rows of the current group.
    fn take(&mut self, rows: usize) -> Result<Table, ReadError> {
        let mut table = Table::default();
        self.left -= rows;
        for (at, (name, _)) in self.columns.iter().enumerate() {
            let numbers = match self.current.get_mut(at).and_then(Option::as_mut) {
                Some(reader) => numbers(reader, rows).map_err(damaged)?,
                None => Some(Numbers::F4(Vec::new())),
            };
            // Columns of texts and the like are none of ours.
            table.columns.extend(numbers.map(|numbers| Column { name: name.clone(), width: 1, numbers }));
        }
        Ok(table)
    }
}

/// The next numbers of a column; none of one that has no numbers.
fn numbers(reader: &mut ColumnReader, rows: usize) -> Result<Option<Numbers>, ParquetError> {
    Ok(Some(match reader {
        ColumnReader::FloatColumnReader(r) => Numbers::F4(values(r, rows)?.into_iter().map(f32::to_bits).collect()),
        ColumnReader::DoubleColumnReader(r) => Numbers::F8(values(r, rows)?),
        ColumnReader::Int32ColumnReader(r) => Numbers::Whole(values(r, rows)?.into_iter().map(i64::from).collect()),
        ColumnReader::Int64ColumnReader(r) => Numbers::Whole(values(r, rows)?),
        ColumnReader::BoolColumnReader(_)
        | ColumnReader::Int96ColumnReader(_)
        | ColumnReader::ByteArrayColumnReader(_)
        | ColumnReader::FixedLenByteArrayColumnReader(_) => return Ok(None),
    }))
}

impl Windows for Groups {
    fn next(&mut self, rows: usize) -> Result<Table, ReadError> {
        let mut out: Option<Table> = None;
        let mut open = rows;
        loop {
            if self.left == 0 && self.next < self.reader.num_row_groups() && open > 0 {
                self.begin()?;
                continue;
            }
            let taken = self.left.min(open);
            let part = self.take(taken)?;
            open -= taken;
            match &mut out {
                None => out = Some(part),
                Some(out) => out.append(part),
            }
            if open == 0 || taken == 0 {
                // A file without a row has columns all the same.
                return Ok(out.unwrap_or_default());
            }
        }
    }
}

pub(super) fn opened(from: &Shared) -> Result<(Document, Where), ReadError> {
    let groups = Groups::open(from, |names| Ok(vec![false; names.len()]))?;
    let Some(document) = groups.document() else {
        return Err(ReadError::Schema(format!("its metadata have no `{SCHEMA}`, which a reference file has")));
    };
    let document = Document::read(&document).map_err(ReadError::Schema)?;
    let groups = Groups::outputs(from, &Wanted::reference(&document))?;
    Ok((document, Where::Columns(Box::new(groups))))
}
