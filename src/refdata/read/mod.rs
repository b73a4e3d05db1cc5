//! Readers: a reference file whole, and anyone's outputs as named columns of numbers.

mod csv;
mod json;
mod npz;
mod parquet;
mod raw;
mod table;

use std::io::{Read, Seek};

use thiserror::Error;

use super::array::{Array, Per};
use super::digest::Digest;
use super::document::Document;

pub use raw::ByteOrder;
pub use table::{Column, Numbers, Table};

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
pub enum Source {
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

impl Source {
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
    /// Its document.
    pub document: Document,
    /// Bytes by array, in the order of the document.
    pub arrays: Vec<Vec<u8>>,
}

impl Dataset {
    /// Reads a reference file and checks its digest.
    ///
    /// # Errors
    /// [`ReadError`] with what is wrong.
    pub fn read(source: Source, from: &mut dyn Load) -> Result<Self, ReadError> {
        let dataset = match source {
            Source::Npz => npz::dataset(from)?,
            Source::Parquet => parquet::dataset(from)?,
            Source::Csv => csv::dataset(from)?,
            Source::Json => json::dataset(from)?,
            Source::Raw => return Err(ReadError::Schema("raw numbers are no reference file".into())),
        };
        dataset.check()?;
        Ok(dataset)
    }

    /// The array with this name.
    pub fn array(&self, name: &str) -> Option<(&Array, &[u8])> {
        let at = self.document.arrays.iter().position(|array| array.name == name)?;
        Some((&self.document.arrays[at], &self.arrays[at]))
    }

    /// Joins the parts of a data set, in whatever order.
    ///
    /// # Errors
    /// [`ReadError::Parts`] when a part is missing, doubled, or of another run.
    pub fn join(mut parts: Vec<Self>) -> Result<Self, ReadError> {
        let wrong = |what: String| Err(ReadError::Parts(what));
        parts.sort_by_key(|part| part.document.first);
        let mut parts = parts.into_iter();
        let Some(mut whole) = parts.next() else { return wrong("it holds no reference file".into()) };
        let common = |document: &Document| Document { first: 0, rows: 0, sha256: String::new(), ..document.clone() };
        let (all, mut end) = (common(&whole.document), whole.document.first + whole.document.rows);
        if whole.document.first > 0 {
            return wrong(format!("samples 0 to {} are missing", whole.document.first - 1));
        }
        for part in parts {
            let Document { first, rows, .. } = part.document;
            if common(&part.document) != all {
                return wrong(format!(
                    "the part that begins with sample {first} is of another run: suite, seed, profile, number of \
                     samples or version differ"
                ));
            }
            if first < end && rows > 0 {
                return wrong(format!("sample {first} is in two parts"));
            }
            if first > end {
                return wrong(format!("samples {end} to {} are missing", first - 1));
            }
            for (bytes, more) in whole.arrays.iter_mut().zip(part.arrays) {
                bytes.extend(more);
            }
            end = end.max(first + rows);
        }
        if end < all.samples {
            return wrong(format!("samples {end} to {} are missing", all.samples - 1));
        }
        whole.document.rows = end;
        // Each part has been checked by its own digest.
        whole.document.sha256.clear();
        Ok(whole)
    }

    fn check(&self) -> Result<(), ReadError> {
        let Document { arrays, rows, first, block_rows, per_case, sha256, .. } = &self.document;
        let damaged = |what: String| Err(ReadError::Damaged(what));
        if *block_rows == 0
            || *per_case == 0
            || !block_rows.is_multiple_of(*per_case)
            || !first.is_multiple_of(*block_rows)
        {
            return damaged("its provenance states blocks that are no whole cases".into());
        }
        for (array, bytes) in arrays.iter().zip(&self.arrays) {
            let wanted = self.document.array_rows(array, *rows) * array.stride() as u64;
            if bytes.len() as u64 != wanted {
                return damaged(format!(
                    "the array `{}` has {} bytes, and its provenance says {wanted}: the file is cut off or damaged",
                    array.name,
                    bytes.len()
                ));
            }
        }
        let mut digest = Digest::default();
        let mut at = 0;
        while at < *rows {
            let end = (at + block_rows).min(*rows);
            let part = |(array, bytes): (&Array, &Vec<u8>)| -> Vec<u8> {
                let span = match array.per {
                    Per::Sample => at..end,
                    Per::Case => at / per_case..end.div_ceil(*per_case),
                };
                let stride = array.stride() as u64;
                bytes[(span.start * stride) as usize..(span.end * stride) as usize].to_vec()
            };
            let parts: Vec<Vec<u8>> = arrays.iter().zip(&self.arrays).map(part).collect();
            digest.add(&Digest::of_block(&parts));
            at = end;
        }
        let found = digest.hex();
        if found == *sha256 { Ok(()) } else { Err(ReadError::Digest { found, stated: sha256.clone(), block: None }) }
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

/// Reads outputs of whatever made them. `width` is the number of words of one sample, which raw numbers
/// do not tell.
///
/// # Errors
/// [`ReadError`] with what is wrong.
pub fn outputs(source: Source, from: &mut dyn Load, order: ByteOrder, width: usize) -> Result<Table, ReadError> {
    match source {
        Source::Npz => npz::table(from),
        Source::Parquet => parquet::table(from).map(|(table, _)| table),
        Source::Csv => csv::table(from).map(|(table, _)| table),
        Source::Json => json::table(from),
        Source::Raw => raw::table(from, order, width),
    }
}
