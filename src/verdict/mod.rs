//! The judge: the only place where what a lane wrote is compared with what the formula says.

mod batch;
mod expectations;
mod expected;
mod judge;
mod observe;
mod tolerance;
mod translation;

pub use batch::{BatchVerdict, Failure, judge_batch, judge_one};
pub use expectations::{Expectations, Movement};
pub use expected::{Expected, Reference, ReferenceError};
pub use judge::{Component, Deviation, Reason, Verdict, judge_sample, judge_value};
pub use observe::{observe, observe_with, passed};
pub use tolerance::Tolerance;
pub use translation::{CompareError, Comparison, Difference, TranslationDeviation, Translations, Unread};
