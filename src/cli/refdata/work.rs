//! Blocks of a shard that are done, each in a file of its own until the shard is whole.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use disk::fresh::Fresh;
use refdata::{Block, Generator, Keep, run_key};

/// What a file of a block begins with.
const MAGIC: &[u8; 16] = b"shadercheck-blk1";
/// Bytes before the arrays: that, the run, the number of the block, and its digest.
const HEAD: usize = 16 + 32 + 8 + 32;

/// The folder of a shard that is under way. It is hidden, so that no reader of data sets takes it for a part.
pub struct Work<'g> {
    folder: PathBuf,
    run: [u8; 32],
    generator: &'g Generator<'g>,
}

impl<'g> Work<'g> {
    /// Beside the file that the shard will be.
    ///
    /// # Errors
    /// When the folder cannot be made.
    pub fn open(path: &Path, document: &str, generator: &'g Generator<'g>) -> io::Result<Self> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let folder = path.with_file_name(format!(".{name}.work"));
        fs::create_dir_all(&folder)?;
        // What an earlier process was writing when it was stopped.
        for entry in fs::read_dir(&folder)? {
            let entry = entry?;
            if entry.file_name().to_string_lossy().ends_with(".new") {
                fs::remove_file(entry.path())?;
            }
        }
        Ok(Self { folder, run: run_key(document), generator })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// How many of these blocks are there.
    pub fn done(&self, blocks: std::ops::Range<u64>) -> u64 {
        blocks.filter(|&number| self.path(number).exists()).count() as u64
    }

    /// Forgets the blocks: the shard is whole.
    ///
    /// # Errors
    /// What the system says.
    pub fn remove(self) -> io::Result<()> {
        match fs::remove_dir_all(&self.folder) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        }
    }

    fn path(&self, number: u64) -> PathBuf {
        self.folder.join(format!("block-{number:012}"))
    }

    fn head(&self, number: u64) -> Vec<u8> {
        [&MAGIC[..], &self.run, &number.to_le_bytes()].concat()
    }
}

impl Keep for Work<'_> {
    fn load(&self, number: u64) -> Option<Block> {
        let bytes = fs::read(self.path(number)).ok()?;
        let (head, arrays) = bytes.split_at_checked(HEAD)?;
        let (own, digest) = head.split_at(HEAD - 32);
        // One of another run, or that is damaged, is made again.
        if own != self.head(number) {
            return None;
        }
        self.generator.restored(number, digest.try_into().ok()?, arrays)
    }

    fn save(&self, number: u64, block: &Block) -> io::Result<()> {
        let path = self.path(number);
        let fresh = Fresh::new(&path)?;
        let mut file = fresh.file()?;
        file.write_all(&self.head(number))?;
        file.write_all(&block.digest)?;
        block.arrays.iter().try_for_each(|array| file.write_all(array))?;
        // The digest tells a file that did not reach the disk: it need not be waited for.
        fresh.keep_unsynced()
    }
}
