//! The domains of suites as proptest strategies.

use std::fmt;
use std::sync::Arc;

use proptest::prelude::any;
use proptest::strategy::{NewTree, Strategy, ValueTree};
use proptest::test_runner::TestRunner;

use super::Sample;
use super::plan::Plan;
use super::shrink::{Domain, Moves, simpler_than};

/// Samples of a plan, for tests written with proptest. A failing sample is shrunk inside its domain
/// by the same moves as in [`super::shrink::shrink`], one at a time.
///
/// proptest's own cap, `max_shrink_iters`, should be raised to some ten thousand for plans with many
/// words.
#[derive(Clone)]
pub struct CaseStrategy {
    plan: Arc<Plan>,
}

/// Invocations of a case that samples are taken from: strands show their later nodes too.
const INVOCATIONS: u64 = 16;

impl CaseStrategy {
    /// Samples of this plan.
    pub fn new(plan: Arc<Plan>) -> Self {
        Self { plan }
    }
}

impl fmt::Debug for CaseStrategy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fields = self.plan.case_record().fields().iter().chain(self.plan.invocation_record().fields());
        f.debug_tuple("CaseStrategy").field(&fields.map(|f| &f.name).collect::<Vec<_>>()).finish()
    }
}

impl Strategy for CaseStrategy {
    type Tree = CaseTree;
    type Value = Sample;

    fn new_tree(&self, runner: &mut TestRunner) -> NewTree<Self> {
        let seed = any::<u64>().new_tree(runner)?.current();
        let invocation = (seed % INVOCATIONS) as usize;
        let sample = self.plan.sample(seed, 0, invocation);
        let moves = Moves::new(&sample, self.plan.groups());
        let plainest = self.plan.simplest(&sample);
        Ok(CaseTree { plan: self.plan.clone(), moves, plainest, best: sample, candidate: None, at: 0, idle: 0 })
    }
}

/// A sample on its way to a simpler one.
///
/// The moves form a ring. The search goes on behind the last move that worked, and ends when a whole
/// turn brought nothing.
#[derive(Clone, Debug)]
pub struct CaseTree {
    plan: Arc<Plan>,
    moves: Moves,
    /// The plainest sample of the plan.
    plainest: Sample,
    /// The simplest sample known to fail (at first: the sample itself).
    best: Sample,
    /// What is being tried.
    candidate: Option<Sample>,
    /// The next move.
    at: usize,
    /// Moves since the last one that worked.
    idle: usize,
}

impl CaseTree {
    /// Puts the next candidate up; false when a whole turn brought none.
    fn advance(&mut self) -> bool {
        while self.idle < self.moves.len() {
            let chosen = self.moves.at(self.at);
            self.at = (self.at + 1) % self.moves.len();
            self.idle += 1;
            let candidate = self.moves.apply(chosen, &self.best, &self.plainest, &*self.plan);
            if let Some(candidate) =
                candidate.filter(|c| simpler_than(c, &self.best, &self.plainest) && self.plan.admits(c))
            {
                self.candidate = Some(candidate);
                return true;
            }
        }
        self.candidate = None;
        false
    }
}

impl ValueTree for CaseTree {
    type Value = Sample;

    fn current(&self) -> Sample {
        self.candidate.as_ref().unwrap_or(&self.best).clone()
    }

    /// The current sample fails: go on from it.
    fn simplify(&mut self) -> bool {
        if let Some(candidate) = self.candidate.take() {
            self.best = candidate;
            self.idle = 0;
        }
        self.advance()
    }

    /// The current sample does not fail: try the next candidate, or end at the best.
    fn complicate(&mut self) -> bool {
        self.candidate.is_some() && self.advance()
    }
}

#[cfg(test)]
mod tests;
