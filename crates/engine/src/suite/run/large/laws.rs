//! Relations between large dispatches: of what the shader means, and of the lane's values.
//!
//! A word may be off by the radius that goes with it through memory. Nothing is shrunk.

use super::super::finding::{self, Finding, FindingKind};
use super::super::part::Part;
use super::super::relate::{self, Outcome};
use super::super::{Prepared, Request};
use judge::verdict::{JudgeContext, meaning_whole, observe_whole};
use lanes::{LaneError, Runner, interrupt};
use program::interp::InterpError;
use property::{Claim, Observed, Relation, Sample};

/// What relations are checked with.
pub(super) struct Laws<'a> {
    pub prepared: &'a Prepared,
    pub context: JudgeContext<'a>,
    pub runner: &'a mut dyn Runner,
}

/// Gives the outputs of one of the inputs of a relation, by its number.
type See<'s> = dyn Fn(&JudgeContext<'_>, usize) -> Result<Vec<Observed>, InterpError> + 's;

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
        // One after the other: each has buffers of its own.
        let batches: Vec<_> = inputs.iter().map(|input| Sample::batch(std::slice::from_ref(input))).collect();
        let meant = self.read(relation, &inputs, &|context, input| meaning_whole(context, &batches[input]))?;
        if matches!(meant, Outcome::Fails(_)) {
            return Ok(Some((meant, "in what the shader means")));
        }
        let actual = batches.iter().map(|batch| self.runner.run(batch)).collect::<Result<Vec<_>, _>>()?;
        let seen =
            self.read(relation, &inputs, &|context, input| observe_whole(context, &batches[input], &actual[input]))?;
        Ok(match (meant, seen) {
            (Outcome::Silent, Outcome::Silent) => None,
            (meant, Outcome::Silent) => Some((meant, "")),
            (Outcome::HoldsAsMeant, Outcome::Holds) => Some((Outcome::HoldsAsMeant, "")),
            (_, seen) => Some((seen, "in the lane's values")),
        })
    }

    /// What a relation says of the shader as it is written, and where it fails, by the first reading of its literals by which
    /// it does not.
    fn read(&self, relation: &dyn Relation, inputs: &[Sample], see: &See<'_>) -> Result<Outcome, LaneError> {
        let judge = |context: &JudgeContext<'_>| -> Result<Outcome, LaneError> {
            let mut outputs = Vec::with_capacity(inputs.len());
            for input in 0..inputs.len() {
                let told = |error: InterpError| LaneError::Unsupported(error.locate(&self.prepared.program));
                outputs.extend(see(context, input).map_err(told)?);
            }
            Ok(relate::judge(relation, inputs, &outputs))
        };
        let written = judge(&self.context)?;
        if !matches!(written, Outcome::Fails(_)) {
            return Ok(written);
        }
        for reading in self.context.readings() {
            match judge(&reading)? {
                Outcome::Fails(_) => {}
                Outcome::Holds | Outcome::HoldsAsMeant => return Ok(Outcome::HoldsAsMeant),
                Outcome::Silent => return Ok(Outcome::Silent),
            }
        }
        Ok(written)
    }
}
