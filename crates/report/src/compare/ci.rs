//! A run of `compare` as services see it: two files are a group of tests, and a pair of functions a test in it.

use std::fmt::Write as _;

use super::twins::Kind;
use super::{Summary, TwinReport, Twins, text, twins_text};
use crate::ci::{Item, Run, Status, Test, place};
use base::diagnostic::Severity;
use engine::compare::Compared;

/// A run over two files for the formats of [`crate::ci`].
pub fn ci(summary: &Summary) -> Run {
    let Summary { texts, seed, pairs, unpaired, errors, interrupted: _ } = summary;
    let (pairs, unpaired, errors) = (pairs.clone(), unpaired.clone(), errors.clone());
    let twin = TwinReport { pairs, unpaired, errors, ..TwinReport::of(texts.clone()) };
    twins(&Twins { seed: *seed, twins: vec![twin], ..Twins::default() })
}

/// The same of many files.
pub fn twins(summary: &Twins) -> Run {
    let outcome = match summary.counts().compared {
        _ if summary.fails() => "failed",
        0 => "could not run",
        _ => "passed",
    };
    let counts = twins_text(summary, false);
    Run {
        outcome: format!("compare {outcome}"),
        summary: counts.lines().last().map_or_else(String::new, |line| format!("{line}.\n")),
        rest: String::new(),
        items: summary.twins.iter().flat_map(items).collect(),
        tests: summary.twins.iter().flat_map(tests).collect(),
    }
}

/// What is wrong with two files: functions that differ, and what could not be compared.
fn items(twin: &TwinReport) -> Vec<Item> {
    let files = twin.not_compared.iter().chain(&twin.errors).map(|why| unread(twin, why));
    files.chain(twin.pairs.iter().filter_map(|pair| unlike(twin, pair))).collect()
}

fn unread(twin: &TwinReport, why: &str) -> Item {
    let message = format!("not compared with {}: {}", twin.texts[1], why.replace('\n', "; "));
    Item {
        severity: Severity::Error,
        code: "not_compared".to_owned(),
        about: "Functions of two files that are to mean the same are not compared.",
        details: message.clone(),
        identity: message.clone(),
        message,
        file: twin.texts[0].clone(),
        at: None,
    }
}

/// Two functions that differ, at the first of them.
fn unlike(twin: &TwinReport, pair: &Compared) -> Option<Item> {
    if Kind::of(twin, pair) != Kind::Unlike {
        return None;
    }
    let name = text::name(pair);
    let bits = pair.unlike.0 == 0;
    let (code, about) = match bits {
        true => ("unlike_bits", "Two functions do not have the same bits on every device."),
        false => ("unlike", "Two functions that are to mean the same differ."),
    };
    let says = if bits { text::equal(pair) } else { text::unlike(pair) };
    let message = format!("{name}: {says}, beside {}", pair.at[1]);
    let mut details = format!("{message}\n");
    match bits {
        true => pair.same_bits.iter().for_each(|bits| text::same_bits(&mut details, bits)),
        false => pair.smallest.iter().for_each(|smallest| text::difference(&mut details, smallest)),
    }
    let (file, at) = place(&pair.at[0]);
    Some(Item {
        severity: Severity::Error,
        code: code.to_owned(),
        about,
        message,
        details,
        file: file.to_owned(),
        at,
        identity: format!("{name} beside {}", twin.texts[1]),
    })
}

fn tests(twin: &TwinReport) -> Vec<Test> {
    let [first, second] = &twin.texts;
    let group = format!("{first} = {second}");
    let test = |name: String, status: Status, output: String| {
        let (group, file) = (group.clone(), first.clone());
        Test { group, name, file, status, output, ..Test::default() }
    };
    let files = twin.not_compared.iter().chain(&twin.errors);
    let files = files.map(|why| test("files".to_owned(), Status::Broken(vec![unread(twin, why)]), String::new()));
    let pair = |pair: &Compared| {
        let status = match (unlike(twin, pair), Kind::of(twin, pair)) {
            (Some(item), _) => Status::Failed(vec![item]),
            (None, Kind::Excepted) => Status::Skipped("known to differ".to_owned()),
            (None, Kind::NotCompared) => {
                let why = pair.not_compared.clone().unwrap_or_else(|| text::equal(pair));
                Status::Skipped(format!("not compared: {why}"))
            }
            (None, _) => Status::Passed,
        };
        let mut output = text::equal(pair);
        if pair.unlike.0 > 0 {
            // Writing into a String does not fail.
            let _ = write!(output, ", {}", text::unlike(pair));
        }
        test(text::name(pair), status, output)
    };
    files.chain(twin.pairs.iter().map(pair)).collect()
}
