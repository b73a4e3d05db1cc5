//! Finds and reads the files to lint, and those that they refer to.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::lint::fix::FixedFile;
use crate::lint::{HOST_EXTENSIONS, Input, SHADER_EXTENSIONS, companions, language_of};
use crate::text::{SourceFile, TextError};

use super::write::{WriteError, replace};

/// Files above this size are no source text; reading one would only exhaust the memory.
const MOST_BYTES: u64 = 16 << 20;

/// Headers include headers: how far they are followed.
const MOST_COMPANION_ROUNDS: usize = 8;

const BOM: &str = "\u{feff}";

/// Why a path is not linted.
#[derive(Debug, Error)]
pub enum InputError {
    /// It cannot be read.
    #[error("{}: cannot be read ({source}); check the path and its permissions", path.display())]
    Unreadable {
        /// The path.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// It is not UTF-8.
    #[error(transparent)]
    NotText(#[from] TextError),
    /// It has no text.
    #[error("{}: the file is empty; name a file with text", .0.display())]
    Empty(PathBuf),
    /// Its name does not say what it is.
    #[error(
        "{}: neither a shader nor C or C++ by its name; known endings are {}",
        .0.display(),
        endings()
    )]
    UnknownKind(PathBuf),
    /// A folder without a file to lint.
    #[error("{}: no shader and no C or C++ file in this folder; known endings are {}", .0.display(), endings())]
    NothingInFolder(PathBuf),
    /// It is too large.
    #[error("{}: the file has {size} bytes, more than a source text of {MOST_BYTES}; leave it out", path.display())]
    TooLarge {
        /// The path.
        path: PathBuf,
        /// Its size.
        size: u64,
    },
    /// It is a device, a pipe or the like.
    #[error("{}: not a regular file; name a file or a folder", .0.display())]
    NotAFile(PathBuf),
}

fn endings() -> String {
    let all: Vec<String> = SHADER_EXTENSIONS.iter().chain(HOST_EXTENSIONS).map(|e| format!(".{e}")).collect();
    all.join(" ")
}

/// What was read.
pub struct Loaded {
    /// The texts, without byte-order marks.
    pub inputs: Vec<Input>,
    /// What could not be read.
    pub problems: Vec<InputError>,
    /// Path and byte-order mark of each reported text, by its name.
    sources: BTreeMap<String, Source>,
}

struct Source {
    path: PathBuf,
    bom: bool,
}

impl Loaded {
    /// Replaces a file by its fixed text, with the byte-order mark that it had.
    pub fn write(&self, file: &FixedFile) -> Result<(), WriteError> {
        let Some(source) = self.sources.get(file.before.name()) else {
            return Err(WriteError::Unknown(file.before.name().to_owned()));
        };
        let bytes = |text: &str| [if source.bom { BOM } else { "" }, text].concat().into_bytes();
        replace(&source.path, &bytes(file.before.text()), &bytes(file.after.text()))
    }
}

/// Reads all files that `paths` name, searches folders, and adds the files that these refer to as
/// context, as far as they can be read.
pub fn load(paths: &[PathBuf]) -> Loaded {
    let mut loaded = Loaded { inputs: Vec::new(), problems: Vec::new(), sources: BTreeMap::new() };
    let mut seen = BTreeSet::new();
    for path in paths {
        match fs::metadata(path) {
            Err(source) => loaded.problems.push(InputError::Unreadable { path: path.clone(), source }),
            Ok(meta) if meta.is_dir() => {
                let mut found = Vec::new();
                search(path, &mut found, &mut loaded.problems);
                if found.is_empty() {
                    loaded.problems.push(InputError::NothingInFolder(path.clone()));
                }
                for file in found {
                    take(&file, false, &mut seen, &mut loaded);
                }
            }
            Ok(meta) if !meta.is_file() => loaded.problems.push(InputError::NotAFile(path.clone())),
            Ok(_) if language_of(&name(path)).is_none() => {
                loaded.problems.push(InputError::UnknownKind(path.clone()));
            }
            Ok(_) => take(path, true, &mut seen, &mut loaded),
        }
    }
    add_companions(&mut loaded.inputs, &mut seen);
    loaded
}

/// Reads a file into `loaded` unless it was read before. An empty file found in a folder is passed
/// over; one that was named is an error.
fn take(path: &Path, named: bool, seen: &mut BTreeSet<PathBuf>, loaded: &mut Loaded) {
    if !seen.insert(identity(path)) {
        return;
    }
    match read(path) {
        Ok((file, bom)) => {
            loaded.sources.insert(file.name().to_owned(), Source { path: path.to_owned(), bom });
            loaded.inputs.push(Input::new(file));
        }
        Err(InputError::Empty(_)) if !named => {}
        Err(error) => loaded.problems.push(error),
    }
}

fn add_companions(inputs: &mut Vec<Input>, seen: &mut BTreeSet<PathBuf>) {
    let mut next = 0;
    for _ in 0..MOST_COMPANION_ROUNDS {
        let wanted: BTreeSet<String> = inputs[next..].iter().flat_map(companions).collect();
        next = inputs.len();
        for path in wanted.iter().map(PathBuf::from) {
            let is_new = path.is_file() && seen.insert(identity(&path));
            // Context that cannot be read only means that less is known.
            if let Some(Ok((file, _))) = is_new.then(|| read(&path)) {
                inputs.push(Input::context(file));
            }
        }
    }
}

fn identity(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// A path as messages show it, and as rules compare it.
fn name(path: &Path) -> String {
    let name = path.to_string_lossy();
    if std::path::MAIN_SEPARATOR == '\\' { name.replace('\\', "/") } else { name.into_owned() }
}

fn read(path: &Path) -> Result<(SourceFile, bool), InputError> {
    let unreadable = |source| InputError::Unreadable { path: path.to_owned(), source };
    let size = fs::metadata(path).map_err(unreadable)?.len();
    if size > MOST_BYTES {
        return Err(InputError::TooLarge { path: path.to_owned(), size });
    }
    let bytes = fs::read(path).map_err(unreadable)?;
    let bom = bytes.starts_with(BOM.as_bytes());
    let text = if bom { &bytes[BOM.len()..] } else { &bytes };
    let file = SourceFile::from_bytes(&name(path), text)?;
    if file.text().trim().is_empty() {
        return Err(InputError::Empty(path.to_owned()));
    }
    Ok((file, bom))
}

/// Files below a folder with a known ending, sorted. Hidden folders are passed over, and links to
/// folders are not followed: they could lead round in a circle.
fn search(folder: &Path, found: &mut Vec<PathBuf>, problems: &mut Vec<InputError>) {
    let entries = match fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>) {
        Ok(entries) => entries,
        Err(source) => {
            problems.push(InputError::Unreadable { path: folder.to_owned(), source });
            return;
        }
    };
    let mut paths: Vec<PathBuf> = entries.iter().map(fs::DirEntry::path).collect();
    paths.sort();
    for path in paths {
        let hidden = path.file_name().is_some_and(|n| n.to_string_lossy().starts_with('.'));
        if path.is_dir() {
            if !hidden && !path.is_symlink() {
                search(&path, found, problems);
            }
        } else if path.is_file() && has_known_ending(&path) {
            found.push(path);
        }
    }
}

fn has_known_ending(path: &Path) -> bool {
    path.extension().is_some_and(|e| {
        let ending = e.to_string_lossy().to_ascii_lowercase();
        SHADER_EXTENSIONS.contains(&ending.as_str()) || HOST_EXTENSIONS.contains(&ending.as_str())
    })
}
