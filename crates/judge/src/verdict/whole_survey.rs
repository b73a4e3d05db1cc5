//! How tight the bounds of large dispatches are, as a [`Survey`] says it of other programs.

use super::judge::agrees;
use super::oracle::JudgeContext;
use super::passes::Passes;
use super::survey::{OfSample, Survey};
use super::tightness::{Gauge, Word, Worst, keep_worse};
use crate::profile::grid::MIN_NORMAL;
use crate::tape::Model;
use base::value::{Record, Scalar};
use program::interp::InterpError;
use program::lane::Actual;

/// Gathers bounds and errors over some large dispatches.
#[derive(Default)]
pub struct WholeSurvey {
    promise: Gauge,
    measured: Gauge,
    as_written: Gauge,
    by_sample: Vec<OfSample>,
    beyond: u64,
    worst_beyond: Option<Worst>,
}

impl WholeSurvey {
    /// Looks at a large dispatch. What the judge tells of is left out: words that are no numbers, or of which
    /// nothing is known, and variables below the normal range.
    ///
    /// # Errors
    /// [`InterpError`] for what is no large dispatch.
    pub fn see<'a>(&mut self, passes: &Passes<'a>, actual: &Actual) -> Result<(), InterpError> {
        let (context, record) = (passes.context(), &actual.layout().vertex);
        // Figures of one dispatch say more than those of some: where terms cancel, errors and bounds differ by magnitudes.
        let own = |all: &mut Gauge, model: Model<'a>| -> Result<(Option<Worst>, Option<f64>), InterpError> {
            let mut one = Gauge::default();
            let beyond = gauge(&mut one, passes, model, actual)?;
            all.merge(one.clone());
            Ok((beyond, one.read("", record).median_over_largest()))
        };
        let (broken, mut allowed) = own(&mut self.promise, context.lenient())?;
        if let Some(model) = context.measured() {
            let (beyond, measured) = own(&mut self.measured, model)?;
            allowed = measured;
            // A word beyond its promise makes the dispatch a deviation, whatever the others are.
            if broken.is_none() && beyond.is_some() {
                self.beyond += 1;
                keep_worse(&mut self.worst_beyond, beyond);
            }
        }
        let (_, as_written) = own(&mut self.as_written, context.as_written())?;
        self.by_sample.push(OfSample { allowed, as_written });
        Ok(())
    }

    /// The figures; `None` where nothing was looked at.
    pub fn read(self, context: &JudgeContext<'_>, record: &Record) -> Option<Survey> {
        let promises = context.promises;
        let promise = &promises.lenient().name;
        let tightest = promises.measured.as_ref().map_or(promise, |profile| &profile.name);
        (!self.by_sample.is_empty()).then(|| Survey {
            invocations: self.by_sample.len() as u64,
            promise: self.promise.read(promise, record),
            measured: promises.measured.as_ref().map(|profile| self.measured.read(&profile.name, record)),
            beyond: self.beyond,
            worst_beyond: self.worst_beyond,
            as_written: Some(self.as_written.read(tightest, record)),
            by_sample: self.by_sample,
        })
    }
}

/// Gauges the words by a model. Gives the one that is farthest beyond its bound.
fn gauge<'a>(
    gauge: &mut Gauge,
    passes: &Passes<'a>,
    model: Model<'a>,
    actual: &Actual,
) -> Result<Option<Worst>, InterpError> {
    let mut beyond = None;
    let record = &actual.layout().vertex;
    // Whole numbers have no bounds.
    if record.fields().iter().all(|field| field.shape.scalar != Scalar::F32) {
        return Ok(None);
    }
    let device = passes.device(model)?;
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
