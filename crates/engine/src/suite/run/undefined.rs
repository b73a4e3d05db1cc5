//! Findings about values that the language leaves undefined: the shader is at fault, and no lane is asked.
//!
//! An undefined value that goes away with other values of inputs marked `guessed = true` is a warning, since it may
//! rest on the guess; one that stays for all of them is an error.

use std::convert::Infallible;

use super::finding::{self, Finding, FindingKind};
use super::part::{Failing, Shown};
use super::{Part, Prepared, Request};
use crate::activity;
use base::value::Scalar;
use judge::verdict::diagnosis::Place;
use judge::verdict::{Fenced, dependences};
use program::interp::{Dependence, author_span};
use property::shrink::Shrunk;
use property::{Sample, pattern};

/// Operations that are told of one suite.
const REPORTED: usize = 4;

/// Shrinks samples that depend on undefined values, one for each operation, and reports them; first the one at which
/// the executor failed outright, if it did.
pub(super) fn findings(
    (prepared, fenced): (&Prepared, Option<&Fenced>),
    failing: &[Failing],
    request: &Request,
    part: &Part,
) -> Vec<Shown> {
    let mut shown: Vec<Shown> = fenced.into_iter().map(|fenced| at_failure(prepared, fenced, request, part)).collect();
    if failing.is_empty() {
        return shown;
    }
    let samples: Vec<Sample> = failing.iter().map(|failing| failing.sample(&prepared.plan)).collect();
    let found = dependences(&prepared.oracle, &Sample::batch(&samples));
    for ((sample, failing), found) in samples.into_iter().zip(failing).zip(found) {
        let Some(found) = found else { continue };
        let alike = Some(format!("{:?}", found.of));
        if shown.len() == REPORTED || shown.iter().any(|shown| shown.alike == alike) {
            continue;
        }
        let shrunk = if request.replay_only { finding::unshrunk(sample) } else { smallest(prepared, sample, &found) };
        let words = [&shrunk.sample.case[..], &shrunk.sample.invocation[..]].concat();
        let again = dependences(&prepared.oracle, &Sample::batch(std::slice::from_ref(&shrunk.sample)));
        let found = again.into_iter().flatten().next().unwrap_or(found);
        let mut case = finding::case(&prepared.program, &shrunk, None);
        case.diagnosis.written = place(prepared, &found);
        let guesses = guesses(prepared, &shrunk.sample, &found);
        let finding = Finding {
            kind: if guesses.is_some() { FindingKind::Guessed } else { FindingKind::Undefined },
            message: message(prepared, &found) + &guesses.unwrap_or_default(),
            case: Some(case),
            // Known when all parts of the run are.
            count: 0,
            reproduce: Some(finding::reproduce(request, part.on(), &shrunk.sample)),
        };
        shown.push(Shown { number: failing.number, alike, words, finding, sample: Some(shrunk.sample) });
    }
    shown
}

/// A failure of the executor where the shader's behaviour is undefined. Which smaller sample would bring it about, only
/// more failures could tell.
fn at_failure(prepared: &Prepared, fenced: &Fenced, request: &Request, part: &Part) -> Shown {
    let shrunk = finding::unshrunk(fenced.sample.clone());
    let words = [&shrunk.sample.case[..], &shrunk.sample.invocation[..]].concat();
    let mut case = finding::case(&prepared.program, &shrunk, None);
    case.diagnosis.written = place(prepared, &fenced.because);
    let finding = Finding {
        kind: FindingKind::Undefined,
        message: format!("{}; {}", message(prepared, &fenced.because), fenced.error.at_undefined()),
        case: Some(case),
        count: 0,
        reproduce: Some(finding::reproduce(request, part.on(), &shrunk.sample)),
    };
    let alike = Some(format!("{:?}", fenced.because.of));
    Shown { number: 0, alike, words, finding, sample: Some(shrunk.sample) }
}

/// The smallest sample that depends on the same operation.
fn smallest(prepared: &Prepared, sample: Sample, found: &Dependence) -> Shrunk {
    let same = |other: &Option<Dependence>| other.as_ref().is_some_and(|other| other.of == found.of);
    let mut oracle = |samples: &[Sample]| -> Result<Vec<bool>, Infallible> {
        Ok(dependences(&prepared.oracle, &Sample::batch(samples)).iter().map(same).collect())
    };
    match activity::shrink(vec![sample.clone()], &*prepared.plan, &mut oracle) {
        Ok(shrunk) => shrunk.into_iter().next().unwrap_or_else(|| finding::unshrunk(sample)),
        Err(never) => match never {},
    }
}

/// What is undefined, where and why.
fn message(prepared: &Prepared, found: &Dependence) -> String {
    let at = place(prepared, found).map_or_else(String::new, |place| format!("{place}: "));
    format!("the shader gives an undefined value: {at}{}", found.of.why(&found.args))
}

/// The guesses that it comes of, as the end of a message; none where every input is stated, and where it stays undefined
/// whatever the guessed inputs are.
fn guesses(prepared: &Prepared, sample: &Sample, found: &Dependence) -> Option<String> {
    let guessed = &prepared.suite.guessed;
    if guessed.is_empty() {
        return None;
    }
    let is_guessed = |name: &str| guessed.iter().any(|group| group.names.iter().any(|own| *own == pattern(name)));
    let others: Vec<Sample> = OTHERS.iter().map(|&other| with_others(sample, other, &is_guessed)).collect();
    let same = |other: &Option<Dependence>| other.as_ref().is_some_and(|other| other.of == found.of);
    if dependences(&prepared.oracle, &Sample::batch(&others)).iter().all(same) {
        return None;
    }
    let lines: Vec<String> = guessed
        .iter()
        .take(REPORTED)
        .map(|group| {
            let names: Vec<String> = group.names.iter().map(|name| format!("`{name}`")).collect();
            format!("{} ({})", group.at, names.join(", "))
        })
        .collect();
    let more = match guessed.len().saturating_sub(REPORTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Some(format!(
        "; these inputs are guessed: set `range` to what programs give, and delete `guessed = true`, at {}{more}",
        lines.join(", ")
    ))
}

/// Numbers that guessed inputs are tried with, real ones and whole ones.
const OTHERS: [(f32, u32); 6] = [(0.5, 0), (1.0, 1), (2.0, 2), (4.0, 3), (0.0, 7), (-1.0, 64)];

/// The sample with another number in each word of some inputs.
fn with_others(sample: &Sample, (real, whole): (f32, u32), which: &dyn Fn(&str) -> bool) -> Sample {
    let mut other = sample.clone();
    let Sample { invocation, case, invocation_record, case_record } = &mut other;
    for (words, record) in [(invocation, invocation_record), (case, case_record)] {
        for (k, field) in record.fields().iter().enumerate().filter(|(_, field)| which(&field.name)) {
            let number = match field.shape.scalar {
                Scalar::F32 => real.to_bits(),
                Scalar::I32 | Scalar::U32 => whole,
                Scalar::Bool => whole & 1,
            };
            words[record.range(k)].fill(number);
        }
    }
    other
}

/// Where it becomes undefined.
fn place(prepared: &Prepared, found: &Dependence) -> Option<Place> {
    let (program, executable) = (&prepared.program, prepared.oracle.executable());
    let span = author_span(program, &executable.place(found.of.site))?;
    Some(Place::of(&program.file, span))
}
