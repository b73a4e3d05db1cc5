//! What a run does at the moment, for whoever waits for it, and how long it looks into what it found.
//!
//! The time limit of a search is the only thing by which shards may differ from a run.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use property::Sample;
use property::shrink::{self, Domain, Oracle, Shrunk};

/// Time in which failing samples are made simpler; what was reached by then is told.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// Candidates that are tried between two looks at the clock.
const CANDIDATES: usize = 1 << 12;

/// What is done, the innermost last, each since when.
static NOW: Mutex<Vec<(String, Instant)>> = Mutex::new(Vec::new());

/// Something that is done until this is dropped.
#[must_use]
pub struct Doing(());

/// Begins something, in words that follow "it".
pub fn doing(what: String) -> Doing {
    NOW.lock().unwrap_or_else(PoisonError::into_inner).push((what, Instant::now()));
    Doing(())
}

impl Drop for Doing {
    fn drop(&mut self) {
        NOW.lock().unwrap_or_else(PoisonError::into_inner).pop();
    }
}

/// What is done at the moment, the outermost first, and for how long the innermost has been; `None` where nothing was begun.
pub fn now() -> Option<(String, Duration)> {
    let now = NOW.lock().unwrap_or_else(PoisonError::into_inner);
    let since = now.last()?.1.elapsed();
    let words: Vec<&str> = now.iter().map(|(what, _)| what.as_str()).collect();
    Some((words.join(": "), since))
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
