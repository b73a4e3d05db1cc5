//! How far a device may be off in the expression at a place.

use std::fmt::Write as _;

use engine::accuracy::{Accuracy, Worst, accuracy};
use engine::fuzz::{Domain, subjects, subjects_of_module};
use engine::suite::read_module;
use engine::suite::run::DEFAULT_SEED;
use judge::profile::by_name;
use lsp::Probe;
use program::Written;
use syntax::Shader;

/// What bounds are derived from: what every conforming device keeps.
const PROFILE: &str = "vulkan-1.4";

/// Inputs that are looked at: an answer is wanted at once.
const SAMPLES: usize = 1 << 11;

/// Part of the bound from which on an operation is named.
const NAMED: f64 = 0.1;

/// What is told about the result of a function; none where it cannot be run or nothing bounds it.
pub(super) fn told(probe: &Probe) -> Option<String> {
    let wanted = |name: &str| name == probe.function;
    let all = match Written::of(&probe.file) {
        Written::Glsl => subjects(&Shader::parse(&probe.file, probe.stage).shader, &wanted).ok()?,
        _ => subjects_of_module(&read_module(&probe.file).ok()?, &[], &wanted).ok()?,
    };
    let [subject] = all.as_slice() else { return None };
    let ready = subject.ready.as_ref().ok()?;
    let (invocation, case) = (ready.kernel.invocation.fields(), ready.kernel.case.fields());
    let domain = Domain::new(&subject.name, invocation, case, &subject.stated);
    let found = accuracy(subject, &domain, by_name(PROFILE)?, SAMPLES, DEFAULT_SEED).ok()?;
    text(&found)
}

fn text(found: &Accuracy) -> Option<String> {
    let Worst { inputs, ulp, loses, most } = found.worst.as_ref().filter(|worst| worst.ulp > 0.0)?;
    let at: Vec<String> = inputs.iter().map(|i| format!("{} = {}", i.shown(), i.values())).collect();
    let at = if at.is_empty() { String::new() } else { format!(", at `{}`", at.join("`, `")) };
    let mut text = format!("a conforming device ({PROFILE}) is off by {} at worst{at}", in_ulp(*ulp));
    let line = |place: &judge::verdict::diagnosis::Place| {
        place.at.position.map_or(String::new(), |p| format!(" (line {})", p.line))
    };
    if let Some((place, condition)) = loses {
        let _ = write!(
            text,
            "\n\n`{}`{} loses the bits: it enlarges errors {} times",
            place.text,
            line(place),
            number(*condition)
        );
    }
    if let Some((place, part)) = most.as_ref().filter(|(_, part)| *part >= NAMED) {
        let _ = write!(text, "\n\n{:.0} % of it is the error of `{}`{}", part * 100.0, place.text, line(place));
    }
    let open = found.samples - found.bounded;
    if open > 0 {
        let _ = write!(text, "\n\nnothing bounds it for {open} of {} inputs", found.samples);
    }
    Some(text)
}

fn in_ulp(ulp: f64) -> String {
    let lost = if ulp >= f64::from(1 << 23) { ", so that no digit is sure," } else { "" };
    format!("{} ULP{lost}", number(ulp))
}

fn number(x: f64) -> String {
    if x < 1e5 { format!("{x:.1}") } else { format!("{x:.1e}") }
}
