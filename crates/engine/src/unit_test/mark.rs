//! Which tests a file has, and the file with a function for each of them.

use base::text::{SourceFile, Span};
use program::Written;
use syntax::Stage;

use super::{comment, module};

/// How names begin that are put into a text.
pub(super) const OWN: &str = "sc_";
/// How the functions are called that run tests.
const ENTRY: &str = "sc_test_";
/// Their parameter: the number of the expectation that is written down, from 0.
pub(super) const WANTED: &str = "sc_wanted_one";

/// A file with its tests made functions.
#[derive(Clone, Debug)]
pub struct Marked {
    /// The text, which leads back to the author's.
    pub file: SourceFile,
    /// The tests in the order of the text.
    pub tests: Vec<UnitTest>,
    /// The calls of assertions in the author's file, by the number that each records.
    pub sites: Vec<Span>,
}

/// A test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitTest {
    /// What its author calls it: a name, or the line of a comment.
    pub name: String,
    /// The function that runs it.
    pub entry: String,
    /// The function that holds it.
    pub function: String,
    /// Its name in the author's file, or the word `@test`.
    pub span: Span,
    /// Why it cannot be run, where its form alone says so.
    pub refused: Option<String>,
}

/// The tests of a file; none where it has none, or is in a language without such tests.
pub fn mark(file: &SourceFile, stage: Stage) -> Option<Marked> {
    if !file.text().contains("@test") && !file.text().contains("@snapshot") {
        return None;
    }
    let marked = match Written::of(file) {
        Written::Wgsl => module::mark(file),
        Written::Glsl => comment::mark(file, stage),
        Written::SpirV | Written::SpirVAssembly | Written::Hlsl | Written::Slang => return None,
    };
    (!marked.tests.is_empty()).then_some(marked)
}

/// The name of the function that runs a test.
pub(super) fn entry(number: usize) -> String {
    format!("{ENTRY}{number}")
}

/// Names of assertions that both languages have.
pub(super) fn is_assertion(word: &str) -> bool {
    let Some(rest) = word.strip_prefix("expect") else { return false };
    let kind = ["Vec2", "Vec3", "Vec4"].iter().find_map(|own| rest.strip_suffix(own)).unwrap_or(rest);
    matches!(kind, "" | "Eq" | "Near" | "Within" | "Ulp")
}
