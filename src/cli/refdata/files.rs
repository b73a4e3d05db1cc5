//! Reference files and folders of their parts.

use std::fs::File;
use std::path::{Path, PathBuf};

use anyhow::Context;

use base::text::Shown;
use refdata::Document;
use refdata::read::{Blocks, Chain, InputFormat, ReadError, Sequence, Shared};

/// The format of a file by its ending.
pub fn source(path: &Path) -> anyhow::Result<InputFormat> {
    let name = path.shown();
    InputFormat::of_name(&name)
        .with_context(|| format!("the ending of `{name}` names no format; there are npz, parquet, csv, json and raw"))
}

/// Opens a file.
pub fn open(path: &Path) -> anyhow::Result<Shared> {
    let failed = || format!("cannot read `{}`", path.shown());
    let file = File::open(path).with_context(failed)?;
    anyhow::ensure!(!file.metadata().with_context(failed)?.is_dir(), "cannot read `{}`: it is a folder", path.shown());
    Shared::new(Box::new(file)).with_context(failed)
}

/// Opens a reference file.
pub fn blocks(path: &Path) -> anyhow::Result<Blocks> {
    Blocks::open(source(path)?, &open(path)?).with_context(|| format!("`{}`", path.shown()))
}

/// The files of a folder that are reference files by their ending, in the order of their names.
pub fn parts(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let failed = || format!("cannot read the folder `{}`", folder.shown());
    let mut paths: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(failed)? {
        let path = entry.with_context(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // What is being written has a name that begins with a point.
        let is_part =
            !name.starts_with('.') && InputFormat::of_name(&name).is_some_and(|source| source != InputFormat::Raw);
        if is_part && path.is_file() {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Files with their documents.
pub fn documents(paths: &[PathBuf]) -> anyhow::Result<Vec<(String, Document)>> {
    paths.iter().map(|path| Ok((path.display().to_string(), blocks(path)?.document().clone()))).collect()
}

/// The files as one data set.
///
/// # Errors
/// When one of them is missing, doubled, or of another run.
pub fn chain<'p>(paths: &'p [PathBuf], documents: &[(String, Document)]) -> Result<Chain<'p>, ReadError> {
    let open = |part: usize| {
        let path: &PathBuf = &paths[part];
        // The error of a file names it.
        blocks(path).map_err(|error| ReadError::Damaged(format!("{error:#}")))
    };
    Chain::new(documents, Box::new(open))
}
