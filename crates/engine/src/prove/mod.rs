//! Races and bounds of compute stages for all sizes: what is proved, what is not decided, and what a dispatch shows.
//!
//! A proof is about the text alone. Beside it, the stage is dispatched in a few sizes: a fault is what a dispatch shows,
//! so that none is a false alarm, and one of what is said to be proved would be a defect of the proof.

use crate::activity;
use crate::dispatch::{Dispatched, Shown};
use crate::fuzz::{Finding, Severity, Subject, place};
use judge::verdict::diagnosis::Place;
use program::interp::group::{MemoryShape, Space};
use program::interp::proof::{MemoryProof, Undecided};

/// What is known of a memory of a kernel.
#[derive(Clone, Debug)]
pub enum Verdict {
    /// No two invocations get in each other's way, and every index lies in its array, for all sizes.
    Verified {
        /// What a host has to keep to, in words.
        conditions: Vec<String>,
    },
    /// Neither is shown.
    Undecided {
        /// Why not.
        why: String,
        /// Where that stands.
        place: Option<Place>,
        /// What a dispatch with numbers that no host may ever give shows.
        example: Option<Box<Finding>>,
    },
    /// A dispatch shows a fault.
    Fault(Box<Finding>),
}

/// A memory of a kernel.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Name of the variable.
    pub name: String,
    /// What it is: `buffer`, `workgroup`, `image` or `uniform`.
    pub kind: &'static str,
    /// What is known of it.
    pub verdict: Verdict,
    /// True where a dispatch shows a fault of what was proved without a condition: a defect of the proof.
    pub contradicted: bool,
}

/// What is known of a kernel.
#[derive(Clone, Debug)]
pub struct ProofReport {
    /// Name of the entry point.
    pub function: String,
    /// `name:line:column` of it.
    pub at: String,
    /// Its memories.
    pub memories: Vec<Judged>,
    /// What is assumed of its numbers, in words.
    pub assumptions: Vec<String>,
    /// Barriers that can go: without any one of them, the same is proved.
    pub idle: Vec<Place>,
    /// Dispatches beside the proof.
    pub dispatches: u64,
}

impl ProofReport {
    /// True where a dispatch shows a fault.
    pub fn has_faults(&self) -> bool {
        self.memories.iter().any(|own| matches!(own.verdict, Verdict::Fault(_)))
    }
}

/// Proves what it can of a compute stage.
pub fn run(subject: &Subject, dispatched: &Dispatched, command: &str) -> ProofReport {
    let _doing = activity::doing(format!("proves `{}`", subject.label));
    let proof = dispatched.executable.prove(dispatched.size);
    let (shown, dispatches) = dispatched.shown(command);
    let at = |site| place(&dispatched.program, &dispatched.executable, Some(site));
    let memories = proof.memories.iter().map(|own| judged(dispatched, own, &shown, command)).collect();
    let mut assumptions = proof.assumptions.clone();
    let axes: Vec<&str> = proof.single.iter().map(|axis| ["x", "y", "z"][*axis]).collect();
    if !axes.is_empty() && !proof.memories.is_empty() {
        assumptions.insert(0, format!("one workgroup is dispatched along {}", axes.join(", ")));
    }
    let constants = dispatched.program.constants.specialized();
    if !constants.is_empty() {
        let all: Vec<String> = constants.iter().map(|(name, value)| format!("`{name}` is {value}")).collect();
        assumptions.push(format!("of what a pipeline may set, {}", all.join(", ")));
    }
    ProofReport {
        function: subject.label.clone(),
        at: subject.at.clone(),
        memories,
        assumptions,
        idle: proof.idle.iter().filter_map(|site| at(*site)).collect(),
        dispatches,
    }
}

fn judged(dispatched: &Dispatched, own: &MemoryProof, shown: &[Shown], command: &str) -> Judged {
    let shape = &dispatched.executable.memories()[own.memory as usize];
    let fault = shown.iter().find(|fault| fault.memory == own.memory);
    let contradicted = fault.is_some_and(|fault| match &own.bounds {
        _ if fault.race => own.races.is_ok(),
        Ok(conditions) => conditions.is_empty(),
        Err(_) => false,
    });
    let verdict = match (fault, &own.races, &own.bounds) {
        (Some(fault), ..) if fault.finding.severity == Severity::Finding => {
            Verdict::Fault(Box::new(fault.finding.clone()))
        }
        // Whether a host keeps to a condition is its matter; one that does not is likely.
        (Some(fault), Ok(()), Ok(conditions)) => Verdict::Undecided {
            why: match conditions.is_empty() {
                true => "a dispatch shows something else".to_owned(),
                false => format!("nothing in the shader sees to it that {}", conditions.join(" and ")),
            },
            place: fault.finding.place.clone(),
            example: Some(Box::new(fault.finding.clone())),
        },
        (None, Ok(()), Ok(conditions)) => Verdict::Verified { conditions: conditions.clone() },
        (_, Err(why), _) | (_, _, Err(why)) => undecided(dispatched, own.memory, why, (fault, command)),
    };
    Judged { name: shape.name.clone(), kind: kind(shape), verdict, contradicted }
}

fn undecided(
    dispatched: &Dispatched,
    memory: u32,
    why: &Undecided,
    (shown, command): (Option<&Shown>, &str),
) -> Verdict {
    let worked_out = || why.numbers.as_ref().and_then(|numbers| dispatched.shown_with(numbers, memory, command));
    let example = shown.map(|shown| shown.finding.clone()).or_else(worked_out);
    // Numbers that were worked out are as good as any where the fault does not depend on how they lie to each other.
    if let Some(finding) = example.clone().filter(|finding| finding.severity == Severity::Finding) {
        return Verdict::Fault(Box::new(finding));
    }
    let place = place(&dispatched.program, &dispatched.executable, why.site);
    Verdict::Undecided { why: why.why.clone(), place, example: example.map(Box::new) }
}

fn kind(shape: &MemoryShape) -> &'static str {
    match shape.space {
        _ if shape.is_image() => "image",
        Space::Workgroup => "workgroup",
        Space::Storage { .. } => "buffer",
        Space::Uniform => "uniform",
    }
}
