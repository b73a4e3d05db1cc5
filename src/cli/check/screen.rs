//! What people see: on a terminal a table that grows suite by suite, elsewhere a line for each suite and stage.

use std::cell::RefCell;
use std::collections::HashMap;
use std::io::{IsTerminal, Write};

use super::CheckArgs;
use super::select::Selected;
use engine::suite::run::{Entry, Summary};
use lanes::Lane;
use report::check::{Table, brief, finding, line, line_as, not_run, refusal, totals};

/// The widest table; a narrower terminal has a narrower one.
const WIDEST: usize = 100;

/// Where the result of a run goes while it runs.
pub struct Screen {
    way: Way,
    color: bool,
    /// Refusals that were told, by the name of the suite and what they say, with the variant that they were told of.
    refused: RefCell<HashMap<(String, String), String>>,
}

enum Way {
    /// Another format: nothing before the end.
    Silent,
    Lines,
    Table {
        table: Table,
        /// True once its head is printed.
        begun: bool,
    },
}

impl Screen {
    /// A table on a terminal, lines elsewhere and where they are asked for, nothing for other formats.
    pub fn new(args: &CheckArgs, selected: &[Selected], lanes: &[Box<dyn Lane>], color: bool) -> Self {
        let plain = args.plain || !std::io::stdout().is_terminal();
        let way = if !args.is_text() {
            Way::Silent
        } else if plain {
            Way::Lines
        } else {
            let width = terminal_size::terminal_size().map_or(WIDEST, |(width, _)| usize::from(width.0).min(WIDEST));
            let names = lanes.iter().map(|lane| lane.description().name).collect();
            let suites = selected.iter().map(|selected| selected.suite.name.as_str());
            Way::Table { table: Table::new(names, suites, width), begun: false }
        };
        Self { way, color: color && !args.plain, refused: RefCell::default() }
    }

    /// A suite ran on a stage of a lane.
    pub fn entry(&self, entry: &Entry, out: &mut dyn Write) -> anyhow::Result<()> {
        match self.way {
            Way::Lines => {
                // One mistake in a suite is told for the first of its sizes.
                let told = refusal(entry).and_then(|refusal| {
                    let first = self.refused.borrow_mut().entry(refusal).or_insert_with(|| entry.suite.clone()).clone();
                    (first != entry.suite).then_some(first)
                });
                let text = told.map_or_else(|| line(entry, self.color), |first| line_as(entry, &first, self.color));
                Ok(out.write_all(text.as_bytes())?)
            }
            Way::Silent | Way::Table { .. } => Ok(()),
        }
    }

    /// A suite ran on all lanes.
    pub fn suite(&mut self, name: &str, entries: &[Entry], out: &mut dyn Write) -> anyhow::Result<()> {
        let Way::Table { table, begun } = &mut self.way else { return Ok(()) };
        if !std::mem::replace(begun, true) {
            out.write_all(table.head(self.color).as_bytes())?;
        }
        out.write_all(table.row(name, entries, self.color).as_bytes())?;
        Ok(out.flush()?)
    }

    /// All of it ran.
    pub fn end(&self, summary: &Summary, out: &mut dyn Write) -> anyhow::Result<()> {
        if matches!(self.way, Way::Table { .. }) {
            out.write_all(not_run(summary, self.color).as_bytes())?;
        }
        findings(summary, self.color, out)?;
        let last = match self.way {
            Way::Silent | Way::Lines => totals(summary, self.color),
            Way::Table { .. } => brief(summary, self.color),
        };
        out.write_all(last.as_bytes())?;
        Ok(out.flush()?)
    }
}

/// Everything that is wrong, and an empty line.
pub fn findings(summary: &Summary, color: bool, out: &mut dyn Write) -> anyhow::Result<()> {
    for at in 0..summary.entries.len() {
        out.write_all(finding(&summary.entries, at, color).as_bytes())?;
    }
    Ok(writeln!(out)?)
}
