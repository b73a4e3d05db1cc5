//! What became of mutants.

use std::borrow::Cow;

use super::operators::CONSTANT_ULP;
use judge::verdict::Movement;
use serde::{Deserialize, Serialize};

/// Name of an operator.
pub type Name = &'static str;

/// What noticed a mutant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kill {
    /// A value deviates from the formula, or an output is not written: how.
    Formula(String),
    /// A geometry stage emits other vertices or strips: how.
    Shape(String),
    /// An output is not written any more, so that the suite cannot run: its name.
    MissingOutput(String),
    /// Loops take more iterations than the original could ever need.
    NotFinished,
    /// A relation between outputs does not hold: its name.
    Relation(String),
    /// Segments of strands are not drawn.
    Coverage,
    /// A test that stands in the shader fails: its name.
    Test(String),
}

impl Kill {
    /// Names of all kinds, in the order of reports.
    pub const NAMES: [&'static str; 7] =
        ["formula", "emission shape", "missing output", "does not finish", "relation", "coverage", "test"];

    /// Name of the check in reports.
    pub fn name(&self) -> &'static str {
        let [formula, shape, missing, not_finished, relation, coverage, test] = Self::NAMES;
        match self {
            Self::Formula(_) => formula,
            Self::Shape(_) => shape,
            Self::MissingOutput(_) => missing,
            Self::NotFinished => not_finished,
            Self::Relation(_) => relation,
            Self::Coverage => coverage,
            Self::Test(_) => test,
        }
    }
}

/// What became of a mutant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Outcome {
    /// The suite noticed it.
    Killed(Kill),
    /// The suite passed, although outputs moved: by so much.
    Survived(Movement),
    /// The suite passed, and every output means the same on all samples. It may still mean something
    /// else outside of them.
    Unmoved,
    /// No output moved, and the form of the mutant shows why none can: the reason.
    Equivalent(Cow<'static, str>),
    /// It could not be run, which no operator should bring about: why.
    Invalid(String),
}

impl Outcome {
    /// Name in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Killed(_) => "killed",
            Self::Survived(_) => "survived",
            Self::Unmoved => "unmoved",
            Self::Equivalent(_) => "equivalent",
            Self::Invalid(_) => "invalid",
        }
    }
}

/// A mutant and what became of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Tested {
    /// Name of the operator that made it.
    #[serde(with = "known")]
    pub operator: Name,
    /// What was done, without a full stop.
    pub what: String,
    /// Line of the shader, from 1.
    pub line: usize,
    /// Column, in characters from 1.
    pub column: usize,
    /// The fault as a unified diff.
    pub diff: String,
    /// What became of it.
    pub outcome: Outcome,
    /// Samples on which it ran, up to the one that killed it.
    pub samples: u64,
}

/// Names of operators, where they are written down.
mod known {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(name: &str, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(name)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<&'static str, D::Error> {
        let name = String::deserialize(from)?;
        let operator = crate::mutate::operators::by_name(&name);
        operator.map(|operator| operator.name).ok_or_else(|| D::Error::custom(format!("there is no operator `{name}`")))
    }
}

/// Mutants, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Score {
    /// Noticed.
    pub killed: usize,
    /// Not noticed, although outputs moved.
    pub survived: usize,
    /// Not noticed, and nothing moved on the samples.
    pub unmoved: usize,
    /// The same by their form.
    pub equivalent: usize,
    /// Could not be run.
    pub invalid: usize,
}

impl Score {
    /// Counts mutants.
    pub fn of<'a>(tested: impl IntoIterator<Item = &'a Tested>) -> Self {
        let mut score = Self::default();
        for mutant in tested {
            let count = match mutant.outcome {
                Outcome::Killed(_) => &mut score.killed,
                Outcome::Survived(_) => &mut score.survived,
                Outcome::Unmoved => &mut score.unmoved,
                Outcome::Equivalent(_) => &mut score.equivalent,
                Outcome::Invalid(_) => &mut score.invalid,
            };
            *count += 1;
        }
        score
    }

    /// All mutants.
    pub fn all(&self) -> usize {
        let Self { killed, survived, unmoved, equivalent, invalid } = *self;
        killed + survived + unmoved + equivalent + invalid
    }

    /// Share of the killed among those that moved an output, 0 to 1; none when none did.
    pub fn share(&self) -> Option<f64> {
        ratio(self.killed, self.killed + self.survived)
    }

    /// The same with every unmoved mutant counted as one that should have been noticed.
    pub fn pessimistic(&self) -> Option<f64> {
        ratio(self.killed, self.killed + self.survived + self.unmoved)
    }
}

fn ratio(part: usize, all: usize) -> Option<f64> {
    (all > 0).then(|| part as f64 / all as f64)
}

/// The mutants of one suite.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SuiteResult {
    /// Name of the suite.
    pub suite: String,
    /// The shader, as it was named.
    pub shader: String,
    /// Samples for each mutant that nothing kills.
    pub samples: u64,
    /// The mutants in the order of operators and of the text.
    pub tested: Vec<Tested>,
}

impl SuiteResult {
    /// All mutants, counted.
    pub fn score(&self) -> Score {
        Score::of(&self.tested)
    }

    /// Mutants without those that move a literal by one ULP, which is less than many a device is off.
    pub fn score_above_ulp(&self) -> Score {
        Score::of(self.tested.iter().filter(|t| t.operator != CONSTANT_ULP))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tested(operator: &'static str, outcome: Outcome) -> Tested {
        Tested { operator, what: String::new(), line: 1, column: 1, diff: String::new(), outcome, samples: 1 }
    }

    #[test]
    fn what_did_not_move_or_run_counts_on_neither_side() {
        let survived = Outcome::Survived(Movement { samples: 1, bounds: 0.5, component: Some("d".into()) });
        let all = [
            tested("sign", Outcome::Killed(Kill::NotFinished)),
            tested("sign", Outcome::Killed(Kill::Coverage)),
            tested("sign", Outcome::Killed(Kill::Relation("r".to_owned()))),
            tested(CONSTANT_ULP, survived),
            tested("sign", Outcome::Unmoved),
            tested("sign", Outcome::Equivalent("e".into())),
            tested("sign", Outcome::Invalid("i".into())),
        ];
        let score = Score::of(&all);
        assert_eq!((score.all(), score.share(), score.pessimistic()), (7, Some(0.75), Some(0.6)));
        let result = SuiteResult { suite: "s".into(), shader: "s".into(), samples: 1, tested: all.to_vec() };
        assert_eq!(result.score_above_ulp().share(), Some(1.0));
        assert_eq!(Score::default().share(), None);
    }
}
