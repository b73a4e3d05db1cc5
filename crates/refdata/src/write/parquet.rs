//! Apache Parquet: a column for each word, a row group for each block, the document in the metadata of the
//! file under the name of the schema. Uniforms are repeated for every sample of a case.

use std::io;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{DoubleType, FloatType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::{Sink, Store};
use crate::array::{Array, Per, WordType};
use crate::document::{Document, SCHEMA};
use crate::generate::Block;

pub(super) struct Parquet<'s> {
    /// None once the file is ended.
    to: Option<SerializedFileWriter<Box<dyn Store + 's>>>,
    arrays: Vec<Array>,
}

fn column_type(name: &str, physical: Physical, logical: Option<LogicalType>) -> Result<Arc<Type>, ParquetError> {
    let builder = Type::primitive_type_builder(name, physical).with_repetition(Repetition::REQUIRED);
    Ok(Arc::new(builder.with_logical_type(logical).build()?))
}

fn schema(document: &Document) -> Result<Arc<Type>, ParquetError> {
    let unsigned = |bit_width| Some(LogicalType::integer(bit_width, false));
    let mut columns = vec![column_type("index", Physical::INT64, None)?];
    for array in &document.arrays {
        let (physical, logical) = match array.dtype {
            WordType::F4 => (Physical::FLOAT, None),
            WordType::F8 => (Physical::DOUBLE, None),
            WordType::I4 => (Physical::INT32, None),
            WordType::U4 => (Physical::INT32, unsigned(32)),
            WordType::U2 => (Physical::INT32, unsigned(16)),
        };
        for word in 0..array.words() {
            columns.push(column_type(&array.column(word), physical, logical.clone())?);
        }
    }
    Ok(Arc::new(Type::group_type_builder("samples").with_fields(columns).build()?))
}

/// Errors of the file system as they were, not as texts.
fn io_error(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    }
}

impl<'s> Parquet<'s> {
    pub fn new(document: &Document, store: Box<dyn Store + 's>) -> io::Result<Self> {
        let properties = WriterProperties::builder()
            .set_created_by(format!("shadercheck {}", env!("CARGO_PKG_VERSION")))
            .set_max_row_group_row_count(None)
            .build();
        let to = SerializedFileWriter::new(store, schema(document).map_err(io_error)?, Arc::new(properties));
        Ok(Self { to: Some(to.map_err(io_error)?), arrays: document.arrays.clone() })
    }

    fn ended() -> io::Error {
        io::Error::other("the file is ended already")
    }
}

/// One word of every row.
fn words<'b, const N: usize>(
    array: &Array,
    bytes: &'b [u8],
    word: usize,
    (rows, per_case): (usize, usize),
) -> impl Iterator<Item = [u8; N]> + use<'b, N> {
    let (stride, per) = (array.stride(), if array.per == Per::Case { per_case } else { 1 });
    (0..rows).map(move |row| {
        let at = row / per * stride + word * N;
        let mut out = [0; N];
        out.copy_from_slice(&bytes[at..at + N]);
        out
    })
}

fn write_column(
    column: &mut SerializedColumnWriter<'_>,
    array: &Array,
    bytes: &[u8],
    word: usize,
    size: (usize, usize),
) -> Result<(), ParquetError> {
    match array.dtype {
        WordType::F4 => {
            let values: Vec<f32> = words(array, bytes, word, size).map(f32::from_le_bytes).collect();
            column.typed::<FloatType>().write_batch(&values, None, None)?;
        }
        WordType::F8 => {
            let values: Vec<f64> = words(array, bytes, word, size).map(f64::from_le_bytes).collect();
            column.typed::<DoubleType>().write_batch(&values, None, None)?;
        }
        WordType::I4 | WordType::U4 => {
            let values: Vec<i32> = words(array, bytes, word, size).map(i32::from_le_bytes).collect();
            column.typed::<Int32Type>().write_batch(&values, None, None)?;
        }
        WordType::U2 => {
            let values: Vec<i32> = words(array, bytes, word, size).map(|b| u16::from_le_bytes(b).into()).collect();
            column.typed::<Int32Type>().write_batch(&values, None, None)?;
        }
    }
    Ok(())
}

impl Sink for Parquet<'_> {
    fn block(&mut self, block: &Block) -> io::Result<()> {
        let to = self.to.as_mut().ok_or_else(Self::ended)?;
        let arrays = &self.arrays;
        let mut write = || -> Result<(), ParquetError> {
            let mut group = to.next_row_group()?;
            if let Some(mut column) = group.next_column()? {
                let values: Vec<i64> = (0..block.rows as i64).map(|row| block.first.cast_signed() + row).collect();
                column.typed::<Int64Type>().write_batch(&values, None, None)?;
                column.close()?;
            }
            for (array, bytes) in arrays.iter().zip(&block.arrays) {
                for word in 0..array.words() {
                    let Some(mut column) = group.next_column()? else { break };
                    write_column(&mut column, array, bytes, word, (block.rows, block.per_case))?;
                    column.close()?;
                }
            }
            group.close()?;
            Ok(())
        };
        write().map_err(io_error)
    }

    fn finish(&mut self, document: &Document) -> io::Result<()> {
        let mut to = self.to.take().ok_or_else(Self::ended)?;
        to.append_key_value_metadata(KeyValue::new(SCHEMA.to_owned(), document.line()));
        // Not `into_inner`, which tells errors of the file system as texts.
        to.finish().map_err(io_error)?;
        io::Write::flush(to.inner_mut())
    }
}
