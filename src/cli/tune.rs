//! `shadercheck tune`: which declarations of a shader may be `mediump`.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::below;
use super::check::Format;
use super::compose::ComposeArgs;
use super::document;
use super::fuzz::{Inputs, all_known, subjects};
use super::includes::{self, IncludedText};
use super::inputs::InputArgs;
use super::lint::{diff, write};
use super::status::ExitStatus;
use base::diagnostic::Lang;
use base::text::{Shown as _, SourceFile};
use engine::fuzz::Subject;
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
    let stage = args.input.stage();
    let domains = args.input.domains()?;
    let request =
        Request { samples: args.samples, seed: args.input.seed, stated: tolerances(args)?, texels: args.texture_size };
    let mut inputs = Inputs::new(&domains);
    let mut summary = Summary { seed: args.input.seed, files: Vec::new() };
    let mut broken = false;
    let compose = ComposeArgs::default();
    let (files, searched) =
        below::shaders(&args.files, |path| Written::of_path(&path.to_string_lossy()) == Written::Glsl)?;
    'files: for path in &files {
        let reading = args.input.reading(Some(&compose), None);
        let mut sources = match includes::read_all(path, &reading, stage) {
            Ok(sources) => sources,
            Err(error) if searched => {
                writeln!(err, "left out: {error:#}")?;
                continue;
            }
            Err(error) => return Err(error),
        };
        let count = sources.len();
        for number in 0..count {
            let Some(source) = sources.get_mut(number) else { break };
            source.stage = stage.unwrap_or(source.stage);
            anyhow::ensure!(
                Written::of(&source.file) == Written::Glsl,
                "`{}`: only GLSL has qualifiers of precision to tune; in WGSL declare `f16` where the report of a translation \
                 (`shadercheck translate --to glsl`) says `mediump`",
                path.shown()
            );
            let mut tuned = Tuned { args, request: &request, inputs: &mut inputs, err };
            match tuned.one(source)? {
                Outcome::Report(file) => {
                    if file.written {
                        // It is there for the next shader of the file.
                        sources = includes::read_all(path, &reading, stage)?;
                    }
                    summary.files.push(*file);
                }
                Outcome::Broken => broken = true,
                // Of several shaders those are tuned that can be.
                Outcome::Nothing(why) if count > 1 || searched => writeln!(err, "note: {}: {why}", source.name)?,
                Outcome::Nothing(why) => anyhow::bail!("{why}"),
            }
            if interrupt::asked() {
                break 'files;
            }
        }
    }
    if !broken && interrupt::signal().is_none() {
        inputs.all_used()?;
    }
    match args.format {
        Format::Text => out.write_all(text(&summary, color).as_bytes())?,
        Format::Json => out.write_all(json(&summary).as_bytes())?,
    }
    out.flush()?;
    let open = |file: &FileReport| file.report.beyond.is_some() || (file.patch.is_some() && !file.written);
    Ok(match interrupt::signal() {
        Some(signal) => ExitStatus::Interrupted(signal),
        None if broken || summary.files.iter().any(open) => ExitStatus::Findings,
        None => ExitStatus::Clean,
    })
}

/// What came of one shader.
enum Outcome {
    Report(Box<FileReport>),
    /// It does not compile, which was told.
    Broken,
    /// Why there is nothing to report.
    Nothing(String),
}

/// What the shaders of a run share.
struct Tuned<'a, 'i> {
    args: &'a TuneArgs,
    request: &'a Request,
    inputs: &'a mut Inputs<'i>,
    err: &'a mut dyn Write,
}

impl Tuned<'_, '_> {
    fn one(&mut self, source: &IncludedText) -> anyhow::Result<Outcome> {
        let args = self.args;
        let wanted: Vec<String> = args.entry.iter().cloned().collect();
        let own = source.author()?;
        let mut known = Vec::new();
        let (errors, subjects) = subjects((&wanted, &args.input.define), source, &mut known)?;
        for error in &errors {
            self.err.write_all(report::diagnostics::text(error, Lang::En, false).as_bytes())?;
        }
        if !errors.is_empty() {
            return Ok(Outcome::Broken);
        }
        all_known(&wanted, &known)?;
        let subject = match chosen(&subjects, args.entry.as_deref()) {
            Ok(subject) => subject,
            Err(why) => return Ok(Outcome::Nothing(format!("`{}`: {why}", source.name))),
        };
        let domain = self.inputs.domain(subject)?;
        let parsed = source.parsed(&args.input.define);
        let again = |file: &SourceFile| match source.changed(file, &args.input.reading(None, None)) {
            Ok(changed) => changed.parsed(&args.input.define),
            Err(_) => Shader::parse_with(file, source.stage, &args.input.define),
        };
        let report = match tune::run((&parsed, &own, subject), &domain, self.request, &again) {
            Ok(report) => report,
            Err(why) => return Ok(Outcome::Nothing(format!("{}: {why}", subject.at))),
        };
        let mut file = FileReport { file: source.name.clone(), report, patch: None, written: false };
        let after = file.report.after.clone();
        if after.text() != own.text() {
            if args.fix {
                let path = document::file_of(&source.path);
                write::replace(&path, own.text().as_bytes(), after.text().as_bytes())?;
                file.written = true;
            }
            file.patch = Some(diff::unified(&FixedFile { before: own, after }));
        }
        Ok(Outcome::Report(Box::new(file)))
    }
}

/// The function whose outputs count.
fn chosen<'s>(subjects: &'s [Subject], entry: Option<&str>) -> Result<&'s Subject, String> {
    let labels = || subjects.iter().map(|subject| format!("`{}`", subject.label)).collect::<Vec<_>>().join(", ");
    match (subjects, entry) {
        ([], _) => Err("nothing to tune: it has no function with a body".to_owned()),
        ([one], _) => Ok(one),
        (_, None) => subjects.iter().find(|subject| subject.name == "main").ok_or_else(|| {
            format!("it has no `main`: name the function whose outputs count with --entry, of {}", labels())
        }),
        (_, Some(_)) => Err(format!("--entry names several functions: give one of {}", labels())),
    }
}
