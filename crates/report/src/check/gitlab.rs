//! `gitlab`: Code Quality of GitLab, beside the lines of a merge request.

use super::Format;
use super::items;
use crate::gitlab::Issues;
use engine::suite::run::Summary;

/// The format.
pub const FORMAT: Format = Format {
    name: "gitlab",
    summary: "Code Quality of GitLab, for merge requests",
    file: "code-quality.json",
    write: |summary| Ok(gitlab(summary)),
};

/// An issue for each fault. What stands for its place names the suite and what is wrong, and neither lanes nor places in the
/// text: both change while the fault stays.
fn gitlab(summary: &Summary) -> String {
    let mut issues = Issues::default();
    for item in items::all(summary) {
        let line = item.at.map_or(1, |(line, _)| line);
        issues.add(item.severity, &item.code, &item.message, &items::relative(&item.file), line, &item.identity());
    }
    issues.report()
}
