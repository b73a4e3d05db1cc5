//! Verdicts on whole batches, on all cores.
//!
//! Most samples are settled by a first look: the lane's words are the nearest to what the shader means,
//! and what it means is what the formula says to within the rounding of binary64. The others are
//! gathered and go through the tape.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::judge::{Blame, Deviation, Doubt, Promise, Reason, Verdict};
use super::oracle::JudgeContext;
use super::reference::{Evaluator, Expected, Reference};
use super::second_pass::SecondPass;
use super::undefined::{self, Looker};
use crate::profile::Op;
use crate::profile::grid::MIN_NORMAL;
use base::value::{Batch, Scalar, ulp_at};
use program::interp::{Binary64, HazardKind, Machine, Mask, Number, OutputColumn, SLOTS, Site};
use program::lane::Actual;

/// An invocation that deviates.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Its index in the batch.
    pub invocation: usize,
    /// How it deviates.
    pub deviation: Deviation,
}

/// Undetermined invocations with one reason and one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubts {
    /// Why.
    pub reason: Reason,
    /// The operation.
    pub op: Option<Op>,
    /// Where it stands.
    pub site: Option<Site>,
    /// Arguments of the operation in the first of them.
    pub args: Vec<f64>,
    /// Number of invocations.
    pub count: u64,
    /// Index of the first of them in the batch.
    pub first: usize,
}

/// The verdicts on a batch, counted.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct BatchVerdict {
    /// Invocations that agree.
    pub agreed: u64,
    /// How many of these agree by each promise, in the order of [`Promise::ALL`].
    pub agreed_by: [u64; Promise::ALL.len()],
    /// Invocations that deviate.
    pub deviated: u64,
    /// How many of these are the shader's fault.
    pub shader_deviated: u64,
    /// Undetermined invocations, in the order of [`Reason::ALL`].
    pub undetermined: [u64; Reason::ALL.len()],
    /// The same by place.
    #[serde(skip)]
    pub doubts: Vec<Doubts>,
    /// Largest distance between a lane and the meaning of the shader, of invocations that agree, in
    /// ULP of the largest component of the variable and of the vectors among the inputs.
    #[serde(with = "base::value::exact")]
    pub max_ulp: f64,
    /// Invocations that are right only where literals stand for the constants that they round.
    #[serde(default)]
    pub reread: u64,
    /// Invocations that agree beside the value 1 at the start of an exponential or a power which has faded out in them.
    #[serde(default)]
    pub faded: u64,
    /// The first few failures, in the order of the batch.
    #[serde(skip)]
    pub failures: Vec<Failure>,
    /// The first few invocations with an output that depends on an undefined value, in the order of the batch.
    #[serde(skip)]
    pub undefined: Vec<usize>,
}

/// Failures that are kept: enough to shrink, few enough to hold when everything fails.
const KEPT: usize = 16;

impl BatchVerdict {
    /// All undetermined invocations.
    pub fn undetermined_count(&self) -> u64 {
        self.undetermined.iter().sum()
    }

    /// All invocations that were looked at.
    pub fn seen(&self) -> u64 {
        self.agreed + self.deviated + self.undetermined_count()
    }

    /// The deviations alone, of samples that are no part of what is counted.
    #[must_use]
    pub fn deviations(&mut self) -> Self {
        Self {
            deviated: self.deviated,
            shader_deviated: self.shader_deviated,
            failures: std::mem::take(&mut self.failures),
            ..Self::default()
        }
    }

    /// Adds the verdicts on what comes after.
    pub fn merge(&mut self, later: Self) {
        let Self { agreed, agreed_by, deviated, shader_deviated, undetermined, doubts, max_ulp, .. } = later;
        self.faded += later.faded;
        self.reread += later.reread;
        self.agreed += agreed;
        self.agreed_by.iter_mut().zip(agreed_by).for_each(|(sum, n)| *sum += n);
        self.deviated += deviated;
        self.shader_deviated += shader_deviated;
        self.undetermined.iter_mut().zip(undetermined).for_each(|(sum, n)| *sum += n);
        doubts.into_iter().for_each(|doubts| self.doubt(doubts));
        self.max_ulp = self.max_ulp.max(max_ulp);
        let room = KEPT.saturating_sub(self.failures.len());
        self.failures.extend(later.failures.into_iter().take(room));
        let room = KEPT.saturating_sub(self.undefined.len());
        self.undefined.extend(later.undefined.into_iter().take(room));
    }

    fn doubt(&mut self, new: Doubts) {
        let same = |d: &&mut Doubts| (d.reason, d.op, d.site) == (new.reason, new.op, new.site);
        match self.doubts.iter_mut().find(same) {
            Some(doubts) => doubts.count += new.count,
            None => self.doubts.push(new),
        }
    }

    pub(super) fn count(&mut self, invocation: usize, verdict: Verdict) {
        match verdict {
            Verdict::Agree(promise) => {
                self.agreed += 1;
                self.agreed_by[promise as usize] += 1;
            }
            Verdict::Undetermined(Doubt { reason, cause }) => {
                self.undetermined[reason as usize] += 1;
                if reason == Reason::Undefined && self.undefined.len() < KEPT {
                    self.undefined.push(invocation);
                }
                let (op, site) = cause.as_ref().map_or((None, None), |cause| (cause.op, cause.site));
                let args = cause.map_or_else(Vec::new, |cause| cause.args);
                self.doubt(Doubts { reason, op, site, args, count: 1, first: invocation });
            }
            Verdict::Deviate(deviation) => {
                self.deviated += 1;
                self.shader_deviated += u64::from(deviation.blame == Blame::Shader);
                if self.failures.len() < KEPT {
                    self.failures.push(Failure { invocation, deviation });
                }
            }
        }
    }
}

/// Invocations that one thread judges at a time.
pub(super) const CHUNK: usize = 4096;
/// The same where each gets a verdict of its own.
const FEW: usize = 512;

/// Judges every invocation of a batch.
///
/// # Panics
/// When `actual` is not of this batch: a defect of the caller.
///
/// ```
/// use base::value::Batch;
/// use judge::verdict::{BatchVerdict, JudgeContext, judge_batch};
/// use program::lane::Actual;
///
/// fn verdict(context: &JudgeContext<'_>, batch: &Batch, actual: &Actual) -> BatchVerdict {
///     judge_batch(context, batch, actual)
/// }
/// ```
///
/// A comparison of a side with itself does not compile. This is the same text but for one type:
///
/// ```compile_fail,E0308
/// use base::value::Batch;
/// use judge::verdict::{BatchVerdict, JudgeContext, judge_batch};
/// use program::interp::Meaning;
///
/// fn verdict(context: &JudgeContext<'_>, batch: &Batch, actual: &Meaning<u32>) -> BatchVerdict {
///     judge_batch(context, batch, actual)
/// }
/// ```
pub fn judge_batch(context: &JudgeContext<'_>, batch: &Batch, actual: &Actual) -> BatchVerdict {
    let count = batch.invocation_count();
    assert_eq!(actual.count(), count, "outputs of another batch");
    let chunks: Vec<BatchVerdict> = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map_init(
            || Judge::new(context),
            |judge, chunk| judge.judge(batch, actual, chunk * CHUNK..((chunk + 1) * CHUNK).min(count)),
        )
        .collect();
    let mut all = BatchVerdict::default();
    for chunk in chunks {
        all.merge(chunk);
    }
    all
}

/// Judges each invocation of a small batch. The verdicts are in the order of the batch.
///
/// # Panics
/// When `actual` is not of this batch: a defect of the caller.
pub fn judge_each(context: &JudgeContext<'_>, batch: &Batch, actual: &Actual) -> Vec<Verdict> {
    let count = batch.invocation_count();
    assert_eq!(actual.count(), count, "outputs of another batch");
    let chunks: Vec<Vec<Verdict>> = (0..count.div_ceil(FEW))
        .into_par_iter()
        .map_init(
            || Judge::new(context),
            |judge, chunk| {
                let range = chunk * FEW..((chunk + 1) * FEW).min(count);
                let (first, mut verdicts) = (range.start, vec![Verdict::Agree(Promise::Text); range.len()]);
                let (open, _) = judge.scan(batch, actual, range);
                for (invocation, verdict) in judge.settle(batch, actual, open) {
                    verdicts[invocation - first] = verdict;
                }
                verdicts
            },
        )
        .collect();
    chunks.concat()
}

/// Judges one invocation of a batch.
///
/// # Panics
/// When `actual` is not of this batch: a defect of the caller.
pub fn judge_at(context: &JudgeContext<'_>, batch: &Batch, actual: &Actual, invocation: usize) -> Verdict {
    assert_eq!(actual.count(), batch.invocation_count(), "outputs of another batch");
    let mut judge = Judge::new(context);
    let (open, _) = judge.scan(batch, actual, invocation..invocation + 1);
    let judged = judge.settle(batch, actual, open).into_iter().next();
    judged.map_or(Verdict::Agree(Promise::Text), |(_, verdict)| verdict)
}

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

/// How near two evaluations in binary64 must be to count as equal at once, relative to the largest
/// component of the variable. Farther ones are judged by what binary64 may have done to them.
pub(super) const NEAR: f64 = 1.0 / (1_u64 << 40) as f64;

/// What one thread judges with.
struct Judge<'a> {
    context: JudgeContext<'a>,
    meaning: Machine<'a, Binary64>,
    /// Where literals are not binary32 numbers: what the author wrote.
    ideal: Option<Machine<'a, Binary64>>,
    evaluator: Evaluator<'a>,
    expected: Expected,
    second: SecondPass<'a>,
    looker: Looker<'a>,
}

impl<'a> Judge<'a> {
    fn new(context: &JudgeContext<'a>) -> Self {
        Self {
            context: *context,
            meaning: context.oracle.meaning(),
            ideal: context.oracle.ideal(),
            evaluator: Evaluator::new(context.reference),
            expected: Expected::default(),
            second: SecondPass::new(context),
            looker: Looker::new(context.oracle),
        }
    }

    /// Verdicts on open samples. Those that depend on an undefined value say nothing of the lane; a deviation of others
    /// that came upon one is held against nobody if NaN or infinity in its place would have led there.
    fn settle(&mut self, batch: &Batch, actual: &Actual, open: Vec<OpenSample>) -> Vec<(usize, Verdict)> {
        let (absent, open): (Vec<OpenSample>, Vec<OpenSample>) =
            open.into_iter().partition(|sample| actual.is_absent(sample.invocation));
        let mut judged = self.present(batch, actual, open);
        if !absent.is_empty() {
            let absent: Vec<usize> = absent.into_iter().map(|sample| sample.invocation).collect();
            let found = self.looker.on_the_way(batch, &absent);
            judged.extend(undefined::verdicts(&self.context, batch, &found));
        }
        judged
    }

    /// The same for those that the executor ran.
    fn present(&mut self, batch: &Batch, actual: &Actual, open: Vec<OpenSample>) -> Vec<(usize, Verdict)> {
        let touched: Vec<usize> = open.iter().filter(|s| s.undefined).map(|s| s.invocation).collect();
        if touched.is_empty() {
            return self.second.judge(batch, actual, &open);
        }
        let mut found = self.looker.look(batch, &touched, false);
        let rest: Vec<OpenSample> = open.into_iter().filter(|s| !found.contains_key(&s.invocation)).collect();
        let mut judged = self.second.judge(batch, actual, &rest);
        let accused = |(invocation, verdict): &(usize, Verdict)| {
            matches!(verdict, Verdict::Deviate(_)) && touched.contains(invocation)
        };
        let accused: Vec<usize> = judged.iter().filter(|one| accused(one)).map(|one| one.0).collect();
        found.extend(self.looker.look(batch, &accused, true));
        judged.retain(|(invocation, _)| !found.contains_key(invocation));
        judged.extend(undefined::verdicts(&self.context, batch, &found));
        judged
    }

    fn judge(&mut self, batch: &Batch, actual: &Actual, range: std::ops::Range<usize>) -> BatchVerdict {
        let mut verdict = BatchVerdict::default();
        let count = range.len();
        let (open, max_ulp) = self.scan(batch, actual, range);
        verdict.max_ulp = max_ulp;
        verdict.agreed = (count - open.len()) as u64;
        verdict.agreed_by[Promise::Text as usize] = verdict.agreed;
        let mut judged = self.settle(batch, actual, open);
        // What comes first must not depend on how samples are shared out among batches and threads.
        judged.sort_by_key(|(invocation, _)| *invocation);
        for (invocation, one) in judged {
            verdict.count(invocation, one);
        }
        verdict.max_ulp = verdict.max_ulp.max(self.second.take_max_ulp());
        verdict.reread = self.second.take_reread();
        verdict.faded = self.second.take_faded();
        verdict
    }

    /// The first look: the invocations that it leaves open, and the largest error of the others in ULP.
    fn scan(&mut self, batch: &Batch, actual: &Actual, range: std::ops::Range<usize>) -> (Vec<OpenSample>, f64) {
        let mut open = Vec::new();
        let mut max_ulp = 0.0_f64;
        for first in range.clone().step_by(SLOTS) {
            let slots = self.meaning.run(batch, first).min(range.end - first);
            let (near, ulp) = near_slots(&self.meaning, actual, first, slots);
            let mut apart = [false; SLOTS];
            let mut undefined = undefined_slots(&self.meaning);
            let ideal = match &mut self.ideal {
                Some(ideal) => {
                    ideal.run(batch, first);
                    apart = far_apart(&self.meaning, ideal);
                    undefined = undefined.or(undefined_slots(ideal));
                    &*ideal
                }
                None => &self.meaning,
            };
            let columns = columns(ideal, self.context.reference);
            let invocations: Vec<usize> = (first..first + slots).collect();
            self.evaluator.turn_to(batch, &invocations);
            for slot in 0..slots {
                let invocation = first + slot;
                self.evaluator.expected(batch, invocation, slot, &mut self.expected);
                let shader = apart[slot] || !fits(ideal, &columns, self.context.reference, &self.expected, slot);
                let undefined = undefined.has(slot);
                if shader || !near[slot] || undefined {
                    open.push(OpenSample { invocation, shader, lane: !near[slot], undefined });
                }
                if !shader && near[slot] {
                    max_ulp = max_ulp.max(ulp[slot]);
                }
            }
        }
        (open, max_ulp)
    }
}

/// The slots that came upon an undefined value.
fn undefined_slots(machine: &Machine<'_, Binary64>) -> Mask {
    let flags = machine.flags();
    if flags.iter().all(|flags| flags.is_empty()) {
        return Mask::NONE;
    }
    Mask::where_(|slot| flags[slot].is_undefined())
}

/// Literals that binary32 rounds move outputs by little. Farther than this they have decided something.
const APART: f64 = 1.0 / (1 << 16) as f64;

/// For each slot, whether the module means something else than what the author wrote.
fn far_apart(meaning: &Machine<'_, Binary64>, ideal: &Machine<'_, Binary64>) -> [bool; SLOTS] {
    let mut apart: [bool; SLOTS] = std::array::from_fn(|slot| meaning.emitted()[slot] != ideal.emitted()[slot]);
    for vertex in 0..meaning.room() {
        for word in 0..meaning.width() {
            match (meaning.output(vertex, word), ideal.output(vertex, word)) {
                (OutputColumn::Real(a), OutputColumn::Real(b)) => {
                    for ((apart, a), b) in apart.iter_mut().zip(a.values()).zip(b.values()) {
                        // Small outputs may be what is left of large terms: 1 stands for these.
                        *apart |= (a - b).abs() > APART * a.abs().max(1.0);
                    }
                }
                (OutputColumn::Word(a), OutputColumn::Word(b)) => {
                    apart.iter_mut().zip(a.iter().zip(b)).for_each(|(apart, (a, b))| *apart |= a != b);
                }
                _ => {}
            }
        }
    }
    apart
}

/// For each slot, whether every word of the lane is the one nearest to the shader's meaning, and the
/// largest error in ULP.
fn near_slots(
    meaning: &Machine<'_, Binary64>,
    actual: &Actual,
    first: usize,
    slots: usize,
) -> ([bool; SLOTS], [f64; SLOTS]) {
    let mut near = [true; SLOTS];
    let mut most = [0.0_f64; SLOTS];
    let geometry = actual.layout().max_vertices.is_some();
    let mut room = 1;
    if geometry {
        room = 0;
        for slot in 0..slots {
            let invocation = first + slot;
            let stored = actual.stored(invocation);
            room = room.max(stored);
            near[slot] = meaning.emitted()[slot] == actual.emitted(invocation)
                && (1..stored).all(|v| meaning.strip(v)[slot] == actual.strip(invocation, v));
        }
    }
    let record = &actual.layout().vertex;
    let mut scale = [0.0_f64; SLOTS];
    for vertex in 0..room {
        for field in 0..record.fields().len() {
            scale.fill(0.0);
            for word in record.range(field) {
                if let OutputColumn::Real(column) = meaning.output(vertex, word) {
                    for (scale, v) in scale.iter_mut().zip(column.values()) {
                        *scale = scale.max(v.abs());
                    }
                }
            }
            for word in record.range(field) {
                let column = meaning.output(vertex, word);
                for slot in 0..slots {
                    let invocation = first + slot;
                    if geometry && vertex >= actual.stored(invocation) {
                        continue;
                    }
                    let found = actual.vertex(invocation, vertex)[word];
                    match column {
                        OutputColumn::Real(column) => {
                            let value = column.values()[slot];
                            let error = (f64::from(f32::from_bits(found)) - value).abs();
                            // Half a gap, less what binary64 leaves open; NaN does not pass. Below the
                            // normal range a device may do what it likes, which says nothing.
                            let small = scale[slot] < MIN_NORMAL && scale[slot] != 0.0;
                            near[slot] &= error <= 0.499_999 * ulp_at(value) && !small;
                            most[slot] = most[slot].max(error / ulp_at(scale[slot]));
                        }
                        OutputColumn::Word(words) => near[slot] &= words[slot] == found,
                    }
                }
            }
        }
    }
    (near, most)
}

/// The columns of the outputs that the formula gives: by vertex, then by word of the formula.
fn columns<'m>(machine: &'m Machine<'_, Binary64>, reference: &Reference) -> Vec<Words<'m>> {
    let room = machine.room();
    let mut columns = Vec::with_capacity(room * reference.vertex_words);
    for vertex in 0..room {
        for output in &reference.outputs {
            for word in output.actual.clone() {
                columns.push(match machine.output(vertex, word) {
                    OutputColumn::Real(column) => Words::Real(column.values()),
                    OutputColumn::Word(words) => Words::Exact(words, output.scalar),
                });
            }
        }
    }
    columns
}

enum Words<'m> {
    Real(&'m [f64; SLOTS]),
    Exact(&'m [u32; SLOTS], Scalar),
}

impl Words<'_> {
    #[inline]
    fn at(&self, slot: usize) -> f64 {
        match self {
            Self::Real(values) => values[slot],
            Self::Exact(words, scalar) => <f64 as Number>::exact(words[slot], *scalar),
        }
    }
}

/// Invocations of a chunk in which the shader may not mean what the formula says, by the first look.
pub(super) fn open_samples(
    context: &JudgeContext<'_>,
    ideal: &mut Machine<'_, Binary64>,
    batch: &Batch,
    first: usize,
) -> Vec<usize> {
    let reference = context.reference;
    let slots = ideal.run(batch, first);
    let columns = columns(ideal, reference);
    let (mut evaluator, mut expected) = (Evaluator::new(reference), Expected::default());
    let invocations: Vec<usize> = (first..first + slots).collect();
    evaluator.turn_to(batch, &invocations);
    let mut open = Vec::new();
    for slot in 0..slots {
        let invocation = first + slot;
        evaluator.expected(batch, invocation, slot, &mut expected);
        if !fits(ideal, &columns, reference, &expected, slot) {
            open.push(invocation);
        }
    }
    open
}

/// True when the shader ends, emits what the formula emits, and means what it says, by the first look.
fn fits(
    machine: &Machine<'_, Binary64>,
    columns: &[Words<'_>],
    reference: &Reference,
    expected: &Expected,
    slot: usize,
) -> bool {
    !machine.flags()[slot].has(HazardKind::Fuel)
        && same_shape(machine, reference, expected, slot)
        && means(columns, reference, expected, slot)
}

/// True when the shader emits what the formula emits.
pub(super) fn same_shape<D: program::interp::Domain>(
    machine: &Machine<'_, D>,
    reference: &Reference,
    expected: &Expected,
    slot: usize,
) -> bool {
    if expected.strips.is_empty() && !reference.emits() {
        return true;
    }
    let count = expected.strips.len();
    machine.emitted()[slot] as usize == count
        && count <= machine.room()
        && (1..count).all(|v| {
            let begins = expected.strips[v] != expected.strips[v - 1];
            begins == (machine.strip(v)[slot] != machine.strip(v - 1)[slot])
        })
}

/// True when the shader means what the formula says, by the first look.
fn means(columns: &[Words<'_>], reference: &Reference, expected: &Expected, slot: usize) -> bool {
    let vertices = expected.words.len() / reference.vertex_words.max(1);
    for vertex in 0..vertices {
        let base = vertex * reference.vertex_words;
        for output in &reference.outputs {
            let at = base + output.expected.start..base + output.expected.end;
            let values = &expected.words[at.clone()];
            let scale = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let allowed = if output.scalar == Scalar::F32 { NEAR * scale } else { 0.0 };
            for ((k, value), column) in at.clone().zip(values).zip(&columns[at]) {
                // Written so that NaN does not pass.
                if !((column.at(slot) - value).abs() <= allowed + expected.slack(k)) {
                    return false;
                }
            }
        }
    }
    true
}
