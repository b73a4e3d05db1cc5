//! Blocks, one after the other, into a file.

use std::io;
use std::ops::Range;

use rayon::prelude::*;

use super::digest::Digest;
use super::document::Document;
use super::generate::{Block, Generator};
use super::read::{ReadError, Sequence};
use super::write::Sink;

/// Most blocks that are made side by side.
const ABREAST: u64 = 4;

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

/// Makes these blocks, but for those that are kept, and hands them to a writer. Some are made side by side, and
/// while they are written the next ones are made, so that twice [`ABREAST`] are in memory at most, however many
/// there are. `progress` is told the number of samples done. Gives the digest.
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
    let abreast = ABREAST.min(rayon::current_num_threads() as u64);
    let one = |number: u64| -> io::Result<Block> {
        if let Some(block) = keep.load(number) {
            return Ok(block);
        }
        let block = generator.block(number);
        keep.save(number, &block)?;
        Ok(block)
    };
    let make = |from: u64| -> io::Result<Vec<Block>> {
        let until = from.saturating_add(abreast).min(blocks.end);
        (from..until).into_par_iter().map(one).collect()
    };
    let mut ready = make(number)?;
    while !ready.is_empty() {
        number += ready.len() as u64;
        let mut write = |blocks: &[Block]| {
            for block in blocks {
                digest.add(&block.digest);
                sink.block(block)?;
                done += block.rows as u64;
                progress(done);
            }
            Ok::<(), io::Error>(())
        };
        let (next, written) = rayon::join(|| make(number), || write(&ready));
        written?;
        ready = next?;
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
