//! Expectations: failures that are expected, as data beside the suites.
//!
//! A failure that an entry expects does not make a run fail; one that an entry expects and that does not come does.
//! Expectations have no say in what is judged: they are applied to the result of a suite on a stage of a lane, once.
//!
//! An entry is about every suite and stage that it matches: one that is too wide shows as a failure that did not
//! come.

mod apply;
mod glob;
mod parse;
mod version;

use std::cell::Cell;

use crate::suite::run::{Expectation, FindingKind};
use lanes::{Description, Stage};

pub use parse::parse;

use version::Versions;

/// Name of the file.
pub const FILE: &str = "expectations.toml";

/// Expectations as their file states them.
#[derive(Clone, Debug, Default)]
pub struct Expectations {
    entries: Vec<Expected>,
}

/// A failure that is expected.
#[derive(Clone, Debug)]
struct Expected {
    /// Pattern of names of lanes.
    lane: String,
    /// Pattern of drivers; any without it.
    driver: Option<String>,
    /// Versions of the driver; any without it.
    versions: Option<Versions>,
    /// Pattern of names of suites.
    suite: String,
    /// Stage of the lane; any without it.
    stage: Option<Stage>,
    kind: FailureKind,
    /// Pattern of the message; any without it.
    message: Option<String>,
    /// False where the failure comes in some runs alone.
    always: bool,
    expectation: Expectation,
    /// True once something that ran was what the entry is about.
    met: Cell<bool>,
    /// True once a lane that ran was one that the entry is about.
    ran: Cell<bool>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FailureKind {
    Finding(FindingKind),
    /// The lane as such.
    Lane,
}

impl FailureKind {
    fn all() -> impl Iterator<Item = Self> {
        // A warning does not make a run fail, and an unexpected pass comes from the expectations themselves.
        let fails = |kind: &FindingKind| !kind.is_warning() && *kind != FindingKind::UnexpectedPass;
        FindingKind::ALL.into_iter().filter(fails).map(Self::Finding).chain([Self::Lane])
    }

    fn name(self) -> &'static str {
        match self {
            Self::Finding(kind) => kind.name(),
            Self::Lane => "lane",
        }
    }
}

impl Expected {
    /// True when the entry is about this lane with this driver.
    fn is_of(&self, lane: &Description) -> bool {
        let of = glob::matches(&self.lane, lane.name)
            && self.driver.as_ref().is_none_or(|driver| glob::matches(driver, &lane.driver))
            && self.versions.as_ref().is_none_or(|versions| versions.hold(&lane.driver));
        if of {
            self.ran.set(true);
        }
        of
    }

    /// True when the entry is about this suite on this stage.
    fn is_about(&self, suite: &str, stage: Stage) -> bool {
        let about = glob::matches(&self.suite, suite) && self.stage.is_none_or(|own| own == stage);
        if about {
            self.met.set(true);
        }
        about
    }
}

impl Expectations {
    /// Number of entries.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// True when nothing is expected to fail.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Entries that are about nothing that ran, although their lane and driver did, one line each. To be asked
    /// when everything has run.
    pub fn stale(&self) -> Vec<String> {
        let stale = self.entries.iter().filter(|entry| entry.ran.get() && !entry.met.get());
        let reported = |entry: &Expected| {
            let stage = entry.stage.map_or_else(String::new, |stage| format!(" in the {stage} stage"));
            format!("{}: nothing that ran is a suite `{}`{stage}", entry.expectation.at, entry.suite)
        };
        stale.map(reported).collect()
    }
}
