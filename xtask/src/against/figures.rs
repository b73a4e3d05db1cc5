//! What the two sides print, and the table that is made of it.

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

/// What one run of the script printed. Times are in seconds, one for each repetition.
#[derive(Debug, PartialEq)]
pub struct Timing {
    pub samples: u64,
    /// Making inputs and all of `judge_only`.
    pub end_to_end: Vec<f64>,
    /// Running, reading back, computing the reference and comparing.
    pub judge_only: Vec<f64>,
}

impl Timing {
    /// Samples a second in the fastest repetition.
    pub fn rate(&self, times: &[f64]) -> f64 {
        self.samples as f64 / times.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Reads what the script prints with `--json`.
///
/// # Errors
/// When it is something else, lacks a time, or reports samples that disagree: the time of a run that
/// finds faults in a right shader is worth nothing.
pub fn timing(text: &str) -> Result<Timing> {
    let json: Value = serde_json::from_str(text)?;
    let count = |key: &str| json[key].as_u64().with_context(|| format!("`{key}` is missing"));
    let times = |key: &str| {
        let times: Option<Vec<f64>> = json[key].as_array().and_then(|list| list.iter().map(Value::as_f64).collect());
        times
            .filter(|times| !times.is_empty() && times.iter().all(|&t| t > 0.0))
            .with_context(|| format!("`{key}` is no list of times"))
    };
    let disagreed = disagreed(text)?;
    ensure!(disagreed == 0, "{disagreed} samples disagree in the script");
    Ok(Timing { samples: count("samples")?, end_to_end: times("end_to_end")?, judge_only: times("judge_only")? })
}

/// Reads how many samples disagree in the script.
///
/// # Errors
/// When the text is not what the script prints.
pub fn disagreed(text: &str) -> Result<u64> {
    let json: Value = serde_json::from_str(text)?;
    json["disagreed"].as_u64().context("`disagreed` is missing")
}

/// Reads how many samples `shadercheck check --format json` judged.
///
/// # Errors
/// When the text is something else, or the run did not pass.
pub fn judged(text: &str) -> Result<u64> {
    let json: Value = serde_json::from_str(text)?;
    ensure!(json["status"] == "pass", "the status is {}", json["status"]);
    json["totals"]["judged"].as_u64().context("`totals.judged` is missing")
}

/// The executable among cargo's messages, of which each line is one.
pub fn executable(messages: &str) -> Option<PathBuf> {
    let mut messages = messages.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    messages.find_map(|message| message["executable"].as_str().map(PathBuf::from))
}

/// Judged samples a second, one entry a round; entries of one round stand at one index.
#[derive(Debug, Default)]
pub struct Rates {
    /// `check`: both stages.
    pub check: Vec<f64>,
    /// `check --stage vertex`.
    pub stage: Vec<f64>,
    /// The script with its inputs made.
    pub end_to_end: Vec<f64>,
    /// The script on ready-made inputs.
    pub judge_only: Vec<f64>,
}

impl Rates {
    /// A table in millions a second, and the ratios within each round.
    pub fn table(&self, suite: &str) -> String {
        let millions = |rates: &[f64]| rates.iter().map(|r| r / 1e6).collect::<Vec<_>>();
        let ratio = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a / b).collect::<Vec<_>>();
        let lines = [
            ("shadercheck check", millions(&self.check)),
            ("shadercheck check --stage vertex", millions(&self.stage)),
            ("script, end to end", millions(&self.end_to_end)),
            ("script, judge only", millions(&self.judge_only)),
            ("ratio check / script end to end", ratio(&self.check, &self.end_to_end)),
            ("ratio vertex / script end to end", ratio(&self.stage, &self.end_to_end)),
            ("ratio vertex / script judge only", ratio(&self.stage, &self.judge_only)),
        ];
        let mut out = format!("\n{suite}\n");
        for (name, mut values) in lines {
            values.sort_by(f64::total_cmp);
            if let [lowest, .., highest] | [lowest @ highest] = values[..] {
                // Writing to a string cannot fail.
                let _ = writeln!(
                    out,
                    "  {name:<34} {highest:>7.2}  {:>7.2}  {lowest:>7.2} to {highest:.2}",
                    median(&values)
                );
            }
        }
        out
    }
}

/// The median of sorted values.
fn median(sorted: &[f64]) -> f64 {
    let half = sorted.len() / 2;
    if sorted.len().is_multiple_of(2) { f64::midpoint(sorted[half - 1], sorted[half]) } else { sorted[half] }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRINTED: &str = r#"{"shader": "sphere", "renderer": "llvmpipe", "samples": 4096,
        "disagreed": 0, "end_to_end": [0.004, 0.002], "judge_only": [0.0015, 0.001]}"#;

    #[test]
    fn the_output_of_the_script_is_read() {
        let timing = timing(PRINTED).unwrap();
        assert_eq!(timing, Timing { samples: 4096, end_to_end: vec![0.004, 0.002], judge_only: vec![0.0015, 0.001] });
        assert_eq!(timing.rate(&timing.end_to_end), 2_048_000.0);
        assert_eq!(timing.rate(&timing.judge_only), 4_096_000.0);
    }

    #[test]
    fn times_of_a_failing_or_broken_script_are_refused() {
        let message = |from: &str, to: &str| {
            assert!(PRINTED.contains(from), "{from}");
            timing(&PRINTED.replace(from, to)).unwrap_err().to_string()
        };
        assert_eq!(message(r#""disagreed": 0"#, r#""disagreed": 3"#), "3 samples disagree in the script");
        assert_eq!(message(r#""disagreed": 0,"#, ""), "`disagreed` is missing");
        assert_eq!(message("[0.004, 0.002]", "[]"), "`end_to_end` is no list of times");
        assert_eq!(message("0.001]", "0.0]"), "`judge_only` is no list of times");
        assert_eq!(message("0.001]", "null]"), "`judge_only` is no list of times");
        assert!(timing("Traceback").is_err());
        assert_eq!(disagreed(&PRINTED.replace(": 0", ": 3")).unwrap(), 3);
    }

    #[test]
    fn judged_samples_count_only_when_the_run_passed() {
        let printed = r#"{"status": "pass", "totals": {"judged": 32}}"#;
        assert_eq!(judged(printed).unwrap(), 32);
        assert!(judged(&printed.replace("pass", "fail")).is_err());
        assert!(judged(&printed.replace("judged", "agreed")).is_err());
    }

    #[test]
    fn the_executable_is_found_among_the_messages() {
        let messages = "{\"reason\":\"compiler-artifact\",\"executable\":null}\n\
                        {\"reason\":\"compiler-artifact\",\"executable\":\"target/release/shadercheck\"}\n";
        assert_eq!(executable(messages), Some("target/release/shadercheck".into()));
        assert_eq!(executable("{\"executable\":null}"), None);
    }

    #[test]
    fn the_table_has_the_best_the_median_and_the_range_and_pairs_rounds() {
        let rates = Rates {
            check: vec![1e6, 4e6],
            stage: vec![2e6, 3e6],
            end_to_end: vec![4e6, 2e6],
            judge_only: vec![5e6, 5e6],
        };
        let table = rates.table("sphere");
        let row = |name: &str| {
            let line = table.lines().find(|line| line.trim_start().starts_with(name)).unwrap();
            line.trim_start()[name.len()..].split_whitespace().collect::<Vec<_>>().join(" ")
        };
        assert_eq!(row("script, end to end"), "4.00 3.00 2.00 to 4.00");
        // 1/4 and 4/2, not the ratio of the best.
        assert_eq!(row("ratio check / script end to end"), "2.00 1.12 0.25 to 2.00");
        assert_eq!(row("ratio vertex / script judge only"), "0.60 0.50 0.40 to 0.60");
    }
}
