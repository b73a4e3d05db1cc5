//! Definite assignment: which components surely have a value, and which may have one.

use std::cell::LazyCell;
use std::collections::{BTreeMap, VecDeque};

use base::text::Span;
use syntax::Shader;
use syntax::ast::ExprId;
use syntax::symbols::SymbolId;

use super::graph::{Event, Graph, Kind};

/// Components of a variable that have a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Assigned {
    /// On all paths.
    pub must: u64,
    /// On some path.
    pub may: u64,
}

/// What is assigned at the start of each block; none where no path leads to.
pub type States = Vec<Option<Vec<Assigned>>>;

/// What is assigned at the start of each block, with or without weak edges.
pub fn solve(graph: &Graph, weak: bool) -> States {
    let mut states: States = vec![None; graph.blocks.len()];
    states[0] = Some(vec![Assigned::default(); graph.variables.len()]);
    let mut todo = VecDeque::from([0]);
    while let Some(at) = todo.pop_front() {
        let Some(mut state) = states[at].clone() else { continue };
        graph.blocks[at].events.iter().for_each(|e| step(&mut state, e));
        for edge in graph.blocks[at].next.iter().filter(|e| weak || !e.weak) {
            let joined = match &states[edge.to] {
                None => state.clone(),
                Some(old) => old
                    .iter()
                    .zip(&state)
                    .map(|(a, b)| Assigned { must: a.must & b.must, may: a.may | b.may })
                    .collect(),
            };
            if states[edge.to].as_ref() != Some(&joined) {
                states[edge.to] = Some(joined);
                if !todo.contains(&edge.to) {
                    todo.push_back(edge.to);
                }
            }
        }
    }
    states
}

/// What an event does.
pub fn step(state: &mut [Assigned], event: &Event) {
    match event.kind {
        Kind::Declare => state[event.variable] = Assigned::default(),
        Kind::Write { .. } => {
            state[event.variable].must |= event.mask;
            state[event.variable].may |= event.mask;
        }
        Kind::Copy { from } => state[event.variable] = state[from],
        Kind::Read { .. } | Kind::Emit | Kind::EndPrimitive | Kind::NoReturn { .. } => {}
    }
}

/// How sure it is that a variable without a value is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    /// The first time that the place is reached.
    Always,
    /// On one of the paths on which the variable exists: each of them leads to the place.
    SomePath,
    /// On a path that may not exist.
    Perhaps,
}

/// A read of components without a value.
#[derive(Clone, Copy, Debug)]
pub struct Unassigned {
    /// The variable.
    pub symbol: SymbolId,
    /// The components without a value.
    pub mask: u64,
    /// The read.
    pub expr: ExprId,
    /// Its place.
    pub span: Span,
    /// How sure that is.
    pub certainty: Certainty,
    /// True when the value makes the next value of the same variable, in a loop.
    pub accumulates: bool,
}

/// The reads of variables without a value: the surest and first of each variable.
pub fn unassigned(shader: &Shader, graph: &Graph) -> Vec<Unassigned> {
    let all = solve(graph, true);
    let likely = solve(graph, false);
    // Most shaders read nothing that has no value.
    let dominators = LazyCell::new(|| Graph::dominators(&[0], &graph.before()));
    let after = || graph.blocks.iter().map(|b| b.next.iter().map(|e| e.to).collect()).collect::<Vec<Vec<usize>>>();
    let followed = LazyCell::new(|| Graph::dominators(&[graph.exit], &after()));
    let mut found: BTreeMap<SymbolId, Unassigned> = BTreeMap::new();
    for (at, block) in graph.blocks.iter().enumerate() {
        let Some(mut state) = all[at].clone() else { continue };
        let mut likely = likely[at].clone();
        for (index, event) in block.events.iter().enumerate() {
            if let (Kind::Read { all, accumulates }, Some(expr)) = (event.kind, event.expr) {
                let missing = |a: &Assigned| if all || a.must & event.mask == 0 { event.mask & !a.must } else { 0 };
                let mask = missing(&state[event.variable]);
                if mask != 0 {
                    let written = state[event.variable].may & event.mask;
                    let never = if all {
                        mask & !written
                    } else if written == 0 {
                        mask
                    } else {
                        0
                    };
                    let certainty = if never != 0 || comes_first(graph, &dominators, at, index, event.variable, mask) {
                        Certainty::Always
                    } else if likely.as_ref().is_some_and(|l| missing(&l[event.variable]) != 0)
                        && declared(graph, &dominators, event.variable, at).is_some_and(|d| followed[d].has(at))
                    {
                        Certainty::SomePath
                    } else {
                        Certainty::Perhaps
                    };
                    let mask = if never == 0 { mask } else { never };
                    let symbol = graph.variables[event.variable].symbol;
                    let read = Unassigned { symbol, mask, expr, span: event.span, certainty, accumulates };
                    let key = |u: &Unassigned| (u.certainty, u.span, u.expr);
                    let best = found.entry(symbol).or_insert(read);
                    if key(&read) < key(best) {
                        *best = read;
                    }
                }
            }
            step(&mut state, event);
            if let Some(likely) = &mut likely {
                step(likely, event);
            }
        }
    }
    let mut found: Vec<Unassigned> = found.into_values().collect();
    found.sort_by_key(|u| (u.span, shader.symbol(u.symbol).span));
    found
}

/// True when the event at `index` of the block `at` comes before every write of these components.
fn comes_first(
    graph: &Graph,
    dominators: &[super::graph::Bits],
    at: usize,
    index: usize,
    variable: usize,
    mask: u64,
) -> bool {
    graph.blocks.iter().enumerate().all(|(other, block)| {
        block.events.iter().enumerate().all(|(i, event)| {
            let writes = match event.kind {
                Kind::Write { .. } => event.variable == variable && event.mask & mask != 0,
                Kind::Copy { .. } => event.variable == variable,
                Kind::Declare | Kind::Read { .. } | Kind::Emit | Kind::EndPrimitive | Kind::NoReturn { .. } => false,
            };
            !writes || if other == at { index < i } else { dominators[other].has(at) }
        })
    })
}

/// The last block on every path to `at` in which a variable is declared.
fn declared(graph: &Graph, dominators: &[super::graph::Bits], variable: usize, at: usize) -> Option<usize> {
    let declares =
        |b: &usize| graph.blocks[*b].events.iter().any(|e| e.variable == variable && e.kind == Kind::Declare);
    let mut above = (0..graph.blocks.len()).filter(|b| dominators[at].has(*b)).filter(declares);
    let first = above.next()?;
    above.next().is_none().then_some(first)
}
