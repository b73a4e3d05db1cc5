//! Asks the other lanes of a run for the samples on which one of them deviates.

use super::bundle::sample;
use super::finding::{Case, Finding};
use super::trial::{Among, Trial};
use super::{DEFAULT_SEED, Part, Prepared, position, relate};
use crate::activity;
use judge::profile::Promises;
use judge::verdict::diagnosis::{CrossCheck, Position, Stand, Witness, stand};
use judge::verdict::{Blame, Deviation, Verdict, judge_at};
use lanes::{Actual, Lane, LaneError, LaneName, Stage};
use program::InputSource;
use property::Sample;

/// Batches of others beside which a sample is looked at that these disturb.
const BESIDE: u64 = 12;

/// Invocations beside the samples.
const MOVED: usize = Among::ALL[0].behind;

/// A lane of the run, with what its results are held against.
#[derive(Clone, Copy)]
pub struct Peer<'a> {
    /// Where samples are run once more.
    pub lane: &'a dyn Lane,
    /// What its results are held against.
    pub promises: &'a Promises,
}

impl Peer<'_> {
    /// Name of the lane.
    pub fn name(&self) -> LaneName {
        self.lane.description().name
    }
}

/// A finding with a sample, and where it was found.
struct Accused<'f> {
    lane: LaneName,
    stage: Stage,
    source: Option<InputSource>,
    case: &'f mut Case,
}

impl Accused<'_> {
    fn deviation(&self) -> Option<&Deviation> {
        self.case.deviation.as_ref()
    }
}

/// A sample on which a lane deviates from the shader: of a shader that deviates from its formula no lane has a say.
fn accused<'f>(
    findings: impl Iterator<Item = &'f mut Finding>,
    (lane, stage, source): (LaneName, Stage, Option<InputSource>),
) -> impl Iterator<Item = Accused<'f>> {
    let blamed = |case: &&mut Case| {
        let deviates = case.deviation.as_ref().is_some_and(|d| d.blame == Blame::Lane);
        case.diagnosis.cross_check.is_none() && (deviates || case.diagnosis.relation.is_some())
    };
    let cases = findings.filter_map(|finding| finding.case.as_mut()).filter(blamed);
    cases.map(move |case| Accused { lane, stage, source, case })
}

/// Asks every lane of a run for the samples on which one deviates, after all of them ran a suite. What follows for
/// whose fault it is stands in the diagnosis of each finding.
pub fn cross_check(prepared: &Prepared, peers: &[Peer<'_>], parts: &mut [Part]) {
    let found = parts.iter_mut().flat_map(|part| {
        let on = (part.lane, part.stage, part.source);
        accused(part.shown_mut(), on)
    });
    all(prepared, peers, found.collect());
}

fn all(prepared: &Prepared, peers: &[Peer<'_>], accused: Vec<Accused<'_>>) {
    if accused.is_empty() {
        return;
    }
    let _doing = activity::doing(format!("asks the other lanes about `{}`", prepared.suite.name));
    let mut sources: Vec<Option<InputSource>> = accused.iter().map(|accused| accused.source).collect();
    sources.dedup();
    let mut left = accused;
    for source in sources {
        let (now, later): (Vec<_>, Vec<_>) = left.into_iter().partition(|accused| accused.source == source);
        left = later;
        from(prepared, peers, source, now);
    }
}

/// Asks all lanes for samples with inputs from one source.
fn from(prepared: &Prepared, peers: &[Peer<'_>], source: Option<InputSource>, mut accused: Vec<Accused<'_>>) {
    let samples: Vec<Sample> = accused.iter().map(|accused| sample(prepared, accused.case)).collect();
    let mut collected: Vec<Vec<Witness>> = vec![Vec::new(); accused.len()];
    let witness = |peer: &Peer<'_>, stage, stand, word| Witness {
        front_end: peer.lane.front_end(&prepared.program),
        ..Witness::new(peer.lane.description(), stage, stand, word)
    };
    for peer in peers {
        for stage in stages(prepared, *peer, source) {
            let given = given(prepared, *peer, stage, source, &samples, &accused);
            match given {
                Ok(given) => {
                    for (collected, (stand, word)) in collected.iter_mut().zip(given) {
                        collected.push(witness(peer, stage, stand, word));
                    }
                }
                // What it cannot run it says nothing about.
                Err(LaneError::Unsupported(_)) => {}
                Err(error) => {
                    let stand = if error.is_failure() { Stand::Failed } else { Stand::Open };
                    collected.iter_mut().for_each(|h| h.push(witness(peer, stage, stand, None)));
                }
            }
        }
    }
    for (accused, mut witnesses) in accused.iter_mut().zip(collected) {
        let own = |w: &Witness| w.lane == accused.lane && w.stage == accused.stage;
        let word = accused.deviation().and_then(Deviation::value).map(|value| value.actual);
        // The lane that is accused comes first, with what it gave when it was asked like the others.
        witnesses.sort_by_key(|w| !own(w));
        match witnesses.first_mut().filter(|w| own(w)) {
            Some(first) if matches!(first.stand, Stand::Right | Stand::Failed) => {}
            Some(first) => (first.stand, first.word) = (Stand::Wrong, word),
            None => {
                let Some(peer) = peers.iter().find(|peer| peer.lane.description().name == accused.lane) else {
                    continue;
                };
                witnesses.insert(0, witness(peer, accused.stage, Stand::Wrong, word));
            }
        }
        let diagnosis = &mut accused.case.diagnosis;
        diagnosis.cross_check = Some(match &diagnosis.position {
            Some(position) => CrossCheck::at(witnesses, position),
            None => CrossCheck::of(witnesses),
        });
    }
}

/// Stages in which a lane can be asked.
fn stages(prepared: &Prepared, peer: Peer<'_>, source: Option<InputSource>) -> Vec<Stage> {
    match source {
        Some(source) => vec![super::stage_of(source)],
        None => prepared.suite.stages(peer.lane),
    }
}

/// What a lane says of each sample.
fn given(
    prepared: &Prepared,
    peer: Peer<'_>,
    stage: Stage,
    source: Option<InputSource>,
    samples: &[Sample],
    accused: &[Accused<'_>],
) -> Result<Vec<(Stand, Option<u32>)>, LaneError> {
    let mut trial = trial(prepared, peer, stage, source, samples.len() + MOVED)?;
    let mut all = Vec::with_capacity(samples.len());
    // In two places each: a lane that errs by place says nothing about the inputs there.
    let first = plain(&mut trial, samples, accused, Among::ALL[0])?;
    let second = plain(&mut trial, samples, accused, Among::ALL[1])?;
    for ((k, one), other) in first.into_iter().enumerate().zip(second) {
        let Case { diagnosis, .. } = &*accused[k].case;
        all.push(match (&diagnosis.relation, &diagnosis.position) {
            (Some(relation), _) => (relate::stand_of(&mut trial, relation, &samples[k])?, None),
            (None, Some(position)) => in_place(prepared, peer, stage, source, &samples[k], position, &accused[k])?,
            (None, None) => {
                if one.0 == Stand::Right || other.0 == Stand::Open {
                    one
                } else {
                    other
                }
            }
        });
    }
    Ok(all)
}

/// What a lane says of samples, each in some place of one batch.
fn plain(
    trial: &mut Trial<'_>,
    samples: &[Sample],
    accused: &[Accused<'_>],
    among: Among,
) -> Result<Vec<(Stand, Option<u32>)>, LaneError> {
    let context = trial.context();
    let mut all = Vec::with_capacity(samples.len());
    trial.run_among(samples, among, |sample, place, batch, actual| {
        all.push(said(&accused[sample], actual, place, &judge_at(&context, batch, actual, place)));
    })?;
    Ok(all)
}

/// What follows from the outputs of an invocation.
fn said(accused: &Accused<'_>, actual: &Actual, at: usize, verdict: &Verdict) -> (Stand, Option<u32>) {
    let Some(deviation) = accused.deviation() else { return (Stand::Open, None) };
    let word = deviation.value().and_then(|value| {
        let record = &actual.layout().vertex;
        let word = (0..record.words()).find(|&word| record.word_name(word) == value.component)?;
        let vertex = value.vertex.unwrap_or(0);
        (vertex < actual.stored(at)).then(|| actual.vertex(at, vertex)[word])
    });
    (stand(deviation, verdict, word), word)
}

/// What a lane says of a sample in the place in which it failed, behind a batch of other samples.
fn in_place(
    prepared: &Prepared,
    peer: Peer<'_>,
    stage: Stage,
    source: Option<InputSource>,
    sample: &Sample,
    position: &Position,
    accused: &Accused<'_>,
) -> Result<(Stand, Option<u32>), LaneError> {
    let Position { invocation, count, per_case, ref wrong, disturbed, .. } = *position;
    let mut trial = trial(prepared, peer, stage, source, count)?;
    if trial.capacity() < count {
        return Ok((Stand::Open, None));
    }
    if disturbed {
        // Not all others disturb it.
        let mut all = (Stand::Open, None);
        for salt in 0..BESIDE {
            let mut batch = position::others(&trial, DEFAULT_SEED ^ salt, sample, count, per_case);
            position::put(&mut batch, invocation, sample);
            let actual = trial.run(&batch)?;
            all = said(accused, &actual, invocation, &judge_at(&trial.context(), &batch, &actual, invocation));
            if all.0 != Stand::Right {
                break;
            }
        }
        return Ok(all);
    }
    let mut batch = position::others(&trial, DEFAULT_SEED, sample, count, per_case);
    trial.run(&batch)?;
    if wrong.is_empty() {
        position::put(&mut batch, invocation, sample);
    } else {
        batch = position::filled(sample, count, per_case);
    }
    let actual = trial.run(&batch)?;
    let verdict = judge_at(&trial.context(), &batch, &actual, invocation);
    Ok(said(accused, &actual, invocation, &verdict))
}

/// A lane ready for so many samples.
fn trial<'a>(
    prepared: &'a Prepared,
    Peer { lane, promises }: Peer<'a>,
    stage: Stage,
    source: Option<InputSource>,
    most: usize,
) -> Result<Trial<'a>, LaneError> {
    match (source, prepared.kernel(stage)) {
        (Some(source), _) => Trial::from_source(prepared, lane, source, promises, most),
        (None, Some(kernel)) => Ok(Trial::with_capacity(prepared, lane, kernel, promises, most)?.in_stage(stage)),
        (None, None) => Err(LaneError::Unsupported(format!("the {stage} stage"))),
    }
}
