//! Files that appear under their name when they are whole.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that is being written beside the one that it will be. It is removed unless it is kept.
pub struct Fresh {
    file: File,
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
        Ok(Self { file, beside, path: path.to_owned(), kept: false })
    }

    /// What is written to.
    ///
    /// # Errors
    /// What the system says.
    pub fn file(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// What the system says, also about what the disk has not taken yet.
    pub fn keep(mut self) -> io::Result<()> {
        self.file.sync_all()?;
        fs::rename(&self.beside, &self.path)?;
        self.kept = true;
        Ok(())
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
        let fresh = Fresh::new(&path).unwrap();
        fresh.file().unwrap().write_all(b"whole").unwrap();
        fresh.keep().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
