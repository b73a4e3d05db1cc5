//! Reads a profile from TOML, with every problem at its place.

use std::cell::RefCell;

use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::measured::{CLASSES, Row, Table};
use super::rule::{Condition, Piece, Quantity, Rule};
use super::{Acceptance, Entry, Flush, Op, Profile, Rounding};
use base::nearest;
use base::text::SourceFile;

/// What is wrong with a profile: one line for each problem, `file:line:column: what`.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{}", .0.join("\n"))]
pub struct ProfileError(pub Vec<String>);

/// Reads a profile. `base` finds the profile that this one extends by name, if it extends one.
///
/// # Errors
/// [`ProfileError`] with every problem: keys that are not known, rules that cannot be read,
/// operations without an entry.
pub fn parse(file: &SourceFile, base: &dyn Fn(&str) -> Option<Profile>) -> Result<Profile, ProfileError> {
    let reader = ProfileReader { problems: RefCell::default() };
    let profile = match DeTable::parse(file.text()) {
        Ok(root) => reader.profile(root.get_ref(), base),
        Err(error) => {
            reader.problem(error.span().map_or(0, |s| s.start), error.message());
            None
        }
    };
    let mut problems = reader.problems.into_inner();
    problems.sort_by_key(|(offset, _)| *offset);
    let lines: Vec<String> = problems.iter().map(|(at, message)| format!("{}: {message}", file.locate(*at))).collect();
    profile.filter(|_| lines.is_empty()).ok_or(ProfileError(lines))
}

/// What was found wrong so far, by byte offset.
struct ProfileReader {
    problems: RefCell<Vec<(usize, String)>>,
}

type Value<'a> = Spanned<DeValue<'a>>;

const TOP: [&str; 11] = [
    "name",
    "revision",
    "extends",
    "acceptance",
    "rounding",
    "contraction",
    "rearrangement",
    "unbounded",
    "subnormals",
    "operations",
    "device",
];

impl ProfileReader {
    fn problem(&self, offset: usize, message: impl Into<String>) {
        self.problems.borrow_mut().push((offset, message.into()));
    }

    /// Notes keys that are none of `known`.
    fn only<'k>(&self, table: &DeTable<'_>, known: impl Iterator<Item = &'k str> + Clone) {
        for key in table.keys() {
            let name: &str = key.get_ref();
            if known.clone().all(|k| k != name) {
                let meant = match nearest(name, known.clone()) {
                    Some(meant) => format!("did you mean `{meant}`?"),
                    None => format!("known keys are {}", known.clone().collect::<Vec<_>>().join(", ")),
                };
                self.problem(key.span().start, format!("unknown key `{name}`; {meant}"));
            }
        }
    }

    fn text<'v>(&self, key: &str, value: &'v Value<'_>) -> Option<&'v str> {
        let text = value.get_ref().as_str();
        if text.is_none() {
            let found = value.get_ref().type_str();
            self.problem(value.span().start, format!("`{key}` is a text, not a value of type {found}"));
        }
        text
    }

    /// A text of the top level; without it, what the extended profile says.
    fn top(&self, table: &DeTable<'_>, key: &str, base: Option<String>) -> Option<String> {
        match table.get(key) {
            Some(value) => self.text(key, value).map(str::to_owned),
            None => {
                if base.is_none() {
                    self.problem(0, format!("missing key `{key}`"));
                }
                base
            }
        }
    }

    /// One of a few words, read from `table` or taken from the extended profile.
    fn word<T: Copy + PartialEq>(
        &self,
        table: Option<&DeTable<'_>>,
        key: &str,
        words: &[(&str, T)],
        base: Option<T>,
    ) -> Option<T> {
        let Some(value) = table.and_then(|t| t.get(key)) else {
            if base.is_none() {
                self.problem(0, format!("missing key `{key}`"));
            }
            return base;
        };
        let text = self.text(key, value)?;
        let found = words.iter().find(|(word, _)| *word == text).map(|(_, t)| *t);
        if found.is_none() {
            let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            self.problem(value.span().start, format!("`{key}` is `{text}`; it can be {}", known.join(", ")));
        }
        found
    }

    fn profile(&self, root: &DeTable<'_>, find: &dyn Fn(&str) -> Option<Profile>) -> Option<Profile> {
        self.only(root, TOP.into_iter());
        let base = match root.get("extends") {
            None => None,
            Some(value) => {
                let name = self.text("extends", value)?;
                let found = find(name);
                if found.is_none() {
                    self.problem(value.span().start, format!("there is no profile `{name}` to extend"));
                    return None;
                }
                found
            }
        };
        let base = base.as_ref();
        let table = |key: &str| {
            let value = root.get(key)?;
            let table = value.get_ref().as_table();
            if table.is_none() {
                self.problem(value.span().start, format!("`{key}` is a table"));
            }
            table
        };
        if let Some(device) = table("device") {
            self.only(device, super::device::KEYS.into_iter());
        }
        let driver = table("device").and_then(|device| Some(self.text("driver", device.get("driver")?)?.to_owned()));
        let subnormals = table("subnormals");
        if let Some(subnormals) = subnormals {
            self.only(subnormals, ["compute", "vertex"].into_iter());
        }
        let flushes = [("must", Flush::Must), ("may", Flush::May), ("never", Flush::Never)];
        let allowance = [("allowed", true), ("never", false)];
        let roundings = [("either", Rounding::Either), ("nearest-even", Rounding::NearestEven)];
        let acceptances = [("text", Acceptance::Text), ("outward", Acceptance::Outward)];
        let name = self.top(root, "name", None);
        let revision = self.top(root, "revision", base.map(|b| b.revision.clone()));
        let root_table = Some(root);
        let rounding = self.word(root_table, "rounding", &roundings, base.map(|b| b.rounding));
        let compute = self.word(subnormals, "compute", &flushes, base.map(|b| b.compute));
        let vertex = self.word(subnormals, "vertex", &flushes, base.map(|b| b.vertex));
        let contraction = self.word(root_table, "contraction", &allowance, base.map(|b| b.contraction));
        let rearrangement = self.word(root_table, "rearrangement", &allowance, base.map(|b| b.rearrangement));
        let fallbacks = [("none", false), ("in-order", true)];
        let fallback = Some(base.is_some_and(|b| b.in_order_where_unbounded));
        let fallback = self.word(root_table, "unbounded", &fallbacks, fallback);
        let acceptance = self.word(root_table, "acceptance", &acceptances, base.map(|b| b.acceptance));
        let entries = self.entries(table("operations"), base, root.contains_key("device"));
        Some(Profile {
            name: name?,
            revision: revision?,
            driver,
            rounding: rounding?,
            compute: compute?,
            vertex: vertex?,
            contraction: contraction?,
            rearrangement: rearrangement?,
            in_order_where_unbounded: fallback?,
            acceptance: acceptance?,
            entries: entries?,
        })
    }

    /// One entry for each operation. What a device was not measured for is as in the profile that
    /// it extends; without one, it does not promise it.
    fn entries(&self, table: Option<&DeTable<'_>>, base: Option<&Profile>, device: bool) -> Option<Vec<Entry>> {
        if let Some(table) = table {
            self.only(table, Op::ALL.iter().map(|op| op.name()));
        }
        let entry = |op: Op| match (table.and_then(|t| t.get(op.name())), base) {
            (Some(value), _) => self.entry(op, value),
            (None, Some(base)) => Some(base.entry(op).clone()),
            (None, None) if device => Some(Entry::Promised(vec![Piece { rule: Rule::NoPromise, domain: vec![] }])),
            (None, None) => {
                self.problem(0, format!("operation `{}` has no entry; write `none` for no promise", op.name()));
                None
            }
        };
        // All of them first: a problem in one hides none in the next.
        let entries: Vec<Option<Entry>> = Op::ALL.into_iter().map(entry).collect();
        entries.into_iter().collect()
    }

    fn entry(&self, op: Op, value: &Value<'_>) -> Option<Entry> {
        match value.get_ref() {
            DeValue::String(_) => {
                let rule = self.rule(op, value)?;
                Some(Entry::Promised(vec![Piece { rule, domain: Vec::new() }]))
            }
            DeValue::Array(list) => {
                let pieces: Vec<Option<Piece>> = list.iter().map(|item| self.piece(op, item)).collect();
                let pieces: Vec<Piece> = pieces.into_iter().collect::<Option<_>>()?;
                if pieces.is_empty() {
                    self.problem(value.span().start, format!("`{}` has no rule", op.name()));
                    return None;
                }
                Some(Entry::Promised(pieces))
            }
            DeValue::Table(table) => self.measured(op, table, value.span().start).map(Entry::Measured),
            other => {
                let found = other.type_str();
                let message =
                    format!("`{}` is a rule, a list of rules or a table, not a value of type {found}", op.name());
                self.problem(value.span().start, message);
                None
            }
        }
    }

    fn rule(&self, op: Op, value: &Value<'_>) -> Option<Rule> {
        match Rule::parse(self.text(op.name(), value)?) {
            Ok(rule) => Some(rule),
            Err(message) => {
                self.problem(value.span().start, message);
                None
            }
        }
    }

    fn piece(&self, op: Op, item: &Value<'_>) -> Option<Piece> {
        let at = item.span().start;
        let Some(table) = item.get_ref().as_table() else {
            self.problem(at, format!("`{}` is a list of tables such as {{ allow = \"ulp(3)\" }}", op.name()));
            return None;
        };
        self.only(table, std::iter::once("allow").chain(Quantity::KEYS.iter().map(|(key, _)| *key)));
        let Some(allow) = table.get("allow") else {
            self.problem(at, "missing key `allow`; for example `allow = \"ulp(2.5)\"`");
            return None;
        };
        let rule = self.rule(op, allow);
        let mut domain = Vec::new();
        for (key, quantity) in Quantity::KEYS {
            let Some(value) = table.get(key) else { continue };
            match Condition::parse(quantity, self.text(key, value)?) {
                Ok(condition) => domain.push(condition),
                Err(message) => self.problem(value.span().start, message),
            }
        }
        Some(Piece { rule: rule?, domain })
    }

    /// The table of a measured operation. What people read beside the rows is not needed here.
    fn measured(&self, op: Op, table: &DeTable<'_>, at: usize) -> Option<Table> {
        self.only(table, super::measured::KEYS.into_iter());
        let required = |key: &str| {
            let value = table.get(key);
            if value.is_none() {
                self.problem(at, format!("missing key `{key}` in the measurement of `{}`", op.name()));
            }
            value
        };
        let samples = required("samples").and_then(|v| self.number("samples", v));
        let margin = required("margin").and_then(|v| self.number("margin", v));
        let exhaustive = required("exhaustive").and_then(|v| {
            let exhaustive = v.get_ref().as_bool();
            if exhaustive.is_none() {
                self.problem(v.span().start, "`exhaustive` is true or false");
            }
            exhaustive
        });
        if let Some(value) = table.get("margin").filter(|_| margin.is_some_and(|m| m < 1.0)) {
            self.problem(value.span().start, "`margin` is a factor on errors, and at least 1");
        }
        let definition = match table.get("definition") {
            None => None,
            Some(value) => match self.rule(op, value)? {
                Rule::Inherited { definition, or: 0.0 } => Some(definition),
                _ => {
                    self.problem(value.span().start, "`definition` is a formula; write `inherits(FORMULA)`");
                    return None;
                }
            },
        };
        let rows = required("binades")?;
        let Some(list) = rows.get_ref().as_array() else {
            self.problem(rows.span().start, "`binades` is a list of rows");
            return None;
        };
        let rows: Option<Vec<Row>> = list.iter().map(|row| self.row(row)).collect();
        let rows = rows?;
        if rows.windows(2).any(|pair| pair[0].bins.1 >= pair[1].bins.0) {
            self.problem(at, format!("the binades of `{}` overlap or are not in ascending order", op.name()));
            return None;
        }
        Some(Table { samples: samples? as u64, exhaustive: exhaustive?, margin: margin?, definition, rows })
    }

    fn number(&self, key: &str, value: &Value<'_>) -> Option<f64> {
        let number = match value.get_ref() {
            DeValue::Integer(n) => n.as_str().parse::<i64>().ok().map(|n| n as f64),
            DeValue::Float(x) => x.as_str().parse::<f64>().ok(),
            _ => None,
        };
        let number = number.filter(|x| x.is_finite());
        if number.is_none() {
            self.problem(value.span().start, format!("`{key}` is not a finite number"));
        }
        number
    }

    /// `[sign, first exponent, last exponent, samples, ulp, abs, histogram…]`.
    fn row(&self, row: &Value<'_>) -> Option<Row> {
        let width = 6 + CLASSES.len() + 1;
        let numbers: Option<Vec<f64>> =
            row.get_ref().as_array().and_then(|list| list.iter().map(|n| self.number("binades", n)).collect());
        let Some(n) = numbers.filter(|n| n.len() == width) else {
            self.problem(row.span().start, format!("a row of `binades` has {width} numbers"));
            return None;
        };
        let exponent = |x: f64| (-127.0..=128.0).contains(&x) && x.fract() == 0.0;
        let sign = n[0].abs() == 1.0;
        if !sign || !exponent(n[1]) || !exponent(n[2]) || n[1] > n[2] || n[3..].iter().any(|x| *x < 0.0) {
            self.problem(
                row.span().start,
                "a row of `binades` is a sign, two exponents from -127 to 128, and no number below 0",
            );
            return None;
        }
        if n[6..].iter().sum::<f64>() != n[3] {
            self.problem(row.span().start, "the classes of a row of `binades` do not add up to its samples");
            return None;
        }
        let bin = |exponent: f64| (exponent as i32 + 127) as usize + if n[0] < 0.0 { 256 } else { 0 };
        Some(Row {
            bins: (bin(n[1]), bin(n[2])),
            samples: n[3] as u64,
            ulp: n[4],
            abs: n[5],
            histogram: std::array::from_fn(|k| n[6 + k] as u64),
        })
    }
}
