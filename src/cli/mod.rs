//! The command line, one file a subcommand. Results go to standard output, progress and complaints
//! to standard error.

#[cfg(feature = "run")]
mod bar;
mod baseline;
#[cfg(feature = "run")]
mod below;
#[cfg(feature = "run")]
pub mod calibrate;
#[cfg(feature = "run")]
pub mod check;
#[cfg(feature = "run")]
mod chunks;
pub mod color;
#[cfg(feature = "run")]
pub mod compare;
pub mod completions;
#[cfg(feature = "run")]
mod compose;
mod definition;
#[cfg(feature = "run")]
mod document;
pub mod explain;
#[cfg(feature = "run")]
pub mod fuzz;
mod groups;
#[cfg(feature = "run")]
mod hosts;
#[cfg(feature = "run")]
pub mod improve;
#[cfg(feature = "run")]
mod includes;
#[cfg(feature = "run")]
pub mod init;
#[cfg(feature = "run")]
pub mod inputs;
#[cfg(unix)]
mod interrupt;
#[cfg(feature = "run")]
pub mod lanes;
pub mod lint;
pub mod lsp;
pub mod mcp;
#[cfg(feature = "run")]
pub mod merge;
#[cfg(feature = "run")]
pub mod mutate;
#[cfg(feature = "drivers")]
pub mod node;
#[cfg(feature = "run")]
mod outcomes;
mod paths;
mod process;
#[cfg(feature = "run")]
pub mod refdata;
#[cfg(feature = "run")]
pub mod reported;
#[cfg(feature = "run")]
pub mod shard;
#[cfg(feature = "run")]
mod spared;
pub mod status;
#[cfg(feature = "run")]
pub mod test;
#[cfg(feature = "run")]
pub mod torture;
#[cfg(feature = "run")]
pub mod trace;
#[cfg(feature = "run")]
pub mod translate;
#[cfg(feature = "run")]
pub mod tune;
pub mod version;
#[cfg(feature = "run")]
mod waiting;
#[cfg(feature = "drivers")]
pub mod worker;

use std::io::{IsTerminal, Write};

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use reading::prelude::Wanted as WantedPrelude;
use syntax::Stage;

use base::diagnostic::Lang;
use base::text::printable;
use color::ColorChoice;
use status::ExitStatus;

/// Languages by the names that options have for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LangName {
    /// English
    En,
    /// Japanese
    Ja,
}

/// Stages by the names that options have for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StageName {
    /// Vertex shader
    #[value(alias = "vert")]
    Vertex,
    /// Tessellation control shader
    #[value(alias = "tesc")]
    TessControl,
    /// Tessellation evaluation shader
    #[value(alias = "tese")]
    TessEvaluation,
    /// Geometry shader
    #[value(alias = "geom")]
    Geometry,
    /// Fragment shader
    #[value(alias = "frag")]
    Fragment,
    /// Compute shader
    #[value(alias = "comp")]
    Compute,
    /// Functions that shaders of any stage use
    Library,
}

impl From<StageName> for Stage {
    fn from(name: StageName) -> Self {
        match name {
            StageName::Vertex => Self::Vertex,
            StageName::TessControl => Self::TessControl,
            StageName::TessEvaluation => Self::TessEvaluation,
            StageName::Geometry => Self::Geometry,
            StageName::Fragment => Self::Fragment,
            StageName::Compute => Self::Compute,
            StageName::Library => Self::Library,
        }
    }
}

impl StageName {
    /// How an option spells it.
    pub fn word(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// Names for `--prelude`.
fn preludes() -> PossibleValuesParser {
    let named = reading::prelude::PRELUDES.iter().map(|p| PossibleValue::new(p.name).help(p.title()));
    PossibleValuesParser::new(named.chain([PossibleValue::new("none").help("Nothing, whatever a text looks like")]))
}

/// What `--prelude` asks for; without it, texts are recognised.
fn prelude(given: Option<&str>) -> WantedPrelude {
    given.and_then(WantedPrelude::named).unwrap_or_default()
}

/// The language that is asked for, or else the one of the environment: `LC_ALL`, `LC_MESSAGES` and
/// `LANG`, of which the first that is set and not empty decides.
fn lang(given: Option<LangName>) -> Lang {
    match given {
        Some(LangName::En) => Lang::En,
        Some(LangName::Ja) => Lang::Ja,
        None => {
            let set = |name| std::env::var(name).ok().filter(|v| !v.is_empty());
            let locale = ["LC_ALL", "LC_MESSAGES", "LANG"].into_iter().find_map(set);
            if locale.is_some_and(|l| l.starts_with("ja")) { Lang::Ja } else { Lang::En }
        }
    }
}

/// Words that options and reports use.
#[cfg(feature = "run")]
const WORDS: &str = "\
A lane is a driver, or the interpreter that is built in, with a way to run shaders on it; `shadercheck lanes` \
lists them. A suite says which inputs a shader gets and what comes out.";

/// Test shaders like other code, on a machine without a GPU
///
/// Exit status: 0 clean; 1 findings or failed cases; 2 usage, configuration or internal error; 130 and 143 when
/// SIGINT or SIGTERM ended the run.
#[derive(Parser, Debug)]
#[command(name = "shadercheck", version, max_term_width = 100)]
#[cfg_attr(feature = "run", command(after_help = WORDS))]
pub struct Cli {
    /// When to colour output
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t)]
    pub color: ColorChoice,
    /// With --version: also the commit, features, and versions of naga and wgpu
    #[arg(long, requires = "version")]
    pub verbose: bool,
    /// What to do
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Run shaders on many inputs and compare every output with its formula
    #[cfg(feature = "run")]
    Check(check::CheckArgs),
    /// Run every function of a shader file on generated inputs, without a suite
    #[cfg(feature = "run")]
    Fuzz(fuzz::FuzzArgs),
    /// Show where the value of a failing case goes wrong, expression after expression
    #[cfg(feature = "run")]
    Trace(trace::TraceArgs),
    /// Run the tests that stand in shaders
    #[cfg(feature = "run")]
    Test(test::TestArgs),
    /// Compare functions of two shader texts, in any two languages
    #[cfg(feature = "run")]
    Compare(compare::CompareArgs),
    /// Find formulas that lose fewer bits than the expressions of a shader
    #[cfg(feature = "run")]
    Improve(improve::ImproveArgs),
    /// Write first suites for a folder of shaders
    #[cfg(feature = "run")]
    Init(init::InitArgs),
    /// Find and repair mistakes in shaders and in the code that feeds them
    Lint(Box<lint::LintArgs>),
    /// Serve an editor: findings while typing, repairs, navigation
    Lsp(lsp::LspArgs),
    /// Serve agents: the commands as tools of the Model Context Protocol
    Mcp(mcp::McpArgs),
    /// Show the page of a lint rule
    Explain(explain::ExplainArgs),
    /// Translate a shader to another language
    #[cfg(feature = "run")]
    Translate(translate::TranslateArgs),
    /// Find which declarations may be mediump on phones, and which must be highp
    #[cfg(feature = "run")]
    Tune(tune::TuneArgs),
    /// Plant small faults in shaders and report which their suites miss
    #[cfg(feature = "run")]
    Mutate(mutate::MutateArgs),
    /// Run random programs on every lane and through every translator
    #[cfg(feature = "run")]
    Torture(torture::TortureArgs),
    /// Write reference data, and compare results with them
    #[cfg(feature = "run")]
    Refdata(refdata::RefdataArgs),
    /// Join the results of the shards of a run
    #[cfg(feature = "run")]
    Merge(merge::MergeArgs),
    /// Show the lanes: drivers, and the interpreter, that can run shaders here
    #[cfg(feature = "run")]
    Lanes(lanes::LanesArgs),
    /// Measure the errors of a device's operations, beside what is promised
    #[cfg(feature = "run")]
    Calibrate(calibrate::CalibrateArgs),
    /// Print a script that completes commands and options in a shell
    Completions(completions::CompletionsArgs),
    /// Write manual pages, one for each command
    #[command(hide = true)]
    Man(completions::ManArgs),
    /// Run jobs of a lane that another process sends
    #[cfg(feature = "drivers")]
    #[command(hide = true)]
    Worker(worker::WorkerArgs),
}

impl Command {
    /// True when the command opens devices.
    #[cfg(feature = "drivers")]
    pub fn opens_devices(&self) -> bool {
        matches!(
            self,
            Self::Check(_)
                | Self::Fuzz(_)
                | Self::Trace(_)
                | Self::Test(_)
                | Self::Compare(_)
                | Self::Improve(_)
                | Self::Lanes(_)
                | Self::Calibrate(_)
                | Self::Mutate(_)
                | Self::Torture(_)
        )
    }

    /// True when the command reports what it found so far when a signal asks it to end.
    #[cfg(all(unix, feature = "run"))]
    fn ends_early(&self) -> bool {
        matches!(
            self,
            Self::Check(_)
                | Self::Fuzz(_)
                | Self::Test(_)
                | Self::Compare(_)
                | Self::Improve(_)
                | Self::Tune(_)
                | Self::Mutate(_)
                | Self::Torture(_)
        )
    }
}

impl Cli {
    /// Reads the command line of the process.
    ///
    /// # Errors
    /// What is to be printed before the process ends: usage, help or the version.
    pub fn read() -> Result<Self, clap::Error> {
        // `--version` is acted on where it stands, before what follows is read.
        let verbose = std::env::args_os().any(|argument| argument == "--verbose");
        let command = groups::grouped(Self::command());
        let command = if verbose { command.version(version::VERBOSE) } else { command };
        Self::from_arg_matches(&command.try_get_matches()?)
    }
}

/// Runs the command line.
pub fn run(cli: &Cli) -> ExitStatus {
    let stdout = std::io::stdout();
    let stderr = std::io::stderr();
    let color = cli.color.decide(stdout.is_terminal(), |name| std::env::var(name).ok());
    // Not locked: the language server writes from a thread of its own.
    let mut out = std::io::BufWriter::new(WhileRead::new(stdout));
    let mut err = WhileRead::new(&stderr);
    #[cfg(all(unix, feature = "run"))]
    let handled = if cli.command.ends_early() { interrupt::listen() } else { interrupt::clean_up() };
    // The linter reports at its end alone.
    #[cfg(all(unix, not(feature = "run")))]
    let handled = interrupt::clean_up();
    #[cfg(unix)]
    if let Err(error) = handled {
        let _ = writeln!(err, "note: signals end the program at once: {error}");
    }
    let result = match &cli.command {
        #[cfg(feature = "run")]
        Command::Check(args) => check::run(args, &mut out, &mut err, color),
        #[cfg(feature = "run")]
        Command::Fuzz(args) => fuzz::run(args, &mut out, &mut err, color),
        #[cfg(feature = "run")]
        Command::Trace(args) => trace::run(args, &mut out, &mut err, color),
        #[cfg(feature = "run")]
        Command::Test(args) => test::run(args, &mut out, &mut err, color),
        #[cfg(feature = "run")]
        Command::Compare(args) => compare::run(args, &mut out, &mut err, color),
        #[cfg(feature = "run")]
        Command::Improve(args) => improve::run(args, &mut out, &mut err, color),
        #[cfg(feature = "run")]
        Command::Init(args) => init::run(args, &mut out, &mut err),
        Command::Lint(args) => lint::run(args, &mut out, &mut err, color),
        Command::Lsp(args) => lsp::run(args, &mut err),
        Command::Mcp(args) => mcp::run(args, &mut out),
        Command::Explain(args) => explain::run(args, &mut out, &mut err, color),
        #[cfg(feature = "run")]
        Command::Translate(args) => translate::run(args, &mut out, &mut err),
        #[cfg(feature = "run")]
        Command::Tune(args) => tune::run(args, &mut out, &mut err, color),
        #[cfg(feature = "run")]
        Command::Mutate(args) => mutate::run(args, &mut out, &mut err),
        #[cfg(feature = "run")]
        Command::Torture(args) => torture::run(args, &mut out, &mut err),
        #[cfg(feature = "run")]
        Command::Refdata(args) => refdata::run(args, &mut out, &mut err),
        #[cfg(feature = "run")]
        Command::Merge(args) => merge::run(args, &mut out, &mut err, color),
        #[cfg(feature = "run")]
        Command::Lanes(args) => lanes::run(args, &mut out),
        #[cfg(feature = "run")]
        Command::Calibrate(args) => calibrate::run(args, &mut out, &mut err),
        Command::Completions(args) => completions::run(args, &mut out),
        Command::Man(args) => completions::man(args),
        #[cfg(feature = "drivers")]
        Command::Worker(args) => worker::run(args, &mut out),
    };
    let result = result.and_then(|status| Ok(out.flush().map(|()| status)?));
    match result {
        Ok(status) => status,
        Err(error) => {
            let _ = writeln!(err, "error: {}", message(&error));
            ExitStatus::Error
        }
    }
}

/// An error with its causes. Many errors tell their cause themselves; it is not told twice.
fn message(error: &anyhow::Error) -> String {
    let mut parts: Vec<String> = Vec::new();
    for cause in error.chain().map(ToString::to_string) {
        if parts.iter().all(|reported| !reported.contains(&cause)) {
            parts.push(cause);
        }
    }
    // Errors may have several lines, and what they quote may be anything.
    parts.join(": ").split('\n').map(printable).collect::<Vec<_>>().join("\n")
}

/// Writes as long as someone reads. A reader that went away, such as `head`, has seen what it wanted;
/// the run goes on without it, because its exit status still has to tell what was found.
struct WhileRead<W> {
    to: W,
    closed: bool,
}

impl<W> WhileRead<W> {
    fn new(to: W) -> Self {
        Self { to, closed: false }
    }

    fn unless_closed<T>(&mut self, done: T, write: impl FnOnce(&mut W) -> std::io::Result<T>) -> std::io::Result<T> {
        if self.closed {
            return Ok(done);
        }
        match write(&mut self.to) {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(done)
            }
            result => result,
        }
    }
}

impl<W: Write> Write for WhileRead<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.unless_closed(bytes.len(), |to| to.write(bytes))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.unless_closed((), Write::flush)
    }
}
