//! What a path leads to, and how each kind of target gets what was written.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::TempPath;

/// Links that are followed before a path counts as a loop; Linux follows as many.
const LINKS: usize = 40;

/// Temporary files that this process made. Their names are random: one that was renamed or removed is not there.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes the temporary files that nobody will finish.
pub fn abandon() {
    for path in std::mem::take(&mut *UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)) {
        // There is nobody to report to, and most of them were finished.
        let _ = fs::remove_file(path);
    }
}

/// The target of an output.
#[expect(clippy::large_enum_variant, reason = "there is one for a file that is written, and never a list")]
pub enum Target {
    /// A regular file, there or not: a temporary file beside it takes its name.
    Renamed {
        temporary: TempPath,
        path: PathBuf,
        /// The file that is replaced. It is open, so that the lack of a permission shows before the work.
        old: Option<(File, Metadata)>,
    },
    /// Contents are copied to what is open.
    Copied {
        to: File,
        /// A regular file, of which the old contents go.
        regular: bool,
    },
}

impl Target {
    /// Finds out what `path` is, and opens a temporary file for it: in `folder`, or beside the target.
    pub fn open(path: &Path, folder: Option<&Path>) -> io::Result<(File, Self)> {
        let metadata = match fs::metadata(path) {
            Ok(metadata) => Some(metadata),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        let descriptor = descriptor(path);
        match metadata {
            Some(metadata) if metadata.is_dir() => {
                Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder; name a file in it"))
            }
            Some(metadata) if descriptor.is_some() || !metadata.is_file() => {
                let to = stream(path, descriptor, &metadata)?;
                Ok((tempfile::tempfile()?, Self::Copied { to, regular: false }))
            }
            Some(metadata) => existing(path, folder, metadata),
            None => {
                let path = end_of_links(path)?;
                let (file, temporary) = beside(folder.unwrap_or_else(|| folder_of(&path)))?;
                Ok((file, Self::Renamed { temporary, path, old: None }))
            }
        }
    }

    /// True for a file that will be renamed, and not copied.
    pub fn is_renamed(&self) -> bool {
        matches!(self, Self::Renamed { .. })
    }

    /// Hands over the contents of the temporary file, which stands at its beginning.
    pub fn give(self, file: &mut File, sync: bool) -> io::Result<()> {
        match self {
            Self::Copied { to, regular } => copy(file, to, regular, sync),
            Self::Renamed { temporary, path, old: None } => rename(file, temporary, &path, sync),
            Self::Renamed { temporary, path, old: Some((old, metadata)) } => {
                let renamed = adopt(file, &metadata).and_then(|()| rename(file, temporary, &path, sync));
                match renamed {
                    // Someone else's file, and one that is mounted by itself, as containers do: neither can be
                    // replaced, but both can be written.
                    Err(error) if cannot_be_replaced(&error) => copy(file, old, true, sync),
                    done => done,
                }
            }
        }
    }
}

/// True for a path that leads to what is no regular file or folder, or is open already.
pub fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|m| !m.is_dir() && (!m.is_file() || descriptor(path).is_some()))
}

/// A regular file that is there.
fn existing(path: &Path, folder: Option<&Path>, metadata: Metadata) -> io::Result<(File, Target)> {
    // Root is not kept from writing to it, but whoever protected the file meant it.
    if metadata.permissions().readonly() {
        return Err(io::Error::new(ErrorKind::PermissionDenied, "it is read-only; make it writable first"));
    }
    let path = fs::canonicalize(path)?;
    let old = OpenOptions::new().write(true).open(&path)?;
    match beside(folder.unwrap_or_else(|| folder_of(&path))) {
        Ok((file, temporary)) => Ok((file, Target::Renamed { temporary, path, old: Some((old, metadata)) })),
        // In a folder where no file can be made, those that are there may still be written.
        Err(error) if cannot_be_replaced(&error) => {
            Ok((tempfile::tempfile()?, Target::Copied { to: old, regular: true }))
        }
        Err(error) => Err(error),
    }
}

fn cannot_be_replaced(error: &io::Error) -> bool {
    use ErrorKind::{CrossesDevices, PermissionDenied, ReadOnlyFilesystem, ResourceBusy};
    matches!(error.kind(), PermissionDenied | ReadOnlyFilesystem | ResourceBusy | CrossesDevices)
}

/// A temporary file that is readable as an ordinary file would be, and removed unless it is renamed.
pub fn beside(folder: &Path) -> io::Result<(File, TempPath)> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".shadercheck-").suffix(".new");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The umask takes its part, as for any new file.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let (file, temporary) = builder.tempfile_in(folder)?.into_parts();
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).push(temporary.to_path_buf());
    Ok((file, temporary))
}

/// The folder of a file.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Where a symbolic link leads that leads to no file yet.
fn end_of_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        match fs::read_link(&path) {
            Ok(next) => path = folder_of(&path).join(next),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("its symbolic links lead in a circle"))
}

/// The open file of a process, which paths such as `/dev/stdout`, `/dev/fd/3` and `/proc/1/fd/1` stand for.
///
/// A regular file may have been written before, and others may write to it: replacing it, or writing at its beginning,
/// would lose that.
#[derive(Clone, Copy)]
#[cfg_attr(not(unix), expect(dead_code, reason = "only Unix has paths that stand for open files"))]
struct Descriptor {
    number: u32,
    /// It is of this process.
    own: bool,
}

fn descriptor(path: &Path) -> Option<Descriptor> {
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        let folder = fs::canonicalize(folder_of(&path)).ok()?;
        if folder.ends_with("fd") && (folder.starts_with("/proc") || folder.starts_with("/dev")) {
            let number = path.file_name()?.to_str()?.parse().ok()?;
            let own = folder.starts_with("/dev") || fs::canonicalize("/proc/self/fd").is_ok_and(|own| own == folder);
            return Some(Descriptor { number, own });
        }
        path = folder.join(fs::read_link(&path).ok()?);
    }
    None
}

/// Opens what is no regular file, or is open already.
#[cfg(unix)]
fn stream(path: &Path, descriptor: Option<Descriptor>, metadata: &Metadata) -> io::Result<File> {
    use std::os::fd::{AsFd, OwnedFd};
    use std::os::unix::fs::FileTypeExt;
    use std::os::unix::net::UnixStream;

    match descriptor {
        // The same open file, so that what is written follows what was written before.
        Some(Descriptor { number: 1, own: true }) => Ok(File::from(io::stdout().as_fd().try_clone_to_owned()?)),
        Some(Descriptor { number: 2, own: true }) => Ok(File::from(io::stderr().as_fd().try_clone_to_owned()?)),
        _ if metadata.file_type().is_socket() => Ok(File::from(OwnedFd::from(UnixStream::connect(path)?))),
        _ if descriptor.is_some() && metadata.is_file() => OpenOptions::new().append(true).open(path),
        _ => OpenOptions::new().write(true).open(path),
    }
}

/// Opens what is no regular file, or is open already.
#[cfg(not(unix))]
fn stream(path: &Path, _: Option<Descriptor>, _: &Metadata) -> io::Result<File> {
    OpenOptions::new().write(true).open(path)
}

/// Gives a file the owner and the permissions of the one that it replaces.
#[cfg(unix)]
fn adopt(file: &File, old: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    let new = file.metadata()?;
    if (new.uid(), new.gid()) != (old.uid(), old.gid()) {
        fchown(file, Some(old.uid()), Some(old.gid()))?;
    }
    // After the owner, whose change takes away some of them.
    file.set_permissions(old.permissions())
}

/// Gives a file the permissions of the one that it replaces.
#[cfg(not(unix))]
fn adopt(file: &File, old: &Metadata) -> io::Result<()> {
    file.set_permissions(old.permissions())
}

fn rename(file: &File, temporary: TempPath, path: &Path, sync: bool) -> io::Result<()> {
    if sync {
        file.sync_all()?;
    }
    temporary.persist(path).map_err(|error| error.error)?;
    if sync {
        // The new name is on the disk once the folder is. Not every system lets a folder be opened.
        return File::open(folder_of(path)).and_then(|folder| folder.sync_all()).or(Ok(()));
    }
    Ok(())
}

fn copy(from: &mut File, mut to: File, regular: bool, sync: bool) -> io::Result<()> {
    from.rewind()?;
    if regular {
        to.set_len(0)?;
    }
    io::copy(from, &mut to)?;
    // Pipes and most devices have no disk to wait for.
    if regular && sync { to.sync_all() } else { Ok(()) }
}
