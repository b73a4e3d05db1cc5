//! `shadercheck tune`: which declarations of a shader may be `mediump`.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::below;
use super::check::Format;
use super::compose::ComposeArgs;
use super::document;
use super::fuzz::{Inputs, all_known, subjects};
use super::includes::{self, IncludedText};
use super::inputs::InputArgs;
use super::lint::{diff, write};
use super::outcomes::{Outcome, Outcomes};
use super::shard::{Printed, Printing, ShardArgs, Terminal};
use super::status::ExitStatus;
use base::text::{Shown as _, SourceFile};
use engine::fuzz::{Domain, Subject};
use engine::session::{At, Job, Seen};
use engine::shard::Identity;
use engine::tune::{self, Request, Stated, Tolerance};
use lanes::interrupt;
use lint::fix::FixedFile;
use program::Written;
use report::tune::{FileReport, Summary, json, text};
use syntax::Shader;

/// Samples of a proof, when none are asked for.
const SAMPLES: u64 = 1 << 14;

/// Arguments of `shadercheck tune`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Each declaration that holds floating-point numbers is tried at mediump and at highp: parameters, local \
variables, uniforms, inputs, outputs, results of functions. The result is the smallest set of highp declarations \
with which the outputs stay within half a step of their format on devices that err as far as GLSL ES and Vulkan \
allow: 10 bits, a range of 2^14. Colours of a fragment stage have 8 bits unless --target says otherwise; \
gl_Position may be off by half a pixel of --viewport; for other outputs state --error. On up to one sample in \
64, a decision (a comparison, floor, a texel) may come out on the other side of an edge that its operand is near \
to.

Names and uses decide what inputs stand for, as in `fuzz`. A comment before the function states ranges,

  // shadercheck: u_time in [0, 3600]

and so does --domain. A range must have two ends.

Exit status: 0 nothing can be lower and nothing is too low, or the patch was written; 1 there is a patch, the \
outputs are off whatever is declared, or a file does not compile; 2 usage.")]
pub struct TuneArgs {
    /// Shader files in GLSL ES, or in desktop GLSL with the qualifiers of 1.30; documents and host code with shaders,
    /// as a whole or at a line (`Renderer.java:12`)
    #[arg(value_name = "PATH", default_value = ".")]
    pub files: Vec<PathBuf>,
    /// Function whose outputs count [default: main]
    #[arg(long, value_name = "NAME")]
    pub entry: Option<String>,
    /// What is said of the files and their inputs
    #[command(flatten)]
    pub input: InputArgs,
    /// Largest error of outputs: `0.001`, `1/255`, or `v_uv=0.001` for one of them; repeatable
    #[arg(long, value_name = "[OUTPUT=]ERROR")]
    pub error: Vec<String>,
    /// Format of the outputs, which may be off by half a step of it: `rgba8`, `rgb10_a2`, `rgba16f`, or
    /// `o_normal=rgba16f`; repeatable
    #[arg(long, value_name = "[OUTPUT=]FORMAT")]
    pub target: Vec<String>,
    /// Size of the viewport in pixels; `gl_Position` may be off by half a pixel
    #[arg(long, value_name = "WxH", value_parser = viewport)]
    pub viewport: Option<[f64; 2]>,
    /// Width and height of textures; coordinates stay `highp` from 1024 texels on
    #[arg(long, value_name = "TEXELS", default_value_t = 2048, value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub texture_size: u32,
    /// Samples of the proof
    #[arg(long, value_name = "N", default_value_t = SAMPLES, value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: u64,
    /// Write the precisions into the files
    #[arg(long)]
    pub fix: bool,
    /// Which shaders of the run: shader `k` is done by shard `k` modulo N
    #[command(flatten)]
    pub sharing: ShardArgs,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// `1920x1080`.
fn viewport(text: &str) -> Result<[f64; 2], String> {
    let side = |text: &str| text.trim().parse::<u32>().ok().filter(|side| *side > 0).map(f64::from);
    let sides = text.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
    sides.ok_or_else(|| "give its width and height in pixels, such as 1920x1080".to_owned())
}

/// `0.001` or `1/255`.
fn error(text: &str) -> Option<f64> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((over, under)) => number(over)? / number(under)?,
        None => number(text)?,
    };
    (value.is_finite() && value > 0.0).then_some(value)
}

/// What the command line says of outputs.
fn tolerances(args: &TuneArgs) -> anyhow::Result<Stated> {
    let named = |text: &str| match text.split_once('=') {
        Some((name, value)) => (Some(name.trim().to_owned()), value.trim().to_owned()),
        None => (None, text.trim().to_owned()),
    };
    let mut all = Stated { viewport: args.viewport, ..Stated::default() };
    for option in &args.target {
        let (name, format) = named(option);
        let tolerance = Tolerance::of_format(&format)
            .map_err(|why| anyhow::anyhow!("--target: no format `{format}` is known: {why}"))?;
        all.named.push((name, tolerance));
    }
    for option in &args.error {
        let (name, value) = named(option);
        let value = error(&value).ok_or_else(|| {
            anyhow::anyhow!("--error `{option}`: give a number above 0, such as 0.001, 1/255 or v_uv=0.001")
        })?;
        all.named.push((name, Tolerance::Absolute(value)));
    }
    Ok(all)
}

/// Runs the command: the result goes to `out`, complaints to `err`.
///
/// # Errors
/// When a file cannot be read or written, is no GLSL, has nothing to tune, a name is unknown, a range has no end, an output
/// has no format, or output fails.
pub fn run(args: &TuneArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    let shard = args.sharing.shard()?;
    anyhow::ensure!(shard.is_none() || !args.fix, "--shard does a part of the shaders; --fix is for a run without it");
    let domains = args.input.domains()?;
    let request =
        Request { samples: args.samples, seed: args.input.seed, stated: tolerances(args)?, texels: args.texture_size };
    let wanted = |path: &Path| Written::of_path(&path.to_string_lossy()) == Written::Glsl;
    let (files, searched) = below::shaders(&args.files, wanted)?;
    let key = |shards| identity(args, shards, &files);
    let inputs = Inputs::new(&domains);
    let (read, next, broken) = (0, 0, false);
    let sources = Vec::new();
    let mut shaders = Shaders { args, request, files: &files, searched, inputs, broken, read, sources, next };
    args.sharing.run(&mut shaders, Outcomes(Vec::new()), key, &mut Terminal::new(args.format, color, out, err))
}

/// Everything that the result of a run depends on.
fn identity(args: &TuneArgs, shards: u64, files: &[PathBuf]) -> Identity {
    let identity = Identity::new("tune", args.input.seed, shards)
        .with("inputs", args.input.words())
        .with("--entry", args.entry.as_deref().unwrap_or_default())
        .with("--error", args.error.join("; "))
        .with("--target", args.target.join("; "))
        .with("--viewport", format!("{:?}", args.viewport))
        .with("--texture-size", args.texture_size)
        .with("--samples", args.samples);
    let texts = files.iter().filter_map(|path| texts(args, path).ok()).flatten();
    texts.fold(identity, |all, text| all.of(&format!("file `{}`", text.name), text.file.text()))
}

/// The shaders of a file.
fn texts(args: &TuneArgs, path: &Path) -> anyhow::Result<Vec<IncludedText>> {
    let compose = ComposeArgs::default();
    includes::read_all(path, &args.input.reading(Some(&compose), None), args.input.stage())
}

/// The shaders of all files, read file by file.
struct Shaders<'a> {
    args: &'a TuneArgs,
    request: Request,
    files: &'a [PathBuf],
    /// The files were found in a folder.
    searched: bool,
    inputs: Inputs<'a>,
    /// A shader does not compile, of this shard or of another: what is in it is not known.
    broken: bool,
    /// Files that were read, the shaders of the last one, and which of them comes next.
    read: usize,
    sources: Vec<IncludedText>,
    next: usize,
}

/// A shader that is tuned, or why it is not.
type Unit = Result<Box<(SourceFile, Subject, Domain)>, Outcome<FileReport>>;

impl Job for Shaders<'_> {
    type Unit = Unit;
    type Part = ShardResult;
    type Error = anyhow::Error;
    type Event<'e> = Seen<'e>;

    fn unit(&mut self, _: u64, at: &mut At<'_, Self>) -> anyhow::Result<Option<Unit>> {
        while self.next == self.sources.len() {
            let Some(path) = self.files.get(self.read) else {
                if !self.broken {
                    self.inputs.all_used()?;
                }
                return Ok(None);
            };
            (self.read, self.next) = (self.read + 1, 0);
            self.sources = match texts(self.args, path) {
                Ok(sources) => sources,
                Err(error) if self.searched => {
                    at.observer.event(Seen::Said(&format!("left out: {error:#}\n")))?;
                    Vec::new()
                }
                Err(error) => return Err(error),
            };
        }
        self.next += 1;
        let source = &mut self.sources[self.next - 1];
        source.stage = self.args.input.stage().unwrap_or(source.stage);
        anyhow::ensure!(
            Written::of(&source.file) == Written::Glsl,
            "`{}`: only GLSL has qualifiers of precision to tune; in WGSL declare `f16` where the report of a translation \
             (`shadercheck translate --to glsl`) says `mediump`",
            source.path.shown()
        );
        self.ready().map(Some)
    }

    fn run(&mut self, (number, unit): (u64, Unit), at: &mut At<'_, Self>) -> anyhow::Result<()> {
        let outcome = match unit {
            Ok(unit) => match self.tuned(*unit)? {
                Some(outcome) => outcome,
                None => return Ok(()),
            },
            Err(outcome) => outcome,
        };
        let outcome = match outcome {
            // Of several shaders those are tuned that can be.
            Outcome::Nothing(why) if self.sources.len() > 1 || self.searched => {
                Outcome::Nothing(format!("note: {}: {why}\n", self.sources[self.next - 1].name))
            }
            Outcome::Nothing(why) => anyhow::bail!("{why}"),
            Outcome::Report(_) | Outcome::Broken(_) => outcome,
        };
        if let Some(said) = outcome.said() {
            at.observer.event(Seen::Said(said))?;
        }
        at.part.0.push((number, outcome));
        Ok(())
    }
}

impl Shaders<'_> {
    /// The function of the shader under way whose outputs count, with its inputs.
    fn ready(&mut self) -> anyhow::Result<Unit> {
        let (args, source) = (self.args, &self.sources[self.next - 1]);
        let wanted: Vec<String> = args.entry.iter().cloned().collect();
        let own = source.author()?;
        let mut known = Vec::new();
        let (errors, subjects) = subjects((&wanted, &args.input.define), source, &mut known)?;
        if !errors.is_empty() {
            self.broken = true;
            return Ok(Err(Outcome::broken(&errors)));
        }
        all_known(&wanted, &known)?;
        match chosen(subjects, args.entry.as_deref()) {
            Ok(subject) => {
                let domain = self.inputs.domain(&subject)?;
                Ok(Ok(Box::new((own, subject, domain))))
            }
            Err(why) => Ok(Err(Outcome::Nothing(format!("`{}`: {why}", source.name)))),
        }
    }

    /// What comes of it; nothing where the run was interrupted, since devices were then not run to the end.
    fn tuned(
        &mut self,
        (own, subject, domain): (SourceFile, Subject, Domain),
    ) -> anyhow::Result<Option<Outcome<FileReport>>> {
        let (args, source) = (self.args, &self.sources[self.next - 1]);
        let parsed = source.parsed(&args.input.define);
        let again = |file: &SourceFile| match source.changed(file, &args.input.reading(None, None)) {
            Ok(changed) => changed.parsed(&args.input.define),
            Err(_) => Shader::parse_with(file, source.stage, &args.input.define),
        };
        let tuned = tune::run((&parsed, &own, &subject), &domain, &self.request, &again);
        let report = match tuned {
            _ if interrupt::asked() => return Ok(None),
            Ok(report) => report,
            Err(why) => return Ok(Some(Outcome::Nothing(format!("{}: {why}", subject.at)))),
        };
        let mut file = FileReport { file: source.name.clone(), report, patch: None, written: false };
        let (after, path) = (file.report.after.clone(), source.path.clone());
        if after.text() != own.text() {
            if args.fix {
                write::replace(&document::file_of(&path), own.text().as_bytes(), after.text().as_bytes())?;
                file.written = true;
                // It is there for the next shader of the file.
                self.sources = texts(args, &path)?;
            }
            file.patch = Some(diff::unified(&FixedFile { before: own, after }));
        }
        Ok(Some(Outcome::Report(file)))
    }
}

/// What came of some shaders.
pub type ShardResult = Outcomes<FileReport>;

impl Printed for ShardResult {
    fn print(self, mut to: Printing<'_>) -> anyhow::Result<ExitStatus> {
        let (files, broken) = self.reports(&mut to)?;
        let summary = Summary { seed: to.identity.seed, files };
        let printed = if !to.format.is_text() { json(&summary) } else { text(&summary, to.color) };
        to.out.write_all(printed.as_bytes())?;
        let open = |file: &FileReport| file.report.beyond.is_some() || (file.patch.is_some() && !file.written);
        Ok(match to.ended()? {
            Some(status) => status,
            None if broken || summary.files.iter().any(open) => ExitStatus::Findings,
            None => ExitStatus::Clean,
        })
    }
}

/// The function whose outputs count.
fn chosen(mut subjects: Vec<Subject>, entry: Option<&str>) -> Result<Subject, String> {
    let labels = |subjects: &[Subject]| {
        subjects.iter().map(|subject| format!("`{}`", subject.label)).collect::<Vec<_>>().join(", ")
    };
    let main = subjects.iter().position(|subject| subject.name == "main");
    match (subjects.len(), entry, main) {
        (0, _, _) => Err("nothing to tune: it has no function with a body".to_owned()),
        (1, _, _) => Ok(subjects.swap_remove(0)),
        (_, None, Some(main)) => Ok(subjects.swap_remove(main)),
        (_, None, None) => Err(format!(
            "it has no `main`: name the function whose outputs count with --entry, of {}",
            labels(&subjects)
        )),
        (_, Some(_), _) => Err(format!("--entry names several functions: give one of {}", labels(&subjects))),
    }
}
