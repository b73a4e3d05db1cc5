//! Blocks, one after the other, into a file.

use std::collections::BTreeMap;
use std::io;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::Scope;

use super::digest::Digest;
use super::document::Document;
use super::generate::{Block, Generator};
use super::read::{ReadError, Sequence};
use super::write::Sink;

/// Most blocks that are in memory.
const AHEAD: u64 = 8;

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

/// Makes these blocks, but for those that are kept, and hands them to a writer. Some are made side by side while
/// others are written: a block is begun when another one has been written, so that eight are in memory at most,
/// however many there are. `progress` is told the number of samples done. Gives the digest.
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
    let line = Line { sink, digest: Digest::default(), next: blocks.start, done: 0, progress };
    let work = Work {
        generator,
        keep,
        next: AtomicU64::new(blocks.start),
        end: blocks.end,
        ready: Mutex::new(BTreeMap::new()),
        line: Mutex::new(line),
        failed: Mutex::new(None),
    };
    let ahead = AHEAD.min(2 * rayon::current_num_threads() as u64);
    rayon::scope(|scope| (0..ahead).for_each(|_| scope.spawn(|scope| work.step(scope))));
    let Work { line, failed, .. } = work;
    let Line { sink, digest, .. } = line.into_inner().unwrap_or_else(PoisonError::into_inner);
    if let Some(error) = failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let mut document = generator.document(&blocks);
    document.sha256 = digest.hex();
    sink.finish(&document)?;
    Ok(document.sha256)
}

/// What threads share that make blocks.
struct Work<'a, 'g> {
    generator: &'a Generator<'g>,
    keep: &'a dyn Keep,
    /// The next block to be made.
    next: AtomicU64,
    end: u64,
    /// Blocks that wait for those before them.
    ready: Mutex<BTreeMap<u64, Block>>,
    line: Mutex<Line<'a>>,
    failed: Mutex<Option<io::Error>>,
}

/// Where blocks are written in their order.
struct Line<'a> {
    sink: &'a mut dyn Sink,
    digest: Digest,
    /// The next block to be written.
    next: u64,
    /// Samples written.
    done: u64,
    progress: &'a mut (dyn FnMut(u64) + Send),
}

impl Work<'_, '_> {
    /// Makes one block, and writes what can be written.
    fn step<'s>(&'s self, scope: &Scope<'s>) {
        if locked(&self.failed).is_some() {
            return;
        }
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        if number >= self.end {
            return;
        }
        let written = self.one(number).and_then(|block| {
            locked(&self.ready).insert(number, block);
            self.write(scope)
        });
        if let Err(error) = written {
            // The error that is told is the first one.
            locked(&self.failed).get_or_insert(error);
        }
    }

    fn one(&self, number: u64) -> io::Result<Block> {
        if let Some(block) = self.keep.load(number) {
            return Ok(block);
        }
        let block = self.generator.block(number);
        self.keep.save(number, &block)?;
        Ok(block)
    }

    /// Writes blocks as long as the next one is there, unless another thread does. Each gives way to a new one.
    fn write<'s>(&'s self, scope: &Scope<'s>) -> io::Result<()> {
        loop {
            let next = {
                let Ok(mut line) = self.line.try_lock() else { return Ok(()) };
                while let Some(block) = self.taken(line.next) {
                    line.write(&block)?;
                    scope.spawn(|scope| self.step(scope));
                }
                line.next
            };
            // It may have come after the last look, when its thread could not write.
            if !locked(&self.ready).contains_key(&next) {
                return Ok(());
            }
        }
    }

    fn taken(&self, number: u64) -> Option<Block> {
        locked(&self.ready).remove(&number)
    }
}

impl Line<'_> {
    fn write(&mut self, block: &Block) -> io::Result<()> {
        self.digest.add(&block.digest);
        self.sink.block(block)?;
        self.next += 1;
        self.done += block.rows as u64;
        (self.progress)(self.done);
        Ok(())
    }
}

/// What is locked, also after a panic of another thread, which `rayon` passes on.
fn locked<X>(mutex: &Mutex<X>) -> MutexGuard<'_, X> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
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
