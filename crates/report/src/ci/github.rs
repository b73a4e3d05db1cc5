//! `github`: commands of GitHub Actions that put findings beside the lines of a change.
//! <https://docs.github.com/actions/reference/workflow-commands-for-github-actions>

use super::{Format, Item, relative};
use crate::actions::{data, property};
use base::diagnostic::Severity;

/// The format: a line for each finding.
pub const FORMAT: Format = Format {
    name: "github",
    summary: "Annotations of GitHub Actions",
    file: "annotations.txt",
    write: |run| Ok(run.items.iter().map(command).collect()),
};

fn command(item: &Item) -> String {
    let kind = match item.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Info => "notice",
    };
    let (line, column) = item.at.unwrap_or((1, 1));
    format!(
        "::{kind} file={},line={line},col={column},title={}::{}\n",
        property(&relative(&item.file)),
        property(&format!("shadercheck {}", item.code)),
        data(item.details.trim())
    )
}
