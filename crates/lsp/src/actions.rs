//! Quick fixes of single findings, and comments that silence them.

use std::collections::HashMap;

use base::diagnostic::{Diagnostic, Lang, Safety};
use base::text::{Edit, Position, SourceFile, Span};
use hosts::{Language, language_of};
use ls_types::{CodeAction, CodeActionKind, Diagnostic as Shown, TextEdit, Uri, WorkspaceEdit};

use crate::encoding::Encoding;

/// The actions that findings at a place offer, those that an editor should prefer first: safe repairs, repairs after
/// which a result may change, and comments that silence. `found` are the findings of the file at this moment, each with
/// how the editor knows it.
pub fn actions(found: &[(&Diagnostic, Shown)], uri: &Uri, lang: Lang, encoding: Encoding) -> Vec<CodeAction> {
    let mut all = Vec::new();
    for wanted in [Safety::Safe, Safety::Unsafe] {
        for (diagnostic, shown) in found {
            let Some(fix) = diagnostic.fix.as_ref().filter(|f| f.safety == wanted && !f.edits.is_empty()) else {
                continue;
            };
            let title = fix.title.in_lang(lang);
            let title = match (wanted, lang) {
                (Safety::Safe, _) => format!("{title} ({})", diagnostic.code),
                (Safety::Unsafe, Lang::En) => format!("{title} ({}; unsafe: the result may change)", diagnostic.code),
                (Safety::Unsafe, Lang::Ja) => format!("{title}（{}、結果が変わることがあります）", diagnostic.code),
            };
            let edits = fix.edits.iter().map(|e| text_edit(&diagnostic.file, e, encoding)).collect();
            all.push(action(title, shown, uri, edits, wanted == Safety::Safe));
        }
    }
    for (diagnostic, shown) in found {
        let Some(edit) = ignore_comment(diagnostic) else { continue };
        let title = match lang {
            Lang::En => format!("Ignore {} on this line", diagnostic.code),
            Lang::Ja => format!("この行では {} を報告しない", diagnostic.code),
        };
        all.push(action(title, shown, uri, vec![text_edit(&diagnostic.file, &edit, encoding)], false));
    }
    all
}

fn action(title: String, shown: &Shown, uri: &Uri, edits: Vec<TextEdit>, preferred: bool) -> CodeAction {
    CodeAction {
        title,
        kind: Some(CodeActionKind::QUICKFIX),
        diagnostics: Some(vec![shown.clone()]),
        edit: Some(WorkspaceEdit { changes: Some(HashMap::from([(uri.clone(), edits)])), ..WorkspaceEdit::default() }),
        is_preferred: preferred.then_some(true),
        ..CodeAction::default()
    }
}

fn text_edit(file: &SourceFile, edit: &Edit, encoding: Encoding) -> TextEdit {
    TextEdit { range: encoding.range(file, edit.span), new_text: edit.replacement.clone() }
}

/// A comment above the line of a finding that silences it; none where a comment cannot stand: in a string of host code,
/// in a document, or in a macro that goes on from the line before.
pub fn ignore_comment(found: &Diagnostic) -> Option<Edit> {
    let file = &found.file;
    let comments = match language_of(file.name())? {
        Language::Shader(_) | Language::Wgsl => true,
        // What is wrong in a shader that is a string stands there.
        Language::Host => found.code.0.starts_with('H'),
        Language::Script => false,
    };
    let line = file.position(found.span.start).line;
    let goes_on = line > 1 && file.line_text(line - 1).ends_with('\\');
    if !comments || goes_on || found.code.0.starts_with('S') {
        return None;
    }
    let text = file.line_text(line);
    let indent = &text[..text.len() - text.trim_start().len()];
    let start = file.offset(Position { line, column: 1 });
    let ending = if file.text().contains("\r\n") { "\r\n" } else { "\n" };
    Some(Edit::replace(Span::at(start), format!("{indent}// shadercheck: ignore[{}]{ending}", found.code)))
}
