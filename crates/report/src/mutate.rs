//! Reports of `shadercheck mutate`.

use std::fmt::Write as _;

use serde_json::{Value, json};

use engine::mutate::operators::{CONSTANT_ULP, registry};
use engine::mutate::{Kill, Outcome, Score, SuiteResult, Tested};

/// What a run of `mutate` found.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Seed of the inputs.
    pub seed: u64,
    /// Lane and driver.
    pub lane: String,
    /// The suites in order.
    pub suites: Vec<SuiteResult>,
    /// Suites for which no score can be given: name, and why.
    pub failed: Vec<(String, String)>,
}

impl Summary {
    fn tested(&self) -> impl Iterator<Item = &Tested> {
        self.suites.iter().flat_map(|s| &s.tested)
    }

    /// All mutants of all suites, counted.
    pub fn score(&self) -> Score {
        Score::of(self.tested())
    }

    /// The same without the mutants that move a literal by one ULP.
    pub fn score_above_ulp(&self) -> Score {
        Score::of(self.tested().filter(|t| t.operator != CONSTANT_ULP))
    }
}

/// The report for people: survivors with their diffs, then a table of suites and one of operators.
pub fn text(summary: &Summary) -> String {
    let mut text = String::new();
    for suite in &summary.suites {
        survivors(&mut text, suite);
    }
    let _ = writeln!(text, "{}", heading("suite"));
    for suite in &summary.suites {
        let _ = writeln!(text, "{}", row(&suite.suite, suite.score(), suite.score_above_ulp()));
    }
    if summary.suites.len() > 1 {
        let _ = writeln!(text, "{}", row("all", summary.score(), summary.score_above_ulp()));
    }
    let _ = writeln!(text, "\n{}  killed by", heading("operator").trim_end_matches("above ULP").trim_end());
    for operator in registry() {
        let of: Vec<&Tested> = summary.tested().filter(|t| t.operator == operator.name).collect();
        if of.is_empty() {
            continue;
        }
        let score = Score::of(of.iter().copied());
        let row = row(operator.name, score, Score::default());
        let line = format!("{}  {}", row.trim_end_matches('-').trim_end(), checks(&of));
        let _ = writeln!(text, "{}", line.trim_end());
    }
    for (suite, why) in &summary.failed {
        let _ = writeln!(text, "\nerror: {suite}: {why}");
    }
    let samples = summary.suites.iter().map(|s| s.samples).max().unwrap_or(0);
    let (all, above) = (summary.score(), summary.score_above_ulp());
    let _ = writeln!(
        text,
        "\n{} of {} mutants that moved an output were killed, {}, at {samples} samples on {}; {} without {CONSTANT_ULP}; {} with unmoved ones as survivors",
        all.killed,
        all.killed + all.survived,
        percent(all.share()),
        summary.lane,
        percent(above.share()),
        percent(all.pessimistic()),
    );
    text
}

const COLUMNS: [&str; 6] = ["mutants", "killed", "survived", "unmoved", "equivalent", "invalid"];

fn heading(first: &str) -> String {
    let counts: Vec<String> = COLUMNS.iter().map(|c| format!("{c:>10}")).collect();
    format!("{first:<16}  {}  {:>8}  above ULP", counts.join(" "), "score")
}

fn row(name: &str, score: Score, above: Score) -> String {
    let counts = [score.all(), score.killed, score.survived, score.unmoved, score.equivalent, score.invalid];
    let counts: Vec<String> = counts.iter().map(|c| format!("{c:>10}")).collect();
    format!("{name:<16}  {}  {:>8}  {:>9}", counts.join(" "), percent(score.share()), percent(above.share()))
}

/// Rounded down, so that only a score without survivors shows as 100 %.
fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", (share * 1000.0).floor() / 10.0))
}

/// Which checks killed mutants, the busiest first.
fn checks(tested: &[&Tested]) -> String {
    let mut counts: Vec<(usize, &str)> = Kill::NAMES
        .iter()
        .map(|name| {
            let by = |t: &&&Tested| matches!(&t.outcome, Outcome::Killed(kill) if kill.name() == *name);
            (tested.iter().filter(by).count(), *name)
        })
        .filter(|(count, _)| *count > 0)
        .collect();
    counts.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    let parts: Vec<String> = counts.iter().map(|(count, name)| format!("{name} {count}")).collect();
    parts.join(", ")
}

/// Everything that was not killed, in the order of the mutants; small literals at the end, in one
/// line each, since they are many and expected.
fn survivors(text: &mut String, suite: &SuiteResult) {
    let left: Vec<&Tested> = suite.tested.iter().filter(|t| !matches!(t.outcome, Outcome::Killed(_))).collect();
    let (small, large): (Vec<&Tested>, Vec<&Tested>) = left.into_iter().partition(|t| t.operator == CONSTANT_ULP);
    for tested in large {
        let _ = writeln!(text, "{} {}", head(suite, tested), fate(&tested.outcome));
        for line in tested.diff.lines().skip(2) {
            let _ = writeln!(text, "    {line}");
        }
        text.push('\n');
    }
    for tested in &small {
        let _ = writeln!(text, "{} {}", head(suite, tested), fate(&tested.outcome));
    }
    if !small.is_empty() {
        text.push('\n');
    }
}

fn head(suite: &SuiteResult, tested: &Tested) -> String {
    format!("{}:{}:{}: {}: {}:", suite.shader, tested.line, tested.column, tested.operator, tested.what)
}

fn fate(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Killed(kill) => format!("killed by {}", kill.name()),
        Outcome::Survived(movement) => match &movement.component {
            Some(component) => {
                format!("survived; {component} moved by {:.2} of what a lane may be off at most", movement.bounds)
            }
            None => "survived; outputs moved only where nothing is judged".to_owned(),
        },
        Outcome::Unmoved => "unmoved: every output means the same on all samples".to_owned(),
        Outcome::Equivalent(why) => format!("equivalent: {why}"),
        Outcome::Invalid(why) => format!("invalid: {why}"),
    }
}

/// The report for programs: one JSON object with a line break. Keys may be added, and are never
/// renamed.
pub fn json(summary: &Summary) -> String {
    let suites: Vec<Value> = summary
        .suites
        .iter()
        .map(|suite| {
            json!({
                "suite": suite.suite,
                "shader": suite.shader,
                "samples": suite.samples,
                "score": score(suite.score()),
                "score_above_ulp": score(suite.score_above_ulp()),
                "mutants": suite.tested.iter().map(mutant).collect::<Vec<_>>(),
            })
        })
        .collect();
    let failed: Vec<Value> =
        summary.failed.iter().map(|(suite, why)| json!({"suite": suite, "message": why})).collect();
    let value = json!({
        "seed": summary.seed,
        "lane": summary.lane,
        "suites": suites,
        "failed": failed,
        "score": score(summary.score()),
        "score_above_ulp": score(summary.score_above_ulp()),
    });
    format!("{value:#}\n")
}

fn score(score: Score) -> Value {
    json!({
        "mutants": score.all(),
        "killed": score.killed,
        "survived": score.survived,
        "unmoved": score.unmoved,
        "equivalent": score.equivalent,
        "invalid": score.invalid,
        "share": score.share(),
        "share_with_unmoved": score.pessimistic(),
    })
}

fn mutant(tested: &Tested) -> Value {
    let mut value = json!({
        "operator": tested.operator,
        "what": tested.what,
        "line": tested.line,
        "column": tested.column,
        "outcome": tested.outcome.name(),
        "samples": tested.samples,
        "diff": tested.diff,
    });
    match &tested.outcome {
        Outcome::Killed(kill) => {
            value["killed_by"] = kill.name().into();
            match kill {
                Kill::Formula(reported) | Kill::Shape(reported) => value["message"] = reported.as_str().into(),
                Kill::MissingOutput(name) => value["output"] = name.as_str().into(),
                Kill::Relation(name) => value["relation"] = name.as_str().into(),
                Kill::NotFinished | Kill::Coverage => {}
            }
        }
        Outcome::Survived(movement) => {
            value["moved_samples"] = movement.samples.into();
            value["moved_component"] = movement.component.clone().into();
            // JSON has no infinity.
            value["moved_bounds"] = if movement.bounds.is_finite() { movement.bounds.into() } else { Value::Null };
        }
        Outcome::Unmoved => {}
        Outcome::Equivalent(why) => value["message"] = why.as_ref().into(),
        Outcome::Invalid(why) => value["message"] = why.as_str().into(),
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::verdict::Movement;

    fn summary() -> Summary {
        let tested = |operator, outcome| Tested {
            operator,
            what: "`+` becomes `-`".into(),
            line: 3,
            column: 5,
            diff: "--- a\n+++ b\n@@ -3 +3 @@\n-x + y\n+x - y\n".into(),
            outcome,
            samples: 7,
        };
        let moved = Movement { samples: 4, bounds: 0.25, component: Some("gl_Position.x".into()) };
        let suite = SuiteResult {
            suite: "sphere".into(),
            shader: "sphere.vert".into(),
            samples: 512,
            tested: vec![
                tested("arithmetic", Outcome::Killed(Kill::Relation("sphere_radius".to_owned()))),
                tested("arithmetic", Outcome::Survived(moved.clone())),
                tested("constant-ulp", Outcome::Survived(moved)),
                tested("sign", Outcome::Invalid("it does not compile".into())),
            ],
        };
        Summary { seed: 1, lane: "soft".into(), suites: vec![suite], failed: vec![("bent".into(), "no".into())] }
    }

    #[test]
    fn the_text_shows_survivors_with_their_diff_and_how_far_they_moved() {
        let text = text(&summary());
        for part in [
            "sphere.vert:3:5: arithmetic: `+` becomes `-`: survived; gl_Position.x moved by 0.25 of what a lane may be off at most",
            "    +x - y",
            "invalid: it does not compile",
            "relation 1",
            "error: bent: no",
            "1 of 3 mutants that moved an output were killed, 33.3 %, at 512 samples on soft; 50.0 % without constant-ulp",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        assert_eq!(text.matches("+x - y").count(), 2, "small literals come without a diff\n{text}");
    }

    #[test]
    fn the_json_has_every_mutant_with_its_outcome() {
        let value: Value = serde_json::from_str(&json(&summary())).unwrap();
        assert_eq!(value["score"]["survived"], 2);
        assert_eq!(value["suites"][0]["mutants"][0]["relation"], "sphere_radius");
        assert_eq!(value["suites"][0]["mutants"][1]["moved_bounds"], 0.25);
        assert_eq!(value["failed"][0]["suite"], "bent");
    }

    #[test]
    fn a_score_with_a_survivor_never_shows_as_all() {
        assert_eq!(percent(Some(0.9999)), "99.9 %");
        assert_eq!(percent(Some(1.0)), "100.0 %");
    }
}
