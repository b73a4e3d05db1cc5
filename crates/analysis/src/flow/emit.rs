//! What outputs hold at `EmitVertex`: behind it all of them are undefined (GLSL 1.50, section 8.10).

use std::collections::{BTreeMap, VecDeque};

use base::text::Span;
use syntax::symbols::SymbolId;

use super::assign;
use super::graph::{Event, Graph, Kind};

/// An output that keeps nothing, where the shader counts on it.
#[derive(Clone, Copy, Debug)]
pub struct Stale {
    /// The output.
    pub symbol: SymbolId,
    /// The `EmitVertex` that emits it.
    pub emit: Span,
    /// A place where it was set before.
    pub set: Span,
}

/// What happened to a variable since an `EmitVertex`; on paths that passed one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Since {
    /// Components that some path did not set again.
    stale: u64,
    /// Components that some path set again.
    fresh: u64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct State {
    emitted: bool,
    variables: Vec<Since>,
}

impl State {
    fn step(&mut self, event: &Event, graph: &Graph) {
        match event.kind {
            Kind::Emit => {
                self.emitted = true;
                for (since, variable) in self.variables.iter_mut().zip(&graph.variables) {
                    *since = Since { stale: variable.full, fresh: 0 };
                }
            }
            Kind::Write { .. } if self.emitted => {
                self.variables[event.variable].stale &= !event.mask;
                self.variables[event.variable].fresh |= event.mask;
            }
            // Of what is passed to a function and back, nothing is known.
            Kind::Copy { .. } => self.variables[event.variable].stale = 0,
            Kind::Declare | Kind::Write { .. } | Kind::Read { .. } | Kind::EndPrimitive | Kind::NoReturn { .. } => {}
        }
    }
}

/// Outputs that are set, emitted, and emitted again without being set on any path in between. `outputs`
/// tells which variables are outputs.
pub fn stale(graph: &Graph, outputs: impl Fn(SymbolId) -> bool + Copy) -> Vec<Stale> {
    let assigned = assign::solve(graph, false);
    let start = State { emitted: false, variables: vec![Since::default(); graph.variables.len()] };
    let mut states: Vec<Option<State>> = vec![None; graph.blocks.len()];
    states[0] = Some(start);
    let mut todo = VecDeque::from([0]);
    while let Some(at) = todo.pop_front() {
        let Some(mut state) = states[at].clone() else { continue };
        graph.blocks[at].events.iter().for_each(|e| state.step(e, graph));
        for edge in graph.blocks[at].next.iter().filter(|e| !e.weak) {
            let mut joined = state.clone();
            if let Some(old) = &states[edge.to] {
                joined.emitted |= old.emitted;
                for (a, b) in joined.variables.iter_mut().zip(&old.variables) {
                    *a = Since { stale: a.stale | b.stale, fresh: a.fresh | b.fresh };
                }
            }
            if states[edge.to].as_ref() != Some(&joined) {
                states[edge.to] = Some(joined);
                todo.push_back(edge.to);
            }
        }
    }
    let set = |variable: usize| {
        graph.events().find(|e| e.variable == variable && matches!(e.kind, Kind::Write { .. })).map(|e| e.span)
    };
    let mut found: BTreeMap<SymbolId, Stale> = BTreeMap::new();
    for (at, block) in graph.blocks.iter().enumerate() {
        let (Some(mut state), Some(mut known)) = (states[at].clone(), assigned[at].clone()) else { continue };
        for event in &block.events {
            if event.kind == Kind::Emit && state.emitted {
                for (index, since) in state.variables.iter().enumerate() {
                    let symbol = graph.variables[index].symbol;
                    if known[index].may & since.stale & !since.fresh == 0 || !outputs(symbol) {
                        continue;
                    }
                    let Some(set) = set(index) else { continue };
                    let new = Stale { symbol, emit: event.span, set };
                    let first = found.entry(symbol).or_insert(new);
                    if new.emit < first.emit {
                        *first = new;
                    }
                }
            }
            state.step(event, graph);
            assign::step(&mut known, event);
        }
    }
    for new in in_loops(graph, &assigned, outputs, set) {
        found.entry(new.symbol).or_insert(new);
    }
    found.into_values().collect()
}

/// Outputs that a loop emits and never sets, though they were set before it: an outer loop may set them again, and
/// still all rounds but the first go without.
fn in_loops(
    graph: &Graph,
    assigned: &assign::States,
    outputs: impl Fn(SymbolId) -> bool,
    set: impl Fn(usize) -> Option<Span>,
) -> Vec<Stale> {
    let mut found = Vec::new();
    for body in graph.loops() {
        let events = || body.iter().flat_map(|at| &graph.blocks[*at].events);
        let emit = body.iter().find_map(|at| {
            let event = graph.blocks[*at].events.iter().find(|e| e.kind == Kind::Emit)?;
            Some((event.span, assigned[*at].as_ref()?))
        });
        let Some((emit, known)) = emit else { continue };
        for (index, variable) in graph.variables.iter().enumerate() {
            let written = events().filter(|e| e.variable == index).fold(0, |mask, e| match e.kind {
                Kind::Write { .. } => mask | e.mask,
                Kind::Copy { .. } => variable.full,
                Kind::Declare | Kind::Read { .. } | Kind::Emit | Kind::EndPrimitive | Kind::NoReturn { .. } => mask,
            });
            if known[index].may & !written != 0 && outputs(variable.symbol) {
                found.extend(set(index).map(|set| Stale { symbol: variable.symbol, emit, set }));
            }
        }
    }
    found
}

/// The first `EmitVertex` that comes before `symbol` is set on any path, with whether it is set at all.
pub fn unset(graph: &Graph, symbol: Option<SymbolId>) -> Option<(Span, bool)> {
    let variable = symbol.and_then(|s| graph.variable(s));
    let states = assign::solve(graph, true);
    let mut first: Option<Span> = None;
    for (block, state) in graph.blocks.iter().zip(states) {
        let Some(mut state) = state else { continue };
        for event in &block.events {
            if event.kind == Kind::Emit && variable.is_none_or(|s| state[s].may == 0) {
                first = Some(first.map_or(event.span, |f| f.min(event.span)));
            }
            assign::step(&mut state, event);
        }
    }
    let set = variable.is_some_and(|s| graph.events().any(|e| e.variable == s && matches!(e.kind, Kind::Write { .. })));
    first.map(|span| (span, set))
}

/// Places where a strip ends with at least one vertex and, on every path, fewer than `needed`: the call of
/// `EndPrimitive`, or none at the end of `main`. With the largest number of vertices.
pub fn short(graph: &Graph, needed: u32) -> Vec<(Option<Span>, u32)> {
    let step = |count: u32, event: &Event| match event.kind {
        Kind::Emit => (count + 1).min(needed),
        Kind::EndPrimitive => 0,
        Kind::Declare | Kind::Read { .. } | Kind::Write { .. } | Kind::Copy { .. } | Kind::NoReturn { .. } => count,
    };
    let mut states: Vec<Option<u32>> = vec![None; graph.blocks.len()];
    states[0] = Some(0);
    let mut todo = VecDeque::from([0]);
    while let Some(at) = todo.pop_front() {
        let Some(start) = states[at] else { continue };
        let end = graph.blocks[at].events.iter().fold(start, step);
        for edge in &graph.blocks[at].next {
            if states[edge.to].is_none_or(|old| old < end) {
                states[edge.to] = Some(end);
                todo.push_back(edge.to);
            }
        }
    }
    let mut ends: BTreeMap<Option<Span>, u32> = BTreeMap::new();
    for (block, state) in graph.blocks.iter().zip(&states) {
        let Some(mut count) = *state else { continue };
        for event in &block.events {
            if event.kind == Kind::EndPrimitive {
                let most = ends.entry(Some(event.span)).or_default();
                *most = count.max(*most);
            }
            count = step(count, event);
        }
    }
    if let Some(count) = states[graph.exit] {
        ends.insert(None, graph.blocks[graph.exit].events.iter().fold(count, step));
    }
    ends.into_iter().filter(|(_, most)| (1..needed).contains(most)).collect()
}
