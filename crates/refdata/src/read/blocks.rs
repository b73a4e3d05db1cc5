//! Reference files block by block, and the parts of a data set as one.

use super::shared::Shared;
use super::windows::Windows;
use super::{Dataset, InputFormat, ReadError, Table, csv, json, npz, parquet};
use crate::array::Array;
use crate::bytes::Bytes;
use crate::digest::Digest;
use crate::document::Document;
use crate::generate::Block;

/// Blocks of a data set in their order.
pub trait Sequence {
    /// The document of all of them. Its digest is that of the file, or empty where there are several.
    fn document(&self) -> &Document;

    /// The next block; none after the last one, when the digest was found to be right.
    ///
    /// # Errors
    /// [`ReadError`] with what is wrong.
    fn next(&mut self) -> Result<Option<Block>, ReadError>;
}

/// A reference file, of which one block is in memory at a time.
pub struct Blocks {
    document: Document,
    numbers: Numbers,
    digest: Digest,
    done: u64,
    ended: bool,
}

/// Where the numbers of a file are.
pub(super) enum Numbers {
    /// Arrays, each in one piece.
    Arrays(Vec<npz::Stored>),
    /// Columns of words.
    Columns(Box<dyn Windows>),
    /// Blocks one after the other.
    Values(json::Values),
}

impl Blocks {
    /// Opens a file and reads its document.
    ///
    /// # Errors
    /// [`ReadError`] with what is wrong.
    pub fn open(source: InputFormat, from: &Shared) -> Result<Self, ReadError> {
        let (document, numbers) = match source {
            InputFormat::Npz => npz::opened(from)?,
            InputFormat::Parquet => parquet::opened(from)?,
            InputFormat::Csv => csv::opened(from)?,
            InputFormat::Json => json::opened(from)?,
            InputFormat::Raw => return Err(ReadError::Schema("raw numbers are no reference file".into())),
        };
        Self::of(document, numbers)
    }

    /// The blocks of an open file.
    pub(super) fn of(document: Document, numbers: Numbers) -> Result<Self, ReadError> {
        document.check_sizes().map_err(ReadError::Damaged)?;
        Ok(Self { document, numbers, digest: Digest::default(), done: 0, ended: false })
    }

    fn arrays(&mut self, rows: u64) -> Result<Vec<Vec<u8>>, ReadError> {
        let Self { document, numbers, done, .. } = self;
        let wanted = |array: &Array| document.array_rows(array, rows) * array.stride() as u64;
        match numbers {
            Numbers::Arrays(all) => {
                let arrays = document.arrays.iter().zip(all);
                arrays.map(|(array, from)| from.words(document.array_rows(array, rows), array.dtype)).collect()
            }
            Numbers::Columns(windows) => {
                let table = windows.next(rows as usize)?;
                let part = Document { first: document.first + *done, rows, ..document.clone() };
                Ok(Dataset::of_table(part, &table)?.arrays)
            }
            Numbers::Values(values) => {
                let cut = || ReadError::Damaged("it has fewer blocks than its provenance says: it is cut off".into());
                let arrays = values.next(document)?.ok_or_else(cut)?;
                match document.arrays.iter().zip(&arrays).find(|(array, bytes)| bytes.len() as u64 != wanted(array)) {
                    None => Ok(arrays),
                    Some((array, bytes)) => Err(ReadError::Damaged(format!(
                        "`{}` has {} bytes in the block of sample {}, and its provenance says {}: the file is cut off or \
                         damaged",
                        array.name,
                        bytes.len(),
                        document.first + *done,
                        wanted(array)
                    ))),
                }
            }
        }
    }

    /// True when there are numbers behind the last block.
    fn has_more(&mut self) -> Result<bool, ReadError> {
        Ok(match &mut self.numbers {
            // Their sizes were compared when the file was opened.
            Numbers::Arrays(_) => false,
            Numbers::Columns(windows) => windows.next(1)?.rows() > 0,
            Numbers::Values(values) => values.next(&self.document)?.is_some(),
        })
    }
}

impl Sequence for Blocks {
    fn document(&self) -> &Document {
        &self.document
    }

    fn next(&mut self) -> Result<Option<Block>, ReadError> {
        if self.ended {
            return Ok(None);
        }
        if self.done == self.document.rows {
            if self.has_more()? {
                let rows = self.document.rows;
                return Err(ReadError::Damaged(format!("it has more than the {rows} rows that its provenance says")));
            }
            let (found, stated) = (std::mem::take(&mut self.digest).hex(), self.document.sha256.clone());
            self.ended = true;
            return if found == stated { Ok(None) } else { Err(ReadError::Digest { found, stated, block: None }) };
        }
        let rows = self.document.block_rows.min(self.document.rows - self.done);
        let arrays = self.arrays(rows)?;
        let Document { first, per_case, .. } = self.document;
        let digest = Digest::of_block(&arrays);
        self.digest.add(&digest);
        let block = Block {
            first: first + self.done,
            rows: rows as usize,
            first_case: (first + self.done) / per_case,
            cases: rows.div_ceil(per_case) as usize,
            per_case: per_case as usize,
            arrays: arrays.into_iter().map(Bytes::from).collect(),
            digest,
        };
        self.done += rows;
        Ok(Some(block))
    }
}

/// Opens the part with this number.
pub type Open<'p> = Box<dyn FnMut(usize) -> Result<Blocks, ReadError> + 'p>;

/// The parts of a data set, one after the other.
pub struct Chain<'p> {
    document: Document,
    open: Open<'p>,
    /// Numbers of the parts, in their order.
    order: Vec<usize>,
    next: usize,
    current: Option<Blocks>,
}

impl<'p> Chain<'p> {
    /// Of parts with these names and documents, in whatever order.
    ///
    /// # Errors
    /// [`ReadError::Parts`] when a part is missing, doubled, or of another run.
    pub fn new(parts: &[(String, Document)], open: Open<'p>) -> Result<Self, ReadError> {
        let (document, order) = joined(parts)?;
        Ok(Self { document, open, order, next: 0, current: None })
    }

    /// The numbers of the parts in the order of their samples.
    pub fn order(&self) -> &[usize] {
        &self.order
    }
}

impl Sequence for Chain<'_> {
    fn document(&self) -> &Document {
        &self.document
    }

    fn next(&mut self) -> Result<Option<Block>, ReadError> {
        loop {
            if let Some(current) = &mut self.current {
                if let Some(block) = current.next()? {
                    return Ok(Some(block));
                }
                self.current = None;
            }
            let Some(&part) = self.order.get(self.next) else { return Ok(None) };
            self.next += 1;
            self.current = Some((self.open)(part)?);
        }
    }
}

/// The document of the whole, and the order of the parts.
fn joined(parts: &[(String, Document)]) -> Result<(Document, Vec<usize>), ReadError> {
    let wrong = |what: String| Err(ReadError::Parts(what));
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|&k| (parts[k].1.first, parts[k].1.rows, &parts[k].0));
    let Some(&first) = order.first() else { return wrong("it holds no reference file".into()) };
    let (name, all) = &parts[first];
    let (mut end, mut before) = (0, name);
    let missing = |from: u64, to: u64| {
        wrong(format!("samples {from} to {} are missing: run the shard that has them again", to - 1))
    };
    for &k in &order {
        let (own, document) = &parts[k];
        if let Err(what) = all.same_run(document) {
            return wrong(format!("`{name}` and `{own}` are of different runs: {what}"));
        }
        let Document { first, rows, .. } = *document;
        if first < end && rows > 0 {
            return wrong(format!("sample {first} is there twice: in `{before}` and in `{own}`"));
        }
        if first > end {
            return missing(end, first);
        }
        if rows > 0 {
            (end, before) = (first + rows, own);
        }
    }
    if end < all.samples {
        return missing(end, all.samples);
    }
    let sha256 = if let [only] = parts { only.1.sha256.clone() } else { String::new() };
    Ok((Document { first: 0, rows: end, sha256, ..all.clone() }, order))
}

impl Table {
    /// Rows of the longest column.
    pub(super) fn rows(&self) -> usize {
        self.columns.iter().map(super::Column::rows).max().unwrap_or(0)
    }
}
