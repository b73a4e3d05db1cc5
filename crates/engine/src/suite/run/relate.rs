//! Relations: what must hold between outputs of related inputs. They are checked on what the shader
//! means and on the lane's own values.

use super::finding::{self, Finding, FindingKind};
use super::position::{self, Place, Tied};
use super::trial::{Among, Trial};
use super::{Part, Prepared, Request};
use crate::activity;
use base::value::Batch;
use judge::verdict::diagnosis::{CrossCheck, Diagnosis, Stand};
use judge::verdict::{JudgeContext, dependences, meaning, observe};
use lanes::LaneError;
use property::{Claim, Observed, Own, Relation, Sample, Sampler};

/// Samples for which each relation is checked. Each takes a few runs and an evaluation of the
/// formula for each input, so there are fewer of them than of plain samples.
pub(super) const SAMPLES: u64 = 512;
/// The same for a short run.
pub(super) const QUICK_SAMPLES: u64 = 96;
/// What the arithmetic of a relation may add, relative to the largest output: some tens of operations
/// in binary64.
const ROUNDING: f64 = 1.0 / (1_u64 << 44) as f64;
/// Places in which inputs are run again: at both ends of a batch of some work groups.
const AMONG: [Among; 2] = [Among { before: 0, behind: 192 }, Among { before: 192, behind: 0 }];
/// Failing samples of a relation that are looked at again.
const LOOKED: usize = 32;
/// Failing samples of a relation that are shrunk.
const SHRUNK: usize = 4;

/// Checks every relation of the suite, on the replayed samples and then on `many` generated ones: a saved
/// sample may have failed a relation alone.
pub fn check(trial: &mut Trial<'_>, request: &Request, many: u64, part: &mut Part) -> Result<(), LaneError> {
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
        let outcomes = outcomes(trial, relation, &samples, None)?;
        let checked = outcomes.iter().filter(|o| !matches!(o, Outcome::Silent)).count() as u64;
        part.reread += outcomes.iter().filter(|o| matches!(o, Outcome::HoldsAsMeant)).count() as u64;
        part.relations.push((relation.name().to_owned(), checked));
        let failing: Vec<Sample> = samples
            .iter()
            .zip(&outcomes)
            .filter(|(_, o)| matches!(o, Outcome::Fails(_)))
            .map(|(s, _)| s.clone())
            .collect();
        // A handful of samples may well miss what a relation is about.
        if checked == 0 && !request.replay_only && many >= QUICK_SAMPLES {
            part.findings.push(vacuous(relation, samples.len()));
        }
        if !failing.is_empty() {
            fail(trial, relation, failing, request, part)?;
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
    pub fn first_broken(&self, context: &JudgeContext<'_>) -> Option<&str> {
        let broken = |probe: &&Probe| {
            let relation = &*probe.relation;
            let observed =
                probe.batch.as_ref().map_or_else(Vec::new, |batch| read(context, batch, &mut |c| meaning(c, batch)));
            as_meant(relation, &probe.inputs, observed).iter().any(|o| matches!(o, Outcome::Fails(_)))
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
pub(super) fn samples(prepared: &Prepared, seed: u64, count: u64) -> Vec<Sample> {
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
pub(super) enum Outcome {
    /// It says nothing here: it does not apply, or an output that it needs has no value.
    Silent,
    Holds,
    /// It holds where literals stand for the constants that they round.
    HoldsAsMeant,
    Fails(Claim),
}

/// What a relation says of samples: of what the shader means, and where that keeps it or says nothing,
/// of the lane's values, which stand among other invocations where that is asked for.
fn outcomes(
    trial: &mut Trial<'_>,
    relation: &dyn Relation,
    samples: &[Sample],
    among: Option<Among>,
) -> Result<Vec<Outcome>, LaneError> {
    let (inputs, batch) = related(relation, samples);
    let Some(batch) = batch else { return Ok(samples.iter().map(|_| Outcome::Silent).collect()) };
    let context = trial.context();
    let meant = as_meant(relation, &inputs, read(&context, &batch, &mut |context| meaning(context, &batch)));
    let seen = observed(trial, &inputs, among)?;
    let seen = as_meant(relation, &inputs, seen);
    let both = meant.into_iter().zip(seen).map(|both| match both {
        (Outcome::Fails(claim), _) | (_, Outcome::Fails(claim)) => Outcome::Fails(claim),
        (Outcome::HoldsAsMeant, _) | (_, Outcome::HoldsAsMeant) => Outcome::HoldsAsMeant,
        (Outcome::Holds, _) | (_, Outcome::Holds) => Outcome::Holds,
        (Outcome::Silent, Outcome::Silent) => Outcome::Silent,
    });
    let mut outcomes: Vec<Outcome> = both.collect();
    silence_undefined(trial.prepared, &inputs, &mut outcomes);
    Ok(outcomes)
}

/// Undefined values are a finding of their own, and need not be related.
fn silence_undefined(prepared: &Prepared, inputs: &[Vec<Sample>], outcomes: &mut [Outcome]) {
    let failing = || outcomes.iter().zip(inputs).filter(|(outcome, _)| matches!(outcome, Outcome::Fails(_)));
    let flat: Vec<Sample> = failing().flat_map(|(_, inputs)| inputs.iter().cloned()).collect();
    if flat.is_empty() {
        return;
    }
    let mut found = dependences(&prepared.oracle, &Sample::batch(&flat)).into_iter();
    for (outcome, inputs) in outcomes.iter_mut().zip(inputs) {
        let undefined = |one: Option<_>| one.flatten().is_some();
        if matches!(outcome, Outcome::Fails(_)) && inputs.iter().fold(false, |any, _| undefined(found.next()) | any) {
            *outcome = Outcome::Silent;
        }
    }
}

/// What a lane gives for the inputs of a relation, one after the other, among other invocations: for the shader as it is
/// written, and then as each reading of its literals has it.
fn observed(
    trial: &mut Trial<'_>,
    inputs: &[Vec<Sample>],
    among: Option<Among>,
) -> Result<Vec<Vec<Observed>>, LaneError> {
    let context = trial.context();
    let flat: Vec<Sample> = inputs.iter().flatten().cloned().collect();
    let mut seen: Vec<Vec<Observed>> = vec![Vec::with_capacity(flat.len()); 1 + context.readings().len()];
    let (all, before) = among.map_or_else(|| (flat.clone(), 0), |among| trial.among(&flat, among));
    trial.run_samples(&all, |_, batch, actual| {
        let some = read(&context, batch, &mut |context| observe(context, batch, actual));
        seen.iter_mut().zip(some).for_each(|(all, some)| all.extend(some));
    })?;
    for seen in &mut seen {
        seen.drain(..before.min(seen.len()));
        seen.truncate(flat.len());
    }
    Ok(seen)
}

/// What the values of a lane for a sample say of a relation, wherever in a batch they stand.
///
/// # Errors
/// [`LaneError`] when the lane fails.
pub(super) fn stand_of(trial: &mut Trial<'_>, name: &str, sample: &Sample) -> Result<Stand, LaneError> {
    let prepared = trial.prepared;
    let Some(relation) = prepared.relations.iter().find(|relation| relation.name() == name) else {
        return Ok(Stand::Open);
    };
    let inputs = [relation.inputs(sample)];
    let mut stand = Stand::Open;
    for among in AMONG {
        let seen = observed(trial, &inputs, Some(among))?;
        match as_meant(&**relation, &inputs, seen).first() {
            Some(Outcome::Holds | Outcome::HoldsAsMeant) => return Ok(Stand::Right),
            Some(Outcome::Fails(_)) => stand = Stand::Wrong,
            Some(Outcome::Silent) | None => {}
        }
    }
    Ok(stand)
}

/// What a relation gets to see of the shader as it is written, and then as each reading of its literals has it.
fn read(
    context: &JudgeContext<'_>,
    batch: &Batch,
    see: &mut dyn FnMut(&JudgeContext<'_>) -> Vec<Observed>,
) -> Vec<Vec<Observed>> {
    let mut all = vec![see(context)];
    for reading in context.readings() {
        let mut seen = see(&reading);
        // What moves an output too far is no reading of it.
        for (k, near) in context.may_read(&reading, batch).into_iter().enumerate() {
            if !near {
                seen[k] = all[0][k].clone();
            }
        }
        all.push(seen);
    }
    all
}

/// What a relation says of each sample as it is written, and where it fails, by the first reading by which it does not.
fn as_meant(relation: &dyn Relation, inputs: &[Vec<Sample>], observed: Vec<Vec<Observed>>) -> Vec<Outcome> {
    let mut all: Vec<Outcome> = Vec::new();
    for seen in observed {
        let outcomes = verdicts(relation, inputs, seen);
        if all.is_empty() {
            all = outcomes.collect();
            continue;
        }
        for (outcome, read) in all.iter_mut().zip(outcomes) {
            if matches!(outcome, Outcome::Fails(_)) && !matches!(read, Outcome::Fails(_)) {
                *outcome = if matches!(read, Outcome::Holds) { Outcome::HoldsAsMeant } else { read };
            }
        }
    }
    all
}

/// What a relation says of the outputs of its inputs.
pub(super) fn judge(relation: &dyn Relation, inputs: &[Sample], outputs: &[Observed]) -> Outcome {
    let mut claims = Vec::new();
    if !inputs.is_empty() {
        relation.claims(inputs, outputs, &mut claims);
    }
    // An output without value, or one that the inputs' rounding decides.
    let blind = outputs.iter().any(|o| o.slack.iter().any(|s| s.is_infinite()));
    // Outputs may be exact; the relation computes with them in binary64, which is not.
    let size = outputs.iter().flat_map(|o| &o.words).fold(0.0_f64, |m, w| m.max(w.abs()));
    let mut outcome = Outcome::Silent;
    for claim in claims {
        if blind && !claim.slack.is_finite() {
            continue;
        }
        // Written so that a NaN anywhere does not hold.
        if (claim.left - claim.right).abs() <= claim.slack + ROUNDING * size {
            outcome = Outcome::Holds;
        } else {
            return Outcome::Fails(claim);
        }
    }
    outcome
}

/// That a relation does not hold, as a sentence without a full stop.
pub(super) fn broken(relation: &dyn Relation, claim: &Claim) -> String {
    format!(
        "the relation `{}` does not hold: {}; {} is {:?} on one side and {:?} on the other, ± {:.1e}",
        relation.name(),
        relation.statement(),
        claim.what,
        claim.left,
        claim.right,
        claim.slack
    )
}

/// The finding about a relation that applies to none of the samples on which it was checked.
pub(super) fn vacuous(relation: &dyn Relation, samples: usize) -> Finding {
    Finding {
        kind: FindingKind::Vacuous,
        message: format!("the relation `{}` applied to none of {samples} samples", relation.name()),
        case: None,
        count: 0,
        reproduce: None,
    }
}

/// Whether the lane errs by place in batches like those in which relations run.
fn by_place(
    trial: &mut Trial<'_>,
    relation: &dyn Relation,
    request: &Request,
    sample: &Sample,
) -> Result<Option<Tied>, LaneError> {
    let many = relation.inputs(sample).len().max(1) * if request.quick { QUICK_SAMPLES } else { SAMPLES } as usize;
    let count = many.min(trial.capacity());
    position::probe(trial, request, sample, Place { at: 0, count, per_case: 1 })
}

fn fail(
    trial: &mut Trial<'_>,
    relation: &dyn Relation,
    failing: Vec<Sample>,
    request: &Request,
    part: &mut Part,
) -> Result<(), LaneError> {
    let count = failing.len() as u64;
    let plan = trial.prepared.plan.clone();
    let mut first: Vec<Sample> = Vec::new();
    // What holds in another place is no matter of the inputs.
    let mut moved: Vec<Sample> = failing.into_iter().take(LOOKED).collect();
    for among in AMONG {
        let again = outcomes(trial, relation, &moved, Some(among))?;
        let (steady, others): (Vec<_>, Vec<_>) =
            moved.into_iter().zip(again).partition(|(_, outcome)| matches!(outcome, Outcome::Fails(_)));
        first.extend(others.into_iter().map(|(sample, _)| sample));
        moved = steady.into_iter().map(|(sample, _)| sample).collect();
    }
    // What is not to be made simpler: it is wrong by its place, or by chance.
    let as_given = request.replay_only || moved.is_empty();
    let first: Vec<Sample> = moved.into_iter().chain(first).take(SHRUNK).collect();
    let mut oracle = |samples: &[Sample]| -> Result<Vec<bool>, LaneError> {
        let outcomes = outcomes(trial, relation, samples, None)?;
        Ok(outcomes.iter().map(|o| matches!(o, Outcome::Fails(_))).collect())
    };
    let shrunk = if as_given { finding::as_given(first) } else { activity::shrink(first, &*plan, &mut oracle)? };
    let Some(simplest) = shrunk.into_iter().next() else { return Ok(()) };
    let one = std::slice::from_ref(&simplest.sample);
    let mut outcome = outcomes(trial, relation, one, Some(AMONG[0]))?.into_iter().next();
    if matches!(outcome, Some(Outcome::Fails(_))) {
        outcome = outcomes(trial, relation, one, Some(AMONG[1]))?.into_iter().next();
    }
    let Some(Outcome::Fails(claim)) = outcome else {
        // The same inputs gave another answer: nothing that was found may get lost over it.
        if let Some(tied) = by_place(trial, relation, request, &simplest.sample)? {
            part.findings.push(finding::tied(request, part, &simplest.sample, tied, trial.prepared));
            return Ok(());
        }
        part.findings.push(Finding {
            kind: FindingKind::Flaky,
            message: format!(
                "flaky: the relation `{}` failed, and held when it was checked again: the lane is not deterministic",
                relation.name()
            ),
            count,
            reproduce: Some(finding::reproduce(request, part.on(), &simplest.sample)),
            case: Some(finding::case(&trial.prepared.program, &simplest, None)),
        });
        return Ok(());
    };
    let inputs = [relation.inputs(&simplest.sample)];
    let meant = meaning(&trial.context(), &Sample::batch(&inputs[0]));
    let of_the_shader = matches!(verdicts(relation, &inputs, meant).next(), Some(Outcome::Fails(_)));
    let diagnosis = Diagnosis {
        relation: Some(relation.name().to_owned()),
        cross_check: of_the_shader.then(CrossCheck::of_the_shader),
        ..Diagnosis::default()
    };
    part.findings.push(Finding {
        kind: FindingKind::Relation,
        message: broken(relation, &claim),
        count,
        reproduce: Some(finding::reproduce(request, part.on(), &simplest.sample)),
        case: Some(finding::Case { diagnosis, ..finding::case(&trial.prepared.program, &simplest, None) }),
    });
    part.failing.push(simplest.sample);
    Ok(())
}
