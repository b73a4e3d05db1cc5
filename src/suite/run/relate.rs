//! Relations: what must hold between outputs of related inputs. They are checked on what the shader
//! means and on the lane's own values.

use super::finding::{self, Finding, FindingKind};
use super::trial::Trial;
use super::{Prepared, Report, Request};
use crate::lane::LaneError;
use crate::property::{Claim, Observed, Own, Relation, Sample, Sampler, shrink};
use crate::value::Batch;
use crate::verdict::{Court, dependences, meaning, observe};

/// Samples for which each relation is checked. Each takes a few runs and an evaluation of the
/// formula for each input, so there are fewer of them than of plain samples.
pub(super) const SAMPLES: u64 = 512;
/// The same for a short run.
pub(super) const QUICK_SAMPLES: u64 = 96;
/// What the arithmetic of a relation may add, relative to the largest output: some tens of operations
/// in binary64.
const ROUNDING: f64 = 1.0 / (1_u64 << 44) as f64;
/// Failing samples of a relation that are shrunk.
const SHRUNK: usize = 4;

/// Checks every relation of the suite, on the replayed samples and then on `many` generated ones: a saved
/// sample may have failed a relation alone.
pub fn check(trial: &mut Trial<'_>, request: &Request, many: u64, report: &mut Report) -> Result<(), LaneError> {
    let prepared = trial.prepared;
    if prepared.relations.is_empty() {
        return Ok(());
    }
    let mut all = request.replay.clone();
    if !request.replay_only {
        all.extend(samples(prepared, request.seed, many));
    }
    let samples = all;
    for relation in &prepared.relations {
        let relation = &**relation;
        let outcomes = outcomes(trial, relation, &samples)?;
        let checked = outcomes.iter().filter(|o| matches!(o, Outcome::Holds | Outcome::Fails(_))).count() as u64;
        report.relations.push((relation.name().to_owned(), checked));
        let failing: Vec<Sample> = samples
            .iter()
            .zip(&outcomes)
            .filter(|(_, o)| matches!(o, Outcome::Fails(_)))
            .map(|(s, _)| s.clone())
            .collect();
        // A handful of samples may well miss what a relation is about.
        if checked == 0 && !request.replay_only && many >= QUICK_SAMPLES {
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
    relation: Own<dyn Relation>,
    inputs: Vec<Vec<Sample>>,
    /// All of them, one after the other; `None` when there are none.
    batch: Option<Batch>,
}

impl Probes {
    /// The inputs of all relations of a suite.
    pub fn new(prepared: &Prepared, seed: u64) -> Self {
        let samples = samples(prepared, seed, SAMPLES);
        let probe = |relation: &Own<dyn Relation>| {
            let (inputs, batch) = related(&**relation, &samples);
            Probe { relation: relation.clone(), inputs, batch }
        };
        Self { probes: prepared.relations.iter().map(probe).collect() }
    }

    /// The first relation that the meaning of a shader does not keep on some sample, by name.
    pub fn first_broken(&self, court: &Court<'_>) -> Option<&str> {
        let broken = |probe: &&Probe| {
            let observed = probe.batch.as_ref().map_or_else(Vec::new, |batch| meaning(court, batch));
            verdicts(&*probe.relation, &probe.inputs, observed).any(|o| matches!(o, Outcome::Fails(_)))
        };
        self.probes.iter().find(broken).map(|probe| probe.relation.name())
    }
}

/// What a relation wants to see for each sample, and all of it as a batch.
fn related(relation: &dyn Relation, samples: &[Sample]) -> (Vec<Vec<Sample>>, Option<Batch>) {
    let inputs: Vec<Vec<Sample>> = samples.iter().map(|s| relation.inputs(s)).collect();
    let flat: Vec<Sample> = inputs.iter().flatten().cloned().collect();
    let batch = (!flat.is_empty()).then(|| Sample::batch(&flat));
    (inputs, batch)
}

/// What a relation says of each sample, from the outputs of its inputs one after the other.
fn verdicts<'i>(
    relation: &'i dyn Relation,
    inputs: &'i [Vec<Sample>],
    observed: Vec<Observed>,
) -> impl Iterator<Item = Outcome> + 'i {
    let mut rest = observed.into_iter();
    inputs.iter().map(move |inputs| {
        let outputs: Vec<Observed> = rest.by_ref().take(inputs.len()).collect();
        judge(relation, inputs, &outputs)
    })
}

/// Samples of the suite's plan, whole strands where the suite has them.
fn samples(prepared: &Prepared, seed: u64, count: u64) -> Vec<Sample> {
    if !prepared.plan.makes_samples() {
        return prepared.rows.iter().take(count as usize).cloned().collect();
    }
    let per_case = prepared.suite.strands.map_or(1, |s| s.primitives()).max(1);
    let batch = Sampler::new(prepared.plan.clone(), seed).batch(0, (count as usize).div_ceil(per_case), per_case);
    // Whole strands, but for a handful.
    let most = if count < QUICK_SAMPLES { count as usize } else { usize::MAX };
    (0..batch.invocation_count().min(most)).map(|i| Sample::of(&batch, i)).collect()
}

/// What a relation says of a sample.
enum Outcome {
    /// It says nothing here: it does not apply, or an output that it needs has no value.
    Silent,
    Holds,
    Fails(Claim),
}

/// What a relation says of samples: of what the shader means, and where that keeps it or says nothing,
/// of the lane's values.
fn outcomes(trial: &mut Trial<'_>, relation: &dyn Relation, samples: &[Sample]) -> Result<Vec<Outcome>, LaneError> {
    let (inputs, batch) = related(relation, samples);
    let Some(batch) = batch else { return Ok(samples.iter().map(|_| Outcome::Silent).collect()) };
    let court = trial.court();
    let meant = verdicts(relation, &inputs, meaning(&court, &batch));
    let flat: Vec<Sample> = inputs.iter().flatten().cloned().collect();
    let mut seen: Vec<Observed> = Vec::with_capacity(flat.len());
    trial.run_samples(&flat, |_, batch, actual| seen.extend(observe(&court, batch, actual)))?;
    let both = meant.zip(verdicts(relation, &inputs, seen));
    // Undefined values are a finding of their own, and need not be related.
    let undefined = |inputs: &[Sample]| {
        let found = dependences(&trial.prepared.oracle, &Sample::batch(inputs));
        found.iter().any(Option::is_some)
    };
    Ok(both
        .zip(&inputs)
        .map(|(both, inputs)| match both {
            (Outcome::Fails(_), _) | (_, Outcome::Fails(_)) if undefined(inputs) => Outcome::Silent,
            (Outcome::Fails(claim), _) | (_, Outcome::Fails(claim)) => Outcome::Fails(claim),
            (Outcome::Holds, _) | (_, Outcome::Holds) => Outcome::Holds,
            (Outcome::Silent, Outcome::Silent) => Outcome::Silent,
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
        // Outputs may be exact; the relation computes with them in binary64, which is not.
        let size = outputs.iter().flat_map(|o| &o.words).fold(0.0_f64, |m, w| m.max(w.abs()));
        // Written so that a NaN anywhere does not hold.
        if (claim.left - claim.right).abs() <= claim.slack + ROUNDING * size {
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
            kind: FindingKind::Flaky,
            message: format!(
                "flaky: the relation `{}` failed, and held when it was checked again: the lane is not deterministic",
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
