//! `shadercheck fuzz --reproducible`: which outputs have the same bits on every conforming device.

use std::io::Write;

use super::{FuzzArgs, IncludedText, Inputs, all_known, command, ended, subjects};
use crate::cli::check::profile;
use crate::cli::reported::Reported;
use crate::cli::status::ExitStatus;
use base::diagnostic::Lang;
use engine::fuzz::Stated;
use engine::reproducible::{self, Request};
use lanes::{Lane, interrupt};
use report::reproducible::{Summary, json, text};

/// What devices promise, where nothing else is asked for.
const PROFILE: &str = "vulkan-1.4";

/// Looks at every function of the texts: the report goes to `out`, what does not compile to `err`.
pub(super) fn run(
    args: &FuzzArgs,
    sources: &[IncludedText],
    stated: &[Stated],
    out: &mut dyn Write,
    err: &mut dyn Write,
    color: bool,
) -> anyhow::Result<ExitStatus> {
    if let Reported::Service(service) = args.format {
        anyhow::bail!("--reproducible finds nothing that `{}` could show: --format is text or json", service.name);
    }
    let Some(profile) = profile::named(args.profile.as_deref().unwrap_or(PROFILE))? else {
        anyhow::bail!("--profile: what devices may do differently follows from what they promise; `none` has nothing");
    };
    let opened = crate::cli::lanes::opened(&args.lane, args.lane.is_empty())?;
    let lanes: Vec<&dyn Lane> = opened.iter().map(AsRef::as_ref).collect();
    let mut inputs = Inputs::new(stated);
    let mut summary = Summary { functions: Vec::new(), not_run: Vec::new() };
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
        let command = format!("{} --reproducible", command(args, source));
        for subject in &subjects {
            let domain = inputs.domain(subject)?;
            let request = Request {
                samples: args.samples,
                seed: args.input.seed,
                case: args.case.as_deref(),
                profile: &profile,
                lanes: &lanes,
                command: &command,
            };
            let ready = match &subject.ready {
                Ok(ready) => ready,
                Err(why) => {
                    summary.not_run.push((subject.label.clone(), why.clone()));
                    continue;
                }
            };
            let report = reproducible::run(subject, ready, &domain, &request);
            // What was under way when the run was to end is left out.
            if interrupt::asked() {
                break 'all;
            }
            summary.functions.push(report.map_err(|why| anyhow::anyhow!("--case: {why}"))?);
        }
    }
    if !broken && !interrupt::asked() {
        all_known(&args.function, &known)?;
    }
    if !interrupt::asked() {
        inputs.all_used()?;
    }
    let printed = match args.format {
        Reported::Text => text(&summary, color),
        Reported::Json | Reported::Service(_) => json(&summary),
    };
    out.write_all(printed.as_bytes())?;
    let nothing = summary.functions.is_empty().then_some("nothing could be run");
    ended(err, broken, summary.has_findings(), nothing)
}
