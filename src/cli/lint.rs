//! `shadercheck lint`: finds faults in shaders and in the host code around them, and repairs them.

pub(super) mod config;
pub(super) mod diff;
pub(super) mod files;
#[cfg(feature = "run")]
mod formula;
pub(super) mod groups;
mod known;
mod modules;
mod packs;
#[cfg(feature = "run")]
mod prove;
mod summary;
pub(super) mod write;

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, ValueEnum};

use crate::cli::status::ExitStatus;
use crate::cli::{LangName, StageName};
use base::diagnostic::{Diagnostic, Lang, Safety, Severity};
use base::text::{Edit, EditList, Encoding, Shown, SourceFile};
use disk::fresh;
use lint::fix::{FixedFile, Outcome};
use lint::{Input, Level};
use report::lint::{Context, FORMATS, Format, by_name, grouped};
use syntax::Stage;

use files::Loaded;
use groups::Groups;
use known::Known;

/// Find faults in shaders, including those in documents and in strings of host code, and in the code that feeds them
///
/// Folders are searched, without hidden files and files that .gitignore names. The nearest shadercheck.toml above a
/// file configures how it is linted; options take precedence.
#[derive(Args, Clone, Debug, Default)]
pub struct LintArgs {
    /// Files, and folders to search for shaders and host code
    #[arg(value_name = "PATH", default_value = ".")]
    pub paths: Vec<PathBuf>,
    /// Apply the repairs that keep the meaning
    #[arg(long)]
    pub fix: bool,
    /// With --fix or --diff: also apply repairs that may change the result
    #[arg(long)]
    pub unsafe_fixes: bool,
    /// Print the repairs as a patch; write nothing
    #[arg(long)]
    pub diff: bool,
    /// Look for better formulas for findings about numbers, prove them, and offer them as repairs; with --fix or
    /// --diff, also run each repaired shader before and after, and report how far its outputs move
    #[arg(long)]
    pub prove: bool,
    /// Stage of the named shader files, if their extensions do not give it or give another
    #[arg(long, value_enum, value_name = "STAGE")]
    pub stage: Option<StageName>,
    /// Only these rules: codes (T001), families of codes (H), or names
    #[arg(long, value_name = "RULE", value_delimiter = ',')]
    pub select: Vec<String>,
    /// Without these rules
    #[arg(long, value_name = "RULE", value_delimiter = ',')]
    pub ignore: Vec<String>,
    /// Also rules that report what may be intended (strict), or that guess by names (heuristic)
    #[arg(long, value_enum)]
    pub level: Option<LevelName>,
    /// Format of the findings [default: text]
    #[arg(long, value_parser = formats())]
    pub format: Option<String>,
    /// Print the number of findings of each rule instead of the findings
    #[arg(long, conflicts_with_all = ["format", "diff", "write_baseline"])]
    pub statistics: bool,
    /// Print information when folders are searched too; for named files or rules it is always printed
    #[arg(long)]
    pub info: bool,
    /// Write the report to this file, and findings as text to standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Read this configuration instead of the nearest shadercheck.toml
    #[arg(long, value_name = "FILE", conflicts_with = "no_config")]
    pub config: Option<PathBuf>,
    /// Read no configuration
    #[arg(long)]
    pub no_config: bool,
    /// Leave out findings that are recorded in this file
    #[arg(long, value_name = "FILE")]
    pub baseline: Option<PathBuf>,
    /// Record all findings in a file for --baseline
    #[arg(long, value_name = "FILE", conflicts_with_all = ["baseline", "fix", "diff"])]
    pub write_baseline: Option<PathBuf>,
    /// With --baseline: remove entries that are no longer found from the file
    #[arg(long, requires = "baseline", conflicts_with = "diff")]
    pub prune_baseline: bool,
    /// Host whose code surrounds each shader [default: recognised from the text]
    #[arg(long, value_name = "NAME", value_parser = super::preludes())]
    pub prelude: Option<String>,
    /// Value of a macro: `--define QUALITY=2`; repeatable
    #[arg(short = 'D', long, value_name = "NAME=VALUE", value_parser = super::definition::definition)]
    pub define: Vec<(String, String)>,
    /// Lint shaders as they stand only, and not with the options that they state set otherwise as well
    #[arg(long)]
    pub no_variants: bool,
    /// Folders to search for imported and included files
    #[arg(short = 'I', long = "include", value_name = "FOLDER")]
    pub include: Vec<PathBuf>,
    /// Exit with status 0 even if there are findings
    #[arg(long)]
    pub exit_zero: bool,
    /// Language of messages [default: from LANG]
    #[arg(long, value_enum)]
    pub lang: Option<LangName>,
}

fn formats() -> PossibleValuesParser {
    PossibleValuesParser::new(FORMATS.iter().map(|f| PossibleValue::new(f.name).help(f.summary)))
}

/// Names of the levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum LevelName {
    /// What is certainly wrong or wasteful
    #[default]
    Default,
    /// Also what is often a mistake and sometimes intended
    Strict,
    /// Also guesses by names and habits
    Heuristic,
}

impl LevelName {
    fn level(self) -> Level {
        match self {
            Self::Default => Level::Default,
            Self::Strict => Level::Strict,
            Self::Heuristic => Level::Heuristic,
        }
    }
}

/// Runs the command: findings go to `out`, complaints about the input and totals to `err`.
///
/// The status is [`ExitStatus::Error`] when a file could not be read, written or a rule is not known,
/// [`ExitStatus::Findings`] when errors or warnings are left, and [`ExitStatus::Clean`] otherwise:
/// information does not count. With `--diff` the files as they are decide.
///
/// # Errors
/// When `out`, `err`, the report or the baseline cannot be written to, and when the configuration or
/// the baseline is wrong.
pub fn run(args: &LintArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    if args.unsafe_fixes && !args.fix && !args.diff {
        anyhow::bail!("--unsafe-fixes only widens --fix or --diff; add one of them");
    }
    if args.prove && cfg!(not(feature = "run")) {
        anyhow::bail!("--prove runs shaders, which this program was built without; build it with the feature `run`");
    }
    let mut loaded = files::load(&args.paths, args.stage.map(Stage::from), &args.include)?;
    let groups = Groups::new(args, &mut loaded)?;
    let lang = super::lang(args.lang.or(groups.lang));
    for problem in &loaded.problems {
        writeln!(err, "error: {problem}")?;
    }
    for skipped in &loaded.skipped {
        writeln!(err, "warning: passed over: {skipped}")?;
    }
    for missing in &groups.missing {
        writeln!(err, "warning: {missing}")?;
    }
    let read = if loaded.problems.is_empty() { ExitStatus::Clean } else { ExitStatus::Error };
    let mut session = Session { args, loaded, groups, lang, color, out, err };
    let status = if let Some(path) = &args.write_baseline {
        session.record(path)?
    } else if args.diff {
        session.diff()?
    } else if args.fix {
        session.fix()?
    } else {
        let mut found = session.groups.run(&session.loaded.inputs);
        session.offer(&mut found);
        session.report(found)?
    };
    let found = status == ExitStatus::Findings && args.exit_zero;
    Ok(read.max(if found { ExitStatus::Clean } else { status }))
}

/// A run: what was read, and where it is told.
struct Session<'a> {
    args: &'a LintArgs,
    loaded: Loaded,
    groups: Groups,
    lang: Lang,
    color: bool,
    out: &'a mut dyn Write,
    err: &'a mut dyn Write,
}

impl Session<'_> {
    fn record(&mut self, path: &std::path::Path) -> anyhow::Result<ExitStatus> {
        let found = self.groups.run(&self.loaded.inputs);
        let count = Known::new(path, &self.loaded).write(&found)?;
        writeln!(self.err, "{}", summary::recorded(count, &path.shown(), self.lang))?;
        Ok(ExitStatus::Clean)
    }

    fn diff(&mut self) -> anyhow::Result<ExitStatus> {
        let found = self.groups.run(&self.loaded.inputs);
        let found = self.unknown(found)?;
        let outcome = self.repaired()?;
        for file in &outcome.files {
            self.out.write_all(diff::unified(file).as_bytes())?;
            let name = file.before.name();
            if let Some(form) = self.loaded.form(name).filter(|f| f.encoding != Encoding::Utf8) {
                let encoding = form.encoding;
                writeln!(self.err, "note: {name} is {encoding} and the patch is UTF-8; --fix writes {encoding}")?;
            }
        }
        self.refusals(&outcome)?;
        self.prove(&outcome)?;
        writeln!(self.err, "{}", summary::would_fix(outcome.applied, outcome.files.len(), self.lang))?;
        Ok(status_of(&found))
    }

    /// Writes repairs, and reports what is left.
    fn fix(&mut self) -> anyhow::Result<ExitStatus> {
        let outcome = self.repaired()?;
        self.refusals(&outcome)?;
        self.prove(&outcome)?;
        let mut written: Vec<&FixedFile> = Vec::new();
        for file in &outcome.files {
            match self.loaded.write(file) {
                Ok(()) => written.push(file),
                Err(error) => writeln!(self.err, "error: {error}")?,
            }
        }
        let all = written.len() == outcome.files.len();
        let remaining = if all {
            outcome.remaining
        } else {
            // What could not be written is as it was, and so are its findings.
            let now: Vec<Input> = self.loaded.inputs.iter().map(|i| after(i, &written)).collect();
            self.groups.run(&now)
        };
        let line = summary::fixed(outcome.applied, outcome.files.len(), written.len(), self.lang);
        let status = self.report_after(remaining, Some(line))?;
        Ok(if all { status } else { ExitStatus::Error })
    }

    fn refusals(&mut self, outcome: &Outcome) -> std::io::Result<()> {
        outcome.refused.iter().try_for_each(|refusal| writeln!(self.err, "warning: {refusal}"))
    }

    /// Findings get the formulas that are proved to be better, where `--prove` asks for them.
    #[cfg(feature = "run")]
    fn offer(&self, found: &mut [Diagnostic]) {
        for input in self.loaded.inputs.iter().filter(|input| self.args.prove && input.reported) {
            let Some(path) = self.loaded.path(input.file.name()) else { continue };
            let mut own: Vec<&mut Diagnostic> =
                found.iter_mut().filter(|d| d.file.name() == input.file.name()).collect();
            formula::offer(path, &input.file, &mut own);
        }
    }

    /// Without what runs shaders nothing is proved.
    #[cfg(not(feature = "run"))]
    fn offer(&self, _: &mut [Diagnostic]) {}

    /// The repaired files: better formulas first, where `--prove` asks for them, then what rules repair themselves.
    fn repaired(&mut self) -> anyhow::Result<Outcome> {
        let mut inputs = self.loaded.inputs.clone();
        let mut found = if self.args.prove { self.groups.run(&inputs) } else { Vec::new() };
        found.iter_mut().for_each(|d| d.fix = None);
        self.offer(&mut found);
        let mut improved = 0;
        for input in &mut inputs {
            let mut edits = EditList::new();
            let mut taken: Vec<&Edit> = Vec::new();
            for diagnostic in found.iter().filter(|d| d.file.name() == input.file.name()) {
                let new = diagnostic.fix.iter().flat_map(|fix| &fix.edits).filter(|edit| !taken.contains(edit));
                for edit in new.collect::<Vec<_>>() {
                    edits.push(edit.clone());
                    taken.push(edit);
                    writeln!(self.err, "{}", self.told(diagnostic))?;
                    improved += 1;
                }
            }
            if !edits.is_empty() {
                let changed = edits.apply(input.file.text()).map_err(|error| anyhow::anyhow!("{error}"))?;
                *input = input.with_file(SourceFile::new(input.file.name(), changed.text.as_str()));
            }
        }
        let mut outcome = self.groups.fix(&inputs, safety(self.args));
        outcome.applied += improved;
        for (own, input) in self.loaded.inputs.iter().zip(&inputs) {
            if own.file.text() == input.file.text() {
                continue;
            }
            let name = own.file.name();
            match outcome.files.iter_mut().find(|file| file.before.name() == name) {
                Some(file) => file.before = own.file.clone(),
                None => outcome.files.push(FixedFile { before: own.file.clone(), after: input.file.clone() }),
            }
        }
        Ok(outcome)
    }

    /// A line about a formula that is written.
    fn told(&self, diagnostic: &Diagnostic) -> String {
        let title = diagnostic.fix.as_ref().map_or("", |fix| fix.title.in_lang(self.lang));
        format!("{}: {}: {title}", diagnostic.file.locate(diagnostic.span.start), diagnostic.code.0)
    }

    /// Without what runs shaders there is nothing to compare with.
    #[cfg(not(feature = "run"))]
    fn prove(&mut self, _: &Outcome) -> std::io::Result<()> {
        Ok(())
    }

    /// Reports how far repairs move what shaders compute.
    #[cfg(feature = "run")]
    fn prove(&mut self, outcome: &Outcome) -> std::io::Result<()> {
        for file in outcome.files.iter().filter(|_| self.args.prove) {
            let name = file.before.name();
            for (function, proof) in prove::prove(file, &self.groups.config(name)) {
                for line in prove::lines(name, function.as_deref(), &proof, self.lang) {
                    writeln!(self.err, "{line}")?;
                }
            }
        }
        Ok(())
    }

    /// The findings that the baseline does not know. What it knows and is gone is told.
    fn unknown(&mut self, found: Vec<Diagnostic>) -> anyhow::Result<Vec<Diagnostic>> {
        let Some(path) = &self.args.baseline else { return Ok(found) };
        let prune = self.args.prune_baseline;
        let covered = Known::new(path, &self.loaded).cover(found, &self.groups, prune)?;
        for known in &covered.stale {
            let line = summary::stale(&known.rule, &known.file, &known.line, known.count, self.lang);
            writeln!(self.err, "{line}")?;
        }
        if !covered.stale.is_empty() && !prune {
            writeln!(self.err, "{}", summary::prune_hint(self.lang))?;
        }
        if covered.covered > 0 {
            writeln!(self.err, "{}", summary::known(covered.covered, self.lang))?;
        }
        Ok(covered.left)
    }

    fn report(&mut self, found: Vec<Diagnostic>) -> anyhow::Result<ExitStatus> {
        self.report_after(found, None)
    }

    /// Prints findings, then a line on what was done, then totals.
    fn report_after(&mut self, found: Vec<Diagnostic>, done: Option<String>) -> anyhow::Result<ExitStatus> {
        let found = self.unknown(found)?;
        let root = std::env::current_dir().ok().map(|folder| files::name(&folder));
        let context = Context { lang: self.lang, color: self.color, root };
        let format = self.args.format.as_deref().and_then(by_name).unwrap_or(FORMATS[0]);
        let write = |format: &Format, context: &Context| (format.write)(&found, context);
        // Whoever names a rule asks for what it says.
        let info = self.args.info || !self.args.select.is_empty() || !self.loaded.is_folder;
        let text = || match () {
            () if self.args.statistics => grouped::statistics(&found),
            () if self.loaded.is_folder => grouped::write(&found, info, &context),
            () => write(FORMATS[0], &context),
        };
        let is_text = format.name == FORMATS[0].name;
        if let Some(path) = &self.args.output {
            let report = write(format, &Context { color: false, ..context.clone() });
            fresh::write(path, report.as_bytes()).with_context(|| format!("{}: cannot be written", path.shown()))?;
        }
        let shown = if is_text || self.args.output.is_some() { text() } else { write(format, &context) };
        self.out.write_all(shown.as_bytes())?;
        for line in done.into_iter().chain(summary::totals(&found, &self.loaded.inputs, self.lang)) {
            writeln!(self.err, "{line}")?;
        }
        if is_text && self.loaded.is_folder && !self.args.statistics {
            for line in summary::next(&found, info, self.lang) {
                writeln!(self.err, "{line}")?;
            }
        }
        Ok(status_of(&found))
    }
}

/// An input with the text that was written.
fn after(input: &Input, written: &[&FixedFile]) -> Input {
    let file = written.iter().find(|f| f.before.name() == input.file.name());
    file.map_or_else(|| input.clone(), |f| input.with_file(f.after.clone()))
}

fn safety(args: &LintArgs) -> Safety {
    if args.unsafe_fixes { Safety::Unsafe } else { Safety::Safe }
}

fn status_of(found: &[Diagnostic]) -> ExitStatus {
    if found.iter().any(|d| d.severity > Severity::Info) { ExitStatus::Findings } else { ExitStatus::Clean }
}

#[cfg(test)]
mod tests;
