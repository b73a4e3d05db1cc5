//! Invocations whose behaviour the language leaves undefined, kept away from executors: a crash at an index outside of
//! its array is the shader's fault, and so is what a store there does to other invocations.
//!
//! Copies of other invocations take their places, so that each of the rest keeps its own.

use std::collections::HashSet;

use super::oracle::Oracle;
use super::parallel::parts;
use base::value::Batch;
use program::OutputLayout;
use program::interp::{Binary64, Dependence, Machine, SLOTS, Site, Undefined};
use program::lane::{Actual, LaneError, Runner};
use property::Sample;

/// A runner that leaves invocations out that store outside of an array, and from the first time on that the executor
/// fails outright at one, all that come upon anything undefined.
///
/// It never hides a failure: where the executor fails without them as well, that is the error.
pub struct Fence<'a> {
    runner: Box<dyn Runner + 'a>,
    oracle: &'a Oracle,
    layout: OutputLayout,
    stores: HashSet<Site>,
    found: Option<Fenced>,
}

/// A failure at an invocation whose behaviour is undefined.
#[derive(Clone, Debug)]
pub struct Fenced {
    /// How the executor failed.
    pub error: LaneError,
    /// The inputs of the invocation.
    pub sample: Sample,
    /// What is undefined there.
    pub because: Dependence,
}

impl<'a> Fence<'a> {
    /// A fence in front of a runner of a kernel of this program with outputs of this layout.
    pub fn new(runner: Box<dyn Runner + 'a>, oracle: &'a Oracle, layout: &OutputLayout) -> Self {
        let stores = oracle.executable().stray_stores();
        Self { runner, oracle, layout: layout.clone(), stores, found: None }
    }

    /// The failure since which undefined invocations are left out.
    pub fn found(&self) -> Option<&Fenced> {
        self.found.as_ref()
    }

    /// Runs what is defined of a batch. Copies of its other invocations stand in for the rest, so that each keeps its place.
    fn without(&mut self, batch: &Batch, undefined: &[Option<Dependence>]) -> Result<Actual, LaneError> {
        let absent: Vec<usize> = (0..undefined.len()).filter(|&k| undefined[k].is_some()).collect();
        let Some(kept) = undefined.iter().position(Option::is_none) else {
            return Ok(Actual::none(&self.layout, absent.len()));
        };
        if absent.is_empty() {
            return self.runner.run(batch);
        }
        Ok(self.runner.run(&with_copies(batch, &absent, kept))?.without(absent))
    }
}

/// A batch in which copies stand at some indices: of an invocation with the same uniforms, or where these have none,
/// of the one at `kept` with its uniforms.
fn with_copies(batch: &Batch, absent: &[usize], kept: usize) -> Batch {
    let (words, case_words) = (batch.invocation_record.words(), batch.case_record.words());
    let mut copied = batch.clone();
    let mut copy = |from: usize, to: usize| {
        copied.invocations[to * words..][..words].copy_from_slice(batch.invocation(from));
    };
    let mut cases = Vec::new();
    for group in absent.chunk_by(|a, b| a / batch.per_case == b / batch.per_case) {
        let case = group[0] / batch.per_case;
        let all = case * batch.per_case..((case + 1) * batch.per_case).min(batch.invocation_count());
        let beside = all.clone().find(|k| group.binary_search(k).is_err());
        if beside.is_none() {
            cases.push(case);
        }
        group.iter().for_each(|&to| copy(beside.unwrap_or(kept), to));
    }
    for case in cases {
        copied.cases[case * case_words..][..case_words].copy_from_slice(batch.case_of(kept));
    }
    copied
}

impl Runner for Fence<'_> {
    fn capacity(&self) -> usize {
        self.runner.capacity()
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        if self.found.is_some() {
            return self.without(batch, &undefined(self.oracle, batch, &|_| true));
        }
        let first = if self.stores.is_empty() {
            self.runner.run(batch)
        } else {
            let stray = undefined(self.oracle, batch, &|of| of.strays(&self.stores));
            self.without(batch, &stray)
        };
        match first {
            Err(error) if error.is_failure() => {
                let undefined = undefined(self.oracle, batch, &|_| true);
                // The one that is named, or where none is or a neighbour brought it down, the first.
                let named = error.invocation().filter(|&at| undefined.get(at).is_some_and(Option::is_some));
                let at = named.or_else(|| undefined.iter().position(Option::is_some));
                let Some((at, because)) = at.and_then(|at| Some((at, undefined[at].clone()?))) else {
                    return Err(error);
                };
                let actual = self.without(batch, &undefined)?;
                self.found = Some(Fenced { error, sample: Sample::of(batch, at), because });
                Ok(actual)
            }
            other => other,
        }
    }
}

/// For each invocation, what is undefined on its way, of all that counts.
fn undefined(oracle: &Oracle, batch: &Batch, counts: &(dyn Fn(&Undefined) -> bool + Sync)) -> Vec<Option<Dependence>> {
    let all: Vec<usize> = (0..batch.invocation_count()).collect();
    let chunks: Vec<&[usize]> = all.chunks(SLOTS).collect();
    let of = |machine: &mut Machine<'_, Binary64>, k: usize| machine.undefined_on_the_way(batch, chunks[k], counts);
    parts(chunks.len(), || oracle.ideal_or_meaning(), of).concat()
}
