//! `--prove`: better formulas for what rules about numbers find, each with its proof.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

use base::diagnostic::{Diagnostic, Fix, Message, Safety};
use base::text::SourceFile;
use engine::fuzz::{Domain, Subject};
use engine::improve::{self, Proposal, Request};
use engine::suite::run::DEFAULT_SEED;
use judge::profile::by_name;
use lanes::{Lane, embedded};
use program::Written;

use crate::cli::compose::{ComposeArgs, Given};
use crate::cli::fuzz::{Inputs, subjects};
use crate::cli::includes::{self, IncludedText};

/// Rules about what a formula loses, or where it has no value: powers, `normalize`, `acos` and `asin`, roots and logarithms,
/// cosines, differences that cancel.
const RULES: [&str; 9] = ["N001", "N002", "N003", "N005", "N006", "N007", "N008", "N017", "N022"];

/// Points of a proof.
const SAMPLES: u64 = 1 << 20;

/// Bits that an expression loses at worst, at the least, for another formula to be worth the change.
const LEAST: f64 = 3.0;

/// What bounds are derived from.
const PROFILE: &str = "vulkan-1.4";

/// Gives findings of a file the formula that is proved to be better as their fix, in place of one that is not; returns how
/// many got one.
pub fn offer(path: &Path, file: &SourceFile, found: &mut [&mut Diagnostic]) -> usize {
    let about = |d: &Diagnostic| RULES.contains(&d.code.0) && d.file.name() == file.name();
    let lines: BTreeSet<usize> = found.iter().filter(|d| about(d)).map(|d| file.position(d.span.start).line).collect();
    if lines.is_empty() {
        return 0;
    }
    let proposals = proposals(path, file, &lines).unwrap_or_default();
    let mut count = 0;
    for diagnostic in found.iter_mut().filter(|d| about(d)) {
        let span = diagnostic.span;
        let over = |p: &&(f64, Proposal)| p.1.edit.span.start < span.end && span.start < p.1.edit.span.end;
        let Some((before, proposal)) = proposals.iter().find(over) else { continue };
        diagnostic.fix =
            Some(Fix { title: title(*before, proposal), edits: vec![proposal.edit.clone()], safety: Safety::Safe });
        count += 1;
    }
    count
}

fn title(before: f64, one: &Proposal) -> Message {
    let (text, points, after) = (&one.text, one.proof.points - one.proof.open, one.lost.worst);
    let ratio = one.compared.accuracy.first().and_then(|bounds| bounds.median_ratio).map(|ratio| 1.0 / ratio);
    let [bound, grenze] = ratio.map_or_else(Default::default, |ratio| {
        [format!("; the bound of a device is {ratio:.2} times as wide"), format!("。装置の誤差限界は {ratio:.2} 倍")]
    });
    Message::new(
        format!(
            "write `{text}`: equal in real numbers at {points} points, loses {after:.1} bits at worst instead of {before:.1}{bound}"
        ),
        format!(
            "`{text}` と書く。{points} 点で実数として等しく、失うビットは最大 {before:.1} の代わりに {after:.1}{grenze}"
        ),
    )
}

/// The best proposal of each expression in these lines, with what the text loses at worst.
fn proposals(path: &Path, file: &SourceFile, lines: &BTreeSet<usize>) -> anyhow::Result<Vec<(f64, Proposal)>> {
    let compose = ComposeArgs::default();
    let reading = Given { folders: &[], defines: &[], compose: Some(&compose), entry: None, stage: None, chunks: None };
    let source = includes::with_includes(file, path, &reading)?;
    let written = Written::of(&source.file);
    let module = if written == Written::Wgsl { Some(source.module()?) } else { None };
    let parsed = (written == Written::Glsl).then(|| source.parsed(&[]).shader);
    let Some(shader) = module.as_ref().and_then(|module| module.tree()).or(parsed.as_ref()) else {
        return Ok(Vec::new());
    };
    let halves = improve::halves(shader);
    // What is run is made ready, which takes a while: only functions around the lines.
    let here = |info: &syntax::symbols::FunctionInfo| {
        let item = info.definition.and_then(|item| shader.unit().items.get(item));
        item.and_then(|item| improve::own_span(shader, file, item.span)).is_some_and(|span| {
            let (first, last) = (file.position(span.start).line, file.position(span.end).line);
            lines.range(first..=last).next().is_some()
        })
    };
    let names: Vec<String> =
        shader.functions().filter(|(_, info)| here(info)).map(|(_, info)| info.name.name.clone()).collect();
    let names: Vec<String> = names.into_iter().filter(|name| !halves.contains(name)).collect();
    let Some(profile) = by_name(PROFILE) else { return Ok(Vec::new()) };
    let devices = improve::shipped();
    let lane = embedded::open()?;
    let lanes: [&dyn Lane; 1] = [lane.as_ref()];
    let read = |source: &IncludedText, names: &[String]| -> anyhow::Result<Vec<Subject>> {
        if names.is_empty() {
            return Ok(Vec::new());
        }
        Ok(subjects((names, &[]), source, &mut Vec::new())?.1)
    };
    let mut all: Vec<(f64, Proposal)> = Vec::new();
    let mut inputs = Inputs::new(&[]);
    for subject in read(&source, &names)?.iter().filter(|subject| subject.ready.is_ok()) {
        let domain: Domain = inputs.domain(subject)?;
        let again = |changed: &SourceFile| {
            let text = source.changed(changed, &Given { compose: None, ..reading }).map_err(|e| e.to_string())?;
            read(&text, std::slice::from_ref(&subject.name)).map_err(|e| e.to_string())
        };
        for &line in lines {
            let request = Request {
                samples: SAMPLES,
                seed: DEFAULT_SEED,
                profile,
                devices: &devices,
                line: Some(line),
                nodes: improve::NODES,
                time: Duration::from_secs(4),
                command: String::new(),
            };
            // A range without an end is nothing to measure in: the finding stays as it is.
            let Ok(reports) = improve::run((shader, file, subject), &domain, &lanes, &request, &again) else {
                continue;
            };
            let worth = reports.into_iter().filter(|report| report.lost.worst >= LEAST);
            all.extend(worth.filter_map(|report| Some((report.lost.worst, report.proposals.into_iter().next()?))));
        }
    }
    // An expression over two lines comes twice.
    all.sort_by_key(|(_, proposal)| proposal.edit.span.start);
    all.dedup_by_key(|(_, proposal)| proposal.edit.span);
    Ok(all)
}
