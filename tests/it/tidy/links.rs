//! Links between documents lead to files that exist, and every page of the book is in its table of contents.

use super::{Fault, File, expect_none, file, messages, project};

/// The folder of the pages of the book.
const PAGES: &str = "docs/book/src";

/// Relative links of a document to files that do not exist. Pages of the book link to each other alone: what lies outside
/// of their folder is not part of the web site.
fn broken(document: &File, files: &[File]) -> Vec<Fault> {
    let exists = |path: &str| files.iter().any(|file| file.path == path || file.is_below(&[path]));
    let mut faults = Vec::new();
    for (line, target) in links(document) {
        let path = resolved(&document.path, target);
        match path {
            Some(path) if document.is_below(&[PAGES]) && !path.starts_with(PAGES) => {
                faults.push(document.fault(line, format!("`{target}` is not a part of the book")));
            }
            Some(path) if exists(&path) => {}
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
    fn a_page_that_is_not_listed_is_reported() {
        assert!(unlisted(&tree("")).is_empty());
        let mut files = tree("");
        files.push(File::new("docs/book/src/b.md", ""));
        assert_eq!(messages(&unlisted(&files)), ["SUMMARY.md does not list this page"]);
    }
}
