//! Anyone's outputs, some rows at a time, so that memory stays flat however long the file is.

use super::shared::Shared;
use super::{ByteOrder, InputFormat, ReadError, Table, Wanted, csv, json, npz, parquet, raw};

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

/// Opens outputs of whatever made them, and reads what is `wanted` of them. JSON is read as a whole, which takes a few
/// times the bytes of its text.
///
/// # Errors
/// [`ReadError`] with what is wrong.
pub fn windows(
    source: InputFormat,
    from: &Shared,
    order: ByteOrder,
    wanted: &Wanted,
) -> Result<Box<dyn Windows>, ReadError> {
    Ok(match source {
        InputFormat::Npz => npz::windows(from, wanted)?,
        InputFormat::Parquet => Box::new(parquet::Groups::outputs(from, wanted)?),
        InputFormat::Csv => Box::new(csv::Lines::open(from, wanted)?),
        InputFormat::Json => Box::new(Whole { table: json::table(from)?, at: 0 }),
        InputFormat::Raw => Box::new(raw::Words::open(from, order, wanted.words())?),
    })
}
