//! What a run of one function gives.

use super::domain::{Law, Standing};
use super::subject::Subject;
use crate::InputValue;
use base::value::Scalar;
use judge::verdict::diagnosis::{Diagnosis, Place};
use judge::verdict::{BatchVerdict, Reason};
use lanes::LaneName;
use serde::{Deserialize, Serialize};

/// Declares kinds of findings with their names in reports and a sentence about each.
macro_rules! kinds {
    ($($kind:ident = $name:literal $about:literal;)+) => {
        /// What is wrong.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum FuzzFindingKind {
            $(#[doc = $about] $kind,)+
        }

        impl FuzzFindingKind {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$kind),+];

            /// Name in reports.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)+
                }
            }

            /// What it means, in a sentence.
            pub fn about(self) -> &'static str {
                match self {
                    $(Self::$kind => $about,)+
                }
            }
        }
    };
}

kinds! {
    LaneDeviation = "lane_deviation" "A lane gives something else than the function means.";
    NotDeterministic = "not_deterministic" "A lane gives different outputs for the same inputs.";
    Disturbed = "disturbed" "Invocations of a lane disturb each other: what the same inputs give depends on what stands beside them.";
    LaneFailed = "lane_failed" "A lane could not run the function to its end.";
    NoValue = "no_value" "An output has no value.";
    Infinite = "infinite" "An output is infinite.";
    Overflow = "overflow" "A value on the way is too large for binary32, and the output is not.";
    Underflow = "underflow" "A value on the way is too small for binary32, and that is lost in the output.";
    Lost = "lost" "Rounding on the way leaves binary32 without a value where real numbers have one.";
    NotWritten = "not_written" "An output is not written.";
    TooManyVertices = "too_many_vertices" "More vertices than `max_vertices`.";
    Endless = "endless" "A loop does not end in reasonable time.";
    Unset = "unset" "A variable that is read before it has a value, or a function that ends without `return`.";
    Undefined = "undefined" "An operation on arguments for which the language leaves its value undefined.";
    Index = "index" "An index outside of its array.";
    DivisionByZero = "division_by_zero" "An integer divided by zero.";
    Shift = "shift" "A shift by 32 or more.";
    Conversion = "conversion" "A number that does not fit the integer that it is converted to.";
    IntegerOverflow = "integer_overflow" "A signed integer that does not fit.";
    Race = "race" "Two invocations of a dispatch touch one place in memory, and nothing comes between.";
    Divergence = "divergence" "A barrier that not all invocations of a workgroup reach.";
    SubgroupWidth = "subgroup_width" "What a dispatch gives depends on how many invocations make a subgroup.";
    Order = "order" "What a dispatch gives depends on the order in which invocations come to atomic functions.";
    IllConditioned = "ill_conditioned" "Rounding is enlarged so much that an output has few right digits.";
    ZeroCrossing = "zero_crossing" "An output crosses zero, where no formula keeps all of its digits.";
    TooLarge = "too_large" "An output is too large for binary32.";
    RoundingOrder = "rounding_order" "An output is made of rounding errors, which a device may regroup away.";
    MediumpOverflow = "mediump_overflow" "A value is too large for `mediump`.";
    MediumpUnderflow = "mediump_underflow" "A value is so small that `mediump` takes it for 0.";
    MediumpDigits = "mediump_digits" "An operation needs digits that `mediump` does not have.";
}

impl FuzzFindingKind {
    /// Whether it is about a lane, and not about the function.
    pub fn is_of_a_lane(self) -> bool {
        matches!(self, Self::LaneDeviation | Self::NotDeterministic | Self::Disturbed | Self::LaneFailed)
    }

    /// How bad it is, by the samples that show it that say most, and where every input has a stated domain or not.
    pub fn severity(self, standing: Standing, stated: bool) -> Severity {
        match self {
            Self::LaneDeviation | Self::NotDeterministic | Self::Disturbed | Self::LaneFailed => Severity::Finding,
            // Dispatches are judged where they are run.
            Self::Race | Self::Divergence | Self::SubgroupWidth | Self::Order => Severity::Finding,
            Self::NoValue
            | Self::Infinite
            | Self::Overflow
            | Self::Underflow
            | Self::Lost
            | Self::NotWritten
            | Self::Unset
            | Self::TooManyVertices => match standing {
                Standing::Counts => Severity::Finding,
                Standing::Unstated => Severity::Warning,
                Standing::Extreme => Severity::Note,
            },
            Self::IllConditioned
            | Self::RoundingOrder
            | Self::MediumpOverflow
            | Self::MediumpUnderflow
            | Self::MediumpDigits => match standing {
                Standing::Counts | Standing::Unstated => Severity::Warning,
                Standing::Extreme => Severity::Note,
            },
            Self::ZeroCrossing => Severity::Note,
            // What whole numbers a function takes, and how large its results may be, only its author knows.
            Self::Undefined
            | Self::Index
            | Self::DivisionByZero
            | Self::Shift
            | Self::Conversion
            | Self::IntegerOverflow
            | Self::TooLarge
            | Self::Endless => {
                if stated {
                    Severity::Finding
                } else {
                    Severity::Note
                }
            }
        }
    }
}

/// How bad something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Severity {
    /// Wrong: the run fails.
    Finding,
    /// Worth a look; the run does not fail.
    Warning,
    /// For inputs alone that may never come, or worth knowing and no fault.
    Note,
}

impl Severity {
    /// `finding`, `warning` or `note`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Finding => "finding",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

/// The part of a run that something was found in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Part {
    /// Inputs that are stated, or as a program would give them.
    #[default]
    Realistic,
    /// Inputs that nobody stated: zeros, coincidences, edges, extremes.
    Arbitrary,
}

impl Part {
    /// `realistic` or `arbitrary`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Realistic => "realistic",
            Self::Arbitrary => "arbitrary",
        }
    }
}

/// One thing that was found.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Finding {
    /// Kind of the finding, which decides its name in reports.
    pub kind: FuzzFindingKind,
    /// How bad it is.
    pub severity: Severity,
    /// The part of the run that shows it.
    #[serde(default)]
    pub part: Part,
    /// What findings at one cause have in common, such as `division by 0`; none for what concerns a lane.
    #[serde(default)]
    pub cause: Option<String>,
    /// One sentence without a full stop.
    pub message: String,
    /// Where it stands in the author's file, with the text there.
    pub place: Option<Place>,
    /// The lane, for what concerns one.
    #[serde(with = "lanes::known::option")]
    pub lane: Option<LaneName>,
    /// Samples that show it.
    pub count: u64,
    /// How many of these count: inputs that are stated or realistic; of moderate size in a run on arbitrary inputs alone.
    pub counting: u64,
    /// The smallest inputs that show it.
    pub inputs: Vec<InputValue>,
    /// The output that shows it.
    pub output: Option<String>,
    /// What the output means in real numbers.
    #[serde(with = "base::value::exact::option")]
    pub meaning: Option<f64>,
    /// Bits of what binary32, or the lane, gives.
    pub found: Option<u32>,
    /// As what these bits are read.
    #[serde(default = "real")]
    pub scalar: Scalar,
    /// By how much the operation enlarges relative errors.
    #[serde(with = "base::value::exact::option")]
    pub condition: Option<f64>,
    /// Of what loses digits: the largest error of strict binary32, as part of the output's size, and the
    /// inputs that show it.
    #[serde(with = "base::value::exact::beside")]
    pub worst: Option<(f64, Vec<InputValue>)>,
    /// Other operations of the function with the same cause, each with the samples that show it.
    #[serde(default)]
    pub also: Vec<(Place, u64)>,
    /// Where a deviation of a lane comes from.
    pub diagnosis: Option<Diagnosis>,
    /// A command that shows it again.
    pub reproduce: Option<String>,
    /// True for a deviation of a lane that comes from the translator which this tool puts between a text and a driver.
    #[serde(default)]
    pub own_translator: bool,
    /// A formula that loses fewer bits, of what loses digits.
    #[serde(default)]
    pub better: Option<String>,
}

/// What outputs are where nothing else is said.
fn real() -> Scalar {
    Scalar::F32
}

impl Finding {
    /// True for what whole dispatches showed: the values say what a host did.
    pub fn is_of_dispatch(&self) -> bool {
        self.inputs.first().is_some_and(|input| input.name == WORKGROUPS)
    }
}

/// What the first value of a finding in a dispatch is called.
pub const WORKGROUPS: &str = "workgroups";

/// What one lane gave.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LaneReport {
    /// Name of the lane.
    #[serde(with = "lanes::known")]
    pub lane: LaneName,
    /// How many realistic samples agree, deviate and are undetermined, and the first that deviate; all samples where
    /// a run has no other part.
    pub verdicts: BatchVerdict,
    /// The same for the second part of the run.
    #[serde(default)]
    pub arbitrary: BatchVerdict,
    /// Why it did not run.
    pub not_run: Option<String>,
}

/// What came of one function.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FunctionReport {
    /// Name of the function.
    pub function: String,
    /// `name:line:column`.
    pub at: String,
    /// Samples that were looked at, of both parts.
    pub samples: u64,
    /// How many of these are of the second part, on inputs that nobody stated.
    #[serde(default)]
    pub arbitrary: u64,
    /// Samples beside these that lie at edges of what the function decides.
    pub edges: u64,
    /// Dispatches of a compute stage, with several workgroups and buffers of several sizes.
    #[serde(default)]
    pub dispatches: u64,
    /// Why a compute stage was not dispatched.
    #[serde(default)]
    pub not_dispatched: Option<String>,
    /// Why it was not run.
    pub not_run: Option<String>,
    /// Each input, type and name, with what is stated of it.
    pub inputs: Vec<(String, Vec<Law>)>,
    /// What each input is taken for where nothing is stated; empty where that does not matter.
    #[serde(default)]
    pub taken_for: Vec<Option<String>>,
    /// Inputs that are in [0, 1] in every sample, since their names say so.
    #[serde(default)]
    pub presumed: Vec<String>,
    /// What samplers were bound to, one line each.
    pub textures: Vec<String>,
    /// Built-in values that are 0 in every sample: a compute stage is run as the first invocation of a dispatch, alone.
    #[serde(default)]
    pub first_of_dispatch: Vec<String>,
    /// The largest error of strict binary32 on samples that count, as part of the output's size.
    #[serde(with = "base::value::exact")]
    pub max_error: f64,
    /// What each lane gave, in the order of the run.
    pub lanes: Vec<LaneReport>,
    /// What was found, the worst first.
    pub findings: Vec<Finding>,
}

impl FunctionReport {
    /// Takes findings for warnings, where what a host gives the function is not known. What a lane is blamed for stays.
    pub fn as_warnings(&mut self) {
        use FuzzFindingKind::{Disturbed, LaneDeviation, LaneFailed, NotDeterministic};
        let of_lanes = [LaneDeviation, NotDeterministic, Disturbed, LaneFailed];
        for finding in self.findings.iter_mut().filter(|own| !of_lanes.contains(&own.kind)) {
            if finding.severity == Severity::Finding {
                finding.severity = Severity::Warning;
            }
        }
    }

    /// Takes findings of a kind for notes, where what was taken for something makes them of a text that is right.
    pub fn as_notes(&mut self, kind: FuzzFindingKind) {
        let all = self.findings.iter_mut().filter(|own| own.kind == kind);
        all.for_each(|own| own.severity = Severity::Note);
        self.findings.sort_by_key(|finding| (finding.severity, finding.kind));
    }

    /// Nothing found yet, of a function.
    pub(super) fn nothing(subject: &Subject) -> Self {
        Self {
            function: subject.label.clone(),
            at: subject.at.clone(),
            samples: 0,
            arbitrary: 0,
            edges: 0,
            dispatches: 0,
            not_dispatched: None,
            not_run: None,
            inputs: Vec::new(),
            taken_for: Vec::new(),
            presumed: Vec::new(),
            textures: Vec::new(),
            first_of_dispatch: Vec::new(),
            max_error: 0.0,
            lanes: Vec::new(),
            findings: Vec::new(),
        }
    }

    /// Findings of one severity, the worst first.
    pub fn of(&self, severity: Severity) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |f| f.severity == severity)
    }

    /// True when the run of this function fails.
    pub fn fails(&self) -> bool {
        self.of(Severity::Finding).next().is_some()
    }

    /// True where a lane ran it, or its dispatches were looked at.
    pub fn ran(&self) -> bool {
        let on_a_lane = || self.lanes.is_empty() || self.lanes.iter().any(|lane| lane.not_run.is_none());
        self.not_run.is_none() && (self.dispatches > 0 || on_a_lane())
    }

    /// Why little is known of a function in which nothing is wrong: what leaves most samples undetermined, where that is more
    /// than half of them on every lane that ran it. The same makes a suite weak.
    pub fn weak(&self) -> Option<Reason> {
        let mut ran = self.lanes.iter().map(|lane| &lane.verdicts).filter(|verdicts| verdicts.seen() > 0).peekable();
        ran.peek()?;
        let mut reasons = [0_u64; Reason::ALL.len()];
        for verdicts in ran {
            if verdicts.undetermined_count() <= verdicts.agreed + verdicts.deviated {
                return None;
            }
            reasons.iter_mut().zip(verdicts.undetermined).for_each(|(sum, n)| *sum += n);
        }
        let most = (0..reasons.len()).rev().max_by_key(|&k| reasons[k])?;
        (!self.fails()).then_some(Reason::ALL[most])
    }

    /// True where notes are all that was found out: they are told whether or not notes are asked for.
    pub fn tells_notes(&self) -> bool {
        self.weak().is_some() && self.findings.iter().all(|finding| finding.severity == Severity::Note)
    }
}
