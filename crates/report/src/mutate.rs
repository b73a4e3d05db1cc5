//! Reports of `shadercheck mutate`.

use std::collections::BTreeMap;
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

/// The report for people: the score, a table of suites and one of operators, then what survived.
pub fn text(summary: &Summary) -> String {
    let samples = summary.suites.iter().map(|s| s.samples).max().unwrap_or(0);
    let (all, above) = (summary.score(), summary.score_above_ulp());
    let mut text = format!(
        "{} of {} mutants that moved an output were killed, {}, at {samples} samples on {}; {} without {CONSTANT_ULP}; {} with unmoved ones as survivors\n\n",
        all.killed,
        all.killed + all.survived,
        percent(all.share()),
        summary.lane,
        percent(above.share()),
        percent(all.pessimistic()),
    );
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
    for suite in &summary.suites {
        survivors(&mut text, suite);
    }
    for (suite, why) in &summary.failed {
        let _ = writeln!(text, "\nerror: {suite}: {why}");
    }
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

/// Everything that was not killed, by the lines of the shader: each line once, with one line for each mutant of it.
fn survivors(text: &mut String, suite: &SuiteResult) {
    let mut by_line: BTreeMap<usize, Vec<&Tested>> = BTreeMap::new();
    for tested in suite.tested.iter().filter(|t| !matches!(t.outcome, Outcome::Killed(_))) {
        by_line.entry(tested.line).or_default().push(tested);
    }
    for (line, mutants) in by_line {
        let own = mutants[0].diff.lines().skip(2).find_map(|line| line.strip_prefix('-'));
        let _ = writeln!(text, "\n{}:{line}: {}", suite.shader, own.unwrap_or_default().trim());
        for tested in mutants {
            let Tested { column, operator, what, outcome, .. } = tested;
            let _ = writeln!(text, "  {column}: {operator}: {what}: {}", fate(outcome));
        }
    }
}

fn fate(outcome: &Outcome) -> String {
    match outcome {
        Outcome::Killed(kill) => format!("killed by {}", kill.name()),
        Outcome::Survived(movement) => match &movement.component {
            Some(component) if movement.bounds.is_finite() => {
                format!(
                    "survived; `{component}` changes by up to {} times the largest error of a lane",
                    times(movement.bounds)
                )
            }
            Some(component) => format!("survived; `{component}` has no finite value any more"),
            None => "survived; outputs change only where nothing is judged".to_owned(),
        },
        Outcome::Unmoved => "unmoved: every output means the same on all samples".to_owned(),
        Outcome::Equivalent(why) => format!("equivalent: {why}"),
        Outcome::Invalid(why) => format!("invalid: {why}"),
    }
}

/// A factor with as many digits as anyone reads.
fn times(factor: f64) -> String {
    match factor {
        _ if factor >= 1e6 => format!("{factor:.0e}"),
        _ if factor >= 100.0 => format!("{factor:.0}"),
        _ => format!("{factor:.2}"),
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
                Kill::Test(name) => value["test"] = name.as_str().into(),
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
    fn the_text_begins_with_the_score_and_shows_survivors_by_their_lines() {
        let text = text(&summary());
        for part in [
            "\nsphere.vert:3: x + y\n",
            "  5: arithmetic: `+` becomes `-`: survived; `gl_Position.x` changes by up to 0.25 times the largest error of a lane\n",
            "invalid: it does not compile",
            "relation 1",
            "error: bent: no",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        let score = "1 of 3 mutants that moved an output were killed, 33.3 %, at 512 samples on soft; 50.0 % without constant-ulp";
        assert!(text.starts_with(score), "{text}");
        assert_eq!(text.matches("x + y").count(), 1, "a line stands once\n{text}");
    }

    #[test]
    fn a_distance_is_told_with_the_digits_that_count() {
        let told = |bounds| fate(&Outcome::Survived(Movement { samples: 1, bounds, component: Some("c.x".into()) }));
        assert!(told(278_473_557_097.02).contains("up to 3e11 times"), "{}", told(278_473_557_097.02));
        assert!(told(13_714.07).contains("up to 13714 times"));
        assert_eq!(told(f64::INFINITY), "survived; `c.x` has no finite value any more");
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
