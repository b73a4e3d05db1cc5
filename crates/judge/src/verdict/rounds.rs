//! How many rounds the loops of samples go through, found out in a cheap domain before dear ones see them.
//!
//! All slots of a chunk pay for its longest loop. Samples are therefore run with little fuel first, those that are not
//! through are gathered and get more, and the last and most expensive step is taken for a part of a batch alone. What a
//! batch costs is bounded so, whatever its inputs are.

use rayon::prelude::*;

use base::value::Batch;
use program::interp::{Domain, Executable, HazardKind, Machine, SLOTS};
use program::lane::interrupt;

/// Rounds after which a loop counts as one that does not end: far above what shaders need.
pub const ENDLESS: u32 = 1 << 13;

/// What each step finds, the rounds that a sample may go through in it, and the part of a batch that it is taken for.
const STEPS: [(Rounds, u32, usize); 3] =
    [(Rounds::Few, 1 << 7, 1), (Rounds::Some, 1 << 10, 1), (Rounds::Many, ENDLESS, 8)];

/// How many rounds a sample goes through, fewest first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rounds {
    /// At most 128.
    #[default]
    Few,
    /// At most 1024.
    Some,
    /// At most [`ENDLESS`].
    Many,
    /// More than [`ENDLESS`].
    Endless,
    /// More than 1024; too many samples of the batch are like that to follow them all, or the run was interrupted.
    Unknown,
}

impl Rounds {
    /// True when the loops of the sample are known to end.
    pub fn end(self) -> bool {
        self <= Self::Many
    }

    /// How long each sample of a batch goes on in a domain. Samples without loops have few rounds.
    pub fn of<D: Domain + Default>(executable: &Executable, batch: &Batch) -> Vec<Self> {
        let count = batch.invocation_count();
        if !executable.has_loops() {
            return vec![Self::Few; count];
        }
        let mut all = vec![Self::Unknown; count];
        let mut open: Vec<usize> = (0..count).collect();
        for (step, fuel, part) in STEPS {
            open.truncate((count / part).max(SLOTS));
            let make = || Machine::new(executable, D::default(), fuel);
            let found: Vec<Vec<Option<Self>>> = open
                .par_chunks(SLOTS)
                .map_init(make, |machine, some| {
                    if interrupt::asked() {
                        return vec![Some(Self::Unknown); some.len()];
                    }
                    let slots = machine.run_some(batch, some);
                    machine.take_findings();
                    let rounds = machine.flags()[..slots].iter().map(|flags| match flags.is_stopped() {
                        false => Some(step),
                        true if flags.has(HazardKind::GivenUp) => Some(Self::Unknown),
                        true => None,
                    });
                    rounds.collect()
                })
                .collect();
            let mut rest = Vec::new();
            for (invocation, found) in open.into_iter().zip(found.into_iter().flatten()) {
                match found {
                    Some(rounds) => all[invocation] = rounds,
                    None => rest.push(invocation),
                }
            }
            open = rest;
        }
        open.into_iter().for_each(|invocation| all[invocation] = Self::Endless);
        all
    }

    /// The samples that end, in the order of their rounds: those that go on for long share chunks.
    pub fn order(all: &[Self]) -> Vec<usize> {
        let mut order: Vec<usize> = (0..all.len()).filter(|&k| all[k].end()).collect();
        order.sort_by_key(|&k| all[k]);
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;
    use base::value::{Field, Record, Shape};
    use program::Program;
    use program::interp::{self, Binary64};
    use program::lower::Target;
    use std::sync::Arc;
    use syntax::{Shader, Stage};

    fn rounds(body: &str, inputs: &[i32]) -> Vec<Rounds> {
        let text = format!("#version 450 core\nfloat f(int n) {{ float a = 0.0; {body} return a; }}\n");
        let parsed = Shader::parse(&SourceFile::new("f.glsl", text), Stage::Library);
        let program = Program::build(&parsed.shader, &Target::Function("f".into())).unwrap();
        let field = |name: &str, shape| Field { name: name.into(), shape };
        let record = Arc::new(Record::new(vec![field("n", Shape::INT)]));
        let mut batch = Batch::with_capacity(record, Arc::new(Record::new(Vec::new())), 1, inputs.len());
        batch.invocations.extend(inputs.iter().map(|n| n.cast_unsigned()));
        Rounds::of::<Binary64>(&interp::compile(&program).unwrap(), &batch)
    }

    #[test]
    fn samples_are_told_apart_by_their_rounds() {
        let found = rounds("for (int i = 0; i < n; ++i) a += 1.0;", &[3, 500, 5000, i32::MAX, -1]);
        assert_eq!(found, [Rounds::Few, Rounds::Some, Rounds::Many, Rounds::Endless, Rounds::Few]);
        assert_eq!(Rounds::order(&found), [0, 4, 1, 2]);
    }

    #[test]
    fn of_many_endless_samples_some_are_followed_and_none_passes() {
        let found = rounds("for (int i = 0; i < n; ++i) a += 1.0;", &[i32::MAX; 2 * SLOTS]);
        assert!(found[..SLOTS].iter().all(|rounds| *rounds == Rounds::Endless));
        assert!(found[SLOTS..].iter().all(|rounds| *rounds == Rounds::Unknown));
        assert!(Rounds::order(&found).is_empty());
    }

    #[test]
    fn a_program_without_loops_is_not_run() {
        assert_eq!(rounds("a = float(n);", &[i32::MAX; 3]), [Rounds::Few; 3]);
    }
}
