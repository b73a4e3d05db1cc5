//! What is known at a point of a function.

use std::collections::{BTreeMap, BTreeSet};

use syntax::symbols::SymbolId;

use super::key::{Key, Keys};
use super::value::{Range, Sources, Value};

/// What is known at a point of a function.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Values of variables that were written; others have the value they begin with.
    pub vars: BTreeMap<SymbolId, Value>,
    /// Ranges that conditions on the way gave to scalar expressions, by their spelling.
    pub facts: BTreeMap<Key, Range>,
    /// What the conditions on the way depend on: values that depend on it too may be narrower than
    /// their ranges say.
    pub path: Sources,
    /// The part of `path` that stays after the branches meet again, because some of them ended.
    pub ended: Sources,
    /// True behind a `return`, `discard`, `break` or `continue`.
    pub dead: bool,
}

impl State {
    /// Forgets what conditions said about a variable.
    pub fn forget(&mut self, symbol: SymbolId, keys: &Keys) {
        self.facts.retain(|key, _| !keys.mentions(*key, symbol));
    }

    /// Drops the variables of a function that came back: no one reads them any more.
    pub fn leave(&mut self, locals: &BTreeSet<SymbolId>, keys: &Keys) {
        self.vars.retain(|symbol, _| !locals.contains(symbol));
        self.facts.retain(|key, _| !keys.mentions_any(*key, locals));
    }

    /// What holds after one of two branches; `before` is the path in front of them, and `on` what
    /// decides between them.
    pub fn meet(self, other: Self, before: Sources, on: Sources, begin: impl Fn(SymbolId) -> Value) -> Self {
        let ended = self.ended.and(other.ended);
        let (mut one, other) = match (self.dead, other.dead) {
            (false, false) => (self, other),
            (true, true) => return Self { ended, dead: true, ..self },
            (true, false) => return other.survive(ended.and(on), before),
            (false, true) => return self.survive(ended.and(on), before),
        };
        let mut symbols: Vec<SymbolId> = one.vars.keys().chain(other.vars.keys()).copied().collect();
        symbols.sort_unstable();
        symbols.dedup();
        for symbol in symbols {
            let ours = one.vars.remove(&symbol).unwrap_or_else(|| begin(symbol));
            let theirs = other.vars.get(&symbol).cloned().unwrap_or_else(|| begin(symbol));
            let joined = if ours == theirs { ours } else { ours.join(&theirs).depending(on) };
            one.vars.insert(symbol, joined);
        }
        let theirs = other.facts;
        one.facts.retain(|key, range| theirs.get(key) == Some(range));
        one.ended = ended;
        one.path = before.and(ended);
        one
    }

    fn survive(mut self, ended: Sources, before: Sources) -> Self {
        self.ended = ended;
        self.path = before.and(ended);
        self
    }
}

/// Keeps what may hold in either of two states, where one may be absent.
pub fn meet_into(slot: &mut Option<State>, state: State, begin: impl Fn(SymbolId) -> Value) {
    *slot = Some(match slot.take() {
        None => state,
        Some(before) => {
            let path = before.path.and(state.path);
            // Which way was taken depends on the conditions of both.
            before.meet(state, path, path, begin)
        }
    });
}
