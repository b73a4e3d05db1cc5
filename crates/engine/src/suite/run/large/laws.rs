//! Relations between large dispatches: of what the shader means, and of the lane's values.
//!
//! A word may be off by the radius that goes with it through memory. Nothing is shrunk.

use super::super::finding::{self, Finding, FindingKind};
use super::super::part::Part;
use super::super::relate::{self, Outcome};
use super::super::{Prepared, Request};
use judge::verdict::{JudgeContext, Passes, meaning_whole, observe_whole};
use lanes::{LaneError, Runner, interrupt};
use program::interp::InterpError;
use property::{Claim, Observed, Relation, Sample};
use rayon::prelude::*;

/// What relations are checked with.
pub(super) struct Laws<'a> {
    pub prepared: &'a Prepared,
    pub context: JudgeContext<'a>,
    pub runner: &'a mut dyn Runner,
}

/// Gives the outputs of one of the inputs of a relation, by its number.
type See<'s> = dyn Fn(&Passes<'_>, usize) -> Result<Observed, InterpError> + Sync + 's;

/// A relation that does not hold.
struct Broken {
    /// Number of the sample.
    number: usize,
    /// Whose values break it.
    of: &'static str,
    claim: Claim,
}

impl Laws<'_> {
    /// Checks every relation of the suite on some samples.
    ///
    /// # Errors
    /// [`LaneError`] when the lane fails.
    pub(super) fn check(&mut self, samples: &[Sample], request: &Request, part: &mut Part) -> Result<(), LaneError> {
        for relation in &self.prepared.relations {
            let relation = &**relation;
            let (mut checked, mut count, mut first) = (0, 0, None);
            for (number, sample) in samples.iter().enumerate() {
                let seen = self.outcome(relation, sample)?;
                // What was cut short says nothing.
                if interrupt::asked() {
                    return Ok(());
                }
                let Some((outcome, of)) = seen else { continue };
                checked += 1;
                match outcome {
                    Outcome::Fails(claim) => {
                        count += 1;
                        first.get_or_insert(Broken { number, of, claim });
                    }
                    Outcome::HoldsAsMeant => part.reread += 1,
                    Outcome::Holds | Outcome::Silent => {}
                }
            }
            part.relations.push((relation.name().to_owned(), checked));
            if checked == 0 && !request.replay_only {
                part.findings.push(relate::vacuous(relation, samples.len()));
            }
            if let Some(Broken { number, of, claim }) = first {
                part.findings.push(Finding {
                    kind: FindingKind::Relation,
                    message: format!("{}, {of}, in sample {number}", relate::broken(relation, &claim)),
                    case: None,
                    count,
                    reproduce: Some(finding::rerun(request, part)),
                });
            }
        }
        Ok(())
    }

    /// What a relation says of a sample, and of whose values; `None` where it says nothing.
    fn outcome(
        &mut self,
        relation: &dyn Relation,
        sample: &Sample,
    ) -> Result<Option<(Outcome, &'static str)>, LaneError> {
        let inputs = relation.inputs(sample);
        if inputs.is_empty() {
            return Ok(None);
        }
        // One after the other on the lane: each has buffers of its own.
        let batches: Vec<_> = inputs.iter().map(|input| Sample::batch(std::slice::from_ref(input))).collect();
        let passes: Vec<_> = batches.iter().map(|batch| Passes::new(self.context, batch)).collect();
        let mut ran = Vec::with_capacity(batches.len());
        // While the lane runs, the interpreter goes through them. An error is told where the result is asked for.
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| passes.par_iter().for_each(|passes| drop(meaning_whole(passes))));
            ran.extend(batches.iter().map(|batch| self.runner.run(batch)));
        });
        let meant = self.read(relation, &inputs, &passes, &|passes, _| meaning_whole(passes))?;
        if matches!(meant, Outcome::Fails(_)) {
            return Ok(Some((meant, "in what the shader means")));
        }
        let actual = ran.into_iter().collect::<Result<Vec<_>, _>>()?;
        let seen = self.read(relation, &inputs, &passes, &|passes, input| observe_whole(passes, &actual[input]))?;
        Ok(match (meant, seen) {
            (Outcome::Silent, Outcome::Silent) => None,
            (meant, Outcome::Silent) => Some((meant, "")),
            (Outcome::HoldsAsMeant, Outcome::Holds) => Some((Outcome::HoldsAsMeant, "")),
            (_, seen) => Some((seen, "in the lane's values")),
        })
    }

    /// What a relation says of the shader as it is written, and where it fails, by the first reading of its literals by which
    /// it does not.
    fn read(
        &self,
        relation: &dyn Relation,
        inputs: &[Sample],
        passes: &[Passes<'_>],
        see: &See<'_>,
    ) -> Result<Outcome, LaneError> {
        let judge = |passes: &[Passes<'_>]| -> Result<Outcome, LaneError> {
            let told = |error: InterpError| LaneError::Unsupported(error.locate(&self.prepared.program));
            let seen: Vec<_> = passes.par_iter().enumerate().map(|(input, passes)| see(passes, input)).collect();
            let outputs = seen.into_iter().collect::<Result<Vec<_>, _>>().map_err(told)?;
            Ok(relate::judge(relation, inputs, &outputs))
        };
        let written = judge(passes)?;
        if !matches!(written, Outcome::Fails(_)) {
            return Ok(written);
        }
        for reading in self.context.readings() {
            let passes: Vec<_> = passes.iter().map(|passes| passes.by(reading)).collect();
            match judge(&passes)? {
                Outcome::Fails(_) => {}
                Outcome::Holds | Outcome::HoldsAsMeant => return Ok(Outcome::HoldsAsMeant),
                Outcome::Silent => return Ok(Outcome::Silent),
            }
        }
        Ok(written)
    }
}
