//! Suites as tests of cargo: one test for each suite, and for each combination of its macros.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};

use base::text::{Shown, SourceFile};
use engine::suite::expectations::{self, Expectations};
use engine::suite::run::{DEFAULT_SEED, Outcome as Run, Request, prepare};
use engine::suite::{self, Suite};
use judge::profile::Promises;
use property::Sample;

use crate::run;

/// Runs every suite (`*.suite.toml`) of a folder as a test of its own, with the arguments that `cargo test`
/// hands over: names that filter, `--list`, `--exact` and so on. It is the `main` of a test target without
/// the usual harness:
///
/// ```toml
/// [[test]]
/// name = "shaders"
/// harness = false
/// ```
///
/// ```no_run
/// // tests/shaders.rs
/// fn main() -> std::process::ExitCode {
///     shadercheck_test::test_main("shaders")
/// }
/// ```
///
/// Suites run on every device that is available, and on the embedded lane where there is none. A folder
/// without suites, and a suite that cannot be read, is a test that fails. Failing cases are kept beside the
/// suite and run first the next time, as of `shadercheck check`.
pub fn test_main(folder: impl AsRef<Path>) -> ExitCode {
    let mut arguments = Arguments::from_args();
    // A suite uses all cores by itself.
    arguments.test_threads.get_or_insert(1);
    libtest_mimic::run(&arguments, trials(folder.as_ref())).exit_code()
}

fn trials(folder: &Path) -> Vec<Trial> {
    let fails = |name: String, message: String| vec![Trial::test(name, move || Err(Failed::from(message)))];
    let files = match suite::search(folder) {
        Ok(files) if files.is_empty() => {
            return fails("suites".into(), format!("`{}` holds no suite file (*.suite.toml)", folder.shown()));
        }
        Ok(files) => files,
        Err(error) => return fails("suites".into(), error.to_string()),
    };
    let of = |path: PathBuf| {
        let inside = path.strip_prefix(folder).unwrap_or(&path).display().to_string().replace('\\', "/");
        let name = inside.trim_end_matches(".suite.toml").to_owned();
        match suite::load_all(&path) {
            Ok(all) => {
                let alone = all.len() == 1;
                let of_one = |loaded: suite::Loaded| {
                    let whole = loaded.suite.name.clone();
                    let trial = |suite: Suite| {
                        let variant = match alone {
                            true => suite.name.strip_prefix(&whole).unwrap_or_default().to_owned(),
                            false => format!("[{}]", suite.name),
                        };
                        let (name, shader, path) = (format!("{name}{variant}"), loaded.shader.clone(), path.clone());
                        let kind = suite.stage.name();
                        Trial::test(name, move || one(&suite, &shader, &path, &variant)).with_kind(kind)
                    };
                    loaded.suite.variants().into_iter().map(trial).collect::<Vec<_>>()
                };
                all.into_iter().flat_map(of_one).collect()
            }
            Err(error) => fails(name, error.to_string()),
        }
    };
    files.into_iter().flat_map(of).collect()
}

/// Runs one suite, saved cases first. `variant` tells it from the others of its file.
fn one(suite: &Suite, shader: &SourceFile, path: &Path, variant: &str) -> Result<(), Failed> {
    let prepared = prepare(suite, shader).map_err(|error| Failed::from(run::error_of(&error)))?;
    let (invocation, case) = (&prepared.compute.invocation, &prepared.compute.case);
    let regressions = suite::regressions_path(path);
    let saved = suite::read_regressions(&regressions)?;
    let own = saved.iter().filter(|regression| regression.suite == suite.name);
    let replay: Vec<Sample> = own.map(|regression| regression.to_sample(invocation, case)).collect::<Result<_, _>>()?;
    let lanes = run::lanes(&[]).map_err(Failed::from)?;
    let expectations = expectations_of(path)?;
    let mut entries = run::on_lanes(prepared, &lanes, |_, lane| Request {
        samples: None,
        seed: DEFAULT_SEED,
        quick: false,
        replay: replay.clone(),
        replay_only: false,
        promises: Promises::of_lane(lane.description()),
        arguments: if variant.is_empty() {
            path.display().to_string()
        } else {
            format!("'{}{variant}'", path.display())
        },
    });
    let failing: Vec<Sample> = entries
        .iter()
        .flat_map(|entry| match &entry.outcome {
            Run::Ran(report) => report.failing.clone(),
            Run::Refused(_) | Run::LaneFailed(_) | Run::KnownFailure { .. } => Vec::new(),
        })
        .collect();
    // What was found is told in any case: a folder that takes no file is no reason to lose it.
    let saved = if failing.is_empty() { Ok(()) } else { suite::save_regressions(&regressions, &suite.name, &failing) };
    let unsaved = saved.err().map_or_else(String::new, |error| format!("failing cases are not saved: {error}\n"));
    for entry in &mut entries {
        let lane =
            lanes.iter().map(|lane| lane.description()).find(|lane| entry.on.is_some_and(|on| on.0 == lane.name));
        if let (Some(expectations), Some(lane)) = (&expectations, lane) {
            expectations.apply(entry, lane);
        }
    }
    let outcome = run::outcome(entries);
    if outcome.passed() { Ok(()) } else { Err(Failed::from(format!("{}{unsaved}", outcome.report()))) }
}

/// What is expected to fail of a suite.
fn expectations_of(suite: &Path) -> Result<Option<Expectations>, Failed> {
    let Some(path) = suite::expectations_path(suite) else { return Ok(None) };
    let read = expectations::parse(&suite::read_expectations(&path)?);
    let reported = |problems: Vec<disk::Problem>| {
        Failed::from(problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
    };
    read.map(Some).map_err(reported)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const SUITE: &str = "suite = \"cube\"\nshader = \"cube.glsl\"\nstage = \"function\"\nentry = \"cube\"\nsamples = 256\n\
        relations = [{ kind = \"odd\", inputs = [\"x\"] }]\ndefines = { ADD = [0.0, 0.5] }\n\
        [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n";

    /// Tests that passed and that failed. What they print goes to a file: who reads the output of this
    /// project's own tests would take it for theirs.
    fn run(folder: &Path, filter: Option<&str>) -> (u64, u64) {
        let log = tempfile::NamedTempFile::new().unwrap();
        let arguments = Arguments {
            filter: filter.map(str::to_owned),
            test_threads: Some(1),
            logfile: Some(log.path().display().to_string()),
            ..Arguments::default()
        };
        let conclusion = libtest_mimic::run(&arguments, trials(folder));
        (conclusion.num_passed, conclusion.num_failed)
    }

    #[test]
    fn every_suite_and_variant_is_a_test() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("inner")).unwrap();
        fs::write(folder.path().join("inner/cube.suite.toml"), SUITE).unwrap();
        fs::write(folder.path().join("inner/cube.glsl"), "float cube(float x) { return x * x * x + ADD; }").unwrap();
        let all = trials(folder.path());
        let names: Vec<&str> = all.iter().map(|trial| trial.name()).collect();
        assert_eq!(names, ["inner/cube[ADD=0.0]", "inner/cube[ADD=0.5]"]);
        assert!(all.iter().all(|trial| trial.kind() == "function"));
        assert_eq!(run(folder.path(), None), (1, 1), "x^3 + 0.5 is not odd");
        let saved = fs::read_to_string(folder.path().join("inner/cube.regressions")).unwrap();
        assert!(saved.contains("cube[ADD=0.5] x="), "{saved}");
        assert_eq!(run(folder.path(), Some("ADD=0.0")), (1, 0));
    }

    #[test]
    fn a_folder_without_suites_and_a_suite_that_is_wrong_fail() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(run(folder.path(), None), (0, 1));
        assert_eq!(run(&folder.path().join("gone"), None), (0, 1));
        fs::write(folder.path().join("cube.suite.toml"), SUITE.replace("odd", "od")).unwrap();
        fs::write(folder.path().join("cube.glsl"), "float cube(float x) { return x; }").unwrap();
        assert_eq!(run(folder.path(), None), (0, 1));
    }
}
