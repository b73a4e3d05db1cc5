//! Columns of Apache Parquet, one group of rows at a time.

use std::io::{BufReader, Read};

use bytes::Bytes;
use parquet::column::reader::ColumnReader;
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};

use super::blocks::Numbers as Where;
use super::shared::Shared;
use super::windows::Windows;
use super::{Column, Numbers, ReadError, Table};
use crate::refdata::document::{Document, SCHEMA};

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

fn values<T: DataType>(
    mut reader: parquet::column::reader::ColumnReaderImpl<T>,
    rows: usize,
) -> Result<Vec<T::T>, ParquetError> {
    let mut list = Vec::new();
    while list.len() < rows {
        let (_, read, _) = reader.read_records(rows - list.len(), None, None, &mut list)?;
        if read == 0 {
            return Err(ParquetError::EOF(format!("{} of {rows} values", list.len())));
        }
    }
    Ok(list)
}

/// Groups of rows, of which one is in memory.
pub(super) struct Groups {
    reader: SerializedFileReader<Shared>,
    next: usize,
    /// The group that was read last, and the row of it that comes next.
    current: Table,
    at: usize,
    /// Names and numbers of the columns that are read.
    columns: Vec<(String, usize)>,
}

impl Groups {
    pub fn open(from: &Shared) -> Result<Self, ReadError> {
        let reader = SerializedFileReader::new(from.at(0)).map_err(damaged)?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let mut columns = Vec::new();
        for (at, column) in schema.columns().iter().enumerate() {
            // The name alone where it has no parents: dots in it are its own.
            let name = column.name().to_owned();
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
            columns.push((name, at));
        }
        Ok(Self { reader, next: 0, current: Table::default(), at: 0, columns })
    }

    /// The document of a reference file.
    fn document(&self) -> Option<String> {
        let pairs = self.reader.metadata().file_metadata().key_value_metadata();
        pairs.and_then(|list| list.iter().find(|pair| pair.key == SCHEMA)?.value.clone())
    }

    fn group(&self, number: usize) -> Result<Table, ReadError> {
        let rows = self.reader.metadata().row_group(number).num_rows() as usize;
        let group = self.reader.get_row_group(number).map_err(damaged)?;
        let mut table = Table::default();
        for (name, at) in &self.columns {
            let numbers = match group.get_column_reader(*at).map_err(damaged)? {
                ColumnReader::FloatColumnReader(r) => {
                    Numbers::F4(values(r, rows).map_err(damaged)?.into_iter().map(f32::to_bits).collect())
                }
                ColumnReader::DoubleColumnReader(r) => Numbers::F8(values(r, rows).map_err(damaged)?),
                ColumnReader::Int32ColumnReader(r) => {
                    Numbers::Whole(values(r, rows).map_err(damaged)?.into_iter().map(i64::from).collect())
                }
                ColumnReader::Int64ColumnReader(r) => Numbers::Whole(values(r, rows).map_err(damaged)?),
                // Columns of texts and the like are none of ours.
                ColumnReader::BoolColumnReader(_)
                | ColumnReader::Int96ColumnReader(_)
                | ColumnReader::ByteArrayColumnReader(_)
                | ColumnReader::FixedLenByteArrayColumnReader(_) => continue,
            };
            table.columns.push(Column { name: name.clone(), width: 1, numbers });
        }
        Ok(table)
    }
}

impl Windows for Groups {
    fn next(&mut self, rows: usize) -> Result<Table, ReadError> {
        let mut out: Option<Table> = None;
        let mut open = rows;
        loop {
            let left = self.current.rows().saturating_sub(self.at);
            if left == 0 && self.next < self.reader.num_row_groups() && open > 0 {
                self.current = self.group(self.next)?;
                (self.next, self.at) = (self.next + 1, 0);
                continue;
            }
            let taken = left.min(open);
            let part = self.current.window(self.at..self.at + taken);
            (self.at, open) = (self.at + taken, open - taken);
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
    let groups = Groups::open(from)?;
    let Some(document) = groups.document() else {
        return Err(ReadError::Schema(format!("its metadata have no `{SCHEMA}`, which a reference file has")));
    };
    Ok((Document::read(&document).map_err(ReadError::Schema)?, Where::Columns(Box::new(groups))))
}
