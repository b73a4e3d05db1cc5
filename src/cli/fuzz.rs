//! `shadercheck fuzz`: every function of a shader file on generated inputs, without a suite.

mod job;
mod known;
mod prove;
mod reproducible;
mod stub;
mod switches;

use std::cell::RefCell;
use std::io::Write;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;

use super::below;
use super::check::shell_word;
use super::compose::{ComposeArgs, Given};
use super::hosts::Hosts;
use super::includes::{self, IncludedText};
use super::inputs::InputArgs;
use super::reported::{self, Reported};
use super::spared;
use crate::cli::shard::{ShardArgs, Terminal};
use crate::cli::status::ExitStatus;
use crate::cli::waiting::Waiting;
use base::diagnostic::{Diagnostic, Severity};
use base::{did_you_mean, nearest};
use engine::fuzz::{self, BadHint, Domain, Stated, Subject};
use engine::suite::run::signal_name;
use judge::profile::Promises;
use lanes::{Lane, StandIn, Wanted, interrupt};
use program::{ProgramError, Written};
use syntax::errors;

pub use job::ShardResult;
use job::{Functions, Lines};

/// Samples of a function, when none are asked for.
const SAMPLES: u64 = 1 << 16;

/// Arguments of `shadercheck fuzz`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_long_help = "\
Inputs. Three samples in four are realistic: the name, type and use of an input decide what it stands for, such \
as a direction of length 1, a colour, texture coordinates, a view, or weights that add up to one; a normal \
matrix follows from its model matrix, and the inputs of a fragment shader are interpolated. The report gives the \
guess for each input. The other samples are arbitrary: ordinary sizes (0, and 1/1024 to 1024 of either sign, \
spread evenly over the magnitudes), special values, related inputs (equal, parallel and nearly equal vectors, \
zero vectors, directions, identity and singular matrices), and now and then any finite number. With --arbitrary, \
all samples are arbitrary. A comment before the function states domains,

  // shadercheck: x in [0, 1], t > 0, normalised n, nonzero v, rotation m, whole k

and so does --domain. NaN and infinity are never inputs.

Findings. A lane (a driver, or the interpreter that is built in, with a way to run shaders on it) that computes something other than what the function means, or gives different outputs for the \
same inputs, is a finding. So is an output that has no value, is infinite, is not written, or is lost to \
overflow or underflow on the way although the real numbers are fine, if the inputs are realistic or lie in their \
stated domains. If it takes arbitrary inputs of ordinary size, it is a warning, reported once for each cause; if it \
takes other inputs, it is a note, and so it is for numbers of a stated range that are nearer to 0 \
than 2^-64 of it, or beyond 1024 if the range has no end. With --arbitrary and --case, inputs of ordinary size \
make findings. Outputs that are themselves too large, indices, integers and endless loops are findings only if \
every input has a stated domain; a signed sum or product that wraps is a note without --strict-integers. A \
function that loses digits (ill-conditioned) gets a warning. A sample is undetermined if it is inconclusive, because the function has no value there or the API \
promises too little.

Reproducible. With --reproducible, nothing is judged: for each output the report says whether every conforming device gives the same bits for the same inputs (fixed), would if everything were `precise`, or is free to give others, with each operation that leaves it open: a product and a sum that may become one operation, terms that may change their order, functions and quotients that are promised within an error, comparisons of what differs already. Sums and products count as rounded to nearest. At most 16384 samples are looked at, and the bits of all available lanes stand beside. The status is 1 if an output is not fixed.

Prove. With --prove, nothing is judged by samples: for each buffer and workgroup variable of a compute stage the report says whether it is verified for all sizes (no two invocations of any dispatch meet at one element without a barrier where one of them writes, and no index lies outside, for every number of workgroups, every length and every number of the host that keeps to the conditions that are stated), or why that is not decided. Indices that are sums of numbers of the invocation, the host and loops are followed, quotients by constants too. Beside it, a few sizes are dispatched: a fault is what a dispatch shows. The status is 1 if there is one.

Exit status: 0 no finding; 1 findings, or a file that does not compile; 2 usage, a lane of --lane that is \
unavailable, or nothing could be run.")]
pub struct FuzzArgs {
    /// Shader files (the extension gives the stage; a file without `main` is a library), documents and host code with
    /// shaders, as a whole or at a line (`README.md:12`, `scene.cpp:40`), and folders to search for shader files
    #[arg(value_name = "PATH", default_value = ".")]
    pub files: Vec<PathBuf>,
    /// Only functions of this name, or one overload by its types: `f(vec3, float)`
    #[arg(long, value_name = "NAME")]
    pub function: Vec<String>,
    /// What is said of the files and their inputs
    #[command(flatten)]
    pub input: InputArgs,
    /// What is stated about parts of texts in WGSL
    #[command(flatten)]
    pub compose: ComposeArgs,
    /// Host whose code surrounds each shader [default: recognised from the text]
    #[arg(long, value_name = "NAME", value_parser = super::preludes())]
    pub prelude: Option<String>,
    /// Only these lanes, of those that `shadercheck lanes` lists [default: the first that runs a function, and all others if it deviates]
    #[arg(long, value_name = "LANE", value_delimiter = ',')]
    pub lane: Vec<String>,
    /// Run each function on every available lane
    #[arg(long, conflicts_with = "lane")]
    pub all_lanes: bool,
    /// Samples per function
    #[arg(long, value_name = "N", default_value_t = SAMPLES, value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: u64,
    /// Run only this case, copied from the `reproduce` line of a report; needs --function
    #[arg(long, value_name = "INPUTS", requires = "function")]
    pub case: Option<String>,
    /// Also show findings at inputs that may never occur
    #[arg(long)]
    pub notes: bool,
    /// Treat all inputs alike, whatever they may stand for: ordinary sizes, special values and extremes
    #[arg(long)]
    pub arbitrary: bool,
    /// Also report signed sums and products that do not fit 32 bits, although every language lets them wrap
    #[arg(long)]
    pub strict_integers: bool,
    /// Instead, say which outputs have the same bits on every conforming device, and what leaves the others open
    #[arg(long, conflicts_with_all = ["write_suite", "notes", "arbitrary", "strict_integers"])]
    pub reproducible: bool,
    /// Instead, say of each buffer and workgroup variable of compute stages whether it is free of races and of indices outside
    /// of it for all sizes
    #[arg(long, conflicts_with_all = ["reproducible", "write_suite", "notes", "arbitrary", "strict_integers", "case"])]
    pub prove: bool,
    /// What devices promise, for --reproducible: a shipped profile by name, or a file that `calibrate` wrote
    #[arg(long, value_name = "PROFILE", requires = "reproducible", hide_short_help = true)]
    pub profile: Option<String>,
    /// Write a first suite for each function that ran, beside its file; existing files are kept
    #[arg(long)]
    pub write_suite: bool,
    /// Which functions of the run: shard `k` modulo N runs function `k`
    #[command(flatten)]
    pub sharing: ShardArgs,
    /// Leave out what this file knows, so that only new findings count
    #[arg(long, value_name = "FILE", conflicts_with_all = ["reproducible", "prove"], hide_short_help = true)]
    pub baseline: Option<PathBuf>,
    /// Record all findings and warnings in a file for --baseline
    #[arg(long, value_name = "FILE", conflicts_with_all = ["baseline", "reproducible", "prove"], hide_short_help = true)]
    pub write_baseline: Option<PathBuf>,
    /// Write the report in every format to this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["reproducible", "prove"])]
    pub report_dir: Option<PathBuf>,
    /// Format of the result
    #[arg(long, value_parser = reported::parser(), default_value = "text")]
    pub format: Reported,
}

impl FuzzArgs {
    /// True where something is asked for that a part of the functions cannot give.
    fn needs_the_whole(&self) -> bool {
        let files = [&self.report_dir, &self.baseline, &self.write_baseline];
        self.case.is_some() || self.write_suite || files.iter().any(|file| file.is_some())
    }
}

/// Runs the command: the result goes to `out`, progress and complaints to `err`.
///
/// The status is [`ExitStatus::Findings`] when a function or lane is at fault or a file does not compile,
/// and [`ExitStatus::Error`] when nothing could be run, or a lane that was asked for is not available.
///
/// # Errors
/// When a file cannot be read, a name is unknown, a domain cannot be read, no lane is available, or output
/// fails.
pub fn run(args: &FuzzArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    let shard = args.sharing.shard()?;
    anyhow::ensure!(
        shard.is_none() || !args.needs_the_whole(),
        "--shard does a part of the functions; --case, --write-suite, --report-dir and baselines are for a run without it"
    );
    let _waiting = Waiting::begin();
    let stated = args.input.domains()?;
    let stage = args.input.stage();
    // A text of which no resource has a binding runs with a host that assigns them, or not at all.
    let compose = ComposeArgs { assign_bindings: true, ..args.compose.clone() };
    let reading = args.input.reading(Some(&compose), args.function.first().map(String::as_str));
    let chunks = RefCell::default();
    let reading = Given { chunks: Some(&chunks), ..reading };
    let mut hosts = Hosts::default();
    let (files, searched) = below::shaders_and_hosts(&args.files)?;
    let mut sources: Vec<IncludedText> = Vec::new();
    let mut complete = |text: IncludedText, defines: &[(String, String)]| {
        text.with_prelude(super::prelude(args.prelude.as_deref())).assuming(defines, &mut hosts)
    };
    // A case is of one text, and a suite states no macros.
    let again = args.case.is_none() && !args.reproducible && !args.prove && !args.write_suite;
    for path in &files {
        match includes::read_all(path, &reading, stage) {
            Ok(texts) => {
                let texts: Vec<_> = texts.into_iter().map(|text| complete(text, &args.input.define)).collect();
                let of_file = (path.as_path(), stage);
                let texts = if again { switches::with_more(of_file, &reading, texts, &mut complete) } else { texts };
                sources.extend(texts);
            }
            // One file of many does not keep the others from being run.
            Err(error) if searched => writeln!(err, "left out: {error:#}")?,
            Err(error) => return Err(error),
        }
    }
    if args.reproducible {
        anyhow::ensure!(shard.is_none(), "--reproducible looks at all functions in one run: leave out --shard");
        return reproducible::run(args, &sources, &stated, out, err, color);
    }
    if args.prove {
        anyhow::ensure!(shard.is_none(), "--prove looks at all compute stages in one run: leave out --shard");
        return prove::run(args, &sources, out, err, color);
    }
    let printed = sources.iter().find(|s| s.printed);
    if let Some(printed) = printed.filter(|_| args.write_suite) {
        anyhow::bail!("--write-suite writes a suite beside a shader file, and {} stands in another file", printed.name);
    }
    let (part, lanes) = open_lanes(args)?;
    let part = part.with_files(args.report_dir.clone(), args.write_baseline.clone());
    let known = args.baseline.as_deref().map(known::Known::read).transpose()?;
    let lanes = lanes.iter().map(|lane| (lane.as_ref(), Promises::of_lane(lane.description()))).collect();
    let terminal = Terminal::new(args.format, color, out, err);
    let (whole, many) = (shard.is_none(), sources.len() > 1);
    let mut lines = Lines { terminal, args, sources: &sources, many, whole, told: 0 };
    let mut functions = Functions::new(args, &sources, lanes, Inputs::new(&stated), whole).knowing(known);
    let used = part.lanes().to_vec();
    let key = |shards| job::identity(args, shards, &sources, &used);
    args.sharing.run(&mut functions, part, key, &mut lines)
}

/// The exit status of a report of its own, `broken` where a text does not compile; says on `err` what cut it short, or that
/// there was `nothing` to report.
fn ended(err: &mut dyn Write, broken: bool, found: bool, nothing: Option<&str>) -> anyhow::Result<ExitStatus> {
    Ok(if let Some(signal) = interrupt::signal() {
        writeln!(err, "error: the run was interrupted by {}; this is what was found until then", signal_name(signal))?;
        ExitStatus::Interrupted(signal)
    } else if broken || found {
        ExitStatus::Findings
    } else if let Some(nothing) = nothing {
        writeln!(err, "error: {nothing}")?;
        ExitStatus::Error
    } else {
        ExitStatus::Clean
    })
}

/// Every function that is asked for has to be there.
pub(super) fn all_known(functions: &[String], known: &[String]) -> anyhow::Result<()> {
    let unknown = functions.iter().find(|name| !known.iter().any(|k| k == *name || base(k) == name.as_str()));
    let Some(name) = unknown else { return Ok(()) };
    let hint = did_you_mean(name, known.iter().map(String::as_str), "there are:");
    anyhow::bail!("there is no function `{name}` with a body; {hint}")
}

/// The name of a function without the types of its parameters.
fn base(label: &str) -> &str {
    label.split('(').next().unwrap_or(label)
}

/// What is wrong with a file, or else the functions of it that are to be run.
pub(super) fn subjects(
    (functions, define): (&[String], &[(String, String)]),
    source: &IncludedText,
    known: &mut Vec<String>,
) -> anyhow::Result<(Vec<Diagnostic>, Vec<Subject>)> {
    let wanted = |name: &str| functions.is_empty() || functions.iter().any(|f| f == name);
    let unstated = |bad: BadHint| anyhow::anyhow!("{}: this comment states no domain: {}", bad.at, bad.why);
    let written = Written::of(&source.file);
    if written != Written::Glsl {
        let mut left_out = Vec::new();
        let read = source.module();
        let rest = read.is_err().then(|| source.rest()).flatten();
        let text = match (read, rest) {
            (Ok(text), _) => text,
            (Err(ProgramError::Source(_)), Some(Ok((text, lacking)))) => {
                left_out.extend(lacking.iter().filter(|one| wanted(&one.name)).map(|one| Subject {
                    label: one.name.clone(),
                    name: one.name.clone(),
                    parameters: Vec::new(),
                    at: one.at.clone(),
                    dispatch: None,
                    ready: Err(format!("`{}` is declared nowhere: name its file with `--with FILE`", one.lacks)),
                    stated: Vec::new(),
                    made_up: false,
                }));
                text
            }
            (Err(ProgramError::Source(mut errors)), rest) => {
                // What is wrong beside what is lacking comes first.
                if let Some(Err(ProgramError::Source(found))) = rest {
                    errors.splice(0..0, found);
                }
                let mut subjects = Vec::new();
                let rewritten = reading::open::is_rewritten(source.file.text());
                let all_are = |code| errors.iter().all(|error| error.code == code);
                let decided = match () {
                    () if rewritten => Some("its engine rewrites declarations"),
                    () if all_are(errors::TEMPLATE) => Some("its host fills in placeholders, unless `--define` does"),
                    () if compose::lack_files(&errors) => Some("what it imports is not here; `-I FOLDER` names it"),
                    () if all_are(errors::FRAGMENT) && source.is_a_part() => Some(PART),
                    () if all_are(program::UNSUPPORTED) => Some("its reader here does not take it"),
                    () => None,
                };
                if let Some((why, first)) = decided.zip(errors.first()) {
                    subjects.push(without_at(source, why, first));
                    errors.clear();
                } else if let Some(open) = source.open() {
                    let (slips, others): (Vec<_>, Vec<_>) = errors.into_iter().partition(|error| source.is_slip(error));
                    subjects.extend(others.into_iter().next().map(|error| without(source, open, &error.at_origin())));
                    errors = slips;
                }
                let told: Vec<Diagnostic> =
                    errors.into_iter().map(Diagnostic::at_origin).map(|d| source.explained(d)).collect();
                // Where some functions do not compile, the others run.
                if let Some((text, broken)) = spared::module(source, !subjects.is_empty()) {
                    known.extend(text.points().into_iter().chain(text.functions()).map(|one| one.name));
                    let wanted = |name: &str| wanted(name) && !source.is_assumed(name);
                    let rest = fuzz::subjects_of_module(&text, &source.values(&text, define), &wanted);
                    let rest: Vec<Subject> = rest.map_err(unstated)?;
                    if subjects.is_empty() || rest.iter().any(|one| one.ready.is_ok() || one.dispatch.is_some()) {
                        subjects = rest;
                        subjects.extend(broken.subjects().filter(|one| wanted(&one.name)));
                    }
                }
                return Ok((told, subjects));
            }
            (Err(error), _) => return Err(error).with_context(|| source.name.clone()),
        };
        known.extend(left_out.iter().map(|one| one.label.clone()));
        known.extend(text.points().into_iter().chain(text.functions()).map(|one| one.name));
        let wanted = |name: &str| wanted(name) && !source.is_assumed(name);
        let subjects = fuzz::subjects_of_module(&text, &source.values(&text, define), &wanted).map_err(unstated)?;
        return Ok((source.lacking(define), subjects.into_iter().chain(left_out).collect()));
    }
    let parsed = source.parsed(define);
    let told = |errors: &mut dyn Iterator<Item = Diagnostic>| -> Vec<Diagnostic> {
        errors.map(Diagnostic::at_origin).map(|d| source.explained(d)).collect()
    };
    let errors = errors_of(parsed.diagnostics);
    // What another preprocessor reads before a compiler does: the linter believes none of it either.
    let is_of_host = |error: &Diagnostic| errors::is_of_the_text(error.code) && error.code != errors::INCLUDE;
    // Hosts that join files put the version in front, wherever it stands.
    let is_joined = |error: &Diagnostic| {
        error.code == errors::LATE_VERSION && error.file.origin(error.span).0.name() != source.file.name()
    };
    let mut doubtful = reading::open::doubtful(&parsed.shader, &errors, errors::Around::empty());
    // Who puts a version in front may declare more there, but for what is nearly a name of the text.
    if !errors.is_empty() && source.is_looked_for() && !source.is_versioned(define) {
        let of_host = |error: &Diagnostic| reading::open::is_about_a_name(error) && !source.is_slip(error);
        let made = source.made_by_names(&errors, define);
        let open = errors.iter().zip(made).map(|(error, made)| made || of_host(error));
        doubtful.iter_mut().zip(open).for_each(|(doubtful, open)| *doubtful |= open);
    }
    // What the linter does not tell either, since something that nobody stated decides.
    let unsure = doubtful.iter().all(|doubtful| *doubtful);
    // A text in another language is told where it is named, and so is what nobody looked for.
    let is_told = errors.iter().any(|error| error.code == errors::OTHER_LANGUAGE)
        || (!source.is_looked_for() && !parsed.shader.lacking().is_empty());
    // What a file that is not there would change, nobody knows.
    let of_file =
        |error: &Diagnostic| Diagnostic { message: parsed.shader.file().slice(error.span).into(), ..error.clone() };
    let lacks_file = errors.iter().find(|error| error.code == errors::INCLUDE).map(of_file);
    let open = lacks_file.is_some() || source.open().is_some();
    let is_sure = |(error, doubtful): (&Diagnostic, &bool)| !doubtful && error.code != errors::INCLUDE;
    let sure = lacks_file.is_some() && errors.iter().zip(&doubtful).any(is_sure);
    let late = errors.iter().any(is_joined);
    let of_host = errors.iter().find(|error| is_joined(error) || is_of_host(error));
    let of_host = of_host.filter(|_| unsure || late).cloned();
    if !errors.is_empty() {
        // Where some functions do not compile, the others run.
        let mut subjects = Vec::new();
        if let Some((shader, broken)) =
            spared::shader(source, &parsed.shader, &errors, (&source.macros(define), open || of_host.is_some()))
        {
            let wanted = |name: &str| wanted(name) && !source.is_assumed(name);
            subjects = fuzz::subjects(&shader, &wanted).map_err(unstated)?;
            subjects.extend(broken.subjects().filter(|one| wanted(&one.name)));
            known.extend(subjects.iter().flat_map(|one| [one.label.clone(), one.name.clone()]));
        }
        let why = match (&of_host, source.open(), &lacks_file) {
            (Some(first), ..) => Some(("its host has to make it a whole shader", first)),
            (None, Some(open), _) => errors.first().map(|first| (open, first)),
            (None, None, Some(first)) if !sure => Some(("it includes what is not there", first)),
            _ => errors.first().filter(|_| unsure && !is_told).map(|first| (HOST_DECIDES, first)),
        };
        if let Some((why, first)) = why {
            if subjects.iter().all(|subject| subject.ready.is_err()) {
                subjects = vec![without_at(source, why, first)];
            }
            return Ok((Vec::new(), subjects));
        }
        // What a host may take away stands behind what it cannot, and is told with nothing else.
        let sure = errors.into_iter().zip(doubtful).filter(|(_, doubtful)| unsure || !doubtful);
        let lacking = source.lacking(define);
        let errors = if lacking.is_empty() { sure.map(|(error, _)| error).collect() } else { lacking };
        return Ok((told(&mut errors.into_iter()), subjects));
    }
    // What is wrong whatever a host adds does not keep the rest from being run.
    let errors = told(&mut source.lacking(define).into_iter());
    let wanted = |name: &str| wanted(name) && !source.is_assumed(name);
    let subjects = fuzz::subjects(&parsed.shader, &wanted).map_err(unstated)?;
    for (_, info) in parsed.shader.functions().filter(|(_, f)| f.definition.is_some()) {
        known.push(info.name.name.clone());
    }
    known.extend(subjects.iter().map(|s| s.label.clone()));
    Ok((errors, subjects))
}

/// The errors of a text. The functions of a stage without `main` are those of a library.
fn errors_of(found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let is_wrong = |error: &Diagnostic| error.code != errors::MISSING_MAIN || !error.span.is_empty();
    found.into_iter().filter(|d| d.severity == Severity::Error && is_wrong(d)).collect()
}

/// Why a text is not run that lacks names, and for which nothing can be found that stands for them.
const PART: &str = "others declare what it uses";

/// Why a text is not run that lint does not call wrong either.
const HOST_DECIDES: &str = "its version, extensions or host decide";

/// [`without`] for one reason, with the place of the first error.
fn without_at(source: &IncludedText, why: &str, first: &Diagnostic) -> Subject {
    let first = first.clone().at_origin();
    without(source, &format!("{why}: {}", first.file.locate(first.span.start)), &first)
}

/// A text that does not compile without what its host fills in.
fn without(source: &IncludedText, open: &str, error: &Diagnostic) -> Subject {
    let label = source.name.rsplit('#').next().unwrap_or(&source.name);
    let at = error.file.locate(error.span.start);
    Subject {
        label: label.to_owned(),
        name: label.to_owned(),
        parameters: Vec::new(),
        ready: Err(format!("{open}: {}", error.message)),
        at,
        dispatch: None,
        stated: Vec::new(),
        made_up: false,
    }
}

/// The command line up to the function.
fn command(args: &FuzzArgs, source: &IncludedText) -> String {
    let mut words = format!("shadercheck fuzz {}", shell_word(&source.given));
    words += &args.input.words();
    words += &args.compose.words();
    for (name, value) in source.assumed() {
        words = format!("{words} --define {}", shell_word(&format!("{name}={value}")));
    }
    if args.strict_integers {
        words.push_str(" --strict-integers");
    }
    if args.arbitrary {
        words.push_str(" --arbitrary");
    }
    if !args.lane.is_empty() {
        words = format!("{words} --lane {}", args.lane.join(","));
    }
    if args.all_lanes {
        words.push_str(" --all-lanes");
    }
    words
}

/// Domains of the command line, with those that no function has an input for.
pub(super) struct Inputs<'a> {
    stated: &'a [Stated],
    used: Vec<bool>,
    names: Vec<String>,
}

impl<'a> Inputs<'a> {
    pub(super) fn new(stated: &'a [Stated]) -> Self {
        Self { stated, used: vec![false; stated.len()], names: Vec::new() }
    }

    /// The domain of a function: what the command line states goes before what comments do.
    pub(super) fn domain(&mut self, subject: &Subject) -> anyhow::Result<Domain> {
        let Ok(ready) = &subject.ready else { return Ok(Domain::default()) };
        let (invocation, case) = (ready.kernel.invocation.fields(), ready.kernel.case.fields());
        let name = base(&subject.label);
        let names = || invocation.iter().chain(case).map(|f| f.name.as_str());
        self.names.extend(names().map(str::to_owned));
        let mut all: Vec<Stated> = Vec::new();
        for (stated, used) in self.stated.iter().zip(&mut self.used) {
            if names().any(|input| stated.is_about(name, input)) {
                *used = true;
                all.push(stated.clone());
            }
        }
        let given = all.len();
        for stated in &subject.stated {
            let mut about = names().filter(|input| stated.is_about(name, input)).peekable();
            if about.peek().is_none() && !stated.whole_file {
                let hint = did_you_mean(&stated.input, names(), "it has:");
                anyhow::bail!("{}: `{name}` has no input `{}`; {hint}", stated.at, stated.input);
            }
            if !about.any(|input| all[..given].iter().any(|s| s.is_about(name, input))) {
                all.push(stated.clone());
            }
        }
        Ok(Domain::new(name, invocation, case, &all))
    }

    pub(super) fn all_used(&self) -> anyhow::Result<()> {
        let Some(k) = self.used.iter().position(|used| !used) else { return Ok(()) };
        let input = &self.stated[k].input;
        let hint = nearest(input, self.names.iter().map(String::as_str))
            .map_or_else(String::new, |n| format!("; did you mean `{n}`?"));
        anyhow::bail!("--domain: no function that was run has an input `{input}`{hint}")
    }
}

/// Opens the lanes that are asked for, or all; with what is found before any function ran.
fn open_lanes(args: &FuzzArgs) -> anyhow::Result<(ShardResult, Vec<Box<dyn Lane>>)> {
    let opened = Wanted { stand_in: StandIn::Beside, ..Wanted::named(&args.lane) }.open()?;
    if opened.lanes.is_empty() {
        let missing: Vec<String> = opened.missing.iter().map(|(n, e)| format!("lane `{n}`: {e}")).collect();
        anyhow::bail!("no lane is available, so nothing was run: {}", missing.join("; "));
    }
    Ok((ShardResult::nothing(&args.lane, &opened.lanes, opened.missing), opened.lanes))
}
