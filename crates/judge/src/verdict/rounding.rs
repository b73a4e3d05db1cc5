//! How far literals that round a constant move the outputs.

use super::oracle::{JudgeContext, Oracle};
use super::rounded::Rounded;
use base::value::{Batch, Record, ulp_at};
use program::Program;
use program::interp::{Binary64, Machine, OutputColumn};
use serde::{Deserialize, Serialize};

/// What the digits of a literal do to an output of one invocation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// The component that moves farthest.
    pub component: String,
    /// How far it moves.
    #[serde(with = "base::value::exact")]
    pub error: f64,
    /// The same in ULP of the largest component of the variable.
    #[serde(with = "base::value::exact")]
    pub ulp: f64,
}

/// For each invocation of a batch, how far a literal moves the outputs from where its constant would have them; `None`
/// where it moves none.
pub fn effects(context: &JudgeContext<'_>, program: &Program, one: &Rounded, batch: &Batch) -> Vec<Option<Effect>> {
    let record = &program.output_layout().vertex;
    let read: Oracle = context.oracle.read(program, one);
    let (mut written, mut meant) = (context.oracle.ideal_or_meaning(), read.ideal_or_meaning());
    let mut all = Vec::with_capacity(batch.invocation_count());
    while all.len() < batch.invocation_count() {
        let slots = written.run(batch, all.len());
        meant.run(batch, all.len());
        all.extend((0..slots).map(|slot| largest(record, &written, &meant, slot)));
    }
    all
}

/// The component of an invocation that moves by the most ULP.
fn largest(
    record: &Record,
    written: &Machine<'_, Binary64>,
    meant: &Machine<'_, Binary64>,
    slot: usize,
) -> Option<Effect> {
    let value = |machine: &Machine<'_, Binary64>, vertex: usize, word: usize| match machine.output(vertex, word) {
        OutputColumn::Real(column) => Some(column.values()[slot]),
        OutputColumn::Word(_) => None,
    };
    let stored = if meant.is_emitting() { meant.room().min(meant.emitted()[slot] as usize) } else { 1 };
    let mut most: Option<Effect> = None;
    for vertex in 0..stored {
        for field in 0..record.fields().len() {
            let words = || record.range(field);
            let size = words().filter_map(|word| value(meant, vertex, word)).fold(0.0_f64, |m, v| m.max(v.abs()));
            for word in words() {
                let (Some(a), Some(b)) = (value(written, vertex, word), value(meant, vertex, word)) else { continue };
                let error = (a - b).abs();
                let ulp = error / ulp_at(size);
                if error > 0.0 && most.as_ref().is_none_or(|most| ulp > most.ulp) {
                    most = Some(Effect { component: record.word_name(word), error, ulp });
                }
            }
        }
    }
    most
}
