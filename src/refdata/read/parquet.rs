//! Columns of Apache Parquet.

use std::io::SeekFrom;

use bytes::Bytes;
use parquet::column::reader::ColumnReader;
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::{Column, Dataset, Load, Numbers, ReadError, Table};
use crate::refdata::document::{Document, SCHEMA};

fn damaged(error: ParquetError) -> ReadError {
    ReadError::Damaged(format!("it is no Parquet file, cut off or damaged: {error}"))
}

fn values<T: DataType>(
    mut reader: parquet::column::reader::ColumnReaderImpl<T>,
    rows: usize,
) -> Result<Vec<T::T>, ParquetError> {
    let mut list = Vec::with_capacity(rows);
    while list.len() < rows {
        let (_, read, _) = reader.read_records(rows - list.len(), None, None, &mut list)?;
        if read == 0 {
            return Err(ParquetError::EOF(format!("{} of {rows} values", list.len())));
        }
    }
    Ok(list)
}

/// The columns, and the document of a reference file.
pub(super) fn table(from: &mut dyn Load) -> Result<(Table, Option<String>), ReadError> {
    let mut bytes = Vec::new();
    from.seek(SeekFrom::Start(0))?;
    from.read_to_end(&mut bytes)?;
    let reader = SerializedFileReader::new(Bytes::from(bytes)).map_err(damaged)?;
    let metadata = reader.metadata().file_metadata();
    let pairs = metadata.key_value_metadata();
    let document = pairs.and_then(|list| list.iter().find(|pair| pair.key == SCHEMA)?.value.clone());
    let schema = metadata.schema_descr_ptr();
    let mut table = Table::default();
    for (at, column) in schema.columns().iter().enumerate() {
        // The name alone where it has no parents: dots in it are its own.
        let name = column.name().to_owned();
        if column.max_def_level() > 0 && column.max_rep_level() > 0 {
            return Err(ReadError::Damaged(format!("the column `{name}` has lists; one column for each word is read")));
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
        let mut numbers: Option<Numbers> = None;
        for group in 0..reader.num_row_groups() {
            let rows = reader.metadata().row_group(group).num_rows() as usize;
            let group = reader.get_row_group(group).map_err(damaged)?;
            let next = match group.get_column_reader(at).map_err(damaged)? {
                ColumnReader::FloatColumnReader(r) => {
                    Numbers::F4(values(r, rows).map_err(damaged)?.into_iter().map(f32::to_bits).collect())
                }
                ColumnReader::DoubleColumnReader(r) => Numbers::F8(values(r, rows).map_err(damaged)?),
                ColumnReader::Int32ColumnReader(r) => {
                    Numbers::Whole(values(r, rows).map_err(damaged)?.into_iter().map(i64::from).collect())
                }
                ColumnReader::Int64ColumnReader(r) => Numbers::Whole(values(r, rows).map_err(damaged)?),
                ColumnReader::BoolColumnReader(_)
                | ColumnReader::Int96ColumnReader(_)
                | ColumnReader::ByteArrayColumnReader(_)
                | ColumnReader::FixedLenByteArrayColumnReader(_) => break,
            };
            numbers = Some(match (numbers, next) {
                (None, next) => next,
                (Some(Numbers::F4(a)), Numbers::F4(b)) => Numbers::F4([a, b].concat()),
                (Some(Numbers::F8(a)), Numbers::F8(b)) => Numbers::F8([a, b].concat()),
                (Some(Numbers::Whole(a)), Numbers::Whole(b)) => Numbers::Whole([a, b].concat()),
                (Some(_), _) => return Err(ReadError::Damaged(format!("the column `{name}` changes its type"))),
            });
        }
        // Columns of texts and the like are none of ours.
        if let Some(numbers) = numbers {
            table.columns.push(Column { name, width: 1, numbers });
        }
    }
    Ok((table, document))
}

pub(super) fn dataset(from: &mut dyn Load) -> Result<Dataset, ReadError> {
    let (table, document) = table(from)?;
    let Some(document) = document else {
        return Err(ReadError::Schema(format!("its metadata have no `{SCHEMA}`, which a reference file has")));
    };
    Dataset::of_table(Document::read(&document).map_err(ReadError::Schema)?, &table)
}
