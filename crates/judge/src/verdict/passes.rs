//! What a large dispatch gives in the domains in which it is asked for, each run once.
//!
//! A verdict, a survey of bounds and a relation ask for the same: a strict device is what the lane `embedded` promises to be,
//! and without numbers that are rounded all devices are one.

use std::ptr;
use std::sync::{Arc, Mutex, PoisonError};

use super::oracle::JudgeContext;
use crate::tape::{Cell, Literal, Model};
use base::value::Batch;
use program::interp::InterpError;
use program::interp::group::Ran;

/// A domain: whose errors count, and what stands for the literals.
#[derive(Clone, Copy)]
struct PassDomain<'a> {
    model: Model<'a>,
    literals: &'a [Option<Literal>],
    /// A device that rounds to nearest is known to the bit.
    bracketed: bool,
}

impl PassDomain<'_> {
    fn is(&self, other: &Self) -> bool {
        let same = match (self.model, other.model) {
            (Model::Binary64, Model::Binary64) => true,
            (
                Model::Device { profile, stage, rearranged },
                Model::Device { profile: profile2, stage: stage2, rearranged: rearranged2 },
            ) => ptr::eq(profile, profile2) && (stage, rearranged) == (stage2, rearranged2),
            (Model::Binary64, Model::Device { .. }) | (Model::Device { .. }, Model::Binary64) => false,
        };
        same && self.literals == other.literals && self.bracketed == other.bracketed
    }
}

/// The runs of one large dispatch.
pub struct Passes<'a> {
    context: JudgeContext<'a>,
    batch: &'a Batch,
    ran: Mutex<Vec<(PassDomain<'a>, Arc<Ran<Cell>>)>>,
}

impl<'a> Passes<'a> {
    /// None so far, of the first invocation of a batch.
    pub fn new(context: JudgeContext<'a>, batch: &'a Batch) -> Self {
        Self { context, batch, ran: Mutex::default() }
    }

    /// None so far, of the same dispatch by another context.
    pub fn by<'b>(&'b self, context: JudgeContext<'b>) -> Passes<'b> {
        Passes::new(context, self.batch)
    }

    /// What is judged, and by what.
    pub fn context(&self) -> &JudgeContext<'a> {
        &self.context
    }

    /// What goes into the dispatch.
    pub(super) fn batch(&self) -> &'a Batch {
        self.batch
    }

    /// How far a device may be from what the module means: one that rounds to nearest is known to the bit.
    ///
    /// # Errors
    /// As of [`Executable::run_whole`](program::interp::Executable::run_whole), here and below.
    pub(super) fn device(&self, model: Model<'a>) -> Result<Arc<Ran<Cell>>, InterpError> {
        self.ask(PassDomain { model, literals: self.context.oracle.folded(), bracketed: true })
    }

    /// How far a device may be off at the most, where the rounding of a literal counts as an error of its own: inputs that are
    /// related were rounded as well, and the luck of one of them is none of another.
    pub(super) fn authored(&self, model: Model<'a>) -> Result<Arc<Ran<Cell>>, InterpError> {
        self.ask(PassDomain { model, literals: self.context.oracle.rounded(), bracketed: false })
    }

    /// The same for a device that had the literals exactly.
    pub(super) fn ideal_device(&self, model: Model<'a>) -> Result<Arc<Ran<Cell>>, InterpError> {
        self.ask(PassDomain { model, literals: self.context.oracle.written(), bracketed: false })
    }

    /// What the author wrote, with how far binary64 is from it.
    pub(super) fn ideal(&self) -> Result<Arc<Ran<Cell>>, InterpError> {
        self.ask(PassDomain { model: Model::Binary64, literals: self.context.oracle.written(), bracketed: false })
    }

    fn ask(&self, domain: PassDomain<'a>) -> Result<Arc<Ran<Cell>>, InterpError> {
        let oracle = self.context.oracle;
        let integers = !oracle.executable().has_reals();
        let known = {
            let ran = self.ran.lock().unwrap_or_else(PoisonError::into_inner);
            ran.iter().find(|(of, _)| integers || of.is(&domain)).map(|(_, ran)| Arc::clone(ran))
        };
        if let Some(known) = known {
            return Ok(known);
        }
        let PassDomain { model, literals, bracketed } = domain;
        let new = Arc::new(oracle.whole((model, literals), bracketed, self.batch, 0)?);
        self.ran.lock().unwrap_or_else(PoisonError::into_inner).push((domain, Arc::clone(&new)));
        Ok(new)
    }
}
