//! The report for people: a line for each function, then what was found.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::{FileReport, Summary};
use crate::diagnostics;
use crate::word::word;
use base::diagnostic::Lang;
use base::text::counted;
use engine::InputValue;
use engine::fuzz::{Finding, FunctionReport, LaneReport, Part, Severity};
use judge::verdict::diagnosis::Place;

/// Colours of a terminal; empty strings elsewhere.
struct Style {
    good: &'static str,
    bad: &'static str,
    weak: &'static str,
    bold: &'static str,
    off: &'static str,
}

impl Style {
    fn new(color: bool) -> Self {
        if color {
            Self { good: "\u{1b}[32m", bad: "\u{1b}[31m", weak: "\u{1b}[33m", bold: "\u{1b}[1m", off: "\u{1b}[0m" }
        } else {
            Self { good: "", bad: "", weak: "", bold: "", off: "" }
        }
    }
}

/// One line for a function, with its line break.
pub fn line(function: &FunctionReport, color: bool) -> String {
    let style = Style::new(color);
    let (mark, paint, text) = match &function.not_run {
        Some(why) => ("--  ", style.weak, format!("not run: {why}")),
        None => {
            let (mark, paint) = match (function.fails(), function.weak()) {
                (true, _) => ("FAIL", style.bad),
                (false, Some(_)) => ("weak", style.weak),
                (false, None) if function.of(Severity::Warning).next().is_some() => ("warn", style.weak),
                (false, None) if !function.ran() => ("--  ", style.weak),
                (false, None) => ("ok  ", style.good),
            };
            let severities = [(Severity::Finding, "finding"), (Severity::Warning, "warning"), (Severity::Note, "note")];
            let of = match function.arbitrary {
                0 => String::new(),
                arbitrary => format!(", {arbitrary} of them arbitrary"),
            };
            let mut parts = Vec::new();
            if function.samples > 0 || function.dispatches == 0 {
                parts.push(format!("{}{of}", counted(function.samples, "sample")));
            }
            if function.dispatches > 0 {
                let ending = if function.dispatches == 1 { "" } else { "es" };
                parts.push(format!("{} dispatch{ending}", function.dispatches));
            }
            for (severity, word) in severities {
                let many = function.of(severity).count() as u64;
                parts.extend((many > 0).then(|| counted(many, word)));
            }
            parts.extend(function.weak().map(|reason| format!("mostly undetermined: {reason}")));
            // Where some lane ran it, those that cannot are told once for all functions, at the end.
            let some = function.lanes.iter().any(|lane| lane.not_run.is_none());
            parts.extend(function.lanes.iter().filter(|lane| !some || lane.not_run.is_none()).map(on_lane));
            (mark, paint, parts.join("  "))
        }
    };
    format!("{paint}{mark}{}  {:<20} {text}\n", style.off, function.function)
}

fn on_lane(lane: &LaneReport) -> String {
    if let Some(why) = &lane.not_run {
        return format!("{}: not run: {why}", lane.lane);
    }
    let v = &lane.verdicts;
    let mut text = format!("{} {} agreed", lane.lane, v.agreed);
    let arbitrary = &lane.arbitrary;
    for (n, what) in [
        (v.deviated, "deviated"),
        (v.undetermined_count(), "undetermined"),
        (arbitrary.deviated, "deviated on arbitrary inputs"),
    ] {
        if n > 0 {
            let _ = write!(text, ", {n} {what}");
        }
    }
    text
}

/// What was found in the functions of a file, the worst first in each; notes only when `notes` says so.
pub fn findings(file: &FileReport, notes: bool, color: bool) -> String {
    let mut text = String::new();
    for diagnostic in &file.errors {
        text.push('\n');
        text.push_str(&diagnostics::text(diagnostic, Lang::En, color));
    }
    for function in &file.functions {
        let mut shown = false;
        let notes = notes || function.tells_notes();
        let told = |f: &&Finding| (notes || f.severity != Severity::Note) && !is_unstated(f);
        for finding in function.findings.iter().filter(told) {
            let severity = match finding.severity {
                Severity::Finding => "",
                Severity::Warning => "warning: ",
                Severity::Note => "note: ",
            };
            one(&mut text, function, finding, severity, color);
            shown = true;
        }
        if shown && !function.textures.is_empty() {
            let _ = writeln!(text, "\nnote: textures of {}: {}", function.function, function.textures.join("; "));
        }
        if let Some(why) = &function.not_dispatched {
            let _ = writeln!(text, "\nnote: {} is not dispatched: {why}", function.function);
        }
        if !function.first_of_dispatch.is_empty() {
            let zeros = function.first_of_dispatch.join("`, `");
            let _ = writeln!(
                text,
                "\nnote: {} is run as the first invocation of a dispatch, alone: `{zeros}` = 0 in every sample",
                function.function
            );
        }
    }
    unstated(&mut text, file, color);
    presumed(&mut text, file);
    text
}

/// The inputs that are in [0, 1] since names say so, in one line.
fn presumed(text: &mut String, file: &FileReport) {
    let mut names: Vec<&str> = file.functions.iter().flat_map(|one| &one.presumed).map(String::as_str).collect();
    names.sort_unstable();
    names.dedup();
    if names.is_empty() || text.is_empty() {
        return;
    }
    let (shown, more) =
        names.get(..NAMES).filter(|_| names.len() > NAMES).map_or((&names[..], ""), |some| (some, ", …"));
    let shown = shown.join("`, `");
    let _ = writeln!(text, "\nnote: in [0, 1], as names say: `{shown}`{more}; `--domain` states another range");
}

/// Names of inputs that are shown in one line.
const NAMES: usize = 6;

/// True for what needs arbitrary inputs: it is reported by its cause.
pub(super) fn is_unstated(finding: &Finding) -> bool {
    finding.severity == Severity::Warning && finding.part == Part::Arbitrary && finding.cause.is_some()
}

/// Places, and inputs, that are told of one cause.
const PLACES: usize = 3;
const INPUTS: usize = 4;

/// Warnings that need arbitrary inputs: a paragraph of at most ten lines for each cause.
fn unstated(text: &mut String, file: &FileReport, color: bool) {
    let style = Style::new(color);
    let all = || file.functions.iter().flat_map(|function| function.findings.iter().map(move |f| (function, f)));
    let mut causes: Vec<&str> = Vec::new();
    for (_, finding) in all().filter(|(_, f)| is_unstated(f)) {
        let cause = finding.cause.as_deref().unwrap_or_default();
        if !causes.contains(&cause) {
            causes.push(cause);
        }
    }
    for cause in causes {
        let of = all().filter(|(_, f)| is_unstated(f) && f.cause.as_deref() == Some(cause));
        let found: Vec<(&FunctionReport, &Finding)> = of.collect();
        let mut functions: Vec<&str> = found.iter().map(|(function, _)| function.function.as_str()).collect();
        functions.dedup();
        let who = match functions[..] {
            [only] => only.to_owned(),
            [ref first, ..] => format!("{first} and {} more", functions.len() - 1),
            [] => String::new(),
        };
        let _ = writeln!(text, "\n{}warning: {who}: {cause}, at arbitrary inputs{}", style.bold, style.off);
        let mut label = "at";
        for (function, finding) in found.iter().take(PLACES) {
            let at = match &finding.place {
                Some(place) if finding.message.contains(&format!("`{}`", place.text)) => place.at.to_string(),
                Some(place) => format!("{}: `{}`", place.at, place.text),
                None => function.at.clone(),
            };
            let _ = writeln!(text, "  {label:<10} {at}: {}", finding.message);
            label = "";
        }
        if found.len() > PLACES {
            let _ = writeln!(text, "  {label:<10} and {} more", found.len() - PLACES);
        }
        let Some((function, first)) = found.first() else { continue };
        let mut label = "smallest";
        for (k, input) in first.inputs.iter().enumerate().take(INPUTS) {
            let rest = first.inputs.len() - INPUTS.min(first.inputs.len());
            let more = if k + 1 == INPUTS && rest > 0 { format!(" (and {rest} more inputs)") } else { String::new() };
            let taken = taken(function, input);
            let _ = writeln!(text, "  {label:<10} {} = {}{taken}{more}", input.shown(), input.values());
            label = "";
        }
        if let Some(command) = &first.reproduce {
            let _ = writeln!(text, "  reproduce  {command}");
        }
    }
}

/// What an input of a function is taken for, in brackets.
fn taken(function: &FunctionReport, input: &InputValue) -> String {
    let at = function.inputs.iter().position(|(name, _)| *name == input.name);
    let taken = at.and_then(|at| function.taken_for.get(at)?.as_ref());
    taken.map_or_else(String::new, |taken| format!(" (taken for {taken})"))
}

/// One finding with all that is known of it, without how bad it is.
pub(super) fn block(function: &FunctionReport, finding: &Finding) -> String {
    let mut text = String::new();
    one(&mut text, function, finding, "", false);
    text
}

fn one(text: &mut String, function: &FunctionReport, finding: &Finding, severity: &str, color: bool) {
    let style = Style::new(color);
    let on = finding.lane.map_or_else(String::new, |lane| format!(" on {lane}"));
    let _ = writeln!(text, "\n{}{severity}{}{on}: {}{}", style.bold, function.function, finding.message, style.off);
    if let Some(Place { at, text: source, expansion, line: _ }) = &finding.place {
        let expanded = expansion.as_ref().map_or_else(String::new, |name| format!(", in the expansion of `{name}`"));
        let _ = writeln!(text, "  at         {at}: `{source}`{expanded}");
    }
    let counted = if finding.is_of_dispatch() { "times" } else { "samples" };
    let mut label = "also at";
    for (place, count) in finding.also.iter().take(PLACES) {
        let _ = writeln!(text, "  {label:<10} {}: `{}` ({count} {counted})", place.at, place.text);
        label = "";
    }
    if finding.also.len() > PLACES {
        let _ = writeln!(text, "  {label:<10} and {} more places", finding.also.len() - PLACES);
    }
    if finding.count > 0 {
        let counting = match finding.counting {
            _ if finding.lane.is_some() => String::new(),
            0 => ", all of them with inputs beyond the moderate".to_owned(),
            n if n == finding.count => String::new(),
            n if function.taken_for.is_empty() => format!(", {n} of them with moderate or stated inputs"),
            n => format!(", {n} of them with realistic or stated inputs"),
        };
        let what = if finding.is_of_dispatch() { "times" } else { "samples" };
        let _ = writeln!(text, "  {what:<10} {}{counting}", finding.count);
    }
    let mut label = "smallest";
    for input in &finding.inputs {
        let _ = writeln!(text, "  {label:<10} {} = {}{}", input.shown(), input.values(), taken(function, input));
        label = "";
    }
    if let Some((error, inputs)) = &finding.worst {
        let all: Vec<String> = inputs.iter().map(|input| format!("{} = {}", input.shown(), input.values())).collect();
        let _ = writeln!(text, "  worst      relative error {error:.1e}: {}", all.join("; "));
    }
    if let (Some(output), Some(found), Some(lane)) = (&finding.output, finding.found, finding.lane) {
        let _ = writeln!(text, "  {lane:<10} {output} = {}", word(found, finding.scalar));
    }
    if let Some(diagnosis) = &finding.diagnosis {
        if let Some(origin) = &diagnosis.origin {
            let _ = writeln!(text, "  cause      {origin}");
        }
        if let Some(divergence) = &diagnosis.divergence {
            let _ = writeln!(text, "  parts at   {divergence}");
        }
    }
    if let Some(command) = &finding.reproduce {
        let _ = writeln!(text, "  reproduce  {command}");
    }
    if let Some(command) = better(finding) {
        let _ = writeln!(text, "  improve    {command}");
    }
}

/// The command that writes a better formula, where there is one.
fn better(finding: &Finding) -> Option<String> {
    let (at, formula) = (&finding.place.as_ref()?.at, finding.better.as_ref()?);
    let line = at.position?.line;
    let plain = at.file.chars().all(|c| c.is_alphanumeric() || "._-/".contains(c));
    let quote = if plain { "" } else { "'" };
    Some(format!("shadercheck improve {quote}{}:{line}{quote} writes `{formula}`", at.file))
}

/// The last lines: lanes that were missing, what was not told, and everything counted.
pub fn totals(summary: &Summary, notes: bool, color: bool) -> String {
    let style = Style::new(color);
    let mut text = String::new();
    for (name, missing) in &summary.unavailable {
        let _ = writeln!(text, "note: lane `{name}` is not available: {missing}");
    }
    for ((lanes, why), many) in not_run(summary) {
        let functions = counted(many, "function");
        let lanes: Vec<String> = lanes.iter().map(|lane| format!("`{lane}`")).collect();
        let _ = writeln!(text, "note: {functions} not run on {}: {why}", lanes.join(", "));
    }
    let totals = summary.totals();
    if totals.notes > 0 && !notes {
        let many = if totals.notes == 1 { "1 note is".to_owned() } else { format!("{} notes are", totals.notes) };
        let _ = writeln!(
            text,
            "note: {many} left out, about inputs that may never come and what is no fault; `--notes` shows them"
        );
    }
    if totals.findings > 0 {
        let _ = writeln!(
            text,
            "help: inputs that never come are left out by a comment before the function, `// shadercheck: x in [0, 1]`, or by `--domain x=[0,1]`"
        );
    }
    if summary.files.iter().flat_map(|file| &file.functions).flat_map(|one| &one.findings).any(has_case) {
        let _ = writeln!(
            text,
            "help: a `reproduce` line with `trace` in the place of `fuzz` shows the expression at which the value goes wrong"
        );
    }
    let failed = totals.findings + totals.broken > 0;
    let (word, paint) = if failed { ("fail", style.bad) } else { ("ok", style.good) };
    let verb = if totals.broken == 1 { "does" } else { "do" };
    let broken = match totals.broken {
        0 => String::new(),
        many => format!(", {} {verb} not compile", counted(many as u64, "file")),
    };
    let weak = if totals.weak == 0 { String::new() } else { format!(" ({} weak)", totals.weak) };
    let _ = writeln!(
        text,
        "{paint}{word}{}: {} run{weak}, {} not run, {}, {}{broken}",
        style.off,
        counted(totals.run as u64, "function"),
        totals.not_run,
        counted(totals.findings as u64, "finding"),
        counted(totals.warnings as u64, "warning")
    );
    text
}

/// True for what is no note and has a case of a function that `trace` takes.
fn has_case(finding: &Finding) -> bool {
    let takes = |command: &String| command.contains(" --case ");
    finding.severity != Severity::Note && finding.reproduce.as_ref().is_some_and(takes)
}

/// Lanes that did not run functions which others ran, with the reason, and how many functions.
fn not_run(summary: &Summary) -> BTreeMap<(Vec<&str>, &str), u64> {
    let mut all = BTreeMap::new();
    for function in summary.files.iter().flat_map(|file| &file.functions) {
        if function.lanes.iter().all(|lane| lane.not_run.is_some()) {
            continue;
        }
        let mut reasons: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for lane in &function.lanes {
            if let Some(why) = &lane.not_run {
                reasons.entry(why).or_default().push(lane.lane);
            }
        }
        for (why, lanes) in reasons {
            *all.entry((lanes, why)).or_default() += 1;
        }
    }
    all
}
