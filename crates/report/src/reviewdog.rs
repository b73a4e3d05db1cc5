//! The Reviewdog Diagnostic Format, `rdjson`, from which reviewdog writes comments on GitHub, GitLab, Gerrit and Bitbucket.
//! <https://github.com/reviewdog/reviewdog/tree/master/proto/rdf>

use serde_json::{Value, json};

use base::diagnostic::Severity;
use base::text::{SourceFile, Span};

/// A whole report, with a line break.
pub(super) fn report(diagnostics: Vec<Value>) -> String {
    format!("{:#}\n", json!({ "source": { "name": "shadercheck" }, "diagnostics": diagnostics }))
}

/// A severity as the format calls it.
pub(super) fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "ERROR",
        Severity::Warning => "WARNING",
        Severity::Info => "INFO",
    }
}

/// A part of a text. Lines and columns count from 1, columns in bytes of UTF-8, and the end is exclusive.
pub(super) fn range(file: &SourceFile, span: Span) -> Value {
    let position = |offset: usize| {
        let start = file.text()[..offset].rfind('\n').map_or(0, |at| at + 1);
        json!({ "line": file.position(offset).line, "column": offset - start + 1 })
    };
    json!({ "start": position(span.start), "end": position(span.end) })
}
