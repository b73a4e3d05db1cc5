//! Whether a shader means what its formula says, by the first look at a chunk of samples.

use super::first_look::ColumnValues;
use super::oracle::JudgeContext;
use super::reference::{Evaluator, Expected, Reference};
use base::value::{Batch, Scalar};
use program::interp::{Binary64, Domain, Machine, Mask, Number, OutputColumn, SLOTS};

/// How near two evaluations in binary64 must be to count as equal at once, relative to the largest
/// component of the variable. Farther ones are judged by what binary64 may have done to them.
pub(super) const NEAR: f64 = 1.0 / (1_u64 << 40) as f64;

/// Literals that binary32 rounds move outputs by little. Farther than this they have decided something.
const APART: f64 = 1.0 / (1 << 16) as f64;

/// The slots in which the module means something else than what the author wrote.
pub(super) fn far_apart<D: ColumnValues>(meaning: &Machine<'_, D>, ideal: &Machine<'_, Binary64>) -> Mask {
    let mut apart = Mask::where_(|slot| meaning.emitted()[slot] != ideal.emitted()[slot]);
    for vertex in 0..meaning.room() {
        for word in 0..meaning.width() {
            apart = apart.or(match (meaning.output(vertex, word), ideal.output(vertex, word)) {
                (OutputColumn::Real(a), OutputColumn::Real(b)) => {
                    let (a, b) = (meaning.as_domain().values(a), b.values());
                    let mut far = [0_u8; SLOTS];
                    number::wide(|| {
                        for slot in 0..SLOTS {
                            // Small outputs may be what is left of large terms: 1 stands for these.
                            far[slot] = u8::from((a[slot] - b[slot]).abs() > APART * a[slot].abs().max(1.0));
                        }
                    });
                    Mask::where_(|slot| far[slot] != 0)
                }
                (OutputColumn::Word(a), OutputColumn::Word(b)) => Mask::where_(|slot| a[slot] != b[slot]),
                _ => Mask::NONE,
            });
        }
    }
    apart
}

/// The columns of the outputs that the formula gives: by vertex, then by word of the formula.
fn columns<'m, D: ColumnValues>(machine: &'m Machine<'_, D>, reference: &Reference) -> Vec<ColumnWords<'m>> {
    let room = machine.room();
    let mut columns = Vec::with_capacity(room * reference.vertex_words);
    for vertex in 0..room {
        for output in &reference.outputs {
            for word in output.actual.clone() {
                columns.push(match machine.output(vertex, word) {
                    OutputColumn::Real(column) => ColumnWords::Real(machine.as_domain().values(column)),
                    OutputColumn::Word(words) => ColumnWords::Exact(words, output.scalar),
                });
            }
        }
    }
    columns
}

enum ColumnWords<'m> {
    Real(&'m [f64; SLOTS]),
    Exact(&'m [u32; SLOTS], Scalar),
}

impl ColumnWords<'_> {
    #[inline]
    fn at(&self, slot: usize) -> f64 {
        match self {
            Self::Real(values) => values[slot],
            Self::Exact(words, scalar) => <f64 as Number>::exact(words[slot], *scalar),
        }
    }
}

/// The slots in which the shader may not mean what the formula says, by the first look.
pub(super) fn unfit<D: ColumnValues>(
    ideal: &Machine<'_, D>,
    reference: &Reference,
    (evaluator, expected): (&mut Evaluator<'_>, &mut Expected),
    batch: &Batch,
    invocations: &[usize],
) -> Mask {
    let columns = columns(ideal, reference);
    evaluator.turn_to(batch, invocations);
    let mut unfit = Mask::NONE;
    for (slot, &invocation) in invocations.iter().enumerate() {
        evaluator.expected(batch, invocation, slot, expected);
        if !fits(ideal, &columns, reference, expected, slot) {
            unfit.insert(slot);
        }
    }
    unfit
}

/// The same as invocations of a chunk that is run here.
pub(super) fn open_samples(
    context: &JudgeContext<'_>,
    ideal: &mut Machine<'_, Binary64>,
    batch: &Batch,
    first: usize,
) -> Vec<usize> {
    let reference = context.reference;
    let invocations: Vec<usize> = (first..first + ideal.run(batch, first)).collect();
    let (mut evaluator, mut expected) = (Evaluator::new(reference), Expected::default());
    let open = unfit(ideal, reference, (&mut evaluator, &mut expected), batch, &invocations);
    open.slots().map(|slot| invocations[slot]).collect()
}

/// True when the shader ends, emits what the formula emits, and means what it says, by the first look.
fn fits<D: Domain>(
    machine: &Machine<'_, D>,
    columns: &[ColumnWords<'_>],
    reference: &Reference,
    expected: &Expected,
    slot: usize,
) -> bool {
    !machine.flags()[slot].is_stopped()
        && same_shape(machine, reference, expected, slot)
        && means(columns, reference, expected, slot)
}

/// True when the shader emits what the formula emits.
pub(super) fn same_shape<D: Domain>(
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
fn means(columns: &[ColumnWords<'_>], reference: &Reference, expected: &Expected, slot: usize) -> bool {
    let vertices = expected.words.len() / reference.vertex_words.max(1);
    for vertex in 0..vertices {
        let base = vertex * reference.vertex_words;
        for output in &reference.outputs {
            let at = base + output.expected.start..base + output.expected.end;
            let values = &expected.words[at.clone()];
            let scale = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let allowed = if output.scalar == Scalar::F32 { NEAR * scale } else { 0.0 };
            for ((k, value), column) in at.clone().zip(values).zip(&columns[at]) {
                // Written so that NaN does not pass, and one infinity is as good as the other.
                if column.at(slot) != *value && !((column.at(slot) - value).abs() <= allowed + expected.slack(k)) {
                    return false;
                }
            }
        }
    }
    true
}
