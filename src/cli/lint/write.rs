//! Replaces a file as a whole or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use base::text::{EncodeError, Encoding, Shown};
use disk::fresh;

/// Why a file was left as it was.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The system refused.
    #[error("{}: cannot be written ({source}); the file is as it was", path.shown())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It may not be written.
    #[error("{}: is read-only and was left as it was; make it writable first", .0.shown())]
    ReadOnly(PathBuf),
    /// It is a device or a pipe.
    #[error("{}: is not a regular file, so that there is nothing to repair in place", .0.shown())]
    NoFile(PathBuf),
    /// Someone else has written it meanwhile.
    #[error("{}: has changed since it was read and was left as it is; run again", .0.shown())]
    Changed(PathBuf),
    /// A character of the repaired text has no place in the encoding of the file.
    #[error("{0}; the file is as it was; convert it to UTF-8 to repair it")]
    Encode(#[from] EncodeError),
    /// The file would not even be written back as it was.
    #[error(
        "{}: holds bytes that {encoding} has another way to write, so that more than the repair would change; the file is as it was; convert it to UTF-8 to repair it",
        path.shown()
    )]
    Inexact {
        /// The file.
        path: PathBuf,
        /// Its encoding.
        encoding: Encoding,
    },
    /// No file was read under this name.
    #[error("{0}: no file of this name was read")]
    Unknown(String),
}

/// Replaces the contents `before` of a file by `after`. Readers see the one or the other, and
/// nothing in between. The permission bits stay; a symbolic link stays one, and the file it
/// points to is replaced.
///
/// # Errors
/// [`WriteError`]; the file is then as it was.
pub fn replace(path: &Path, before: &[u8], after: &[u8]) -> Result<(), WriteError> {
    let failed = |source| WriteError::Io { path: path.to_owned(), source };
    let target = fs::canonicalize(path).map_err(failed)?;
    let metadata = fs::metadata(&target).map_err(failed)?;
    if !metadata.is_file() {
        // What was read from a pipe is gone from it: reading it again would wait for ever.
        return Err(WriteError::NoFile(path.to_owned()));
    }
    if metadata.permissions().readonly() {
        return Err(WriteError::ReadOnly(path.to_owned()));
    }
    if fs::read(&target).map_err(failed)? != before {
        return Err(WriteError::Changed(path.to_owned()));
    }
    fresh::write(&target, after).map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_change_and_nothing_is_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vert");
        fs::write(&path, "before").unwrap();
        replace(&path, b"before", b"after").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"after");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn permission_bits_and_links_stay() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a.vert"), folder.path().join("link.vert"));
        fs::write(&path, "before").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o751)).unwrap();
        symlink("a.vert", &link).unwrap();
        replace(&link, b"before", b"after").unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o7777, 0o751);
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"after");
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_is_read_only_or_has_changed_is_left_alone() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vert");
        fs::write(&path, "other").unwrap();
        assert!(matches!(replace(&path, b"before", b"after"), Err(WriteError::Changed(_))));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        assert!(matches!(replace(&path, b"other", b"after"), Err(WriteError::ReadOnly(_))));
        assert_eq!(fs::read(&path).unwrap(), b"other");
        assert!(matches!(replace(&folder.path().join("none"), b"", b""), Err(WriteError::Io { .. })));
    }
}
