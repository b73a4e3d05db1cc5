//! The paths through a function and the functions it calls, as blocks of events.

use std::collections::BTreeSet;

use base::text::Span;
use syntax::ast::ExprId;
use syntax::symbols::{FunctionId, SymbolId};

/// Paths through a function. Called functions are part of it, once for each call.
#[derive(Clone, Debug)]
pub struct Graph {
    /// The blocks; the first one is entered.
    pub blocks: Vec<Block>,
    /// The block behind a normal return.
    pub exit: usize,
    /// The variables that are followed.
    pub variables: Vec<Variable>,
    /// The functions whose bodies are part of it, the root included.
    pub functions: Vec<FunctionId>,
}

/// Events that happen one after the other.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// The events.
    pub events: Vec<Event>,
    /// Where the paths go on; none where an invocation ends.
    pub next: Vec<Edge>,
}

/// The way from a block to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The block it leads to.
    pub to: usize,
    /// True when it is often never taken, for reasons that the text does not show: a loop without a
    /// round, a missing last `else` of a chain, a value that a `switch` has no label for.
    pub weak: bool,
}

/// A variable in one copy of its function.
#[derive(Clone, Copy, Debug)]
pub struct Variable {
    /// The variable.
    pub symbol: SymbolId,
    /// All of its components.
    pub full: u64,
    /// Loops around its declaration.
    pub loops: u32,
}

/// Something that happens.
#[derive(Clone, Copy, Debug)]
pub struct Event {
    /// What happens.
    pub kind: Kind,
    /// To which variable.
    pub variable: usize,
    /// To which components.
    pub mask: u64,
    /// Place in the text.
    pub span: Span,
    /// The expression, if it is one.
    pub expr: Option<ExprId>,
}

/// What happens to a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It begins to exist, without a value.
    Declare,
    /// Its value is used.
    Read {
        /// True when each of the components is needed; false when some of them may be enough.
        all: bool,
        /// True when the value makes the next value of the same variable, in a loop.
        accumulates: bool,
    },
    /// It gets a value.
    Write {
        /// True when all components of the mask get one.
        exact: bool,
        /// Whether an assignment, an initialiser or a call stores it.
        store: Store,
    },
    /// It becomes a copy of another variable.
    Copy {
        /// The other one.
        from: usize,
    },
    /// `EmitVertex`; no variable.
    Emit,
    /// `EndPrimitive`; no variable.
    EndPrimitive,
    /// The end of a body that should have returned a value; no variable.
    NoReturn {
        /// True in the body of the root.
        root: bool,
    },
}

/// How a variable gets a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Store {
    /// By `=`, `+=` and so on, `++` or `--`.
    Assigned,
    /// By its initialiser.
    Initial,
    /// As a parameter, from a call, or before the function begins.
    Passed,
}

impl Graph {
    /// The blocks of each loop that paths go round in.
    pub fn loops(&self) -> Vec<BTreeSet<usize>> {
        let mut found = Vec::new();
        for (from, to) in self.back_edges() {
            let mut body = BTreeSet::from([to]);
            let mut todo = vec![from];
            while let Some(at) = todo.pop() {
                if body.insert(at) {
                    let before = self.blocks.iter().enumerate().filter(|(_, b)| b.next.iter().any(|e| e.to == at));
                    todo.extend(before.map(|(i, _)| i));
                }
            }
            found.push(body);
        }
        found
    }

    /// Edges that lead back to a block on the way to them.
    fn back_edges(&self) -> Vec<(usize, usize)> {
        let mut found = Vec::new();
        let mut seen = vec![false; self.blocks.len()];
        // The way to the current block, with the number of edges that were taken from each.
        let mut way: Vec<(usize, usize)> = vec![(0, 0)];
        while let Some((at, taken)) = way.last_mut() {
            let (block, next) = (*at, self.blocks[*at].next.get(*taken).map(|e| e.to));
            seen[block] = true;
            *taken += 1;
            match next {
                None => {
                    way.pop();
                }
                Some(to) if way.iter().any(|(b, _)| *b == to) => found.push((block, to)),
                Some(to) if !seen[to] => way.push((to, 0)),
                Some(_) => {}
            }
        }
        found
    }

    /// Blocks that a path leads to, over weak edges or not.
    pub fn reached(&self, weak: bool) -> Vec<bool> {
        let mut seen = vec![false; self.blocks.len()];
        let mut todo = vec![0];
        while let Some(at) = todo.pop() {
            if std::mem::replace(&mut seen[at], true) {
                continue;
            }
            todo.extend(self.blocks[at].next.iter().filter(|e| weak || !e.weak).map(|e| e.to));
        }
        seen
    }

    /// For each block the blocks before it.
    pub fn before(&self) -> Vec<Vec<usize>> {
        let mut before = vec![Vec::new(); self.blocks.len()];
        for (at, block) in self.blocks.iter().enumerate() {
            block.next.iter().for_each(|e| before[e.to].push(at));
        }
        before
    }

    /// All events in blocks that are reached.
    pub fn events(&self) -> impl Iterator<Item = &Event> {
        let reached = self.reached(true);
        self.blocks.iter().enumerate().filter(move |(i, _)| reached[*i]).flat_map(|(_, b)| &b.events)
    }

    /// The variable of a variable that exists once: a global one, or one of the root.
    pub fn variable(&self, symbol: SymbolId) -> Option<usize> {
        self.variables.iter().position(|s| s.symbol == symbol)
    }

    /// For each block the blocks that every path to it passes, as bits; itself included. `entries` are
    /// where paths begin, `before` gives the blocks before each.
    pub fn dominators(entries: &[usize], before: &[Vec<usize>]) -> Vec<Bits> {
        let n = before.len();
        let mut all: Vec<Bits> = (0..n).map(|_| Bits::all(n)).collect();
        for &entry in entries {
            all[entry] = Bits::none(n);
            all[entry].set(entry);
        }
        loop {
            let mut changed = false;
            for at in 0..n {
                if entries.contains(&at) {
                    continue;
                }
                let mut bits = Bits::all(n);
                before[at].iter().for_each(|&b| bits.and(&all[b]));
                bits.set(at);
                if bits != all[at] {
                    all[at] = bits;
                    changed = true;
                }
            }
            if !changed {
                return all;
            }
        }
    }
}

/// A set of blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bits(Vec<u64>);

impl Bits {
    fn all(n: usize) -> Self {
        Self(vec![u64::MAX; n.div_ceil(64)])
    }

    fn none(n: usize) -> Self {
        Self(vec![0; n.div_ceil(64)])
    }

    fn set(&mut self, at: usize) {
        self.0[at / 64] |= 1 << (at % 64);
    }

    fn and(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(a, b)| *a &= b);
    }

    /// True when the block is in the set.
    pub fn has(&self, at: usize) -> bool {
        self.0[at / 64] >> (at % 64) & 1 == 1
    }
}
