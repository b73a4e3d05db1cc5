//! The judge on devices that err as far as their profile allows: none of them may be accused.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command prints its figures")]

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use base::text::SourceFile;
use chapter::SUITES;
use engine::adversary::Strategy;
use engine::suite::run::soundness::{Request, Row, check, halved};
use engine::suite::run::{Prepared, prepare};
use engine::suite::{load_all, parse};

/// Samples where none are asked for, as when all benchmarks run.
const SAMPLES: u64 = 1_000_000;
const SEED: u64 = 0x5eed;

fn main() -> ExitCode {
    match run() {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::from(1),
        Err(error) => {
            eprintln!("soundness: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Prints what came out; gives the number of wrong accusations.
fn run() -> Result<u64> {
    let (request, files) = request(std::env::args().skip(1))?;
    let half = request.lowered;
    let suites = if files.is_empty() {
        suites(half)?
    } else {
        files.iter().map(|path| read(path, half)).collect::<Result<Vec<_>>>()?.into_iter().flatten().collect()
    };
    let start = Instant::now();
    let found = check(&suites, &request, &mut |done| {
        eprintln!("{done} of {} samples, {:.0} s", request.samples, start.elapsed().as_secs_f64());
    })?;
    println!("largest error over its bound");
    println!("profile      order       strategy   judged        undetermined  violations  used    by");
    for profile in &request.profiles {
        for rearranges in [false, true] {
            for &strategy in &request.strategies {
                let rows = found.rows.iter().filter(|row| {
                    let b = row.behaviour;
                    b.profile.name == profile.name && b.rearranges == rearranges && b.strategy == strategy
                });
                line(&suites, &profile.name, rearranges, strategy, &rows.collect::<Vec<_>>());
            }
        }
    }
    for v in &found.violations {
        let order = if v.behaviour.rearranges { "rearranged" } else { "in order" };
        println!(
            "{} by {}, {} stage, {:?}, {order}, seed {:#x}: `{}` is {} times the bound off: {}",
            v.suite,
            v.behaviour.profile.name,
            v.behaviour.stage,
            v.behaviour.strategy,
            v.seed,
            v.component,
            v.ratio,
            v.deviation
        );
    }
    println!(
        "{} violations in {} judged samples; {} are inconclusive; {:.0} s",
        found.violations(),
        found.judged(),
        found.undetermined(),
        start.elapsed().as_secs_f64()
    );
    if found.judged() == 0 {
        bail!("nothing was judged");
    }
    Ok(found.violations())
}

fn line(suites: &[Prepared], profile: &str, rearranges: bool, strategy: Strategy, rows: &[&Row]) {
    if rows.is_empty() {
        return;
    }
    let sum = |of: fn(&Row) -> u64| rows.iter().map(|row| of(row)).sum::<u64>();
    let most = rows.iter().filter_map(|row| Some((row.used.as_ref()?, row.suite)));
    let most = most.max_by(|(a, _), (b, _)| a.part.total_cmp(&b.part));
    let (part, by) = most.map_or((0.0, String::new()), |(used, suite)| {
        (used.part, format!("{} {}", suites[suite].suite.name, used.component))
    });
    println!(
        "{profile:<12} {:<11} {:<10} {:<13} {:<13} {:<11} {part:<7.4} {by}",
        if rearranges { "rearranged" } else { "in order" },
        format!("{strategy:?}"),
        sum(|row| row.judged),
        sum(|row| row.undetermined.iter().sum()),
        sum(|row| row.violations),
    );
}

/// What is asked for, and the files of suites that run in place of the chapter's.
fn request(arguments: impl Iterator<Item = String>) -> Result<(Request, Vec<PathBuf>)> {
    let (mut request, mut files) = (Request::new(SAMPLES, SEED), Vec::new());
    // Cargo adds `--bench`.
    let mut arguments = arguments.filter(|argument| argument != "--bench");
    while let Some(argument) = arguments.next() {
        if !argument.starts_with("--") {
            files.push(PathBuf::from(argument));
            continue;
        }
        if argument == "--half" {
            request.lowered = true;
            continue;
        }
        let value = arguments.next().with_context(|| format!("`{argument}` needs a value"))?;
        let number = value.parse().with_context(|| format!("`{argument} {value}` is no number"))?;
        match argument.as_str() {
            "--samples" => request.samples = number,
            "--seed" => request.seed = number,
            _ => bail!("there is no option `{argument}`; options are --samples N, --seed N and --half"),
        }
    }
    Ok((request, files))
}

/// The suites of a file, in whatever language their shaders are; with `half` in GLSL, whose numbers are `mediump`.
fn read(path: &Path, half: bool) -> Result<Vec<Prepared>> {
    let ready = load_all(path)?.into_iter().map(|loaded| {
        Ok(if half { halved(&loaded.suite, &loaded.shader)? } else { prepare(&loaded.suite, &loaded.shader)? })
    });
    ready.collect()
}

fn suites(half: bool) -> Result<Vec<Prepared>> {
    let ready = SUITES.iter().map(|suite| {
        let parsed = parse(&SourceFile::new(suite.path, suite.toml)).with_context(|| suite.path.to_owned())?;
        let shader = SourceFile::new(suite.shader_name, suite.shader_text);
        Ok(if half { halved(&parsed, &shader)? } else { prepare(&parsed, &shader)? })
    });
    ready.collect()
}
