//! Files that appear under their name when they are whole.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// How long what is written waits for [`Fresh::sync_early`].
const EVERY: Duration = Duration::from_millis(10);

/// A file that is being written beside the one that it will be. It is removed unless it is kept.
pub struct Fresh {
    file: File,
    early: Option<Early>,
    beside: PathBuf,
    path: PathBuf,
    kept: bool,
}

impl Fresh {
    /// Begins a file.
    ///
    /// # Errors
    /// What the system says.
    pub fn new(path: &Path) -> io::Result<Self> {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Self::within(folder, path)
    }

    /// Begins a file in another folder of the same disk.
    ///
    /// # Errors
    /// What the system says.
    pub fn within(folder: &Path, path: &Path) -> io::Result<Self> {
        // Not a temporary file of the system's kind: those are readable by their owner alone.
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let beside = folder.join(format!(".{name}.{}.new", std::process::id()));
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(true).open(&beside)?;
        Ok(Self { file, early: None, beside, path: path.to_owned(), kept: false })
    }

    /// What is written to.
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
        self.early = Some(Early::begin(self.file.try_clone()?)?);
        Ok(())
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// What the system says, also about what the disk has not taken yet.
    pub fn keep(mut self) -> io::Result<()> {
        if let Some(early) = self.early.take() {
            early.end()?;
        }
        self.file.sync_all()?;
        fs::rename(&self.beside, &self.path)?;
        self.kept = true;
        Ok(())
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

/// Writes a whole file.
///
/// # Errors
/// What the system says; there is no file of this name then, or the one that was there.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut fresh = Fresh::new(path)?;
    fresh.file.write_all(bytes)?;
    fresh.keep()
}

impl Drop for Fresh {
    fn drop(&mut self) {
        if !self.kept {
            // There is nobody to tell that a file was left behind.
            let _ = fs::remove_file(&self.beside);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_not_kept_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.npz");
        let fresh = Fresh::new(&path).unwrap();
        fresh.file().unwrap().write_all(b"half").unwrap();
        assert!(!path.exists());
        drop(fresh);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let mut fresh = Fresh::new(&path).unwrap();
        fresh.sync_early().unwrap();
        fresh.file().unwrap().write_all(b"whole").unwrap();
        fresh.keep().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
