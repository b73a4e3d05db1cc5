//! Blocks, one after the other, into a file.

use std::io;
use std::ops::Range;

use super::digest::Digest;
use super::generate::{Block, Generator};
use super::write::Sink;

/// Makes these blocks and hands them to a writer. While one is written the next is made, so that two are in
/// memory, however many there are. `progress` is told the number of samples done. Gives the digest.
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
    let mut ready = (number < blocks.end).then(|| generator.block(number));
    while let Some(block) = ready.take() {
        number += 1;
        let next = || (number < blocks.end).then(|| generator.block(number));
        let write = |block: &Block| -> io::Result<()> {
            digest.add(&block.digest);
            sink.block(block)
        };
        let written = {
            let mut write = write;
            let (next, written) = rayon::join(next, || write(&block));
            ready = next;
            written
        };
        written?;
        done += block.rows as u64;
        progress(done);
    }
    let mut document = generator.document(&blocks);
    document.sha256 = digest.hex();
    sink.finish(&document)?;
    Ok(document.sha256)
}
