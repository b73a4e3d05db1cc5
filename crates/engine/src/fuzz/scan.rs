//! The first look at samples: what a function means, in binary64, beside what strict binary32 gives.

use rayon::prelude::*;

use base::value::{Batch, Record, Scalar, Shape};
use judge::verdict::{ENDLESS, Rounds};
use lanes::interrupt;
use program::interp::{Binary32, Binary64, Executable, HazardKind, Machine, Number, OutputColumn, POISON, SLOTS};

/// Part of an output's size that rounding may move it by before it counts as ill-conditioned.
pub const LIMIT: f64 = 1.0 / 1024.0;

/// A relative error that no operation of binary32 leaves by itself.
const EXACT: f64 = 1.0 / (1_u64 << 40) as f64;

/// One that a rounding may leave.
const ROUNDED: f64 = 1.0 / (1_u64 << 32) as f64;

/// Rounds of loops that one sample may go through.
pub const ROUNDS: u32 = ENDLESS;

const MAX_FINITE: f64 = f32::MAX as f64;
const MIN_NORMAL: f64 = f32::MIN_POSITIVE as f64;

/// What is wrong with a sample, the worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Trouble {
    /// A loop goes on for longer than `ROUNDS`.
    Endless,
    /// An output is NaN in real numbers.
    NoValue,
    /// An output is infinite in real numbers.
    Infinite,
    /// An output is NaN or infinite in binary32, and fits binary32 in real numbers.
    Lost,
    /// An output is too large for binary32 in real numbers.
    TooLarge,
    /// An output is never written.
    NotWritten,
    /// More vertices than `max_vertices`.
    TooManyVertices,
    /// An output depends on a variable without a value.
    Unset,
    /// An output depends on an operation whose value is undefined.
    Undefined,
    /// Rounding moves an output by more than [`LIMIT`] of its size.
    Moved,
    /// An output is 0 in real numbers and the error of another in binary32, as error-free transformations take it.
    Paired,
    /// An index outside of its array.
    Index,
    /// An integer divided by zero.
    DivisionByZero,
    /// A shift by 32 or more.
    Shift,
    /// A number that does not fit the integer that it is converted to.
    Conversion,
    /// A signed integer that does not fit.
    IntegerOverflow,
}

impl Trouble {
    /// The trouble that an undefined value is.
    pub fn of(kind: HazardKind) -> Self {
        match kind {
            HazardKind::Index => Self::Index,
            HazardKind::DivisionByZero => Self::DivisionByZero,
            HazardKind::Shift => Self::Shift,
            HazardKind::Conversion => Self::Conversion,
            HazardKind::Overflow => Self::IntegerOverflow,
            // These follow from the text, whatever the inputs.
            HazardKind::Unset | HazardKind::NoReturn | HazardKind::Overlap | HazardKind::Divergence => Self::Unset,
            HazardKind::Quotient
            | HazardKind::Remainder
            | HazardKind::BitField
            | HazardKind::Argument
            | HazardKind::Fuel
            | HazardKind::Killed
            | HazardKind::GivenUp => Self::Undefined,
        }
    }

    /// What the interpreter calls it, for what concerns integers.
    pub fn of_integers(self) -> Option<HazardKind> {
        Some(match self {
            Self::Index => HazardKind::Index,
            Self::DivisionByZero => HazardKind::DivisionByZero,
            Self::Shift => HazardKind::Shift,
            Self::Conversion => HazardKind::Conversion,
            Self::IntegerOverflow => HazardKind::Overflow,
            Self::Endless
            | Self::NoValue
            | Self::Infinite
            | Self::Lost
            | Self::TooLarge
            | Self::NotWritten
            | Self::TooManyVertices
            | Self::Unset
            | Self::Undefined
            | Self::Moved
            | Self::Paired => return None,
        })
    }
}

/// One sample, looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// What is wrong with it.
    pub trouble: Option<Trouble>,
    /// Where it shows: vertex and word of the output.
    pub place: (usize, usize),
    /// The largest error of binary32, as part of the size of the variable; 0 where there is trouble of
    /// another kind.
    pub error: f64,
    /// An output depends on an undefined value: devices need not agree on it, nor with themselves.
    pub undefined: bool,
    /// With [`Trouble::Paired`]: the relative errors of the other output, with this one added and without.
    pub pair: [f64; 2],
    /// How long its loops go on; of those that are not known to end nothing else is known.
    pub rounds: Rounds,
}

impl Look {
    fn note(&mut self, trouble: Trouble, place: (usize, usize)) {
        if self.trouble.is_none_or(|before| trouble < before) {
            (self.trouble, self.place) = (Some(trouble), place);
        }
    }
}

/// Looks at every sample of a batch, on all cores, until the process is asked to end; nothing is known of the others.
/// `record` is that of the outputs.
pub fn scan(executable: &Executable, record: &Record, batch: &Batch) -> Vec<Look> {
    let (wide, narrow) = (Rounds::of::<Binary64>(executable, batch), Rounds::of::<Binary32>(executable, batch));
    let rounds: Vec<Rounds> = wide.into_iter().zip(narrow).map(|(wide, narrow)| wide.max(narrow)).collect();
    let order = Rounds::order(&rounds);
    let chunks: Vec<Vec<Look>> = order
        .par_chunks(SLOTS)
        .map_init(
            || {
                let meaning = Machine::new(executable, Binary64::default(), ROUNDS);
                (meaning, Machine::new(executable, Binary32::default(), ROUNDS))
            },
            |(meaning, strict), chunk| {
                if interrupt::asked() {
                    return vec![Look { rounds: Rounds::Unknown, ..Look::default() }; chunk.len()];
                }
                let mut looks = chunk_of(meaning, strict, record, batch, chunk);
                undefined(meaning, record, batch, chunk, &mut looks);
                looks
            },
        )
        .collect();
    let endless = |rounds| (rounds == Rounds::Endless).then_some(Trouble::Endless);
    let unknown = |&rounds: &Rounds| Look { trouble: endless(rounds), rounds, ..Look::default() };
    let mut looks: Vec<Look> = rounds.iter().map(unknown).collect();
    for (invocation, look) in order.into_iter().zip(chunks.into_iter().flatten()) {
        looks[invocation] = Look { rounds: look.rounds.max(rounds[invocation]), ..look };
    }
    looks
}

fn chunk_of(
    meaning: &mut Machine<'_, Binary64>,
    strict: &mut Machine<'_, Binary32>,
    record: &Record,
    batch: &Batch,
    invocations: &[usize],
) -> Vec<Look> {
    let slots = meaning.run_some(batch, invocations);
    strict.run_some(batch, invocations);
    // They are asked for one by one when they are named.
    meaning.take_findings();
    strict.take_findings();
    let mut looks = vec![Look::default(); slots];
    for (slot, look) in looks.iter_mut().enumerate() {
        let (wide, narrow) = (meaning.flags()[slot], strict.flags()[slot]);
        if wide.is_stopped() || narrow.is_stopped() {
            look.rounds = Rounds::Unknown;
            continue;
        }
        // Whether it matters is found out at the end.
        look.undefined = wide.is_undefined();
        if wide.has(HazardKind::Overflow) {
            look.note(Trouble::IntegerOverflow, (0, 0));
        }
        if meaning.is_emitting() && meaning.emitted()[slot] as usize > meaning.room() {
            look.note(Trouble::TooManyVertices, (0, 0));
        }
    }
    // In each slot: values in real numbers and in binary32, with their words.
    let mut words: Vec<Vec<Word>> = vec![Vec::new(); slots];
    for vertex in 0..meaning.room() {
        words.iter_mut().for_each(Vec::clear);
        for field in 0..record.fields().len() {
            let range = record.range(field);
            let mut scale = [0.0_f64; SLOTS];
            for word in range.clone() {
                if let OutputColumn::Real(column) = meaning.output(vertex, word) {
                    scale.iter_mut().zip(column.values()).for_each(|(s, v)| *s = s.max(v.abs()));
                }
            }
            for word in range {
                let (wide, narrow) = match (meaning.output(vertex, word), strict.output(vertex, word)) {
                    (OutputColumn::Real(wide), OutputColumn::Real(narrow)) => (wide, narrow),
                    (OutputColumn::Word(words), _) => {
                        for (slot, look) in looks.iter_mut().enumerate().filter(|(slot, _)| words[*slot] == POISON) {
                            if !meaning.is_emitting() || (vertex as u32) < meaning.emitted()[slot] {
                                look.note(Trouble::NotWritten, (vertex, word));
                            }
                        }
                        continue;
                    }
                    (OutputColumn::Real(_), OutputColumn::Word(_)) => continue,
                };
                for (slot, look) in looks.iter_mut().enumerate() {
                    let emitted = |count: u32| !meaning.is_emitting() || (vertex as u32) < count;
                    // Where binary32 goes another way there is nothing to compare.
                    if !emitted(meaning.emitted()[slot]) || !emitted(strict.emitted()[slot]) {
                        continue;
                    }
                    let (exact, found) = (wide.values()[slot], narrow.values()[slot]);
                    value(look, exact, f64::from(found), found.is_poison(), scale[slot], (vertex, word));
                    words[slot].push((exact, f64::from(found), word));
                }
            }
        }
        for (look, words) in looks.iter_mut().zip(&words) {
            if let Some((pair, word)) = paired(words) {
                if look.trouble.is_none_or(|before| Trouble::Paired < before) {
                    look.pair = pair;
                }
                look.note(Trouble::Paired, (vertex, word));
            }
        }
    }
    looks
}

/// A value in real numbers, in binary32, and its word.
type Word = (f64, f64, usize);

/// A word that is 0 in real numbers and in binary32 what another one is off by; and the relative error of the other with and
/// without it.
fn paired(words: &[Word]) -> Option<([f64; 2], usize)> {
    // Nothing but noise: hardly any word.
    let noise = words.iter().filter(|(exact, found, _)| exact.abs() < found.abs() * LIMIT && found.is_finite());
    noise.into_iter().find_map(|&(exact, low, word)| {
        words.iter().find_map(|&(meaning, high, other)| {
            let size = meaning.abs();
            let [with, without] = [high + low - meaning, high - meaning].map(|error| error.abs() / size);
            let holds = other != word
                && exact.abs() <= size * EXACT
                && low.abs() <= size * LIMIT
                && without > ROUNDED
                && with <= EXACT;
            holds.then_some(([with, without], word))
        })
    })
}

/// Leaves undefined values out that no output depends on, and notes the others.
fn undefined(meaning: &mut Machine<'_, Binary64>, record: &Record, batch: &Batch, chunk: &[usize], looks: &mut [Look]) {
    let touched: Vec<usize> = (0..looks.len()).filter(|&slot| looks[slot].undefined).collect();
    if touched.is_empty() {
        return;
    }
    let invocations: Vec<usize> = touched.iter().map(|&slot| chunk[slot]).collect();
    let failed: Vec<bool> = touched.iter().map(|&slot| says_no(meaning, record, slot)).collect();
    for ((slot, found), failed) in touched.into_iter().zip(meaning.dependences(batch, &invocations, false)).zip(failed)
    {
        looks[slot].undefined = found.is_some();
        let unset = |kind| matches!(kind, HazardKind::Unset);
        if let Some(found) = found.filter(|found| !(failed && unset(found.of.kind))) {
            looks[slot].note(Trouble::of(found.of.kind), (0, 0));
        }
    }
}

/// True where a function returns `false`: there is no intersection, no root, no hit, and what its `out` parameters hold then,
/// nobody is to read.
fn says_no(meaning: &Machine<'_, Binary64>, record: &Record, slot: usize) -> bool {
    let returned =
        record.fields().first().filter(|field| field.name == "return" && field.shape == Shape::vector(Scalar::Bool, 1));
    returned.is_some() && matches!(meaning.output(0, 0), OutputColumn::Word(words) if words[slot] == 0)
}

/// Compares one word.
fn value(look: &mut Look, exact: f64, found: f64, unwritten: bool, scale: f64, place: (usize, usize)) {
    if exact.is_nan() {
        let trouble = if exact.is_poison() { Trouble::NotWritten } else { Trouble::NoValue };
        look.note(trouble, place);
    } else if exact.is_infinite() {
        look.note(Trouble::Infinite, place);
    } else if exact.abs() > MAX_FINITE {
        look.note(Trouble::TooLarge, place);
    } else if !found.is_finite() {
        if !unwritten {
            look.note(Trouble::Lost, place);
        }
    } else if (MIN_NORMAL..=MAX_FINITE).contains(&scale) {
        let error = (found - exact).abs() / scale;
        if error > LIMIT {
            look.note(Trouble::Moved, place);
        }
        look.error = look.error.max(error);
    }
}
