//! What is shown for each file: what the linter finds, and what commands found in the text as it is.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

/// Diagnostics in the form of the protocol, by file.
#[derive(Default)]
pub(super) struct Shown {
    linted: BTreeMap<String, Vec<Value>>,
    results: BTreeMap<String, Vec<Value>>,
    /// Files for which the client shows something.
    visible: BTreeSet<String>,
}

impl Shown {
    /// Files for which the client shows something.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.visible.iter()
    }

    /// What the linter finds in a file now.
    pub fn lint(&mut self, name: &str, found: Vec<Value>) {
        self.linted.insert(name.to_owned(), found);
    }

    /// What a command found now: of it, nothing older is kept.
    pub fn results(&mut self, source: &str, found: BTreeMap<String, Vec<Value>>) -> BTreeSet<String> {
        let mut changed: BTreeSet<String> = found.keys().cloned().collect();
        for (name, old) in &mut self.results {
            let before = old.len();
            old.retain(|d| d["source"] != source);
            if old.len() != before {
                changed.insert(name.clone());
            }
        }
        for (name, new) in found {
            self.results.entry(name).or_default().extend(new);
        }
        changed
    }

    /// A text changed: what commands found in it holds no more.
    pub fn forget_results(&mut self, name: &str) {
        self.results.remove(name);
    }

    /// All that is to be shown for a file; none where nothing is and nothing was, and `always` is not asked for.
    pub fn all(&mut self, name: &str, always: bool) -> Option<Vec<Value>> {
        let parts = [self.linted.get(name), self.results.get(name)];
        let all: Vec<Value> = parts.into_iter().flatten().flatten().cloned().collect();
        let was = if all.is_empty() { self.visible.remove(name) } else { !self.visible.insert(name.to_owned()) };
        (!all.is_empty() || was || always).then_some(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn results_stay_beside_findings_until_their_text_changes() {
        let mut shown = Shown::default();
        assert_eq!(shown.all("a", false), None);
        shown.lint("a", vec![json!({ "source": "shadercheck" })]);
        let found = |n| BTreeMap::from([("a".to_owned(), vec![json!({ "source": "fuzz", "n": n })])]);
        shown.results("fuzz", found(1));
        assert_eq!(shown.all("a", false).unwrap().len(), 2);
        shown.results("fuzz", found(2));
        assert_eq!(shown.all("a", false).unwrap()[1]["n"], 2);
        assert_eq!(shown.results("fuzz", BTreeMap::new()), BTreeSet::from(["a".to_owned()]));
        shown.results("fuzz", found(3));
        shown.forget_results("a");
        shown.lint("a", Vec::new());
        assert_eq!(shown.all("a", false), Some(Vec::new()), "what was shown is taken away");
        assert_eq!(shown.all("a", false), None);
    }
}
