//! Suites of which a lane judged no sample, grouped by the reason.

use engine::suite::run::{Entry, Outcome, Summary};

/// Suites that a lane did not run for one reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NotRun<'a> {
    /// Name of the lane.
    pub lane: &'static str,
    /// Why, without the number of samples.
    pub why: String,
    /// Names of the suites.
    pub suites: Vec<&'a str>,
}

/// All of them, in the order of the run.
pub(super) fn by_cause(summary: &Summary) -> Vec<NotRun<'_>> {
    let mut all: Vec<NotRun<'_>> = Vec::new();
    for entry in &summary.entries {
        let (Some((lane, _)), Some(why)) = (entry.on, why(entry)) else { continue };
        match all.iter_mut().find(|known| known.lane == lane && known.why == why) {
            Some(known) if known.suites.contains(&entry.suite.as_str()) => {}
            Some(known) => known.suites.push(&entry.suite),
            None => all.push(NotRun { lane, why, suites: vec![&entry.suite] }),
        }
    }
    all
}

fn why(entry: &Entry) -> Option<String> {
    let all = entry.not_run()?;
    match &entry.outcome {
        Outcome::Ran(report) => Some(report.unsupported_because.clone().unwrap_or(all)),
        Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => None,
    }
}
