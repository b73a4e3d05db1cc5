//! Texts as git has them: `REVISION:PATH`.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use anyhow::Context as _;

use crate::cli::compose::Given;
use crate::cli::document;
use crate::cli::includes::{self, IncludedText};
use crate::cli::translate;
use syntax::Stage;

/// The text of an argument: a file, or `REVISION:PATH` of the repository that the working folder, or the path, lies in.
///
/// # Errors
/// When there is neither such a file nor such a revision, or it cannot be read; and when a file that it includes was another
/// one at that revision, since only the files of today are found.
pub(super) fn text(argument: &str, given: &Given<'_>, stage: Option<Stage>) -> anyhow::Result<IncludedText> {
    let path = Path::new(argument);
    let versioned = argument.split_once(':').filter(|(revision, path)| !revision.is_empty() && !path.is_empty());
    let mut text = match versioned {
        Some((revision, file)) if !document::file_of(path).exists() => {
            let bytes = of_revision(revision, file)?;
            let of_file = translate::decoded(file, &bytes).with_context(|| format!("of `{argument}`"))?;
            let mut text = includes::with_includes(&of_file, Path::new(file), given)?;
            unchanged(revision, file, &text)?;
            (text.name, text.given) = (argument.to_owned(), argument.to_owned());
            text
        }
        _ => includes::read_one(path, given)?,
    };
    text.stage = stage.unwrap_or(text.stage);
    Ok(text)
}

/// Refuses a text whose parts were others at its revision: together with those of today they are no version of anything.
fn unchanged(revision: &str, file: &str, text: &IncludedText) -> anyhow::Result<()> {
    let whole = &text.file;
    let starts = std::iter::once(0).chain(whole.text().match_indices('\n').map(|(at, _)| at + 1));
    let parts: BTreeSet<String> = starts.map(|at| whole.location(at).file).filter(|name| name != file).collect();
    for part in parts {
        let now = std::fs::read(&part).with_context(|| format!("cannot read `{part}`"))?;
        let changed = match of_revision(revision, &part) {
            Ok(then) => then != now,
            Err(_) => true,
        };
        anyhow::ensure!(
            !changed,
            "`{revision}:{file}` includes `{part}`, which is another one in `{revision}`; compare whole versions: \
             `git worktree add FOLDER {revision}`, and then the file in FOLDER"
        );
    }
    Ok(())
}

fn of_revision(revision: &str, file: &str) -> anyhow::Result<Vec<u8>> {
    let path = Path::new(file);
    let folder = path.parent().filter(|folder| folder.is_dir()).unwrap_or(Path::new("."));
    let name = path.file_name().context("the path of a revision names no file")?.to_string_lossy();
    // A revision must not be taken for an option.
    anyhow::ensure!(!revision.starts_with('-'), "`{revision}` is no revision of git");
    let shown = Command::new("git").arg("-C").arg(folder).args(["show", &format!("{revision}:./{name}")]).output();
    let shown = shown.with_context(|| format!("`{revision}:{file}` is a version in git, and git cannot be started"))?;
    if !shown.status.success() {
        let why = String::from_utf8_lossy(&shown.stderr);
        let why = why.lines().next().unwrap_or("it does not say why").trim_start_matches("fatal: ");
        anyhow::bail!("there is no file `{revision}:{file}`, and git has none of that version: {why}");
    }
    Ok(shown.stdout)
}
