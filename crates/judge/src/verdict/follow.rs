//! Samples on all sides of decisions that may go either way.
//!
//! A comparison of numbers that are nearer to each other than their errors, a `floor` beside a whole number or a coordinate at
//! the edge of a texel leaves a sample open, and with it outputs that do not depend on it. Here such a sample runs on every
//! path through its decisions, as far as these are few. A word is right where it is on one of the paths, and wrong where it
//! is on none and all of them are known.
//!
//! An undefined value or a loop without end on a side path leaves the word open.

use std::ops::Range;

use super::judge::{Blame, Deviation, Doubt, Promise, Reason, Verdict, What};
use super::oracle::JudgeContext;
use super::reference::{Expected, Reference};
use super::shape::{shape_of_lane, shape_of_shader};
use super::words::{Aim, SampleVerdict, SlotsToJudge, Told, WordOfSample, open_words, told, word_of_shader};
use crate::tape::{Path, Tape};
use base::value::Batch;
use program::OutputLayout;
use program::interp::{Machine, OutputColumn, SLOTS};
use program::lane::Actual;

/// Paths of a sample that are followed.
const MOST_PATHS: usize = 64;

/// Combinations of sides that decisions on one path may have: with more, paths are not begun.
const MOST_COMBINED: usize = 4 * MOST_PATHS;

/// Pairs of a path of the program and one of its reference that may be compared.
const MOST_PAIRS: usize = 1 << 10;

/// A slot of a run and the sample that it runs.
pub(super) struct OnPath {
    pub slot: usize,
    pub sample: usize,
    /// The path of real numbers, which comes first.
    pub first: bool,
}

/// Whether a tape leaves a slot of its last run open, in a way that paths may settle.
pub(super) fn is_open(tape: &Tape<'_>, slot: usize) -> bool {
    tape.given_up(slot).is_none() && (tape.fork(slot).is_some() || tape.is_stepping(slot))
}

/// True for a doubt that paths may settle.
pub(super) fn may_be_settled(doubt: &Doubt) -> bool {
    match doubt.reason {
        Reason::Branch | Reason::TexelEdge | Reason::IllConditioned | Reason::Underflow => true,
        Reason::Domain | Reason::NoPromise | Reason::LongLoop | Reason::Overflow | Reason::Undefined => false,
    }
}

/// Sees a machine after a run, with the invocation of each slot and what the known ones are.
/// Gives samples whose other paths are not worth a look: these are not known.
type See<'s, 'a> = &'s mut dyn FnMut(&mut Machine<'a, Tape<'a>>, &[usize], &[OnPath]) -> Vec<usize>;

/// Runs invocations of a batch on all of their paths, and shows each run with what its slots are. Gives the samples, in the
/// order of `invocations`, of which every path is known: no decision was left open, no loop went on without end, and nothing on
/// the way was undefined.
pub(super) fn on_all_paths<'a>(
    machine: &mut Machine<'a, Tape<'a>>,
    batch: &Batch,
    invocations: &[usize],
    see: See<'_, 'a>,
) -> Vec<bool> {
    let mut known = vec![true; invocations.len()];
    let mut count = vec![1_usize; invocations.len()];
    let mut pending: Vec<(usize, Path)> = (0..invocations.len()).rev().map(|sample| (sample, Path::new())).collect();
    loop {
        pending.retain(|(sample, _)| known[*sample]);
        if pending.is_empty() {
            break;
        }
        let now = pending.split_off(pending.len().saturating_sub(SLOTS));
        let run: Vec<usize> = now.iter().map(|(sample, _)| invocations[*sample]).collect();
        machine.domain().follow(now.iter().map(|(_, path)| path.clone()).collect());
        machine.run_some(batch, &run);
        let flags = *machine.flags();
        let mut seen = Vec::with_capacity(now.len());
        for (slot, (sample, path)) in now.into_iter().enumerate() {
            let tape = machine.as_domain();
            // The path of real numbers was looked at for what is undefined on it.
            let undefined = !path.is_empty() && flags[slot].is_undefined();
            if undefined || flags[slot].is_stopped() || tape.fork(slot).is_some() || tape.given_up(slot).is_some() {
                known[sample] = false;
                continue;
            }
            let sides = tape.sides(slot);
            // Decisions that have no say about each other have all of their combinations.
            let combined = sides.iter().fold(1_usize, |all, sides| all.saturating_mul(usize::from(*sides)));
            if combined > MOST_COMBINED {
                known[sample] = false;
                continue;
            }
            for (k, &sides) in sides.iter().enumerate().skip(path.len()) {
                for side in 1..sides {
                    let mut next = path.clone();
                    next.resize(k, 0);
                    next.push(side);
                    count[sample] += 1;
                    pending.push((sample, next));
                }
            }
            known[sample] &= count[sample] <= MOST_PATHS;
            seen.push(OnPath { slot, sample, first: path.is_empty() });
        }
        see(machine, &run, &seen).into_iter().for_each(|sample| known[sample] = false);
    }
    machine.domain().follow(Vec::new());
    known
}

/// The samples of a run on the path of real numbers that no other path settles.
fn hopeless(best: &[Best], seen: &[OnPath]) -> Vec<usize> {
    seen.iter().filter(|on| on.first && best[on.sample].is_open()).map(|on| on.sample).collect()
}

/// What came of each word of a sample, on the best of its paths.
#[derive(Default)]
struct Best {
    /// By vertex and word.
    words: Vec<Option<Told>>,
    /// The shape on some path fits.
    fits: bool,
    /// Why it does not on another.
    shape: Option<Deviation>,
}

impl Best {
    /// Keeps the better of two things told of a word; of two that are wrong, the nearer one.
    fn tell(&mut self, at: usize, new: Told) {
        if self.words.len() <= at {
            self.words.resize_with(at + 1, || None);
        }
        let before = self.words[at].take();
        self.words[at] = Some(match before {
            None => new,
            Some(before) => better(before, new),
        });
    }

    /// True where some word is open for another reason than decisions and none is wrong: the sample will not deviate, and
    /// what is too coarse on one side hardly ever is not on another.
    fn is_open(&self) -> bool {
        let any = |told: fn(&Told) -> bool| self.words.iter().flatten().any(told);
        any(|told| matches!(told, Told::Open(_))) && !any(|told| matches!(told, Told::Wrong(_)))
    }

    /// What all words say of the sample.
    fn standing(self, blame: Blame, promise: Promise) -> SampleVerdict {
        if !self.fits
            && let Some(shape) = self.shape
        {
            return SampleVerdict::new(Verdict::Deviate(shape));
        }
        let mut standing = SampleVerdict::new(Verdict::Agree(promise));
        self.words.into_iter().flatten().for_each(|word| standing.tell(word, blame));
        standing
    }
}

fn better(a: Told, b: Told) -> Told {
    let off = |what: &What| match what {
        What::Value(value) => {
            let target = value.expected.unwrap_or(value.meaning);
            let found = super::judge::real(value.actual, value.scalar);
            let off = if value.expected.is_some() { value.meaning - target } else { found - target };
            if off.is_nan() { f64::INFINITY } else { off.abs() }
        }
        _ => f64::INFINITY,
    };
    match (a, b) {
        (Told::Right { ulp, faded }, Told::Right { ulp: other, faded: too }) => {
            if other < ulp {
                Told::Right { ulp: other, faded: too }
            } else {
                Told::Right { ulp, faded }
            }
        }
        (right @ Told::Right { .. }, _) | (_, right @ Told::Right { .. }) => right,
        (open @ Told::Open(_), _) | (_, open @ Told::Open(_)) => open,
        (Told::Wrong(a), Told::Wrong(b)) => Told::Wrong(if off(&b) < off(&a) { b } else { a }),
    }
}

/// Verdicts on a lane for samples whose decisions are open, with the largest error and whether something has faded out where
/// it agrees; `None` where not every path is known.
pub(super) fn lane<'a>(
    machine: &mut Machine<'a, Tape<'a>>,
    reference: &Reference,
    promise: Promise,
    (batch, actual): (&Batch, &Actual),
    invocations: &[usize],
) -> Vec<Option<SampleVerdict>> {
    let mut best: Vec<Best> = invocations.iter().map(|_| Best::default()).collect();
    let vectors: Vec<f64> = invocations.iter().map(|&invocation| reference.vector_size(batch, invocation)).collect();
    let record = actual.layout().vertex.clone();
    let mut see = |machine: &mut Machine<'a, Tape<'a>>, run: &[usize], seen: &[OnPath]| {
        let mut fitting = Vec::new();
        for &OnPath { slot, sample, .. } in seen {
            match shape_of_lane(machine, actual, run[slot], slot) {
                Some(shape) => best[sample].shape = Some(shape),
                None => {
                    best[sample].fits = true;
                    fitting.push((slot, sample));
                }
            }
        }
        for vertex in 0..machine.room() {
            let open: Vec<(usize, usize)> =
                fitting.iter().copied().filter(|(slot, _)| vertex < actual.stored(run[*slot])).collect();
            if open.is_empty() {
                continue;
            }
            for field in 0..record.fields().len() {
                let scale = scales(machine, vertex, record.range(field));
                for word in record.range(field) {
                    let slots: Vec<usize> = open.iter().map(|(slot, _)| *slot).collect();
                    let known = SlotsToJudge { open: &slots, decided: &[true; SLOTS], doubted: &[false; SLOTS] };
                    let outcomes = open_words(machine, actual, run, &known, vertex, word);
                    for ((slot, outcome, error), &(_, sample)) in outcomes.into_iter().zip(&open) {
                        let sizes = (scale[slot], scale[slot].max(vectors[sample]));
                        let known = (outcome, error, false);
                        let told = told(machine, actual, run[slot], (vertex, word, slot), known, sizes);
                        best[sample].tell(vertex * record.words() + word, told);
                    }
                }
            }
        }
        hopeless(&best, seen)
    };
    let known = on_all_paths(machine, batch, invocations, &mut see);
    let standing = |(best, known): (Best, bool)| known.then(|| best.standing(Blame::Lane, promise));
    best.into_iter().zip(known).map(standing).collect()
}

/// The largest component of a variable in each slot.
pub(super) fn scales(machine: &Machine<'_, Tape<'_>>, vertex: usize, words: Range<usize>) -> [f64; SLOTS] {
    let mut scale = [0.0_f64; SLOTS];
    for word in words {
        if let OutputColumn::Real(&column) = machine.output(vertex, word) {
            let values = machine.as_domain().values(column);
            scale.iter_mut().zip(values).for_each(|(s, v)| *s = s.max(v.abs()));
        }
    }
    scale
}

/// Verdicts on the shader for samples whose decisions are open, in it or in what is expected: `None` where not every path of
/// the two is known.
pub(super) fn shader<'a>(
    machine: &mut Machine<'a, Tape<'a>>,
    context: &JudgeContext<'a>,
    (batch, layout, actual): (&Batch, &OutputLayout, Option<&Actual>),
    invocations: &[usize],
    expected: &[Option<Vec<Expected>>],
) -> Vec<Option<Verdict>> {
    let reference = context.reference;
    let mut best: Vec<Best> = invocations.iter().map(|_| Best::default()).collect();
    let mut pairs = vec![0_usize; invocations.len()];
    let mut see = |machine: &mut Machine<'a, Tape<'a>>, run: &[usize], seen: &[OnPath]| {
        let most = expected.iter().flatten().map(Vec::len).max().unwrap_or(0);
        for alternative in 0..most {
            let wanted = |sample: usize| expected[sample].as_ref().and_then(|all| all.get(alternative));
            let mut of_slot: Vec<Option<&Expected>> = vec![None; SLOTS];
            let mut fitting = Vec::new();
            for &OnPath { slot, sample, .. } in seen {
                let Some(wanted) = wanted(sample) else { continue };
                pairs[sample] += 1;
                match shape_of_shader(machine, context, wanted, slot) {
                    Some(shape) => best[sample].shape = Some(shape),
                    None => {
                        best[sample].fits = true;
                        of_slot[slot] = Some(wanted);
                        fitting.push((slot, sample));
                    }
                }
            }
            for vertex in 0..machine.room() {
                for output in &reference.outputs {
                    let base = vertex * reference.vertex_words;
                    let scales: Vec<f64> = of_slot
                        .iter()
                        .map(|expected| {
                            let range = base + output.expected.start..base + output.expected.end;
                            let values = expected.and_then(|expected| expected.words.get(range));
                            values.map_or(0.0, |values| values.iter().fold(0.0_f64, |m, v| m.max(v.abs())))
                        })
                        .collect();
                    for k in 0..output.expected.len() {
                        let at = base + output.expected.start + k;
                        let target = |slot: usize| of_slot[slot].and_then(|expected| expected.words.get(at).copied());
                        let slack = |slot: usize| of_slot[slot].map_or(0.0, |expected| expected.slack(at));
                        let open: Vec<(usize, usize)> =
                            fitting.iter().copied().filter(|(slot, _)| target(*slot).is_some()).collect();
                        let slots: Vec<usize> = open.iter().map(|(slot, _)| *slot).collect();
                        let word = output.actual.start + k;
                        let aim = Aim { target: &target, slack: &slack, scales: &scales };
                        let mut found =
                            word_of_shader(machine, vertex, word, output, &slots, &aim).into_iter().peekable();
                        for (slot, sample) in open {
                            let told = match found.next_if(|(of, _)| *of == slot) {
                                None => Told::Right { ulp: 0.0, faded: false },
                                Some((_, Err(doubt))) => Told::Open(doubt),
                                Some((_, Ok(meant))) => {
                                    let word = WordOfSample { layout, actual, reference, output, vertex, word };
                                    Told::Wrong(word.what(meant, target(slot), run[slot]))
                                }
                            };
                            best[sample].tell(at, told);
                        }
                    }
                }
            }
        }
        hopeless(&best, seen)
    };
    let known = on_all_paths(machine, batch, invocations, &mut see);
    let known = known.into_iter().zip(expected).zip(pairs);
    let verdict = |(best, ((known, expected), pairs)): (Best, ((bool, &Option<_>), usize))| {
        let whole = known && expected.is_some() && pairs <= MOST_PAIRS;
        whole.then(|| best.standing(Blame::Shader, Promise::Text).verdict)
    };
    best.into_iter().zip(known).map(verdict).collect()
}
