//! `shadercheck lint`: finds faults in shaders and in the C and C++ code around them, and repairs them.

mod diff;
mod files;
mod write;

use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::cli::LangName;
use crate::cli::status::ExitStatus;
use crate::diagnostic::{Diagnostic, Lang, Safety, Severity};
use crate::lint::fix::Outcome;
use crate::lint::{Config, Level, Selection, Settings, by_code, fix, run_with};
use crate::report::diagnostics;

use files::Loaded;

/// Find faults in shaders, and in C and C++ code that feeds them
#[derive(Args, Clone, Debug, Default)]
pub struct LintArgs {
    /// Files, and folders that are searched for shaders and C and C++ files
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// Repair what can be repaired without changing the meaning
    #[arg(long)]
    pub fix: bool,
    /// With --fix or --diff: repair also where the result may change
    #[arg(long)]
    pub unsafe_fixes: bool,
    /// Print the repairs as a patch; write nothing
    #[arg(long)]
    pub diff: bool,
    /// Only these rules: codes (T001), beginnings of codes (H), or names
    #[arg(long, value_name = "RULE", value_delimiter = ',')]
    pub select: Vec<String>,
    /// Without these rules
    #[arg(long, value_name = "RULE", value_delimiter = ',')]
    pub ignore: Vec<String>,
    /// Also rules that report what may be meant (strict), or that guess by names (heuristic)
    #[arg(long, value_enum, default_value_t)]
    pub level: LevelName,
    /// How findings are printed
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// Language of messages; LANG decides when it is left out
    #[arg(long, value_enum)]
    pub lang: Option<LangName>,
}

/// How findings are printed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// With excerpts of the text
    #[default]
    Text,
    /// One line each
    Concise,
    /// An array for programs
    Json,
}

/// Names of the levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum LevelName {
    /// What is wrong or wasteful for certain
    #[default]
    Default,
    /// Also what is often a mistake, and sometimes meant
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
/// When `out` or `err` cannot be written to.
pub fn run(args: &LintArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    if args.unsafe_fixes && !args.fix && !args.diff {
        writeln!(err, "error: --unsafe-fixes only widens --fix or --diff; add one of them")?;
        return Ok(ExitStatus::Error);
    }
    let selection = match Selection::new(&args.select, &args.ignore) {
        Ok(selection) => selection.at(args.level.level()),
        Err(error) => {
            writeln!(err, "error: {error}")?;
            return Ok(ExitStatus::Error);
        }
    };
    let settings = Settings { selection, config: Config::default() };
    let lang = super::lang(args.lang);
    let loaded = files::load(&args.paths);
    for problem in &loaded.problems {
        writeln!(err, "error: {problem}")?;
    }
    let mut status = if loaded.problems.is_empty() { ExitStatus::Clean } else { ExitStatus::Error };
    if args.diff {
        let found = run_with(&loaded.inputs, &settings);
        let outcome = fix::fix(&loaded.inputs, &settings, safety(args));
        outcome.files.iter().try_for_each(|f| out.write_all(diff::unified(f).as_bytes()))?;
        report_refusals(&outcome, err)?;
        writeln!(err, "{} in {} would be fixed", findings(outcome.applied), files_count(outcome.files.len()))?;
        return Ok(status.max(status_of(&found)));
    }
    if !args.fix {
        let found = run_with(&loaded.inputs, &settings);
        print(&found, args.format, lang, out, color)?;
        status = status.max(status_of(&found));
        write!(err, "{}", summary(&found, &loaded))?;
        return Ok(status);
    }
    let outcome = fix::fix(&loaded.inputs, &settings, safety(args));
    report_refusals(&outcome, err)?;
    let mut written = true;
    for file in &outcome.files {
        if let Err(error) = loaded.write(file) {
            writeln!(err, "error: {error}")?;
            written = false;
        }
    }
    if !written {
        status = ExitStatus::Error;
    }
    print(&outcome.remaining, args.format, lang, out, color)?;
    let verb = if written { "fixed" } else { "found a fix for" };
    writeln!(err, "{verb} {} in {}", findings(outcome.applied), files_count(outcome.files.len()))?;
    write!(err, "{}", summary(&outcome.remaining, &loaded))?;
    Ok(status.max(status_of(&outcome.remaining)))
}

fn safety(args: &LintArgs) -> Safety {
    if args.unsafe_fixes { Safety::Unsafe } else { Safety::Safe }
}

fn status_of(found: &[Diagnostic]) -> ExitStatus {
    if found.iter().any(|d| d.severity > Severity::Info) { ExitStatus::Findings } else { ExitStatus::Clean }
}

fn report_refusals(outcome: &Outcome, err: &mut dyn Write) -> std::io::Result<()> {
    outcome.refused.iter().try_for_each(|refusal| writeln!(err, "warning: {refusal}"))
}

fn print(found: &[Diagnostic], format: Format, lang: Lang, out: &mut dyn Write, color: bool) -> anyhow::Result<()> {
    match format {
        Format::Text => {
            for diagnostic in found {
                writeln!(out, "{}", diagnostics::text(diagnostic, lang, color))?;
            }
        }
        Format::Concise => {
            for diagnostic in found {
                writeln!(out, "{}", diagnostics::concise(diagnostic, lang))?;
            }
        }
        Format::Json => {
            let text = diagnostics::json(found, lang, |code| by_code(code).map(|r| r.name))?;
            out.write_all(text.as_bytes())?;
        }
    }
    Ok(())
}

/// Totals: how much was looked at, what was found, what could be fixed.
fn summary(found: &[Diagnostic], loaded: &Loaded) -> String {
    let count = |severity| found.iter().filter(|d| d.severity == severity).count();
    let looked_at = files_count(loaded.inputs.iter().filter(|i| i.reported).count());
    let mut text = String::new();
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    // Writing into a String does not fail.
    let _ = writeln!(
        text,
        "{looked_at}: {}, {}, {} info",
        plural(count(Severity::Error), "error"),
        plural(count(Severity::Warning), "warning"),
        count(Severity::Info)
    );
    let fixable = |s| found.iter().filter(|d| d.fix.as_ref().is_some_and(|f| f.safety == s)).count();
    let (safe, risky) = (fixable(Safety::Safe), fixable(Safety::Unsafe));
    if safe > 0 {
        let _ = writeln!(text, "{} can be fixed with --fix", findings(safe));
    }
    if risky > 0 {
        let need = if risky == 1 { "needs" } else { "need" };
        let _ = writeln!(text, "{risky} more {need} --fix --unsafe-fixes");
    }
    text
}

fn findings(n: usize) -> String {
    format!("{n} finding{}", if n == 1 { "" } else { "s" })
}

fn files_count(n: usize) -> String {
    format!("{n} file{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests;
