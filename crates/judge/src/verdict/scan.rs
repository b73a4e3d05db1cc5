//! The first look at the samples of a batch: which of them need no more.

use super::first_look::{self, ColumnValues, look};
use super::fit::{far_apart, unfit};
use super::oracle::JudgeContext;
use super::reference::{Evaluator, Expected};
use crate::tape::{Glance, Tape};
use base::value::{Batch, Scalar};
use program::interp::{Binary64, Domain, Machine, Mask, SLOTS};
use program::lane::Actual;

/// An invocation that the first look leaves open.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenSample {
    pub invocation: usize,
    /// The shader may not mean what the formula says.
    pub shader: bool,
    /// The lane may not give what the shader means.
    pub lane: bool,
    /// An undefined value came up on the way.
    pub undefined: bool,
}

/// What the first look finds.
#[derive(Default)]
pub(super) struct Scanned {
    /// What it leaves open.
    pub open: Vec<OpenSample>,
    /// Invocations for which nothing is promised, and which are as the device was measured.
    pub measured: Vec<usize>,
    /// The largest error of those that are right, in ULP.
    pub max_ulp: f64,
}

/// What one thread looks with.
pub(super) struct Scanner<'a> {
    context: JudgeContext<'a>,
    /// What settles most samples without a tape, as long as it does.
    glance: Option<Machine<'a, Glance<'a>>>,
    glances: Glances,
    /// What the module means, and how far a device may surely be off by the first promise.
    moving: Option<Machine<'a, Tape<'a>>>,
    /// The same as measured.
    measured: Option<Machine<'a, Tape<'a>>>,
    /// What the module means, where loops are too long for a tape.
    meaning: Option<Machine<'a, Binary64>>,
    /// Where literals are not binary32 numbers: what the author wrote.
    ideal: Option<Machine<'a, Binary64>>,
    evaluator: Evaluator<'a>,
    expected: Expected,
}

impl<'a> Scanner<'a> {
    pub(super) fn new(context: &JudgeContext<'a>, glances: bool) -> Self {
        Self {
            context: *context,
            glance: if glances { first_look::glance(context) } else { None },
            glances: Glances::default(),
            moving: first_look::machine(context),
            measured: context.measured().map(|model| context.oracle.moving_tape(model)),
            meaning: None,
            ideal: context.oracle.ideal(),
            evaluator: Evaluator::new(context.reference),
            expected: Expected::default(),
        }
    }

    /// Samples that were glanced at, and those of them that needed no more.
    pub(super) fn glanced(&self) -> [u64; 2] {
        [self.glances.samples as u64, (self.glances.samples - self.glances.open) as u64]
    }

    /// The first look at some invocations.
    pub(super) fn scan(&mut self, batch: &Batch, actual: &Actual, range: std::ops::Range<usize>) -> Scanned {
        let (mut scanned, mut unpromised) = (Scanned::default(), Vec::new());
        let mut left = Vec::new();
        let invocations = side_by_side(batch, range);
        for group in invocations.chunks(SLOTS) {
            if !self.glance(batch, actual, group, (&mut scanned, &mut unpromised)) {
                left.extend_from_slice(group);
                continue;
            }
            let open = std::mem::take(&mut scanned.open);
            left.extend(open.into_iter().map(|sample| sample.invocation));
        }
        for group in left.chunks(SLOTS) {
            self.look(batch, actual, group, (&mut scanned, &mut unpromised));
        }
        if let Some(machine) = &mut self.measured {
            for group in unpromised.chunks(SLOTS) {
                machine.run_some(batch, group);
                let seen = look(machine, actual, group, false);
                let (most, reference) = (&mut scanned.max_ulp, self.context.reference);
                let faint = seen.raise(most, seen.right, machine, reference, (batch, actual, group));
                let right = seen.right.minus(faint);
                for (slot, &invocation) in group.iter().enumerate() {
                    if right.has(slot) {
                        scanned.measured.push(invocation);
                    } else {
                        scanned.open.push(OpenSample { invocation, shader: false, lane: true, undefined: false });
                    }
                }
            }
        }
        scanned
    }

    /// Looks at a chunk without a tape. False, with nothing found, where that is not tried.
    fn glance(
        &mut self,
        batch: &Batch,
        actual: &Actual,
        group: &[usize],
        (scanned, unpromised): (&mut Scanned, &mut Vec<usize>),
    ) -> bool {
        let Self { context, glance, glances, measured, ideal, evaluator, expected, .. } = self;
        let Some(machine) = glance else { return false };
        machine.run_some(batch, group);
        if machine.as_domain().has_given_up() {
            *glance = None;
            return false;
        }
        if let Some(ideal) = ideal {
            ideal.run_some(batch, group);
        }
        let unpromised = measured.is_some().then_some(unpromised);
        let mut chunk = Chunk { context, ideal: ideal.as_ref(), evaluator, expected, unpromised, scanned };
        chunk.judge(machine, batch, actual, group);
        if !glances.go_on(group.len(), chunk.scanned.open.len()) {
            *glance = None;
        }
        true
    }

    /// Looks at a chunk with a tape.
    fn look(
        &mut self,
        batch: &Batch,
        actual: &Actual,
        group: &[usize],
        (scanned, unpromised): (&mut Scanned, &mut Vec<usize>),
    ) {
        let Self { context, moving, measured, meaning, ideal, evaluator, expected, .. } = self;
        if let Some(ideal) = ideal {
            ideal.run_some(batch, group);
        }
        let unpromised = measured.is_some().then_some(unpromised);
        let mut chunk = Chunk { context, ideal: ideal.as_ref(), evaluator, expected, unpromised, scanned };
        if let Some(machine) = moving {
            machine.run_some(batch, group);
            if machine.as_domain().has_given_up() {
                // It would again and again; the second look says of each sample what the first would.
                *moving = None;
            }
        }
        match moving {
            Some(machine) => chunk.judge(machine, batch, actual, group),
            None => {
                let machine = meaning.get_or_insert_with(|| context.oracle.meaning());
                machine.run_some(batch, group);
                chunk.judge(machine, batch, actual, group);
            }
        }
    }
}

/// Invocations in an order in which those with the same whole numbers among their uniforms come together: loops and branches
/// that these decide are then gone through by whole chunks.
fn side_by_side(batch: &Batch, range: std::ops::Range<usize>) -> Vec<usize> {
    let record = &batch.case_record;
    let fields = record.fields().iter().enumerate();
    let whole: Vec<usize> =
        fields.filter(|(_, field)| field.shape.scalar != Scalar::F32).flat_map(|(k, _)| record.range(k)).collect();
    if whole.is_empty() || range.is_empty() {
        return range.collect();
    }
    let mut cases: Vec<usize> = (range.start / batch.per_case..range.end.div_ceil(batch.per_case)).collect();
    cases.sort_by_cached_key(|&case| -> Vec<u32> { whole.iter().map(|&word| batch.case(case)[word]).collect() });
    let of = |case: usize| (case * batch.per_case).max(range.start)..((case + 1) * batch.per_case).min(range.end);
    cases.into_iter().flat_map(of).collect()
}

/// Whether glances are worth their time: what they leave open is looked at once more.
#[derive(Default)]
struct Glances {
    samples: usize,
    open: usize,
}

impl Glances {
    /// Counts the samples of a chunk and those that it left open. False where the next chunk is better looked at by a tape at
    /// once.
    fn go_on(&mut self, samples: usize, open: usize) -> bool {
        self.samples += samples;
        self.open += open;
        self.samples < 2 * SLOTS || 2 * self.open <= self.samples
    }
}

/// What the first look at a chunk needs beside the machine that ran it.
struct Chunk<'c, 'a> {
    context: &'c JudgeContext<'a>,
    ideal: Option<&'c Machine<'a, Binary64>>,
    evaluator: &'c mut Evaluator<'a>,
    expected: &'c mut Expected,
    /// Invocations for which nothing is promised, where measurements decide.
    unpromised: Option<&'c mut Vec<usize>>,
    scanned: &'c mut Scanned,
}

impl Chunk<'_, '_> {
    fn judge<D: ColumnValues>(
        &mut self,
        machine: &Machine<'_, D>,
        batch: &Batch,
        actual: &Actual,
        invocations: &[usize],
    ) {
        let reference = self.context.reference;
        let seen = look(machine, actual, invocations, true);
        let mut undefined = undefined_slots(machine);
        let expectation = (&mut *self.evaluator, &mut *self.expected);
        let shader = match self.ideal {
            Some(ideal) => {
                undefined = undefined.or(undefined_slots(ideal));
                far_apart(machine, ideal).or(unfit(ideal, reference, expectation, batch, invocations))
            }
            None => unfit(machine, reference, expectation, batch, invocations),
        };
        // Of a shader that may be wrong or undefined, only what is nearest is settled here.
        let clear = Mask::first(invocations.len()).minus(shader).minus(undefined);
        let settled = seen.right.and(clear).or(seen.nearest.minus(shader));
        let most = &mut self.scanned.max_ulp;
        let faint = seen.raise(most, settled, machine, reference, (batch, actual, invocations));
        let (right, settled) = (seen.right.minus(faint), settled.minus(faint));
        let agreed = right.and(clear);
        let mut rest = Mask::first(invocations.len()).minus(agreed);
        if let Some(unpromised) = &mut self.unpromised {
            let some = seen.unpromised.minus(seen.right).and(clear);
            unpromised.extend(some.slots().map(|slot| invocations[slot]));
            rest = rest.minus(some);
        }
        self.scanned.open.extend(rest.slots().map(|slot| OpenSample {
            invocation: invocations[slot],
            shader: shader.has(slot),
            lane: !settled.or(seen.nearest).has(slot),
            undefined: undefined.has(slot),
        }));
    }
}

/// The slots that came upon an undefined value.
fn undefined_slots<D: Domain>(machine: &Machine<'_, D>) -> Mask {
    let flags = machine.flags();
    if flags.iter().all(|flags| flags.is_empty()) {
        return Mask::NONE;
    }
    Mask::where_(|slot| flags[slot].is_undefined())
}
