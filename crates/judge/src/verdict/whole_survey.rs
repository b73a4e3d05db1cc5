//! How tight the bounds of large dispatches are, as a [`Survey`] says it of other programs.

use super::judge::agrees;
use super::oracle::JudgeContext;
use super::survey::Survey;
use super::tightness::{Gauge, Word, Worst, keep_worse};
use crate::profile::grid::MIN_NORMAL;
use crate::tape::Model;
use base::value::{Batch, Record, Scalar};
use program::interp::InterpError;
use program::lane::Actual;

/// Gathers bounds and errors over some large dispatches.
#[derive(Default)]
pub struct WholeSurvey {
    promise: Gauge,
    measured: Gauge,
    invocations: u64,
    beyond: u64,
    worst_beyond: Option<Worst>,
}

impl WholeSurvey {
    /// Looks at the first invocation of a batch. What the judge tells of is left out: words that are no numbers, or of which
    /// nothing is known, and variables below the normal range.
    ///
    /// # Errors
    /// [`InterpError`] for what is no large dispatch.
    pub fn see(&mut self, context: &JudgeContext<'_>, batch: &Batch, actual: &Actual) -> Result<(), InterpError> {
        let broken = gauge(&mut self.promise, context, context.lenient(), batch, actual)?;
        if let Some(model) = context.measured() {
            let beyond = gauge(&mut self.measured, context, model, batch, actual)?;
            // A word beyond its promise makes the dispatch a deviation, whatever the others are.
            if broken.is_none() && beyond.is_some() {
                self.beyond += 1;
                keep_worse(&mut self.worst_beyond, beyond);
            }
        }
        self.invocations += 1;
        Ok(())
    }

    /// The figures; `None` where nothing was looked at.
    pub fn read(self, context: &JudgeContext<'_>, record: &Record) -> Option<Survey> {
        let promises = context.promises;
        (self.invocations > 0).then(|| Survey {
            invocations: self.invocations,
            promise: self.promise.read(&promises.conformance.unwrap_or(promises.text).name, record),
            measured: promises.measured.as_ref().map(|profile| self.measured.read(&profile.name, record)),
            beyond: self.beyond,
            worst_beyond: self.worst_beyond,
        })
    }
}

/// Gauges the words by a model. Gives the one that is farthest beyond its bound.
fn gauge(
    gauge: &mut Gauge,
    context: &JudgeContext<'_>,
    model: Model<'_>,
    batch: &Batch,
    actual: &Actual,
) -> Result<Option<Worst>, InterpError> {
    let mut beyond = None;
    let device = context.oracle.whole(model, batch, 0)?;
    let (record, found) = (&actual.layout().vertex, actual.vertex(0, 0));
    for field in 0..record.fields().len() {
        let is_known = |word: &usize| {
            record.scalar_of(*word) == Scalar::F32 && device.cells[*word].value.is_finite() && !device.open[*word]
        };
        let words: Vec<usize> = record.range(field).filter(is_known).collect();
        let size = words.iter().fold(0.0_f64, |size, &word| size.max(device.cells[word].value.abs()));
        if size > 0.0 && size < MIN_NORMAL {
            continue;
        }
        for word in words {
            let cell = device.cells[word];
            let error = (f64::from(f32::from_bits(found[word])) - cell.value).abs();
            let seen = Word { word, field, error, bound: cell.radius, size };
            gauge.see(&seen, |word| word.worst(record, None, 0));
            if seen.bound.is_finite() && !agrees(seen.error, 0.0, seen.bound) {
                keep_worse(&mut beyond, Some(seen.worst(record, None, 0)));
            }
        }
    }
    Ok(beyond)
}
