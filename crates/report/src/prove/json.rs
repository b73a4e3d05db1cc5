//! The report for programs. Keys may be added; none is renamed.

use serde::Serialize;

use super::Summary;
use crate::fuzz::{Input, inputs};
use base::text::Location;
use engine::fuzz::Finding;
use engine::prove::{Judged, ProofReport, Verdict};

#[derive(Serialize)]
struct Root<'a> {
    kernels: Vec<Kernel<'a>>,
    not_run: Vec<NotRun<'a>>,
}

#[derive(Serialize)]
struct NotRun<'a> {
    function: &'a str,
    why: &'a str,
}

#[derive(Serialize)]
struct Kernel<'a> {
    function: &'a str,
    at: &'a str,
    memories: Vec<Memory<'a>>,
    /// What is assumed of its numbers.
    assumptions: &'a [String],
    /// Barriers of which each can go.
    idle_barriers: Vec<&'a Location>,
    /// Dispatches beside the proof.
    dispatches: u64,
}

#[derive(Serialize)]
struct Memory<'a> {
    name: &'a str,
    /// `buffer`, `workgroup`, `image` or `uniform`.
    kind: &'a str,
    /// `verified`, `not_decided` or `fault`.
    verdict: &'static str,
    /// Of what is verified, what a host has to keep to.
    conditions: &'a [String],
    /// Why it is not decided, or what the fault is.
    message: Option<&'a str>,
    at: Option<&'a Location>,
    /// Of what is not decided, a dispatch that may never be made in which invocations meet.
    example: Option<Shown<'a>>,
    /// A dispatch shows a fault of what is proved: a defect of the proof.
    contradicted: bool,
    inputs: Vec<Input<'a>>,
}

#[derive(Serialize)]
struct Shown<'a> {
    message: &'a str,
    inputs: Vec<Input<'a>>,
}

/// The report as one object, with a line break.
pub fn json(summary: &Summary) -> String {
    let not_run = summary.not_run.iter().map(|(function, why)| NotRun { function, why }).collect();
    let root = Root { kernels: summary.kernels.iter().map(one).collect(), not_run };
    serde_json::to_string_pretty(&root).unwrap_or_default() + "\n"
}

fn one(kernel: &ProofReport) -> Kernel<'_> {
    Kernel {
        function: &kernel.function,
        at: &kernel.at,
        memories: kernel.memories.iter().map(memory).collect(),
        assumptions: &kernel.assumptions,
        idle_barriers: kernel.idle.iter().map(|place| &place.at).collect(),
        dispatches: kernel.dispatches,
    }
}

fn memory(own: &Judged) -> Memory<'_> {
    let none = Memory {
        name: &own.name,
        kind: own.kind,
        verdict: "verified",
        conditions: &[],
        message: None,
        at: None,
        example: None,
        contradicted: own.contradicted,
        inputs: Vec::new(),
    };
    match &own.verdict {
        Verdict::Verified { conditions } => Memory { conditions, ..none },
        Verdict::Undecided { why, place, example } => Memory {
            verdict: "not_decided",
            message: Some(why),
            at: place.as_ref().map(|place| &place.at),
            example: example.as_deref().map(shown),
            ..none
        },
        Verdict::Fault(finding) => Memory {
            verdict: "fault",
            message: Some(&finding.message),
            at: finding.place.as_ref().map(|place| &place.at),
            inputs: inputs(&finding.inputs),
            ..none
        },
    }
}

fn shown(finding: &Finding) -> Shown<'_> {
    Shown { message: &finding.message, inputs: inputs(&finding.inputs) }
}
