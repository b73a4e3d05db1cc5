//! Whether two functions mean the same in real numbers.

use std::collections::BTreeMap;
use std::convert::Infallible;

use serde::{Deserialize, Serialize};

use super::accuracy::{Apart, Farthest, apart};
use super::curve::named;
use super::{Compared, ReadyPair};
use crate::InputValue;
use crate::activity;
use crate::fuzz::{Domain, Shrinking, Within};
use base::value::Batch;
use judge::profile::{Profile, Promises};
use judge::verdict::{JudgeContext, Reason, Verdict, What, unlike};
use lanes::{Api, Stage, interrupt};
use property::Sample;
use property::shrink;

/// Samples that are shrunk.
const SHRUNK: usize = 8;

/// A sample that means something else in the two.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unlike {
    /// The inputs of the first.
    pub inputs: Vec<InputValue>,
    /// The output that differs.
    pub output: String,
    /// Its values in real numbers; `None` where it is not a number of a word, such as a number of vertices.
    #[serde(with = "crate::bits")]
    pub values: Option<[f64; 2]>,
    /// What differs, in words.
    pub message: String,
    /// True for inputs that are taken for what their names and uses say.
    pub realistic: bool,
    /// The command that shows it.
    pub reproduce: String,
}

/// What is seen of samples.
#[derive(Default)]
pub(super) struct Meanings {
    samples: u64,
    reasons: BTreeMap<Reason, u64>,
    count: u64,
    /// Of these, those that devices cannot hide.
    beyond: u64,
    /// Of the others, those for which nothing bounds a device.
    unbounded: u64,
    /// Differing samples, realistic ones first; and of those as well that devices cannot hide.
    kept: Vec<(bool, Sample)>,
    kept_beyond: Vec<(bool, Sample)>,
}

/// How the two stand in a sample.
enum MeaningStanding {
    Unlike(String, Option<[f64; 2]>, String),
    Open(Reason),
}

impl ReadyPair<'_> {
    /// Samples that are not surely equal, each with what is known.
    fn standing(&self, batch: &Batch, fed: &Batch) -> BTreeMap<usize, MeaningStanding> {
        let promises = Promises::of_api(Api::Vulkan);
        let [first, second] = &self.oracles;
        let context =
            |oracle, reference| JudgeContext { oracle, reference, promises: &promises, stage: Stage::Compute };
        let mut all = BTreeMap::new();
        for (k, verdict) in unlike(&context(first, &self.reference), &self.sides[0].kernel.output, batch) {
            all.insert(k, standing(verdict, false));
        }
        // Where the second has no value, only the first can tell whether it has one.
        if let Some(reverse) = &self.reverse {
            for (k, verdict) in unlike(&context(second, reverse), &self.sides[1].kernel.output, fed) {
                if !matches!(all.get(&k), Some(MeaningStanding::Unlike(..))) {
                    all.insert(k, standing(verdict, true));
                }
            }
        }
        all
    }
}

fn in_words(component: &str, [first, second]: [f64; 2]) -> String {
    format!("`{component}` is {first:?} in the first and {second:?} in the second")
}

/// What a verdict says of the two; `turned` when the second was held against the first.
fn standing(verdict: Verdict, turned: bool) -> MeaningStanding {
    match verdict {
        Verdict::Undetermined(doubt) => MeaningStanding::Open(doubt.reason),
        Verdict::Agree(_) => MeaningStanding::Open(Reason::Branch),
        Verdict::Deviate(deviation) => match &deviation.what {
            What::Value(value) => {
                let values = [value.meaning, value.expected.unwrap_or(f64::NAN)];
                let values = if turned { [values[1], values[0]] } else { values };
                MeaningStanding::Unlike(value.component.clone(), Some(values), in_words(&value.component, values))
            }
            What::NotWritten { component, .. } => {
                let which = if turned { "second" } else { "first" };
                MeaningStanding::Unlike(component.clone(), None, format!("`{component}` is not written in the {which}"))
            }
            What::Endless => {
                let which = if turned { "second" } else { "first" };
                MeaningStanding::Unlike("loop".to_owned(), None, format!("a loop of the {which} does not end"))
            }
            What::VertexCount { .. } | What::Strip { .. } | What::TooManyVertices { .. } => {
                MeaningStanding::Unlike("vertices".to_owned(), None, deviation.to_string())
            }
        },
    }
}

impl Meanings {
    /// Counts samples of which nothing is known.
    pub(super) fn leave_open(&mut self, reason: Reason, count: u64) {
        if count > 0 {
            self.samples += count;
            *self.reasons.entry(reason).or_default() += count;
        }
    }

    /// Looks at a batch; gives for each sample whether it differs. Nothing once the run is to end: what was found until then
    /// may be found for want of time.
    pub(super) fn see(
        &mut self,
        (pair, profile): (&ReadyPair<'_>, &Profile),
        batch: &Batch,
        fed: &Batch,
        realistic: bool,
    ) -> Option<Vec<bool>> {
        let count = batch.invocation_count();
        let standing = pair.standing(batch, fed);
        if interrupt::asked() {
            return None;
        }
        self.samples += count as u64;
        let mut differing = vec![false; count];
        for (k, standing) in standing {
            match standing {
                MeaningStanding::Open(reason) => *self.reasons.entry(reason).or_default() += 1,
                MeaningStanding::Unlike(..) => {
                    differing[k] = true;
                    self.count += 1;
                    if self.kept.len() < SHRUNK {
                        self.kept.push((realistic, Sample::of(batch, k)));
                    }
                }
            }
        }
        let samples: Vec<Sample> = (0..count).filter(|&k| differing[k]).map(|k| Sample::of(batch, k)).collect();
        for ((apart, _), sample) in apart(pair, profile, &samples).into_iter().zip(samples) {
            match apart {
                Apart::Beyond => {
                    self.beyond += 1;
                    if self.kept_beyond.len() < SHRUNK {
                        self.kept_beyond.push((realistic, sample));
                    }
                }
                Apart::Unbounded => self.unbounded += 1,
                Apart::Within => {}
            }
        }
        Some(differing)
    }

    /// Shrinks what differs, and writes what was found; gives the smallest sample.
    pub(super) fn finish(
        self,
        (pair, profile): (&ReadyPair<'_>, &Profile),
        domain: &Domain,
        reproduce: &dyn Fn(&Sample) -> String,
        compared: &mut Compared,
    ) -> Option<Sample> {
        let open: u64 = self.reasons.values().sum();
        compared.equal = self.samples - open - self.count;
        compared.undetermined = self.reasons.into_iter().collect();
        compared.unlike = (self.count, self.beyond);
        compared.unbounded = self.unbounded;
        let realistic = self.kept.iter().any(|(realistic, _)| *realistic);
        // Other digits of a constant would hide what else differs.
        let beyond = self.kept_beyond.iter().any(|(of, _)| *of == realistic);
        let kept = if beyond { self.kept_beyond } else { self.kept };
        let first: Vec<Sample> =
            kept.into_iter().filter(|(of, _)| *of == realistic).map(|(_, sample)| sample).collect();
        if first.is_empty() {
            return None;
        }
        let mut differs = |samples: &[Sample]| -> Result<Vec<bool>, Infallible> {
            // Nothing is tried any more when the run is to end.
            if interrupt::asked() {
                return Ok(Vec::new());
            }
            let batch = Sample::batch(samples);
            let found = pair.standing(&batch, &pair.fed(&batch));
            let unlike = |k: usize| matches!(found.get(&k), Some(MeaningStanding::Unlike(..)));
            let far = if beyond { apart(pair, profile, samples) } else { Vec::new() };
            Ok((0..samples.len()).map(|k| unlike(k) && (!beyond || far[k].0 == Apart::Beyond)).collect())
        };
        let within = match realistic && !domain.is_stated() {
            true => Within::Realistic(&pair.sides[0].realistic),
            false => Within::Laws,
        };
        let shrunk = match activity::shrink(first, &Shrinking { domain, within }, &mut differs) {
            Ok(shrunk) => shrunk,
            Err(never) => match never {},
        };
        let plain = |sample: &Sample| shrink::Domain::simplest(&Shrinking { domain, within }, sample);
        let simpler = |a: &Sample, b: &Sample| shrink::complexity(a, &plain(a)).cmp(&shrink::complexity(b, &plain(b)));
        let sample = shrunk.into_iter().map(|one| one.sample).min_by(simpler)?;
        let batch = Sample::batch(std::slice::from_ref(&sample));
        let found = pair.standing(&batch, &pair.fed(&batch)).remove(&0);
        let Some(MeaningStanding::Unlike(mut output, mut values, mut message)) = found else { return None };
        // Of several values at a jump, the two are told that the texts have.
        let farthest = apart(pair, profile, std::slice::from_ref(&sample)).pop().and_then(|(_, farthest)| farthest);
        if let (Some(_), Some(Farthest { word, values: both })) = (values, farthest)
            && both[0] != both[1]
        {
            output = named(&pair.sides[0].kernel.output.vertex, word);
            message = in_words(&output, both);
            values = Some(both);
        }
        let (inputs, reproduce) = (InputValue::all(&sample, &pair.sides[0].program), reproduce(&sample));
        compared.smallest = Some(Unlike { inputs, output, values, message, realistic, reproduce });
        Some(sample)
    }
}
