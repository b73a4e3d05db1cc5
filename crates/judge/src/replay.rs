//! Single operations run again on a device, with operands that a shader had, and judged by a promise:
//! whether a built-in alone explains a result.

use thiserror::Error;

use super::profile::{Free, Interval, Op, Profile, accept};
use crate::single::kernel;
use base::value::Batch;
use program::ProgramError;
use program::lane::{Lane, LaneError, Stage};

/// Why nothing was replayed.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// A kernel could not be made.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// The lane failed.
    #[error(transparent)]
    Lane(#[from] LaneError),
}

/// Why an operation was not run again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skip {
    /// GLSL cannot write it as a single scalar operation.
    NoKernel,
    /// It takes another number of operands.
    Operands {
        /// Operands that it takes.
        takes: usize,
    },
}

/// What a device gave for one operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// The bits of the device's result.
    pub result: u32,
    /// The value in real numbers; NaN where it is undefined.
    pub exact: f64,
    /// The results that are accepted, or why all are.
    pub accepted: Result<Interval, Free>,
}

impl Judged {
    /// The device's result as a number.
    pub fn value(&self) -> f64 {
        f64::from(f32::from_bits(self.result))
    }

    /// True when the result is not accepted.
    pub fn is_outside(&self) -> bool {
        self.accepted.is_ok_and(|accepted| !accepted.contains(self.value()))
    }

    /// The error over the error that is accepted on the same side of the exact value: above 1 for a
    /// result that is outside, infinite for NaN and where no error at all is accepted. `None` when
    /// any result is accepted.
    pub fn factor(&self) -> Option<f64> {
        let Interval { lo, hi } = self.accepted.ok()?;
        let value = self.value();
        if value == self.exact {
            return Some(0.0);
        }
        if value.is_nan() {
            return Some(f64::INFINITY);
        }
        let (error, room) = if value > self.exact {
            (value - self.exact, hi - self.exact)
        } else {
            (self.exact - value, self.exact - lo)
        };
        // Both are infinite where an overflow is accepted; there is no room on a side on which no result
        // is accepted at all.
        Some(if room.is_infinite() { 0.0 } else { error / room.max(0.0) })
    }
}

/// One operation with its operands and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Replayed {
    /// The operation.
    pub op: Op,
    /// The bits of the operands.
    pub operands: Vec<u32>,
    /// The device's result, or why there is none.
    pub outcome: Result<Judged, Skip>,
}

impl Replayed {
    /// True when the device gave a result that is not accepted.
    pub fn is_outside(&self) -> bool {
        self.outcome.is_ok_and(|judged| judged.is_outside())
    }
}

/// Runs operations alone on a lane, in a stage, those of one kind in one batch, and judges each by a
/// profile. Gives one entry for each item, in the same order.
///
/// # Errors
/// [`ReplayError`] when the lane refuses a kernel, such as for a stage that it lacks, or fails.
pub fn replay(
    lane: &dyn Lane,
    stage: Stage,
    profile: &Profile,
    items: &[(Op, Vec<u32>)],
) -> Result<Vec<Replayed>, ReplayError> {
    let skip = |(op, operands): &(Op, Vec<u32>)| match op.arity().filter(|_| kernel::expression(*op).is_some()) {
        None => Some(Skip::NoKernel),
        Some(takes) => (takes != operands.len()).then_some(Skip::Operands { takes }),
    };
    let mut outcomes: Vec<Result<Judged, Skip>> =
        items.iter().map(|item| Err(skip(item).unwrap_or(Skip::NoKernel))).collect();
    for op in Op::ALL {
        let own: Vec<usize> = (0..items.len()).filter(|&k| items[k].0 == op && skip(&items[k]).is_none()).collect();
        let results = run(lane, stage, op, own.iter().map(|&k| items[k].1.as_slice()))?;
        for (k, result) in own.into_iter().zip(results) {
            outcomes[k] = Ok(judge(profile, stage, op, &items[k].1, result));
        }
    }
    let all = items.iter().zip(outcomes);
    Ok(all.map(|((op, operands), outcome)| Replayed { op: *op, operands: operands.clone(), outcome }).collect())
}

/// The results of one operation for lists of operands.
fn run<'a>(
    lane: &dyn Lane,
    stage: Stage,
    op: Op,
    operands: impl ExactSizeIterator<Item = &'a [u32]>,
) -> Result<Vec<u32>, ReplayError> {
    let count = operands.len();
    if count == 0 {
        return Ok(Vec::new());
    }
    let kernel = kernel::in_stage(op, stage)?;
    let name = kernel::result_name(stage);
    let output = &kernel.output.vertex;
    let word = output.index_of(name).map(|k| output.range(k).start);
    let word = word.ok_or_else(|| ProgramError::Internal(format!("the kernel has no output `{name}`")))?;
    let mut runner = lane.prepare(&kernel, count)?;
    let mut operands = operands.peekable();
    let mut results = Vec::with_capacity(count);
    while operands.peek().is_some() {
        // All in one, unless the device takes fewer.
        let mut batch = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), 1, count);
        batch.invocations.extend(operands.by_ref().take(runner.capacity().max(1)).flatten());
        let actual = runner.run(&batch)?;
        results.extend((0..actual.count()).map(|k| actual.vertex(k, 0)[word]));
    }
    Ok(results)
}

fn judge(profile: &Profile, stage: Stage, op: Op, operands: &[u32], result: u32) -> Judged {
    let args: Vec<f64> = operands.iter().map(|&bits| f64::from(f32::from_bits(bits))).collect();
    // No specification promises what comes of infinities and NaN.
    let finite = args.iter().all(|x| x.is_finite());
    let accepted = if finite { accept(profile, op, &args, stage) } else { Err(Free::OutsideDomain) };
    Judged { result, exact: op.exact(&args), accepted }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::by_name;
    use crate::single::{Inputs, measurable};
    use lanes::{embedded, vulkan};
    use program::Kernel;
    use program::lane::{Actual, Description, Marks, Runner};

    /// The embedded lane, which adds something to the results of one operation.
    struct Faulty {
        lane: Box<dyn Lane>,
        op: Op,
        fault: f32,
    }

    struct FaultyRunner {
        runner: Box<dyn Runner>,
        fault: f32,
    }

    impl Lane for Faulty {
        fn description(&self) -> &Description {
            self.lane.description()
        }

        fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
            let runner = self.lane.prepare(kernel, capacity)?;
            let own = kernel.program.file.name() == format!("calibrate-{}.glsl", self.op.name());
            Ok(Box::new(FaultyRunner { runner, fault: if own { self.fault } else { 0.0 } }))
        }
    }

    impl Runner for FaultyRunner {
        fn capacity(&self) -> usize {
            // Fewer than are asked for.
            3
        }

        fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
            assert!(batch.invocation_count() <= 3);
            let actual = self.runner.run(batch)?;
            let marks = Marks::random();
            let record = |k: usize| {
                let result = f32::from_bits(actual.vertex(k, 0)[0]) + self.fault;
                [marks.canary ^ k as u32, result.to_bits()]
            };
            let words = (0..actual.count()).flat_map(record).collect();
            Actual::accept(actual.layout(), words, actual.count(), marks)
        }
    }

    fn vulkan_text() -> &'static Profile {
        by_name("vulkan-1.4").unwrap()
    }

    fn items(op: Op, count: u64) -> impl Iterator<Item = (Op, Vec<u32>)> {
        let inputs = Inputs::new(op);
        (0..count).map(move |k| (op, inputs.at(k)[..op.arity().unwrap()].to_vec()))
    }

    fn bits(values: &[f32]) -> Vec<u32> {
        values.iter().map(|x| x.to_bits()).collect()
    }

    #[test]
    fn exact_arithmetic_is_inside_for_every_operation() {
        let lane = embedded::open().unwrap();
        let items: Vec<_> = measurable().flat_map(|op| items(op, 500)).collect();
        let replayed = replay(&*lane, Stage::Compute, vulkan_text(), &items).unwrap();
        assert_eq!(replayed.len(), items.len());
        for (replayed, (op, operands)) in replayed.iter().zip(&items) {
            assert_eq!((replayed.op, &replayed.operands), (*op, operands));
            let judged = replayed.outcome.unwrap();
            assert!(!judged.is_outside(), "{op:?} {operands:?}: {judged:?}");
            assert!(judged.factor().is_none_or(|factor| factor <= 1.0), "{op:?} {operands:?}: {judged:?}");
        }
        let bounded = replayed.iter().filter(|r| r.outcome.unwrap().accepted.is_ok()).count();
        assert!(bounded > items.len() / 3, "{bounded}");
    }

    #[test]
    fn a_fault_past_the_promise_is_found_and_one_below_is_not() {
        let arguments = [0.3, 1.0, -1.2, 2.0, -3.0];
        let items: Vec<_> = [Op::Cos, Op::Sin].iter().flat_map(|&op| arguments.map(|x| (op, bits(&[x])))).collect();
        let promise = 2f32.powi(-11);
        for (fault, outside) in [(2.0 * promise, true), (0.5 * promise, false), (0.0, false)] {
            let lane = Faulty { lane: embedded::open().unwrap(), op: Op::Sin, fault };
            let replayed = replay(&lane, Stage::Compute, vulkan_text(), &items).unwrap();
            for replayed in &replayed {
                assert_eq!(replayed.is_outside(), outside && replayed.op == Op::Sin, "{fault}: {replayed:?}");
            }
            let factor = replayed[6].outcome.unwrap().factor().unwrap();
            assert!((factor - f64::from(fault / promise)).abs() < 1e-3, "{factor}");
        }
    }

    #[test]
    fn what_cannot_be_run_alone_is_listed_as_such() {
        let items = [
            (Op::Refract, bits(&[1.0; 7])),
            (Op::Add, bits(&[1.0])),
            (Op::Add, bits(&[1.0, 2.0])),
            (Op::Sin, bits(&[f32::INFINITY])),
        ];
        let lane = embedded::open().unwrap();
        let replayed = replay(&*lane, Stage::Compute, vulkan_text(), &items).unwrap();
        assert_eq!(replayed[0].outcome, Err(Skip::NoKernel));
        assert_eq!(replayed[1].outcome, Err(Skip::Operands { takes: 2 }));
        assert_eq!(replayed[2].outcome.unwrap().value(), 3.0);
        assert_eq!(replayed[3].outcome.unwrap().accepted, Err(Free::OutsideDomain));
        assert!(replay(&*lane, Stage::Vertex, vulkan_text(), &items).is_err());
        assert!(replay(&*lane, Stage::Compute, vulkan_text(), &[]).unwrap().is_empty());
    }

    #[test]
    fn factors_are_of_the_side_of_the_error() {
        let judged =
            |result: f32, lo, hi| Judged { result: result.to_bits(), exact: 1.0, accepted: Ok(Interval { lo, hi }) };
        assert_eq!(judged(2.0, 0.75, 1.5).factor(), Some(2.0));
        assert_eq!(judged(0.5, 0.75, 1.5).factor(), Some(2.0));
        assert_eq!(judged(2.0, 1.0, 1.0).factor(), Some(f64::INFINITY));
        assert_eq!(judged(0.5, 1.5, 1.5).factor(), Some(f64::INFINITY));
        assert_eq!(judged(f32::NAN, 0.0, f64::INFINITY).factor(), Some(f64::INFINITY));
        assert_eq!(judged(f32::INFINITY, 0.0, f64::INFINITY).factor(), Some(0.0));
        assert!(judged(f32::NAN, 0.0, 2.0).is_outside() && !judged(1.0, 1.0, 1.0).is_outside());
        assert_eq!(Judged { accepted: Err(Free::NoPromise), ..judged(2.0, 0.0, 0.0) }.factor(), None);
    }

    #[test]
    fn the_driver_keeps_its_promises_for_arithmetic_in_both_stages() {
        let lane = vulkan::open().expect("this test needs a Vulkan driver; `cargo xtask test` installs lavapipe");
        let arithmetic = [Op::Add, Op::Sub, Op::Mul, Op::Div, Op::Sin, Op::Cos, Op::Sqrt, Op::InverseSqrt];
        let items: Vec<_> = arithmetic.into_iter().flat_map(|op| items(op, 300)).collect();
        for &stage in &lane.description().stages {
            let replayed = replay(&*lane, stage, by_name("vulkan-cts").unwrap(), &items).unwrap();
            let outside: Vec<&Replayed> = replayed.iter().filter(|r| r.is_outside()).collect();
            assert!(outside.is_empty(), "{stage}: {outside:?}");
        }
    }
}
