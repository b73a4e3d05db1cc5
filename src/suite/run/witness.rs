//! Asks the other lanes of a run for the samples on which one of them deviates.

use super::bundle::sample;
use super::finding::{Case, Finding};
use super::trial::Trial;
use super::{Part, Prepared, Report};
use crate::bound::profile::Rulings;
use crate::lane::{Lane, LaneError, LaneName, Stage};
use crate::program::Source;
use crate::property::Sample;
use crate::verdict::diagnosis::{Hearing, Stand, Witness, stand};
use crate::verdict::{Blame, Deviation, judge_each};

/// A lane of the run, with what its results are held against.
#[derive(Clone, Copy)]
pub struct Peer<'a> {
    /// The lane.
    pub lane: &'a dyn Lane,
    /// What its results are held against.
    pub rulings: &'a Rulings,
}

/// A finding with a sample, and where it was found.
struct Accused<'f> {
    lane: LaneName,
    stage: Stage,
    source: Option<Source>,
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
    (lane, stage, source): (LaneName, Stage, Option<Source>),
) -> impl Iterator<Item = Accused<'f>> {
    let blamed = |case: &&mut Case| {
        case.diagnosis.hearing.is_none() && case.deviation.as_ref().is_some_and(|d| d.blame == Blame::Lane)
    };
    let cases = findings.filter_map(|finding| finding.case.as_mut()).filter(blamed);
    cases.map(move |case| Accused { lane, stage, source, case })
}

/// Hears every lane of a run on the samples on which one deviates, after all of them ran a suite. What follows for
/// whose fault it is stands in the diagnosis of each finding.
pub fn hear(prepared: &Prepared, peers: &[Peer<'_>], reports: &mut [&mut Report]) {
    let found = reports.iter_mut().flat_map(|report| {
        let on = (report.lane, report.stage, report.source);
        accused(report.findings.iter_mut(), on)
    });
    all(prepared, peers, found.collect());
}

/// The same for parts of a run.
pub fn hear_parts(prepared: &Prepared, peers: &[Peer<'_>], parts: &mut [Part]) {
    let found = parts.iter_mut().flat_map(|part| {
        let on = (part.lane, part.stage, None);
        accused(part.shown_mut(), on)
    });
    all(prepared, peers, found.collect());
}

fn all(prepared: &Prepared, peers: &[Peer<'_>], accused: Vec<Accused<'_>>) {
    if accused.is_empty() {
        return;
    }
    let mut sources: Vec<Option<Source>> = accused.iter().map(|accused| accused.source).collect();
    sources.dedup();
    let mut left = accused;
    for source in sources {
        let (now, later): (Vec<_>, Vec<_>) = left.into_iter().partition(|accused| accused.source == source);
        left = later;
        from(prepared, peers, source, now);
    }
}

/// Hears all lanes on samples with inputs from one source.
fn from(prepared: &Prepared, peers: &[Peer<'_>], source: Option<Source>, mut accused: Vec<Accused<'_>>) {
    let samples: Vec<Sample> = accused.iter().map(|accused| sample(prepared, accused.case)).collect();
    let mut heard: Vec<Vec<Witness>> = vec![Vec::new(); accused.len()];
    for peer in peers {
        for stage in stages(prepared, *peer, source) {
            let described = peer.lane.description();
            let given = given(prepared, *peer, stage, source, &samples, &accused);
            match given {
                Ok(given) => {
                    for (heard, (stand, word)) in heard.iter_mut().zip(given) {
                        heard.push(Witness::new(described, stage, stand, word));
                    }
                }
                // What it cannot run it says nothing about.
                Err(LaneError::Unsupported(_)) => {}
                Err(
                    LaneError::Api(_)
                    | LaneError::Endless { .. }
                    | LaneError::NotWritten { .. }
                    | LaneError::Lost { .. },
                ) => {
                    heard.iter_mut().for_each(|h| h.push(Witness::new(described, stage, Stand::Open, None)));
                }
            }
        }
    }
    for (accused, mut witnesses) in accused.iter_mut().zip(heard) {
        let own = |w: &Witness| w.lane == accused.lane && w.stage == accused.stage;
        let word = accused.deviation().and_then(Deviation::value).map(|value| value.actual);
        // The lane that is accused comes first, with what was found of it.
        witnesses.sort_by_key(|w| !own(w));
        match witnesses.first_mut().filter(|w| own(w)) {
            Some(first) => (first.stand, first.word) = (Stand::Wrong, word),
            None => {
                let Some(peer) = peers.iter().find(|peer| peer.lane.description().name == accused.lane) else {
                    continue;
                };
                witnesses.insert(0, Witness::new(peer.lane.description(), accused.stage, Stand::Wrong, word));
            }
        }
        accused.case.diagnosis.hearing = Some(Hearing::of(witnesses));
    }
}

/// Stages in which a lane can be asked.
fn stages(prepared: &Prepared, peer: Peer<'_>, source: Option<Source>) -> Vec<Stage> {
    match source {
        Some(source) => vec![super::stage_of(source)],
        None => prepared.stages(peer.lane),
    }
}

/// What a lane says of each sample.
fn given(
    prepared: &Prepared,
    Peer { lane, rulings }: Peer<'_>,
    stage: Stage,
    source: Option<Source>,
    samples: &[Sample],
    accused: &[Accused<'_>],
) -> Result<Vec<(Stand, Option<u32>)>, LaneError> {
    let mut trial = match (source, prepared.kernel(stage)) {
        (Some(source), _) => Trial::from_source(prepared, lane, source, rulings, samples.len())?,
        (None, Some(kernel)) => Trial::with_capacity(prepared, lane, kernel, rulings, samples.len())?,
        (None, None) => return Err(LaneError::Unsupported(format!("the {stage} stage"))),
    };
    let court = trial.court();
    let mut all = Vec::with_capacity(samples.len());
    trial.run_samples(samples, |at, batch, actual| {
        for (k, verdict) in judge_each(&court, batch, actual).iter().enumerate() {
            let Some(deviation) = accused[at + k].deviation() else { continue };
            let word = deviation.value().and_then(|value| {
                let record = &actual.layout().vertex;
                let word = (0..record.words()).find(|&word| record.word_name(word) == value.component)?;
                let vertex = value.vertex.unwrap_or(0);
                (vertex < actual.stored(k)).then(|| actual.vertex(k, vertex)[word])
            });
            all.push((stand(deviation, verdict, word), word));
        }
    })?;
    Ok(all)
}
