//! Samples at the edges of what a program decides.
//!
//! A fault that shows beside a branch alone is missed by inputs drawn from a distribution. The interpreter sees every
//! comparison, and every built-in function with a bend or a jump, of a few samples. Where two of them are on different
//! sides, inputs of the one are replaced by inputs of the other until a single word makes the difference, and that word
//! is halved until it is one step of binary32 or of an integer: these are the nearest samples on both sides. Where all
//! are on one side, a short search goes for the other.
//!
//! All of it depends on the program, the samples and the domain alone.
//!
//! These samples come beside the stream of a suite, whose bits stay as they are, and are judged by the first part of
//! a run. Deviations among them count. What agrees or is undetermined is counted apart, since most of them lie where
//! a lane may decide either way.

mod approach;
mod bisect;
mod question;
mod watch;

use std::collections::{BTreeMap, BTreeSet, HashSet};

use base::value::{Batch, Scalar};
use program::interp::{Machine, SLOTS, Site};
use program::lane::interrupt;
use property::Sample;
use property::shrink::Domain;

use super::Oracle;
use question::UNASKED;
use watch::{Answers, Key};

pub use question::Question;
pub(super) use watch::Watch;

/// Times that samples are sought: what lies behind a branch is met when its edge was found.
const PASSES: usize = 3;
/// Pairs that are divided in one pass; they share the slots of one chunk.
const PAIRS: usize = 32;
/// Samples that are found at most.
const FOUND: usize = 224;
/// Samples that are kept for each side of a question.
const KEPT: usize = 3;
/// Chunks that all searches of one program may run.
const BUDGET: usize = 120;
/// Rounds of loops that they may go through in all.
const ROUNDS: u64 = 1 << 16;

/// What became of a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reached {
    /// The comparison or function in the program.
    pub site: Site,
    /// The question that it asks of its arguments.
    pub question: Question,
    /// One bit for each of [`Question::classes`]: whether some sample was of this class.
    pub met: u16,
}

/// Samples at the edges of a program.
#[derive(Clone, Debug)]
pub struct Edges {
    /// Those that were given, and those that were found.
    pub samples: Vec<Sample>,
    /// What these and the pilot met, by place.
    pub reached: Vec<Reached>,
}

/// Finds samples at the edges of what the program decides. `pilot` is a batch of ordinary samples, `given` are samples at
/// the edges of the inputs; what is found lies in the domain.
pub fn edges(oracle: &Oracle, domain: &dyn Domain, pilot: &Batch, given: Vec<Sample>) -> Edges {
    let mut search = EdgeSearch {
        domain,
        watch: oracle.watch(),
        tries: oracle.watch(),
        pool: Vec::new(),
        values: values(&given),
        known: BTreeMap::new(),
        budget: BUDGET,
    };
    let (mut samples, most) = (Vec::new(), given.len());
    let mut seen = HashSet::new();
    let mut add = |new: Vec<Sample>| -> Vec<Sample> {
        new.into_iter().filter(|s| seen.insert((s.case.clone(), s.invocation.clone()))).collect()
    };
    search.learn(pilot);
    // A shader without end is a finding by itself, and every try would go through all rounds.
    let endless = search.watch.flags().iter().any(|flags| flags.is_stopped());
    let mut new = add(given);
    let passes = if endless { 0 } else { PASSES };
    for _ in 0..passes {
        if !new.is_empty() {
            search.learn(&Sample::batch(&new));
        }
        samples.append(&mut new);
        let mut found = search.approach();
        if !found.is_empty() {
            search.learn(&Sample::batch(&found));
        }
        found.extend(search.bisect());
        new = add(found);
        new.truncate((most + FOUND).saturating_sub(samples.len()));
        if new.is_empty() {
            break;
        }
    }
    if !new.is_empty() {
        search.learn(&Sample::batch(&new));
        samples.append(&mut new);
    }
    let met = search.watch.domain().met();
    let mut reached: Vec<Reached> = met.map(|(site, question, met)| Reached { site, question, met }).collect();
    reached.sort_by_key(|reached| (reached.site, reached.question));
    Edges { samples, reached }
}

/// What is known of one answer.
#[derive(Default)]
struct Sides {
    /// Samples by the side on which they are, as indices into the pool.
    on: BTreeMap<i8, Vec<usize>>,
    /// The sample that is nearest to another side, with its distance.
    nearest: Option<(f32, usize)>,
    /// Whether the distances differ: inputs have a say in it. What a single sample met may differ as well.
    moves: bool,
    met: usize,
    /// Pairs of samples that were halved.
    halved: BTreeSet<(usize, usize)>,
    /// Whether another side was looked for.
    sought: bool,
}

/// A search under way.
struct EdgeSearch<'a> {
    domain: &'a dyn Domain,
    /// Sees the samples of the run alone.
    watch: Machine<'a, Watch>,
    /// Sees what is tried.
    tries: Machine<'a, Watch>,
    /// Samples that answered.
    pool: Vec<Sample>,
    /// Values of each word among the samples at the edges of inputs.
    values: Vec<Vec<u32>>,
    known: BTreeMap<Key, Sides>,
    budget: usize,
}

impl EdgeSearch<'_> {
    /// Takes note of how samples answer.
    fn learn(&mut self, batch: &Batch) {
        let count = batch.invocation_count();
        for first in (0..count).step_by(SLOTS) {
            let slots = self.watch.run(batch, first);
            self.watch.take_findings();
            let mut places = vec![None; slots];
            for (key, answers) in self.watch.domain().answers() {
                note(self.known.entry(key).or_default(), answers, slots, &mut |slot| {
                    *places[slot].get_or_insert_with(|| {
                        self.pool.push(Sample::of(batch, first + slot));
                        self.pool.len() - 1
                    })
                });
            }
        }
    }

    /// Runs samples that are tried, at most [`SLOTS`]. `None` when the budget is spent.
    fn try_all(&mut self, samples: &[Sample]) -> Option<&Watch> {
        self.budget = self.budget.checked_sub(1)?;
        if self.tries.rounds() > ROUNDS || interrupt::asked() {
            return None;
        }
        let batch = Sample::batch(samples);
        self.tries.run(&batch, 0);
        self.tries.take_findings();
        Some(self.tries.domain())
    }
}

/// Adds the answers of a chunk. `place` gives the index of a slot's sample in the pool.
fn note(sides: &mut Sides, answers: &Answers, slots: usize, place: &mut dyn FnMut(usize) -> usize) {
    for slot in 0..slots {
        let (side, gap) = (answers.sides[slot], answers.gaps[slot].abs());
        if side == UNASKED {
            continue;
        }
        // Sides of numbers between whole numbers are many: some transitions are enough.
        sides.met += 1;
        let on = sides.on.len();
        match sides.on.get_mut(&side) {
            Some(kept) if kept.len() < KEPT => kept.push(place(slot)),
            None if on < 8 => {
                sides.on.insert(side, vec![place(slot)]);
            }
            Some(_) | None => {}
        }
        match sides.nearest {
            _ if gap.is_nan() => {}
            Some((least, _)) => {
                sides.moves |= gap != least;
                if gap < least {
                    sides.nearest = Some((gap, place(slot)));
                }
            }
            None => sides.nearest = Some((gap, place(slot))),
        }
    }
}

/// The values that each word takes in some samples.
fn values(samples: &[Sample]) -> Vec<Vec<u32>> {
    let count = samples.first().map_or(0, words);
    let values = |at: usize| samples.iter().map(|sample| word(sample, at)).collect::<BTreeSet<u32>>();
    (0..count).map(|at| values(at).into_iter().collect()).collect()
}

/// The type of a word of a sample; uniforms come first.
fn scalar(sample: &Sample, word: usize) -> Scalar {
    match word.checked_sub(sample.case.len()) {
        None => sample.case_record.scalar_of(word),
        Some(word) => sample.invocation_record.scalar_of(word),
    }
}

fn word(sample: &Sample, word: usize) -> u32 {
    match word.checked_sub(sample.case.len()) {
        None => sample.case[word],
        Some(word) => sample.invocation[word],
    }
}

fn word_mut(sample: &mut Sample, word: usize) -> &mut u32 {
    match word.checked_sub(sample.case.len()) {
        None => &mut sample.case[word],
        Some(word) => &mut sample.invocation[word],
    }
}

/// Words of a sample.
fn words(sample: &Sample) -> usize {
    sample.case.len() + sample.invocation.len()
}

/// The place of a word's value among all values of its type, neighbours side by side. The two zeros have one place.
fn rank(word: u32, scalar: Scalar) -> i64 {
    let signed = i64::from(word.cast_signed());
    match scalar {
        Scalar::F32 if signed < 0 => i64::from(i32::MIN) - signed,
        Scalar::F32 | Scalar::I32 => signed,
        Scalar::U32 | Scalar::Bool => i64::from(word),
    }
}

/// The word with this place.
fn ranked(rank: i64, scalar: Scalar) -> u32 {
    match scalar {
        Scalar::F32 if rank < 0 => (i64::from(i32::MIN) - rank) as i32 as u32,
        Scalar::F32 | Scalar::I32 => rank as i32 as u32,
        Scalar::U32 | Scalar::Bool => rank as u32,
    }
}

#[cfg(test)]
mod tests;
