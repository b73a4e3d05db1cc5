//! What a run tells services that show findings beside the lines of a change, whatever command it is of.

mod github;
mod gitlab;
mod junit;
mod markdown;
mod rdjson;
mod sarif;

use std::path::{Component, Path, PathBuf};

use base::diagnostic::{Diagnostic, Lang, Severity};

/// A run as services see it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Run {
    /// What came of it, in a word or two behind the name of the program: `passed`, `fuzz failed`.
    pub outcome: String,
    /// Counts and tables in Markdown, above the findings.
    pub summary: String,
    /// What else the page has in Markdown, below the findings.
    pub rest: String,
    /// Everything that is wrong, once.
    pub items: Vec<Item>,
    /// What was tested, in the order of the run.
    pub tests: Vec<Test>,
}

/// Something that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// Error or warning.
    pub severity: Severity,
    /// What it is about: the kind of a finding, or the code of an error.
    pub code: String,
    /// What the code stands for, in a sentence.
    pub about: &'static str,
    /// What is wrong, in a line.
    pub message: String,
    /// All that is known, over several lines, as people read it.
    pub details: String,
    /// The file where it shows.
    pub file: String,
    /// Line and column in it, from 1; none for a finding about the whole file.
    pub at: Option<(usize, usize)>,
    /// What stays the same from run to run while the fault is there.
    pub identity: String,
}

/// What the code of an error of the front end stands for.
pub const BROKEN: &str = "The shader does not compile.";

impl Item {
    /// An error or warning of the front end.
    pub fn of(found: &Diagnostic) -> Self {
        let at = found.file.position(found.span.start);
        let message = found.message.to_string();
        Self {
            severity: found.severity,
            code: found.code.0.to_owned(),
            about: BROKEN,
            details: crate::diagnostics::text(found, Lang::En, false),
            file: found.file.name().to_owned(),
            at: Some((at.line, at.column)),
            identity: message.clone(),
            message,
        }
    }
}

/// One test of a run: a suite on a lane, a function, a pair of functions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Test {
    /// What it is grouped by: a lane, or a file.
    pub group: String,
    /// Its name in the group.
    pub name: String,
    /// The file that is tested.
    pub file: String,
    /// What came of it.
    pub status: Status,
    /// Counts, in a line.
    pub output: String,
    /// Warnings with all that is known of them.
    pub warnings: Vec<String>,
    /// Facts by name.
    pub properties: Vec<(String, String)>,
}

/// What came of a test.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Status {
    /// Nothing is wrong.
    #[default]
    Passed,
    /// It did not run, or its failure is expected.
    Skipped(String),
    /// Something is wrong.
    Failed(Vec<Item>),
    /// It could not be made.
    Broken(Vec<Item>),
}

/// A format for services.
#[derive(Debug)]
pub struct Format {
    /// Name, as `--format` takes it.
    pub name: &'static str,
    /// What it is for, in a few words.
    pub summary: &'static str,
    /// The file that holds it in a folder of reports.
    pub file: &'static str,
    /// The whole report of a run.
    ///
    /// # Errors
    /// Why the format cannot hold it.
    pub write: fn(&Run) -> Result<String, String>,
}

/// All formats for services.
pub const FORMATS: &[&Format] =
    &[&junit::FORMAT, &sarif::FORMAT, &github::FORMAT, &gitlab::FORMAT, &rdjson::FORMAT, &markdown::FORMAT];

/// The format of this name.
pub fn by_name(name: &str) -> Option<&'static Format> {
    FORMATS.iter().copied().find(|format| format.name == name)
}

/// File, line and column of `name:line:column`; the whole text, and no place in it, where it is no such place.
pub fn place(at: &str) -> (&str, Option<(usize, usize)>) {
    let mut parts = at.rsplitn(3, ':');
    let number = |part: Option<&str>| part.and_then(|part| part.parse().ok());
    let (column, line) = (number(parts.next()), number(parts.next()));
    match (parts.next(), line, column) {
        (Some(file), Some(line), Some(column)) => (file, Some((line, column))),
        _ => (at, None),
    }
}

/// A path as services want it: from the root of the repository on, without `./`.
fn relative(file: &str) -> String {
    let plain: PathBuf = Path::new(file).components().filter(|part| !matches!(part, Component::CurDir)).collect();
    plain.display().to_string().replace('\\', "/")
}

/// A text that Markdown takes as it is.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_have_no_dots() {
        assert_eq!(relative("./a/./b.vert"), "a/b.vert");
        assert_eq!(relative("/a/b.vert"), "/a/b.vert");
    }

    #[test]
    fn a_place_has_a_file_a_line_and_a_column() {
        assert_eq!(place("a/b.glsl:12:7"), ("a/b.glsl", Some((12, 7))));
        assert_eq!(place("C:/a.glsl:1:2"), ("C:/a.glsl", Some((1, 2))));
        assert_eq!(place("a.glsl"), ("a.glsl", None));
    }

    #[test]
    fn every_format_has_the_findings_of_a_run() {
        let item = Item {
            severity: Severity::Error,
            code: "no-value".to_owned(),
            about: "An output has no value.",
            message: "f: `x / 0` has no value".to_owned(),
            details: "f: `x / 0` has no value\n  smallest   x = 1 < 2".to_owned(),
            file: "./a/b.glsl".to_owned(),
            at: Some((3, 7)),
            identity: "f no-value".to_owned(),
        };
        let warning = Item { severity: Severity::Warning, code: "lossy".to_owned(), at: None, ..item.clone() };
        let test = |name: &str, status| Test {
            group: "a/b.glsl".to_owned(),
            name: name.to_owned(),
            file: item.file.clone(),
            status,
            ..Test::default()
        };
        let run = Run {
            outcome: "fuzz failed".to_owned(),
            summary: "1 function run.\n".to_owned(),
            tests: vec![
                test("f", Status::Failed(vec![item.clone()])),
                test("g", Status::Skipped("no room".to_owned())),
                test("h", Status::Passed),
            ],
            items: vec![item, warning],
            ..Run::default()
        };
        for format in FORMATS {
            let written = (format.write)(&run).unwrap();
            let has = ["x / 0", "a/b.glsl", "no-value"].map(|part| written.contains(part));
            // Markdown names neither files nor codes.
            let expected = if format.name == "markdown" { [true, false, false] } else { [true; 3] };
            assert_eq!(has, expected, "{}: {written}", format.name);
            assert!((format.write)(&Run::default()).is_ok(), "{}", format.name);
            assert_eq!(by_name(format.name).unwrap().file, format.file);
        }
    }
}
