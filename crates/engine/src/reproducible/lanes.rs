//! The bits of lanes beside those of strict binary32.

use std::ops::Range;

use super::StrictBits;
use crate::InputValue;
use crate::fuzz::{Ready, kernel, stage_of};
use base::value::{Batch, Scalar, ulp_at};
use lanes::{Actual, Lane, LaneName, Runner, embedded};
use program::Program;
use program::interp::Number;
use property::Sample;

/// A lane that was asked.
#[derive(Clone, Debug)]
pub struct OnLane {
    /// Its name.
    pub lane: LaneName,
    /// Why it did not run the function, or not to the end.
    pub not_run: Option<String>,
}

/// Where a lane has other bits than strict binary32.
#[derive(Clone, Debug)]
pub struct Apart {
    /// The lane.
    pub lane: LaneName,
    /// By what the text became what its driver got.
    pub front_end: String,
    /// Samples in which an output differs.
    pub samples: u64,
    /// Of these, samples in which no conforming device may differ.
    pub fixed: u64,
    /// The largest distance in ULP of a number; infinite for whole numbers and where only one is a number.
    pub ulp: f64,
    /// The inputs of the first sample in which no device may differ, else of the one with the largest distance.
    pub inputs: Vec<InputValue>,
    /// The command that shows it.
    pub reproduce: String,
}

/// What was seen of an output on a lane.
#[derive(Clone, Default)]
struct Seen {
    samples: u64,
    fixed: u64,
    ulp: f64,
    sample: Option<Sample>,
}

/// A lane under way.
pub(super) struct Running<'a> {
    ready: &'a Ready,
    lane: LaneName,
    front_end: String,
    runner: Option<Box<dyn Runner>>,
    not_run: Option<String>,
    seen: Vec<Seen>,
}

impl<'a> Running<'a> {
    pub(super) fn new(lane: &dyn Lane, ready: &'a Ready, capacity: usize) -> Self {
        let name = lane.description().name;
        let seen = vec![Seen::default(); ready.kernel.output.vertex.fields().len()];
        let kernel = kernel(&ready.program, stage_of(lane, &ready.program)).map_err(|error| error.to_string());
        let prepared =
            kernel.and_then(|kernel| lane.prepare(&kernel, capacity.max(1)).map_err(|error| error.to_string()));
        let front_end = lane.front_end(&ready.program);
        let (runner, not_run) = match prepared {
            // It is what the others are held against.
            Ok(_) if name == embedded::STRICT => (None, None),
            Ok(runner) => (Some(runner), None),
            Err(why) => (None, Some(why)),
        };
        Self { ready, lane: name, front_end, runner, not_run, seen }
    }

    /// Runs a batch. `fixed` has, for each output, the samples in which no device may differ.
    pub(super) fn run(
        &mut self,
        batch: &Batch,
        outputs: &[(Range<usize>, f64)],
        fixed: &[Vec<bool>],
        strict: &StrictBits,
    ) {
        let Some(runner) = &mut self.runner else { return };
        if batch.invocation_count() == 0 {
            return;
        }
        let actual = match runner.run(batch) {
            Ok(actual) => actual,
            Err(error) => {
                self.not_run = Some(error.to_string());
                self.runner = None;
                return;
            }
        };
        for sample in 0..batch.invocation_count() {
            for (k, own) in outputs.iter().enumerate() {
                let far = self.distance(strict, &actual, sample, own);
                if far > 0.0 {
                    self.seen[k].note(far, fixed[k][sample], || Sample::of(batch, sample));
                }
            }
        }
    }

    /// The largest distance of the words of an output, in ULP of its size or, where that is larger, of its usual one; 0 for
    /// the same bits. Any NaN is as good as another.
    fn distance(
        &self,
        strict: &StrictBits,
        actual: &Actual,
        sample: usize,
        (words, usual): &(Range<usize>, f64),
    ) -> f64 {
        let record = &self.ready.kernel.output.vertex;
        let mut far = 0.0_f64;
        if actual.is_absent(sample) {
            return far;
        }
        for vertex in 0..actual.stored(sample).min(strict.room) {
            let (wanted, given) = (strict.vertex(sample, vertex), actual.vertex(sample, vertex));
            for word in words.clone() {
                let (strict, given) = (wanted[word], given[word]);
                if strict == given {
                    continue;
                }
                let (a, b) = (f32::from_bits(strict), f32::from_bits(given));
                far = far.max(match record.scalar_of(word) {
                    Scalar::F32 if a.is_poison() || (a.is_nan() && b.is_nan()) => 0.0,
                    Scalar::F32 if a.is_finite() && b.is_finite() => {
                        let (a, b) = (f64::from(a), f64::from(b));
                        ((a - b).abs() / ulp_at(a.abs().max(*usual))).max(f64::MIN_POSITIVE)
                    }
                    Scalar::F32 | Scalar::I32 | Scalar::U32 | Scalar::Bool => f64::INFINITY,
                });
            }
        }
        far
    }

    pub(super) fn report(&self) -> OnLane {
        OnLane { lane: self.lane, not_run: self.not_run.clone() }
    }

    /// Where an output differs.
    pub(super) fn apart(
        &self,
        output: usize,
        program: &Program,
        reproduce: &dyn Fn(&Sample) -> String,
    ) -> Option<Apart> {
        let Seen { samples, fixed, ulp, sample } = self.seen.get(output)?;
        let sample = sample.as_ref()?;
        Some(Apart {
            lane: self.lane,
            front_end: self.front_end.clone(),
            samples: *samples,
            fixed: *fixed,
            ulp: *ulp,
            inputs: InputValue::all(sample, program),
            reproduce: reproduce(sample),
        })
    }
}

impl Seen {
    fn note(&mut self, far: f64, fixed: bool, sample: impl FnOnce() -> Sample) {
        let first = fixed && self.fixed == 0;
        if first || (self.fixed == 0 && far > self.ulp) {
            self.sample = Some(sample());
        }
        self.samples += 1;
        self.fixed += u64::from(fixed);
        self.ulp = self.ulp.max(far);
    }
}
