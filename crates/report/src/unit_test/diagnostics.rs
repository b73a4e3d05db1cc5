//! What is wrong with an expectation, at its place.

use std::fmt::Write as _;

use super::{FileReport, Summary, TestReport};
use crate::word::readable;
use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::counted;
use engine::unit_test::{Expectation, Kind, OnLane, Verdict};

/// An expectation does not hold.
const FAILS: Code = Code("U001");
/// An expectation holds where it ran, and a conforming device may break it.
const MAY_FAIL: Code = Code("U002");
/// A test expects nothing.
const NOTHING: Code = Code("U003");
/// Whether an expectation holds elsewhere is not known.
const UNKNOWN: Code = Code("U004");
/// An expectation holds of a value that is none.
const NO_VALUE: Code = Code("U005");

/// What is wrong with a test.
pub(super) fn of(summary: &Summary, file: &FileReport, test: &TestReport) -> Vec<Diagnostic> {
    let Ok(ran) = &test.outcome else { return Vec::new() };
    let new = |code, severity, expectation: Option<&Expectation>, message: String| {
        let span = expectation.and_then(|own| own.site).unwrap_or(test.span);
        Diagnostic::new(code, severity, &file.file, span, message)
    };
    if ran.expectations.is_empty() {
        let message = format!("test `{}` expects nothing, so that it cannot fail", test.name);
        return vec![new(NOTHING, Severity::Warning, None, message).with_help("expect something of a value")];
    }
    let one = |own: &Expectation| match own.verdict {
        Verdict::Holds { .. } => None,
        Verdict::Fails => {
            let (message, label) = failure(own);
            let new = new(FAILS, Severity::Error, Some(own), format!("test `{}`: {message}", test.name));
            let new = new.with_label(label);
            Some(match why(own, &summary.profile) {
                Some(why) => new.with_why(why),
                None => new,
            })
        }
        Verdict::MayFail { component, apart, allowed } => {
            let severity = if summary.strict { Severity::Error } else { Severity::Warning };
            let message = format!(
                "test `{}` may fail on another device: its tolerance is smaller than what {} allows",
                test.name, summary.profile
            );
            let label = format!(
                "{}the two may be {} apart, and {} is allowed",
                of_component(own, component),
                readable(apart),
                readable(allowed)
            );
            Some(new(MAY_FAIL, severity, Some(own), message).with_label(label).with_help(wider(own, component, apart)))
        }
        Verdict::NoValue => {
            let severity = if summary.strict { Severity::Error } else { Severity::Warning };
            let message = format!("test `{}` passes by luck: in real numbers this has no finite value", test.name);
            Some(new(NO_VALUE, severity, Some(own), message).with_help("other devices may give something else, or NaN"))
        }
        Verdict::Undecided => Some(new(
            UNKNOWN,
            Severity::Info,
            Some(own),
            format!("test `{}`: a decision on the way may fall either way on another device", test.name),
        )),
        Verdict::Unpromised => Some(new(
            UNKNOWN,
            Severity::Info,
            Some(own),
            format!("test `{}`: {} promises nothing of this value", test.name, summary.profile),
        )),
    };
    // A call that is reached several times is told once, where it is farthest off.
    let mut worst: Vec<&Expectation> = Vec::new();
    for own in &ran.expectations {
        let alike = |other: &&mut &Expectation| {
            let same = std::mem::discriminant(&other.verdict) == std::mem::discriminant(&own.verdict);
            same && own.site.is_some() && other.site == own.site
        };
        match worst.iter_mut().find(alike) {
            Some(other) if excess(own) > excess(other) => *other = own,
            Some(_) => {}
            None => worst.push(own),
        }
    }
    worst.into_iter().filter_map(one).collect()
}

/// How many times the two are farther apart than they may be, where that is what is wrong.
fn excess(own: &Expectation) -> f64 {
    match own.verdict {
        Verdict::MayFail { apart, allowed, .. } => apart / allowed,
        _ => 0.0,
    }
}

/// `z: `, where there are several.
fn of_component(own: &Expectation, component: usize) -> String {
    match own.real.len() {
        0 | 1 => String::new(),
        _ => format!("{}: ", ["x", "y", "z", "w"].get(component).unwrap_or(&"")),
    }
}

/// What does not hold in a sentence, and the numbers.
fn failure(own: &Expectation) -> (String, String) {
    let failing: Vec<&OnLane> = own.lanes.iter().filter(|lane| !lane.holds).collect();
    let names: Vec<&str> = failing.iter().map(|lane| lane.lane).collect();
    let on = match failing.len() {
        n if n == own.lanes.len() => String::new(),
        _ => format!(" on {}", names.join(", ")),
    };
    let Some(first) = failing.first() else { return Default::default() };
    let found = &first.found;
    match own.kind {
        Kind::Condition => (format!("the condition is false{on}"), "false".to_owned()),
        Kind::Equal => {
            let [actual, expected] = found.words.map(u32::cast_signed);
            (format!("{actual} is not {expected}{on}"), format!("{actual}, and {expected} is expected"))
        }
        Kind::Near { .. } | Kind::Ulp(_) => {
            let worst = worst(found.actual.iter().zip(&found.expected));
            let (a, b) = (found.actual[worst], found.expected[worst]);
            let part = of_component(own, worst);
            let message = if a.is_nan() || b.is_nan() {
                format!("a value is not a number{on}")
            } else {
                format!("{a:?} is too far from {b:?}{on}")
            };
            let mut label = format!("{part}{a:?}, and {b:?} is expected");
            let apart = (f64::from(a) - f64::from(b)).abs();
            let allowed = match own.kind {
                Kind::Near { relative, absolute } => {
                    readable(absolute.max(relative * f64::from(a).abs().max(f64::from(b).abs())))
                }
                Kind::Ulp(most) => format!("{most} ULP"),
                Kind::Condition | Kind::Equal => String::new(),
            };
            if apart.is_finite() {
                let _ = write!(label, "; {} apart, and {allowed} is allowed", readable(apart));
            }
            (message, label)
        }
    }
}

/// The component that is farthest off; one that is no number first.
fn worst<'f>(both: impl Iterator<Item = (&'f f32, &'f f32)>) -> usize {
    let apart = both.map(|(a, b)| if a == b { 0.0 } else { (a - b).abs() });
    let far = apart.map(|apart| if apart.is_nan() { f32::INFINITY } else { apart });
    far.enumerate().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map_or(0, |(at, _)| at)
}

/// Whose fault it is, as far as that is known.
fn why(own: &Expectation, profile: &str) -> Option<String> {
    let failing = || own.lanes.iter().filter(|lane| !lane.holds);
    if let Some(lane) = failing().find(|lane| lane.deviates) {
        return Some(format!("`{}` is farther off than {profile} allows: the device is at fault", lane.lane));
    }
    if own.real.iter().any(|(a, b)| !a.value.is_finite() || !b.value.is_finite()) {
        return Some("in real numbers it has no finite value: a device that gives one does so by luck".to_owned());
    }
    if own.real.iter().any(|(a, b)| !a.bound.is_finite() || !b.bound.is_finite()) {
        return Some(format!("{profile} promises nothing of this value"));
    }
    if failing().count() == own.lanes.len() || matches!(own.kind, Kind::Condition | Kind::Equal) {
        return None;
    }
    Some(format!("{profile} allows what each lane gives: the tolerance is too small for some devices"))
}

/// The tolerance that would do.
fn wider(own: &Expectation, component: usize, apart: f64) -> String {
    let Some((actual, expected)) = own.real.get(component) else { return String::new() };
    let larger = actual.value.abs().max(expected.value.abs());
    let up = |x: f64| {
        let step = 10_f64.powf(x.log10().floor() - 1.0);
        readable((x / step).ceil() * step)
    };
    match own.kind {
        Kind::Ulp(_) => {
            let ulp = base::value::ulp_at(expected.value);
            format!("allow {}", counted((apart / ulp).ceil() as u64, "ULP").trim_end_matches('s'))
        }
        _ if larger > 0.0 && apart > larger => {
            "so much is lost here that no tolerance helps; `shadercheck fuzz` shows where".to_owned()
        }
        _ if larger > 0.0 => {
            format!("allow {} of the value (relative), or {} (absolute)", up(apart / larger), up(apart))
        }
        _ => format!("allow {} (absolute)", up(apart)),
    }
}
