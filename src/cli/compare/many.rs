//! A run over twins: every function that two files have in common.

use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::twins::{Twin, Twins};
use super::{CompareArgs, Given, Hosts, IncludedText, command, is_broken, made, version};
use crate::cli::fuzz::Inputs;
use crate::cli::reported;
use crate::cli::shard::{Printed, Printing, Terminal};
use crate::cli::status::ExitStatus;
use crate::cli::waiting::Waiting;
use base::text::Shown as _;
use engine::compare::{self, Pairing, Request};
use engine::fuzz::{Domain, Subject};
use engine::session::{At, Job, Join, Seen, Unlike};
use engine::shard::Identity;
use judge::profile::Profile;
use lanes::Lane;
use report::compare::{TwinReport, Twins as Summary, twins_ci, twins_json, twins_text};

/// How the parts of such a run are called.
pub const COMMAND: &str = "compare twins";

/// Compares all twins.
///
/// # Errors
/// When an option is for one pair of files, or a domain, profile or lane cannot be had.
pub(super) fn run(
    args: &CompareArgs,
    twins: &Twins,
    (out, err): (&mut dyn Write, &mut dyn Write),
    color: bool,
) -> anyhow::Result<ExitStatus> {
    let shard = args.sharing.shard()?;
    anyhow::ensure!(args.function.is_empty(), "--function is for two files: name them");
    anyhow::ensure!(
        shard.is_none() || args.report_dir.is_none(),
        "--shard does a part of the files; --report-dir is for a run without it"
    );
    let _waiting = Waiting::begin();
    let stated = args.input.domains()?;
    let profiles = super::profiles(args)?;
    // What is asked of many is whether they mean the same: lanes run them where they are named.
    let opened = if args.lane.is_empty() { Vec::new() } else { crate::cli::lanes::opened(&args.lane, false)? };
    let lanes: Vec<&dyn Lane> = opened.iter().map(AsRef::as_ref).collect();
    let names = |paths: &[PathBuf]| paths.iter().map(|path| path.shown().to_string()).collect::<Vec<_>>();
    let alone = twins.alone.each_ref().map(|side| names(side));
    let part = ShardResult { alone, twins: Vec::new(), reports: args.report_dir.clone() };
    let key = |shards| identity(args, shards, twins, &lanes);
    let mut all = All {
        args,
        twins: &twins.twins,
        inputs: Inputs::new(&stated),
        lanes: &lanes,
        profiles: profiles.iter().map(AsRef::as_ref).collect(),
        hosts: Hosts::default(),
        seen: HashSet::new(),
    };
    args.sharing.run(&mut all, part, key, &mut Terminal::new(args.format, color, out, err))
}

fn identity(args: &CompareArgs, shards: u64, twins: &Twins, lanes: &[&dyn Lane]) -> Identity {
    let identity = Identity::new(COMMAND, args.input.seed, shards)
        .with("command", command(args, args.two().unwrap_or_default()))
        .with("--profile", args.profile.join(","))
        .with("--samples", args.samples)
        .with("except", twins.twins.iter().flat_map(|twin| twin.except.clone()).collect::<Vec<_>>().join(","))
        .on(lanes.iter().map(|lane| lane.description()));
    let paths = twins.twins.iter().flat_map(|twin| &twin.paths);
    paths.fold(identity, |all, path| match std::fs::read_to_string(path) {
        Ok(text) => all.of(&format!("file `{}`", path.shown()), &text),
        Err(_) => all,
    })
}

struct All<'a> {
    args: &'a CompareArgs,
    twins: &'a [Twin],
    inputs: Inputs<'a>,
    lanes: &'a [&'a dyn Lane],
    profiles: Vec<&'a Profile>,
    hosts: Hosts,
    /// Places of the pairs that were compared.
    seen: HashSet<[String; 2]>,
}

/// Two files with their functions, or why they are not compared.
struct Unit {
    names: [String; 2],
    except: Vec<String>,
    sides: Result<[Functions; 2], String>,
}

/// The functions of a file, and its first error where some do not compile.
struct Functions {
    text: IncludedText,
    subjects: Vec<Subject>,
    error: Option<String>,
}

impl All<'_> {
    /// The functions of a file, or why it has none.
    fn side(&mut self, path: &Path, defines: &[(String, String)]) -> anyhow::Result<Result<Functions, String>> {
        let args = self.args;
        let given = Given { defines, ..args.input.reading(Some(&args.compose), None) };
        let text = match version::text(&path.to_string_lossy(), &given, args.input.stage()) {
            Ok(text) => text.assuming(defines, &mut self.hosts),
            Err(error) => return Ok(Err(format!("{error:#}"))),
        };
        // Of many texts, the first error of each is told, in the report.
        Ok(match made(&text, defines, &mut std::io::sink()) {
            Ok((subjects, Some(error))) if is_broken(&subjects, Some(&error)) => {
                Err(format!("{} does not compile: {error}", path.shown()))
            }
            Ok((subjects, error)) => Ok(Functions { text, subjects, error }),
            Err(error) => Err(format!("{}: {error:#}", path.shown())),
        })
    }
}

impl Job for All<'_> {
    type Unit = Unit;
    type Part = ShardResult;
    type Error = anyhow::Error;
    type Event<'e> = Seen<'e>;

    fn unit(&mut self, number: u64, _: &mut At<'_, Self>) -> anyhow::Result<Option<Unit>> {
        let Some(twin) = self.twins.get(number as usize) else {
            self.inputs.all_used()?;
            return Ok(None);
        };
        let names = twin.paths.each_ref().map(|path| path.shown().to_string());
        let defines = self.args.input.define.clone();
        let second_defines = [&defines[..], &self.args.define_second[..]].concat();
        let sides = match self.side(&twin.paths[0], &defines)? {
            Ok(first) => self.side(&twin.paths[1], &second_defines)?.map(|second| [first, second]),
            Err(why) => Err(why),
        };
        Ok(Some(Unit { names, except: twin.except.clone(), sides }))
    }

    fn run(&mut self, (number, unit): (u64, Unit), at: &mut At<'_, Self>) -> anyhow::Result<()> {
        let Unit { names, except, sides } = unit;
        let mut report = TwinReport { except, ..TwinReport::of(names) };
        let sides = match sides {
            Ok(sides) => sides,
            Err(why) => {
                report.not_compared = Some(why);
                at.part.twins.push((number, report));
                return Ok(());
            }
        };
        report.errors = sides.iter().filter_map(|side| side.error.clone()).collect();
        let pairing = compare::pairing(sides.each_ref().map(|side| side.subjects.as_slice()), &[]);
        let Pairing { pairs, unpaired } = pairing.unwrap_or_else(|why| {
            report.not_compared = Some(why);
            Pairing::default()
        });
        report.unpaired = unpaired;
        let request = Request {
            samples: self.args.samples,
            seed: self.args.input.seed,
            case: None,
            profiles: self.profiles.clone(),
            command: command(self.args, [&report.texts[0], &report.texts[1]]),
            curves: false,
            same_bits: self.args.same_bits,
        };
        for pair in pairs {
            // A function of a file that several include is compared once.
            if !self.seen.insert(pair.map(|subject| subject.at.clone())) {
                continue;
            }
            let domain: Domain = self.inputs.domain(pair[0])?;
            let compared = compare::run(pair, &domain, self.lanes, &request).map_err(anyhow::Error::msg)?;
            report.pairs.push(super::open(compared, pair, sides.each_ref().map(|side| &side.text)));
        }
        at.part.twins.push((number, report));
        Ok(())
    }
}

/// What came of some twins, each with its number in the run.
#[derive(Debug, Serialize, Deserialize)]
pub struct ShardResult {
    alone: [Vec<String>; 2],
    twins: Vec<(u64, TwinReport)>,
    /// Where the reports of a whole run go.
    #[serde(skip)]
    reports: Option<PathBuf>,
}

impl Join for ShardResult {
    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        Unlike::unless(self.alone == other.alone, "compared different files")?;
        self.twins.extend(other.twins);
        self.twins.sort_by_key(|(number, _)| *number);
        let mut seen = HashSet::new();
        for (_, twin) in &mut self.twins {
            twin.pairs.retain(|pair| seen.insert(pair.at.clone()));
        }
        Ok(())
    }
}

impl Printed for ShardResult {
    fn print(self, mut to: Printing<'_>) -> anyhow::Result<ExitStatus> {
        let twins = self.twins.into_iter().map(|(_, twin)| twin).collect();
        let summary = Summary { seed: to.identity.seed, twins, alone: self.alone };
        if let Some(folder) = &self.reports {
            reported::write_all(folder, &twins_ci(&summary), &twins_json(&summary))?;
        }
        let printed = to.format.of(|| twins_ci(&summary), || twins_json(&summary))?;
        let printed = printed.unwrap_or_else(|| twins_text(&summary, to.color));
        to.out.write_all(printed.as_bytes())?;
        Ok(if let Some(status) = to.ended()? {
            status
        } else if summary.counts().compared == 0 {
            writeln!(to.err, "error: nothing could be compared")?;
            ExitStatus::Error
        } else if summary.fails() {
            ExitStatus::Findings
        } else {
            ExitStatus::Clean
        })
    }
}
