//! Reading expectations.

use std::cell::Cell;

use toml::de::DeTable;

use super::version::{self, Versions};
use super::{Expectations, Expected, FailureKind};
use crate::suite::run::Expectation;
use base::did_you_mean;
use base::text::SourceFile;
use disk::Problem;
use disk::table::{At, Reader, Table};
use lanes::Stage;

const KEYS: [&str; 10] =
    ["lane", "driver", "versions", "suite", "stage", "kind", "message", "reason", "link", "always"];

/// Reads expectations.
///
/// # Errors
/// Everything that is wrong, each with `file:line:column`, in the order of the file.
pub fn parse(file: &SourceFile) -> Result<Expectations, Vec<Problem>> {
    let reader = Reader::new(file);
    let expectations = match DeTable::parse(file.text()) {
        Ok(document) => {
            let root = Table::root(&reader, document.get_ref()).only(&["expected"]);
            let entries = root.tables("expected", "[[expected]]").into_iter().map(expected).collect::<Option<_>>();
            entries.map(|entries| Expectations { entries })
        }
        Err(error) => {
            let message = error.message().trim_end().replace('\n', "; ");
            reader.problem(error.span().map_or(0, |s| s.start), format!("not TOML: {message}"));
            None
        }
    };
    reader.finish(expectations, "the expectations cannot be read")
}

fn expected(table: Table<'_>) -> Option<Expected> {
    let table = table.only(&KEYS);
    let text = |key: &str| table.text(key).map(|text| text.value);
    let lane = table.required_text("lane", "lane = \"vulkan\"");
    let suite = table.required_text("suite", "suite = \"hair*\"");
    let kind = table.required_text("kind", "kind = \"deviation\"");
    let reason = table.required_text("reason", "reason = \"the driver's asin is too coarse\"");
    let kind = kind.and_then(|kind| known(table, "kind", &kind, FailureKind::all(), FailureKind::name));
    let stages = [Stage::Compute, Stage::Vertex, Stage::Geometry];
    let stage = table.text("stage").map(|stage| known(table, "stage", &stage, stages.into_iter(), Stage::name));
    let versions = table.table("versions", "versions").map(versions);
    let link = text("link");
    let expectation = Expectation { at: table.reader.locate(table.offset), reason: reason?.value, link };
    Some(Expected {
        lane: lane?.value,
        driver: text("driver"),
        versions: versions.map_or(Some(None), |versions| versions.map(Some))?,
        suite: suite?.value,
        stage: stage.map_or(Some(None), |stage| stage.map(Some))?,
        kind: kind?,
        message: text("message"),
        always: table.flag("always").unwrap_or(true),
        expectation,
        met: Cell::new(false),
        ran: Cell::new(false),
    })
}

fn versions(table: Table<'_>) -> Option<Versions> {
    let table = table.only(&["of", "from", "before"]);
    let of = table.required_text("of", "of = \"Mesa\"");
    let version = |key: &str| -> Option<Option<Vec<u64>>> {
        let Some(text) = table.text(key) else { return Some(None) };
        let version = version::parse(&text.value);
        if version.is_none() {
            let message = format!("`{key}` is `{}`, which is no version such as `22.3.6`", text.value);
            table.reader.problem(text.offset, message);
        }
        version.map(Some)
    };
    let (from, before) = (version("from"), version("before"));
    if !table.has("from") && !table.has("before") {
        table.missing("before", "before = \"23.0\"");
        return None;
    }
    Some(Versions { of: of?.value, from: from?, before: before? })
}

/// A word of a list.
fn known<T: Copy>(
    table: Table<'_>,
    what: &str,
    given: &At<String>,
    all: impl Iterator<Item = T>,
    name: impl Fn(T) -> &'static str,
) -> Option<T> {
    let all: Vec<T> = all.collect();
    let found = all.iter().copied().find(|&one| name(one) == given.value);
    if found.is_none() {
        let names = || all.iter().map(|&one| name(one));
        let hint = did_you_mean(&given.value, names(), "known:");
        table.reader.problem(given.offset, format!("unknown {what} `{}`; {hint}", given.value));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "[[expected]]\nlane = \"vulkan*\"\ndriver = \"*llvmpipe*\"\n\
        versions = { of = \"Mesa\", from = \"22.3\", before = \"24\" }\nsuite = \"hair*\"\nstage = \"vertex\"\n\
        kind = \"deviation\"\nmessage = \"*gl_Position*\"\nreason = \"a reason\"\nlink = \"https://example.org\"\n\
        always = false\n";

    fn read(text: &str) -> Result<Expectations, Vec<String>> {
        let reported = |problems: Vec<Problem>| problems.iter().map(Problem::to_string).collect();
        parse(&SourceFile::new("e.toml", text)).map_err(reported)
    }

    #[test]
    fn every_key_is_read() {
        let expectations = read(GOOD).unwrap();
        let [entry] = &expectations.entries[..] else { panic!("{expectations:?}") };
        assert_eq!((entry.stage, entry.kind.name(), entry.always), (Some(Stage::Vertex), "deviation", false));
        assert_eq!(entry.expectation.to_string(), "a reason (e.toml:1:1, https://example.org)");
        assert!(read("").unwrap().is_empty() && read(&GOOD.repeat(2)).unwrap().len() == 2);
    }

    #[test]
    fn what_is_wrong_is_reported_at_its_place_with_a_suggestion() {
        for (from, to, message) in [
            ("reason =", "reson =", "e.toml:9:1: unknown key `reson` in [[expected]]; did you mean `reason`?"),
            ("[[expected]]", "[[expectd]]", "e.toml:1:3: unknown key `expectd`; did you mean `expected`?"),
            ("\"deviation\"", "\"deviatoin\"", "e.toml:7:8: unknown kind `deviatoin`; did you mean `deviation`?"),
            ("\"deviation\"", "\"range\"", "e.toml:7:8: unknown kind `range`"),
            ("\"vertex\"", "\"vertx\"", "e.toml:6:9: unknown stage `vertx`; did you mean `vertex`?"),
            ("\"22.3\"", "\"22.x\"", "e.toml:4:34: `from` is `22.x`, which is no version such as `22.3.6`"),
            ("of = ", "off = ", "e.toml:4:14: unknown key `off` in versions; did you mean `of`?"),
            ("suite = \"hair*\"\n", "", "e.toml:1:1: missing key `suite` in [[expected]]"),
            ("\"a reason\"", "3", "e.toml:9:10: `reason` is a text"),
            ("false", "0", "e.toml:11:10: `always` is true or false"),
            ("lane =", "lane ==", "not TOML: "),
        ] {
            assert!(GOOD.contains(from), "{from}");
            let problems = read(&GOOD.replace(from, to)).unwrap_err();
            assert!(problems.iter().any(|problem| problem.contains(message)), "{message}\n{problems:#?}");
        }
    }
}
