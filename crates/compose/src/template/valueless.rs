//! Names of directives that have no value: in a condition, `#if QUALITY > 2`, and marked, `@group(#{MATERIAL_BIND_GROUP})`.

use base::diagnostic::{Diagnostic, Severity};
use base::text::{SourceFile, Span};
use syntax::{errors, plain};

use super::assume::by_place;

/// Names that are assumed of one file at most.
const MOST: usize = 64;

/// Runs the directives of a text. A name without a value has the one that its place asks for, and 1 in a condition; each is
/// told.
pub(crate) fn assuming(
    file: &SourceFile,
    defines: &[(String, String)],
    replacement: plain::Replacement,
) -> (plain::Plain, Vec<Diagnostic>) {
    let (mut defines, mut notes) = (defines.to_vec(), Vec::new());
    loop {
        let read = plain::plain(file, &defines, replacement);
        let valueless = read.diagnostics.iter().find(|d| d.code == errors::VALUELESS);
        let Some(span) = valueless.map(|d| d.span).filter(|_| notes.len() < MOST) else { return (read, notes) };
        let name = file.slice(span).trim_matches(['#', '{', '}']).trim().to_owned();
        let (value, why) = match by_place(file, span, notes.len()) {
            Some((_, found)) if file.slice(span).starts_with('#') => (found.value, found.why),
            _ => ("1".to_owned(), "a number"),
        };
        if name.is_empty() || defines.iter().any(|(known, _)| *known == name) {
            return (read, notes);
        }
        notes.push(note(file, span, &name, &value, why));
        defines.push((name, value));
    }
}

/// What to tell of a value that is assumed.
fn note(file: &SourceFile, span: Span, name: &str, value: &str, why: &str) -> Diagnostic {
    let message = format!("`{name}` is taken for {value}, {why}; `--define {name}=VALUE` states another");
    Diagnostic::new(errors::TEMPLATE, Severity::Info, file, span, message).at_origin()
}
