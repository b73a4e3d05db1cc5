//! `shadercheck trace`: one case of a function, expression after expression, to the first that goes wrong.

use std::cell::RefCell;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::check::{Format, profile};
use super::compose::{ComposeArgs, Given};
use super::fuzz::{Inputs, all_known, subjects};
use super::hosts::Hosts;
use super::includes::{self, IncludedText};
use super::inputs::InputArgs;
use super::status::ExitStatus;
use super::waiting::Waiting;
use base::diagnostic::Lang;
use base::value::{Record, Scalar};
use engine::fuzz::{self, Domain, Ready, Subject};
use engine::trace::{self, Case, Request};
use judge::profile::Promises;
use lanes::Lane;
use property::Sample;
use report::trace::{Summary, json, text};

/// Samples among which a case is sought, when none are asked for.
const SAMPLES: u64 = 1 << 14;

/// Arguments of `shadercheck trace`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Without --case and --set, each function is run as `fuzz` does, and the smallest case of its worst finding is traced; a \
function without findings is traced if --function names it, at the inputs that lose most bits. A row is a number of an \
expression: what strict binary32 makes of it, what it is in real numbers with the most that a conforming device may be \
off, and the bits that are lost, log2 (1 + distance in ULP). With --lane, what the lane computes stands beside. Stores \
that are added for this keep its compiler from optimisations, so that the last bits may be others than without.

The origin is the first expression without a finite value, else the first at which a lane is farther off than a device \
may be or a decision falls otherwise than in real numbers, else the one that loses most bits beside those that its \
operands had lost. Whole numbers are not traced. A compute stage is traced as the first invocation of a dispatch, alone.

Exit status: 0 something was traced; 1 the file does not compile; 2 usage, or nothing could be traced.")]
pub struct TraceArgs {
    /// A shader file, or a document or host code with shaders at a line (`README.md:12`)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Only functions of this name, or one overload by its types: `f(vec3, float)`
    #[arg(long, value_name = "NAME")]
    pub function: Vec<String>,
    /// This case, copied from the `reproduce` line of a report; needs --function
    #[arg(long, value_name = "INPUTS", requires = "function")]
    pub case: Option<String>,
    /// The numbers of an input: `x=0.5`, `n=0,0,1`; one for each input of the function; needs --function
    #[arg(long, value_name = "INPUT=NUMBERS", requires = "function", allow_hyphen_values = true)]
    pub set: Vec<String>,
    /// Only what this output depends on: `gl_Position`, `color.x`
    #[arg(long, value_name = "NAME")]
    pub output: Option<String>,
    /// What is said of the file and its inputs
    #[command(flatten)]
    pub input: InputArgs,
    /// What is stated about parts of texts in WGSL
    #[command(flatten)]
    pub compose: ComposeArgs,
    /// Lanes whose values stand beside, of those that `shadercheck lanes` lists
    #[arg(long, value_name = "LANE", value_delimiter = ',')]
    pub lane: Vec<String>,
    /// Every available lane
    #[arg(long, conflicts_with = "lane")]
    pub all_lanes: bool,
    /// Seek a case among arbitrary inputs, whatever these may stand for
    #[arg(long)]
    pub arbitrary: bool,
    /// Seek a case among signed sums and products that do not fit 32 bits too
    #[arg(long)]
    pub strict_integers: bool,
    /// Profile for bounds: a shipped one by name, or a file that `calibrate` wrote
    #[arg(long, value_name = "PROFILE", default_value = "vulkan-1.4")]
    pub profile: String,
    /// Samples among which a case is sought
    #[arg(long, value_name = "N", default_value_t = SAMPLES, value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: u64,
    /// Show every step: all rounds of loops, and what no output depends on
    #[arg(long)]
    pub all: bool,
    /// Format of the result; json has every step
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// Runs the command: the result goes to `out`, complaints to `err`.
///
/// # Errors
/// When the file cannot be read, a name is unknown, a case does not fit the inputs, a lane is not available, or output
/// fails.
pub fn run(args: &TraceArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    anyhow::ensure!(
        args.case.is_none() || args.set.is_empty(),
        "--case and --set both state the inputs: give one of them"
    );
    let _waiting = Waiting::begin();
    let stated = args.input.domains()?;
    let Some(profile) = profile::named(&args.profile)? else {
        anyhow::bail!("--profile: a trace needs bounds; `none` has none");
    };
    let compose = ComposeArgs { assign_bindings: true, ..args.compose.clone() };
    let reading = args.input.reading(Some(&compose), args.function.first().map(String::as_str));
    let chunks = RefCell::default();
    let source = includes::read_one(&args.file, &Given { chunks: Some(&chunks), ..reading })?;
    let source = source.with_prelude(super::prelude(None)).assuming(&args.input.define, &mut Hosts::default());
    for note in source.notes() {
        writeln!(err, "note: {note}")?;
    }
    let mut known = Vec::new();
    let (errors, subjects) = subjects((&args.function, &args.input.define), &source, &mut known)?;
    for error in &errors {
        err.write_all(report::diagnostics::text(error, Lang::En, false).as_bytes())?;
    }
    if !errors.is_empty() && subjects.is_empty() {
        return Ok(ExitStatus::Findings);
    }
    all_known(&args.function, &known)?;
    anyhow::ensure!(
        (args.case.is_none() && args.set.is_empty()) || subjects.len() == 1,
        "--case and --set are for one function, and there are {} of these names",
        subjects.len()
    );
    let wanted: Vec<String> = match args.lane.is_empty() {
        true if !args.all_lanes => vec![lanes::embedded::STRICT.to_owned()],
        _ => args.lane.clone(),
    };
    let opened = super::lanes::opened(&wanted, args.all_lanes)?;
    let lanes: Vec<&dyn Lane> = opened.iter().map(AsRef::as_ref).collect();
    let mut inputs = Inputs::new(&stated);
    let mut summary = Summary { traces: Vec::new(), not_traced: Vec::new() };
    let request = Request { lanes: &lanes, profile: &profile, output: args.output.as_deref() };
    for subject in &subjects {
        let domain = inputs.domain(subject)?;
        let traced = case(args, &source, (subject, &domain), &lanes)?
            .and_then(|(ready, case)| trace::run(subject, ready, &case, &request));
        match traced {
            Ok(traced) => summary.traces.push(traced),
            Err(why) => summary.not_traced.push((subject.label.clone(), why)),
        }
    }
    inputs.all_used()?;
    let printed = match args.format {
        Format::Json => json(&summary),
        Format::Text => text(&summary, args.all, color),
    };
    out.write_all(printed.as_bytes())?;
    if summary.traces.is_empty() {
        match &summary.not_traced[..] {
            [(function, why)] => writeln!(err, "error: `{function}` was not traced: {why}")?,
            _ => writeln!(
                err,
                "error: nothing was traced; `--function NAME` traces a function in which nothing was found"
            )?,
        }
        return Ok(ExitStatus::Error);
    }
    Ok(ExitStatus::Clean)
}

/// The case of a function that is traced, or why there is none.
fn case<'s>(
    args: &TraceArgs,
    source: &IncludedText,
    (subject, domain): (&'s Subject, &Domain),
    lanes: &[&dyn Lane],
) -> anyhow::Result<Result<(&'s Ready, Case), String>> {
    let ready = match &subject.ready {
        Ok(ready) => ready,
        Err(why) => return Ok(Err(why.clone())),
    };
    if let Some(words) = &args.case {
        let sample = fuzz::given(ready, words).map_err(|why| anyhow::anyhow!("--case: {why}"))?;
        return Ok(Ok((ready, Case { sample, why: "the inputs of --case".to_owned(), output: None })));
    }
    if !args.set.is_empty() {
        let sample = set(ready, &args.set)?;
        return Ok(Ok((ready, Case { sample, why: "the inputs of --set".to_owned(), output: None })));
    }
    let request = fuzz::Request {
        samples: args.samples,
        seed: args.input.seed,
        case: None,
        notes: false,
        arbitrary: args.arbitrary,
        strict_integers: args.strict_integers,
        first_lane: args.lane.is_empty() && !args.all_lanes,
        command: format!("shadercheck fuzz {}", source.given),
    };
    let on: Vec<(&dyn Lane, Promises)> =
        lanes.iter().map(|lane| (*lane, Promises::of_lane(lane.description()))).collect();
    let found = fuzz::run(subject, domain, &on, &request).map_err(anyhow::Error::msg)?;
    let named = !args.function.is_empty();
    let drawn = || Case::hardest(subject, ready, domain, (args.samples as usize, args.input.seed));
    Ok(match Case::of(&found, ready, named) {
        Some(case) => Ok((ready, case)),
        None if named => Ok((ready, drawn())),
        None => Err(format!("nothing was found in {} samples", found.samples)),
    })
}

/// The sample that `--set` states: every input of the function, each once.
fn set(ready: &Ready, given: &[String]) -> anyhow::Result<Sample> {
    let (invocation, case) = (&ready.kernel.invocation, &ready.kernel.case);
    let mut sample = Sample {
        invocation_record: invocation.clone(),
        case_record: case.clone(),
        invocation: vec![0; invocation.words()],
        case: vec![0; case.words()],
    };
    let names: Vec<String> = invocation.fields().iter().chain(case.fields()).map(|field| field.name.clone()).collect();
    let mut seen: Vec<&str> = Vec::new();
    for text in given {
        let Some((name, numbers)) = text.split_once('=') else {
            anyhow::bail!("--set `{text}`: give INPUT=NUMBERS, such as `x=0.5` or `n=0,0,1`");
        };
        let name = name.trim();
        anyhow::ensure!(!seen.contains(&name), "--set: input `{name}` is given twice");
        let at = |record: &Record| record.index_of(name);
        let (record, words) = match (at(invocation), at(case)) {
            (Some(_), _) => (invocation, &mut sample.invocation),
            (None, Some(_)) => (case, &mut sample.case),
            (None, None) => {
                let hint = base::did_you_mean(name, names.iter().map(String::as_str), "it has:");
                anyhow::bail!("--set: the function has no input `{name}`; {hint}");
            }
        };
        let Some(field) = at(record) else { continue };
        let (shape, range) = (record.fields()[field].shape, record.range(field));
        let read: Vec<u32> = numbers
            .split(',')
            .map(|number| {
                word(number.trim(), shape.scalar)
                    .ok_or_else(|| anyhow::anyhow!("--set `{text}`: `{}` is no {}", number.trim(), kind(shape.scalar)))
            })
            .collect::<anyhow::Result<_>>()?;
        let wanted = range.len();
        anyhow::ensure!(
            read.len() == wanted,
            "--set: input `{name}` ({shape}) has {wanted} numbers, not {}",
            read.len()
        );
        words[range].copy_from_slice(&read);
        seen.push(name);
    }
    if let Some(missing) = names.iter().find(|name| !seen.contains(&name.as_str())) {
        anyhow::bail!("--set: input `{missing}` has no value; each of these needs one: {}", names.join(", "));
    }
    Ok(sample)
}

/// A number as a word.
fn word(number: &str, scalar: Scalar) -> Option<u32> {
    match scalar {
        Scalar::F32 => number.parse::<f32>().ok().map(f32::to_bits),
        Scalar::I32 => number.parse::<i32>().ok().map(|number| number as u32),
        Scalar::U32 => number.parse().ok(),
        Scalar::Bool => number.parse::<bool>().ok().map(u32::from),
    }
}

fn kind(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::F32 => "number",
        Scalar::I32 => "whole number of 32 bits",
        Scalar::U32 => "whole number of 32 bits without a sign",
        Scalar::Bool => "`true` or `false`",
    }
}
