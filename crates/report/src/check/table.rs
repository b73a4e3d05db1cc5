//! The table that a terminal shows: suites down, lanes across. The stages of a lane share a cell.

use super::text::Style;
use engine::suite::run::{Entry, Outcome, Report, Standing};

/// Most characters of the name of a suite.
const SUITE: usize = 20;
/// Characters of a mark.
const MARK: usize = 5;
/// Characters of a number of samples, with a blank before it.
const NUMBER: usize = 5;
/// Characters of an error, with a blank before it.
const ERROR: usize = 4;

/// A table of suites and lanes in a width.
pub struct Table {
    lanes: Vec<&'static str>,
    suite: usize,
    cell: usize,
}

/// The word of a cell.
fn word(standing: Standing) -> &'static str {
    match standing {
        Standing::LaneFailed => "LOST",
        other => other.word(),
    }
}

impl Table {
    /// A table with these lanes and suites that is at most `width` characters wide, as long as each lane has room
    /// for a mark.
    pub fn new<'s>(lanes: Vec<&'static str>, suites: impl Iterator<Item = &'s str>, width: usize) -> Self {
        let suite = suites.map(|name| name.chars().count()).max().unwrap_or_default().clamp(5, SUITE);
        let each = width.saturating_sub(suite) / lanes.len().max(1);
        let longest = lanes.iter().map(|name| name.len()).max().unwrap_or_default();
        // A blank before each cell, and no wider than what it can hold.
        let cell = each.saturating_sub(2).clamp(MARK - 1, longest.max(MARK + NUMBER + ERROR));
        Self { lanes, suite, cell }
    }

    /// The names of the lanes, and what their cells hold.
    pub fn head(&self, color: bool) -> String {
        let style = Style::new(color);
        let mut names = " ".repeat(self.suite);
        let mut what = " ".repeat(self.suite);
        let parts = match self.detail() {
            Detail::Mark => String::new(),
            Detail::Judged => format!("{:<MARK$}{:>NUMBER$}", "", "n"),
            Detail::All => format!("{:<MARK$}{:>NUMBER$}{:>ERROR$}", "", "n", "ULP"),
        };
        for lane in &self.lanes {
            names.push_str("  ");
            names.push_str(&fitted(lane, self.cell));
            what.push_str("  ");
            what.push_str(&fitted(&parts, self.cell));
        }
        let what = what.trim_end();
        let what = if what.is_empty() { String::new() } else { format!("{what}\n") };
        format!("{}{}{}\n{what}", style.bold, names.trim_end(), style.off)
    }

    /// The line of a suite, with what came of it on each lane.
    pub fn row(&self, suite: &str, entries: &[Entry], color: bool) -> String {
        let style = Style::new(color);
        let mut row = fitted(suite, self.suite);
        if let Some(refused) = entries.iter().find(|entry| entry.on.is_none())
            && let Outcome::Refused(error) = &refused.outcome
        {
            let room = (self.lanes.len() * (self.cell + 2)).saturating_sub(MARK + 3).max(30);
            let error = error.to_string();
            let error = fitted(error.lines().next().unwrap_or_default(), room);
            return format!("{row}  {}FAIL{}  {}\n", style.bad, style.off, error.trim_end());
        }
        for lane in &self.lanes {
            let of: Vec<&Entry> =
                entries.iter().filter(|entry| entry.on.is_some_and(|(name, _)| name == *lane)).collect();
            let (mark, text) = self.cell(&of);
            let paint = match mark {
                None | Some(Standing::NotRun | Standing::Known) => "",
                Some(standing) => style.of(standing),
            };
            let off = if paint.is_empty() { "" } else { style.off };
            row.push_str(&format!("  {paint}{}{off}", fitted(&text, self.cell)));
        }
        format!("{}\n", row.trim_end())
    }

    /// What came of a suite on a lane, in all of its stages.
    fn cell(&self, entries: &[&Entry]) -> (Option<Standing>, String) {
        let Some(mark) = entries.iter().map(|entry| entry.standing()).max() else { return (None, "-".to_owned()) };
        let reports = || {
            entries.iter().filter_map(|entry| match &entry.outcome {
                Outcome::Ran(report) => Some(&**report),
                Outcome::Refused(_) | Outcome::LaneFailed(_) | Outcome::KnownFailure { .. } => None,
            })
        };
        let sum = |of: &dyn Fn(&Report) -> u64| reports().map(of).sum::<u64>();
        let judged = short(sum(&|report| report.judged()));
        let worst = reports().filter(|r| r.verdicts.agreed > 0).map(|r| r.verdicts.max_ulp).fold(None, most);
        let worst = worst.map_or_else(|| "-".to_owned(), ulp);
        let word = word(mark);
        let text = match (self.detail(), mark) {
            (Detail::Mark, _) | (_, Standing::NotRun | Standing::LaneFailed) => word.to_owned(),
            (Detail::Judged | Detail::All, Standing::Failed) => {
                let deviated = sum(&|report| report.verdicts.deviated);
                let kind = reports().flat_map(Report::errors).map(|finding| finding.kind.name()).next();
                match (deviated, kind) {
                    (1.., Some("deviation")) => format!("{word:<MARK$}{:>NUMBER$} dev", short(deviated)),
                    (_, kind) => format!("{word:<MARK$}{}", kind.unwrap_or_default()),
                }
            }
            (Detail::Judged, _) => format!("{word:<MARK$}{judged:>NUMBER$}"),
            (Detail::All, _) => format!("{word:<MARK$}{judged:>NUMBER$}{worst:>ERROR$}"),
        };
        (Some(mark), text)
    }

    fn detail(&self) -> Detail {
        match self.cell {
            wide if wide >= MARK + NUMBER + ERROR => Detail::All,
            some if some >= MARK + NUMBER => Detail::Judged,
            _ => Detail::Mark,
        }
    }
}

/// How much a cell has room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Detail {
    Mark,
    Judged,
    All,
}

fn most(so_far: Option<f64>, ulp: f64) -> Option<f64> {
    Some(so_far.map_or(ulp, |so_far| so_far.max(ulp)))
}

/// An error in at most three characters.
fn ulp(ulp: f64) -> String {
    match ulp {
        small if small < 9.95 => format!("{small:.1}"),
        some if some < 999.5 => format!("{some:.0}"),
        _ => ">1k".to_owned(),
    }
}

/// A number of samples in at most five characters.
pub fn short(n: u64) -> String {
    match n {
        0..10_000 => n.to_string(),
        10_000..1_000_000 => format!("{}k", n / 1000),
        1_000_000..100_000_000 => format!("{:.1}M", (n / 100_000) as f64 / 10.0),
        _ => format!("{}M", n / 1_000_000),
    }
}

/// A text in exactly this many characters.
fn fitted(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return format!("{text:<width$}");
    }
    let cut: String = text.chars().take(width.saturating_sub(1)).collect();
    format!("{cut}…")
}

#[cfg(test)]
mod tests {
    use super::*;
    use lanes::Stage;

    const SUITES: [&str; 3] = ["sphere", "kochanek_bartels", "a_suite_with_a_very_long_name"];

    fn lost(lane: &'static str, stage: Stage) -> Entry {
        let outcome = Outcome::LaneFailed("gone".to_owned());
        Entry { suite: "sphere".to_owned(), shader: "s.vert".to_owned(), on: Some((lane, stage)), outcome }
    }

    #[test]
    fn the_table_fits_its_width() {
        let lanes = ["vulkan", "vulkan-swiftshader", "vulkan-glslang", "opengl", "opengl-softpipe", "a", "b", "c", "d"];
        for count in 1..=lanes.len() {
            for width in [80, 100] {
                let table = Table::new(lanes[..count].to_vec(), SUITES.into_iter(), width);
                let entries: Vec<Entry> = lanes[..count].iter().map(|lane| lost(lane, Stage::Vertex)).collect();
                let text = format!("{}{}", table.head(false), table.row(SUITES[2], &entries, false));
                let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
                assert!(widest <= width, "{count} lanes in {width}:\n{text}");
                assert_eq!(text.matches("LOST").count(), count);
            }
        }
    }

    #[test]
    fn five_lanes_have_room_for_everything_at_100_columns() {
        let table = Table::new(vec!["vulkan"; 5], SUITES[..2].iter().copied(), 100);
        assert_eq!(table.detail(), Detail::All);
        assert_eq!(Table::new(vec!["vulkan"; 2], SUITES.into_iter(), 80).detail(), Detail::All);
    }

    #[test]
    fn the_worst_stage_of_a_lane_counts() {
        let table = Table::new(vec!["vulkan", "opengl"], SUITES.into_iter(), 100);
        let known = Entry {
            outcome: Outcome::KnownFailure {
                message: String::new(),
                expectation: engine::suite::run::Expectation { at: String::new(), reason: String::new(), link: None },
            },
            ..lost("vulkan", Stage::Compute)
        };
        let row = table.row("sphere", &[known, lost("vulkan", Stage::Vertex)], false);
        assert!(row.contains("LOST") && !row.contains("known") && row.trim_end().ends_with('-'), "{row}");
    }

    #[test]
    fn numbers_are_short() {
        let all = [0, 9999, 10_000, 131_072, 999_999, 1_000_000, 99_999_999, 100_000_000].map(short);
        assert_eq!(all, ["0", "9999", "10k", "131k", "999k", "1.0M", "99.9M", "100M"]);
        assert_eq!([0.0, 5.04, 9.94, 9.96, 999.4, 1e9].map(ulp), ["0.0", "5.0", "9.9", "10", "999", ">1k"]);
    }
}
