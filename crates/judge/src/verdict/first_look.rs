//! The first look at a chunk of samples: one pass over the operations, and one over the words of the lane.
//!
//! A word is right when it is the nearest to what the shader means, or nearer than a device may surely be off: the
//! allowance of [`Tape::allowance`] is at most the bound, so that the second look would say the same.
//!
//! Most samples need no more than a [`Glance`], which knows less than a tape and settles them alike.
//!
//! Most verdicts need no bound, only the knowledge that there is one that is large enough: for any choice of signs |Σ
//! ±∂y/∂v_k·b_k| is at most Σ |∂y/∂v_k|·b_k, and one forward derivative gives such a sum for all outputs at once.
//! Only the samples that this leaves open go through the reverse sweep, which runs once for each output.

use super::oracle::JudgeContext;
use super::reference::Reference;
use super::second_pass::USELESS;
use crate::profile::grid::MIN_NORMAL;
use crate::tape::{Column, FADED, Glance, Tape, gap};
use base::value::{Batch, ulp_at};
use program::interp::{Binary64, Domain, Machine, Mask, OutputColumn, SLOTS, Words};
use program::lane::Actual;

/// Half a gap, less what binary64 leaves open.
const NEAREST: f64 = 0.499_999;

/// A domain whose values are real numbers.
pub(super) trait ColumnValues: Domain {
    /// The numbers of a column.
    fn values<'c>(&'c self, column: &'c Self::Column) -> &'c [f64; SLOTS];

    /// How far a device may surely be off; NaN where nothing is known.
    fn allowance(&self, column: &Self::Column) -> [f64; SLOTS] {
        let _ = column;
        [f64::NAN; SLOTS]
    }

    /// Slots in which nothing bounds a column for want of a promise.
    fn unpromised(&self, column: &Self::Column) -> Mask {
        let _ = column;
        Mask::NONE
    }
}

impl ColumnValues for Binary64 {
    fn values<'c>(&'c self, column: &'c Self::Column) -> &'c [f64; SLOTS] {
        column.values()
    }
}

impl ColumnValues for Tape<'_> {
    fn values<'c>(&'c self, column: &'c Column) -> &'c [f64; SLOTS] {
        Tape::values(self, *column)
    }

    fn allowance(&self, column: &Column) -> [f64; SLOTS] {
        Tape::allowance(self, *column)
    }

    fn unpromised(&self, column: &Column) -> Mask {
        Tape::unpromised(self, *column)
    }
}

impl ColumnValues for Glance<'_> {
    fn values<'c>(&'c self, column: &'c Column) -> &'c [f64; SLOTS] {
        Glance::values(self, *column)
    }

    fn allowance(&self, column: &Column) -> [f64; SLOTS] {
        Glance::allowance(self, *column)
    }

    fn unpromised(&self, column: &Column) -> Mask {
        Glance::unpromised(self, *column)
    }
}

/// What a look at the words of a lane finds.
pub(super) struct Look {
    /// Slots in which every word is right.
    pub right: Mask,
    /// Slots in which every word is right, but for some for which nothing is promised.
    pub unpromised: Mask,
    /// Slots in which every word is the nearest.
    pub nearest: Mask,
    /// The largest error of each slot in ULP of its variable.
    ulp: [f64; SLOTS],
}

/// Looks at the words of a lane for the invocations that a machine ran. `nearest` words are right, whatever is promised;
/// without it only those that are what the shader means.
pub(super) fn look<D: ColumnValues>(
    machine: &Machine<'_, D>,
    actual: &Actual,
    invocations: &[usize],
    nearest: bool,
) -> Look {
    let slots = invocations.len();
    let mut look = Look {
        right: Mask::first(slots),
        unpromised: Mask::first(slots),
        nearest: Mask::first(slots),
        ulp: [0.0; SLOTS],
    };
    let geometry = actual.layout().max_vertices.is_some();
    let mut room = 1;
    if geometry {
        room = invocations.iter().map(|&invocation| actual.stored(invocation)).max().unwrap_or(0);
        let same = Mask::where_(|slot| {
            invocations.get(slot).is_some_and(|&invocation| {
                machine.emitted()[slot] == actual.emitted(invocation)
                    && (1..actual.stored(invocation)).all(|v| machine.strip(v)[slot] == actual.strip(invocation, v))
            })
        });
        look.keep(same, same, same);
    }
    let record = &actual.layout().vertex;
    for vertex in 0..room {
        let stored = if geometry {
            Mask::where_(|slot| invocations.get(slot).is_some_and(|&k| vertex < actual.stored(k)))
        } else {
            Mask::first(slots)
        };
        for field in 0..record.fields().len() {
            let mut scale = [0.0_f64; SLOTS];
            for word in record.range(field) {
                if let OutputColumn::Real(column) = machine.output(vertex, word) {
                    let values = machine.as_domain().values(column);
                    number::wide(|| (0..SLOTS).for_each(|slot| scale[slot] = scale[slot].max(values[slot].abs())));
                }
            }
            for word in record.range(field) {
                let mut found: Words = [0; SLOTS];
                let which = stored.slots().map(|slot| (slot, invocations[slot]));
                actual.gather(vertex, word, which, &mut found);
                look.word(machine, &machine.output(vertex, word), &found, &scale, stored, nearest);
            }
        }
    }
    // A word that is the nearest though nothing bounds it is right beside others of that kind alone.
    look.right = look.right.or(look.nearest);
    look
}

impl Look {
    fn keep(&mut self, right: Mask, unpromised: Mask, nearest: Mask) {
        self.right = self.right.and(right);
        self.unpromised = self.unpromised.and(unpromised);
        self.nearest = self.nearest.and(nearest);
    }

    fn word<D: ColumnValues>(
        &mut self,
        machine: &Machine<'_, D>,
        column: &OutputColumn<'_, D::Column>,
        found: &Words,
        scale: &[f64; SLOTS],
        stored: Mask,
        nearest: bool,
    ) {
        let absent = Mask::ALL.minus(stored);
        let column = match column {
            OutputColumn::Real(column) => *column,
            OutputColumn::Word(words) => {
                let same = Mask::where_(|slot| words[slot] == found[slot]).or(absent);
                return self.keep(same, same, same);
            }
        };
        let part = if nearest { NEAREST } else { 0.0 };
        let (values, allowance) = (machine.as_domain().values(column), machine.as_domain().allowance(column));
        let (mut near, mut within) = ([0_u8; SLOTS], [0_u8; SLOTS]);
        let mut ulp = [0.0_f64; SLOTS];
        number::wide(|| {
            for slot in 0..SLOTS {
                let (value, scale) = (values[slot], scale[slot]);
                let error = (f64::from(f32::from_bits(found[slot])) - value).abs();
                // Below the normal range a device may do what it likes, which says nothing.
                let normal = (scale >= MIN_NORMAL) | (scale == 0.0);
                // Written so that NaN does not pass.
                near[slot] = u8::from((error <= part * gap(value.abs())) & normal);
                // An error that is large for its value says nothing either.
                let allowed = (error <= allowance[slot]) | (error == 0.0);
                within[slot] = u8::from(allowed & normal & (error <= USELESS * scale));
                ulp[slot] = error / gap(scale);
            }
        });
        let near = Mask::where_(|slot| near[slot] != 0).or(absent);
        let within = Mask::where_(|slot| within[slot] != 0).or(absent);
        let unpromised = machine.as_domain().unpromised(column);
        self.keep(within, within.or(unpromised), near);
        if stored.is_full() {
            number::wide(|| (0..SLOTS).for_each(|slot| self.ulp[slot] = self.ulp[slot].max(ulp[slot])));
        } else {
            stored.each(|slot| self.ulp[slot] = self.ulp[slot].max(ulp[slot]));
        }
    }

    /// Raises `most` to the largest error of some slots in ULP: of the largest component of the variable, and where a word
    /// is not the nearest, of the vectors among the inputs as well. Gives the slots whose error counts unless their value
    /// has faded out, which this look does not know.
    pub(super) fn raise<D: ColumnValues>(
        &self,
        most: &mut f64,
        which: Mask,
        machine: &Machine<'_, D>,
        reference: &Reference,
        (batch, actual, invocations): (&Batch, &Actual, &[usize]),
    ) -> Mask {
        let mut faint = Mask::NONE;
        // What is no larger by its own variable is no larger by any.
        which.each(|slot| {
            if self.ulp[slot] > *most {
                let found = match self.nearest.has(slot) {
                    true => Some(self.ulp[slot]),
                    false => largest(machine, reference, batch, actual, invocations[slot], (slot, *most)),
                };
                match found {
                    Some(ulp) => *most = ulp,
                    None => faint.insert(slot),
                }
            }
        });
        faint
    }
}

/// The largest error of a slot, in ULP of the largest component of each variable and of the vectors among the inputs, if it
/// is more than `most`. `None` where that depends on whether a value has faded out.
fn largest<D: ColumnValues>(
    machine: &Machine<'_, D>,
    reference: &Reference,
    batch: &Batch,
    actual: &Actual,
    invocation: usize,
    (slot, mut most): (usize, f64),
) -> Option<f64> {
    let (record, domain) = (&actual.layout().vertex, machine.as_domain());
    let vectors = reference.vector_size(batch, invocation);
    for vertex in 0..actual.stored(invocation) {
        for field in 0..record.fields().len() {
            let reals = || {
                record.range(field).filter_map(|word| match machine.output(vertex, word) {
                    OutputColumn::Real(column) => Some((word, column)),
                    OutputColumn::Word(_) => None,
                })
            };
            let scale = reals().fold(0.0_f64, |scale, (_, column)| scale.max(domain.values(column)[slot].abs()));
            for (word, column) in reals() {
                let found = f64::from(f32::from_bits(actual.vertex(invocation, vertex)[word]));
                let error = (found - domain.values(column)[slot]).abs();
                let ulp = error / ulp_at(scale.max(vectors));
                if ulp > most {
                    if error <= FADED && scale <= FADED {
                        return None;
                    }
                    most = ulp;
                }
            }
        }
    }
    Some(most)
}

/// A machine for the first look: what the module means, and how far a device may surely be off by the first promise.
pub(super) fn machine<'a>(context: &JudgeContext<'a>) -> Option<Machine<'a, Tape<'a>>> {
    let (_, model) = context.tiers().into_iter().next()?;
    Some(context.oracle.moving_tape(model))
}

/// The same for a glance, which comes before it. `None` where the first promise is one that a glance does not know.
pub(super) fn glance<'a>(context: &JudgeContext<'a>) -> Option<Machine<'a, Glance<'a>>> {
    let (_, model) = context.tiers().into_iter().next()?;
    context.oracle.glance(model)
}
