//! Where the files lie that `#include` names.

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use crate::elsewhere::{plain, refusal};
use crate::modules::{ancestors, outwards};
use crate::read_source;
use base::text::{Shown, SourceFile, decode};
use syntax::include::Wanted;

/// The folders around a file up to that of its project; where nothing shows a project, up to the one that we are in.
fn below_here(folder: &Path) -> Vec<PathBuf> {
    let (mut found, project) = outwards(folder);
    let here = || found.iter().position(|folder| folder.as_os_str() == ".");
    match project.or_else(here) {
        Some(last) => found.truncate(last + 1),
        None => return ancestors(folder),
    }
    found
}

/// The file that an `#include` asks for; none where there is none. One by `"path"` is looked for beside the file that asks
/// first, and each in the folders, and then in those around the file. One that lies in none of `within` is read where it is a
/// shader by its ending.
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
    let around = from.into_iter().flat_map(below_here).skip(usize::from(wanted.quoted));
    for folder in beside.iter().cloned().chain(folders.iter().cloned()).chain(around) {
        let path = if folder.as_os_str().is_empty() { PathBuf::from(path) } else { folder.join(path) };
        let refusal = || refusal(&path, within).map(|why| Error::new(ErrorKind::InvalidInput, why));
        match read_source(&path).and_then(|bytes| refusal().map_or(Ok(bytes), Err)) {
            Ok(bytes) => return decode(&plain(&path), &bytes).map(|d| Some(d.file)).map_err(|e| e.to_string()),
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {}
            Err(error) => return Err(format!("{}: {error}", path.shown())),
        }
    }
    Ok(None)
}
