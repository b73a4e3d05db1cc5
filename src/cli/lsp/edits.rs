//! Changes of files in the types of the protocol.

use std::collections::HashMap;

use base::text::{SourceFile, Span};
use ls_types::{TextEdit, Uri, WorkspaceEdit};
use lsp::{Edits, Encoding, RenameError};
use similar::{Algorithm, DiffOp, TextDiff};

use super::requests::Context;

/// What turns one text into another, line by line: what an editor keeps at other lines stays.
pub(super) fn between(before: &SourceFile, after: &str, encoding: Encoding) -> Vec<TextEdit> {
    let diff = TextDiff::configure().algorithm(Algorithm::Myers).diff_lines(before.text(), after);
    let lines = |text: &str| -> Vec<usize> {
        let mut starts = vec![0];
        diff_lines(text, &mut starts);
        starts
    };
    let (old, new) = (lines(before.text()), lines(after));
    let changed = diff.ops().iter().filter(|op| !matches!(op, DiffOp::Equal { .. })).map(|op| {
        let (from, to) = (op.old_range(), op.new_range());
        let span = Span::new(old[from.start], old[from.end]);
        TextEdit { range: encoding.range(before, span), new_text: after[new[to.start]..new[to.end]].to_owned() }
    });
    changed.collect()
}

/// Offsets at which lines begin, as `similar` cuts them, and the end of the text.
fn diff_lines(text: &str, starts: &mut Vec<usize>) {
    let bytes = text.as_bytes();
    for (i, b) in bytes.iter().enumerate() {
        if *b == b'\n' || (*b == b'\r' && bytes.get(i + 1) != Some(&b'\n')) {
            starts.push(i + 1);
        }
    }
    if starts.last() != Some(&text.len()) {
        starts.push(text.len());
    }
}

/// Changes of several files. Nothing is changed outside of the workspace, nor in a file that an editor would not write
/// back as it was.
///
/// # Errors
/// Why a file must not be changed.
pub(super) fn workspace_edit(edits: &Edits, context: &Context) -> Result<WorkspaceEdit, RenameError> {
    let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
    for (name, (file, spans)) in edits {
        if !context.is_open(name) {
            if !context.is_inside(name) {
                return Err(RenameError::Outside(name.clone()));
            }
            if let Some(encoding) = context.project.loaded.other_encoding(name) {
                return Err(RenameError::Encoding(name.clone(), encoding.to_string()));
            }
        }
        let Some(uri) = context.uri(name) else { return Err(RenameError::Outside(name.clone())) };
        let encoding = context.options.encoding;
        let edit =
            |(span, text): &(Span, String)| TextEdit { range: encoding.range(file, *span), new_text: text.clone() };
        changes.insert(uri, spans.iter().map(edit).collect());
    }
    Ok(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lines_that_differ_are_replaced() {
        let before = SourceFile::new("a", "one\ntwo\r\nthree\nfour");
        let edits = between(&before, "one\nTWO\r\nthree\nfour\nfive", Encoding::Utf16);
        let texts: Vec<&str> = edits.iter().map(|e| e.new_text.as_str()).collect();
        assert_eq!(texts, ["TWO\r\n", "four\nfive"]);
        assert_eq!((edits[0].range.start.line, edits[0].range.end.line), (1, 2));
        assert!(between(&before, before.text(), Encoding::Utf16).is_empty());
        assert_eq!(between(&SourceFile::new("a", ""), "x\n", Encoding::Utf16).len(), 1);
    }
}
