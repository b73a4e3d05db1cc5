//! The report of a run over many files and their twins: what differs, and how much was compared.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::json::{Alone, Pair};
use engine::compare::{Compared, SameBits, Unpaired};

/// Two files that are to mean the same.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct TwinReport {
    /// Their names.
    pub texts: [String; 2],
    /// Why nothing of them is compared.
    pub not_compared: Option<String>,
    /// The first error of each file of which some functions do not compile.
    #[serde(default)]
    pub errors: Vec<String>,
    /// The pairs of functions, in the order of the first.
    pub pairs: Vec<Compared>,
    /// Functions of each that have no partner.
    pub unpaired: [Vec<Unpaired>; 2],
    /// Functions that are known to differ.
    pub except: Vec<String>,
}

impl TwinReport {
    /// Of two files of which nothing is known yet.
    pub fn of(texts: [String; 2]) -> Self {
        Self { texts, ..Self::default() }
    }

    /// True for functions that are known to differ.
    fn is_excepted(&self, pair: &Compared) -> bool {
        let plain = |label: &str| label.split('(').next().unwrap_or(label).to_owned();
        pair.functions.iter().any(|function| self.except.iter().any(|own| own == function || *own == plain(function)))
    }
}

/// A run over twins.
#[derive(Debug, Default)]
pub struct Twins {
    /// Seed of the inputs.
    pub seed: u64,
    /// The twins.
    pub twins: Vec<TwinReport>,
    /// Files of each half that have none.
    pub alone: [Vec<String>; 2],
}

/// How many pairs of functions there are of which kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Pairs of files.
    pub files: usize,
    /// Pairs of files of which nothing is compared.
    pub files_not_compared: usize,
    /// Pairs of files of which some functions do not compile.
    pub files_with_errors: usize,
    /// Pairs of functions of which something is known.
    pub compared: usize,
    /// Those that mean the same on all samples of which something is known.
    pub equal: usize,
    /// Of the equal ones, those of which little is known.
    pub weak: usize,
    /// Those that mean something else, or whose bits differ where that was asked for.
    pub unlike: usize,
    /// Of the unlike ones, those that differ by no more than a conforming device may be off.
    pub close: usize,
    /// Those that are known to differ, and do.
    pub excepted: usize,
    /// Pairs of which nothing is known.
    pub not_compared: usize,
    /// Functions that have no partner in the twin.
    pub without_partner: usize,
}

impl Twins {
    /// The counts.
    pub fn counts(&self) -> Counts {
        let mut counts = Counts { files: self.twins.len(), ..Counts::default() };
        for twin in &self.twins {
            counts.files_not_compared += usize::from(twin.not_compared.is_some());
            counts.files_with_errors += usize::from(!twin.errors.is_empty());
            counts.without_partner += twin.unpaired.iter().map(Vec::len).sum::<usize>();
            for pair in &twin.pairs {
                match Kind::of(twin, pair) {
                    Kind::NotCompared => counts.not_compared += 1,
                    Kind::Equal => counts.equal += 1,
                    Kind::Weak => (counts.equal, counts.weak) = (counts.equal + 1, counts.weak + 1),
                    Kind::Unlike => {
                        counts.unlike += 1;
                        counts.close += usize::from(pair.unlike.0 > 0 && pair.unlike.1 + pair.unbounded == 0);
                    }
                    Kind::Excepted => counts.excepted += 1,
                    Kind::NoLongerUnlike => counts.equal += 1,
                }
            }
        }
        counts.compared = counts.equal + counts.unlike + counts.excepted;
        counts
    }

    /// True where something differs, or a file does not compile.
    pub fn fails(&self) -> bool {
        let counts = self.counts();
        counts.unlike + counts.files_not_compared + counts.files_with_errors > 0
    }
}

/// What a pair of functions shows.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    NotCompared,
    Equal,
    Weak,
    Unlike,
    Excepted,
    /// It is stated that they differ, and they do not.
    NoLongerUnlike,
}

impl Kind {
    pub(super) fn of(twin: &TwinReport, pair: &Compared) -> Self {
        let differs = pair.unlike.0 > 0 || !pair.same_bits.iter().all(SameBits::holds);
        match (differs, twin.is_excepted(pair)) {
            (true, true) => Self::Excepted,
            (true, false) => Self::Unlike,
            (false, _) if !pair.is_known() => Self::NotCompared,
            (false, true) => Self::NoLongerUnlike,
            (false, false) if pair.weak().is_some() => Self::Weak,
            (false, false) => Self::Equal,
        }
    }
}

/// Functions or files whose names are shown in a row.
const NAMES: usize = 6;

/// The report for people: what differs, what could not be compared and why, and the counts.
pub fn text(summary: &Twins, color: bool) -> String {
    let paint = |code: &'static str| if color { code } else { "" };
    let (bad, weak, off) = (paint("\u{1b}[31m"), paint("\u{1b}[33m"), paint("\u{1b}[0m"));
    let mut text = String::new();
    for twin in &summary.twins {
        let mut own = String::new();
        if let Some(why) = &twin.not_compared {
            let _ = writeln!(own, "{weak}--    {off}  not compared: {}", why.replace('\n', "; "));
        }
        for error in &twin.errors {
            let _ = writeln!(own, "{weak}--    {off}  functions that do not compile are left out: {error}");
        }
        for pair in &twin.pairs {
            let name = super::text::name(pair);
            match Kind::of(twin, pair) {
                Kind::Equal | Kind::Excepted => {}
                Kind::NotCompared => {
                    let why = pair.not_compared.clone().unwrap_or_else(|| super::text::equal(pair));
                    let _ = writeln!(own, "{weak}--    {off}  {name:<20} not compared: {why}");
                }
                Kind::Weak => {
                    let _ = writeln!(own, "{weak}weak  {off}  {name:<20} {}", super::text::equal(pair));
                }
                Kind::NoLongerUnlike => {
                    let _ = writeln!(own, "{weak}equal {off}  {name:<20} is stated to differ (`except`), and does not");
                }
                Kind::Unlike if pair.unlike.0 == 0 => {
                    let _ = writeln!(own, "{bad}BITS  {off}  {name:<20} {}", super::text::equal(pair));
                    pair.same_bits.iter().for_each(|bits| super::text::same_bits(&mut own, bits));
                }
                Kind::Unlike => {
                    let _ = writeln!(own, "{bad}UNLIKE{off}  {name:<20} {}", super::text::unlike(pair));
                    pair.smallest.iter().for_each(|smallest| super::text::difference(&mut own, smallest));
                }
            }
        }
        let unlike: Vec<String> =
            twin.unpaired.iter().flatten().filter(|one| one.why.is_some()).map(|one| one.function.clone()).collect();
        if !unlike.is_empty() {
            let _ = writeln!(own, "{weak}--    {off}  no partner with these parameters: {}", in_a_row(&unlike));
        }
        if !own.is_empty() {
            let _ = writeln!(text, "{} = {}\n{own}", twin.texts[0], twin.texts[1]);
        }
    }
    for (which, names) in ["first", "second"].iter().zip(&summary.alone).filter(|(_, names)| !names.is_empty()) {
        let _ = writeln!(text, "no twin of {} of the {which}: {}", files(names.len()), in_a_row(names));
    }
    for (k, which) in ["first", "second"].iter().enumerate() {
        let alone = |twin: &TwinReport| {
            twin.unpaired[k].iter().filter(|one| one.why.is_none()).map(|one| one.function.clone()).collect::<Vec<_>>()
        };
        let names: Vec<String> = summary.twins.iter().flat_map(alone).collect();
        if !names.is_empty() {
            let _ = writeln!(text, "only in the {which}: {}", in_a_row(&names));
        }
    }
    let counts = summary.counts();
    let also = |count: usize, what: &str| if count == 0 { String::new() } else { format!(", {count} {what}") };
    let _ = writeln!(
        text,
        "{} with twins{}; {} compared: {} equal{}, {} unlike{}{}; {} not compared, {} without a partner",
        files(counts.files),
        also(counts.files_not_compared, "of them not compared") + &also(counts.files_with_errors, "of them in part"),
        functions(counts.compared),
        counts.equal,
        if counts.weak == 0 { String::new() } else { format!(" ({} weak)", counts.weak) },
        counts.unlike,
        match counts.close {
            0 => String::new(),
            close => format!(" ({close} by no more than a conforming device may be off)"),
        },
        also(counts.excepted, "known to differ"),
        counts.not_compared,
        counts.without_partner
    );
    text
}

fn files(count: usize) -> String {
    if count == 1 { "1 file".to_owned() } else { format!("{count} files") }
}

fn functions(count: usize) -> String {
    if count == 1 { "1 function".to_owned() } else { format!("{count} functions") }
}

fn in_a_row(names: &[String]) -> String {
    let shown = names.iter().take(NAMES).map(String::as_str).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(NAMES) {
        0 => shown,
        rest => format!("{shown} and {rest} more"),
    }
}

#[derive(Serialize)]
struct Root<'a> {
    status: &'static str,
    seed: u64,
    counts: Counts,
    twins: Vec<Twin<'a>>,
    /// Files that have no twin.
    only_in_first: &'a [String],
    only_in_second: &'a [String],
}

#[derive(Serialize)]
struct Twin<'a> {
    first: &'a str,
    second: &'a str,
    not_compared: Option<&'a str>,
    errors: &'a [String],
    pairs: Vec<TwinPair<'a>>,
    unpaired: Vec<Alone<'a>>,
}

#[derive(Serialize)]
struct TwinPair<'a> {
    /// True where the configuration states that the two differ.
    excepted: bool,
    #[serde(flatten)]
    pair: Pair<'a>,
}

/// The report as one object, with a line break.
pub fn json(summary: &Twins) -> String {
    let counts = summary.counts();
    let fails = summary.fails() || counts.compared == 0;
    let twins = summary.twins.iter().map(|own| Twin {
        first: &own.texts[0],
        second: &own.texts[1],
        not_compared: own.not_compared.as_deref(),
        errors: &own.errors,
        pairs: own
            .pairs
            .iter()
            .map(|pair| TwinPair { excepted: own.is_excepted(pair), pair: super::json::pair(pair) })
            .collect(),
        unpaired: (0..2)
            .flat_map(|side| own.unpaired[side].iter().map(move |one| super::json::alone(side, one)))
            .collect(),
    });
    let root = Root {
        status: if fails { "fail" } else { "pass" },
        seed: summary.seed,
        counts,
        twins: twins.collect(),
        only_in_first: &summary.alone[0],
        only_in_second: &summary.alone[1],
    };
    // Strings, numbers and lists: there is nothing that could not be written.
    let mut text = serde_json::to_string_pretty(&root).unwrap_or_default();
    text.push('\n');
    text
}
