//! Shaders of documents and of host code, for commands that run them: `chapter.md`, or `chapter.md:34` for the one at
//! that line.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use anyhow::Context as _;

use base::text::{Shown, SourceFile};
use disk::{Budget, plain_path};
use hosts::document::{Printed, runnable_shaders};
use hosts::script::filled::candidates;
use hosts::{Language, language_of};

/// The shaders that a path means; none when it names a file that is one shader.
///
/// # Errors
/// When the file cannot be read, host code holds no whole shader, or none stands at the line.
pub fn shaders(path: &Path) -> anyhow::Result<Option<Vec<Printed>>> {
    if path.is_file() {
        let file = super::translate::read(path)?;
        let all = runnable(&file, path);
        let is_host = matches!(language_of(file.name()), Some(Language::Host | Language::Script));
        anyhow::ensure!(
            !is_host || !all.is_empty(),
            "`{}` holds no whole shader; name a shader file, or state with --stage that this is one",
            path.shown()
        );
        return Ok((!all.is_empty()).then_some(all));
    }
    let Some((document, line)) = at_line(path) else { return Ok(None) };
    let all = runnable(&super::translate::read(&document)?, &document);
    let lines: Vec<String> = all.iter().map(|s| s.lines.start().to_string()).collect();
    let there = all.into_iter().filter(|s| s.lines.contains(&line)).min_by_key(|s| s.lines.end() - s.lines.start());
    let there = there.with_context(|| match lines.as_slice() {
        [] => format!("`{}` holds no whole shader", document.shown()),
        _ => format!(
            "no whole shader stands at line {line} of `{}`; shaders begin at {}",
            document.shown(),
            lines.join(", ")
        ),
    })?;
    Ok(Some(vec![there]))
}

/// True for a file of statements, which its host puts into a function.
///
/// # Errors
/// When the file cannot be read.
pub fn is_of_statements(path: &Path) -> anyhow::Result<bool> {
    Ok(shaders(path)?.is_some_and(|all| matches!(&all[..], [only] if only.part)))
}

/// The shaders of a text, with what host code fills in. Files that it imports are looked for beside it.
pub fn runnable(file: &SourceFile, path: &Path) -> Vec<Printed> {
    let mut budget = Budget::default();
    let mut paths = HashMap::from([(file.name().to_owned(), path.to_owned())]);
    runnable_shaders(file, &mut |from, import| {
        let folder = paths.get(from)?.parent()?.to_owned();
        let found = imported(&folder.join(import))?;
        let file = budget.read(&found)?;
        paths.insert(file.name().to_owned(), found);
        Some(file)
    })
}

/// The file that an import means.
fn imported(path: &Path) -> Option<PathBuf> {
    let path = plain_path(path).to_str()?.to_owned();
    candidates(&path).into_iter().map(PathBuf::from).find(|path| path.is_file())
}

/// The one shader that a path means, for commands that take one.
///
/// # Errors
/// When it cannot be read, or is a document with several shaders.
pub fn shader(path: &Path) -> anyhow::Result<SourceFile> {
    let Some(all) = shaders(path)? else { return super::translate::read(path) };
    let mut all = whole(all);
    let lines: Vec<String> = all.iter().map(|s| s.lines.start().to_string()).collect();
    match (all.pop(), all.is_empty()) {
        (Some(only), true) => Ok(only.file),
        _ => anyhow::bail!(
            "`{0}` holds several shaders; name the line of one: `{0}:{1}` (they begin at {2})",
            path.shown(),
            lines.first().map_or("LINE", String::as_str),
            lines.join(", ")
        ),
    }
}

/// Without the strings that a host puts into others, where there is anything else.
pub fn whole(mut all: Vec<Printed>) -> Vec<Printed> {
    if all.iter().any(|shader| !shader.part) {
        all.retain(|shader| !shader.part);
    }
    all
}

/// The file that a path means, with a line of it or without.
pub fn file_of(path: &Path) -> PathBuf {
    if path.is_file() {
        return path.to_owned();
    }
    at_line(path).map_or_else(|| path.to_owned(), |(document, _)| document)
}

/// A document and a line of it.
fn at_line(path: &Path) -> Option<(PathBuf, usize)> {
    let text = path.to_str()?;
    let (document, line) = text.rsplit_once(':')?;
    let document = PathBuf::from(document);
    document.is_file().then_some((document, line.parse().ok()?))
}
