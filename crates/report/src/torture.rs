//! What random programs found, as text and JSON.

use std::fmt::Write;

use base::text::counted;
use engine::torture::{Cause, Found};
use lanes::Description;
use serde_json::{Value, json};

/// A run.
#[derive(Debug, Default)]
pub struct Summary {
    /// Seed of the programs.
    pub seed: u64,
    /// The command line up to the number of a program.
    pub command: String,
    /// Lanes that ran.
    pub lanes: Vec<Description>,
    /// What was found.
    pub found: Found,
    /// How long it took; 0 where parts were joined.
    pub seconds: f64,
    /// The signal that ended it.
    pub interrupted: Option<u8>,
}

/// A cause in one line.
pub fn line(cause: &Cause) -> String {
    let blamed = if cause.blamed.is_empty() { String::new() } else { format!(" ({})", cause.blamed) };
    let message = cause.message.lines().next().unwrap_or_default();
    format!("{} on {}{blamed}: {message}", cause.kind.name(), cause.on)
}

/// The run as text.
pub fn text(summary: &Summary) -> String {
    let mut text = String::new();
    let found = &summary.found;
    for (number, cause) in found.causes.iter().enumerate() {
        let _ = writeln!(text, "{}. {}", number + 1, line(cause));
        let programs = if cause.count == 1 { "program" } else { "programs" };
        let _ = writeln!(
            text,
            "   {} {programs}; made smaller from {} to {} statements and operands in {} trials",
            cause.count, cause.sizes.0, cause.sizes.1, cause.tried
        );
        for line in cause.folder.text().lines() {
            let _ = writeln!(text, "   | {line}");
        }
        let _ = writeln!(text, "   reproduce: {} --first {} --programs 1\n", summary.command, cause.program);
    }
    for (why, (count, first)) in &found.refused {
        let _ = writeln!(text, "note: not run by {why} ({count} programs, the first is {first})");
    }
    for (lane, (programs, samples)) in &found.lanes {
        let _ = writeln!(text, "note: lane {lane}: {programs} programs, {samples} samples");
    }
    if summary.seconds > 0.0 {
        let rate = found.programs as f64 / summary.seconds;
        let _ = writeln!(text, "note: {rate:.1} programs a second");
    }
    if let Some(signal) = summary.interrupted {
        let _ = writeln!(text, "note: the run was ended by signal {signal}; this is what it had found");
    }
    let _ = writeln!(
        text,
        "{}: {}, {} agreed, {} undetermined, {} undetermined as a whole, {}",
        if found.fails() { "FAIL" } else { "pass" },
        counted(found.programs, "program"),
        counted(found.agreed, "sample"),
        found.undetermined,
        counted(found.vacuous, "program"),
        counted(found.causes.len() as u64, "finding")
    );
    text
}

/// The run as JSON.
pub fn json(summary: &Summary) -> String {
    let found = &summary.found;
    let cause = |cause: &Cause| {
        json!({
            "kind": cause.kind,
            "on": cause.on,
            "blamed": cause.blamed,
            "message": cause.message,
            "cause": cause.key,
            "language": cause.language,
            "form": cause.form,
            "program": cause.program,
            "programs": cause.count,
            "size": { "before": cause.sizes.0, "after": cause.sizes.1, "tried": cause.tried },
            "folder": cause.folder.name,
            "text": cause.folder.text(),
            "reproduce": format!("{} --first {} --programs 1", summary.command, cause.program),
        })
    };
    let refused =
        |(why, (count, first)): (&String, &(u64, u64))| json!({ "why": why, "programs": count, "first": first });
    let lane = |description: &Description| {
        let (programs, samples) = found.lanes.get(description.name).copied().unwrap_or_default();
        json!({ "lane": description.name, "driver": description.driver, "programs": programs, "samples": samples })
    };
    let value = json!({
        "schema": "shadercheck.torture",
        "schema_version": 1,
        "seed": summary.seed,
        "interrupted": summary.interrupted,
        "programs": found.programs,
        "forms": found.forms,
        "agreed": found.agreed,
        "undetermined": found.undetermined,
        "vacuous": found.vacuous,
        "lanes": summary.lanes.iter().map(lane).collect::<Vec<Value>>(),
        "refused": found.refused.iter().map(refused).collect::<Vec<Value>>(),
        "findings": found.causes.iter().map(cause).collect::<Vec<Value>>(),
    });
    format!("{value:#}\n")
}
