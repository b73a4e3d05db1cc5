//! What is proved of compute stages.

mod json;
mod text;

pub use json::json;
pub use text::text;

use engine::prove::{ProofReport, Verdict};

/// What came of a run.
#[derive(Debug)]
pub struct Summary {
    /// Compute stages that were looked at.
    pub kernels: Vec<ProofReport>,
    /// Those that were not, with the reason.
    pub not_run: Vec<(String, String)>,
}

impl Summary {
    /// True where a dispatch shows a fault.
    pub fn has_findings(&self) -> bool {
        self.kernels.iter().any(ProofReport::has_faults)
    }

    /// Memories that are verified, not decided, and at fault.
    fn counts(&self) -> [usize; 3] {
        let mut counts = [0; 3];
        for own in self.kernels.iter().flat_map(|kernel| &kernel.memories) {
            counts[match own.verdict {
                Verdict::Verified { .. } => 0,
                Verdict::Undecided { .. } => 1,
                Verdict::Fault(_) => 2,
            }] += 1;
        }
        counts
    }
}
