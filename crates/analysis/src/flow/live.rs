//! Stores whose value nothing uses.

use std::collections::{BTreeMap, VecDeque};

use base::text::Span;
use syntax::Shader;
use syntax::ast::ExprId;
use syntax::symbols::{Direction, SymbolId, SymbolKind};

use super::graph::{Event, Graph, Kind, Store};

/// A store whose value nothing uses.
#[derive(Clone, Copy, Debug)]
pub struct Dead {
    /// The variable.
    pub symbol: SymbolId,
    /// The assignment.
    pub expr: ExprId,
    /// What is assigned to.
    pub span: Span,
}

/// True when the value outlives the function at the root.
fn outlives(shader: &Shader, symbol: SymbolId) -> bool {
    match shader.symbol(symbol).kind {
        SymbolKind::Local | SymbolKind::Param(Direction::In) => false,
        SymbolKind::Param(Direction::Out | Direction::InOut)
        | SymbolKind::Builtin
        | SymbolKind::Global(_)
        | SymbolKind::BlockMember(_)
        | SymbolKind::BlockInstance(_) => true,
    }
}

fn step(live: &mut [u64], event: &Event, graph: &Graph, kept: &[bool]) {
    match event.kind {
        Kind::Read { .. } => live[event.variable] |= event.mask,
        Kind::Write { exact: true, store: _ } => live[event.variable] &= !event.mask,
        Kind::Write { exact: false, store: _ } => {}
        Kind::Declare => live[event.variable] = 0,
        Kind::Copy { from } => {
            let needed = live[event.variable];
            live[event.variable] = 0;
            live[from] |= needed;
        }
        Kind::Emit => {
            for ((live, variable), kept) in live.iter_mut().zip(&graph.variables).zip(kept) {
                if *kept {
                    *live |= variable.full;
                }
            }
        }
        Kind::EndPrimitive | Kind::NoReturn { .. } => {}
    }
}

/// Assignments whose value is overwritten or dropped on every path, in each copy of their function.
pub fn dead(shader: &Shader, graph: &Graph) -> Vec<Dead> {
    let kept: Vec<bool> = graph.variables.iter().map(|s| outlives(shader, s.symbol)).collect();
    let before = graph.before();
    let n = graph.blocks.len();
    let at_exit: Vec<u64> = graph.variables.iter().zip(&kept).map(|(s, k)| if *k { s.full } else { 0 }).collect();
    // What is live at the end of each block.
    let mut live: Vec<Vec<u64>> = vec![vec![0; graph.variables.len()]; n];
    live[graph.exit].clone_from(&at_exit);
    let mut todo: VecDeque<usize> = (0..n).rev().collect();
    while let Some(at) = todo.pop_front() {
        let mut state = live[at].clone();
        graph.blocks[at].events.iter().rev().for_each(|e| step(&mut state, e, graph, &kept));
        for &b in &before[at] {
            let mut changed = false;
            for (old, new) in live[b].iter_mut().zip(&state) {
                changed |= *old | new != *old;
                *old |= new;
            }
            if changed && !todo.contains(&b) {
                todo.push_back(b);
            }
        }
    }
    let reached = graph.reached(true);
    let ends = paths_that_end(graph, &before);
    let mut stores: BTreeMap<ExprId, (Dead, bool)> = BTreeMap::new();
    for at in (0..n).filter(|at| reached[*at]) {
        let mut state = live[at].clone();
        for event in graph.blocks[at].events.iter().rev() {
            if let (Kind::Write { store: Store::Assigned, exact: _ }, Some(expr)) = (event.kind, event.expr) {
                let unused = state[event.variable] & event.mask == 0 && ends[at];
                let symbol = graph.variables[event.variable].symbol;
                let store = stores.entry(expr).or_insert((Dead { symbol, expr, span: event.span }, true));
                store.1 &= unused;
            }
            step(&mut state, event, graph, &kept);
        }
    }
    stores.into_values().filter(|(_, dead)| *dead).map(|(store, _)| store).collect()
}

/// Blocks from which the exit can be reached: where an invocation is given up, or never ends, nothing is
/// said about stores.
fn paths_that_end(graph: &Graph, before: &[Vec<usize>]) -> Vec<bool> {
    let mut seen = vec![false; graph.blocks.len()];
    let mut todo = vec![graph.exit];
    while let Some(at) = todo.pop() {
        if !std::mem::replace(&mut seen[at], true) {
            todo.extend(&before[at]);
        }
    }
    seen
}
