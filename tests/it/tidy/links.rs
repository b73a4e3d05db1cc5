//! Links and paths in documents lead to files that exist, and every page of the book is in its table of contents.

use super::readme::{code, documents};
use super::{Fault, File, expect_none, file, messages, project};

/// The folder of the pages of the book.
const PAGES: &str = "docs/book/src";

/// Folders of the project that a path in a document may start with.
const ROOTS: [&str; 13] = [
    ".ci/",
    "crates/",
    "deploy/",
    "docs/",
    "editors/",
    "examples/",
    "fixtures/",
    "shaders/",
    "src/",
    "tests/",
    "upstream/",
    "web/",
    "xtask/",
];

fn exists(path: &str, files: &[File]) -> bool {
    files.iter().any(|file| file.path == path || file.is_below(&[path]))
}

/// Relative links of a document to files that do not exist. Pages of the book link to each other alone: what lies outside
/// of their folder is not part of the web site.
fn broken(document: &File, files: &[File]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (line, target) in links(document) {
        let path = resolved(&document.path, target);
        match path {
            Some(path) if document.is_below(&[PAGES]) && !path.starts_with(PAGES) => {
                faults.push(document.fault(line, format!("`{target}` is not a part of the book")));
            }
            Some(path) if exists(&path, files) => {}
            _ => faults.push(document.fault(line, format!("`{target}` does not exist"))),
        }
    }
    faults
}

/// Targets of links and pictures outside of code, with their lines; without addresses and places in the same document.
fn links(document: &File) -> Vec<(usize, &str)> {
    let mut fenced = false;
    let mut found = Vec::new();
    for (at, line) in document.text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            let targets = line.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0));
            let relative = targets.filter(|target| !target.contains("://") && !target.starts_with('#'));
            found.extend(relative.map(|target| (at + 1, target)));
        }
    }
    found
}

/// Paths of this project in the prose of a document that do not exist.
fn missing(document: &File, files: &[File]) -> Vec<Fault> {
    let spans = code(document).into_iter().filter(|(_, fenced, _)| !fenced);
    let paths = spans.filter_map(|(line, _, text)| Some((line, text.split(' ').next()?.trim_end_matches('/'))));
    let ours = paths.filter(|(_, path)| ROOTS.iter().any(|root| path.starts_with(root)));
    let gone = ours.filter(|(_, path)| !exists(path, files));
    gone.map(|(line, path)| document.fault(line, format!("`{path}` does not exist"))).collect()
}

/// The path from the root that a link of the file `from` leads to.
fn resolved(from: &str, target: &str) -> Option<String> {
    let mut parts: Vec<&str> = from.split('/').collect();
    parts.pop();
    for part in target.split('#').next()?.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            name => parts.push(name),
        }
    }
    Some(parts.join("/"))
}

/// Pages that SUMMARY.md does not list.
fn unlisted(files: &[File]) -> Vec<Fault> {
    let summary = file(files, "docs/book/src/SUMMARY.md");
    let listed: Vec<String> = links(summary).into_iter().filter_map(|(_, to)| resolved(&summary.path, to)).collect();
    let is_page = |file: &&File| file.is_below(&[PAGES]) && file.path.ends_with(".md") && file.path != summary.path;
    let pages = files.iter().filter(is_page).filter(|page| !listed.contains(&page.path));
    pages.map(|page| page.fault(1, "SUMMARY.md does not list this page")).collect()
}

#[test]
fn links_lead_to_files_that_exist() {
    let files = project();
    let is_document =
        |file: &&File| file.path.ends_with(".md") && (!file.path.contains('/') || file.is_below(&["docs", ".github"]));
    let documents: Vec<&File> = files.iter().filter(is_document).collect();
    assert!(documents.iter().map(|document| links(document).len()).sum::<usize>() > 40, "there are no links");
    let faults: Vec<Fault> = documents.iter().flat_map(|document| broken(document, &files)).collect();
    expect_none(&faults);
}

#[test]
fn paths_in_documents_exist() {
    let files = project();
    let faults: Vec<Fault> = documents(&files).iter().flat_map(|document| missing(document, &files)).collect();
    expect_none(&faults);
}

#[test]
fn the_summary_lists_every_page() {
    expect_none(&unlisted(&project()));
}

#[cfg(test)]
mod planted {
    use super::*;

    fn tree(page: &str) -> Vec<File> {
        vec![
            File::new("README.md", ""),
            File::new("docs/book/src/SUMMARY.md", "- [A](a.md)\n"),
            File::new("docs/book/src/a.md", page),
        ]
    }

    fn said(page: &str) -> Vec<String> {
        let files = tree(page);
        messages(&broken(file(&files, "docs/book/src/a.md"), &files)).into_iter().map(String::from).collect()
    }

    #[test]
    fn a_broken_link_is_reported() {
        assert_eq!(said("see [b](b.md)"), ["`b.md` does not exist"]);
        assert_eq!(said("![b](../../../../b.png)"), ["`../../../../b.png` does not exist"]);
    }

    #[test]
    fn a_link_out_of_the_book_is_reported() {
        assert_eq!(said("see [r](../../../README.md)"), ["`../../../README.md` is not a part of the book"]);
    }

    #[test]
    fn links_that_lead_somewhere_addresses_and_code_are_fine() {
        assert!(said("[a](a.md#top), [b](#b), [c](https://example.org/c.md)\n```\n[d](d.md)\n```\n").is_empty());
    }

    #[test]
    fn a_path_that_does_not_exist_is_reported() {
        let files = tree("");
        let found = |text: &str| messages(&missing(&File::new("README.md", text), &files)).join("; ");
        assert_eq!(found("`docs/books/` has it"), "`docs/books` does not exist");
        assert_eq!(found("`docs/book/src/a.md`, `docs/book/`, `report/a.md`\n```\ndocs/b.md `docs/c.md`\n```\n"), "");
    }

    #[test]
    fn a_page_that_is_not_listed_is_reported() {
        assert!(unlisted(&tree("")).is_empty());
        let mut files = tree("");
        files.push(File::new("docs/book/src/b.md", ""));
        assert_eq!(messages(&unlisted(&files)), ["SUMMARY.md does not list this page"]);
    }
}
