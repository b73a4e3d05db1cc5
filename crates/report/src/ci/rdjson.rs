//! `rdjson`: the Reviewdog Diagnostic Format.

use serde_json::{Value, json};

use super::{Format, Item, relative};
use crate::reviewdog::{report, severity};

/// The format.
pub const FORMAT: Format = Format {
    name: "rdjson",
    summary: "Reviewdog Diagnostic Format",
    file: "reviewdog.json",
    write: |run| Ok(report(run.items.iter().map(diagnostic).collect())),
};

/// A finding at the line where it shows; columns of this format count bytes, and those of an item characters.
fn diagnostic(item: &Item) -> Value {
    let mut location = json!({ "path": relative(&item.file) });
    if let Some((line, _)) = item.at {
        location["range"] = json!({ "start": { "line": line } });
    }
    json!({
        "message": item.details.trim(),
        "location": location,
        "severity": severity(item.severity),
        "code": { "value": item.code },
    })
}
