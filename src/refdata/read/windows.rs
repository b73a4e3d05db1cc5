//! Anyone's outputs, some rows at a time, so that memory stays flat however long the file is.

use super::shared::Shared;
use super::{ByteOrder, ReadError, Source, Table, csv, json, npz, parquet, raw};

/// Rows of a file in their order.
pub trait Windows: Send {
    /// The next rows, at most so many; fewer at the end, and then none.
    ///
    /// # Errors
    /// [`ReadError`] with what is wrong.
    fn next(&mut self, rows: usize) -> Result<Table, ReadError>;
}

/// A table that is in memory as a whole.
pub(super) struct Whole {
    pub table: Table,
    pub at: usize,
}

impl Windows for Whole {
    fn next(&mut self, rows: usize) -> Result<Table, ReadError> {
        let begin = self.at;
        self.at = begin.saturating_add(rows);
        Ok(self.table.window(begin..self.at))
    }
}

/// Opens outputs of whatever made them. `width` is the number of words of one sample, which raw numbers do not
/// tell. JSON, and archives that are compressed, are read as a whole.
///
/// # Errors
/// [`ReadError`] with what is wrong.
pub fn windows(source: Source, from: &Shared, order: ByteOrder, width: usize) -> Result<Box<dyn Windows>, ReadError> {
    Ok(match source {
        Source::Npz => npz::windows(from)?,
        Source::Parquet => Box::new(parquet::Groups::open(from)?),
        Source::Csv => Box::new(csv::Lines::open(from)?),
        Source::Json => Box::new(Whole { table: json::table(&mut from.at(0))?, at: 0 }),
        Source::Raw => Box::new(raw::Words::open(from, order, width)?),
    })
}
