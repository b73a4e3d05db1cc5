//! The report for people: a line for each suite and lane, findings, totals.

use std::fmt::Write as _;

use crate::diagnostic::Lang;
use crate::program::Source;
use crate::report::diagnostics;
use crate::suite::run::{Apart, Case, Entry, Finding, InputValue, LaneUsed, Outcome, Report, RunError, Summary};
use crate::value::{F32Bits, Scalar};
use crate::verdict::diagnosis::Diagnosis;
use crate::verdict::{Blame, Deviation, Value};

/// Colours of a terminal; empty strings elsewhere.
struct Style {
    good: &'static str,
    bad: &'static str,
    bold: &'static str,
    off: &'static str,
}

impl Style {
    fn new(color: bool) -> Self {
        if color {
            Self { good: "\u{1b}[32m", bad: "\u{1b}[31m", bold: "\u{1b}[1m", off: "\u{1b}[0m" }
        } else {
            Self { good: "", bad: "", bold: "", off: "" }
        }
    }
}

/// One line for a suite on a lane, with its line break.
pub fn line(entry: &Entry, color: bool) -> String {
    let style = Style::new(color);
    let source = match &entry.outcome {
        Outcome::Ran(report) => report.source,
        Outcome::Refused(_) | Outcome::LaneFailed(_) => None,
    };
    let on = match (entry.on, source) {
        // The longest name of a source is longer than that of a stage.
        (Some((lane, _)), Some(source)) => format!("{:<17}", format!("{lane}/{}", source.name())),
        (Some((lane, stage)), None) => format!("{lane}/{stage}"),
        (None, _) => String::new(),
    };
    let (good, text) = match &entry.outcome {
        Outcome::Ran(report) if report.judged() == 0 && report.unsupported > 0 => {
            let why = report.unsupported_because.as_deref().map_or_else(String::new, |why| format!(": {why}"));
            (true, format!("{} samples not supported on this lane{why}", report.unsupported))
        }
        Outcome::Ran(report) => {
            let verdicts = &report.verdicts;
            // Without a sample that agrees there is no error to tell.
            let worst = if verdicts.agreed > 0 { format!("{:.1}", verdicts.max_ulp) } else { "-".to_owned() };
            let checked: u64 = report.relations.iter().map(|(_, n)| n).sum();
            (
                report.errors().is_empty(),
                format!(
                    "{:>8} judged  {:>8} agreed  {:>6} deviated  {:>6} undetermined  max {worst:>5} ULP  {} relations ({checked})",
                    report.judged(),
                    verdicts.agreed,
                    verdicts.deviated,
                    verdicts.undetermined_count(),
                    report.relations.len(),
                ),
            )
        }
        Outcome::Refused(error) => (false, error.to_string()),
        Outcome::LaneFailed(message) => (false, message.clone()),
    };
    let (mark, paint) = if good { ("ok  ", style.good) } else { ("FAIL", style.bad) };
    format!("{paint}{mark}{}  {:<16} {on:<15}  {text}\n", style.off, entry.suite)
}

/// Everything that is wrong with the suite and lane of `entries[at]`; empty when nothing is. Findings
/// that the same suite has shown on an earlier lane or stage are not told again.
pub fn finding(entries: &[Entry], at: usize, color: bool) -> String {
    let entry = &entries[at];
    let mut text = String::new();
    match &entry.outcome {
        Outcome::Ran(report) => {
            let on = self::on(report);
            if let Some(earlier) = entries[..at].iter().find_map(|e| same_findings(e, report)) {
                let style = Style::new(color);
                let many = if report.errors().len() == 1 { "finding" } else { "findings" };
                let _ = writeln!(
                    text,
                    "\n{}{on}: the same {} {many} as on {}{}",
                    style.bold,
                    report.errors().len(),
                    place(earlier),
                    style.off
                );
                return text;
            }
            let errors = report.errors();
            for (k, finding) in errors.iter().enumerate() {
                let inputs = |f: &Finding| f.case.as_ref().map(|c| c.inputs.clone());
                let told = inputs(finding).is_some() && errors[..k].iter().any(|f| inputs(f) == inputs(finding));
                one(&mut text, &on, &report.shader, finding, told, color);
            }
        }
        Outcome::Refused(RunError::Shader { diagnostics, .. }) => {
            for diagnostic in diagnostics {
                text.push('\n');
                text.push_str(&diagnostics::text(diagnostic, Lang::En, color));
            }
            let _ = writeln!(
                text,
                "\nhelp: `shadercheck lint {}` tells more, and repairs what is often wrong",
                entry.shader
            );
        }
        Outcome::Refused(_) | Outcome::LaneFailed(_) => {}
    }
    text
}

/// Lane, stage and source of a report.
fn place(report: &Report) -> String {
    let source = report.source.map_or_else(String::new, |source| format!(", {}", source.phrase()));
    format!("{}/{}{source}", report.lane, report.stage)
}

/// Suite, lane, stage and source of a report.
fn on(report: &Report) -> String {
    format!("{} on {}", report.suite, place(report))
}

/// The report of `entry` when it is of the same suite and shader and found exactly the same.
fn same_findings<'e>(entry: &'e Entry, report: &Report) -> Option<&'e Report> {
    let Outcome::Ran(earlier) = &entry.outcome else { return None };
    let told = |r: &Report| -> Vec<(String, Option<Vec<InputValue>>)> {
        r.errors().iter().map(|f| (f.message.clone(), f.case.as_ref().map(|c| c.inputs.clone()))).collect()
    };
    let same = earlier.suite == report.suite && earlier.shader == report.shader && told(earlier) == told(report);
    (same && !report.errors().is_empty()).then_some(&**earlier)
}

/// True for the words of an identity matrix in binary32.
fn is_identity(name: &str, bits: &[u32]) -> bool {
    let size = match bits.len() {
        4 => 2,
        9 => 3,
        16 => 4,
        _ => return false,
    };
    let one = |k: usize| k.is_multiple_of(size + 1);
    name.starts_with("mat") && bits.iter().enumerate().all(|(k, &b)| b == if one(k) { 1.0_f32.to_bits() } else { 0 })
}

/// Words of an input that are shown; a longer one is cut in the middle, the command has it whole.
const SHOWN: usize = 16;

/// One finding with all that is known about it.
pub(super) fn block(on: &str, shader: &str, finding: &Finding) -> String {
    let mut text = String::new();
    one(&mut text, on, shader, finding, false, false);
    text
}

/// One finding. Its inputs and the command are left out when an earlier finding has `told` them.
fn one(text: &mut String, on: &str, shader: &str, finding: &Finding, told: bool, color: bool) {
    let style = Style::new(color);
    let _ = writeln!(text, "\n{}{on}: {}{}", style.bold, finding.message, style.off);
    let _ = writeln!(text, "  file       {shader}");
    if finding.count > 0 {
        let _ = writeln!(text, "  samples    {}", finding.count);
    }
    if let Some(case) = &finding.case {
        case_text(text, case, told);
    }
    if let Some(command) = finding.reproduce.as_ref().filter(|_| !told) {
        let _ = writeln!(text, "  reproduce  {command}");
    }
}

fn case_text(text: &mut String, case: &Case, told: bool) {
    // A case that was asked for is shown as it is.
    let mut label = if case.tried > 0 { "smallest" } else { "case" };
    if told {
        let _ = writeln!(text, "  {label:<9}  as above");
    }
    for InputValue { name, bits, decimal } in case.inputs.iter().filter(|_| !told) {
        if is_identity(name, bits) {
            let _ = writeln!(text, "  {label:<9}  {name} = identity");
            label = "";
            continue;
        }
        let shown = bits.len().min(SHOWN);
        let more = if bits.len() > shown { format!(", … {} more", bits.len() - shown) } else { String::new() };
        let hex: Vec<String> = bits[..shown].iter().map(|b| format!("{b:08x}")).collect();
        let _ = writeln!(text, "  {label:<9}  {name} = {}{more}", decimal[..shown].join(", "));
        let _ = writeln!(text, "             bits {}{more}", hex.join(" "));
        label = "";
    }
    if let Some((deviation, value)) = case.deviation.as_ref().and_then(|d| Some((d, d.value()?)))
        && value.scalar == Scalar::F32
    {
        sides(text, &case.against, deviation, value);
    }
    origins(text, &case.diagnosis);
    if case.tried > 0 && !told {
        let _ = writeln!(text, "  shrunk     in {} rounds from {} candidates", case.rounds, case.tried);
    }
}

/// Where a deviation comes from.
fn origins(text: &mut String, diagnosis: &Diagnosis) {
    let Diagnosis { literals, no_value, origin, divergence } = diagnosis;
    for literal in literals {
        let _ = writeln!(text, "  because    {literal}");
    }
    if let Some(no_value) = no_value {
        let _ = writeln!(text, "  because    {no_value}");
    }
    if let Some(origin) = origin {
        let _ = writeln!(text, "  because    {origin}");
    }
    if let Some(divergence) = divergence {
        let _ = writeln!(text, "  first at   {divergence}");
    }
}

/// A component on all sides.
fn sides(text: &mut String, against: &str, deviation: &Deviation, value: &Value) {
    let Value { component, expected, meaning, actual, bound, .. } = value;
    if let Some(expected) = expected {
        let label = if against == "expectation" { "expected" } else { against };
        let _ = writeln!(text, "  {label:<9}  {component} = {expected:?}");
    }
    let allowed = if deviation.blame == Blame::Lane { format!(" ± {bound:.1e}") } else { String::new() };
    let _ = writeln!(text, "  shader     {component} = {meaning:?}{allowed}");
    let bits = F32Bits(*actual);
    let _ = writeln!(text, "  lane       {component} = {bits} (0x{actual:08x}, {})", bits.to_hex_float());
    let found = match deviation.blame {
        Blame::Shader => *meaning,
        Blame::Lane => f64::from(bits.to_f32()),
    };
    let off = (found - deviation.target(value)).abs();
    // The distance of a NaN is NaN, and that of an expected 0 in ULP is astronomical.
    if off.is_finite() {
        let ulp = off / crate::value::ulp_at(deviation.target(value));
        let ulp = if ulp < 1e9 { format!("{ulp:.1}") } else { format!("{ulp:.1e}") };
        let times = match deviation.blame {
            Blame::Lane if *bound > 0.0 => format!("{:.1} times what is allowed, ", off / bound),
            Blame::Lane | Blame::Shader => String::new(),
        };
        let _ = writeln!(text, "  off by     {off:.3e}: {times}{ulp} ULP");
    }
}

/// How outputs differ from those of inputs in storage.
fn differs(apart: &Apart) -> String {
    let Apart { samples, different, ulp, component } = apart;
    let most =
        if ulp.is_finite() && *ulp > 0.0 { format!(", by {ulp} ULP of `{component}` at most") } else { String::new() };
    format!("{different} of {samples} samples have other bits than with inputs in storage{most}")
}

/// Kinds of doubt that are told for each suite.
const DOUBTS: usize = 3;

/// The last lines: what lanes were held against, lanes that are missing, facts about coverage, totals.
pub fn totals(summary: &Summary, color: bool) -> String {
    let style = Style::new(color);
    let mut text = super::survey::warnings(summary);
    for entry in &summary.entries {
        if let Outcome::Ran(report) = &entry.outcome
            && let Some(coverage) = &report.coverage
            && coverage.is_complete()
        {
            let _ = writeln!(text, "note: {}: {coverage}", on(report));
        }
        if let Outcome::Ran(report) = &entry.outcome {
            let on = on(report);
            // A few more samples of the same inputs are in doubt for the same reasons.
            let few = matches!(report.source, Some(Source::Constants | Source::Uniforms));
            if let Some(apart) = report.apart.as_ref().filter(|a| a.different > 0) {
                let _ = writeln!(text, "note: {on}: {}", differs(apart));
            }
            for texture in &report.textures {
                let _ = writeln!(text, "note: {on}: texture {texture}");
            }
            for doubtful in report.doubts.iter().take(if few { 0 } else { DOUBTS }) {
                let _ = writeln!(text, "note: {on}: {doubtful}");
            }
        }
        if let Outcome::Ran(report) = &entry.outcome
            && report.replayed > 0
            && report.verdicts.seen() > report.replayed
        {
            let on = on(report);
            let _ = writeln!(text, "note: {on}: saved cases that ran first: {}", report.replayed);
        }
    }
    for LaneUsed { description, against } in &summary.lanes {
        let promises: Vec<&str> =
            [&against.promise].into_iter().chain(&against.conformance).map(String::as_str).collect();
        let measured = match &against.measured {
            Some(measured) => format!("measured profile {measured}"),
            None => "no measured profile".to_owned(),
        };
        let _ = writeln!(text, "note: lane `{}`: promises of {}; {measured}", description.name, promises.join(", "));
    }
    text.push_str(&super::translations::notes(summary));
    for (name, why) in &summary.unavailable {
        let _ = writeln!(text, "note: lane `{name}` did not run: {why}");
    }
    let t = summary.totals();
    let (word, paint) = match summary.status() {
        crate::suite::run::Status::Pass => ("pass", style.good),
        crate::suite::run::Status::Fail => ("fail", style.bad),
        crate::suite::run::Status::Broken => ("not run", style.bad),
    };
    let _ = writeln!(
        text,
        "{paint}{word}{}: {} judged, {} agreed, {} deviated, {} undetermined, {} unsupported",
        style.off, t.judged, t.agreed, t.deviated, t.undetermined, t.unsupported
    );
    text
}

#[cfg(test)]
mod tests {
    use super::is_identity;

    #[test]
    fn only_the_identity_is_called_so() {
        let one = 1.0_f32.to_bits();
        let mut bits: Vec<u32> = (0..16).map(|k| if k % 5 == 0 { one } else { 0 }).collect();
        assert!(is_identity("mat4 mc", &bits));
        assert!(!is_identity("float[16] w", &bits));
        // -0 is another word than 0.
        bits[1] = 0x8000_0000;
        assert!(!is_identity("mat4 mc", &bits));
    }
}
