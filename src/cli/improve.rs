//! `shadercheck improve`: formulas that lose fewer bits than the expressions of a shader.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Context as _;
use clap::Args;

use super::below;
use super::check::{Format, profile, shell_word};
use super::compose::ComposeArgs;
use super::fuzz::{Inputs, all_known, subjects};
use super::includes::{self, IncludedText};
use super::inputs::InputArgs;
use super::lint::{diff, write};
use super::outcomes::{Outcome, Outcomes};
use super::shard::{Printed, Printing, ShardArgs, Terminal};
use super::status::ExitStatus;
use base::text::{EditList, Shown as _, SourceFile};
use engine::fuzz::{Domain, Subject};
use engine::improve::{self, Request};
use engine::session::{At, Job, Seen};
use engine::shard::Identity;
use hosts::Language;
use judge::profile::{Profile, by_name};
use lanes::{Lane, interrupt};
use lint::fix::FixedFile;
use program::Written;
use report::improve::{FileReport, Summary, json};

/// What bounds of whole functions are derived from, where no profile is asked for.
const BOUNDS: &str = "vulkan-1.4";

/// Points of a proof, when none are asked for.
const SAMPLES: u64 = 1 << 20;

/// Arguments of `shadercheck improve`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Rules write each expression that loses bits in binary32 in other ways, such as 1 − cos x = 2 sin²(x/2), \
differences of roots by their conjugate, or ln(1 + x) by artanh. Local variables that are set once are expanded; \
textures, calls and choices are opaque inputs. The forms that lose least are proved: in real numbers they equal \
the original at all points, in binary64 and, where that has too few digits, in 320 bits. Then the judge compares \
both functions, with the bounds of a device and on the lanes. At most three proposals are shown; nothing is \
written without --fix.

Names and uses decide what inputs stand for, as in `fuzz`. A comment before the function states ranges,

  // shadercheck: lat in [-85, 85]

and so does --domain. The range of an input of an expression must have two ends.

Exit status: 0 nothing better was found, or it was written; 1 there are proposals, or a file does not compile; 2 \
usage.")]
pub struct ImproveArgs {
    /// Shader files in GLSL or WGSL; `FILE:LINE` for all expressions on one line, however little they lose
    #[arg(value_name = "PATH", default_value = ".")]
    pub files: Vec<PathBuf>,
    /// Only functions of this name, or one overload by its types: `f(vec3, float)`
    #[arg(long, value_name = "NAME")]
    pub function: Vec<String>,
    /// What is said of the files and their inputs
    #[command(flatten)]
    pub input: InputArgs,
    /// Lanes that run both formulas
    #[arg(long, value_name = "LANE", value_delimiter = ',', default_value = "embedded")]
    pub lane: Vec<String>,
    /// Judge proposals by this profile alone: a shipped one by name, or a file that `calibrate` wrote [default: the
    /// promises of Vulkan, WebGPU and OpenGL, and all shipped devices]
    #[arg(long, value_name = "PROFILE")]
    pub profile: Option<String>,
    /// Points of the proof of a proposal
    #[arg(long, value_name = "N", default_value_t = SAMPLES, value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: u64,
    /// Write the first proposal of each expression into its file
    #[arg(long)]
    pub fix: bool,
    /// Which files of the run: file `k` is done by shard `k` modulo N
    #[command(flatten)]
    pub sharing: ShardArgs,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// Runs the command: the result goes to `out`, complaints to `err`.
///
/// # Errors
/// When a file cannot be read or written, is neither GLSL nor WGSL, a name is unknown, a range has no end, a lane is not available, or
/// output fails.
pub fn run(args: &ImproveArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    let shard = args.sharing.shard()?;
    anyhow::ensure!(shard.is_none() || !args.fix, "--shard does a part of the files; --fix is for a run without it");
    let stated = args.input.domains()?;
    let Some(profile) = profile::named(args.profile.as_deref().unwrap_or(BOUNDS))? else {
        anyhow::bail!("--profile: a proposal needs bounds; `none` has none");
    };
    let profile: &Profile = &profile;
    let devices = if args.profile.is_some() { vec![profile] } else { improve::shipped() };
    let opened = super::lanes::opened(&args.lane, false)?;
    let lanes: Vec<&dyn Lane> = opened.iter().map(AsRef::as_ref).collect();
    let improved = |path: &Path| matches!(Written::of_path(&path.to_string_lossy()), Written::Glsl | Written::Wgsl);
    let (paths, searched) = below::shaders(&args.files, improved)?;
    let (inputs, known, broken) = (Inputs::new(&stated), Vec::new(), false);
    let key = |shards| identity(args, shards, &paths, (profile, &lanes));
    let mut files =
        Files { args, paths: &paths, searched, profile, devices: &devices, lanes: &lanes, inputs, known, broken };
    args.sharing.run(&mut files, Outcomes(Vec::new()), key, &mut Terminal::new(args.format, color, out, err))
}

/// The name of the parameter with the name of the profile.
const PROFILE: &str = "profile";

/// Everything that the result of a run depends on.
fn identity(
    args: &ImproveArgs,
    shards: u64,
    paths: &[PathBuf],
    (profile, lanes): (&Profile, &[&dyn Lane]),
) -> Identity {
    let identity = Identity::new("improve", args.input.seed, shards)
        .with("inputs", args.input.words())
        .with("--function", args.function.join("; "))
        .with("--profile", args.profile.as_deref().unwrap_or_default())
        .with(PROFILE, &profile.name)
        .with("--samples", args.samples)
        .on(lanes.iter().map(|lane| lane.description()));
    let of = |all: Identity, path: &PathBuf| match text(args, path) {
        Ok((source, _)) => all.of(&format!("file `{}`", path.shown()), source.file.text()),
        Err(_) => all,
    };
    paths.iter().fold(identity, of)
}

/// A file, and the line that alone is meant.
fn text(args: &ImproveArgs, path: &Path) -> anyhow::Result<(IncludedText, Option<usize>)> {
    let (file, line) = at_line(path);
    let compose = ComposeArgs::default();
    let given = args.input.reading(Some(&compose), None);
    let is_host = matches!(hosts::language_of(&file.to_string_lossy()), Some(Language::Host | Language::Script));
    // The line tells one of several shaders as well.
    let mut source = if is_host && args.input.stage().is_none() {
        includes::read_one(path, &given)?
    } else {
        includes::read(&file, &given)?
    };
    let path = file;
    source.stage = args.input.stage().unwrap_or(source.stage);
    anyhow::ensure!(
        matches!(Written::of(&source.file), Written::Glsl | Written::Wgsl),
        "`{}`: expressions of GLSL and WGSL are improved; translate it, or improve the formula in a file of its own",
        path.shown()
    );
    Ok((source, line))
}

/// The files of a run.
struct Files<'a> {
    args: &'a ImproveArgs,
    paths: &'a [PathBuf],
    /// They were found in a folder.
    searched: bool,
    profile: &'a Profile,
    devices: &'a [&'a Profile],
    lanes: &'a [&'a dyn Lane],
    inputs: Inputs<'a>,
    known: Vec<String>,
    /// A file does not compile, of this shard or of another: what is in it is not known.
    broken: bool,
}

/// A file with its functions and their inputs.
struct Unit {
    source: IncludedText,
    line: Option<usize>,
    subjects: Vec<(Subject, Domain)>,
}

impl Job for Files<'_> {
    type Unit = Result<Unit, Outcome<FileReport>>;
    type Part = ShardResult;
    type Error = anyhow::Error;
    type Event<'e> = Seen<'e>;

    fn unit(&mut self, number: u64, _: &mut At<'_, Self>) -> anyhow::Result<Option<Self::Unit>> {
        let args = self.args;
        let Some(path) = self.paths.get(number as usize) else {
            if !self.broken {
                all_known(&args.function, &self.known)?;
                self.inputs.all_used()?;
            }
            return Ok(None);
        };
        let (source, line) = match text(args, path) {
            Ok(text) => text,
            Err(error) if self.searched => return Ok(Some(Err(Outcome::Nothing(format!("left out: {error:#}\n"))))),
            Err(error) => return Err(error),
        };
        let (errors, subjects) = subjects((&args.function, &args.input.define), &source, &mut self.known)?;
        if !errors.is_empty() {
            self.broken = true;
            return Ok(Some(Err(Outcome::broken(&errors))));
        }
        let mut with_inputs = Vec::new();
        for subject in subjects {
            let domain = self.inputs.domain(&subject)?;
            with_inputs.push((subject, domain));
        }
        Ok(Some(Ok(Unit { source, line, subjects: with_inputs })))
    }

    fn run(&mut self, (number, unit): (u64, Self::Unit), at: &mut At<'_, Self>) -> anyhow::Result<()> {
        let outcome = match unit {
            Ok(Unit { source, line, subjects }) => {
                let (args, profile, devices) = (self.args, self.profile, self.devices);
                let (input, samples) = (&args.input, args.samples);
                let run = Run { input, samples, source: &source, line, profile, devices, lanes: self.lanes };
                run.file(&subjects, args.fix)?.map_or_else(|| Outcome::Broken(String::new()), Outcome::Report)
            }
            Err(outcome) => outcome,
        };
        if let Some(said) = outcome.said() {
            at.observer.event(Seen::Said(said))?;
        }
        at.part.0.push((number, outcome));
        Ok(())
    }
}

/// What came of some files.
pub type ShardResult = Outcomes<FileReport>;

impl Printed for ShardResult {
    fn print(self, mut to: Printing<'_>) -> anyhow::Result<ExitStatus> {
        let (files, broken) = self.reports(&mut to)?;
        let profile = to.identity.parameters.get(PROFILE).cloned().unwrap_or_default();
        let summary = Summary { seed: to.identity.seed, profile, files };
        let printed = if !to.format.is_text() { json(&summary) } else { report::improve::text(&summary, to.color) };
        to.out.write_all(printed.as_bytes())?;
        let open = summary.files.iter().any(|file| file.patch.is_some() && !file.written);
        Ok(match to.ended()? {
            Some(status) => status,
            None if broken || open => ExitStatus::Findings,
            None => ExitStatus::Clean,
        })
    }
}

/// A file and a line of it: `a.frag:12`.
fn at_line(path: &std::path::Path) -> (PathBuf, Option<usize>) {
    let parts = path.to_str().filter(|_| !path.is_file()).and_then(|text| text.rsplit_once(':'));
    match parts.and_then(|(file, line)| Some((file, line.parse().ok()?))) {
        Some((file, line)) => (PathBuf::from(file), Some(line)),
        None => (path.to_owned(), None),
    }
}

/// One file under way.
struct Run<'a> {
    input: &'a InputArgs,
    samples: u64,
    source: &'a IncludedText,
    line: Option<usize>,
    profile: &'a Profile,
    devices: &'a [&'a Profile],
    lanes: &'a [&'a dyn Lane],
}

/// A formula that loses fewer bits than what stands at a line of a function.
pub(super) fn better(
    (source, input): (&IncludedText, &InputArgs),
    (subject, domain): (&Subject, &Domain),
    line: usize,
) -> Option<String> {
    if !matches!(Written::of(&source.file), Written::Glsl | Written::Wgsl) || subject.ready.is_err() {
        return None;
    }
    let (profile, devices) = (by_name(BOUNDS)?, improve::shipped());
    let run = Run { input, samples: SAMPLES, source, line: Some(line), profile, devices: &devices, lanes: &[] };
    let found = run.expressions(std::slice::from_ref(&(subject, domain))).ok()??;
    found.0.into_iter().find_map(|report| Some(report.proposals.into_iter().next()?.text))
}

/// What came of expressions, and functions that were not looked at.
type Found = (Vec<improve::Report>, Vec<(String, String)>);

impl Run<'_> {
    /// The report; none where there is no syntax tree.
    fn file(&self, subjects: &[(Subject, Domain)], fix: bool) -> anyhow::Result<Option<FileReport>> {
        let subjects: Vec<(&Subject, &Domain)> = subjects.iter().map(|(subject, domain)| (subject, domain)).collect();
        let Some((expressions, not_run)) = self.expressions(&subjects)? else { return Ok(None) };
        let mut report = FileReport { file: self.source.name.clone(), expressions, not_run, ..FileReport::default() };
        self.patched(&self.source.author()?, &mut report, fix)?;
        Ok(Some(report))
    }

    fn expressions(&self, subjects: &[(&Subject, &Domain)]) -> anyhow::Result<Option<Found>> {
        let own = self.source.author()?;
        let module = if Written::of(&self.source.file) == Written::Wgsl { self.source.module().ok() } else { None };
        let parsed = module.is_none().then(|| self.source.parsed(&self.input.define).shader);
        let tree = module.as_ref().and_then(|module| module.tree()).or(parsed.as_ref());
        let Some(shader) = tree else { return Ok(None) };
        let (mut expressions, mut not_run) = Found::default();
        let request = Request {
            samples: self.samples,
            seed: self.input.seed,
            profile: self.profile,
            devices: self.devices,
            line: self.line,
            nodes: improve::NODES,
            time: Duration::from_secs(4),
            command: format!("shadercheck improve {}", shell_word(&self.source.given)),
        };
        let halves = improve::halves(shader);
        for (subject, domain) in subjects {
            if halves.contains(&subject.name) {
                not_run.push((subject.label.clone(), improve::OF_HALVES.to_owned()));
                continue;
            }
            if let Err(why) = &subject.ready {
                not_run.push((subject.label.clone(), why.clone()));
                continue;
            }
            let again = |file: &SourceFile| self.changed(file, subject);
            let found = improve::run((shader, &own, subject), domain, self.lanes, &request, &again);
            expressions.extend(found.map_err(|why| anyhow::anyhow!("{}: {why}", subject.at))?);
            if interrupt::asked() {
                break;
            }
        }
        Ok(Some((expressions, not_run)))
    }

    /// The function in a changed file.
    fn changed(&self, file: &SourceFile, subject: &Subject) -> Result<Vec<Subject>, String> {
        let text = self.source.changed(file, &self.input.reading(None, None)).map_err(|error| error.to_string())?;
        let wanted = [subject.name.clone()];
        let (errors, subjects) =
            subjects((&wanted, &self.input.define), &text, &mut Vec::new()).map_err(|error| error.to_string())?;
        errors
            .first()
            .map_or(Ok(subjects), |error| Err(format!("the changed text does not compile: {}", error.message)))
    }

    /// The patch of the first proposals, written where that is asked for.
    fn patched(&self, own: &SourceFile, report: &mut FileReport, fix: bool) -> anyhow::Result<()> {
        let mut edits = EditList::new();
        for expression in &report.expressions {
            if let Some(first) = expression.proposals.first() {
                edits.push(first.edit.clone());
            }
        }
        if edits.is_empty() {
            return Ok(());
        }
        let changed = edits.apply(own.text()).context("internal error, please report: the proposals overlap")?;
        let after = SourceFile::new(own.name(), changed.text.as_str());
        if fix {
            write::replace(&self.source.path, own.text().as_bytes(), after.text().as_bytes())?;
            report.written = true;
        }
        report.patch = Some(diff::unified(&FixedFile { before: own.clone(), after }));
        Ok(())
    }
}
