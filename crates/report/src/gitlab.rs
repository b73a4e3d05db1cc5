//! Reports of GitLab's Code Quality, which merge requests show.
//! <https://docs.gitlab.com/ci/testing/code_quality/#code-quality-report-format>

use std::collections::BTreeMap;

use serde_json::{Value, json};

use base::diagnostic::Severity;
use base::text::fingerprint;

/// The issues of a report.
#[derive(Debug, Default)]
pub(super) struct Issues {
    issues: Vec<Value>,
    /// How often each place was told: GitLab takes issues with one fingerprint for one issue.
    seen: BTreeMap<u64, usize>,
}

impl Issues {
    /// Adds an issue. `file` is its path from the root of the repository, `line` counts from 1, and `place` is a text that
    /// stays when the line moves, from which GitLab tells old issues from new ones.
    pub(super) fn add(&mut self, severity: Severity, code: &str, message: &str, file: &str, line: usize, place: &str) {
        let hash = fingerprint(&format!("{code} {file} {place}"));
        let nth = self.seen.entry(hash).or_default();
        *nth += 1;
        let severity = match severity {
            Severity::Error => "major",
            Severity::Warning => "minor",
            Severity::Info => "info",
        };
        self.issues.push(json!({
            "description": message,
            "check_name": code,
            "fingerprint": format!("{hash:016x}{nth:04x}"),
            "severity": severity,
            "location": { "path": file, "lines": { "begin": line } },
        }));
    }

    /// The whole report, with a line break.
    pub(super) fn report(self) -> String {
        format!("{:#}\n", Value::Array(self.issues))
    }
}
