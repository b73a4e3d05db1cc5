//! `markdown`: a summary for the page of a CI job.

use std::fmt::Write;

use super::{Format, Run, escaped};
use base::diagnostic::Severity;

/// The format.
pub const FORMAT: Format = Format {
    name: "markdown",
    summary: "A summary for the page of a CI job",
    file: "summary.md",
    write: |run| Ok(markdown(run)),
};

/// Findings that are shown in full.
const SHOWN: usize = 20;

/// Totals and tables, and the findings.
fn markdown(run: &Run) -> String {
    let mut text = format!("## shadercheck {}\n\n{}", run.outcome, run.summary);
    for (severity, title) in [(Severity::Error, "Findings"), (Severity::Warning, "Warnings")] {
        let of: Vec<_> = run.items.iter().filter(|item| item.severity == severity).collect();
        if of.is_empty() {
            continue;
        }
        // Writing into a String does not fail.
        let _ = write!(text, "\n### {title}\n");
        for item in of.iter().take(SHOWN) {
            // A fence that is longer than any in the text.
            let fence = "`".repeat(3 + item.details.matches("```").count());
            let _ = write!(
                text,
                "\n<details><summary>{}</summary>\n\n{fence}text\n{}\n{fence}\n</details>\n",
                escaped(&item.message),
                item.details.trim()
            );
        }
        if of.len() > SHOWN {
            let _ = writeln!(text, "\n{} more are in the other reports.", of.len() - SHOWN);
        }
    }
    text + &run.rest
}
