//! The links of a web site that was built.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result};

/// Links of the pages of a folder that lead to no file of it, or to no place on a page. Addresses elsewhere are not asked for.
///
/// # Errors
/// When the folder cannot be read.
pub fn broken(folder: &Path) -> Result<Vec<String>> {
    let mut files = BTreeSet::new();
    list(folder, Path::new(""), &mut files)?;
    let mut pages = BTreeMap::new();
    for file in files.iter().filter(|file| file.extension().is_some_and(|ending| ending == "html")) {
        let text = fs::read_to_string(folder.join(file)).with_context(|| format!("cannot read {}", file.display()))?;
        pages.insert(file.clone(), text);
    }
    let mut faults = Vec::new();
    for (page, text) in &pages {
        for target in attributes(text, &[" href=\"", " src=\""]) {
            // A page for what is not found lies nowhere in particular.
            let elsewhere = target.contains(':') || target.starts_with("//") || target.is_empty();
            if elsewhere || page == Path::new("404.html") {
                continue;
            }
            let (path, place) = target.split_once('#').unwrap_or((target, ""));
            let path = path.split('?').next().unwrap_or_default();
            let to = if path.is_empty() { page.clone() } else { resolved(page, path) };
            let there = files.contains(&to) && (place.is_empty() || has_place(&pages, &to, place));
            if !there {
                faults.push(format!("{}: `{target}` leads nowhere", page.display()));
            }
        }
    }
    faults.sort();
    faults.dedup();
    Ok(faults)
}

fn list(folder: &Path, below: &Path, files: &mut BTreeSet<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder.join(below)).with_context(|| format!("cannot list {}", folder.display()))? {
        let entry = entry?;
        let path = below.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            list(folder, &path, files)?;
        } else {
            files.insert(path);
        }
    }
    Ok(())
}

/// Values of attributes.
fn attributes<'t>(text: &'t str, names: &[&str]) -> Vec<&'t str> {
    let values =
        |name: &&str| text.split(*name).skip(1).filter_map(|rest| Some(rest.split_once('"')?.0)).collect::<Vec<_>>();
    names.iter().flat_map(values).collect()
}

fn has_place(pages: &BTreeMap<PathBuf, String>, page: &Path, place: &str) -> bool {
    pages.get(page).is_none_or(|text| attributes(text, &[" id=\"", " name=\""]).contains(&place))
}

/// The path from the root of the site that a link of a page leads to.
fn resolved(page: &Path, target: &str) -> PathBuf {
    let mut path = page.parent().unwrap_or(Path::new("")).to_owned();
    for part in Path::new(target).components() {
        match part {
            Component::ParentDir => drop(path.pop()),
            Component::Normal(name) => path.push(name),
            Component::RootDir => path = PathBuf::new(),
            Component::CurDir | Component::Prefix(_) => {}
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_to_files_and_places_that_are_not_there_are_reported() {
        let folder = std::env::temp_dir().join(format!("shadercheck-site-{}", std::process::id()));
        fs::create_dir_all(folder.join("rules")).unwrap();
        let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
        write("a.png", "");
        write(
            "index.html",
            "<a href=\"rules/b.html#here\"></a><a href=\"#none\"></a><img src=\"a.png\"><a href=\"https://x.y/z\">",
        );
        write(
            "rules/b.html",
            "<h1 id=\"here\"></h1><a href=\"../index.html\"></a><a href=\"c.html\"></a><a href=\"../index.html#x\">",
        );
        let faults = broken(&folder).unwrap();
        fs::remove_dir_all(&folder).unwrap();
        assert_eq!(
            faults,
            [
                "index.html: `#none` leads nowhere",
                "rules/b.html: `../index.html#x` leads nowhere",
                "rules/b.html: `c.html` leads nowhere"
            ]
        );
    }
}
