//! Relations: what must hold between outputs of related inputs. They are checked on what the shader
//! means and on the lane's own values.

use super::finding::{self, Finding, FindingKind};
use super::position::{self, Place, Tied};
use super::related::{Inputs, KeptKnown, Known, Wanted};
use super::trial::{Among, Trial};
use super::{Part, Prepared, Request};
use crate::activity;
use base::value::Batch;
use judge::verdict::diagnosis::{CrossCheck, Diagnosis, Stand};
use judge::verdict::{JudgeContext, Slack, dependences, meaning, observe, observe_again, slack};
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
    let kept = Some(&prepared.known);
    let all = outcomes(trial, &prepared.relations, &samples, None, kept)?;
    for (relation, outcomes) in prepared.relations.iter().zip(all) {
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
            part.findings.push(vacuous(&**relation, samples.len()));
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
    relations: Vec<Own<dyn Relation>>,
    inputs: Inputs,
}

impl Probes {
    /// The inputs of all relations of a suite.
    pub fn new(prepared: &Prepared, seed: u64) -> Self {
        let samples = samples(prepared, seed, SAMPLES);
        Self { relations: prepared.relations.clone(), inputs: Inputs::of(&prepared.relations, &samples) }
    }

    /// The first relation that the meaning of a shader does not keep on some sample, by name.
    pub fn first_broken(&self, context: &JudgeContext<'_>) -> Option<&str> {
        let meant = meaning(context, &self.inputs.batch()?);
        let broken = |(k, relation): &(usize, &Own<dyn Relation>)| {
            let outcomes = of_meaning(context, &***relation, &self.inputs.wanted[*k], &self.inputs, &meant);
            outcomes.iter().any(|outcome| matches!(outcome, Outcome::Fails(_)))
        };
        self.relations.iter().enumerate().find(broken).map(|(_, relation)| relation.name())
    }
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

/// What each relation says of samples: of what the shader means, and where that keeps it or says nothing, of the lane's
/// values, which stand among other invocations where that is asked for.
fn outcomes(
    trial: &mut Trial<'_>,
    relations: &[Own<dyn Relation>],
    samples: &[Sample],
    among: Option<Among>,
    kept: Option<&KeptKnown>,
) -> Result<Vec<Vec<Outcome>>, LaneError> {
    let inputs = Inputs::of(relations, samples);
    let Some(batch) = inputs.batch() else {
        return Ok(relations.iter().map(|_| samples.iter().map(|_| Outcome::Silent).collect()).collect());
    };
    let context = trial.context();
    let known = kept.map_or_else(
        || Known::of(&context, &batch),
        |kept| kept.of(&context, trial.prepared.is_lowered(context.oracle), &inputs, &batch),
    );
    let mut all = Vec::with_capacity(relations.len());
    for (relation, wanted) in relations.iter().zip(&inputs.wanted) {
        let meant = of_meaning(&context, &**relation, wanted, &inputs, &known.meant);
        let seen = of_lane(trial, &**relation, (wanted, &inputs), &known.slack, among)?;
        let both = meant.into_iter().zip(seen).map(|both| match both {
            (Outcome::Fails(claim), _) | (_, Outcome::Fails(claim)) => Outcome::Fails(claim),
            (Outcome::HoldsAsMeant, _) | (_, Outcome::HoldsAsMeant) => Outcome::HoldsAsMeant,
            (Outcome::Holds, _) | (_, Outcome::Holds) => Outcome::Holds,
            (Outcome::Silent, Outcome::Silent) => Outcome::Silent,
        });
        let mut outcomes: Vec<Outcome> = both.collect();
        silence_undefined(trial.prepared, wanted, &inputs, &mut outcomes);
        all.push(outcomes);
    }
    Ok(all)
}

/// [`outcomes`] of one relation.
fn outcomes_of(
    trial: &mut Trial<'_>,
    relation: &Own<dyn Relation>,
    samples: &[Sample],
    among: Option<Among>,
) -> Result<Vec<Outcome>, LaneError> {
    let mut outcomes = outcomes(trial, std::slice::from_ref(relation), samples, among, None)?;
    Ok(outcomes.remove(0))
}

/// Undefined values are a finding of their own, and need not be related.
fn silence_undefined(prepared: &Prepared, wanted: &[Wanted], inputs: &Inputs, outcomes: &mut [Outcome]) {
    let failing = || outcomes.iter().zip(wanted).filter(|(outcome, _)| matches!(outcome, Outcome::Fails(_)));
    let flat: Vec<Sample> = failing().flat_map(|(_, wanted)| inputs.samples(wanted)).collect();
    if flat.is_empty() {
        return;
    }
    let mut found = dependences(&prepared.oracle, &Sample::batch(&flat)).into_iter();
    for (outcome, wanted) in outcomes.iter_mut().zip(wanted) {
        let undefined = |one: Option<_>| one.flatten().is_some();
        if matches!(outcome, Outcome::Fails(_)) && wanted.iter().fold(false, |any, _| undefined(found.next()) | any) {
            *outcome = Outcome::Silent;
        }
    }
}

/// What a relation says of the meaning of a shader, which is `meant` for each of the inputs.
fn of_meaning(
    context: &JudgeContext<'_>,
    relation: &dyn Relation,
    wanted: &[Wanted],
    inputs: &Inputs,
    meant: &[Observed],
) -> Vec<Outcome> {
    let meant: Vec<Observed> = wanted.iter().flatten().map(|&input| meant[input].clone()).collect();
    as_meant(context, relation, (wanted, inputs), &meant, &mut |reading, batch, _| meaning(reading, batch))
}

/// What a relation says of the values that a lane gives for its inputs, one after the other, among other invocations.
/// `slack` is how far each of the inputs may be off.
fn of_lane(
    trial: &mut Trial<'_>,
    relation: &dyn Relation,
    (wanted, inputs): (&[Wanted], &Inputs),
    known: &Slack,
    among: Option<Among>,
) -> Result<Vec<Outcome>, LaneError> {
    let context = trial.context();
    let order: Wanted = wanted.iter().flatten().copied().collect();
    let Some(&first) = order.first() else { return Ok(wanted.iter().map(|_| Outcome::Silent).collect()) };
    let flat: Vec<Sample> = inputs.samples(&order).collect();
    let (all, before) = among.map_or_else(|| (flat.clone(), 0), |among| trial.among(&flat, among));
    let input_at = |place: usize| place.checked_sub(before).and_then(|at| order.get(at)).copied().unwrap_or(first);
    let mut seen = Vec::with_capacity(all.len());
    trial.run_samples(&all, |at, _, actual| {
        seen.extend(observe(&context, actual, |invocation| known[input_at(at + invocation)].as_slice()));
    })?;
    let seen = &seen[before..before + flat.len()];
    Ok(as_meant(&context, relation, (wanted, inputs), seen, &mut |reading, batch, places| {
        let slack = slack(reading, batch);
        places.iter().zip(&slack).map(|(&place, slack)| observe_again(reading, &seen[place], slack)).collect()
    }))
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
    let inputs = Inputs::of(std::slice::from_ref(relation), std::slice::from_ref(sample));
    let Some(batch) = inputs.batch() else { return Ok(Stand::Open) };
    let known = slack(&trial.context(), &batch);
    let mut stand = Stand::Open;
    for among in AMONG {
        let seen = of_lane(trial, &**relation, (&inputs.wanted[0], &inputs), &known, Some(among))?;
        match seen.first() {
            Some(Outcome::Holds | Outcome::HoldsAsMeant) => return Ok(Stand::Right),
            Some(Outcome::Fails(_)) => stand = Stand::Wrong,
            Some(Outcome::Silent) | None => {}
        }
    }
    Ok(stand)
}

/// What a relation says of each sample, from the outputs of its inputs one after the other.
fn verdicts(relation: &dyn Relation, wanted: &[Wanted], inputs: &Inputs, outputs: &[Observed]) -> Vec<Outcome> {
    let mut rest = outputs;
    let one = |wanted: &Wanted| {
        let (outputs, behind) = rest.split_at(wanted.len());
        rest = behind;
        judge(relation, &inputs.samples(wanted).collect::<Vec<_>>(), outputs)
    };
    wanted.iter().map(one).collect()
}

/// The outputs of a batch by a reading; the places are those of its invocations among all outputs.
type Read<'r> = dyn FnMut(&JudgeContext<'_>, &Batch, &[usize]) -> Vec<Observed> + 'r;

/// What a relation says of each sample as it is written, and where it fails, by the first reading of the program's literals
/// by which it does not.
fn as_meant(
    context: &JudgeContext<'_>,
    relation: &dyn Relation,
    (wanted, inputs): (&[Wanted], &Inputs),
    written: &[Observed],
    see: &mut Read<'_>,
) -> Vec<Outcome> {
    let mut outcomes = verdicts(relation, wanted, inputs, written);
    for reading in context.readings() {
        let (mut failing, mut places, mut at) = (Vec::new(), Vec::new(), 0);
        for (sample, wanted) in wanted.iter().enumerate() {
            if matches!(outcomes[sample], Outcome::Fails(_)) {
                failing.push(sample);
                places.extend(at..at + wanted.len());
            }
            at += wanted.len();
        }
        if failing.is_empty() {
            break;
        }
        let again: Vec<Wanted> = failing.iter().map(|&sample| wanted[sample].clone()).collect();
        let batch = Sample::batch(&again.iter().flat_map(|wanted| inputs.samples(wanted)).collect::<Vec<_>>());
        let mut read = see(&reading, &batch, &places);
        // What moves an output too far is no reading of it.
        for (k, near) in context.may_read(&reading, &batch).into_iter().enumerate() {
            if !near {
                read[k] = written[places[k]].clone();
            }
        }
        for (sample, outcome) in failing.into_iter().zip(verdicts(relation, &again, inputs, &read)) {
            match outcome {
                Outcome::Fails(_) => {}
                Outcome::Holds => outcomes[sample] = Outcome::HoldsAsMeant,
                outcome => outcomes[sample] = outcome,
            }
        }
    }
    outcomes
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
    relation: &Own<dyn Relation>,
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
        let again = outcomes_of(trial, relation, &moved, Some(among))?;
        let (steady, others): (Vec<_>, Vec<_>) =
            moved.into_iter().zip(again).partition(|(_, outcome)| matches!(outcome, Outcome::Fails(_)));
        first.extend(others.into_iter().map(|(sample, _)| sample));
        moved = steady.into_iter().map(|(sample, _)| sample).collect();
    }
    // What is not to be made simpler: it is wrong by its place, or by chance.
    let as_given = request.replay_only || moved.is_empty();
    let first: Vec<Sample> = moved.into_iter().chain(first).take(SHRUNK).collect();
    let mut oracle = |samples: &[Sample]| -> Result<Vec<bool>, LaneError> {
        let outcomes = outcomes_of(trial, relation, samples, None)?;
        Ok(outcomes.iter().map(|o| matches!(o, Outcome::Fails(_))).collect())
    };
    let shrunk = if as_given { finding::as_given(first) } else { activity::shrink(first, &*plan, &mut oracle)? };
    let Some(simplest) = shrunk.into_iter().next() else { return Ok(()) };
    let one = std::slice::from_ref(&simplest.sample);
    let mut outcome = outcomes_of(trial, relation, one, Some(AMONG[0]))?.into_iter().next();
    if matches!(outcome, Some(Outcome::Fails(_))) {
        outcome = outcomes_of(trial, relation, one, Some(AMONG[1]))?.into_iter().next();
    }
    let Some(Outcome::Fails(claim)) = outcome else {
        // The same inputs gave another answer: nothing that was found may get lost over it.
        if let Some(tied) = by_place(trial, &**relation, request, &simplest.sample)? {
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
    let inputs = relation.inputs(&simplest.sample);
    let meant = meaning(&trial.context(), &Sample::batch(&inputs));
    let of_the_shader = matches!(judge(&**relation, &inputs, &meant), Outcome::Fails(_));
    let diagnosis = Diagnosis {
        relation: Some(relation.name().to_owned()),
        cross_check: of_the_shader.then(CrossCheck::of_the_shader),
        ..Diagnosis::default()
    };
    part.findings.push(Finding {
        kind: FindingKind::Relation,
        message: broken(&**relation, &claim),
        count,
        reproduce: Some(finding::reproduce(request, part.on(), &simplest.sample)),
        case: Some(finding::Case { diagnosis, ..finding::case(&trial.prepared.program, &simplest, None) }),
    });
    part.failing.push(simplest.sample);
    Ok(())
}
