//! Verdicts on whole batches, on all cores.
//!
//! Most samples are settled by a first look: the lane's words are nearer to what the shader means than the operations may
//! move them, and what it means is what the formula says to within the rounding of binary64. The others are gathered, and
//! bounds are derived for them.

use serde::{Deserialize, Serialize};

use super::judge::{Blame, Deviation, Doubt, Promise, Reason, Verdict};
use super::oracle::JudgeContext;
use super::parallel::{Idle, parts};
use super::scan::{OpenSample, Scanned, Scanner};
use super::second_pass::SecondPass;
use super::undefined::{self, Looker};
use crate::profile::Op;
use base::value::Batch;
use program::interp::Site;
use program::lane::{Actual, interrupt};

/// An invocation that deviates.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Its index in the batch.
    pub invocation: usize,
    /// The wrong output, and whose fault it is.
    pub deviation: Deviation,
}

/// Undetermined invocations with one reason and one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubts {
    /// Why they are undetermined.
    pub reason: Reason,
    /// The operation.
    pub op: Option<Op>,
    /// The operation in the program; `None` if no operation is the reason.
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

    /// Adds invocations of which nothing is known.
    pub fn leave_open(&mut self, reason: Reason, count: u64) {
        self.undetermined[reason as usize] += count;
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
/// Once the process is asked to end, no more is looked at: fewer are [seen](BatchVerdict::seen) than the batch has.
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
    Judges::new(context).judge(batch, actual)
}

/// What judges batch after batch: machines and tapes stay from one to the next.
pub struct Judges<'a> {
    context: JudgeContext<'a>,
    idle: Idle<Judge<'a>>,
    /// Whether most samples are settled by a [`Glance`](crate::tape::Glance).
    glances: bool,
}

impl<'a> Judges<'a> {
    /// For batches of one program on one lane.
    pub fn new(context: &JudgeContext<'a>) -> Self {
        Self { context: *context, idle: Idle::default(), glances: true }
    }

    /// The same without the glance that comes first: verdicts are equal, and come later. For tests and benchmarks.
    #[must_use]
    pub fn without_glances(self) -> Self {
        Self { glances: false, ..self }
    }

    /// Samples that were glanced at, and those of them that needed no more.
    pub fn glanced(&self) -> [u64; 2] {
        self.idle.sum(|judge| judge.scanner.glanced())
    }

    /// The same as [`judge_batch`].
    ///
    /// # Panics
    /// When `actual` is not of this batch: a defect of the caller.
    pub fn judge(&self, batch: &Batch, actual: &Actual) -> BatchVerdict {
        let count = batch.invocation_count();
        assert_eq!(actual.count(), count, "outputs of another batch");
        let chunks = self.idle.parts(
            count.div_ceil(CHUNK),
            || Judge::new(&self.context, self.glances),
            |judge, chunk| match chunk > 0 && interrupt::asked() {
                true => BatchVerdict::default(),
                false => judge.judge(batch, actual, chunk * CHUNK..((chunk + 1) * CHUNK).min(count)),
            },
        );
        let mut all = BatchVerdict::default();
        for chunk in chunks {
            all.merge(chunk);
        }
        all
    }
}

/// Judges each invocation of a small batch. The verdicts are in the order of the batch.
///
/// # Panics
/// When `actual` is not of this batch: a defect of the caller.
pub fn judge_each(context: &JudgeContext<'_>, batch: &Batch, actual: &Actual) -> Vec<Verdict> {
    let count = batch.invocation_count();
    assert_eq!(actual.count(), count, "outputs of another batch");
    let chunks = parts(
        count.div_ceil(FEW),
        // What is looked at one by one has most often failed before, and a glance settles none of it.
        || Judge::new(context, false),
        |judge, chunk| {
            let range = chunk * FEW..((chunk + 1) * FEW).min(count);
            let (first, mut verdicts) = (range.start, vec![Verdict::Agree(Promise::Text); range.len()]);
            let Scanned { open, measured, .. } = judge.scanner.scan(batch, actual, range);
            measured.into_iter().for_each(|k| verdicts[k - first] = Verdict::Agree(Promise::Measured));
            for (invocation, verdict) in judge.settle(batch, actual, open) {
                verdicts[invocation - first] = verdict;
            }
            verdicts
        },
    );
    chunks.concat()
}

/// Judges one invocation of a batch.
///
/// # Panics
/// When `actual` is not of this batch: a defect of the caller.
pub fn judge_at(context: &JudgeContext<'_>, batch: &Batch, actual: &Actual, invocation: usize) -> Verdict {
    assert_eq!(actual.count(), batch.invocation_count(), "outputs of another batch");
    let mut judge = Judge::new(context, false);
    let Scanned { open, measured, .. } = judge.scanner.scan(batch, actual, invocation..invocation + 1);
    let promise = if measured.is_empty() { Promise::Text } else { Promise::Measured };
    let judged = judge.settle(batch, actual, open).into_iter().next();
    judged.map_or(Verdict::Agree(promise), |(_, verdict)| verdict)
}

/// What one thread judges with.
struct Judge<'a> {
    context: JudgeContext<'a>,
    scanner: Scanner<'a>,
    second: SecondPass<'a>,
    looker: Looker<'a>,
}

impl<'a> Judge<'a> {
    fn new(context: &JudgeContext<'a>, glances: bool) -> Self {
        Self {
            context: *context,
            scanner: Scanner::new(context, glances),
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
        let count = range.len();
        let Scanned { open, measured, max_ulp } = self.scanner.scan(batch, actual, range);
        let agreed = (count - open.len()) as u64;
        let mut verdict = BatchVerdict { agreed, max_ulp, ..BatchVerdict::default() };
        verdict.agreed_by[Promise::Text as usize] = agreed - measured.len() as u64;
        verdict.agreed_by[Promise::Measured as usize] = measured.len() as u64;
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
}
