//! What leaves a slot of a tape open.

use super::judge::{Doubt, Reason};
use crate::tape::Tape;
use program::interp::{Machine, OutputColumn};

/// Why nothing is known of a slot that was given up in a very long loop.
pub(super) fn cut(tape: &Tape<'_>, slot: usize) -> Option<Doubt> {
    let site = tape.given_up(slot)?;
    Some(Doubt { reason: Reason::LongLoop, cause: Some(tape.decision(site)) })
}

/// The comparison that could go either way in a slot.
pub(super) fn fork(tape: &Tape<'_>, slot: usize) -> Doubt {
    let cause = tape.fork(slot).map(|site| tape.decision(site));
    let reason = if tape.is_texel_edge(slot) { Reason::TexelEdge } else { Reason::Branch };
    Doubt { reason, cause }
}

/// The operation that has the largest part in the doubt about a small value.
pub(super) fn underflow(machine: &mut Machine<'_, Tape<'_>>, vertex: usize, word: usize, slot: usize) -> Doubt {
    let OutputColumn::Real(&column) = machine.output(vertex, word) else { return Doubt::of(Reason::Underflow) };
    let share = machine.domain().shares(column, slot, 1).into_iter().next();
    Doubt { reason: Reason::Underflow, cause: share.map(Into::into) }
}

/// True when an output word has faded out in a slot.
pub(super) fn fades(machine: &mut Machine<'_, Tape<'_>>, vertex: usize, word: usize, slot: usize) -> bool {
    let OutputColumn::Real(&column) = machine.output(vertex, word) else { return false };
    machine.domain().has_faded(column, slot)
}
