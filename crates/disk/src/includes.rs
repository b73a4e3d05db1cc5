//! Where the files lie that `#include` names.

use std::collections::HashMap;
use std::io::{Error, ErrorKind};
use std::path::{Component, Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::elsewhere::{plain, refusal};
use crate::modules::{ancestors, below, outwards};
use crate::read_source;
use base::text::{Shown, SourceFile, decode};
use syntax::include::Wanted;

/// The folders around a file up to that of its project; where nothing shows a project, up to the one that we are in. With the
/// last one, unless neither is known.
fn below_here(folder: &Path) -> (Vec<PathBuf>, Option<PathBuf>) {
    let (mut found, project) = outwards(folder);
    let here = || found.iter().position(|folder| folder.as_os_str() == ".");
    match project.or_else(here) {
        Some(last) => found.truncate(last + 1),
        None => return (ancestors(folder), None),
    }
    let last = found.last().cloned();
    (found, last)
}

/// True for a file of the project, but for what it hides: `.git` and `.env` hold what no message may quote.
fn is_of(project: &Path, path: &Path) -> bool {
    let shown = |part: Component<'_>| !part.as_os_str().to_string_lossy().starts_with('.');
    let (Ok(project), Ok(path)) = (project.canonicalize(), path.canonicalize()) else { return false };
    path.strip_prefix(project).is_ok_and(|rest| rest.components().all(shown))
}

/// True for a text in which a line begins as one of a shader does: a key and a list of passwords have none.
fn has_code(bytes: &[u8]) -> bool {
    let begins = |line: &str| {
        let word = line.trim_start().split(|c: char| !c.is_ascii_alphanumeric() && c != '#').next().unwrap_or("");
        ["#define", "#ifdef", "#ifndef", "#include", "struct"].contains(&word) || syntax::is_keyword(word)
    };
    String::from_utf8_lossy(bytes).lines().any(begins)
}

/// What is said where no file lies.
const ABSENT: [ErrorKind; 3] = [ErrorKind::NotFound, ErrorKind::NotADirectory, ErrorKind::IsADirectory];

/// The file that an `#include` asks for; none where there is none. One by `"path"` is looked for beside the file that asks
/// first, and each in the folders, and then in those around the file, and in the whole project at last. One that lies in none
/// of `within` is read where it is a shader by its ending, or of the same project and holds code.
///
/// # Errors
/// Why a file is not read that is there.
pub fn included(wanted: &Wanted, folders: &[PathBuf], within: &[&Path]) -> Result<Option<SourceFile>, String> {
    let own = Path::new(wanted.from.name()).parent();
    let beside = own.filter(|_| wanted.quoted).map(Path::to_owned);
    // A path from the root is one of the virtual file system of ARB_shading_language_include.
    let path = wanted.path.trim_start_matches('/');
    // Hosts that join the texts name files from the folder of all shaders, which is one around them.
    let here = Path::new(".");
    let from = own.map(|folder| if folder.as_os_str().is_empty() { here } else { folder });
    let (around, project) = from.map(below_here).unwrap_or_default();
    let around = around.into_iter().skip(usize::from(wanted.quoted));
    let read = |path: &Path| {
        let bytes = read_source(path)?;
        let own = || project.as_ref().is_some_and(|project| is_of(project, path)) && has_code(&bytes);
        match refusal(path, within).filter(|_| !own()) {
            Some(why) => Err(Error::new(ErrorKind::InvalidInput, why)),
            None => Ok(bytes),
        }
    };
    for folder in beside.iter().cloned().chain(folders.iter().cloned()).chain(around) {
        let path = if folder.as_os_str().is_empty() { PathBuf::from(path) } else { folder.join(path) };
        match read(&path) {
            Ok(bytes) => return decode(&plain(&path), &bytes).map(|d| Some(d.file)).map_err(|e| e.to_string()),
            // `<common>` is a name of the host, whatever folder has it.
            Err(error) if ABSENT.contains(&error.kind()) => {}
            Err(error) => return Err(format!("{}: {error}", path.shown())),
        }
    }
    let only = project.as_deref().and_then(|project| only_one(project, path));
    Ok(only.and_then(|path| decode(&plain(&path), &read(&path).ok()?).ok()).map(|decoded| decoded.file))
}

/// How long a list of files is taken for what lies there, at least; and so many times as long as it took to make.
const FRESH: Duration = Duration::from_secs(4);
const TIMES: u32 = 50;

/// Folders and the file that the end of a path has at least, where its beginning is a name of the host: `engine://`, `@core/`.
const LEAST: usize = 3;

/// The file of a project whose path ends like this, where no other does: a build file or the host states the folder.
pub(crate) fn only_one(project: &Path, named: &str) -> Option<PathBuf> {
    let path = named.split_once("://").map_or(named, |(_, path)| path);
    let mut wanted = Path::new(path.trim_start_matches(['@', '/']));
    let of_host = named.len() != wanted.as_os_str().len();
    let mut found = ending_so(project, wanted);
    while found.is_empty() && of_host && wanted.components().count() > LEAST {
        let mut rest = wanted.components();
        rest.next();
        wanted = rest.as_path();
        found = ending_so(project, wanted);
    }
    if let [only] = &found[..] { Some(only.clone()) } else { None }
}

/// The files of a project, in a list that is made now and then.
struct Listed {
    at: Instant,
    cost: Duration,
    files: Vec<PathBuf>,
}

impl Listed {
    fn new(project: &Path) -> Self {
        let at = Instant::now();
        let files = below(project, &|path| path.extension().is_some());
        Self { at, cost: at.elapsed(), files }
    }
}

/// The first two files of a project whose paths end so.
fn ending_so(project: &Path, wanted: &Path) -> Vec<PathBuf> {
    static LISTS: LazyLock<Mutex<HashMap<PathBuf, Listed>>> = LazyLock::new(Mutex::default);
    let plain = wanted.components().all(|part| matches!(part, Component::Normal(_)));
    if !plain || wanted.extension().is_none() {
        return Vec::new();
    }
    let mut lists = LISTS.lock().unwrap_or_else(PoisonError::into_inner);
    let list = lists.entry(project.to_owned()).or_insert_with(|| Listed::new(project));
    if list.at.elapsed() > FRESH.max(list.cost * TIMES) {
        *list = Listed::new(project);
    }
    list.files.iter().filter(|path| path.ends_with(wanted)).take(2).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::Span;

    #[test]
    fn a_file_of_the_project_is_read_whatever_its_ending_and_what_is_hidden_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir_all(at(".git")).unwrap();
        std::fs::create_dir_all(at("shaders/common")).unwrap();
        for file in ["shaders/a.settings", "shaders/.env", ".git/config", "b.sh"] {
            std::fs::write(at(file), "const int A = 1;\n").unwrap();
        }
        let of = |path: &str| {
            let from = SourceFile::new(at("shaders/programs/a.frag").display().to_string(), "");
            let wanted = Wanted { from, path: path.to_owned(), quoted: true, import: false, span: Span::at(0) };
            included(&wanted, &[], &[&at("shaders/programs")])
        };
        std::fs::create_dir_all(at("shaders/programs")).unwrap();
        for path in ["/a.settings", "../a.settings", "../../b.sh"] {
            assert!(of(path).is_ok_and(|found| found.is_some()), "{path}");
        }
        std::fs::write(at("shaders/secret.key"), "-----BEGIN PRIVATE KEY-----\nMIIE\n").unwrap();
        for path in ["../.env", "../../.git/config", "../secret.key"] {
            assert!(of(path).is_err_and(|why| why.contains("its ending")), "{path}");
        }
        // The only one of the project that ends so; of two neither is meant.
        std::fs::create_dir_all(at("lib/one")).unwrap();
        std::fs::create_dir_all(at("lib/two")).unwrap();
        for file in ["lib/one/noise.glsl", "lib/one/wind.glsl", "lib/two/wind.glsl"] {
            std::fs::write(at(file), "const int A = 1;\n").unwrap();
        }
        std::fs::create_dir_all(at("other")).unwrap();
        std::fs::write(at("other/only.key"), "-----BEGIN PRIVATE KEY-----\nMIIE\n").unwrap();
        for path in ["secret.key", "shaders/secret.key", "config", "only.key"] {
            assert!(!of(path).is_ok_and(|found| found.is_some()), "{path}");
        }
        for (path, found) in
            [("engine://lib/one/noise.glsl", true), ("@core/lib/one/noise.glsl", true), ("lib/three/noise.glsl", false)]
        {
            assert_eq!(of(path).unwrap().is_some(), found, "{path}");
        }
        let found = ["noise.glsl", "one/noise.glsl", "wind.glsl", "two/wind.glsl", "two/noise.glsl"];
        assert_eq!(found.map(|path| of(path).unwrap().is_some()), [true, true, false, true, false]);
        // A folder is no file; hosts have names such as `common`.
        assert!(of("/common").is_ok_and(|found| found.is_none()));
    }
}
