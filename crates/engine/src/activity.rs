//! What a run does at the moment, for whoever waits for it, and how long it looks into what it found.
//!
//! The time limit of a search is the only thing by which shards may differ from a run.

use std::marker::PhantomData;
use std::sync::{Mutex, PoisonError};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use property::Sample;
use property::shrink::{self, Domain, Oracle, Shrunk};

/// Time in which failing samples are made simpler; what was reached by then is told.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// Candidates that are tried between two looks at the clock.
const CANDIDATES: usize = 1 << 12;

/// What a thread does, the innermost last, each since when.
type Doings = Vec<(String, Instant)>;

/// What is done, by the threads that do it.
static NOW: Mutex<Vec<(ThreadId, Doings)>> = Mutex::new(Vec::new());

/// Something that is done until this is dropped, on the thread that began it.
#[must_use]
pub struct Doing(PhantomData<*const ()>);

/// Begins something, in words that follow "it".
pub fn doing(what: String) -> Doing {
    let (mut all, thread) = (NOW.lock().unwrap_or_else(PoisonError::into_inner), thread::current().id());
    let begun = (what, Instant::now());
    match all.iter_mut().find(|(of, _)| *of == thread) {
        Some((_, doings)) => doings.push(begun),
        None => all.push((thread, vec![begun])),
    }
    Doing(PhantomData)
}

impl Drop for Doing {
    fn drop(&mut self) {
        let (mut all, thread) = (NOW.lock().unwrap_or_else(PoisonError::into_inner), thread::current().id());
        if let Some(at) = all.iter().position(|(of, _)| *of == thread) {
            all[at].1.pop();
            if all[at].1.is_empty() {
                all.remove(at);
            }
        }
    }
}

/// What is done at the moment, the outermost first, and for how long the innermost has been; of threads, the one whose
/// innermost has been for the longest. `None` where nothing was begun.
pub fn now() -> Option<(String, Duration)> {
    let now = NOW.lock().unwrap_or_else(PoisonError::into_inner);
    let innermost = |doings: &Doings| doings.last().map(|(_, since)| *since);
    let (doings, since) =
        now.iter().filter_map(|(_, doings)| Some((doings, innermost(doings)?))).min_by_key(|of| of.1)?;
    let words: Vec<&str> = doings.iter().map(|(what, _)| what.as_str()).collect();
    Some((words.join(": "), since.elapsed()))
}

/// [`shrink::shrink`] for as long as [`PATIENCE`] lasts: what is not tried by then counts as not failing, and nothing that was
/// reached is the simplest.
///
/// # Errors
/// The first error of the oracle.
pub(crate) fn shrink<E>(
    failing: Vec<Sample>,
    domain: &dyn Domain,
    oracle: &mut Oracle<'_, E>,
) -> Result<Vec<Shrunk>, E> {
    bounded(PATIENCE, failing, domain, oracle)
}

fn bounded<E>(
    patience: Duration,
    failing: Vec<Sample>,
    domain: &dyn Domain,
    oracle: &mut Oracle<'_, E>,
) -> Result<Vec<Shrunk>, E> {
    let _doing = doing("makes failing samples simpler".to_owned());
    let (began, mut over) = (Instant::now(), false);
    let mut within = |samples: &[Sample]| -> Result<Vec<bool>, E> {
        let mut answers = Vec::with_capacity(samples.len());
        for some in samples.chunks(CANDIDATES) {
            over |= began.elapsed() >= patience;
            if over {
                break;
            }
            let mut given = oracle(some)?;
            // What it does not answer does not fail.
            given.resize(some.len(), false);
            answers.append(&mut given);
        }
        Ok(answers)
    };
    let mut shrunk = shrink::shrink(failing, domain, &mut within)?;
    if over {
        shrunk.iter_mut().for_each(|one| one.minimal = false);
    }
    Ok(shrunk)
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;
    use std::sync::Arc;

    use base::value::{Field, Record, Shape};

    use super::*;

    fn sample(word: f32) -> Sample {
        let field = Field { name: "x".into(), shape: Shape::FLOAT };
        let (invocation_record, case_record) = (Arc::new(Record::new(vec![field])), Arc::default());
        Sample { invocation: vec![word.to_bits()], case: Vec::new(), invocation_record, case_record }
    }

    #[test]
    fn a_search_without_time_keeps_what_it_has_and_one_with_time_ends() {
        let all = |_: &Sample| true;
        let mut asked = 0;
        let mut fails = |samples: &[Sample]| -> Result<Vec<bool>, Infallible> {
            asked += 1;
            Ok(samples.iter().map(|sample| f32::from_bits(sample.invocation[0]) > 1.0).collect())
        };
        let none = bounded(Duration::ZERO, vec![sample(1234.567)], &all, &mut fails).unwrap();
        assert!(none[0].sample == sample(1234.567) && !none[0].minimal);
        let enough = bounded(PATIENCE, vec![sample(1234.567)], &all, &mut fails).unwrap();
        assert!(enough[0].minimal && f32::from_bits(enough[0].sample.invocation[0]) < 4.0, "{enough:?}");
        assert!(asked > 0);
    }

    #[test]
    fn what_is_done_is_told_from_the_outside_in() {
        let _outer = doing("runs a suite".to_owned());
        let inner = doing("asks the other lanes".to_owned());
        let (words, _) = now().unwrap();
        // Other tests run beside this one.
        assert!(words.contains("runs a suite") && words.contains("asks the other lanes"), "{words}");
        drop(inner);
    }
}
