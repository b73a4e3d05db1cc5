//! Verdicts on large dispatches: each word of the outputs is held against what the shader means there, and that against what
//! is expected.
//!
//! A small dispatch is judged like any other program, see [`judge_batch`](super::judge_batch). Here a bound is the radius
//! that goes with a word through all memory, and there is one pass for each promise, whatever the number of outputs.

use super::batch::BatchVerdict;
use super::fit::NEAR;
use super::judge::{Blame, Deviation, Doubt, Reason, Value, Verdict, What, real};
use super::oracle::JudgeContext;
use super::passes::Passes;
use super::reference::Expected;
use super::second_pass::{TWO_WAYS, USELESS};
use crate::profile::grid::MIN_NORMAL;
use crate::tape::Cell;
use base::value::{Batch, Scalar, ulp_at};
use program::interp::InterpError;
use program::interp::group::Ran;
use program::lane::Actual;

/// Judges a large dispatch. One of which at most the share `open` of the words stays undetermined agrees by the others.
///
/// # Errors
/// [`InterpError`] for what is no large dispatch.
pub fn judge_whole(passes: &Passes<'_>, actual: &Actual, open: f64) -> Result<BatchVerdict, InterpError> {
    let (verdict, ulp) = one(passes, actual, open)?;
    let mut all = BatchVerdict::default();
    all.count(0, verdict);
    all.max_ulp = ulp;
    Ok(all)
}

/// How much work a large dispatch is, in rounds of loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Work {
    /// Of the shader.
    pub shader: u64,
    /// Of its reference; 0 where that is no shader.
    pub reference: u64,
}

/// How much work it is to run an invocation that is a large dispatch, and its reference.
///
/// # Errors
/// [`InterpError`] for what is no large dispatch.
pub fn work_of_whole(context: &JudgeContext<'_>, batch: &Batch, invocation: usize) -> Result<Work, InterpError> {
    let shader = context.oracle.plain_whole(batch, invocation)?.rounds;
    Ok(Work { shader, reference: context.reference.rounds_of_whole(batch, invocation)? })
}

/// The verdict on a dispatch, with the largest error of a word that is right.
fn one(passes: &Passes<'_>, actual: &Actual, share: f64) -> Result<(Verdict, f64), InterpError> {
    let (context, batch) = (passes.context(), passes.batch());
    let tiers = context.tiers();
    let Some(&(_, model)) = tiers.first() else {
        return Ok((Verdict::Undetermined(Doubt::of(Reason::NoPromise)), 0.0));
    };
    let (device, expected) = rayon::join(|| passes.device(model), || context.reference.expect_whole(batch, 0, false));
    let (mut device, expected) = (device?, expected?);
    if !device.whole {
        return Ok((Verdict::Undetermined(Doubt::of(Reason::LongLoop)), 0.0));
    }
    let words = WordsOfWhole { context, actual };
    let against = match words.is_expected(&device, &expected, batch)? {
        true => Looked { open: vec![None; device.words.len()], ..Looked::default() },
        false => {
            let (meaning, expected) = rayon::join(|| passes.ideal(), || context.reference.expect_whole(batch, 0, true));
            let (meaning, expected) = (meaning?, expected?);
            words.against_expected(&meaning, &expected)
        }
    };
    if let Some(deviation) = against.deviation {
        return Ok((Verdict::Deviate(deviation), 0.0));
    }
    let mut last = None;
    for (tier, (promise, model)) in tiers.into_iter().enumerate() {
        if tier > 0 {
            device = passes.device(model)?;
        }
        let found = words.against_device(&device);
        let mut counts = [0_usize; Reason::ALL.len()];
        for reason in found.open.iter().zip(&against.open).filter_map(|(a, b)| a.or(*b)) {
            counts[reason as usize] += 1;
        }
        let open: usize = counts.iter().sum();
        let verdict = match found.deviation {
            Some(deviation) => Verdict::Deviate(deviation),
            None if open as f64 <= share * found.open.len() as f64 => return Ok((Verdict::Agree(promise), found.ulp)),
            None => {
                let most = (0..counts.len()).max_by_key(|&k| counts[k]).map_or(Reason::Branch, |k| Reason::ALL[k]);
                Verdict::Undetermined(Doubt::of(most))
            }
        };
        last = Some(Verdict::worse(last, verdict, tier));
    }
    Ok((last.unwrap_or(Verdict::Undetermined(Doubt::of(Reason::NoPromise))), 0.0))
}

/// What a look at all words finds.
#[derive(Default)]
struct Looked {
    /// The first word that deviates.
    deviation: Option<Deviation>,
    /// For each word of the outputs, why it is undetermined.
    open: Vec<Option<Reason>>,
    /// The largest error of a word that is right, in ULP of the largest of its variable.
    ulp: f64,
}

/// The words of a dispatch.
struct WordsOfWhole<'a> {
    context: &'a JudgeContext<'a>,
    actual: &'a Actual,
}

/// The largest value of a variable.
fn scale(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).filter(|size| size.is_finite()).fold(0.0, f64::max)
}

impl WordsOfWhole<'_> {
    /// A first look: whether all that the shader means is what is expected, to within the rounding of binary64.
    fn is_expected(&self, device: &Ran<Cell>, expected: &Expected, batch: &Batch) -> Result<bool, InterpError> {
        if expected.words.is_empty() {
            return Ok(true);
        }
        // Where a literal is no binary32 number, the meaning is another one.
        let oracle = self.context.oracle;
        let own = oracle.has_rounded_literals().then(|| oracle.plain_whole(batch, 0)).transpose()?;
        let real_of = |word: usize| own.as_ref().map_or(device.cells[word].value, |own| own.cells[word]);
        let words = own.as_ref().map_or(&device.words, |own| &own.words);
        Ok(self.context.reference.outputs.iter().all(|output| {
            let near = NEAR * scale(output.actual.clone().map(real_of));
            output.expected.clone().zip(output.actual.clone()).all(|(k, word)| match output.scalar {
                Scalar::F32 => (real_of(word) - expected.words[k]).abs() <= near,
                scalar => real(words[word], scalar) == expected.words[k],
            })
        }))
    }

    fn value(&self, word: usize, blame: Blame, expected: Option<f64>, meaning: f64, bound: f64) -> Deviation {
        let record = &self.actual.layout().vertex;
        let value = Value {
            component: record.word_name(word),
            vertex: None,
            expected,
            meaning,
            actual: self.actual.vertex(0, 0)[word],
            scalar: record.scalar_of(word),
            bound,
        };
        Deviation { blame, what: What::Value(value) }
    }

    /// What the shader means, against what is expected of it.
    fn against_expected(&self, meaning: &Ran<Cell>, expected: &Expected) -> Looked {
        let mut looked = Looked { open: vec![None; meaning.words.len()], ..Looked::default() };
        for output in &self.context.reference.outputs {
            let scale = scale(meaning.cells[output.actual.clone()].iter().map(|cell| cell.value));
            for (k, word) in output.expected.clone().zip(output.actual.clone()) {
                let (wanted, slack) = (expected.words[k], expected.slack(k));
                let cell = meaning.cells[word];
                let (value, bound) = match output.scalar {
                    Scalar::F32 => (cell.value, TWO_WAYS * cell.radius + NEAR * scale + slack),
                    scalar => (real(meaning.words[word], scalar), slack),
                };
                let reason = match () {
                    () if meaning.open[word] || !meaning.whole || slack == f64::INFINITY => Some(Reason::Branch),
                    // There is no value to compare with.
                    () if wanted.is_nan() => Some(Reason::Domain),
                    () if value.is_finite() && !bound.is_finite() => Some(Reason::IllConditioned),
                    () => None,
                };
                if reason.is_none() && value != wanted && !((value - wanted).abs() <= bound) {
                    let deviation = || self.value(word, Blame::Shader, Some(wanted), value, bound);
                    looked.deviation.get_or_insert_with(deviation);
                }
                looked.open[word] = reason;
            }
        }
        looked
    }

    /// What the lane wrote, against what the shader means to a device.
    fn against_device(&self, device: &Ran<Cell>) -> Looked {
        let layout = &self.actual.layout().vertex;
        let found = self.actual.vertex(0, 0);
        let mut looked = Looked { open: vec![None; found.len()], ..Looked::default() };
        if !device.whole {
            looked.open.fill(Some(Reason::LongLoop));
            return looked;
        }
        for field in 0..layout.fields().len() {
            let range = layout.range(field);
            let scale = scale(device.cells[range.clone()].iter().map(|cell| cell.value));
            for word in range {
                if layout.scalar_of(word) != Scalar::F32 {
                    if device.open[word] {
                        looked.open[word] = Some(Reason::Branch);
                    } else if found[word] != device.words[word] {
                        let meaning = real(device.words[word], layout.scalar_of(word));
                        looked.deviation.get_or_insert_with(|| self.value(word, Blame::Lane, None, meaning, 0.0));
                    }
                    continue;
                }
                let Cell { value, radius, .. } = device.cells[word];
                let error = (f64::from(f32::from_bits(found[word])) - value).abs();
                // What binary64 does to the value is far less than what a device may do.
                let bound = radius * (1.0 + NEAR);
                let same = found[word] == (value as f32).to_bits() || error == 0.0;
                looked.open[word] = match () {
                    () if device.open[word] => Some(Reason::Branch),
                    () if !value.is_finite() => Some(Reason::Domain),
                    () if !bound.is_finite() => Some(Reason::NoPromise),
                    () if same => None,
                    () if error <= bound && scale > 0.0 && scale < MIN_NORMAL => Some(Reason::Underflow),
                    () if error <= bound && error > USELESS * scale => Some(Reason::IllConditioned),
                    () => None,
                };
                if looked.open[word].is_some() {
                    continue;
                }
                if same || error <= bound {
                    looked.ulp = looked.ulp.max(error / ulp_at(scale.max(MIN_NORMAL)));
                } else {
                    looked.deviation.get_or_insert_with(|| self.value(word, Blame::Lane, None, value, bound));
                }
            }
        }
        looked
    }
}
