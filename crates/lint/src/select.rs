//! Which rules run: `--select` and `--ignore`.

use std::collections::BTreeMap;

use thiserror::Error;

use super::registry::{RULES, by_code, nearest};
use super::rule::Level;

/// Why a selection is refused.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SelectError {
    /// No rule has this code, prefix or name.
    #[error("no rule is called `{given}`{}; `shadercheck explain` lists all rules", hint(.nearest))]
    Unknown {
        /// What was given.
        given: String,
        /// Rules that look like it.
        nearest: Vec<String>,
    },
}

fn hint(nearest: &[String]) -> String {
    if nearest.is_empty() { String::new() } else { format!(" (did you mean {}?)", nearest.join(", ")) }
}

/// A choice of rules by code (`T001`), family (`T`: the letters that codes begin with) or name. Of a selecting and an
/// ignoring entry that both match, the longer one decides, and `ignore` at equal length.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    select: Vec<String>,
    ignore: Vec<String>,
    level: Level,
}

impl Selection {
    /// Checks and keeps the entries. An empty `select` selects everything.
    ///
    /// # Errors
    /// [`SelectError::Unknown`] for an entry that matches no rule and no code of the front end (`E…`).
    pub fn new(select: &[String], ignore: &[String]) -> Result<Self, SelectError> {
        Ok(Self { select: codes(select)?, ignore: codes(ignore)?, level: Level::Default })
    }

    /// The same choice with the rules of a level. A rule that is selected by its whole code or by name
    /// runs at any level.
    #[must_use]
    pub fn at(mut self, level: Level) -> Self {
        self.level = level;
        self
    }

    /// True when diagnostics with `code`, of a rule of this level, are wanted.
    pub fn keeps(&self, code: &str, level: Level) -> bool {
        if level > self.level && !self.select.iter().any(|s| s == code) {
            return false;
        }
        let longest = |list: &[String]| list.iter().filter(|p| code.starts_with(p.as_str())).map(String::len).max();
        match (longest(&self.select), longest(&self.ignore)) {
            (None, Some(_)) => false,
            (None, None) => self.select.is_empty(),
            (Some(_), None) => true,
            (Some(selected), Some(ignored)) => selected > ignored,
        }
    }
}

/// Rules left out for single files, by the names of the files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PerFile {
    ignored: BTreeMap<String, Vec<String>>,
}

impl PerFile {
    /// Leaves out rules for the file of this name, besides those left out already.
    ///
    /// # Errors
    /// [`SelectError::Unknown`] as for [`Selection::new`].
    pub fn ignore(&mut self, file: &str, rules: &[String]) -> Result<(), SelectError> {
        let rules = codes(rules)?;
        self.ignored.entry(file.to_owned()).or_default().extend(rules);
        Ok(())
    }

    /// True when findings with this code are not wanted for the file of this name.
    pub fn ignores(&self, file: &str, code: &str) -> bool {
        self.ignored.get(file).is_some_and(|rules| rules.iter().any(|r| code.starts_with(r.as_str())))
    }
}

fn codes(given: &[String]) -> Result<Vec<String>, SelectError> {
    given.iter().map(|entry| code(entry)).collect()
}

fn code(given: &str) -> Result<String, SelectError> {
    let upper = given.to_ascii_uppercase();
    // A part of a number is a slip: `H03` is meant for `H003`.
    let front_end =
        upper.strip_prefix('E').is_some_and(|r| [0, 3].contains(&r.len()) && r.bytes().all(|b| b.is_ascii_digit()));
    let family = |code: &str| code.trim_end_matches(|c: char| c.is_ascii_digit()) == upper;
    if front_end || RULES.iter().any(|r| r.code.0 == upper || family(r.code.0)) {
        return Ok(upper);
    }
    match by_code(given) {
        Some(rule) => Ok(rule.code.0.to_owned()),
        None => Err(SelectError::Unknown { given: given.to_owned(), nearest: nearest(given) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn selection(select: &[&str], ignore: &[&str]) -> Selection {
        let own = |l: &[&str]| l.iter().map(|&s| s.to_owned()).collect::<Vec<_>>();
        Selection::new(&own(select), &own(ignore)).unwrap()
    }

    #[test]
    fn an_empty_selection_keeps_everything() {
        assert!(selection(&[], &[]).keeps("T001", Level::Default));
        assert!(selection(&[], &["T"]).keeps("E001", Level::Default));
    }

    #[test]
    fn the_longer_entry_decides() {
        let s = selection(&["H"], &["H001"]);
        assert!(
            s.keeps("H002", Level::Default) && !s.keeps("H001", Level::Default) && !s.keeps("T001", Level::Default)
        );
        let s = selection(&["H001"], &["h"]);
        assert!(s.keeps("H001", Level::Default) && !s.keeps("H002", Level::Default));
        assert!(!selection(&["H001"], &["H001"]).keeps("H001", Level::Default));
    }

    #[test]
    fn a_level_has_the_rules_of_those_before_it() {
        let own = |l: &[&str]| l.iter().map(|&s| s.to_owned()).collect::<Vec<_>>();
        let s = selection(&["T"], &[]);
        assert!(!s.keeps("T001", Level::Strict) && s.clone().at(Level::Heuristic).keeps("T001", Level::Strict));
        assert!(Selection::new(&own(&["T001"]), &[]).unwrap().keeps("T001", Level::Heuristic), "selected by its code");
    }

    #[test]
    fn single_files_leave_rules_out() {
        let mut per_file = PerFile::default();
        per_file.ignore("a.vert", &["N".to_owned()]).unwrap();
        per_file.ignore("a.vert", &["T001".to_owned()]).unwrap();
        assert!(per_file.ignores("a.vert", "N014") && per_file.ignores("a.vert", "T001"));
        assert!(!per_file.ignores("b.vert", "N014") && !per_file.ignores("a.vert", "H001"));
        assert!(per_file.ignore("a.vert", &["Q".to_owned()]).is_err());
    }

    #[test]
    fn a_name_stands_for_its_code() {
        assert!(selection(&["low-precision-pi"], &[]).keeps("N014", Level::Default));
    }

    #[test]
    fn an_unknown_rule_is_refused_with_the_nearest() {
        let error = Selection::new(&["H0O1".to_owned()], &[]).unwrap_err();
        assert!(error.to_string().contains("`H0O1`") && error.to_string().contains("H001"), "{error}");
        assert!(Selection::new(&[], &[String::new()]).is_err());
        // A part of a number selects nothing that anybody means.
        let error = Selection::new(&["H03".to_owned()], &[]).unwrap_err();
        assert!(error.to_string().contains("H003"), "{error}");
        assert!(
            Selection::new(&["E0".to_owned()], &[]).is_err() && Selection::new(&["E0123".to_owned()], &[]).is_err()
        );
        assert!(
            selection(&["E"], &[]).keeps("E001", Level::Default)
                && selection(&["E801"], &[]).keeps("E801", Level::Default)
        );
    }
}
