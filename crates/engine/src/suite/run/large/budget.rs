//! How much of a suite about large dispatches a run does, for one of them may take seconds.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::super::{Prepared, Request};
use base::value::Batch;
use judge::verdict::{JudgeContext, Work, work_of_whole};
use lanes::LaneError;

/// Rounds of loops of all samples together, unless a number of samples is asked for.
const ROUNDS: u64 = 1 << 20;
/// Rounds of loops of the samples of a relation together.
const ROUNDS_OF_RELATION: u64 = ROUNDS / 4;
/// Words of the samples of a relation together: large buffers take long without a loop.
const WORDS_OF_RELATION: u64 = 1 << 18;
/// Samples on which a relation is checked at most: each takes a run on the lane, and two of the interpreter, for each of its
/// inputs.
const RELATED: u64 = 8;

/// How much of a suite about large dispatches a run does.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Budget {
    /// Samples that were asked for.
    pub asked: u64,
    /// Samples that are run.
    pub samples: u64,
    /// Rounds of loops of one sample, those of its reference included; `None` where the number of samples is as asked for.
    pub rounds: Option<u64>,
    /// Rounds of loops that all samples together may take.
    pub limit: u64,
    /// Samples on which each relation is checked.
    pub related: u64,
}

impl Budget {
    /// The budget of a run that is asked for `asked` samples, of which `first` makes one.
    pub(super) fn of(
        context: &JudgeContext<'_>,
        (prepared, first): (&Prepared, &dyn Fn() -> Batch),
        request: &Request,
        asked: u64,
    ) -> Result<Self, LaneError> {
        let words = prepared.compute.invocation.words() as u64;
        let related = asked.min(RELATED).min((WORDS_OF_RELATION / words.max(1)).max(1));
        let as_asked = Self { asked, samples: asked, rounds: None, limit: ROUNDS, related };
        if request.samples.is_some() || request.replay_only || asked < 2 {
            return Ok(as_asked);
        }
        let work = work_of_whole(context, &first(), 0);
        let Work { shader, reference } =
            work.map_err(|error| LaneError::Unsupported(error.locate(&prepared.program)))?;
        let rounds = (shader + reference).max(1);
        Ok(Self {
            samples: asked.min((ROUNDS / rounds).max(1)),
            rounds: Some(rounds),
            related: as_asked.related.min((ROUNDS_OF_RELATION / shader.max(1)).max(1)),
            ..as_asked
        })
    }

    /// True where fewer samples are run than were asked for.
    pub fn is_short(&self) -> bool {
        self.samples < self.asked
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { asked, samples, rounds, limit, related } = self;
        write!(f, "a large dispatch: ")?;
        match rounds.filter(|_| self.is_short()) {
            Some(rounds) => write!(
                f,
                "{samples} of {asked} samples, since one takes {rounds} rounds of loops and a run {limit}; --samples \
                 sets another number; "
            )?,
            None => write!(f, "{samples} of {asked} samples; ")?,
        }
        write!(f, "each relation on at most {related}; edges, translations and repeated runs are left to smaller sizes")
    }
}
