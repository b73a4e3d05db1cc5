//! How many of piglit's generated tests of built-in functions agree, by version, stage and what runs them.
//!
//! Each test computes a result from uniforms, compares it with an expected value within a tolerance that the
//! test states, and says by a color whether it passes. The stage is run on every set of uniforms, and its
//! color compared with the one that is probed.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command prints its figures")]

#[path = "mod.rs"]
mod piglit;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail};
use lanes::{Lane, vulkan};
use rayon::prelude::*;

use piglit::convert::{convert, tested};
use piglit::format::ShaderTest;
use piglit::judge::{Found, Runner, judge};

#[derive(Default)]
struct Request {
    folders: Vec<PathBuf>,
    list: Option<String>,
    every: usize,
}

/// What became of one file.
struct Outcome {
    path: PathBuf,
    /// Version and stage.
    group: (String, &'static str),
    /// Number of draws.
    cases: usize,
    /// Why it is not run at all.
    skipped: Option<String>,
    found: BTreeMap<Runner, Found>,
}

#[derive(Clone, Copy, Default)]
struct Tally {
    ran: usize,
    agreed: usize,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("piglit: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<()> {
    let request = request(std::env::args().skip(1).filter(|a| a != "--bench"))?;
    if request.folders.is_empty() {
        // All benchmarks run: there is nothing to convert.
        return Ok(());
    }
    let mut files = Vec::new();
    for folder in &request.folders {
        walk(folder, &mut files)?;
    }
    files.sort();
    let files: Vec<PathBuf> = files.into_iter().step_by(request.every.max(1)).collect();
    if files.is_empty() {
        bail!("no file built-in-functions/vs-*.shader_test (or gs-*, fs-*, cs-*) is below these folders");
    }
    let probe = vulkan::open();
    if let Err(missing) = &probe {
        eprintln!("piglit: lane `vulkan` is left out: {missing}");
    }
    let device = probe.is_ok();
    // A lane stays on its thread.
    let open = || if device { vulkan::open().ok() } else { None };
    let outcomes: Vec<Outcome> =
        files.par_chunks(64).map_init(open, |lane, files| chunk(lane.as_deref(), files)).flatten().collect();
    if let Some(wanted) = &request.list {
        list(&outcomes, wanted);
    } else {
        report(&outcomes);
    }
    Ok(())
}

fn chunk(lane: Option<&dyn Lane>, files: &[PathBuf]) -> Vec<Outcome> {
    files.iter().map(|path| examine(path, lane)).collect()
}

fn examine(path: &Path, lane: Option<&dyn Lane>) -> Outcome {
    let group = (String::new(), "");
    let mut outcome = Outcome { path: path.to_owned(), group, cases: 0, skipped: None, found: BTreeMap::new() };
    let parsed = std::fs::read_to_string(path).map_err(Into::into).and_then(|text| ShaderTest::parse(&text));
    let test = match parsed {
        Ok(test) => test,
        Err(error) => {
            outcome.skipped = Some(format!("the file is not understood: {error:#}"));
            return outcome;
        }
    };
    outcome.group = (test.version.clone(), tested(&test).map_or("", |s| s.stage().name()));
    outcome.cases = test.cases.len();
    match convert(&path.display().to_string(), &test) {
        Ok(converted) => {
            for runner in Runner::ALL {
                if let Some(found) = judge(&converted, runner, lane) {
                    outcome.found.insert(runner, found);
                }
            }
        }
        Err(skipped) => outcome.skipped = Some(skipped.0),
    }
    outcome
}

fn report(outcomes: &[Outcome]) {
    let mut table: BTreeMap<(&str, &str, Runner), Tally> = BTreeMap::new();
    let mut groups: BTreeMap<(&str, &str), (usize, usize)> = BTreeMap::new();
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    for o in outcomes {
        let key = (o.group.0.as_str(), o.group.1);
        let entry = groups.entry(key).or_default();
        entry.0 += 1;
        entry.1 += o.cases;
        if let Some(why) = &o.skipped {
            *reasons.entry(format!("not run: {}", short(why))).or_default() += 1;
        }
        for (runner, found) in &o.found {
            match found {
                Found::Not(why) => {
                    *reasons.entry(format!("not on {}: {}", name(*runner), short(why))).or_default() += 1
                }
                Found::Agrees | Found::Disagrees(_) => {
                    for key in [(key.0, key.1, *runner), ("all", "", *runner)] {
                        let tally = table.entry(key).or_default();
                        tally.ran += 1;
                        tally.agreed += usize::from(*found == Found::Agrees);
                    }
                }
            }
        }
    }
    print!("version stage       tests    cases");
    for runner in Runner::ALL {
        print!("{:>25}", name(runner));
    }
    println!();
    let all = groups.values().fold((0, 0), |sum, g| (sum.0 + g.0, sum.1 + g.1));
    for (&(version, stage), &(tests, cases)) in groups.iter().chain([(&("all", ""), &all)]) {
        print!("{version:<8}{stage:<10}{tests:>7}{cases:>9}");
        for runner in Runner::ALL {
            print!("{:>25}", table.get(&(version, stage, runner)).map_or_else(String::new, share));
        }
        println!();
    }
    let mut reasons: Vec<_> = reasons.into_iter().collect();
    reasons.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    for (reason, count) in reasons {
        println!("{count:>7}  {reason}");
    }
    for o in outcomes {
        for (runner, found) in &o.found {
            if let Found::Disagrees(cases) = found {
                let (case, color) = cases.first().cloned().unwrap_or_default();
                let (more, color) = (cases.len(), color.join(" "));
                println!(
                    "disagrees on {}: {}: {more} of {} cases, first {case}: {color}",
                    name(*runner),
                    o.path.display(),
                    o.cases
                );
            }
        }
    }
}

/// What stands above a column.
fn name(runner: Runner) -> &'static str {
    match runner {
        Runner::Real => "binary64",
        Runner::Strict => "binary32",
        Runner::Compute => "vulkan",
        Runner::Vertex => "vulkan/vertex",
    }
}

fn share(tally: &Tally) -> String {
    let percent = 100.0 * tally.agreed as f64 / tally.ran.max(1) as f64;
    format!("{}/{} {percent:.2} %", tally.agreed, tally.ran)
}

fn list(outcomes: &[Outcome], wanted: &str) {
    for o in outcomes {
        let skipped = o.skipped.iter().map(|why| format!("not run: {why}"));
        let found = o.found.iter().filter_map(|(runner, found)| match found {
            Found::Not(why) => Some(format!("not on {}: {why}", name(*runner))),
            Found::Disagrees(cases) => Some(format!("disagrees on {}: {cases:?}", name(*runner))),
            Found::Agrees => None,
        });
        for reason in skipped.chain(found).filter(|r| r.contains(wanted)) {
            println!("{}: {reason}", o.path.display());
        }
    }
}

/// A reason without what differs from file to file.
fn short(why: &str) -> String {
    let line = why.lines().next().unwrap_or_default();
    let line = line.split_once(".shader_test:").map_or(line, |(_, rest)| rest.split_once(": ").map_or(rest, |r| r.1));
    line.chars().take(110).collect()
}

fn request(mut arguments: impl Iterator<Item = String>) -> Result<Request> {
    let mut request = Request::default();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--list" => request.list = Some(arguments.next().context("--list takes a reason")?),
            "--every" => request.every = arguments.next().context("--every takes a number")?.parse()?,
            _ if argument.starts_with('-') => bail!("unknown option `{argument}`; known: --list, --every"),
            _ => request.folders.push(PathBuf::from(argument)),
        }
    }
    Ok(request)
}

/// The generated tests of built-in functions below a folder.
fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in std::fs::read_dir(folder).with_context(|| format!("cannot read `{}`", folder.display()))? {
        let entry = entry?;
        let kind = entry.file_type()?;
        let path = entry.path();
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
        let tested = folder.ends_with("built-in-functions") && name.ends_with(".shader_test");
        let wanted = tested && ["vs-", "gs-", "fs-", "cs-"].iter().any(|p| name.starts_with(p));
        if kind.is_dir() {
            walk(&path, files)?;
        } else if kind.is_file() && wanted {
            files.push(path);
        }
    }
    Ok(())
}
