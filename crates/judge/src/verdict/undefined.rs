//! Samples with an output that depends on a value that the language leaves undefined. They say something about the
//! shader, and nothing about a lane.

use std::collections::HashMap;

use super::judge::{Doubt, Reason, Verdict};
use super::oracle::{JudgeContext, Oracle};
use super::reference::{Evaluator, Expected};
use crate::tape::{Cause, Why};
use base::value::Batch;
use program::interp::{Binary64, Dependence, Machine, SLOTS, Site};

/// Looks for them. The machine is made when it is first needed.
pub(super) struct Looker<'a> {
    oracle: &'a Oracle,
    machine: Option<Machine<'a, Binary64>>,
}

/// What an invocation depends on, by its index in the batch.
pub(super) type Dependences = HashMap<usize, Dependence>;

impl<'a> Looker<'a> {
    pub(super) fn new(oracle: &'a Oracle) -> Self {
        Self { oracle, machine: None }
    }

    /// Which of some invocations depend on an undefined value. `any` tries NaN and infinity in its place as well.
    pub(super) fn look(&mut self, batch: &Batch, invocations: &[usize], any: bool) -> Dependences {
        let oracle = self.oracle;
        let mut all = Dependences::new();
        for some in invocations.chunks(SLOTS) {
            let machine = self.machine.get_or_insert_with(|| oracle.ideal_or_meaning());
            let found = machine.dependences(batch, some, any);
            all.extend(some.iter().zip(found).filter_map(|(&invocation, found)| Some((invocation, found?))));
        }
        all
    }

    /// What is undefined in some invocations, whether or not an output depends on it.
    pub(super) fn on_the_way(&mut self, batch: &Batch, invocations: &[usize]) -> Dependences {
        let oracle = self.oracle;
        let mut all = Dependences::new();
        for some in invocations.chunks(SLOTS) {
            let machine = self.machine.get_or_insert_with(|| oracle.ideal_or_meaning());
            let found = machine.undefined_on_the_way(batch, some, &|_| true);
            all.extend(some.iter().zip(found).filter_map(|(&invocation, found)| Some((invocation, found?))));
        }
        all
    }
}

/// Verdicts on samples that depend on undefined values, which have no say about the lane. Where nothing is expected
/// the author knows that there is no value.
pub(super) fn verdicts(context: &JudgeContext<'_>, batch: &Batch, found: &Dependences) -> Vec<(usize, Verdict)> {
    let mut invocations: Vec<usize> = found.keys().copied().collect();
    invocations.sort_unstable();
    let (mut evaluator, mut expected) = (Evaluator::new(context.reference), Expected::default());
    let mut all = Vec::with_capacity(invocations.len());
    for some in invocations.chunks(SLOTS) {
        evaluator.turn_to(batch, some);
        for (slot, &invocation) in some.iter().enumerate() {
            evaluator.expected(batch, invocation, slot, &mut expected);
            let none = expected.words.iter().any(|word| word.is_nan());
            let reason = if none { Reason::Domain } else { Reason::Undefined };
            let cause = found.get(&invocation).map(|found| at(found.of.site));
            all.push((invocation, Verdict::Undetermined(Doubt { reason, cause })));
        }
    }
    all
}

fn at(site: Site) -> Cause {
    Cause { why: Why::Domain, op: None, site: Some(site), args: Vec::new(), value: f64::NAN }
}

/// For each invocation of a small batch, the undefined value that an output depends on.
pub fn dependences(oracle: &Oracle, batch: &Batch) -> Vec<Option<Dependence>> {
    let all: Vec<usize> = (0..batch.invocation_count()).collect();
    let mut found = Looker::new(oracle).look(batch, &all, false);
    all.into_iter().map(|invocation| found.remove(&invocation)).collect()
}
