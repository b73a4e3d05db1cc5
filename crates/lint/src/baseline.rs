//! Findings that are known and put off: a list that later runs are compared with. Lines are named by
//! their text and not by their number, so that an edit elsewhere in the file changes nothing.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use base::diagnostic::Diagnostic;
use base::text::fingerprint;

use super::registry::by_code;

/// Version of the form of the file.
const VERSION: u32 = 1;

/// Known findings.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    version: u32,
    findings: Vec<Known>,
}

/// Findings of one rule on lines with the same text in one file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// Path of the file, with `/`, from the folder of the baseline.
    pub file: String,
    /// Code of the rule; a file may have its name instead.
    pub rule: String,
    /// [`fingerprint`] of the line in which the findings begin, in hexadecimal digits.
    pub fingerprint: String,
    /// The line, for people; only the fingerprint counts.
    pub line: String,
    /// How many there are.
    pub count: usize,
}

/// Why a text is no baseline.
#[derive(Debug, Error)]
pub enum BaselineError {
    /// It is no JSON of the right form.
    #[error("not a baseline of shadercheck: {0}; write it anew with --write-baseline")]
    Form(#[from] serde_json::Error),
    /// It is of another version.
    #[error("a baseline of version {0}, and this program reads version {VERSION}; write it anew with --write-baseline")]
    Version(u32),
}

/// What a baseline makes of findings.
#[derive(Clone, Debug, PartialEq)]
pub struct Covered {
    /// Findings that the baseline does not know.
    pub left: Vec<Diagnostic>,
    /// How many it knew.
    pub covered: usize,
    /// What it knows and is not found any more, with the number of missing findings.
    pub stale: Vec<Known>,
}

type Key = (String, String, String);

impl Known {
    fn key(&self) -> Key {
        (self.file.clone(), self.rule.clone(), self.fingerprint.clone())
    }
}

impl Baseline {
    /// A baseline that knows exactly these findings. `path_of` gives the path of a file by the name
    /// that diagnostics have for it.
    pub fn of(found: &[Diagnostic], path_of: impl Fn(&str) -> String) -> Self {
        let mut known: BTreeMap<Key, Known> = BTreeMap::new();
        for diagnostic in found {
            let new = known_of(diagnostic, &path_of);
            known.entry(new.key()).and_modify(|k| k.count += 1).or_insert(new);
        }
        Self { version: VERSION, findings: known.into_values().collect() }
    }

    /// Reads the text of a baseline file.
    ///
    /// # Errors
    /// [`BaselineError`] for text that is not JSON, has other keys, or is of another version.
    pub fn parse(text: &str) -> Result<Self, BaselineError> {
        let mut baseline: Self = serde_json::from_str(text)?;
        for known in &mut baseline.findings {
            if let Some(rule) = by_code(&known.rule) {
                known.rule = rule.code.0.to_owned();
            }
        }
        if baseline.version == VERSION { Ok(baseline) } else { Err(BaselineError::Version(baseline.version)) }
    }

    /// The text of its file, sorted, one finding after the other.
    pub fn to_text(&self) -> String {
        // Texts and numbers can always be written.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Number of findings that it knows.
    pub fn len(&self) -> usize {
        self.findings.iter().map(|k| k.count).sum()
    }

    /// True when it knows none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Takes one finding, where it is known and was not taken as often as that; true then.
    pub fn takes(&mut self, found: &Diagnostic, path_of: impl Fn(&str) -> String) -> bool {
        let key = known_of(found, path_of).key();
        let known = self.findings.iter_mut().find(|known| known.count > 0 && known.key() == key);
        known.map(|known| known.count -= 1).is_some()
    }

    /// Takes known findings out of `found`, each as often as it is known. `judged` says of a path and
    /// a code whether this run looked for it: what it did not look for is not stale.
    pub fn cover(
        &self,
        found: Vec<Diagnostic>,
        path_of: impl Fn(&str) -> String,
        judged: impl Fn(&str, &str) -> bool,
    ) -> Covered {
        let mut open: BTreeMap<Key, Known> = BTreeMap::new();
        for known in &self.findings {
            open.entry(known.key()).and_modify(|k| k.count += known.count).or_insert_with(|| known.clone());
        }
        let before = found.len();
        let mut left = Vec::new();
        for diagnostic in found {
            match open.get_mut(&known_of(&diagnostic, &path_of).key()) {
                Some(known) if known.count > 0 => known.count -= 1,
                Some(_) | None => left.push(diagnostic),
            }
        }
        let covered = before - left.len();
        let stale = open.into_values().filter(|k| k.count > 0 && judged(&k.file, &k.rule)).collect();
        Covered { left, covered, stale }
    }

    /// The baseline without what is stale.
    #[must_use]
    pub fn without(&self, stale: &[Known]) -> Self {
        let mut gone: BTreeMap<Key, usize> = BTreeMap::new();
        for known in stale {
            *gone.entry(known.key()).or_default() += known.count;
        }
        let mut findings = self.findings.clone();
        for known in &mut findings {
            let missing = gone.entry(known.key()).or_default();
            let less = known.count.min(*missing);
            known.count -= less;
            *missing -= less;
        }
        findings.retain(|k| k.count > 0);
        Self { version: VERSION, findings }
    }
}

fn known_of(diagnostic: &Diagnostic, path_of: impl Fn(&str) -> String) -> Known {
    let file = &diagnostic.file;
    let line = file.line_text(file.position(diagnostic.span.start).line);
    Known {
        file: path_of(file.name()),
        rule: diagnostic.code.0.to_owned(),
        fingerprint: format!("{:016x}", fingerprint(line)),
        line: line.split_whitespace().collect::<Vec<_>>().join(" "),
        count: 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::diagnostic::{Code, Severity};
    use base::text::{SourceFile, Span};

    fn finding(text: &str, needle: &str, nth: usize) -> Diagnostic {
        let file = SourceFile::new("a.vert", text);
        let at = text.match_indices(needle).nth(nth).unwrap().0;
        Diagnostic::new(Code("N014"), Severity::Info, &file, Span::new(at, at + needle.len()), "m")
    }

    fn path(name: &str) -> String {
        format!("shaders/{name}")
    }

    fn all(_: &str, _: &str) -> bool {
        true
    }

    const OLD: &str = "one\nx = pi;\ny = pi;\nx = pi;\n";

    fn old() -> Baseline {
        Baseline::of(&[finding(OLD, "pi", 0), finding(OLD, "pi", 1), finding(OLD, "pi", 2)], path)
    }

    #[test]
    fn lines_of_the_same_text_are_counted_together() {
        let baseline = old();
        assert_eq!((baseline.findings.len(), baseline.len()), (2, 3));
        assert_eq!(Baseline::parse(&baseline.to_text()).unwrap(), baseline);
        assert!(baseline.to_text().contains("shaders/a.vert"));
    }

    #[test]
    fn lines_that_move_or_are_indented_stay_known_and_new_ones_are_reported() {
        let new = "more\nmore\n    y  = pi;\nx = pi;\nx = pi;\nx = pi;\n";
        let found: Vec<_> = (0..4).map(|i| finding(new, "pi", i)).collect();
        let result = old().cover(found.clone(), path, all);
        assert_eq!((result.left, result.covered, result.stale.len()), (vec![found[3].clone()], 3, 0));
    }

    #[test]
    fn a_finding_is_taken_as_often_as_it_is_known() {
        let (mut known, x) = (old(), finding("x = pi;", "pi", 0));
        assert!(known.takes(&x, path) && known.takes(&x, path) && !known.takes(&x, path));
        assert!(!known.takes(&finding("z = pi;", "pi", 0), path));
    }

    #[test]
    fn what_is_gone_is_stale_and_can_be_pruned() {
        let found = vec![finding("x = pi;", "pi", 0)];
        let baseline = old();
        let result = baseline.cover(found.clone(), path, all);
        let mut stale: Vec<_> = result.stale.iter().map(|k| (k.line.as_str(), k.count)).collect();
        stale.sort_unstable();
        assert_eq!(stale, [("x = pi;", 1), ("y = pi;", 1)]);
        let pruned = baseline.without(&result.stale);
        assert_eq!(pruned.len(), 1);
        assert!(pruned.cover(found, path, all).stale.is_empty());
        assert!(baseline.cover(Vec::new(), path, |_, _| false).stale.is_empty(), "not looked for");
    }

    #[test]
    fn a_rule_may_stand_by_its_name() {
        let text = old().to_text().replace("N014", "low-precision-pi");
        assert_eq!(Baseline::parse(&text).unwrap(), old());
    }

    #[test]
    fn another_file_or_rule_is_not_covered() {
        let found = vec![finding("x = pi;", "pi", 0)];
        assert_eq!(old().cover(found.clone(), |n| n.to_owned(), all).left.len(), 1);
        let mut other = found;
        other[0].code = Code("T001");
        assert_eq!(old().cover(other, path, all).left.len(), 1);
    }

    #[test]
    fn other_texts_are_refused() {
        assert!(Baseline::parse("[]").unwrap_err().to_string().contains("--write-baseline"));
        assert!(Baseline::parse("{\"version\": 2, \"findings\": []}").unwrap_err().to_string().contains("version 2"));
        assert!(Baseline::parse("{\"version\": 1, \"findings\": [], \"more\": 1}").is_err());
    }
}
