//! Writers of data sets, one format a file.

mod c;
mod csv;
mod json;
mod npz;
mod parquet;
mod text;

use std::io::{self, Seek, Write};

use super::document::Document;
use super::generate::Block;

/// What a data set is written to.
pub trait Store: Write + Seek + Send {}

impl<T: Write + Seek + Send> Store for T {}

/// Takes the blocks of a data set in their order.
pub trait Sink: Send {
    /// Writes a block.
    ///
    /// # Errors
    /// What the store fails with.
    fn block(&mut self, block: &Block) -> io::Result<()>;

    /// Ends the file. The document is the one that the writer began with, and has its digest now.
    ///
    /// # Errors
    /// What the store fails with.
    fn finish(&mut self, document: &Document) -> io::Result<()>;
}

/// A format of data sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Bits as texts with the decimal beside them.
    Json,
    /// Arrays of NumPy.
    Npz,
    /// Columns of Apache Parquet, a row group for each block.
    Parquet,
    /// A header for C and C++.
    C,
    /// A table with one line for each sample.
    Csv,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Json, Self::Npz, Self::Parquet, Self::C, Self::Csv];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Json => "json",
            Self::Npz => "npz",
            Self::Parquet => "parquet",
            Self::C => "c",
            Self::Csv => "csv",
        }
    }

    /// A writer. `spill` is asked for a second store where a format needs one.
    ///
    /// # Errors
    /// What a store fails with.
    pub fn sink<'s>(
        self,
        document: &Document,
        store: Box<dyn Store + 's>,
        spill: &dyn Fn() -> io::Result<Box<dyn Spill + 's>>,
    ) -> io::Result<Box<dyn Sink + 's>> {
        Ok(match self {
            Self::Json => Box::new(json::Json::new(document, store)?),
            Self::Npz => Box::new(npz::Npz::new(document, store)?),
            Self::Parquet => Box::new(parquet::Parquet::new(document, store)?),
            Self::C => Box::new(c::Header::new(document, store, spill()?)?),
            Self::Csv => Box::new(csv::Csv::new(document, store)?),
        })
    }
}

/// A store that is read again.
pub trait Spill: Store + io::Read {}

impl<T: Store + io::Read> Spill for T {}
