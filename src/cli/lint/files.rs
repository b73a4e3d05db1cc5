//! Finds and reads the files to lint, and those that they refer to.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use ignore::{WalkBuilder, WalkState};
use rayon::prelude::*;
use thiserror::Error;

use base::text::{Decoded, Encoding, Form, Shown, SourceFile, TextError, decode_western};
use disk::{MOST_BYTES, read_source};
use hosts::document::{DOCUMENT_EXTENSIONS, is_document};
use hosts::marks;
use hosts::script::SCRIPT_EXTENSIONS;
use hosts::{HOST_EXTENSIONS, Language, SHADER_EXTENSIONS, language_of};
use lint::Input;
use lint::fix::FixedFile;
use reading::{Config, Project, companions};
use syntax::{Stage, errors};

use super::modules;
use super::write::{WriteError, replace};

/// Headers include headers: how far they are followed.
const MOST_COMPANION_ROUNDS: usize = 8;

/// Why a path is not linted.
#[derive(Debug, Error)]
pub enum InputError {
    /// It cannot be read.
    #[error("{}: cannot be read ({source}); check the path and its permissions", path.shown())]
    Unreadable {
        /// The path.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A folder cannot be searched.
    #[error("{}: cannot be searched ({message}); check its permissions", path.shown())]
    Unsearchable {
        /// The folder that was to be searched.
        path: PathBuf,
        /// What the system says.
        message: String,
    },
    /// Its bytes are no text.
    #[error(transparent)]
    NotText(#[from] TextError),
    /// It has no text.
    #[error("{}: the file is empty; name a file with text", .0.shown())]
    Empty(PathBuf),
    /// A tool wrote it, from sources that are linted themselves.
    #[error("{}: a bundle by the length of its lines, which a tool wrote from other files; name it to have it linted", .0.shown())]
    Bundle(PathBuf),
    /// Its name does not say what it is.
    #[error(
        "{}: neither a shader nor host code by its name, and no document with blocks of such code; known endings are {}",
        .0.shown(),
        endings()
    )]
    UnknownKind(PathBuf),
    /// A language that has no rules.
    #[error("{}: there are no rules for HLSL and Slang; `fuzz` and `compare` run their functions", .0.shown())]
    NoRules(PathBuf),
    /// A document in which nothing is code of ours.
    #[error("{}: no block of this document is a shader, or code that calls OpenGL", .0.shown())]
    NoCode(PathBuf),
    /// A folder without a file to lint.
    #[error(
        "{}: no shader, no host code and no document with such code in this folder; known endings are {}; hidden files and what .gitignore names are left out",
        .0.shown(),
        endings()
    )]
    NothingInFolder(PathBuf),
    /// It is too large.
    #[error("{}: the file has {size} bytes, more than a source text of {MOST_BYTES}; leave it out", path.shown())]
    TooLarge {
        /// The path.
        path: PathBuf,
        /// Its size.
        size: u64,
    },
    /// It is a device, a pipe or the like.
    #[error("{}: not a regular file; name a file or a folder", .0.shown())]
    NotAFile(PathBuf),
}

fn endings() -> String {
    let all: Vec<String> = known_endings().map(|e| format!(".{e}")).collect();
    all.join(" ")
}

fn known_endings() -> impl Iterator<Item = &'static &'static str> {
    SHADER_EXTENSIONS.iter().chain(HOST_EXTENSIONS).chain(SCRIPT_EXTENSIONS).chain(DOCUMENT_EXTENSIONS)
}

/// What was read.
#[derive(Default)]
pub struct Loaded {
    /// The texts, without byte-order marks.
    pub inputs: Vec<Input>,
    /// The stage of shader files that are named, where it is stated.
    stage: Option<Stage>,
    /// Stages that the texts of found files say, whose endings say nothing.
    told: BTreeMap<PathBuf, Stage>,
    /// Folders in which imported files are looked for.
    folders: Vec<PathBuf>,
    /// What could not be read.
    pub problems: Vec<InputError>,
    /// Files of host code in a folder that are no text, and bundles.
    pub skipped: Vec<InputError>,
    /// Where each reported text came from, by its name.
    sources: BTreeMap<String, Candidate>,
    /// Names of all texts by their real paths.
    names: BTreeMap<PathBuf, String>,
    /// A folder was searched.
    pub is_folder: bool,
}

struct Candidate {
    path: PathBuf,
    form: Form,
    exact: bool,
}

impl Loaded {
    /// Replaces a file by its fixed text, in the encoding that it had.
    pub fn write(&self, file: &FixedFile) -> Result<(), WriteError> {
        let Some(source) = self.sources.get(file.before.name()) else {
            return Err(WriteError::Unknown(file.before.name().to_owned()));
        };
        let (path, encoding) = (source.path.clone(), source.form.encoding);
        if !source.exact {
            return Err(WriteError::Inexact { path, encoding });
        }
        let before = source.form.encode(&file.before)?;
        replace(&path, &before, &source.form.encode(&file.after)?)
    }

    /// How a reported file is written.
    pub fn form(&self, name: &str) -> Option<Form> {
        self.sources.get(name).map(|s| s.form)
    }

    /// Path of a reported file.
    pub fn path(&self, name: &str) -> Option<&Path> {
        self.sources.get(name).map(|s| s.path.as_path())
    }

    /// Puts a text in the place of a file's, or beside the others where the file is not among them.
    pub fn overlay(&mut self, path: &Path, text: &str) {
        let file = SourceFile::new(name(path), text);
        let known = self.inputs.iter_mut().find(|i| i.file.name() == file.name());
        if !self.sources.contains_key(file.name()) {
            self.names.insert(identity(path), file.name().to_owned());
            let form = Form { encoding: Encoding::Utf8, mark: false };
            self.sources.insert(file.name().to_owned(), Candidate { path: path.to_owned(), form, exact: true });
        }
        match known {
            Some(input) => *input = input.with_file(file).with_reported(true),
            None => {
                let shader = matches!(language_of(file.name()), Some(Language::Wgsl | Language::Shader(_)));
                let input = Input::new(file).kept();
                self.inputs.push(if shader { input.composed_by(modules::composer(&self.folders)) } else { input });
            }
        }
    }

    /// The encoding of a file where a text cannot be written back to it byte by byte as UTF-8.
    pub fn other_encoding(&self, name: &str) -> Option<Encoding> {
        let source = self.sources.get(name)?;
        (source.form.encoding != Encoding::Utf8 || !source.exact).then_some(source.form.encoding)
    }

    /// The name under which a file is among the inputs; it is read as context when it is not yet.
    /// The path itself when it cannot be read.
    pub fn name_of(&mut self, path: &Path) -> String {
        let identity = identity(path);
        if let Some(name) = self.names.get(&identity) {
            return name.clone();
        }
        let name = name(path);
        if let Ok(decoded) = read(path) {
            self.names.insert(identity, name.clone());
            self.inputs.push(Input::context(decoded.file));
        }
        name
    }
}

/// Reads all files that `paths` name, searches folders, and adds the files that these refer to as
/// context, as far as they can be read. Shader files among `paths`, and files of no known kind, are of `stage` where that
/// is given.
///
/// # Errors
/// When a stage is given and no such file is named.
pub fn load(paths: &[PathBuf], stage: Option<Stage>, folders: &[PathBuf]) -> anyhow::Result<Loaded> {
    let mut loaded = Loaded { stage, folders: folders.to_vec(), ..Loaded::default() };
    let mut wanted: Vec<(PathBuf, bool)> = Vec::new();
    // Folders that hold nothing, or documents alone, in which nothing may be code.
    let mut searched: Vec<PathBuf> = Vec::new();
    for path in paths {
        match fs::metadata(path) {
            Err(source) => loaded.problems.push(InputError::Unreadable { path: path.clone(), source }),
            Ok(meta) if meta.is_dir() => {
                loaded.is_folder = true;
                let (found, told) = search(path, &mut loaded.problems);
                loaded.told.extend(told);
                if found.iter().all(|file| language_of(&name(file)).is_none() && !lacks_rules(file)) {
                    searched.push(path.clone());
                }
                wanted.extend(found.into_iter().map(|file| (file, false)));
            }
            Ok(meta) if !meta.is_file() => loaded.problems.push(InputError::NotAFile(path.clone())),
            Ok(_) => wanted.push((path.clone(), true)),
        }
    }
    take(wanted, &mut loaded);
    searched.retain(|folder| !loaded.sources.values().any(|s| s.path.starts_with(folder)));
    loaded.problems.extend(searched.into_iter().map(InputError::NothingInFolder));
    let staged = loaded.inputs.iter().any(|input| input.stage.is_some());
    anyhow::ensure!(
        stage.is_none() || staged || !loaded.problems.is_empty(),
        "--stage says the stage of shader files that are named, and none is: name the file by itself"
    );
    add_companions(&mut loaded);
    add_declaring(&mut loaded);
    Ok(loaded)
}

/// Reads files that a search has found, as a folder's, with those that they refer to. What is read of them is kept; of
/// texts that are among `before` it is that which was kept there.
pub fn load_found(paths: Vec<PathBuf>, before: &[Input]) -> Loaded {
    let mut loaded = Loaded::default();
    take(paths.into_iter().map(|path| (path, false)).collect(), &mut loaded);
    add_companions(&mut loaded);
    let before: BTreeMap<&str, &Input> = before.iter().map(|i| (i.file.name(), i)).collect();
    for input in &mut loaded.inputs {
        let same = before.get(input.file.name()).filter(|b| b.file == input.file && b.reported == input.reported);
        *input = same.map_or_else(|| input.clone().kept(), |b| (*b).clone());
    }
    loaded
}

/// Reads files into `loaded`, each once. An empty file found in a folder is passed over; one that was
/// named is an error.
fn take(wanted: Vec<(PathBuf, bool)>, loaded: &mut Loaded) {
    let identities: Vec<PathBuf> = wanted.par_iter().map(|(path, _)| identity(path)).collect();
    let mut fresh = Vec::new();
    for ((path, named), identity) in wanted.into_iter().zip(identities) {
        if let std::collections::btree_map::Entry::Vacant(entry) = loaded.names.entry(identity) {
            entry.insert(name(&path));
            fresh.push((path, named));
        }
    }
    let composer = modules::composer(&loaded.folders);
    let texts: Vec<_> = fresh.par_iter().map(|(path, _)| read(path)).collect();
    let (alone, mut unruled) = (fresh.iter().all(|(path, named)| *named && lacks_rules(path)), Vec::new());
    for ((path, named), text) in fresh.into_iter().zip(texts) {
        let language = language_of(&name(&path));
        let is_document = |file: &SourceFile| language.is_none() && is_document(file);
        let is_shader = |file: &SourceFile| match language {
            Some(Language::Shader(_)) => true,
            Some(Language::Wgsl | Language::Host | Language::Script) => false,
            None => !is_document(file),
        };
        let stage = loaded.stage.filter(|_| named).or_else(|| loaded.told.get(&path).copied());
        match text {
            Ok(Decoded { file, .. }) if stage.is_none() && language.is_none() && !is_document(&file) => match named {
                // Of a text by its name it is not clear that it is a document.
                true if has_ending(&path, DOCUMENT_EXTENSIONS.iter().filter(|e| **e != "txt")) => {
                    loaded.skipped.push(InputError::NoCode(path))
                }
                true if lacks_rules(&path) => unruled.push(path),
                true => loaded.problems.push(InputError::UnknownKind(path)),
                // Of a folder's files in languages without rules, one speaks for all.
                false if lacks_rules(&path) && unruled.is_empty() => unruled.push(path),
                false => {}
            },
            Ok(Decoded { file, .. }) if !named && language == Some(Language::Script) && is_bundle(file.text()) => {
                loaded.skipped.push(InputError::Bundle(path));
            }
            Ok(Decoded { file, form, exact }) => {
                let shares_its_ending = lacks_rules(&path);
                loaded.sources.insert(file.name().to_owned(), Candidate { path, form, exact });
                let stage = stage.filter(|_| is_shader(&file));
                let input = Input::new(file);
                let input = if named { input.named() } else { input };
                let input = match language {
                    Some(Language::Wgsl | Language::Shader(_)) => input.composed_by(composer.clone()),
                    // Stages in one file include others as a shader does; a listing in prose tells of files that need not be here.
                    None if shares_its_ending => input.composed_by(composer.clone()),
                    // Modules in its strings.
                    Some(Language::Script) => input.composed_by(composer.clone()),
                    Some(Language::Host) | None => input,
                };
                loaded.inputs.push(match stage {
                    Some(stage) => input.with_stage(stage),
                    None => input,
                });
            }
            // Most documents of a folder have nothing to do with shaders.
            Err(_) if !named && language.is_none() => {}
            Err(InputError::Empty(_)) if !named => {}
            // Folders hold the code of others as well, which nobody asked about.
            Err(error) if !named && matches!(language, Some(Language::Host | Language::Script)) => {
                loaded.skipped.push(error)
            }
            Err(error) => loaded.problems.push(error),
        }
    }
    // Who names nothing else asked for what is not there; beside other files they are passed over.
    let kind = if alone { &mut loaded.problems } else { &mut loaded.skipped };
    kind.extend(unruled.into_iter().map(InputError::NoRules));
}

/// Lines of more bytes are written by tools.
const MOST_BYTES_A_LINE: usize = 5000;

/// True for a script that a tool packed: most of it stands in lines that nobody writes. One line of data makes no bundle.
fn is_bundle(text: &str) -> bool {
    let packed: usize = text.lines().map(str::len).filter(|bytes| *bytes > MOST_BYTES_A_LINE).sum();
    2 * packed > text.len()
}

fn add_companions(loaded: &mut Loaded) {
    let mut next = 0;
    for _ in 0..MOST_COMPANION_ROUNDS {
        let wanted: BTreeSet<String> = loaded.inputs[next..].par_iter().flat_map_iter(companions).collect();
        next = loaded.inputs.len();
        for path in wanted.iter().map(PathBuf::from).filter(|p| p.is_file()) {
            // Context that cannot be read only means that less is known.
            loaded.name_of(&path);
        }
    }
}

/// Adds files of the project that have names which the named files lack, so that these are read as with their folder: what is
/// put in front of a text stands in a file of its own, and a hook before a commit names the changed files alone.
fn add_declaring(loaded: &mut Loaded) {
    if loaded.is_folder {
        return;
    }
    let project = Project::new(&loaded.inputs, &Config::default());
    let lacking = project.shaders().filter(|shader| shader.reported).flat_map(|shader| &shader.front_end);
    let lacking = lacking.filter(|error| errors::is_name(error.code)).map(|error| error.file.slice(error.span));
    let names: BTreeSet<String> = lacking.filter(|name| !name.is_empty()).map(str::to_owned).collect();
    if names.is_empty() {
        return;
    }
    let roots: BTreeSet<PathBuf> = loaded.sources.values().filter_map(|source| root_of(&source.path)).collect();
    for root in roots {
        let (found, _) = search(&root, &mut Vec::new());
        let has_name = |path: &&PathBuf| {
            let text = read(path).ok().map(|decoded| decoded.file);
            text.is_some_and(|file| names.iter().any(|name| marks::has_word(file.text(), name)))
        };
        let declaring: Vec<PathBuf> = found.par_iter().take(MOST_AROUND).filter(has_name).cloned().collect();
        for path in declaring {
            loaded.name_of(&path);
        }
    }
}

/// Files of a project that are looked through for names.
const MOST_AROUND: usize = 5000;

/// The folder of the project that a file belongs to: that of git or of a manifest, or else the one that we are in.
fn root_of(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (around, project) = disk::outwards(folder);
    let here = || around.iter().position(|folder| folder.as_os_str() == ".");
    around.get(project.or_else(here)?).cloned()
}

fn identity(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// A path as messages show it, and as rules compare it.
pub fn name(path: &Path) -> String {
    let name = path.to_string_lossy();
    let name = if std::path::MAIN_SEPARATOR == '\\' { name.replace('\\', "/") } else { name.into_owned() };
    // What is found below `.` is told as it would be named.
    match name.strip_prefix("./") {
        Some(rest) if !rest.is_empty() => rest.to_owned(),
        _ => name,
    }
}

fn read(path: &Path) -> Result<Decoded, InputError> {
    let unreadable = |source| InputError::Unreadable { path: path.to_owned(), source };
    let size = fs::metadata(path).map_err(unreadable)?.len();
    if size > MOST_BYTES {
        return Err(InputError::TooLarge { path: path.to_owned(), size });
    }
    let bytes = read_source(path).map_err(unreadable)?;
    let name = name(path);
    let decoded = decode_western(&name, &bytes)?;
    if decoded.file.text().trim().is_empty() {
        return Err(InputError::Empty(path.to_owned()));
    }
    Ok(decoded)
}

/// Files below a folder with a known ending, sorted, and with the stages that their texts say, those with another ending that
/// have the name of a shader beside them: `fire.gem` beside `fire.vert` and `fire.frag`. Hidden files and those that `.gitignore` and
/// `.ignore` name are left out, and links to folders are not followed: they could lead round in a
/// circle.
fn search(folder: &Path, problems: &mut Vec<InputError>) -> (Vec<PathBuf>, BTreeMap<PathBuf, Stage>) {
    let found: Mutex<(Vec<PathBuf>, Vec<String>, Vec<PathBuf>)> = Mutex::default();
    let walk = WalkBuilder::new(folder).require_git(false).git_global(false).build_parallel();
    walk.run(|| {
        Box::new(|entry| {
            let mut found = found.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            match entry {
                Ok(entry)
                    if (has_known_ending(entry.path()) || lacks_rules(entry.path())) && entry.path().is_file() =>
                {
                    found.0.push(entry.into_path());
                }
                Ok(entry) if entry.path().extension().is_some() && entry.path().is_file() => {
                    found.2.push(entry.into_path());
                }
                Ok(_) => {}
                Err(error) => found.1.push(error.to_string()),
            }
            WalkState::Continue
        })
    });
    let (mut files, mut errors, others) = found.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let called = |path: &Path| path.with_extension("");
    let staged = |path: &&PathBuf| Stage::from_path(&name(path)).is_some_and(|stage| stage != Stage::Library);
    let shaders: BTreeSet<PathBuf> = files.iter().filter(staged).map(|path| called(path)).collect();
    let told: BTreeMap<PathBuf, Stage> = others
        .into_iter()
        .filter(|path| shaders.contains(&called(path)))
        .filter_map(|path| Some((marks::stage(read(&path).ok()?.file.text()).ok()??, path)))
        .map(|(stage, path)| (path, stage))
        .collect();
    files.extend(told.keys().cloned());
    files.sort();
    errors.sort();
    problems.extend(errors.into_iter().map(|message| InputError::Unsearchable { path: folder.to_owned(), message }));
    (files, told)
}

/// True for a shader in a language that no rule reads.
fn lacks_rules(path: &Path) -> bool {
    has_ending(path, ["hlsl", "hlsli", "slang"].iter())
}

/// True for the endings of files that folders are searched for.
pub fn has_known_ending(path: &Path) -> bool {
    has_ending(path, known_endings())
}

fn has_ending(path: &Path, mut endings: impl Iterator<Item = &'static &'static str>) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    ending.is_some_and(|ending| endings.any(|e| *e == ending))
}
