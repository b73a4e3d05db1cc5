//! Where output goes. A regular file appears under its name when it is whole; a device, pipe or socket is opened and
//! written to. Whatever writes to a path that people name goes through here: a rename onto `/dev/null` replaces the
//! device.

mod target;

pub use target::abandon;

use std::fs::File;
use std::io::{self, Seek, Write};
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use target::Target;

/// How long what is written waits for [`Fresh::sync_early`].
const EVERY: Duration = Duration::from_millis(10);

/// Output that is being written to a temporary file. Its target gets it when it is kept; until then a regular file
/// stays as it was, and dropping this leaves nothing behind.
pub struct Fresh {
    file: File,
    early: Option<Early>,
    target: Target,
}

impl Fresh {
    /// Begins to write to `path`. Symbolic links are followed.
    ///
    /// # Errors
    /// When the target is a folder, is read-only, or cannot be opened or made: before the work, not after it.
    pub fn new(path: &Path) -> io::Result<Self> {
        let (file, target) = Target::open(path, None)?;
        Ok(Self { file, early: None, target })
    }

    /// Like [`Fresh::new`], with the temporary file in another folder of the same disk.
    ///
    /// # Errors
    /// As [`Fresh::new`].
    pub fn within(folder: &Path, path: &Path) -> io::Result<Self> {
        let (file, target) = Target::open(path, Some(folder))?;
        Ok(Self { file, early: None, target })
    }

    /// What is written to; it can seek, whatever the target is.
    ///
    /// # Errors
    /// What the system says.
    pub fn file(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Has the disk take what is written while more is computed, so that little is left to wait for at the end.
    ///
    /// # Errors
    /// What the system says.
    pub fn sync_early(&mut self) -> io::Result<()> {
        if self.target.is_renamed() {
            self.early = Some(Early::begin(self.file.try_clone()?)?);
        }
        Ok(())
    }

    /// Gives the target what was written, and has the disk take it: at any time either the old or the new file is
    /// there, whole, also when the machine stops.
    ///
    /// # Errors
    /// What the system says, also about what the disk has not taken yet.
    pub fn keep(self) -> io::Result<()> {
        self.end(true)
    }

    /// Like [`Fresh::keep`], without waiting for the disk: for files that tell by themselves whether they are whole.
    ///
    /// # Errors
    /// What the system says.
    pub fn keep_unsynced(self) -> io::Result<()> {
        self.end(false)
    }

    fn end(mut self, sync: bool) -> io::Result<()> {
        if let Some(early) = self.early.take() {
            early.end()?;
        }
        self.file.rewind()?;
        self.target.give(&mut self.file, sync)
    }
}

/// A thread that has the disk take a file now and then.
struct Early {
    /// Closed to end the thread.
    open: Sender<()>,
    thread: JoinHandle<io::Result<()>>,
}

impl Early {
    fn begin(file: File) -> io::Result<Self> {
        let (open, ended) = channel::<()>();
        let thread = std::thread::Builder::new().name("sync".into()).spawn(move || {
            while ended.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
                // The system tells an error once: whoever asks next hears nothing of it.
                file.sync_data()?;
            }
            Ok(())
        })?;
        Ok(Self { open, thread })
    }

    fn end(self) -> io::Result<()> {
        drop(self.open);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the thread that waits for the disk was lost")))
    }
}

/// Writes a whole file, or to a device, pipe or socket.
///
/// # Errors
/// As [`Fresh::new`] and [`Fresh::keep`]; a regular file is then as it was.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut fresh = Fresh::new(path)?;
    fresh.file.write_all(bytes)?;
    fresh.keep()
}

/// Writes a file that must not be there yet.
///
/// # Errors
/// [`io::ErrorKind::AlreadyExists`] when something of this name is there, also if it came up meanwhile; what the
/// system says otherwise.
pub fn create(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let (mut file, temporary) = target::beside(target::folder_of(path))?;
    file.write_all(bytes)?;
    file.sync_all()?;
    temporary.persist_noclobber(path).map_err(|error| error.error)
}

/// True for what is opened and written to, and not replaced: a device, pipe or socket, or an open file such as
/// `/dev/stdout`. It has no ending that tells a format, and nothing can lie beside it.
pub fn is_stream(path: &Path) -> bool {
    target::is_stream(path)
}

/// Fails if no file can be made in a folder.
///
/// # Errors
/// What the system says.
pub fn probe(folder: &Path) -> io::Result<()> {
    target::beside(folder).map(|_| ())
}

#[cfg(test)]
mod tests;
