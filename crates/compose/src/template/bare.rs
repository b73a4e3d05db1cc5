//! Names that a host replaces without any braces around them, such as `elem` and `WORKGROUP_SIZE_X`: nothing declares them,
//! and their places say what they have to be.

use base::diagnostic::{Diagnostic, Severity};
use base::text::{Assembly, SourceFile, Span};
use syntax::errors;

use super::assume::by_place;
use crate::Composed;

/// Places of types and sizes; what stands in an expression may be anything.
const SURE: u8 = 2;

/// The file with declarations of the names that it lacks, as far as their places say what they have to be, and what is
/// assumed of each; the others stay open. None where no place says anything, or another file or a condition may declare a name.
pub(crate) fn declared(root: &SourceFile, composed: &Composed) -> Option<(SourceFile, Vec<Diagnostic>)> {
    if composed.undeclared.is_empty() {
        return None;
    }
    let mut out = Assembly::new();
    let end = root.text().len();
    out.copy(root, Span::new(0, end));
    let mut notes = Vec::new();
    for missing in &composed.undeclared {
        if missing.condition.is_some() || !missing.candidates.is_empty() {
            return None;
        }
        let Some((_, found)) = by_place(&composed.file, missing.span, 0).filter(|(rank, _)| *rank <= SURE) else {
            continue;
        };
        let name = &missing.name;
        let is_type = found.value == "f32";
        // Who writes a type with a capital declares a structure somewhere.
        if is_type && !name.starts_with(char::is_lowercase) {
            return None;
        }
        let declaration = if is_type { "alias" } else { "const" };
        out.insert(&format!("\n{declaration} {name} = {};", found.value), root, end);
        let message = format!(
            "`{name}` is declared nowhere, and is taken for {}, {}; a file named by `--with` declares another",
            found.value, found.why
        );
        notes
            .push(Diagnostic::new(errors::TEMPLATE, Severity::Info, &composed.file, missing.span, message).at_origin());
    }
    (!notes.is_empty()).then(|| (out.finish(root.name()), notes))
}
