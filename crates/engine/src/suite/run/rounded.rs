//! Literals that round a constant: what each does to the outputs, told as a warning.

use super::finding::{self, Finding, FindingKind};
use super::trial::Trial;
use super::{Part, Request, relate};
use crate::activity;
use judge::verdict::diagnosis::{Diagnosis, Place, ShortLiteral};
use judge::verdict::{Effect, Rounded, effects};
use lanes::LaneError;
use property::Sample;

/// Samples on which the effect of a literal is looked for.
const SAMPLES: u64 = 2048;
/// The same for a short run.
const QUICK_SAMPLES: u64 = 256;
/// Samples that are shrunk.
const SHRUNK: usize = 4;

/// What each literal of the suite's shader that rounds a constant does to the outputs. Whether that is told follows from
/// the whole run: where the shader is right with the digits that are written, nobody needs to know.
pub(super) fn look(trial: &Trial<'_>, request: &Request, part: &Part) -> Result<Vec<Finding>, LaneError> {
    let prepared = trial.prepared;
    let literals = prepared.oracle.rounded_constants();
    if literals.is_empty() {
        return Ok(Vec::new());
    }
    let many = if request.quick { QUICK_SAMPLES } else { SAMPLES };
    let mut samples = request.replay.clone();
    if !request.replay_only {
        samples.extend(relate::samples(prepared, request.seed, many));
    }
    let mut found = Vec::new();
    for literal in literals.iter().filter(|literal| literal.is_seen()) {
        found.extend(one(trial, request, part, literal, &samples)?);
    }
    Ok(found)
}

fn one(
    trial: &Trial<'_>,
    request: &Request,
    part: &Part,
    literal: &Rounded,
    samples: &[Sample],
) -> Result<Option<Finding>, LaneError> {
    let (prepared, context) = (trial.prepared, trial.context());
    let seen = |samples: &[Sample]| effects(&context, &prepared.program, literal, &Sample::batch(samples));
    let all = if samples.is_empty() { Vec::new() } else { seen(samples) };
    let ulp = |effect: &Option<Effect>| effect.as_ref().map_or(0.0, |effect| effect.ulp);
    let most = all.iter().map(ulp).fold(0.0_f64, f64::max);
    let Some(largest) = all.iter().flatten().find(|effect| effect.ulp >= most) else { return Ok(None) };
    // The simplest sample is one of those on which it does much.
    let shows = |effect: &Option<Effect>| ulp(effect) >= most / 2.0;
    let first: Vec<Sample> =
        samples.iter().zip(&all).filter(|(_, effect)| shows(effect)).map(|(s, _)| s.clone()).take(SHRUNK).collect();
    let mut oracle =
        |samples: &[Sample]| -> Result<Vec<bool>, LaneError> { Ok(seen(samples).iter().map(shows).collect()) };
    let shrunk = if request.replay_only {
        finding::as_given(first)
    } else {
        activity::shrink(first, &*prepared.plan.clone(), &mut oracle)?
    };
    let Some(simplest) = shrunk.into_iter().next() else { return Ok(None) };
    let file = &prepared.program.file;
    let place = Place::of(file, literal.span);
    let Rounded { name, meant, digits, .. } = literal;
    let case = finding::case(&prepared.program, &simplest, None);
    let message = format!(
        "{place} is {name} in {digits} digits, and is judged as {name}: as it is written it moves `{}` by up to {:.1e} \
         ({:.1} ULP){}; write {meant:?}",
        largest.component,
        largest.error,
        largest.ulp,
        smallest(&case)
    );
    let short = ShortLiteral { place, stands_for: (*name).into(), off: (literal.written - literal.meant).abs() };
    let diagnosis = Diagnosis { literals: vec![short], ..Diagnosis::default() };
    let case = finding::Case { diagnosis, ..case };
    Ok(Some(Finding {
        kind: FindingKind::RoundedLiteral,
        message,
        reproduce: Some(finding::reproduce(request, part.on(), &simplest.sample)),
        case: Some(case),
        // Known when all parts of the run are.
        count: 0,
    }))
}

/// Inputs that fit into a sentence.
const SHORT: usize = 4;

/// The smallest input in words, as far as it is short.
fn smallest(case: &finding::Case) -> String {
    let short = case.inputs.iter().filter(|input| input.bits.len() <= SHORT).take(SHORT);
    let name = |name: &str| name.rsplit(' ').next().unwrap_or_default().to_owned();
    let all: Vec<String> = short.map(|input| format!("{} = {}", name(&input.name), input.decimal.join(", "))).collect();
    if all.is_empty() { String::new() } else { format!(", smallest input {}", all.join("; ")) }
}
