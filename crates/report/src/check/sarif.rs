//! `sarif`: the Static Analysis Results Interchange Format 2.1.0 (OASIS), for code scanning.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::Format;
use super::items::{self, Item};
use crate::sarif::{encoded, level, log};
use engine::suite::run::{FindingKind, Summary};

/// The format.
pub const FORMAT: Format = Format {
    name: "sarif",
    summary: "SARIF 2.1.0, for code scanning",
    file: "report.sarif",
    write: |summary| Ok(sarif(summary)),
};

/// The whole log, with a line break.
fn sarif(summary: &Summary) -> String {
    let all = items::all(summary);
    let used: BTreeSet<&str> = all.iter().map(|item| item.code.as_str()).collect();
    let rules: Vec<Value> =
        used.iter().map(|code| json!({ "id": code, "shortDescription": { "text": described(code) } })).collect();
    let index = |code: &str| used.iter().position(|used| *used == code).unwrap_or_default();
    let results: Vec<Value> = all.iter().map(|item| result(item, index(&item.code))).collect();
    log(rules, results, None)
}

fn result(item: &Item, index: usize) -> Value {
    let path = items::relative(&item.file);
    let uri = if path.starts_with('/') { format!("file://{}", encoded(&path)) } else { encoded(&path) };
    let mut place = json!({ "artifactLocation": { "uri": uri } });
    if let Some((line, column)) = item.at {
        place["region"] = json!({ "startLine": line, "startColumn": column });
    }
    json!({
        "ruleId": item.code,
        "ruleIndex": index,
        "level": level(item.severity),
        "message": { "text": item.details.trim() },
        "locations": [{ "physicalLocation": place }],
    })
}

/// What a code stands for.
fn described(code: &str) -> &'static str {
    let kind = FindingKind::ALL.into_iter().find(|kind| kind.name() == code);
    kind.map(FindingKind::about).or_else(|| about(code)).unwrap_or("The shader does not compile.")
}

/// What a code stands for that is no kind of finding.
pub fn about(code: &str) -> Option<&'static str> {
    match code {
        "lane" => Some("The lane failed."),
        "configuration" => Some("A suite does not fit its shader."),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::diagnostic::Severity;

    #[test]
    fn severities_are_levels() {
        assert_eq!((level(Severity::Error), level(Severity::Info)), ("error", "note"));
        assert_eq!(described("lane"), "The lane failed.");
        assert_eq!(described("E001"), "The shader does not compile.");
        assert_eq!(described("deviation"), FindingKind::Deviation.about());
    }
}
