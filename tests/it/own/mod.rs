//! Suites of one's own: each kind of expectation and each law with a shader that keeps it and one that
//! does not.

mod bundle;
mod defines;
mod entries;
mod expectations;
mod formats;
mod includes;
mod init;
mod known_failures;
mod laws;
mod literals;
mod macros;
pub(crate) mod schema;
mod textures;

use std::fs;

use crate::binary::{Ran, command};

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// `shadercheck check . --lane embedded` with more arguments, in a folder with these files.
fn check(files: &[(&str, &str)], more: &[&str]) -> Ran {
    let folder = folder(files);
    command(folder.path(), "check . --lane embedded").args(more).output().unwrap().into()
}

/// A suite of one function in `f.glsl` with inputs that are numbers from -2 to 2.
fn suite(inputs: &[&str], rest: &str) -> String {
    let names: Vec<String> = inputs.iter().map(|name| format!("{name:?}")).collect();
    format!(
        "suite = \"own\"\nshader = \"f.glsl\"\nstage = \"function\"\nentry = \"f\"\nsamples = 2048\n{rest}\n\
         [[inputs]]\nnames = [{}]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n",
        names.join(", ")
    )
}

/// The first finding of a run: its message, and the values of the smallest case.
fn finding(ran: &Ran) -> (String, Vec<String>) {
    let block = ran.out.split("\n\n").find(|block| block.contains("  file   ")).unwrap_or_else(|| panic!("{ran:?}"));
    let values = block.lines().filter_map(|line| {
        let (label, rest) = line.split_at_checked(13)?;
        let label = label.trim();
        let case = label.is_empty() || label == "smallest" || label == "case";
        (case && rest.contains(" = ")).then(|| rest.trim().to_owned())
    });
    (block.lines().next().unwrap().to_owned(), values.collect())
}
