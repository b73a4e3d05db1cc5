//! Faults tied to a place in a buffer: the same inputs are right in one place of a batch and wrong in another.
//!
//! One sample in every place of a batch tells them from faults that depend on inputs. Between two such runs another
//! batch runs, so that what is left over from it shows.
//!
//! Such a fault is in the memory or the readback of the executor. It is reported with its places and not shrunk.

use super::part::Failing;
use super::trial::Trial;
use super::{Request, repeat};
use crate::elsewhere::{self, Word};
use base::value::Batch;
use judge::verdict::diagnosis::Position;
use judge::verdict::{Blame, Deviation, Verdict, judge_at, judge_batch};
use lanes::{Actual, LaneError};
use property::{Sample, Sampler};

/// Batches of others in which a sample is looked at.
const BESIDE: u64 = 3;
/// Batches in which the place is sought whose outputs a sample gets, where it gets those of another.
const SOUGHT: u64 = 12;
/// Wrong places that are named.
const NAMED: usize = 4;

/// Where a sample stood when it failed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Its index in the batch.
    pub at: usize,
    /// Invocations of the batch.
    pub count: usize,
    /// Invocations that share uniforms.
    pub per_case: usize,
}

impl Place {
    /// That of a failing sample; none where it is not known.
    pub fn of(failing: &Failing) -> Option<Self> {
        let Failing { at, count, per_case, .. } = *failing;
        (count > 0 && per_case > 0 && at < count).then_some(Self { at, count, per_case })
    }
}

/// A fault that depends on the place.
#[derive(Clone)]
pub(super) struct Tied {
    /// Where, and how many places are wrong.
    pub position: Position,
    /// How the sample deviates there.
    pub deviation: Deviation,
    /// For each place, whether it is wrong.
    wrong: Vec<bool>,
}

impl Tied {
    /// True when this fault explains a sample that failed at this place.
    pub fn explains(&self, place: Place) -> bool {
        self.wrong.is_empty() || self.wrong.get(place.at).copied().unwrap_or(false)
    }
}

/// A batch with one sample in every place.
pub(super) fn filled(sample: &Sample, count: usize, per_case: usize) -> Batch {
    let (invocation, case) = (sample.invocation_record.clone(), sample.case_record.clone());
    let mut batch = Batch::with_capacity(invocation, case, per_case, count);
    batch.invocations = sample.invocation.repeat(count);
    batch.cases = sample.case.repeat(count.div_ceil(per_case));
    batch
}

/// A batch of other samples in the same shape.
pub(super) fn others(trial: &Trial<'_>, seed: u64, sample: &Sample, count: usize, per_case: usize) -> Batch {
    let prepared = trial.prepared;
    if prepared.plan.makes_samples() && sample.invocation.len() + sample.case.len() > 0 {
        // Not those of the run itself, which may be what is left over.
        return Sampler::new(prepared.plan.clone(), !seed).batch(0, count.div_ceil(per_case), per_case);
    }
    match prepared.rows.iter().find(|row| row.invocation != sample.invocation) {
        Some(other) => filled(other, count, per_case),
        None => filled(sample, count, per_case),
    }
}

/// Puts a sample into a batch.
pub(super) fn put(batch: &mut Batch, at: usize, sample: &Sample) {
    let (words, case_words) = (sample.invocation.len(), sample.case.len());
    batch.invocations[at * words..][..words].copy_from_slice(&sample.invocation);
    let case = at / batch.per_case.max(1);
    batch.cases[case * case_words..][..case_words].copy_from_slice(&sample.case);
}

/// Whether the deviation of a sample depends on its place: it deviates in some places of a batch that holds nothing
/// else, the same ones each time; or in its place beside other samples, and in none beside itself. One that deviates in
/// all places, and did not in another batch, depends on how that is made up.
///
/// # Errors
/// [`LaneError`] when the lane fails.
pub(super) fn probe(
    trial: &mut Trial<'_>,
    request: &Request,
    sample: &Sample,
    place: Place,
) -> Result<Option<Tied>, LaneError> {
    let Place { at, count, per_case } = place;
    if count > trial.capacity() || count < 2 {
        return Ok(None);
    }
    let context = trial.context();
    let (same, other) = (filled(sample, count, per_case), others(trial, request.seed, sample, count, per_case));
    let prints = |actual: &Actual| -> Vec<u64> { (0..count).map(|k| repeat::print(actual, k)).collect() };
    trial.run(&other)?;
    let first = trial.run(&same)?;
    let verdict = judge_batch(&context, &same, &first);
    let first = prints(&first);
    // What comes in every second or third dispatch is not taken for what comes each time.
    for between in [1, 2] {
        (0..between).try_for_each(|_| trial.run(&other).map(drop))?;
        if prints(&trial.run(&same)?) != first {
            return Ok(None);
        }
    }
    if verdict.shader_deviated > 0 {
        return Ok(None);
    }
    if let Some(failure) = verdict.failures.iter().find(|f| f.invocation == at).or(verdict.failures.first()) {
        let right = mode(&first);
        let wrong: Vec<bool> = match first[failure.invocation] == right {
            _ if verdict.deviated == count as u64 => vec![true; count],
            true => first.iter().map(|&print| print == right).collect(),
            false => first.iter().map(|&print| print != right).collect(),
        };
        let all: Vec<usize> = (0..count).filter(|&k| wrong[k]).collect();
        let (many, named) = (all.len(), all.into_iter().take(NAMED).collect());
        let position =
            Position { invocation: failure.invocation, count, per_case, wrong: named, many, disturbed: false };
        return Ok(Some(Tied { position, deviation: failure.deviation.clone(), wrong }));
    }
    // Some others may have what the sample has to give.
    for salt in 0..BESIDE {
        let mut placed = others(trial, request.seed ^ salt, sample, count, per_case);
        put(&mut placed, at, sample);
        if let Some(deviation) = beside(trial, &same, &placed, at, first[at])? {
            let disturbed = !is_swapped(trial, request, sample, place, &deviation)?;
            let position = Position { invocation: at, count, per_case, wrong: Vec::new(), many: 0, disturbed };
            return Ok(Some(Tied { position, deviation, wrong: Vec::new() }));
        }
    }
    Ok(None)
}

/// True where a sample that is wrong beside others gives what is meant in another place of the batch, the same one whatever
/// stands there: memory is addressed wrongly. Else what it gives comes of the others' inputs.
fn is_swapped(
    trial: &mut Trial<'_>,
    request: &Request,
    sample: &Sample,
    Place { at, count, per_case }: Place,
    deviation: &Deviation,
) -> Result<bool, LaneError> {
    let Some(value) = deviation.value() else { return Ok(true) };
    let mut from: Vec<usize> = (0..count).filter(|&k| k != at).collect();
    for salt in 0..SOUGHT {
        let mut placed = others(trial, request.seed ^ salt, sample, count, per_case);
        put(&mut placed, at, sample);
        let actual = trial.run(&placed)?;
        let record = &actual.layout().vertex;
        let word = (0..record.words()).find(|&word| record.word_name(word) == value.component);
        let vertex = value.vertex.unwrap_or(0);
        let Some(word) = word.filter(|_| vertex < actual.stored(at)) else { return Ok(true) };
        let found = actual.vertex(at, vertex)[word];
        let of = Word { vertex, word, scalar: value.scalar };
        from = elsewhere::that_mean(trial.prepared.oracle.executable(), &placed, of, found, &from);
    }
    Ok(!from.is_empty())
}

/// How a sample deviates in its place beside others, each time; it is right beside itself, where it gives `right`.
fn beside(
    trial: &mut Trial<'_>,
    same: &Batch,
    placed: &Batch,
    at: usize,
    right: u64,
) -> Result<Option<Deviation>, LaneError> {
    let context = trial.context();
    let mut found = None;
    for (round, between) in [1, 1, 2].into_iter().enumerate() {
        (0..between).try_for_each(|_| trial.run(same).map(drop))?;
        let actual = trial.run(placed)?;
        if repeat::print(&actual, at) == right {
            return Ok(None);
        }
        if round == 0 {
            found = match judge_at(&context, placed, &actual, at) {
                Verdict::Deviate(deviation) if deviation.blame == Blame::Lane => Some(deviation),
                _ => return Ok(None),
            };
        }
    }
    Ok(found)
}

/// What most places gave.
fn mode(prints: &[u64]) -> u64 {
    let mut sorted = prints.to_vec();
    sorted.sort_unstable();
    let longest = sorted.chunk_by(|a, b| a == b).max_by_key(|run| run.len());
    longest.and_then(|run| run.first()).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::mode;

    #[test]
    fn most_places_tell_what_is_mode() {
        assert_eq!(mode(&[3, 1, 2, 1, 1, 3]), 1);
        assert_eq!(mode(&[]), 0);
    }
}
