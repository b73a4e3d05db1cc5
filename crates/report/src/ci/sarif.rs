//! `sarif`: the Static Analysis Results Interchange Format 2.1.0 (OASIS), for code scanning.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::{Format, Item, Run, relative};
use crate::sarif::{encoded, level, log};

/// The format.
pub const FORMAT: Format = Format {
    name: "sarif",
    summary: "SARIF 2.1.0, for code scanning",
    file: "report.sarif",
    write: |run| Ok(sarif(run)),
};

/// The whole log, with a line break.
fn sarif(run: &Run) -> String {
    let used: BTreeMap<&str, &str> = run.items.iter().map(|item| (item.code.as_str(), item.about)).collect();
    let rules = used.iter().map(|(code, about)| json!({ "id": code, "shortDescription": { "text": about } })).collect();
    let index = |code: &str| used.keys().position(|used| *used == code).unwrap_or_default();
    let results: Vec<Value> = run.items.iter().map(|item| result(item, index(&item.code))).collect();
    log(rules, results, None)
}

fn result(item: &Item, index: usize) -> Value {
    let path = relative(&item.file);
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
