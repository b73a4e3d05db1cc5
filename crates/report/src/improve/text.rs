//! The report for people: each expression with what it loses, then its proposals.

use std::fmt::Write as _;

use super::Summary;
use engine::improve::{Lost, OnDevice, Plot, Proposal, Report, Source};

/// Heights of a plot.
const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// The report.
pub fn text(summary: &Summary, color: bool) -> String {
    let mut text = String::new();
    for file in &summary.files {
        for report in &file.expressions {
            expression(&mut text, report, &summary.profile, color);
        }
        for (function, why) in &file.not_run {
            let _ = writeln!(text, "{}: `{function}` was not looked at: {why}\n", file.file);
        }
        if let Some(patch) = &file.patch {
            let _ = writeln!(text, "{patch}");
        }
        if file.written {
            let _ = writeln!(text, "{}: written", file.file);
        }
    }
    let (better, all) = summary.counts();
    let _ = writeln!(text, "{all} expressions that lose bits, {better} with a better formula");
    text
}

fn expression(text: &mut String, report: &Report, profile: &str, color: bool) {
    let [bold, off] = if color { ["\u{1b}[1m", "\u{1b}[0m"] } else { ["", ""] };
    let _ = writeln!(text, "{}: in `{}`\n  {bold}{}{off}", report.at, report.function, report.text);
    if let Some(why) = &report.failed {
        let _ = writeln!(text, "  {why}\n");
        return;
    }
    let _ = writeln!(text, "  loses {}; costs {:.0}", lost(report.lost), report.operations);
    for input in &report.inputs {
        let [low, high] = input.range;
        let from = input
            .taken_for
            .as_ref()
            .map_or_else(|| "stated".to_owned(), |what| format!("not stated; taken for {what}"));
        let _ = writeln!(text, "  over {} from {:?} to {high:?} ({from})", input.name, low + 0.0);
    }
    if !report.inlined.is_empty() {
        let _ = writeln!(text, "  with {} written out", report.inlined.join(", "));
    }
    if let (Some(pole), (with, without)) = (&report.pole, report.points) {
        let _ =
            writeln!(text, "  without a value at {without} of {} points, left out: {}", with + without, point(pole));
    }
    if report.proposals.is_empty() {
        text.push_str("  no better formula was found\n");
    }
    for (k, one) in report.proposals.iter().enumerate() {
        proposal(text, k + 1, one, report, profile);
    }
    for (formula, why) in &report.refused {
        let _ = writeln!(text, "  not proposed: {formula}\n     {why}");
    }
    text.push('\n');
}

fn proposal(text: &mut String, number: usize, one: &Proposal, report: &Report, profile: &str) {
    let _ = writeln!(text, "\n  {number}. {}", one.text);
    let _ =
        writeln!(text, "     loses {}, instead of {}; costs {:.0}", lost(one.lost), lost(report.lost), one.operations);
    devices(text, one);
    plot(text, &one.plot);
    let proof = &one.proof;
    let _ = write!(text, "     equal in real numbers at {} points", proof.points - proof.open);
    if proof.many_bits > 0 {
        let _ = write!(text, ", {} of them by 320 bits", proof.many_bits);
    }
    if proof.rounded > 0 {
        let _ =
            write!(text, "; at {} of these but for less than a sixteenth of a unit in the last place", proof.rounded);
    }
    if proof.open > 0 {
        let _ = write!(text, "; {} more lose too many digits in binary64 to tell", proof.open);
    }
    if proof.won > 0 {
        let _ = write!(text, "; has a value at {} where the text has none", proof.won);
    }
    text.push('\n');
    match &one.worse {
        None => text.push_str("     worse at no point\n"),
        Some((share, at, [before, after])) => {
            let _ = writeln!(
                text,
                "     worse at {:.1} % of the points, most at {}: {after:.1} bits instead of {before:.1}",
                100.0 * share,
                point(at)
            );
        }
    }
    judged(text, one, profile);
}

/// What both lose on devices: of promises the one by which the proposal loses most, then each device.
fn devices(text: &mut String, one: &Proposal) {
    let promised = |one: &&OnDevice| one.source == Source::Promise;
    let worst = one.devices.iter().filter(promised).max_by(|a, b| a.lost[1].mean.total_cmp(&b.lost[1].mean));
    for on in worst.into_iter().chain(one.devices.iter().filter(|one| !promised(one))) {
        let [before, after] = on.lost;
        let _ = writeln!(
            text,
            "     {}: {:.2} → {:.2} bits in the mean, {:.1} → {:.1} at worst",
            on.shown(),
            before.mean,
            after.mean,
            before.worst,
            after.worst
        );
    }
}

fn judged(text: &mut String, one: &Proposal, profile: &str) {
    for bounds in &one.compared.accuracy {
        let ratio = bounds
            .median_ratio
            .map_or_else(String::new, |ratio| format!("{:.2} times as wide in the median, ", 1.0 / ratio));
        let _ = writeln!(
            text,
            "     bound of a device by {profile}: {ratio}tighter at {} and wider at {} of {} samples",
            bounds.better[1], bounds.better[0], bounds.compared
        );
        if bounds.alone[1] + bounds.alone[0] > 0 {
            let _ = writeln!(
                text,
                "     bounded at {} samples where the text is not, and not at {} where it is",
                bounds.alone[1], bounds.alone[0]
            );
        }
    }
    if let Some([before, after]) = &one.compared.resolution {
        let _ = writeln!(
            text,
            "     distinct outputs of {} neighbouring inputs: {} instead of {}; steps the wrong way: {} instead of {}",
            after.inputs, after.distinct, before.distinct, after.reversed, before.reversed
        );
    }
    for lane in &one.compared.lanes {
        let says = match (&lane.not_run, &lane.farthest) {
            (Some(why), _) => format!("not run: {why}"),
            (None, Some((far, _))) => {
                format!("{} of {} outputs are alike, the others by at most {far:.0} ULP", lane.same, lane.samples)
            }
            (None, None) => format!("all {} outputs are alike", lane.samples),
        };
        let _ = writeln!(text, "     on {}: {says}", lane.lane);
    }
}

fn lost(lost: Lost) -> String {
    format!("{:.2} bits in the mean and {:.1} at worst", lost.mean, lost.worst)
}

fn point(at: &[(String, f32)]) -> String {
    at.iter().map(|(name, x)| format!("{name} = {x:?}")).collect::<Vec<_>>().join(", ")
}

/// Two lines of bars with one scale: before, after.
fn plot(text: &mut String, plot: &Plot) {
    let most = plot.places.iter().flat_map(|(_, lost)| *lost).fold(1.0, f64::max);
    let bars = |side: usize| -> String {
        let height = |lost: f64| BARS[((lost / most * 7.0).round().clamp(0.0, 7.0)) as usize];
        plot.places.iter().map(|(_, lost)| height(lost[side])).collect()
    };
    let Some((to, _)) = plot.places.last() else { return };
    let _ = writeln!(text, "     before {}  bits lost over {}, up to {most:.1}", bars(0), plot.input);
    let _ = writeln!(text, "     after  {}  from {:?} to {to:?}", bars(1), plot.from);
}
