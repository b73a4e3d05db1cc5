//! `cargo xtask repository`: where the project is. Cargo.toml says it, and the other files that name it say the same.

use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::cargo::workspace;

/// What stands for the owner until there is one.
const UNKNOWN: &str = "OWNER";

/// Without an argument: checks that the owner is known. With an address: writes it into every file that names the project.
pub fn run(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    let workspace = workspace()?;
    let manifest = fs::read_to_string(workspace.join("Cargo.toml")).context("cannot read Cargo.toml")?;
    let old = slug(address(&manifest)?)?;
    let words: Vec<&str> = arguments.iter().filter_map(|word| word.to_str()).collect();
    match words[..] {
        [] if old.starts_with(UNKNOWN) => {
            writeln!(messages, "xtask: nobody knows where the project is: cargo xtask repository ADDRESS")?;
            Ok(1)
        }
        [] => {
            writeln!(messages, "xtask: the project is at {}", address(&manifest)?)?;
            Ok(0)
        }
        [new] => {
            let changed = write(&workspace, old, slug(new)?)?;
            writeln!(messages, "xtask: {changed} files name {}", slug(new)?)?;
            Ok(0)
        }
        _ => bail!("repository takes one address"),
    }
}

/// The address in the manifest of the workspace.
fn address(manifest: &str) -> Result<&str> {
    let line = manifest.lines().find_map(|line| line.strip_prefix("repository = \""));
    line.and_then(|rest| rest.strip_suffix('"')).context("Cargo.toml has no line `repository = \"…\"`")
}

/// Owner and name in an address.
fn slug(address: &str) -> Result<&str> {
    let slug = address.strip_prefix("https://github.com/").unwrap_or_default();
    let fits = slug.split('/').count() == 2 && slug.split('/').all(|part| !part.is_empty());
    ensure!(fits, "`{address}` is not https://github.com/OWNER/NAME");
    Ok(slug)
}

/// Replaces `old` by `new` in every file that git tracks; gives how many were changed.
fn write(workspace: &Path, old: &str, new: &str) -> Result<usize> {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(workspace).output()?;
    ensure!(listed.status.success(), "git cannot list the files");
    let mut changed = 0;
    for path in String::from_utf8(listed.stdout)?.split('\0').filter(|path| !path.is_empty()) {
        let path = workspace.join(path);
        // Links and files that are not text name nothing.
        let Ok(text) = fs::read_to_string(&path) else { continue };
        if path.is_symlink() || !text.contains(old) {
            continue;
        }
        fs::write(&path, text.replace(old, new)).with_context(|| format!("cannot write {}", path.display()))?;
        changed += 1;
    }
    Ok(changed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_address_is_read_and_others_are_refused() {
        let manifest = "[workspace.package]\nrepository = \"https://github.com/a/b\"\nhomepage = \"x\"\n";
        assert_eq!(slug(address(manifest).unwrap()).unwrap(), "a/b");
        assert!(address("[workspace.package]\n").is_err());
        for wrong in ["a/b", "https://github.com/a", "https://github.com/a/", "https://github.com/a/b/c"] {
            assert!(slug(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_address_is_written_into_every_tracked_file_that_names_the_project() {
        let folder = std::env::temp_dir().join(format!("shadercheck-repository-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("a.md"), "see https://github.com/x/y and x/y@main\n").unwrap();
        fs::write(folder.join("b.md"), "x/z\n").unwrap();
        for words in [&["init", "-q"][..], &["add", "."]] {
            assert!(Command::new("git").args(words).current_dir(&folder).status().unwrap().success());
        }
        fs::write(folder.join("untracked.md"), "x/y\n").unwrap();
        assert_eq!(write(&folder, "x/y", "acme/y").unwrap(), 1);
        let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!(read("a.md"), "see https://github.com/acme/y and acme/y@main\n");
        assert_eq!((read("b.md"), read("untracked.md")), ("x/z\n".into(), "x/y\n".into()));
        fs::remove_dir_all(&folder).unwrap();
    }
}
