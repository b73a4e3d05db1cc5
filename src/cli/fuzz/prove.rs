//! `shadercheck fuzz --prove`: races and bounds of compute stages for all sizes.

use std::io::Write;

use super::{FuzzArgs, IncludedText, all_known, command, ended, subjects};
use crate::cli::reported::Reported;
use crate::cli::status::ExitStatus;
use base::diagnostic::Lang;
use engine::prove;
use lanes::interrupt;
use report::prove::{Summary, json, text};

/// Looks at every compute stage of the texts: the report goes to `out`, what does not compile to `err`.
pub(super) fn run(
    args: &FuzzArgs,
    sources: &[IncludedText],
    out: &mut dyn Write,
    err: &mut dyn Write,
    color: bool,
) -> anyhow::Result<ExitStatus> {
    if let Reported::Service(service) = args.format {
        anyhow::bail!("--prove has nothing that `{}` could show: --format is text or json", service.name);
    }
    let mut summary = Summary { kernels: Vec::new(), not_run: Vec::new() };
    let (mut known, mut broken) = (Vec::new(), false);
    'all: for source in sources {
        for note in source.notes() {
            writeln!(err, "note: {note}")?;
        }
        let (errors, subjects) = subjects((&args.function, &args.input.define), source, &mut known)?;
        for error in &errors {
            err.write_all(report::diagnostics::text(error, Lang::En, false).as_bytes())?;
        }
        broken |= !errors.is_empty();
        let command = command(args, source);
        for subject in &subjects {
            match &subject.dispatch {
                Some(Ok(dispatched)) => {
                    let report = prove::run(subject, dispatched, &command);
                    // What was under way when the run was to end is left out.
                    if interrupt::asked() {
                        break 'all;
                    }
                    summary.kernels.push(report);
                }
                Some(Err(why)) => summary.not_run.push((subject.label.clone(), why.clone())),
                // A function is looked at where a compute stage calls it.
                None => {}
            }
        }
    }
    if !broken && !interrupt::asked() {
        all_known(&args.function, &known)?;
    }
    let printed = match args.format {
        Reported::Text => text(&summary, color),
        Reported::Json | Reported::Service(_) => json(&summary),
    };
    out.write_all(printed.as_bytes())?;
    let nothing = summary.kernels.is_empty().then_some("there is no compute stage that could be looked at");
    ended(err, broken, summary.has_findings(), nothing)
}
