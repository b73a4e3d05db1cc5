//! Suites, shaders and regressions on disk: the only file access of suites, kept thin.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use base::text::{SourceFile, decode};
use program::{Written, listing};
use property::Sample;
use property::regressions::{self, Regression};

use super::error::LoadError;
use super::expectations::FILE;
use super::{Contents, Expect, Includes, Suite, combinations, parse_all};
use disk::{elsewhere, fresh, read_source};

/// Ending of a suite file.
pub const ENDING: &str = ".suite.toml";

/// A suite with its shader.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The suite.
    pub suite: Suite,
    /// Text of its shader; named as the path that was read.
    pub shader: SourceFile,
}

fn read(path: &Path) -> Result<SourceFile, LoadError> {
    let bytes = fs::read(path).map_err(|source| LoadError::Read { path: path.to_owned(), source })?;
    Ok(SourceFile::from_bytes(&path.display().to_string(), &bytes)?)
}

/// Reads a shader, in any encoding that is known, with the files that it includes.
///
/// # Errors
/// A file that cannot be read, and one that is no text. A file that is included and not there is none: only
/// the preprocessor knows whether it counts.
pub fn read_shader(path: &Path, includes: &mut Includes) -> Result<SourceFile, LoadError> {
    let bytes = read_source(path).map_err(|source| LoadError::Read { path: path.to_owned(), source })?;
    let name = path.display().to_string();
    if Written::of_path(&name) == Written::SpirV {
        let unread =
            |why| LoadError::Read { path: path.to_owned(), source: std::io::Error::new(ErrorKind::InvalidData, why) };
        return listing(&name, &bytes).map_err(unread);
    }
    let file = decode(&name, &bytes)?.file;
    // What a text in WGSL is composed of depends on values that are not chosen yet.
    if Written::of(&file) == Written::Wgsl { Ok(file) } else { includes.resolve(&file) }
}

/// Reads a suite file, with one suite or several, and the shaders that it names, which lie beside it.
///
/// # Errors
/// A file that cannot be read or is no text, and everything that is wrong in the suite file.
pub fn load_all(path: &Path) -> Result<Vec<Loaded>, LoadError> {
    let bytes = read_source(path).map_err(|source| LoadError::Read { path: path.to_owned(), source })?;
    let suites = parse_all(&SourceFile::from_bytes(&path.display().to_string(), &bytes)?)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    suites.into_iter().map(|suite| attached(suite, folder)).collect()
}

/// A suite with the texts that it names.
fn attached(mut suite: Suite, folder: &Path) -> Result<Loaded, LoadError> {
    for searched in &mut suite.includes.folders {
        *searched = folder.join(&*searched);
        if !searched.is_dir() {
            let path = searched.clone();
            let source = std::io::Error::from(ErrorKind::NotADirectory);
            let at = place(&suite.file, "include");
            return Err(LoadError::Named { at, what: "folder of includes", path, source });
        }
    }
    attach(&mut suite, folder)?;
    attach_pictures(&mut suite, folder)?;
    let (file, includes) = (&suite.file, &mut suite.includes);
    let mut text_of = |name: &String| {
        let path = folder.join(name);
        if let Some(why) = elsewhere::refusal(&path, &[folder]) {
            let source = std::io::Error::new(ErrorKind::InvalidInput, why);
            return Err(LoadError::Shader { at: place(file, name), path, source });
        }
        read_shader(&path, includes).map_err(|error| match error {
            LoadError::Read { path, source } => LoadError::Shader { at: place(file, name), path, source },
            other => other,
        })
    };
    let shader = text_of(&suite.shader)?;
    suite.linked_texts = suite.linked.iter().map(&mut text_of).collect::<Result<_, _>>()?;
    suite.with_texts = suite.with.iter().map(text_of).collect::<Result<_, _>>()?;
    Ok(Loaded { suite, shader })
}

/// Where a suite file says something first.
fn place(file: &SourceFile, text: &str) -> String {
    file.locate(file.text().find(text).unwrap_or_default()).to_string()
}

/// Suite files (`*.suite.toml`) below a folder, sorted. Hidden folders and build folders are left out.
///
/// # Errors
/// A folder that cannot be read.
pub fn search(folder: &Path) -> Result<Vec<PathBuf>, LoadError> {
    let mut files = Vec::new();
    walk(folder, &mut files)?;
    Ok(files)
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), LoadError> {
    let failed = |source| LoadError::Folder { path: folder.to_owned(), source };
    let mut entries: Vec<_> = fs::read_dir(folder).and_then(Iterator::collect::<Result<_, _>>).map_err(failed)?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        // A link to a folder is not followed: it may lead back here.
        if entry.file_type().map_err(failed)?.is_dir() {
            if !name.starts_with('.') && name != "target" && name != "node_modules" {
                walk(&path, files)?;
            }
        } else if name.ends_with(ENDING) {
            files.push(path);
        }
    }
    Ok(())
}

/// Reads the files that say what a suite expects.
fn attach(suite: &mut Suite, folder: &Path) -> Result<(), LoadError> {
    if let Expect::Recorded(recorded) = &mut suite.expect
        && recorded.is_arrays()
    {
        let each = combinations(&suite.dispatch.sizes).into_iter().map(|(_, chosen)| recorded.path_for(&chosen));
        let paths: BTreeSet<String> = each.collect();
        for file in paths {
            let path = folder.join(&file);
            let named =
                |source| LoadError::Named { at: recorded.at.clone(), what: "record", path: path.clone(), source };
            let bytes = fs::read(&path).map_err(named)?;
            recorded.archives.push((file, bytes));
        }
        return Ok(());
    }
    let (what, file, at, text) = match &mut suite.expect {
        Expect::Reference(reference) => ("reference", &reference.file, &reference.at, &mut reference.text),
        Expect::Recorded(recorded) => ("record", &recorded.file, &recorded.at, &mut recorded.text),
        Expect::Formula(_) | Expect::Nothing => return Ok(()),
    };
    let path = folder.join(file);
    if let Some(why) = elsewhere::refusal(&path, &[folder]).filter(|_| what == "reference") {
        let source = std::io::Error::new(ErrorKind::InvalidInput, why);
        return Err(LoadError::Named { at: at.clone(), what, path, source });
    }
    let read = if what == "reference" { read_shader(&path, &mut suite.includes) } else { self::read(&path) };
    *text = Some(read.map_err(|error| match error {
        LoadError::Read { path, source } => LoadError::Named { at: at.clone(), what, path, source },
        other => other,
    })?);
    Ok(())
}

/// Reads the pictures that a suite binds to samplers.
fn attach_pictures(suite: &mut Suite, folder: &Path) -> Result<(), LoadError> {
    for texture in &mut suite.textures {
        let Contents::File { name, picture } = &mut texture.contents else { continue };
        let path = folder.join(&*name);
        let named = |source| LoadError::Named { at: texture.at.clone(), what: "texture", path: path.clone(), source };
        let bytes = fs::read(&path).map_err(named)?;
        let read = super::textures::decode(name, &bytes);
        *picture = Some(read.map_err(|why| named(std::io::Error::new(ErrorKind::InvalidData, why)))?);
    }
    Ok(())
}

/// The expectations of a suite file: the nearest `expectations.toml` in its folder or above, up to the root of the
/// repository. Without a repository, up to the working folder where the suite lies below it, or in its own folder.
pub fn expectations_path(suite: &Path) -> Option<PathBuf> {
    let folder = suite.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let whole = folder.canonicalize().ok()?;
    let root = whole.ancestors().find(|folder| folder.join(".git").exists()).map(Path::to_owned);
    let here = || std::env::current_dir().and_then(|here| here.canonicalize()).ok();
    let last = root.or_else(|| here().filter(|here| whole.starts_with(here))).unwrap_or_else(|| whole.clone());
    let found = whole.ancestors().take_while(|folder| folder.starts_with(&last)).map(|folder| folder.join(FILE));
    let found = found.into_iter().find(|path| path.is_file())?;
    // Shown as people named the suite where it lies beside it, and from the working folder on elsewhere.
    if found.parent() == Some(&*whole) {
        return Some(folder.join(FILE));
    }
    let short = here().and_then(|here| found.strip_prefix(here).map(Path::to_owned).ok());
    Some(short.unwrap_or(found))
}

/// Reads the text of expectations.
///
/// # Errors
/// A file that cannot be read, or is no text.
pub fn read_expectations(path: &Path) -> Result<SourceFile, LoadError> {
    read(path)
}

/// The regression file of a suite file: `sphere.suite.toml` has `sphere.regressions` beside it.
pub fn regressions_path(suite: &Path) -> PathBuf {
    let name = suite.file_name().and_then(|n| n.to_str()).unwrap_or_default();
    let stem = name.strip_suffix(".suite.toml").or(name.strip_suffix(".toml")).unwrap_or(name);
    suite.with_file_name(format!("{stem}.regressions"))
}

/// Reads a regression file; nothing when there is none.
///
/// # Errors
/// A file that cannot be read, and the first malformed line.
pub fn read_regressions(path: &Path) -> Result<Vec<Regression>, LoadError> {
    Ok(regressions::parse(&existing(path)?)?)
}

fn existing(path: &Path) -> Result<SourceFile, LoadError> {
    match read(path) {
        Err(LoadError::Read { source, .. }) if source.kind() == ErrorKind::NotFound => {
            Ok(SourceFile::new(path.display().to_string(), ""))
        }
        other => other,
    }
}

/// Adds failing samples to a regression file. The file is replaced in one step, so that it is never
/// half written; what it holds is kept.
///
/// # Errors
/// A file that cannot be read or written, and a malformed line in it.
pub fn save_regressions(path: &Path, suite: &str, samples: &[Sample]) -> Result<(), LoadError> {
    let old = existing(path)?;
    let text = regressions::append(&old, suite, samples)?;
    if text == old.text() {
        return Ok(());
    }
    fresh::write(path, text.as_bytes()).map_err(|source| LoadError::Write { path: path.to_owned(), source })
}
