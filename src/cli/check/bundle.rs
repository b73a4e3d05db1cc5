//! The files of a failing case.

use std::path::Path;

use anyhow::Context;

use super::shell_word;
use crate::cli::paths::relative;
use base::text::Shown;
use disk::fresh;
use engine::suite::run::Bundle;

/// A script that goes to the folder in which it was written before it does anything: its paths are relative to that.
fn from_anywhere(folder: &Path, script: &[u8]) -> Vec<u8> {
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    let (Ok(here), Ok(folder)) = (here, folder.canonicalize()) else { return script.to_vec() };
    let way = shell_word(&relative(&folder, &here));
    let text = String::from_utf8_lossy(script);
    text.replacen("#!/bin/sh\n", &format!("#!/bin/sh\ncd \"$(dirname \"$0\")\"/{way} || exit 2\n"), 1).into_bytes()
}

/// Writes the files of a failing case into a folder of its name.
pub(super) fn write_bundle(folder: &Path, bundle: &Bundle) -> anyhow::Result<()> {
    let folder = folder.join(&bundle.name);
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make the folder `{}`", folder.shown()))?;
    for (name, content) in &bundle.files {
        let path = folder.join(name);
        let content = if name == "reproduce.sh" { from_anywhere(&folder, content) } else { content.clone() };
        fresh::write(&path, &content).with_context(|| format!("cannot write `{}`", path.shown()))?;
    }
    Ok(())
}
