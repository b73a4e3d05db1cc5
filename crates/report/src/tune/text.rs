//! The report for people: a table of the declarations, then why some must be `highp`, then the patch.

use std::fmt::Write as _;

use super::{FileReport, Summary};
use crate::word::readable;
use engine::tune::{Report, Row, Shown, Tolerance, word};

/// The report.
pub fn text(summary: &Summary, color: bool) -> String {
    let mut text = String::new();
    for file in &summary.files {
        one(&mut text, file, color);
    }
    text
}

/// A number of allowed errors.
fn ratio(x: f64) -> String {
    if x.is_infinite() { "lost".to_owned() } else { format!("{x:.2}") }
}

/// What an output may be off by.
pub(super) fn allowed(tolerance: Tolerance) -> String {
    match tolerance {
        Tolerance::Absolute(limit) => readable(limit),
        Tolerance::Unit(limit) => format!("{} between 0 and 1", readable(limit)),
        Tolerance::Relative(limit) => format!("{} of its size", readable(limit)),
        Tolerance::Pixels([width, height]) => format!("half a pixel of {width}x{height}"),
    }
}

fn one(text: &mut String, file: &FileReport, color: bool) {
    let [bold, off] = if color { ["\u{1b}[1m", "\u{1b}[0m"] } else { ["", ""] };
    let report = &file.report;
    let _ = writeln!(text, "{}: {bold}{}{off}", report.at, report.function);
    for (name, says) in &report.inputs {
        let _ = writeln!(text, "  over {name}: {says}");
    }
    for (name, tolerance) in &report.outputs {
        let _ = writeln!(text, "  {name} may be off by {}", allowed(*tolerance));
    }
    if report.left_out > 0 {
        let _ = writeln!(text, "  {} samples without a sound output in binary32 were left out", report.left_out);
    }
    if let Some(beyond) = &report.beyond {
        text.push_str("  even so the outputs are off, by something whose precision this file does not state:\n");
        shown(text, beyond);
        return;
    }
    table(text, report);
    for row in report.rows.iter().filter(|row| row.high) {
        if row.shown.is_some() || row.texels.is_some() || row.kept {
            let _ = writeln!(text, "\n  {} must be highp", row.declaration.what);
        }
        if let Some(size) = row.texels {
            let repeats = if row.declaration.repeats { ", fewer where they repeat" } else { "" };
            let _ = writeln!(
                text,
                "    a coordinate of textures comes from it: of {size} texels (--texture-size) `mediump` tells less than 1024 apart{repeats}"
            );
        }
        if row.kept {
            text.push_str("    nobody states the range of what goes into it: a comment or --domain does\n");
        }
        if row.declaration.sampler {
            text.push_str("    what is read from it has its precision, which is `lowp` by default: enough for 8 bits of a colour\n");
        }
        row.shown.iter().for_each(|found| shown(text, found));
    }
    proof(text, report);
    if let Some(patch) = &file.patch {
        let _ = writeln!(text, "\n{patch}");
    }
    if file.written {
        let _ = writeln!(text, "{}: written", file.file);
    }
}

fn table(text: &mut String, report: &Report) {
    let head = ["declaration", "now", "may be", "error if it alone is mediump", "samples off", "at edges"];
    let row = |row: &Row| {
        let percent = |part: f64| if part > 0.0 { format!("{:.2} %", 100.0 * part) } else { "none".to_owned() };
        [
            row.declaration.what.clone(),
            row.declaration.now.map_or("-", word).to_owned(),
            if row.high { "highp".to_owned() } else { "mediump".to_owned() },
            ratio(row.alone),
            percent(row.alone_off[0]),
            percent(row.alone_off[1]),
        ]
    };
    let mut rows: Vec<[String; 6]> = vec![head.map(str::to_owned)];
    rows.extend(report.rows.iter().map(row));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    text.push('\n');
    for row in &rows {
        let cells: Vec<String> = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
        let _ = writeln!(text, "  {}", cells.join("  ").trim_end());
    }
    text.push_str("  errors in units of what is allowed\n");
}

fn shown(text: &mut String, found: &Shown) {
    if let Some(place) = &found.place {
        let _ = writeln!(text, "    {}: `{}`", place.at, place.text);
    }
    let [wide, device] = found.values;
    let times =
        if found.ratio.is_finite() { format!(", {:.2} times what is allowed", found.ratio) } else { String::new() };
    let _ = writeln!(text, "    {}: {} is {wide:?}, and {device:?} on a device{times}", found.message, found.output);
    for input in &found.inputs {
        let _ = writeln!(text, "    {} = {}", input.shown(), input.values());
    }
}

fn proof(text: &mut String, report: &Report) {
    let high = report.rows.iter().filter(|row| row.high).count();
    let set = match (high, report.smallest) {
        (0, _) => "all may be mediump".to_owned(),
        (_, true) => format!("{high} of {} must be highp, and no smaller set holds", report.rows.len()),
        (_, false) => {
            format!("with {high} of {} highp it holds, and none of these can be lowered alone", report.rows.len())
        }
    };
    let _ = writeln!(text, "\n  {set}");
    let _ = writeln!(
        text,
        "  proved on {} samples of devices that err as far as GLSL ES and Vulkan allow: the largest error is {}",
        report.samples,
        ratio(report.worst)
    );
    if report.jumps > 0 {
        let _ = writeln!(
            text,
            "  at {} of these a decision falls to the other side of an edge that it is near to",
            report.jumps
        );
    }
    let [worst, half] = report.all_medium.map(ratio);
    let _ = writeln!(
        text,
        "  on a device with binary16 the largest error is {}; with mediump everywhere it is {half}, and {worst} at the least that is allowed",
        ratio(report.binary16)
    );
}
