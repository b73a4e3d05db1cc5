//! The judge: the only place where what a lane wrote, what the shader means and what the formula says
//! are compared.

mod batch;
mod closeup;
pub mod diagnosis;
mod edges;
mod expectations;
mod fence;
mod first_look;
mod fit;
mod judge;
mod limits;
mod literals;
mod observe;
mod open;
mod oracle;
mod parallel;
mod reading;
mod reference;
mod rounded;
mod rounding;
mod second_pass;
mod shape;
mod survey;
mod tightness;
mod translation;
mod undefined;
mod unlike;
mod used;

pub use batch::{BatchVerdict, Doubts, Failure, judge_at, judge_batch, judge_each};
pub use closeup::{Closeup, Seen, closeups};
pub use edges::{Edges, Question, Reached, edges};
pub use expectations::{Movement, movement, shader_deviation};
pub use fence::{Fence, Fenced};
pub use judge::{Blame, Deviation, Doubt, Promise, Reason, Value, Verdict, What, agrees};
pub use limits::{Limiter, Limits, Meant, Roundoff, Wanted};
pub use observe::{meaning, observe};
pub use oracle::{JudgeContext, Oracle};
pub use reference::{Expected, Given, GivenRule, MEANING, Recorded, RecordedRow, Reference, ReferenceError};
pub use rounded::{Literals, Rounded};
pub use rounding::{Effect, effects};
pub use survey::{Survey, survey};
pub use tightness::{Tightness, VariableTightness, Worst};
pub use translation::{CompareError, Comparison, Difference, TranslationDeviation, Translations, Unread};
pub use undefined::dependences;
pub use unlike::unlike;
pub use used::{Used, used};
