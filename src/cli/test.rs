//! `shadercheck test`: tests that stand in shaders.

use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};

use super::below;
use super::check::{profile, select};
use super::compose::{ComposeArgs, Given};
use super::fuzz::subjects;
use super::includes::{self, IncludedText};
use super::lint::files::name;
use super::status::ExitStatus;
use super::waiting::Waiting;
use base::diagnostic::{Diagnostic, Severity};
use base::text::{Shown as _, SourceFile};
use disk::fresh;
use engine::coverage::{Coverage, Lcov, Share};
use engine::fuzz::{self, Subject};
use engine::mutate::Operator;
use engine::unit_test::{self, Marked, Passing, Request, UnitTest};
use lanes::{Lane, embedded, interrupt};
use program::{ModuleText, Written};
use report::mutate::Summary as Mutated;
use report::unit_test::{FileReport, Summary, TestReport, json, junit, line, text};
use syntax::{Shader, Stage};

/// The profile that bounds are derived from where none is named.
const PROFILE: &str = "vulkan-1.4";

/// Formats that tests have of their own; the others are those of diagnostics.
const OWN: [(&str, &str); 3] =
    [("text", "For people"), ("json", "For programs"), ("junit", "Test cases, for CI services")];
/// Formats of diagnostics that make sense for a run of tests.
const SHARED: [&str; 3] = ["github", "gitlab", "rdjson"];

/// Arguments of `shadercheck test`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_long_help = "\
A test in WGSL is a function without parameters, marked `@test`, that calls the assertions of the package `wgsl_test` of \
WESL: expect, expectEq, expectNear, expectWithin and expectUlp, with Vec2, Vec3 and Vec4 behind the last three for vectors.

  import package::color::luminance;
  import wgsl_test::expectNear;
  @test fn white() { expectNear(luminance(vec3f(1.0)), 1.0); }

In GLSL it is a comment that begins with `@test`; the same assertions take vectors as they are.

  // @test white
  // expectNear(luminance(vec3(1.0)), 1.0);

A test is run by the interpreter and on a lane. An expectation that fails is an error; NaN is near nothing. One that holds \
there, but is stricter than what a conforming device may be off, is a warning, with the tolerance that would do.

Exit status: 0 all tests passed; 1 a test failed, or a file does not compile; 2 usage, or no test could be run.")]
pub struct TestArgs {
    /// Shader files, and folders to search for those with tests
    #[arg(value_name = "PATH", default_value = ".")]
    pub paths: Vec<PathBuf>,
    /// Only tests whose name contains one of these
    #[arg(long, value_name = "TEXT")]
    pub filter: Vec<String>,
    /// Count an expectation that a conforming device may break as a failure
    #[arg(long)]
    pub strict: bool,
    /// Value of a macro, of a feature, or of an `override` constant of WGSL: `--define WIDTH=8`; repeatable
    #[arg(short = 'D', long, value_name = "NAME=VALUE", value_parser = super::definition::definition)]
    pub define: Vec<(String, String)>,
    /// Folders to search for imported and included files
    #[arg(short = 'I', long = "include", value_name = "FOLDER")]
    pub include: Vec<PathBuf>,
    /// What is stated about parts of texts in WGSL
    #[command(flatten)]
    pub compose: ComposeArgs,
    /// Lanes, of those that `shadercheck lanes` lists [default: the first that runs a test]
    #[arg(long, value_name = "LANE", value_delimiter = ',')]
    pub lane: Vec<String>,
    /// Run each test on every available lane
    #[arg(long, conflicts_with = "lane")]
    pub all_lanes: bool,
    /// Profile for bounds: a shipped one by name, or a file that `calibrate` wrote
    #[arg(long, value_name = "PROFILE", default_value = PROFILE)]
    pub profile: String,
    /// Write which lines, functions and branches the tests reach, as LCOV
    #[arg(long, value_name = "FILE")]
    pub coverage: Option<PathBuf>,
    /// Format of the result
    #[arg(long, value_parser = formats(), default_value = "text")]
    pub format: String,
}

fn formats() -> PossibleValuesParser {
    let shared = report::lint::FORMATS.iter().filter(|format| SHARED.contains(&format.name));
    let own = OWN.into_iter().map(|(name, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(own.chain(shared.map(|format| PossibleValue::new(format.name).help(format.summary))))
}

impl TestArgs {
    /// The tests of these paths, or of the current folder.
    pub(super) fn of(paths: &[String], format: &str) -> Self {
        let paths: Vec<PathBuf> = paths.iter().map(PathBuf::from).collect();
        let paths = if paths.is_empty() { vec![PathBuf::from(".")] } else { paths };
        Self { paths, profile: PROFILE.to_owned(), format: format.to_owned(), ..Self::default() }
    }

    /// True where each path has a test and none a suite, and tests are reported in the format.
    pub(super) fn applies(&self) -> bool {
        if !self.paths.iter().all(|path| select::is_without_suites(path)) {
            return false;
        }
        let known = OWN.iter().map(|(name, _)| *name).chain(SHARED).any(|name| name == self.format);
        known && marked(&self.paths, &mut std::io::sink()).is_ok()
    }
}

/// Runs the command: the result goes to `out`, notes and complaints to `err`.
///
/// # Errors
/// When a file cannot be read, no file has a test, a lane is not available, or output fails.
pub fn run(args: &TestArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    let _waiting = Waiting::begin();
    let Some(profile) = profile::named(&args.profile)? else {
        anyhow::bail!("--profile: tests are held against bounds; `none` has none");
    };
    let files = marked(&args.paths, err)?;
    let opened = super::lanes::opened(&args.lane, args.lane.is_empty())?;
    let lanes: Vec<&dyn Lane> = opened.iter().map(AsRef::as_ref).collect();
    let many = files.len() > 1;
    let mut summary = Summary { files: Vec::new(), profile: profile.name.clone(), strict: args.strict };
    let mut covered = args.coverage.as_ref().map(|path| (path, Covered::default()));
    for (path, file, marked) in files {
        let request = Request {
            lanes: &lanes,
            all_lanes: args.all_lanes || !args.lane.is_empty(),
            profile: &profile,
            sites: &marked.sites,
        };
        let covered = covered.as_mut().map(|(_, covered)| covered);
        let report = of_file(args, file, &read(args, &path, &marked)?, (&request, covered))?;
        if args.format == "text" {
            report.notes.iter().try_for_each(|note| writeln!(err, "note: {note}"))?;
            if many {
                writeln!(out, "{}", report.file.name())?;
            }
            report.tests.iter().try_for_each(|test| out.write_all(line(&summary, test, color).as_bytes()))?;
            out.flush()?;
        }
        summary.files.push(report);
        if interrupt::asked() {
            break;
        }
    }
    if let Some((path, covered)) = covered {
        let lcov = covered.lcov(&args.define);
        let context = || format!("cannot write `{}`", path.shown());
        fresh::write(path, lcov.text.as_bytes()).with_context(context)?;
        let of = |share: Share, what: &str| format!("{} of {} {what}", share.reached, share.all);
        let (lines, functions) = (of(lcov.lines, "lines"), of(lcov.functions, "functions"));
        writeln!(err, "coverage: {lines}, {functions}, {}", of(lcov.branches, "branches"))?;
    }
    let printed = match args.format.as_str() {
        "text" => text(&summary, color),
        "json" => json(&summary),
        "junit" => junit(&summary).map_err(anyhow::Error::msg)?,
        other => {
            let root = std::env::current_dir().ok().map(|folder| name(&folder));
            let context = report::lint::Context { color, root, ..Default::default() };
            let format = report::lint::by_name(other).context("there is no such format")?;
            (format.write)(&summary.diagnostics(), &context)
        }
    };
    out.write_all(printed.as_bytes())?;
    let totals = summary.totals();
    Ok(match interrupt::signal() {
        Some(signal) => ExitStatus::Interrupted(signal),
        None if totals.failed + totals.broken > 0 => ExitStatus::Findings,
        None if totals.passed == 0 => {
            writeln!(err, "error: no test could be run{}", if args.filter.is_empty() { "" } else { "; see --filter" })?;
            ExitStatus::Error
        }
        None => ExitStatus::Clean,
    })
}

/// Files with their tests.
type MarkedFile = (PathBuf, SourceFile, Marked);

/// The files that have tests. One that is named has to have some.
fn marked(paths: &[PathBuf], err: &mut dyn Write) -> anyhow::Result<Vec<MarkedFile>> {
    let mut found = Vec::new();
    for path in paths {
        let searched = path.is_dir();
        let files = match searched {
            true => below::files(path)?.into_iter().filter(|file| below::stage_of(file).is_some()).collect(),
            false => vec![path.clone()],
        };
        let before = found.len();
        for path in files {
            match marked_file(&path) {
                Ok(Some((file, marked))) => found.push((path, file, marked)),
                // One file of many does not keep the others from being tested.
                Ok(None) => {}
                Err(error) if searched => writeln!(err, "left out: {error:#}")?,
                Err(error) => return Err(error),
            }
        }
        anyhow::ensure!(
            found.len() > before,
            "`{}` has no test: mark a function of WGSL with `@test`, or begin a comment of GLSL with it; see `shadercheck \
             test --help`",
            path.shown()
        );
    }
    Ok(found)
}

fn marked_file(path: &Path) -> anyhow::Result<Option<(SourceFile, Marked)>> {
    let file = super::translate::read(path)?;
    let stage = below::stage_of(path).unwrap_or(Stage::Library);
    Ok(unit_test::mark(&file, stage).map(|marked| (file, marked)))
}

/// A file with its tests as it is read, and the tests that are wanted.
struct ReadFile<'m> {
    source: IncludedText,
    tests: Vec<&'m UnitTest>,
}

/// Reads a file with its tests.
fn read<'m>(args: &TestArgs, path: &Path, marked: &'m Marked) -> anyhow::Result<ReadFile<'m>> {
    let compose = ComposeArgs { assign_bindings: true, ..args.compose.clone() };
    let reading = Given {
        folders: &args.include,
        defines: &args.define,
        compose: Some(&compose),
        entry: None,
        stage: None,
        chunks: None,
    };
    let source = includes::with_includes(&marked.file, path, &reading)?;
    // Nothing stands for what a text lacks: a name that nothing declares is a mistake in a test.
    let source = source.with_prelude(super::prelude(None));
    let wanted = |name: &str| args.filter.is_empty() || args.filter.iter().any(|text| name.contains(text));
    Ok(ReadFile { source, tests: marked.tests.iter().filter(|test| wanted(&test.name)).collect() })
}

/// What tests reach, and which functions are tests.
#[derive(Default)]
struct Covered {
    coverage: Coverage,
    /// Each with the name of its file.
    tests: HashSet<(String, String)>,
}

impl Covered {
    /// The report, without tests and what they are made of.
    fn lcov(&self, defines: &[(String, String)]) -> Lcov {
        let read = |file: &SourceFile| match Written::of(file) {
            Written::Wgsl => Shader::parse_wgsl(file).shader,
            _ => {
                let stage = below::stage_of(Path::new(file.name())).unwrap_or(Stage::Library);
                includes::read_glsl(file, stage, defines).shader
            }
        };
        self.coverage.lcov(&read, &|file, function| {
            file != compose::ASSERTIONS && !self.tests.contains(&(file.to_owned(), function.to_owned()))
        })
    }
}

/// Runs the tests of a file.
fn of_file(
    args: &TestArgs,
    file: SourceFile,
    ReadFile { source, tests }: &ReadFile<'_>,
    (request, mut covered): (&Request<'_>, Option<&mut Covered>),
) -> anyhow::Result<FileReport> {
    let mut report = FileReport { file, notes: source.notes(), errors: Vec::new(), tests: Vec::new() };
    if tests.is_empty() {
        return Ok(report);
    }
    let entries: Vec<String> = tests.iter().map(|test| test.entry.clone()).collect();
    let (errors, subjects) = subjects((&entries, &args.define), source, &mut Vec::new())?;
    report.errors = errors;
    for test in tests.iter().filter(|_| report.errors.is_empty()) {
        let subject = subjects.iter().find(|subject| subject.name == test.entry);
        let ready = match (&test.refused, subject.map(|subject: &Subject| &subject.ready)) {
            (Some(why), _) | (None, Some(Err(why))) => Err(why.clone()),
            (None, Some(Ok(ready))) => Ok(ready),
            (None, None) => Err("internal error, please report: it got lost".to_owned()),
        };
        let outcome = ready.clone().and_then(|ready| unit_test::run(ready, request));
        if let (Some(covered), Ok(ready), Ok(_)) = (covered.as_deref_mut(), ready, &outcome) {
            let counted = covered.coverage.run(&ready.program, &unit_test::batch(ready));
            counted.map_err(|error| anyhow::anyhow!("{}", error.locate(&ready.program)))?;
            covered.tests.insert((report.file.name().to_owned(), test.function.clone()));
        }
        report.tests.push(TestReport { name: test.name.clone(), span: test.span, outcome });
        if interrupt::asked() {
            break;
        }
    }
    Ok(report)
}

/// Plants faults in what the tests of files call. Tests that fail, or cannot be run, are told and left out.
///
/// # Errors
/// When a file cannot be read or has no test, or output fails.
pub(super) fn mutants(
    args: &TestArgs,
    operators: &[&'static Operator],
    err: &mut dyn Write,
) -> anyhow::Result<Mutated> {
    let profile = profile::named(PROFILE)?.context("there is no such profile")?;
    let mut all = Mutated { lane: embedded::STRICT.to_owned(), ..Mutated::default() };
    for (path, file, marked) in marked(&args.paths, err)? {
        let request = Request { lanes: &[], all_lanes: false, profile: &profile, sites: &marked.sites };
        let read = read(args, &path, &marked)?;
        let report = of_file(args, file, &read, (&request, None))?;
        let name = report.file.name().to_owned();
        if !report.errors.is_empty() {
            all.failed.push((name, "it does not compile; `shadercheck test` says why".to_owned()));
            continue;
        }
        let mut passing = Vec::new();
        for (test, of) in read.tests.iter().zip(&report.tests) {
            match &of.outcome {
                Ok(ran) if !of.fails() => passing.push(Passing { test, ran }),
                Ok(_) => writeln!(err, "note: {name}: `{}` fails, and is left out", of.name)?,
                Err(why) => writeln!(err, "note: {name}: `{}` is left out: {why}", of.name)?,
            }
        }
        let ReadFile { source, .. } = &read;
        let found = match Written::of(&source.file) {
            Written::Glsl => {
                let (stage, parsed) = (source.stage, source.parsed(&args.define));
                let build = |file: &SourceFile, entries: &[String]| {
                    let parsed = includes::read_glsl(file, stage, &args.define);
                    first_error(&parsed.diagnostics)?;
                    fuzz::subjects(&parsed.shader, &|name| entries.iter().any(|own| own == name)).map_err(|bad| bad.why)
                };
                unit_test::mutate(&parsed.shader, &passing, operators, &build)
            }
            _ => {
                let text = source.module().map_err(|error| anyhow::anyhow!("{name}: {error}"))?;
                let values = source.values(&text, &args.define);
                let build = |file: &SourceFile, entries: &[String]| {
                    let text = ModuleText::read(file, Written::Wgsl).map_err(|error| error.to_string())?;
                    let wanted = |name: &str| entries.iter().any(|own| own == name);
                    fuzz::subjects_of_module(&text, &values, &wanted).map_err(|bad| bad.why)
                };
                let tree = text.tree().context("the text has no syntax tree")?;
                unit_test::mutate(tree, &passing, operators, &build)
            }
        };
        all.suites.extend(found);
        if interrupt::asked() {
            break;
        }
    }
    Ok(all)
}

fn first_error(found: &[Diagnostic]) -> Result<(), String> {
    let first = found.iter().find(|own| own.severity == Severity::Error);
    first.map_or(Ok(()), |first| Err(first.message.to_string()))
}
