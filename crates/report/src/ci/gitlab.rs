//! `gitlab`: Code Quality of GitLab, beside the lines of a merge request.

use super::{Format, Run, relative};
use crate::gitlab::Issues;

/// The format.
pub const FORMAT: Format = Format {
    name: "gitlab",
    summary: "Code Quality of GitLab, for merge requests",
    file: "code-quality.json",
    write: |run| Ok(gitlab(run)),
};

/// An issue for each fault. What stands for its place names neither lanes nor places in the text: both change while the
/// fault stays.
fn gitlab(run: &Run) -> String {
    let mut issues = Issues::default();
    for item in &run.items {
        let line = item.at.map_or(1, |(line, _)| line);
        issues.add(item.severity, &item.code, &item.message, &relative(&item.file), line, &item.identity);
    }
    issues.report()
}
