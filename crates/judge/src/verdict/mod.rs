//! The judge: the only place where what a lane wrote, what the shader means and what the formula says
//! are compared.
//!
//! The shader is compared with its formula in binary64, where no lane has a say: a bound of several ULP would let a
//! factor of 1.0001 pass where an operation is promised little, and would hide a constant with too few digits
//! everywhere. The lane is compared with the meaning of the shader, within the bound. What an API does not promise is
//! undetermined, with the operation as the reason; a suite caps the share of such samples.

mod batch;
mod closeup;
pub mod diagnosis;
mod edges;
mod expectations;
mod fence;
mod first_look;
mod fit;
mod follow;
mod judge;
mod limits;
mod literals;
mod observe;
mod open;
mod oracle;
mod parallel;
mod passes;
mod reading;
mod reference;
mod rounded;
mod rounding;
mod rounds;
mod scan;
mod second_pass;
mod shape;
mod survey;
mod tightness;
mod translation;
mod undefined;
mod unlike;
mod used;
mod whole;
mod whole_survey;
mod words;

pub use batch::{BatchVerdict, Doubts, Failure, Judges, judge_at, judge_batch, judge_each};
pub use closeup::{Closeup, Seen, closeups};
pub use edges::{Edges, Question, Reached, edges};
pub use expectations::{Movement, movement, shader_deviation};
pub use fence::{Fence, Fenced};
pub use judge::{Blame, Deviation, Doubt, Promise, Reason, Value, Verdict, What, agrees};
pub use limits::{Limiter, Limits, Meant, Roundoff, Wanted};
pub use observe::{Lenience, Slack, meaning, meaning_whole, observe, observe_again, observe_whole, slack};
pub use oracle::{JudgeContext, Oracle};
pub use passes::Passes;
pub use reference::{Expected, Given, GivenRule, MEANING, Recorded, RecordedRow, Reference, ReferenceError};
pub use rounded::{Literals, Rounded};
pub use rounding::{Effect, effects};
pub use rounds::{ENDLESS, Rounds};
pub use survey::{OfSample, Survey, survey};
pub use tightness::{Tightness, VariableTightness, Worst};
pub use translation::{CompareError, Comparison, Difference, TranslationDeviation, Translations, Unread};
pub use undefined::dependences;
pub use unlike::unlike;
pub use used::{Used, used};
pub use whole::{Work, judge_whole, work_of_whole};
pub use whole_survey::WholeSurvey;
