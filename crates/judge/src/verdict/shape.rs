//! What is no number: how many vertices are emitted, and in which strips.

use super::fit::same_shape;
use super::judge::{Blame, Deviation, What};
use super::oracle::JudgeContext;
use super::reference::Expected;
use crate::tape::Tape;
use program::interp::{Domain, HazardKind, Machine};
use program::lane::Actual;

/// Compares what the shader emits with what the formula does.
pub(super) fn shape_of_shader(
    machine: &Machine<'_, Tape<'_>>,
    context: &JudgeContext<'_>,
    expected: &Expected,
    lane: usize,
) -> Option<Deviation> {
    let blame = Blame::Shader;
    if machine.flags()[lane].has(HazardKind::Fuel) {
        return Some(Deviation { blame, what: What::Endless });
    }
    if same_shape(machine, context.reference, expected, lane) {
        return None;
    }
    let (emitted, max) = (machine.emitted()[lane], machine.room() as u32);
    let count = expected.strips.len();
    let what = if emitted > max {
        What::TooManyVertices { emitted, max }
    } else if emitted as usize != count {
        What::VertexCount { expected: count, actual: emitted }
    } else {
        let begins = |v: usize| expected.strips[v] != expected.strips[v - 1];
        let began = |v: usize| machine.strip(v)[lane] != machine.strip(v - 1)[lane];
        let vertex = (1..count).find(|&v| begins(v) != began(v))?;
        What::Strip { vertex, begins: begins(vertex) }
    };
    Some(Deviation { blame, what })
}

/// The same between a lane and the shader.
pub(super) fn shape_of_lane<D: Domain>(
    machine: &Machine<'_, D>,
    actual: &Actual,
    invocation: usize,
    lane: usize,
) -> Option<Deviation> {
    let max = actual.layout().max_vertices?;
    let (emitted, meant) = (actual.emitted(invocation), machine.emitted()[lane]);
    let what = if emitted != meant {
        What::VertexCount { expected: meant as usize, actual: emitted }
    } else {
        let count = emitted.min(max) as usize;
        let begins = |v: usize| machine.strip(v)[lane] != machine.strip(v - 1)[lane];
        let began = |v: usize| actual.strip(invocation, v) != actual.strip(invocation, v - 1);
        let vertex = (1..count).find(|&v| begins(v) != began(v))?;
        What::Strip { vertex, begins: begins(vertex) }
    };
    Some(Deviation { blame: Blame::Lane, what })
}
