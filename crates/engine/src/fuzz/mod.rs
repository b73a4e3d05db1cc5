//! Fuzzing without a suite: every function of a file is run on inputs from its domain, on all lanes,
//! and judged by what it means itself.
//!
//! ```text
//! file ─ slice ─▶ one function alone ─ wrapper ─▶ text ─▶ Program, Kernel
//! domain ─ realistic, generate ─▶ Batch ─┬─ scan: binary64 beside strict binary32 ─▶ troubles ─ name ─▶ findings
//!                                        └─ lanes ─▶ verdicts, blame, determinism ─▶ findings
//! ```

mod apart;
mod builtin;
mod called;
mod crossing;
mod domain;
mod finding;
mod generate;
mod guessed;
mod hint;
mod lanes;
mod lowered;
mod modules;
mod name;
mod presumed;
mod realistic;
mod run;
mod scan;
mod shrinking;
mod slice;
mod stage;
mod subject;
mod textured;
mod words;
mod wrapper;

pub(crate) use crossing::{PILOT, sizes};
pub use domain::{Domain, InputDomain, Interval, Law, MODERATE, Shrinking, Stated, Within};
pub use finding::{Finding, FunctionReport, FuzzFindingKind, LaneReport, Part, Severity, WORKGROUPS};
pub use generate::{batch, stream_key};
pub(crate) use generate::{batch_size, drawn};
pub use hint::{FORMS, option};
pub(crate) use lowered::{Beside, Event, Harm, Narrowing};
pub(crate) use modules::Known;
pub use modules::subjects_of_module;
pub use name::decimal;
pub(crate) use name::{place, place_of};
pub use run::{Request, given, run};
pub use scan::{LIMIT, ROUNDS, Trouble};
pub(crate) use scan::{Look, scan};
pub(crate) use stage::{kernel, stage_of};
pub use subject::{BadHint, Ready, Subject, subjects};
pub(crate) use words::{operation, word_of};
