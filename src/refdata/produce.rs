//! Blocks, one after the other, into a file.

use std::io;
use std::ops::Range;

use super::digest::Digest;
use super::document::Document;
use super::generate::{Block, Generator};
use super::read::{ReadError, Sequence};
use super::write::Sink;

/// Where blocks are kept that are done, so that a run that was stopped need not make them again.
pub trait Keep: Sync {
    /// A block that is there.
    fn load(&self, number: u64) -> Option<Block>;

    /// Keeps a block.
    ///
    /// # Errors
    /// What it is written to fails with.
    fn save(&self, number: u64, block: &Block) -> io::Result<()>;
}

/// Keeps nothing.
pub struct Forget;

impl Keep for Forget {
    fn load(&self, _number: u64) -> Option<Block> {
        None
    }

    fn save(&self, _number: u64, _block: &Block) -> io::Result<()> {
        Ok(())
    }
}

/// Makes these blocks, but for those that are kept, and hands them to a writer. While one is written the next is
/// made, so that two are in memory, however many there are. `progress` is told the number of samples done. Gives
/// the digest.
///
/// # Errors
/// What the writer, or the place where blocks are kept, fails with.
pub fn produce(
    generator: &Generator<'_>,
    blocks: Range<u64>,
    sink: &mut dyn Sink,
    keep: &dyn Keep,
    progress: &mut (dyn FnMut(u64) + Send),
) -> io::Result<String> {
    let mut digest = Digest::default();
    let mut number = blocks.start;
    let mut done = 0;
    let make = |number: u64| -> io::Result<Option<Block>> {
        if number >= blocks.end {
            return Ok(None);
        }
        if let Some(block) = keep.load(number) {
            return Ok(Some(block));
        }
        let block = generator.block(number);
        keep.save(number, &block)?;
        Ok(Some(block))
    };
    let mut ready = make(number)?;
    while let Some(block) = ready.take() {
        number += 1;
        digest.add(&block.digest);
        let (next, written) = rayon::join(|| make(number), || sink.block(&block));
        written?;
        ready = next?;
        done += block.rows as u64;
        progress(done);
    }
    let mut document = generator.document(&blocks);
    document.sha256 = digest.hex();
    sink.finish(&document)?;
    Ok(document.sha256)
}

/// Why blocks could not be copied.
#[derive(Debug, thiserror::Error)]
pub enum CopyError {
    /// They cannot be read.
    #[error("{0}")]
    Read(#[from] ReadError),
    /// They cannot be written.
    #[error("{0}")]
    Write(#[from] io::Error),
}

/// Copies blocks to a writer, or only looks whether they are all there and as they were written. Gives the
/// document, with its digest.
///
/// # Errors
/// [`CopyError`] with what is wrong.
pub fn copy(
    blocks: &mut dyn Sequence,
    mut sink: Option<&mut dyn Sink>,
    progress: &mut dyn FnMut(u64),
) -> Result<Document, CopyError> {
    let (mut digest, mut done) = (Digest::default(), 0);
    while let Some(block) = blocks.next()? {
        digest.add(&block.digest);
        if let Some(sink) = &mut sink {
            sink.block(&block)?;
        }
        done += block.rows as u64;
        progress(done);
    }
    let document = Document { sha256: digest.hex(), ..blocks.document().clone() };
    if let Some(sink) = &mut sink {
        sink.finish(&document)?;
    }
    Ok(document)
}
