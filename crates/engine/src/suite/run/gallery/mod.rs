//! What a page about a run shows beside its verdicts: errors and bounds of some samples, and pictures of the
//! outputs. It is looked at in a small run of its own, so that runs without a page pay nothing for it.

mod errors;
mod promised;
mod scene;

use super::trial::Trial;
use super::{Prepared, Report, Request};
use base::value::{Batch, Record, Scalar, ulp_at};
use judge::verdict::{Closeup, Seen, closeups};
use lanes::{Lane, LaneError, Stage};
use program::InputSource;
use property::{Sample, Sampler};

pub use errors::{Errors, LARGEST, SMALLEST};
pub use promised::{Promised, promised};
pub use scene::{Axis, Cell, Scene, State, Worst};

/// Samples of the suite that are looked at word by word.
const SAMPLES: usize = 2048;

/// What a page shows of a suite on a stage of a lane.
#[derive(Clone, Debug)]
pub struct Gallery {
    /// Errors of the first samples of the suite.
    pub errors: Errors,
    /// Its picture, where there is something to lay out.
    pub scene: Option<Scene>,
}

/// Looks at a suite on a lane for a page. Gives nothing for a lane that cannot run it, and for inputs as
/// literals, where every few samples are a module of their own.
///
/// # Errors
/// [`LaneError`] when the lane fails.
pub fn gallery(
    prepared: &Prepared,
    lane: &dyn Lane,
    stage: Stage,
    request: &Request,
    report: &Report,
) -> Result<Option<Gallery>, LaneError> {
    let kernel = match prepared.kernel(stage) {
        Some(kernel) if report.verdicts.seen() > 0 => kernel,
        Some(_) | None => return Ok(None),
    };
    let trial = match report.source {
        None | Some(InputSource::Storage) => Trial::new(prepared, lane, kernel, &request.promises),
        Some(InputSource::Constants) => return Ok(None),
        Some(source) => Trial::from_source(prepared, lane, source, &request.promises, SAMPLES),
    };
    let mut trial = match trial {
        Ok(trial) => trial,
        Err(LaneError::Unsupported(_)) => return Ok(None),
        Err(error) => return Err(error),
    };
    let mut errors = Errors::default();
    let record = prepared.compute.output.vertex.clone();
    if prepared.plan.makes_samples() {
        let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
        let per_case = per_case.min(trial.capacity());
        let cases = SAMPLES.min(trial.capacity()).div_ceil(per_case).min((trial.capacity() / per_case).max(1));
        let batch = Sampler::new(prepared.plan.clone(), request.seed).batch(0, cases, per_case);
        let actual = trial.run(&batch)?;
        closeups(&trial.context(), &batch, &actual).iter().for_each(|closeup| errors.add(closeup, &record));
    } else {
        let samples = &prepared.rows[..prepared.rows.len().min(SAMPLES)];
        look(&mut trial, samples)?.iter().for_each(|closeup| errors.add(closeup, &record));
    }
    let scene = scene::scene(&mut trial, request, report)?;
    Ok(Some(Gallery { errors, scene }))
}

/// Runs samples and looks at each.
fn look(trial: &mut Trial<'_>, samples: &[Sample]) -> Result<Vec<Closeup>, LaneError> {
    let mut all = Vec::with_capacity(samples.len());
    let context = trial.context();
    for chunk in samples.chunks(trial.capacity()) {
        let batch = batch(chunk);
        let actual = trial.run(&batch)?;
        all.extend(closeups(&context, &batch, &actual));
    }
    Ok(all)
}

/// Samples as one case where they share their uniforms: a draw for each would take long.
fn batch(samples: &[Sample]) -> Batch {
    let first = &samples[0];
    if samples.iter().any(|sample| sample.case != first.case) {
        return Sample::batch(samples);
    }
    Batch {
        invocation_record: first.invocation_record.clone(),
        case_record: first.case_record.clone(),
        per_case: samples.len(),
        invocations: samples.iter().flat_map(|sample| &sample.invocation).copied().collect(),
        cases: first.case.clone(),
    }
}

/// Error and bound of a word, in ULP of the largest component of its variable.
#[derive(Clone, Copy, Debug)]
struct Measured {
    word: usize,
    /// NaN where the lane gave no number.
    error: f64,
    /// Infinite where there is none.
    bound: f64,
}

impl Measured {
    /// Error ÷ bound: infinite for what is no number, NaN without a bound.
    fn ratio(&self) -> f64 {
        if self.error == 0.0 {
            0.0
        } else if self.error.is_nan() {
            f64::INFINITY
        } else if self.bound.is_finite() {
            self.error / self.bound
        } else {
            f64::NAN
        }
    }
}

/// The words of a vertex that are real numbers and should have a value.
fn measured<'a>(words: &'a [Seen], record: &'a Record) -> impl Iterator<Item = Measured> + 'a {
    let fields = (0..record.fields().len()).filter(|&k| record.fields()[k].shape.scalar == Scalar::F32);
    fields.flat_map(move |field| {
        let range = record.range(field);
        let size = words[range.clone()].iter().map(|seen| seen.target().abs()).fold(0.0_f64, f64::max);
        let ulp = ulp_at(size);
        range.filter(|&word| words[word].target().is_finite()).map(move |word| {
            let seen = &words[word];
            Measured { word, error: seen.error() / ulp, bound: seen.bound() / ulp }
        })
    })
}
