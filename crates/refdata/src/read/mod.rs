//! Readers: a reference file whole, and anyone's outputs as named columns of numbers.

mod blocks;
mod csv;
mod json;
mod npy;
mod npz;
mod parquet;
mod raw;
mod shared;
mod table;
mod wanted;
mod windows;

use std::io::{Read, Seek};

use thiserror::Error;

use super::array::{Array, Per};
use super::bytes::Bytes;
use super::document::Document;

pub use blocks::{Blocks, Chain, Open, Sequence};
pub use raw::ByteOrder;
pub use shared::Shared;
pub use table::{Column, Numbers, Table};
pub use wanted::Wanted;
pub(super) use wanted::{PREFIXES, is_plain};
pub use windows::{Windows, windows};

/// Bytes of a provenance, and of the first line of a table, at most.
const MOST_TEXT: u64 = 1 << 24;

/// What files are read from.
pub trait Load: Read + Seek + Send + Sync {}

impl<T: Read + Seek + Send + Sync> Load for T {}

/// Why a file cannot be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The file system.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// Not what its ending says, cut off, or otherwise damaged.
    #[error("{0}")]
    Damaged(String),
    /// No reference file, or one of another version.
    #[error("{0}")]
    Schema(String),
    /// Parts that do not make a whole.
    #[error("{0}")]
    Parts(String),
    /// The numbers are not those that were written.
    #[error(
        "SHA-256 is {found}, and the file says {stated}: it was changed or damaged after it was written{}",
        .block.map_or_else(String::new, |block| format!("; block {block} is the first that cannot be read"))
    )]
    Digest {
        /// Of the numbers.
        found: String,
        /// What the document says.
        stated: String,
        /// The block at which reading ended.
        block: Option<u64>,
    },
}

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputFormat {
    /// NPZ, or a single array of NumPy.
    Npz,
    /// Parquet.
    Parquet,
    /// A table.
    Csv,
    /// JSON.
    Json,
    /// binary32 numbers alone, for outputs.
    Raw,
}

impl InputFormat {
    /// The format of a file by its ending.
    pub fn of_name(name: &str) -> Option<Self> {
        let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
        Some(match ending.as_str() {
            "npz" | "npy" => Self::Npz,
            "parquet" | "pq" => Self::Parquet,
            "csv" => Self::Csv,
            "json" => Self::Json,
            "raw" | "bin" | "f32" => Self::Raw,
            _ => return None,
        })
    }
}

/// A reference file.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// Provenance, as the file has it.
    pub document: Document,
    /// Bytes by array, in the order of the document.
    pub arrays: Vec<Vec<u8>>,
}

impl Dataset {
    /// Reads a reference file as a whole and checks its digest.
    ///
    /// # Errors
    /// [`ReadError`] with what is wrong.
    pub fn read(source: InputFormat, from: &Shared) -> Result<Self, ReadError> {
        Self::of(&mut Blocks::open(source, from)?)
    }

    /// The array with this name.
    pub fn array(&self, name: &str) -> Option<(&Array, &[u8])> {
        let at = self.document.arrays.iter().position(|array| array.name == name)?;
        Some((&self.document.arrays[at], &self.arrays[at]))
    }

    /// All blocks together.
    ///
    /// # Errors
    /// [`ReadError`] with what is wrong.
    pub fn of(blocks: &mut dyn Sequence) -> Result<Self, ReadError> {
        let document = blocks.document().clone();
        let mut arrays = vec![Vec::new(); document.arrays.len()];
        while let Some(block) = blocks.next()? {
            arrays
                .iter_mut()
                .zip(&block.arrays)
                .for_each(|(all, part): (&mut Vec<u8>, &Bytes)| all.extend_from_slice(part));
        }
        Ok(Self { document, arrays })
    }

    /// Joins columns of words to arrays. The columns of uniforms have a value for every sample, of which
    /// the first of each case counts.
    fn of_table(document: Document, table: &Table) -> Result<Self, ReadError> {
        let mut arrays = Vec::new();
        for array in &document.arrays {
            let count = document.array_rows(array, document.rows) as usize;
            let step = if array.per == Per::Case { document.per_case.max(1) as usize } else { 1 };
            let columns: Vec<&Column> = (0..array.words())
                .map(|word| {
                    let name = array.column(word);
                    let missing = || ReadError::Damaged(format!("it has no column `{name}`"));
                    table.column(&name).ok_or_else(missing)
                })
                .collect::<Result<_, _>>()?;
            if let Some(short) = columns.iter().find(|column| column.numbers.len() as u64 != document.rows) {
                return Err(ReadError::Damaged(format!(
                    "the column `{}` has {} rows, and its provenance says {}: the file is cut off or damaged",
                    short.name,
                    short.numbers.len(),
                    document.rows
                )));
            }
            let mut bytes = Vec::with_capacity(count * array.stride());
            for row in 0..count {
                for column in &columns {
                    column.numbers.write(row * step, array.dtype, &mut bytes);
                }
            }
            arrays.push(bytes);
        }
        Ok(Self { document, arrays })
    }
}

/// Reads outputs of whatever made them, as a whole.
///
/// # Errors
/// [`ReadError`] with what is wrong; also when there are so many more rows than the reference has that they are
/// not its outputs.
pub fn outputs(source: InputFormat, from: &Shared, order: ByteOrder, wanted: &Wanted) -> Result<Table, ReadError> {
    let mut windows = windows(source, from, order, wanted)?;
    let table = windows.next(wanted.most())?;
    if windows.next(1)?.rows() > 0 {
        let (most, rows) = (wanted.most(), wanted.rows());
        return Err(ReadError::Damaged(format!("it has more than {most} rows, and the reference has {rows}")));
    }
    Ok(table)
}
