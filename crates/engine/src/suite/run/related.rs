//! What relations want to see, and what is known of it before a lane runs it. The relations of a suite share most of their
//! inputs, and lanes and stages share all of them: each is looked at once.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use base::value::Batch;
use judge::verdict::{JudgeContext, Lenience, Slack, meaning, slack};
use property::{Observed, Own, Relation, Sample};

/// Numbers of the inputs that a relation wants to see for a sample.
pub(super) type Wanted = Vec<usize>;

/// The inputs that relations want to see for some samples, each of them once.
pub(super) struct Inputs {
    all: Vec<Sample>,
    /// By relation, then by sample.
    pub(super) wanted: Vec<Vec<Wanted>>,
}

impl Inputs {
    pub(super) fn of(relations: &[Own<dyn Relation>], samples: &[Sample]) -> Self {
        let mut numbers: HashMap<(Vec<u32>, Vec<u32>), usize> = HashMap::new();
        let mut all = Vec::new();
        let mut number_of = |input: Sample| {
            *numbers.entry((input.invocation.clone(), input.case.clone())).or_insert_with(|| {
                all.push(input);
                all.len() - 1
            })
        };
        let mut of_sample = |relation: &Own<dyn Relation>, sample| -> Wanted {
            relation.inputs(sample).into_iter().map(&mut number_of).collect()
        };
        let of_relation = |relation| samples.iter().map(|sample| of_sample(relation, sample)).collect();
        let wanted = relations.iter().map(of_relation).collect();
        Self { all, wanted }
    }

    /// All of them; none when no relation wants to see anything.
    pub(super) fn batch(&self) -> Option<Batch> {
        (!self.all.is_empty()).then(|| Sample::batch(&self.all))
    }

    /// Those with these numbers.
    pub(super) fn samples<'i>(&'i self, wanted: &'i [usize]) -> impl Iterator<Item = Sample> + 'i {
        wanted.iter().map(|&input| self.all[input].clone())
    }
}

/// What is known of inputs, each in their order.
#[derive(Clone)]
pub(super) struct Known {
    /// What the shader means.
    pub(super) meant: Arc<Vec<Observed>>,
    /// How far a lane may be off.
    pub(super) slack: Arc<Slack>,
}

impl Known {
    pub(super) fn of(context: &JudgeContext<'_>, batch: &Batch) -> Self {
        Self { meant: Arc::new(meaning(context, batch)), slack: Arc::new(slack(context, batch)) }
    }
}

/// What is known of the inputs of a suite's relations, from one lane to the next.
#[derive(Default)]
pub struct KeptKnown(Mutex<Option<Kept>>);

/// What the last lane left.
struct Kept {
    inputs: Vec<Sample>,
    lowered: bool,
    lenience: Lenience,
    known: Known,
}

/// Most numbers that are kept.
const KEPT: usize = 1 << 20;

impl KeptKnown {
    /// `batch` has the inputs; `lowered` says that the program is that of [`super::Prepared::lowered`]. Nobody waits for what another lane is computing.
    pub(super) fn of(&self, context: &JudgeContext<'_>, lowered: bool, inputs: &Inputs, batch: &Batch) -> Known {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let lenience = context.lenience();
        let left = lock().as_ref().filter(|kept| kept.lowered == lowered && kept.inputs == inputs.all).map(|kept| {
            let slack = (kept.lenience == lenience).then(|| kept.known.slack.clone());
            (kept.known.meant.clone(), slack)
        });
        let known = match left {
            None => Known::of(context, batch),
            Some((meant, slack_left)) => {
                Known { meant, slack: slack_left.unwrap_or_else(|| Arc::new(slack(context, batch))) }
            }
        };
        let numbers = known.slack.iter().map(Vec::len).sum::<usize>();
        *lock() =
            (numbers <= KEPT).then(|| Kept { inputs: inputs.all.clone(), lowered, lenience, known: known.clone() });
        known
    }
}
