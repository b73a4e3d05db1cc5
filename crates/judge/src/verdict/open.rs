//! What leaves a lane of a tape open.

use super::judge::{Doubt, Reason};
use crate::tape::Tape;
use program::interp::{Machine, OutputColumn};

/// Why nothing is known of a lane that was given up in a very long loop.
pub(super) fn cut(tape: &Tape<'_>, lane: usize) -> Option<Doubt> {
    let site = tape.given_up(lane)?;
    Some(Doubt { reason: Reason::LongLoop, cause: Some(tape.decision(site)) })
}

/// The comparison that could go either way in a lane.
pub(super) fn fork(tape: &Tape<'_>, lane: usize) -> Doubt {
    let cause = tape.fork(lane).map(|site| tape.decision(site));
    let reason = if tape.is_texel_edge(lane) { Reason::TexelEdge } else { Reason::Branch };
    Doubt { reason, cause }
}

/// The operation that has the largest part in the doubt about a small value.
pub(super) fn underflow(machine: &mut Machine<'_, Tape<'_>>, vertex: usize, word: usize, lane: usize) -> Doubt {
    let OutputColumn::Real(&column) = machine.output(vertex, word) else { return Doubt::of(Reason::Underflow) };
    let share = machine.domain().shares(column, lane, 1).into_iter().next();
    Doubt { reason: Reason::Underflow, cause: share.map(Into::into) }
}

/// True when an output word has faded out in a lane.
pub(super) fn fades(machine: &mut Machine<'_, Tape<'_>>, vertex: usize, word: usize, lane: usize) -> bool {
    let OutputColumn::Real(&column) = machine.output(vertex, word) else { return false };
    machine.domain().has_faded(column, lane)
}
