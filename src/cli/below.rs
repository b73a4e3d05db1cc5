//! The shaders below a folder.

use std::path::{Path, PathBuf};

use anyhow::Context;
use ignore::WalkBuilder;

use base::text::Shown;
use hosts::Language;
use program::Written;
use syntax::Stage;

/// Files below a folder, sorted, as `./a.vert` without its `./`. What `.gitignore` names is left out, and so are hidden files
/// and the folders that builds make.
///
/// # Errors
/// A folder that cannot be searched.
pub fn files(root: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let walk = WalkBuilder::new(root)
        .require_git(false)
        .git_global(false)
        .filter_entry(|entry| !matches!(entry.file_name().to_str(), Some("target" | "node_modules")))
        .build();
    let mut files = Vec::new();
    for entry in walk {
        let entry = entry.with_context(|| format!("cannot search the folder `{}`", root.shown()))?;
        if entry.path().is_file() {
            files.push(entry.path().strip_prefix(".").unwrap_or(entry.path()).to_owned());
        }
    }
    files.sort();
    Ok(files)
}

/// The stage of a shader by its ending; none for a file that is none.
pub fn stage_of(path: &Path) -> Option<Stage> {
    let name = path.to_string_lossy();
    Stage::from_path(&name).or_else(|| (Written::of_path(&name) != Written::Glsl).then_some(Stage::Library))
}

/// The files that are named, and for each folder the shaders below it that `wanted` takes. Whether any was a folder.
///
/// # Errors
/// A folder without such a shader.
pub fn shaders(paths: &[PathBuf], wanted: fn(&Path) -> bool) -> anyhow::Result<(Vec<PathBuf>, bool)> {
    search(paths, &|file| stage_of(file).is_some() && wanted(file))
}

/// The same, and for each folder the files of host code that have shaders in their strings.
///
/// # Errors
/// As of [`shaders`].
pub fn shaders_and_hosts(paths: &[PathBuf]) -> anyhow::Result<(Vec<PathBuf>, bool)> {
    search(paths, &|file| stage_of(file).is_some() || has_shaders(file))
}

/// True for a file of host code with a shader in it. Most have none of the words that no whole shader does without.
fn has_shaders(path: &Path) -> bool {
    const MARKS: [&str; 5] = ["void main", "@vertex", "@fragment", "@compute", "/* glsl */"];
    let name = path.to_string_lossy();
    let is_host = matches!(hosts::language_of(&name), Some(Language::Host | Language::Script));
    let small = || path.metadata().is_ok_and(|data| data.len() <= LARGEST);
    if !is_host || !small() {
        return false;
    }
    let Ok(file) = super::translate::read(path) else { return false };
    MARKS.iter().any(|mark| file.text().contains(mark)) && !super::document::runnable(&file, path).is_empty()
}

/// Bytes of a file of host code that is looked through: what tools write is longer.
const LARGEST: u64 = 1 << 20;

fn search(paths: &[PathBuf], wanted: &dyn Fn(&Path) -> bool) -> anyhow::Result<(Vec<PathBuf>, bool)> {
    let (mut all, mut searched) = (Vec::new(), false);
    for path in paths {
        if !path.is_dir() {
            all.push(path.clone());
            continue;
        }
        searched = true;
        let before = all.len();
        all.extend(files(path)?.into_iter().filter(|file| wanted(file)));
        anyhow::ensure!(all.len() > before, "{}", none_in(path));
    }
    Ok((all, searched))
}

/// What is wrong with a folder without shaders.
pub fn none_in(folder: &Path) -> String {
    format!(
        "`{}` holds no shader; the extension gives the stage: .vert, .geom, .frag, .comp, .glsl for a library, .wgsl",
        folder.shown()
    )
}
