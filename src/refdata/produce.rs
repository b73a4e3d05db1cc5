//! Blocks, one after the other, into a file.

use std::io;
use std::ops::Range;

use rayon::prelude::*;

use super::digest::Digest;
use super::generate::{Block, Generator};
use super::write::Sink;

/// Most blocks that are made side by side.
const ABREAST: u64 = 4;

/// Makes these blocks and hands them to a writer. Some are made side by side, and while they are written the
/// next ones are made, so that twice [`ABREAST`] are in memory at most, however many there are. `progress` is told the
/// number of samples done. Gives the digest.
///
/// # Errors
/// What the writer fails with.
pub fn produce(
    generator: &Generator<'_>,
    blocks: Range<u64>,
    sink: &mut dyn Sink,
    progress: &mut (dyn FnMut(u64) + Send),
) -> io::Result<String> {
    let mut digest = Digest::default();
    let mut number = blocks.start;
    let mut done = 0;
    let abreast = ABREAST.min(rayon::current_num_threads() as u64);
    let make = |from: u64| -> Vec<Block> {
        let until = from.saturating_add(abreast).min(blocks.end);
        (from..until).into_par_iter().map(|number| generator.block(number)).collect()
    };
    let mut ready = make(number);
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
        ready = next;
    }
    let mut document = generator.document(&blocks);
    document.sha256 = digest.hex();
    sink.finish(&document)?;
    Ok(document.sha256)
}
