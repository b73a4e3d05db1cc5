//! ARCHITECTURE.md says what is there, and its invariants name the tests that hold them.

use std::collections::BTreeSet;

use super::{Fault, File, expect_none, file, messages, project};

/// Folders of the project that a path in the document may start with.
const ROOTS: [&str; 12] = [
    "src/",
    "crates/",
    "benches/",
    "shaders/",
    "fixtures/",
    "tests/",
    "xtask/",
    "docs/",
    "examples/",
    ".ci/",
    ".config/",
    ".cargo/",
];

/// Folders and files that are named and missing, and folders of `src` that the code map leaves out.
fn map_faults(document: &File, files: &[File]) -> Vec<Fault> {
    let exists = |path: &str| files.iter().any(|file| file.path == path || file.is_below(&[path]));
    let mut faults = Vec::new();
    for (line, path) in code_spans(document).filter(|(_, span)| ROOTS.iter().any(|root| span.starts_with(root))) {
        if !exists(path.trim_end_matches('/')) {
            faults.push(document.fault(line, format!("`{path}` does not exist")));
        }
    }
    let (first, map) = section(document, "## Code map");
    if map.is_empty() {
        return vec![document.fault(1, "there is no section `## Code map`")];
    }
    let folders = files.iter().filter_map(|file| {
        let root = ["src/", "crates/"].into_iter().find(|root| file.path.starts_with(root))?;
        Some(format!("{root}{}/", file.path[root.len()..].split_once('/')?.0))
    });
    for folder in folders.collect::<BTreeSet<_>>() {
        if !map.iter().any(|line| line.contains(&format!("`{folder}`"))) {
            faults.push(document.fault(first, format!("the code map leaves out `{folder}`")));
        }
    }
    faults
}

/// Invariants without a number in order, without a holder, or held by a test that does not exist.
fn invariant_faults(document: &File, files: &[File]) -> Vec<Fault> {
    let (first, lines) = section(document, "## Invariants");
    let mut items: Vec<(usize, String)> = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        if line.starts_with(|c: char| c.is_ascii_digit()) {
            items.push((first + at + 1, (*line).to_owned()));
        } else if let Some((_, item)) = items.last_mut().filter(|_| line.starts_with(' ')) {
            item.push(' ');
            item.push_str(line.trim());
        }
    }
    if items.is_empty() {
        return vec![document.fault(1, "there are no numbered invariants below `## Invariants`")];
    }
    let mut faults = Vec::new();
    for (at, (line, item)) in items.iter().enumerate() {
        let number = at + 1;
        if !item.starts_with(&format!("{number}. ")) {
            faults.push(document.fault(*line, format!("this invariant should have the number {number}")));
        }
        let Some((_, holder)) = item.split_once("Held by ") else {
            faults.push(document.fault(*line, format!("invariant {number} does not say what holds it")));
            continue;
        };
        let tests: Vec<&str> = holder.split('`').skip(1).step_by(2).filter(|name| name.contains("::")).collect();
        if tests.is_empty() && !holder.starts_with("the compiler") {
            faults.push(document.fault(*line, format!("invariant {number} names no test")));
        }
        for test in tests.into_iter().filter(|test| !test_exists(test, files)) {
            faults.push(document.fault(*line, format!("invariant {number} is held by `{test}`, which does not exist")));
        }
    }
    faults
}

/// Whether `module::path::name` is a test of the library, of the tasks or of this binary, or `name::module::path::name` one
/// of a crate.
fn test_exists(test: &str, files: &[File]) -> bool {
    let mut modules: Vec<&str> = test.split("::").collect();
    let name = modules.pop().unwrap_or_default();
    // A module of tests may stand inside the file of its parent or have a file of its own.
    let inner = modules.last().is_some_and(|last| ["tests", "planted"].contains(last));
    let parents = [modules[..modules.len() - usize::from(inner)].join("/"), modules.join("/")];
    let here = ["src", "tests/it", "xtask/src"].into_iter().flat_map(|root| {
        parents.iter().flat_map(move |module| [format!("{root}/{module}.rs"), format!("{root}/{module}/mod.rs")])
    });
    let of_crate = parents.iter().flat_map(|path| {
        let (name, module) = path.split_once('/').unwrap_or((path, "lib"));
        [format!("crates/{name}/src/{module}.rs"), format!("crates/{name}/src/{module}/mod.rs")]
    });
    let places = here.chain(of_crate);
    places.into_iter().filter_map(|path| files.iter().find(|file| file.path == path)).any(|file| {
        let lines: Vec<&str> = file.text.lines().map(str::trim).collect();
        let is_test = |at: usize| lines[..at].iter().rev().take_while(|l| l.starts_with("#[")).any(|l| *l == "#[test]");
        (0..lines.len()).any(|at| lines[at].starts_with(&format!("fn {name}(")) && is_test(at))
    })
}

/// The text in single backticks with its lines, outside of fenced blocks.
fn code_spans(document: &File) -> impl Iterator<Item = (usize, &str)> {
    let mut fenced = false;
    let lines = document.text.lines().enumerate().filter(move |(_, line)| {
        let fence = line.starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    });
    lines.flat_map(|(at, line)| line.split('`').skip(1).step_by(2).map(move |span| (at + 1, span)))
}

/// The line of a heading, from 1, and the lines up to the next heading of its level.
fn section<'a>(document: &'a File, heading: &str) -> (usize, Vec<&'a str>) {
    let mut lines = document.text.lines().enumerate().skip_while(|(_, line)| *line != heading);
    let first = lines.next().map_or(1, |(at, _)| at + 1);
    (first, lines.map(|(_, line)| line).take_while(|line| !line.starts_with("## ")).collect())
}

#[test]
fn the_code_map_is_the_code() {
    let files = project();
    expect_none(&map_faults(file(&files, "ARCHITECTURE.md"), &files));
}

#[test]
fn invariants_are_held_by_tests_that_exist() {
    let files = project();
    expect_none(&invariant_faults(file(&files, "ARCHITECTURE.md"), &files));
}

#[cfg(test)]
mod planted {
    use super::*;

    fn tree() -> Vec<File> {
        let test = "#[cfg(test)]\nmod tests {\n    #[test]\n    fn holds() {}\n    fn is_no_test() {}\n}\n";
        vec![File::new("src/text/mod.rs", test), File::new("src/value/mod.rs", ""), File::new("src/main.rs", "")]
    }

    fn map(text: &str) -> Vec<Fault> {
        map_faults(&File::new("ARCHITECTURE.md", text), &tree())
    }

    fn invariants(text: &str) -> Vec<Fault> {
        invariant_faults(&File::new("ARCHITECTURE.md", &format!("## Invariants\n\n{text}")), &tree())
    }

    #[test]
    fn a_complete_map_is_fine() {
        assert!(map("## Code map\n- `src/text/` a\n- `src/value/` b\n").is_empty());
    }

    #[test]
    fn a_folder_that_the_map_leaves_out_is_reported() {
        assert_eq!(
            messages(&map("## Code map\n- `src/text/`\n## Next\n`src/value/`\n")),
            ["the code map leaves out `src/value/`"]
        );
    }

    #[test]
    fn a_path_that_does_not_exist_is_reported_at_its_line() {
        let faults = map("## Code map\n- `src/text/` `src/value/`\n- `src/valu/`\n");
        assert_eq!(faults, [File::new("ARCHITECTURE.md", "").fault(3, "`src/valu/` does not exist")]);
    }

    #[test]
    fn a_document_without_sections_is_reported() {
        assert_eq!(messages(&map("# Nothing\n")), ["there is no section `## Code map`"]);
        assert_eq!(invariants("none\n").len(), 1);
    }

    #[test]
    fn an_invariant_with_its_test_is_fine() {
        assert!(invariants("1. A. Held by\n   `text::tests::holds`.\n2. B. Held by the compiler.\n").is_empty());
    }

    #[test]
    fn an_invariant_whose_test_is_gone_is_reported() {
        for name in ["text::tests::held", "text::tests::is_no_test", "value::tests::holds"] {
            let expected = format!("invariant 1 is held by `{name}`, which does not exist");
            assert_eq!(messages(&invariants(&format!("1. A. Held by `{name}`.\n"))), [expected]);
        }
    }

    #[test]
    fn an_invariant_without_a_holder_or_out_of_order_is_reported() {
        assert_eq!(messages(&invariants("1. A.\n")), ["invariant 1 does not say what holds it"]);
        assert_eq!(messages(&invariants("1. A. Held by care.\n")), ["invariant 1 names no test"]);
        assert_eq!(
            messages(&invariants("1. A. Held by the compiler.\n3. B. Held by the compiler.\n")),
            ["this invariant should have the number 2"]
        );
    }
}
