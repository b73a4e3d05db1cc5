//! What a program shows, and what tells one cause from another.

use serde::{Deserialize, Serialize};

use super::program::Program;
use crate::InputValue;
use crate::suite::run::{Finding, FindingKind, Report};
use judge::verdict::diagnosis::{Fault, Origin};
use lanes::LaneError;

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// The process of a driver or a translator crashed or hung, or the device was lost.
    Lost,
    /// naga panicked.
    Panic,
    /// A lane gives something else than the program means.
    Deviation,
    /// A lane gave different outputs for the same inputs.
    Flaky,
    /// A translation means something else than the program.
    Translation,
    /// A call of a driver failed, or a lane wrote nothing.
    Failed,
}

impl EventKind {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lost => "lost",
            Self::Panic => "panic",
            Self::Deviation => "deviation",
            Self::Flaky => "flaky",
            Self::Translation => "translation",
            Self::Failed => "failed",
        }
    }
}

/// One thing that a program shows.
#[derive(Clone, Debug)]
pub struct Event {
    /// What it is.
    pub kind: EventKind,
    /// The lane, or the language of the translation.
    pub on: String,
    /// What is wrong, in a sentence.
    pub message: String,
    /// What a deviation comes from, in a word: the built-in that is wrong alone, or how all of them together are.
    pub origin: String,
    /// The same in a sentence.
    pub diagnosis: String,
    /// Whose fault it is: a word and a sentence.
    pub blamed: String,
    /// The inputs that show it.
    pub inputs: Vec<InputValue>,
    /// The command that runs these.
    pub reproduce: Option<String>,
}

impl Event {
    /// True where what is known before a program is made smaller says what the cause is.
    pub fn is_sure(&self) -> bool {
        self.kind != EventKind::Translation && self.origin != MISCOMPILATION && self.origin != UNKNOWN
    }

    /// What is known of the cause before a program is made smaller.
    pub fn coarse(&self) -> String {
        format!("{} on {}: {}", self.kind.name(), self.on, self.origin)
    }

    /// True where a smaller program shows the same.
    pub fn is_like(&self, other: &Self) -> bool {
        self.coarse() == other.coarse()
    }

    /// What tells the cause from others once the program is small: who is blamed, for what, and the operations in it.
    pub fn key(&self, operations: &str, program: &Program) -> String {
        let about = match self.is_sure() {
            true => String::new(),
            false => {
                let mut words: Vec<String> =
                    program.kinds().into_iter().filter(|word| STRUCTURE.contains(&&**word)).collect();
                words.sort();
                format!(" of {operations} {}", words.join(", "))
            }
        };
        let who = if self.blamed.is_empty() { &self.on } else { &self.blamed };
        format!("{} of {who}: {}{about}", self.kind.name(), self.origin)
    }
}

/// Kinds of statements and expressions that say what a small program is about.
const STRUCTURE: [&str; 20] = [
    "if",
    "for",
    "loop",
    "switch",
    "break",
    "continue",
    "early return",
    "pointer",
    "pointer to a part",
    "assign a part",
    "exchange",
    "atomic",
    "construct array",
    "construct structure",
    "construct matrix",
    "member",
    "element",
    "call",
    "assign",
    "uniform",
];

/// Every operation alone is right.
const MISCOMPILATION: &str = "miscompilation";
/// Nothing is known.
const UNKNOWN: &str = "unknown";

/// What a lane failed with.
pub fn of_failure(lane: &str, error: &LaneError) -> Event {
    let kind = match error {
        LaneError::Lost { .. } | LaneError::Translator(_) => EventKind::Lost,
        LaneError::Api(_) | LaneError::Unsupported(_) | LaneError::Endless { .. } | LaneError::NotWritten { .. } => {
            EventKind::Failed
        }
    };
    let message = error.to_string();
    // wgpu has naga inside: the panic is one of the translator, whatever lane met it.
    if let Some(event) = of_panic(&message) {
        return event;
    }
    Event {
        kind,
        on: lane.to_owned(),
        origin: plain(&message),
        message,
        diagnosis: String::new(),
        blamed: String::new(),
        inputs: Vec::new(),
        reproduce: None,
    }
}

/// A panic of naga, by what a front end or a translator is refused with.
pub fn of_panic(why: &str) -> Option<Event> {
    let said = ["panicked: ", "a panic: "].into_iter().find_map(|word| why.split_once(word))?.1;
    Some(Event {
        kind: EventKind::Panic,
        on: "naga".to_owned(),
        origin: plain(said),
        message: why.to_owned(),
        diagnosis: String::new(),
        blamed: String::new(),
        inputs: Vec::new(),
        reproduce: None,
    })
}

/// What a finding of a run shows; none for what is about the run itself.
pub fn of_finding(report: &Report, finding: &Finding) -> Option<Event> {
    let kind = match finding.kind {
        FindingKind::Deviation => EventKind::Deviation,
        FindingKind::Flaky => EventKind::Flaky,
        FindingKind::Translation => EventKind::Translation,
        FindingKind::Undefined
        | FindingKind::Guessed
        | FindingKind::Relation
        | FindingKind::Coverage
        | FindingKind::Floor
        | FindingKind::Vacuous
        | FindingKind::UnexpectedPass
        | FindingKind::Quality
        | FindingKind::VacuousBound
        | FindingKind::Range
        | FindingKind::RoundedLiteral => return None,
    };
    let case = finding.case.as_ref();
    let diagnosis = case.map(|case| &case.diagnosis);
    let origin = diagnosis.and_then(|d| d.origin.as_ref());
    let word = match origin {
        Some(Origin::BuiltIn { op, .. }) => format!("built-in {}", op.name()),
        Some(Origin::Rearrangement) => "rearrangement".to_owned(),
        Some(Origin::PreciseLost { .. }) => "precise lost".to_owned(),
        Some(Origin::RoundingLeftOut { .. }) => "rounding left out".to_owned(),
        Some(Origin::Miscompilation) => MISCOMPILATION.to_owned(),
        None if diagnosis.is_some_and(|d| d.position.is_some()) => "position".to_owned(),
        None => UNKNOWN.to_owned(),
    };
    let fault = diagnosis.and_then(|d| d.cross_check.as_ref()).map(|check| &check.fault);
    let on = match kind {
        EventKind::Translation => finding.message.split(':').next().unwrap_or_default().to_owned(),
        _ => report.lane.to_owned(),
    };
    Some(Event {
        kind,
        on,
        message: finding.message.clone(),
        origin: word,
        diagnosis: origin.map(ToString::to_string).unwrap_or_default(),
        blamed: fault.map(blamed).unwrap_or_default(),
        inputs: case.map(|case| case.inputs.clone()).unwrap_or_default(),
        reproduce: finding.reproduce.clone(),
    })
}

/// Who is blamed, in a few words that do not depend on which lanes ran beside.
fn blamed(fault: &Fault) -> String {
    match fault {
        Fault::Executor { executor, .. } | Fault::Position { executor, .. } | Fault::Neighbours { executor, .. } => {
            format!("executor {executor}")
        }
        Fault::Translator { front_end, .. } => format!("translator {front_end}"),
        Fault::OneGroup { executor, front_end } | Fault::Either { executor, front_end } => {
            format!("executor {executor} or translator {front_end}")
        }
        Fault::Pair { executor, front_end } | Fault::Unsteady { executor, front_end } => {
            format!("executor {executor} with translator {front_end}")
        }
        Fault::Shader => "the program".to_owned(),
        Fault::Everyone { .. } => "every lane, or our own meaning".to_owned(),
        Fault::Mixed { wrong, .. } => format!("mixed: {}", wrong.join(", ")),
    }
}

/// A message without numbers, names of variables and what it quotes, so that those of one cause are alike.
pub fn plain(message: &str) -> String {
    let first = message.lines().next().unwrap_or_default();
    let mut text = String::new();
    let mut quoted = false;
    for c in first.chars() {
        match c {
            '`' | '"' => quoted = !quoted,
            _ if quoted => {}
            c if c.is_ascii_digit() => {
                if !text.ends_with('0') {
                    text.push('0');
                }
            }
            c => text.push(c),
        }
    }
    text.chars().take(160).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_of_one_cause_are_alike() {
        assert_eq!(plain("a.frag:12:3: `v12` is 0x3f no [77]"), plain("a.frag:2:31: `x` is 0x3f no [8]"));
        assert_ne!(plain("lost its device"), plain("was ended by SIGSEGV"));
    }
}
