//! What the project's text must not say.

use super::{Fault, File, expect_none, messages, project};

/// Folders of one machine. Written in two parts so that this file passes its own check.
const FOLDERS: [&str; 5] =
    [concat!("/ro", "ot/"), concat!("/ho", "me/"), concat!("/wo", "rk/"), concat!("/Us", "ers/"), concat!("/t", "mp/")];

/// Words that belong to a workshop and not to a product.
const WORDS: [&str; 6] = [
    concat!("Clau", "de"),
    concat!("Anthro", "pic"),
    concat!("agent ", "session"),
    concat!("TO", "DO"),
    concat!("FIX", "ME"),
    concat!("XX", "X"),
];

fn unwanted(files: &[File]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for file in files {
        for (at, line) in file.text.lines().enumerate() {
            for folder in FOLDERS.iter().filter(|folder| has_folder(line, folder)) {
                faults.push(file.fault(at + 1, format!("`{folder}` is a folder of one machine")));
            }
            for word in WORDS.iter().filter(|word| has_word(line, word)) {
                faults.push(file.fault(at + 1, format!("`{word}` does not belong in the project")));
            }
        }
    }
    faults
}

/// The folder starts a path: `a/work/b` is relative and `https://host/work/` is an address.
fn has_folder(line: &str, folder: &str) -> bool {
    let starts_path = |before: &str| !before.ends_with(|c: char| c.is_alphanumeric() || "._-*})>".contains(c));
    line.match_indices(folder).any(|(at, _)| starts_path(&line[..at]))
}

/// The word stands alone.
fn has_word(line: &str, word: &str) -> bool {
    let alone = |at: usize| {
        let part_of_a_word = |c: char| c.is_alphanumeric() || c == '_';
        !line[..at].ends_with(part_of_a_word) && !line[at + word.len()..].starts_with(part_of_a_word)
    };
    line.match_indices(word).any(|(at, _)| alone(at))
}

#[test]
fn the_text_names_no_machine_and_no_workshop() {
    expect_none(&unwanted(&project()));
}

#[test]
fn planted_folders_and_words_are_reported() {
    for folder in FOLDERS {
        let file = File::new("README.md", &format!("ok\nsee `{folder}project`"));
        let faults = unwanted(std::slice::from_ref(&file));
        assert_eq!(faults, [file.fault(2, format!("`{folder}` is a folder of one machine"))]);
    }
    for word in WORDS {
        let faults = unwanted(&[File::new("src/a.rs", &format!("// {word}: later"))]);
        assert_eq!(messages(&faults), [format!("`{word}` does not belong in the project")]);
    }
}

#[test]
fn relative_paths_addresses_and_longer_words_are_fine() {
    for folder in FOLDERS {
        for line in [format!("a{folder}b"), format!("https://host.org{folder}b"), format!("${{TMPDIR}}{folder}")] {
            assert!(!has_folder(&line, folder), "{line}");
        }
    }
    let longer = format!("{}S {}_LIST", WORDS[3], WORDS[4]);
    assert!(unwanted(&[File::new("src/a.rs", &longer)]).is_empty());
}
