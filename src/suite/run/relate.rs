//! Relations: what must hold between outputs of related inputs, on the lane's own values.

use super::finding::{self, Finding, FindingKind};
use super::trial::Trial;
use super::{Prepared, Report, Request};
use crate::lane::LaneError;
use crate::property::{Claim, Observed, Relation, Sample, Sampler, shrink};
use crate::verdict::{Slack, observe, observed, slack};

/// Samples for which each relation is checked. Each takes a few runs and an evaluation of the
/// formula for each input, so there are fewer of them than of plain samples.
const SAMPLES: u64 = 512;
/// The same for a short run.
const QUICK_SAMPLES: u64 = 96;
/// Failing samples of a relation that are shrunk.
const SHRUNK: usize = 4;

/// Checks every relation of the suite, on the replayed samples and then on generated ones: a saved
/// sample may have failed a relation alone.
pub fn check(trial: &mut Trial<'_>, request: &Request, report: &mut Report) -> Result<(), LaneError> {
    let prepared = trial.prepared;
    if prepared.relations.is_empty() {
        return Ok(());
    }
    let mut all = request.replay.clone();
    if !request.replay_only {
        all.extend(samples(prepared, request.seed, if request.quick { QUICK_SAMPLES } else { SAMPLES }));
    }
    let samples = all;
    for &relation in &prepared.relations {
        let outcomes = outcomes(trial, relation, &samples)?;
        let checked = outcomes.iter().filter(|o| matches!(o, Outcome::Holds | Outcome::Fails(_))).count() as u64;
        report.relations.push((relation.name().to_owned(), checked));
        let failing: Vec<Sample> = samples
            .iter()
            .zip(&outcomes)
            .filter(|(_, o)| matches!(o, Outcome::Fails(_)))
            .map(|(s, _)| s.clone())
            .collect();
        if checked == 0 && !request.replay_only {
            report.findings.push(Finding {
                kind: FindingKind::Vacuous,
                message: format!("the relation `{}` applied to none of {} samples", relation.name(), samples.len()),
                case: None,
                count: 0,
                reproduce: None,
            });
        }
        if !failing.is_empty() {
            fail(trial, relation, failing, request, report)?;
        }
    }
    Ok(())
}

/// The relations of a suite with the inputs that they want to see, made once for many programs with
/// the same interface.
pub struct Probes {
    probes: Vec<Probe>,
}

struct Probe {
    relation: &'static dyn Relation,
    inputs: Vec<Vec<Sample>>,
    flat: Vec<Sample>,
    /// For each of `flat`, how far the words of a lane may be off.
    slack: Slack,
}

impl Probes {
    /// The inputs of all relations of a suite.
    pub fn new(trial: &Trial<'_>, seed: u64) -> Self {
        let prepared = trial.prepared;
        let samples = samples(prepared, seed, SAMPLES);
        let probe = |&relation: &&'static dyn Relation| {
            let inputs: Vec<Vec<Sample>> = samples.iter().map(|s| relation.inputs(s)).collect();
            let flat: Vec<Sample> = inputs.iter().flatten().cloned().collect();
            let slack =
                if flat.is_empty() { Slack::new() } else { slack(&trial.court(), &super::trial::batch_of(&flat)) };
            Probe { relation, inputs, flat, slack }
        };
        Self { probes: prepared.relations.iter().map(probe).collect() }
    }

    /// The first relation that does not hold on some sample, by name.
    ///
    /// # Errors
    /// [`LaneError`] when the lane fails.
    pub fn first_broken(&self, trial: &mut Trial<'_>) -> Result<Option<&'static str>, LaneError> {
        use rayon::prelude::*;
        let court = trial.court();
        for Probe { relation, inputs, flat, slack } in &self.probes {
            let mut observations: Vec<Observed> = Vec::with_capacity(flat.len());
            if !flat.is_empty() {
                trial.run_samples(flat, |first, batch, actual| {
                    let see = |i: usize| observed(&court, actual, i, &slack[first + i]);
                    let seen: Vec<Observed> = (0..batch.invocation_count()).into_par_iter().map(see).collect();
                    observations.extend(seen);
                })?;
            }
            let mut rest = observations.into_iter();
            let fails = inputs.iter().any(|inputs| {
                let outputs: Vec<Observed> = rest.by_ref().take(inputs.len()).collect();
                matches!(judge(*relation, inputs, &outputs), Outcome::Fails(_))
            });
            if fails {
                return Ok(Some(relation.name()));
            }
        }
        Ok(None)
    }
}

/// Samples of the suite's plan, whole strands where the suite has them.
fn samples(prepared: &Prepared, seed: u64, count: u64) -> Vec<Sample> {
    let per_case = prepared.suite.strands.map_or(1, |s| s.primitives()).max(1);
    let batch = Sampler::new(prepared.plan.clone(), seed).batch(0, (count as usize).div_ceil(per_case), per_case);
    (0..batch.invocation_count()).map(|i| super::trial::sample_of(&batch, i)).collect()
}

/// What a relation says of a sample.
enum Outcome {
    /// It says nothing here: it does not apply, or an output that it needs has no value.
    Silent,
    Holds,
    Fails(Claim),
}

fn outcomes(trial: &mut Trial<'_>, relation: &dyn Relation, samples: &[Sample]) -> Result<Vec<Outcome>, LaneError> {
    let inputs: Vec<Vec<Sample>> = samples.iter().map(|s| relation.inputs(s)).collect();
    let flat: Vec<Sample> = inputs.iter().flatten().cloned().collect();
    let mut observed: Vec<Observed> = Vec::with_capacity(flat.len());
    if !flat.is_empty() {
        let court = trial.court();
        trial.run_samples(&flat, |_, batch, actual| observed.extend(observe(&court, batch, actual)))?;
    }
    let mut rest = observed.into_iter();
    Ok(inputs
        .iter()
        .map(|inputs| {
            let outputs: Vec<Observed> = rest.by_ref().take(inputs.len()).collect();
            judge(relation, inputs, &outputs)
        })
        .collect())
}

fn judge(relation: &dyn Relation, inputs: &[Sample], outputs: &[Observed]) -> Outcome {
    let mut claims = Vec::new();
    if !inputs.is_empty() {
        relation.claims(inputs, outputs, &mut claims);
    }
    // An output without value, or one that the inputs' rounding decides.
    let blind = outputs.iter().any(|o| o.slack.iter().any(|s| s.is_infinite()));
    let mut outcome = Outcome::Silent;
    for claim in claims {
        if blind && !claim.slack.is_finite() {
            continue;
        }
        // Written so that a NaN anywhere does not hold.
        if (claim.left - claim.right).abs() <= claim.slack {
            outcome = Outcome::Holds;
        } else {
            return Outcome::Fails(claim);
        }
    }
    outcome
}

fn fail(
    trial: &mut Trial<'_>,
    relation: &dyn Relation,
    failing: Vec<Sample>,
    request: &Request,
    report: &mut Report,
) -> Result<(), LaneError> {
    let count = failing.len() as u64;
    let plan = trial.prepared.plan.clone();
    let first: Vec<Sample> = failing.into_iter().take(SHRUNK).collect();
    let mut oracle = |samples: &[Sample]| -> Result<Vec<bool>, LaneError> {
        let outcomes = outcomes(trial, relation, samples)?;
        Ok(outcomes.iter().map(|o| matches!(o, Outcome::Fails(_))).collect())
    };
    let shrunk =
        if request.replay_only { finding::as_given(first) } else { shrink::shrink(first, &*plan, &mut oracle)? };
    let Some(simplest) = shrunk.into_iter().next() else { return Ok(()) };
    let outcome = outcomes(trial, relation, std::slice::from_ref(&simplest.sample))?.into_iter().next();
    let Some(Outcome::Fails(claim)) = outcome else {
        // The same inputs gave another answer: nothing that was found may get lost over it.
        report.findings.push(Finding {
            kind: FindingKind::Relation,
            message: format!(
                "the relation `{}` failed, and held when it was checked again: the lane is not deterministic",
                relation.name()
            ),
            count,
            reproduce: Some(finding::reproduce(request, report, &simplest.sample)),
            case: Some(finding::case(&simplest, None)),
        });
        return Ok(());
    };
    report.findings.push(Finding {
        kind: FindingKind::Relation,
        message: format!(
            "the relation `{}` does not hold: {}; {} is {:?} on one side and {:?} on the other, ± {:.1e}",
            relation.name(),
            relation.statement(),
            claim.what,
            claim.left,
            claim.right,
            claim.slack
        ),
        count,
        reproduce: Some(finding::reproduce(request, report, &simplest.sample)),
        case: Some(finding::case(&simplest, None)),
    });
    report.failing.push(simplest.sample);
    Ok(())
}
