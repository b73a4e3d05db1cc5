//! Verdicts on single words, in all slots of a chunk.

use super::fit::NEAR;
use super::judge::{Blame, Deviation, Doubt, Promise, Reason, Value, Verdict, What, agrees, real};
use super::open::{fades, fork, underflow};
use super::reference::{JudgedOutput, Reference};
use super::second_pass::{TWO_WAYS, USELESS, USELESS_64};
use crate::profile::grid::MIN_NORMAL;
use crate::tape::{FADED, Tape};
use base::value::{Scalar, ulp_at};
use program::OutputLayout;
use program::interp::{Machine, Number, OutputColumn, POISON, SLOTS};
use program::lane::Actual;

/// What a word of a lane tells.
pub(super) enum Told {
    /// It is right, by so many ULP; beside the start of what has faded out where it says so.
    Right {
        ulp: f64,
        faded: bool,
    },
    Open(Doubt),
    Wrong(What),
}

/// The verdict on a sample by those of its words that were judged.
#[derive(Clone, Debug)]
pub(super) struct SampleVerdict {
    pub verdict: Verdict,
    /// The largest error of words that are right, in ULP.
    pub ulp: f64,
    /// Some of them are right beside the start of what has faded out.
    pub faded: bool,
}

impl SampleVerdict {
    pub fn new(verdict: Verdict) -> Self {
        Self { verdict, ulp: 0.0, faded: false }
    }

    /// Takes in one more word; a difference is the fault of `blame`.
    pub fn tell(&mut self, word: Told, blame: Blame) {
        let verdict = match word {
            Told::Right { ulp, faded } => {
                (self.ulp, self.faded) = (self.ulp.max(ulp), self.faded | faded);
                return;
            }
            Told::Open(doubt) => Verdict::Undetermined(doubt),
            Told::Wrong(what) => Verdict::Deviate(Deviation { blame, what }),
        };
        let before = std::mem::replace(&mut self.verdict, Verdict::Agree(Promise::Text));
        self.verdict = Verdict::worse(Some(before), verdict, 0);
    }
}

/// What is made of what came of a word, with its error. `sizes` are those of its variable, and of the vectors among the inputs
/// as well.
pub(super) fn told(
    machine: &mut Machine<'_, Tape<'_>>,
    actual: &Actual,
    invocation: usize,
    (vertex, word, slot): (usize, usize, usize),
    (outcome, error, doubted): (Allowed, f64, bool),
    (scale, size): (f64, f64),
) -> Told {
    let record = &actual.layout().vertex;
    let scalar = record.scalar_of(word);
    let right = |ulp: f64, faded: bool| Told::Right { ulp, faded };
    match outcome {
        Allowed::Within if doubted => right(0.0, false),
        Allowed::Within if scalar == Scalar::F32 && scale < MIN_NORMAL && scale > 0.0 => {
            Told::Open(underflow(machine, vertex, word, slot))
        }
        // Beside its value at the start, what has faded out is 0 on every device.
        Allowed::Within if error <= FADED && scale <= FADED && fades(machine, vertex, word, slot) => {
            right(0.0, error > USELESS * size.max(MIN_NORMAL))
        }
        Allowed::Within if error > USELESS * size.max(MIN_NORMAL) => {
            let reason = Reason::IllConditioned;
            Told::Open(Doubt { reason, ..underflow(machine, vertex, word, slot) })
        }
        Allowed::Within => right(error / ulp_at(size), false),
        Allowed::Doubtful(doubt) => Told::Open(doubt),
        Allowed::Outside { meaning, bound } => {
            let found = found_word(actual, invocation, vertex, word);
            let component = record.word_name(word);
            let on = actual.layout().max_vertices.map(|_| vertex);
            Told::Wrong(match actual.is_unwritten(found) {
                true => What::NotWritten { component, vertex: on },
                false => {
                    What::Value(Value { component, vertex: on, expected: None, meaning, actual: found, scalar, bound })
                }
            })
        }
    }
}

/// The word of a lane; the mark of what was never written where the vertex is not stored.
pub(super) fn found_word(actual: &Actual, invocation: usize, vertex: usize, word: usize) -> u32 {
    if vertex < actual.stored(invocation) { actual.vertex(invocation, vertex)[word] } else { POISON }
}

/// What came of one word of one slot.
pub(super) enum Allowed {
    /// The error is within the bound, or within a part of it.
    Within,
    Doubtful(Doubt),
    Outside {
        meaning: f64,
        bound: f64,
    },
}

/// Slots of a chunk about which something is known.
pub(super) struct SlotsToJudge<'k> {
    /// Those to judge.
    pub open: &'k [usize],
    /// Those in which no comparison is in doubt.
    pub decided: &'k [bool],
    /// Those that are in doubt already: theirs come without a cause, and with any reason.
    pub doubted: &'k [bool; SLOTS],
}

/// Judges one output word in some slots. Gives the slot, what came of it, and its error.
pub(super) fn open_words(
    machine: &mut Machine<'_, Tape<'_>>,
    actual: &Actual,
    invocations: &[usize],
    &SlotsToJudge { open, decided, doubted }: &SlotsToJudge<'_>,
    vertex: usize,
    word: usize,
) -> Vec<(usize, Allowed, f64)> {
    let found = |slot: usize| actual.vertex(invocations[slot], vertex)[word];
    let column = match machine.output(vertex, word) {
        OutputColumn::Real(&column) => column,
        OutputColumn::Word(words) => {
            let (words, scalar) = (*words, actual.layout().vertex.scalar_of(word));
            let tape = machine.domain();
            let judge = |&slot: &usize| {
                let unwritten = words[slot] == POISON && actual.is_unwritten(found(slot));
                let outcome = if words[slot] == found(slot) || unwritten {
                    Allowed::Within
                } else if !decided[slot] && tape.fork(slot).is_some() {
                    Allowed::Doubtful(fork(tape, slot))
                } else {
                    Allowed::Outside { meaning: real(words[slot], scalar), bound: 0.0 }
                };
                (slot, outcome, 0.0)
            };
            return open.iter().map(judge).collect();
        }
    };
    let tape = machine.domain();
    let values = *tape.values(column);
    // NaN on either side gives an error that is within nothing.
    let errors: Vec<(usize, f64)> =
        open.iter().map(|&slot| (slot, (f64::from(f32::from_bits(found(slot))) - values[slot]).abs())).collect();
    let equal = |slot: usize| f64::from(f32::from_bits(found(slot))) == values[slot];
    // What is infinite stays so.
    let settled =
        |slot: usize, error: f64, bound: f64| bound == f64::INFINITY || equal(slot) || agrees(error, 0.0, bound);
    let bounds = tape.bounds(column, &mut |bound| errors.iter().all(|&(slot, e)| settled(slot, e, bound[slot])));
    errors
        .into_iter()
        .map(|(slot, error)| {
            let bound = bounds.bound[slot];
            if equal(slot) || agrees(error, 0.0, bound) {
                return (slot, Allowed::Within, if error.is_nan() { 0.0 } else { error });
            }
            // What the shader itself leaves unwritten, a lane may leave so.
            if values[slot].is_poison() && actual.is_unwritten(found(slot)) {
                return (slot, Allowed::Within, 0.0);
            }
            let outcome = if !values[slot].is_finite() || !bound.is_finite() {
                let cause = || Doubt::by(tape.cause(column, slot));
                Allowed::Doubtful(if doubted[slot] { Doubt::of(Reason::Branch) } else { cause() })
            } else if !decided[slot] && tape.fork(slot).is_some() {
                Allowed::Doubtful(fork(tape, slot))
            } else {
                Allowed::Outside { meaning: values[slot], bound }
            };
            (slot, outcome, error)
        })
        .collect()
}

pub(super) type Reevaluated = (usize, Result<(Option<f64>, f64), Doubt>);

/// What one word should be, for each slot.
pub(super) struct Aim<'t> {
    pub target: &'t dyn Fn(usize) -> Option<f64>,
    /// How far the target itself may be off.
    pub slack: &'t dyn Fn(usize) -> f64,
    /// Size of the largest component of the variable.
    pub scales: &'t [f64],
}

/// Judges one word of the formula in some slots: those in which the shader means something else, with
/// its meaning and what binary64 allows, or with a doubt.
pub(super) fn word_of_shader(
    machine: &mut Machine<'_, Tape<'_>>,
    vertex: usize,
    word: usize,
    output: &JudgedOutput,
    open: &[usize],
    &Aim { target, slack, scales }: &Aim<'_>,
) -> Vec<Reevaluated> {
    let column = match machine.output(vertex, word) {
        OutputColumn::Real(&column) => column,
        OutputColumn::Word(words) => {
            let (words, tape) = (*words, machine.as_domain());
            let wrong = |&slot: &usize| {
                let (meaning, wanted) = (<f64 as Number>::exact(words[slot], output.scalar), target(slot)?);
                let meaning = (words[slot] != POISON).then_some(meaning);
                if meaning.is_some_and(|meaning| agrees(meaning, wanted, slack(slot)) || meaning == wanted) {
                    return None;
                }
                if wanted.is_nan() || slack(slot) == f64::INFINITY {
                    // Nothing is expected here, or it is not known what.
                    let reason = if wanted.is_nan() { Reason::Domain } else { Reason::Branch };
                    return Some((slot, Err(Doubt::of(reason))));
                }
                if tape.fork(slot).is_some() {
                    return Some((slot, Err(fork(tape, slot))));
                }
                Some((slot, Ok((meaning, slack(slot)))))
            };
            return open.iter().filter_map(wrong).collect();
        }
    };
    let tape = machine.domain();
    let values = *tape.values(column);
    let far: Vec<(usize, f64)> = open
        .iter()
        .filter_map(|&slot| Some((slot, (values[slot] - target(slot)?).abs())))
        .filter(|&(slot, error)| !(error <= NEAR * scales[slot]) && target(slot) != Some(values[slot]))
        .collect();
    if far.is_empty() {
        return Vec::new();
    }
    let bounds = tape.bounds(column, &mut |_| false);
    let judge = |(slot, error): (usize, f64)| -> Option<Reevaluated> {
        let wanted = target(slot)?;
        let bound = TWO_WAYS * bounds.bound[slot] + NEAR * scales[slot] + slack(slot);
        if values[slot].is_poison() {
            return Some((slot, Ok((None, 0.0))));
        }
        if wanted.is_nan() {
            // The formula has no value here.
            return Some((slot, Err(Doubt { reason: Reason::Domain, cause: tape.cause(column, slot) })));
        }
        if slack(slot) == f64::INFINITY {
            // What is expected is not known well enough to be compared with.
            return Some((slot, Err(Doubt::of(Reason::IllConditioned))));
        }
        if agrees(error, 0.0, bound) {
            let useless = error - slack(slot) > USELESS_64 * scales[slot].max(MIN_NORMAL);
            return useless.then(|| (slot, Err(Doubt::of(Reason::IllConditioned))));
        }
        // A shader without a value where the formula has one is wrong.
        if values[slot].is_finite() && !bound.is_finite() {
            return Some((slot, Err(Doubt::by(tape.cause(column, slot)))));
        }
        if values[slot].is_finite() && tape.fork(slot).is_some() {
            return Some((slot, Err(fork(tape, slot))));
        }
        Some((slot, Ok((Some(values[slot]), if bound.is_finite() { bound } else { 0.0 }))))
    };
    far.into_iter().filter_map(judge).collect()
}

/// A word of a shader, with what a report shows of it.
pub(super) struct WordOfSample<'w> {
    pub layout: &'w OutputLayout,
    pub actual: Option<&'w Actual>,
    pub reference: &'w Reference,
    pub output: &'w JudgedOutput,
    pub vertex: usize,
    pub word: usize,
}

impl WordOfSample<'_> {
    /// What is wrong with it: the meaning and what binary64 allows, beside what is expected of an invocation.
    pub fn what(&self, (meaning, bound): (Option<f64>, f64), expected: Option<f64>, invocation: usize) -> What {
        let Self { layout, actual, reference, output, vertex, word } = *self;
        let component = layout.vertex.word_name(word);
        let vertex_of = reference.emits().then_some(vertex);
        match meaning {
            None => What::NotWritten { component, vertex: vertex_of },
            Some(meaning) => What::Value(Value {
                component,
                vertex: vertex_of,
                expected,
                meaning,
                actual: actual.map_or(POISON, |actual| found_word(actual, invocation, vertex, word)),
                scalar: output.scalar,
                bound,
            }),
        }
    }
}
