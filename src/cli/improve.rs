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
use super::status::ExitStatus;
use super::translate;
use base::diagnostic::Lang;
use base::text::{EditList, Shown as _, SourceFile};
use engine::fuzz::Subject;
use engine::improve::{self, Request};
use judge::profile::Profile;
use lanes::{Lane, StandIn, Wanted, interrupt};
use lint::fix::FixedFile;
use program::Written;
use report::improve::{FileReport, Summary, json, text};

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
    /// Profile for bounds: a shipped one by name, or a file that `calibrate` wrote
    #[arg(long, value_name = "PROFILE", default_value = "vulkan-1.4")]
    pub profile: String,
    /// Points of the proof of a proposal
    #[arg(long, value_name = "N", default_value_t = SAMPLES, value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: u64,
    /// Write the first proposal of each expression into its file
    #[arg(long)]
    pub fix: bool,
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
    let stage = args.input.stage();
    let stated = args.input.domains()?;
    let Some(profile) = profile::named(&args.profile)? else {
        anyhow::bail!("--profile: a proposal needs bounds; `none` has none");
    };
    let opened = Wanted { stand_in: StandIn::Beside, ..Wanted::named(&args.lane) }.open()?;
    let missing: Vec<String> = opened.missing.iter().map(|(name, error)| format!("lane `{name}`: {error}")).collect();
    anyhow::ensure!(missing.is_empty(), "{}", missing.join("; "));
    let lanes: Vec<&dyn Lane> = opened.lanes.iter().map(AsRef::as_ref).collect();
    let mut inputs = Inputs::new(&stated);
    let mut known = Vec::new();
    let mut summary = Summary { seed: args.input.seed, profile: profile.name.clone(), files: Vec::new() };
    let mut broken = false;
    let improved = |path: &Path| matches!(Written::of_path(&path.to_string_lossy()), Written::Glsl | Written::Wgsl);
    let (files, searched) = below::shaders(&args.files, improved)?;
    for given in &files {
        let (path, line) = at_line(given);
        let compose = ComposeArgs::default();
        let mut source = match includes::read(&path, &args.input.reading(Some(&compose), None)) {
            Ok(source) => source,
            Err(error) if searched => {
                writeln!(err, "left out: {error:#}")?;
                continue;
            }
            Err(error) => return Err(error),
        };
        source.stage = stage.unwrap_or(source.stage);
        anyhow::ensure!(
            matches!(Written::of(&source.file), Written::Glsl | Written::Wgsl),
            "`{}`: expressions of GLSL and WGSL are improved; translate it, or improve the formula in a file of its own",
            path.shown()
        );
        let run = Run { args, source: &source, line, profile: &profile, lanes: &lanes };
        match run.file(&path, &mut inputs, &mut known, err)? {
            Some(report) => summary.files.push(report),
            None => broken = true,
        }
        if interrupt::asked() {
            break;
        }
    }
    if !broken && interrupt::signal().is_none() {
        all_known(&args.function, &known)?;
        inputs.all_used()?;
    }
    match args.format {
        Format::Text => out.write_all(text(&summary, color).as_bytes())?,
        Format::Json => out.write_all(json(&summary).as_bytes())?,
    }
    out.flush()?;
    Ok(match interrupt::signal() {
        Some(signal) => ExitStatus::Interrupted(signal),
        None if broken || (summary.counts().0 > 0 && !args.fix) => ExitStatus::Findings,
        None => ExitStatus::Clean,
    })
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
    args: &'a ImproveArgs,
    source: &'a IncludedText,
    line: Option<usize>,
    profile: &'a Profile,
    lanes: &'a [&'a dyn Lane],
}

impl Run<'_> {
    /// The report; none where the file does not compile, which is printed.
    fn file(
        &self,
        path: &std::path::Path,
        inputs: &mut Inputs<'_>,
        known: &mut Vec<String>,
        err: &mut dyn Write,
    ) -> anyhow::Result<Option<FileReport>> {
        let own = translate::read(path)?;
        let (errors, subjects) = subjects((&self.args.function, &self.args.input.define), self.source, known)?;
        for error in &errors {
            err.write_all(report::diagnostics::text(error, Lang::En, false).as_bytes())?;
        }
        if !errors.is_empty() {
            return Ok(None);
        }
        let module = if Written::of(&self.source.file) == Written::Wgsl { self.source.module().ok() } else { None };
        let parsed = module.is_none().then(|| self.source.parsed(&self.args.input.define).shader);
        let tree = module.as_ref().and_then(|module| module.tree()).or(parsed.as_ref());
        let Some(shader) = tree else { return Ok(None) };
        let request = Request {
            samples: self.args.samples,
            seed: self.args.input.seed,
            profile: self.profile,
            line: self.line,
            nodes: improve::NODES,
            time: Duration::from_secs(4),
            command: format!("shadercheck improve {}", shell_word(&self.source.given)),
        };
        let mut report = FileReport { file: self.source.name.clone(), ..FileReport::default() };
        let halves = improve::halves(shader);
        for subject in &subjects {
            if halves.contains(&subject.name) {
                report.not_run.push((subject.label.clone(), improve::OF_HALVES.to_owned()));
                continue;
            }
            if let Err(why) = &subject.ready {
                report.not_run.push((subject.label.clone(), why.clone()));
                continue;
            }
            let domain = inputs.domain(subject)?;
            let again = |file: &SourceFile| self.changed(file, subject);
            let found = improve::run((shader, &own, subject), &domain, self.lanes, &request, &again);
            report.expressions.extend(found.map_err(|why| anyhow::anyhow!("{}: {why}", subject.at))?);
            if interrupt::asked() {
                break;
            }
        }
        self.patched(path, &own, &mut report)?;
        Ok(Some(report))
    }

    /// The function in a changed file.
    fn changed(&self, file: &SourceFile, subject: &Subject) -> Result<Vec<Subject>, String> {
        let text =
            self.source.changed(file, &self.args.input.reading(None, None)).map_err(|error| error.to_string())?;
        let wanted = [subject.name.clone()];
        let (errors, subjects) =
            subjects((&wanted, &self.args.input.define), &text, &mut Vec::new()).map_err(|error| error.to_string())?;
        errors
            .first()
            .map_or(Ok(subjects), |error| Err(format!("the changed text does not compile: {}", error.message)))
    }

    /// The patch of the first proposals, written where that is asked for.
    fn patched(&self, path: &std::path::Path, own: &SourceFile, report: &mut FileReport) -> anyhow::Result<()> {
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
        if self.args.fix {
            write::replace(path, own.text().as_bytes(), after.text().as_bytes())?;
            report.written = true;
        }
        report.patch = Some(diff::unified(&FixedFile { before: own.clone(), after }));
        Ok(())
    }
}
