//! `formula`, `reference`, `recorded` and `defines`.

use super::super::expect::{Define, Expect, RecordedFile, ReferenceFile};
use super::dispatch::groups;
use super::{Names, Stage, known};
use disk::table::{At, Table};

/// Combinations of macros that are taken for intended.
const MOST_VARIANTS: usize = 64;

/// What is expected. At most one of the three keys may stand there.
pub(super) fn expect(root: Table<'_>, names: &Names, stage: Option<Stage>) -> Expect {
    let given: Vec<&str> = ["formula", "reference", "recorded"].into_iter().filter(|key| root.has(key)).collect();
    if let [first, second, ..] = given[..] {
        let message = format!("`{first}` says what is expected already; remove `{second}`, or make two suites");
        root.reader.problem(root.offset_of(second), message);
    }
    let formula = root.text("formula").and_then(|given| formula(root, &given, names));
    let reference = reference(root, stage);
    let recorded = recorded(root);
    formula
        .map(Expect::Formula)
        .or_else(|| reference.map(Expect::Reference))
        .or_else(|| recorded.map(Expect::Recorded))
        .unwrap_or_default()
}

fn formula(root: Table<'_>, given: &At<String>, names: &Names) -> Option<String> {
    known(root, "formula", given, names.formulas.iter().map(String::as_str))
}

/// `reference = "old.vert"`, or a table with the function that is called.
fn reference(root: Table<'_>, stage: Option<Stage>) -> Option<ReferenceFile> {
    let at = root.reader.locate(root.offset_of("reference"));
    if root.is_text("reference") {
        let file = root.text("reference")?.value;
        return Some(ReferenceFile { file, function: None, output: None, groups: Vec::new(), text: None, at });
    }
    let table = root.table("reference", "[reference]")?.only(&["file", "function", "output", "groups"]);
    let groups = groups(table);
    if !groups.is_empty() && (stage != Some(Stage::Compute) || table.has("function")) {
        let message = "`groups` is for a reference that is a compute stage";
        table.reader.problem(table.offset_of("groups"), message);
    }
    let file = table.required_text("file", "file = \"reference.glsl\"");
    let function = table.text("function");
    let output = table.text("output");
    if let (Some(output), None, Some(Stage::Vertex | Stage::Geometry | Stage::Fragment)) = (&output, &function, stage) {
        let message = "`output` says which output the value of a function stands for; name the `function` too";
        table.reader.problem(output.offset, message);
    }
    let (function, output) = (function.map(|f| f.value), output.map(|o| o.value));
    Some(ReferenceFile { file: file?.value, function, output, groups, text: None, at })
}

/// `recorded = "vectors.csv"`, or a table that says how exact the record is.
fn recorded(root: Table<'_>) -> Option<RecordedFile> {
    let at = root.reader.locate(root.offset_of("recorded"));
    let of = |file: At<String>, table: Table<'_>, relative: Option<f64>, absolute: Option<f64>| {
        if ![".csv", ".json", ".npz"].iter().any(|ending| file.value.ends_with(ending)) {
            let message = format!("`{}` is neither .csv, .json nor .npz", file.value);
            table.reader.problem(file.offset, message);
        }
        let (relative_error, absolute_error) = (relative.unwrap_or(RecordedFile::ROUNDED), absolute.unwrap_or(0.0));
        let (text, archives) = (None, Vec::new());
        Some(RecordedFile { file: file.value, relative_error, absolute_error, text, archives, at })
    };
    if root.is_text("recorded") {
        return of(root.text("recorded")?, root, None, None);
    }
    let table = root.table("recorded", "[recorded]")?.only(&["file", "relative_error", "absolute_error"]);
    let file = table.required_text("file", "file = \"vectors.csv\"");
    let error = |key: &str, most: f64| {
        let At { value, offset } = table.number(key)?;
        if (0.0..=most).contains(&value) {
            return Some(value);
        }
        table.reader.problem(offset, format!("`{key}` is {value}, which is not from 0 to {most}"));
        None
    };
    let (relative, absolute) = (error("relative_error", 0.01), error("absolute_error", f64::MAX));
    of(file?, table, relative, absolute)
}

/// True for what can be the name of a macro.
pub(super) fn is_macro(name: &str) -> bool {
    let mut letters = name.chars();
    let starts = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    starts && letters.all(|c| c.is_ascii_alphanumeric() || c == '_') && !name.starts_with("GL_")
}

/// `[defines]`: each macro with a value or a list of them. `true` defines it as 1, `false` leaves it out.
pub(super) fn defines(root: Table<'_>) -> Vec<Define> {
    let Some(table) = root.table("defines", "[defines]") else { return Vec::new() };
    let mut all: Vec<Define> = Vec::new();
    for At { value: name, offset } in table.keys() {
        if !is_macro(name) {
            table.reader.problem(offset, format!("`{name}` cannot be the name of a macro"));
            continue;
        }
        let values = table.words(name);
        if values.is_empty() {
            // What is no word has been told.
            continue;
        }
        all.push(Define { name: name.to_owned(), values });
    }
    let count = all.iter().try_fold(1_usize, |count, define| count.checked_mul(define.values.len()));
    if count.is_none_or(|count| count > MOST_VARIANTS) {
        let message = format!("[defines] makes more than {MOST_VARIANTS} combinations; make several suites");
        table.reader.problem(table.offset, message);
        all.clear();
    }
    all
}
