//! What lanes give of two functions.

use serde::{Deserialize, Serialize};

use super::ReadyPair;
use crate::InputValue;
use base::value::{Batch, Scalar, ulp_at};
use lanes::{Actual, Lane, LaneName, Runner};
use property::Sample;

/// Two functions on one lane.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OnLane {
    /// Name of the lane.
    #[serde(with = "lanes::known")]
    pub lane: LaneName,
    /// Why it did not run both, or not to the end.
    pub not_run: Option<String>,
    /// Samples that mean the same in both and ran.
    pub samples: u64,
    /// Of these, those with the same bits in all outputs that both have.
    pub same: u64,
    /// The largest distance of these outputs in ULP of the larger one's variable, with the inputs; infinite where only one is
    /// a number.
    #[serde(with = "crate::bits")]
    pub farthest: Option<(f64, Vec<InputValue>)>,
}

/// Both functions, ready to run on a lane.
pub(super) struct Both<'a> {
    pair: &'a ReadyPair<'a>,
    runners: Option<[Box<dyn Runner>; 2]>,
    report: OnLane,
}

impl<'a> Both<'a> {
    pub(super) fn new(lane: &dyn Lane, pair: &'a ReadyPair<'a>, capacity: usize) -> Self {
        let name = lane.description().name;
        let mut report = OnLane { lane: name, not_run: None, samples: 0, same: 0, farthest: None };
        let prepared = pair.sides.map(|ready| lane.prepare(&ready.kernel, capacity.max(1)));
        let runners = match prepared {
            [Ok(first), Ok(second)] => Some([first, second]),
            [Err(error), _] | [_, Err(error)] => {
                report.not_run = Some(error.to_string());
                None
            }
        };
        Self { pair, runners, report }
    }

    /// Runs a batch; samples that differ in their meaning are left out.
    pub(super) fn see(&mut self, batch: &Batch, fed: &Batch, differing: &[bool]) {
        let Some([first, second]) = &mut self.runners else { return };
        if batch.invocation_count() > first.capacity().min(second.capacity()) {
            self.report.not_run = Some("the lane cannot run a batch as a whole".to_owned());
            self.runners = None;
            return;
        }
        match (first.run(batch), second.run(fed)) {
            (Ok(a), Ok(b)) => self.compare(batch, &a, &b, differing),
            (Err(error), _) | (_, Err(error)) => {
                self.report.not_run = Some(error.to_string());
                self.runners = None;
            }
        }
    }

    fn compare(&mut self, batch: &Batch, a: &Actual, b: &Actual, differing: &[bool]) {
        let pairs = self.pair.reference.pairs();
        let record = &self.pair.sides[0].kernel.output.vertex;
        for k in (0..batch.invocation_count()).filter(|&k| !differing[k]) {
            self.report.samples += 1;
            let stored = a.stored(k).min(b.stored(k));
            let mut far = if a.emitted(k) == b.emitted(k) { 0.0_f64 } else { f64::INFINITY };
            for vertex in 0..stored {
                let (a, b) = (a.vertex(k, vertex), b.vertex(k, vertex));
                for (own, other) in &pairs {
                    let both = || own.clone().zip(other.clone()).map(|(own, other)| (a[own], b[other]));
                    if record.scalar_of(own.start) != Scalar::F32 {
                        far = if both().all(|(a, b)| a == b) { far } else { f64::INFINITY };
                        continue;
                    }
                    far = far.max(distance(both()));
                }
            }
            self.report.same += u64::from(far == 0.0);
            if far > self.report.farthest.as_ref().map_or(0.0, |(most, _)| *most) {
                self.report.farthest = Some((far, InputValue::all(&Sample::of(batch, k), &self.pair.sides[0].program)));
            }
        }
    }

    pub(super) fn finish(self) -> OnLane {
        self.report
    }
}

/// The largest distance of the components of a variable, in ULP of its largest component. Any NaN is as good as another,
/// and 0 has no sign.
fn distance(both: impl Iterator<Item = (u32, u32)>) -> f64 {
    let numbers: Vec<(f64, f64)> =
        both.map(|(a, b)| (f64::from(f32::from_bits(a)), f64::from(f32::from_bits(b)))).collect();
    let size = numbers.iter().fold(0.0_f64, |size, (a, b)| size.max(a.abs()).max(b.abs()));
    let of = |&(a, b): &(f64, f64)| {
        if a == b || (a.is_nan() && b.is_nan()) {
            0.0
        } else if !a.is_finite() || !b.is_finite() {
            f64::INFINITY
        } else {
            (a - b).abs() / ulp_at(size)
        }
    };
    numbers.iter().map(of).fold(0.0, f64::max)
}
