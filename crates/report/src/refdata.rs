//! What a comparison with reference data found.

use std::fmt::Write;

use serde_json::json;

use base::value::F32Bits;
use refdata::WordType;
use refdata::verify::{Report, Worst};

/// The report for people.
pub fn text(report: &Report) -> String {
    let mut text = String::new();
    let Report { suite, samples, rows, matched, .. } = report;
    let profile = report.profile.as_ref().map_or_else(String::new, |p| format!(", bounds of {p}"));
    let total = report.total();
    let open = total.undetermined;
    let all = open + total.agreed + total.deviated + total.not_finite;
    let unbounded = match open {
        0 => String::new(),
        _ => format!(", {open} of {all} elements without a bound ({:.2} %)", open as f64 * 100.0 / all as f64),
    };
    let _ = writeln!(text, "{suite}: {samples} samples, {rows} rows matched by {matched}{profile}{unbounded}");
    for (name, counts) in &report.outputs {
        let _ = writeln!(
            text,
            "  {name:20} {} agreed, {} deviated, {} not finite, {} undetermined",
            counts.agreed, counts.deviated, counts.not_finite, counts.undetermined
        );
    }
    if !report.findings.is_empty() {
        for worst in &report.worst {
            text.push('\n');
            case(&mut text, worst);
        }
    } else if let Some(worst) = report.worst.first() {
        let element = &worst.element;
        let at = format!("`{}` of sample {}", element.component, element.sample);
        let _ = writeln!(text, "  nearest to its bound: {at}, {:.3} of it", element.ratio());
    }
    text.push('\n');
    for finding in &report.findings {
        let _ = writeln!(text, "finding: {finding}");
    }
    let _ = writeln!(
        text,
        "{}: {} elements judged, {} agreed, {} deviated, {} not finite, {} undetermined",
        if report.findings.is_empty() { "pass" } else { "fail" },
        total.agreed + total.deviated + total.not_finite,
        total.agreed,
        total.deviated,
        total.not_finite,
        total.undetermined
    );
    text
}

fn case(text: &mut String, Worst { element, flags, inputs }: &Worst) {
    let _ = writeln!(
        text,
        "`{}` of sample {} is {:?} (0x{:08x}), expected {:?} ± {:.1e}",
        element.component, element.sample, element.actual, element.bits, element.expected, element.bound
    );
    let _ = writeln!(text, "  off by     {:.3e}: {} of its bound", element.error(), times(element.ratio()));
    for (name, kind, words) in inputs {
        // A long list says less than its beginning.
        let shown: Vec<String> = words.iter().take(16).map(|&word| number(word, *kind)).collect();
        let rest = if words.len() > 16 { ", …" } else { "" };
        let _ = writeln!(text, "  input      {name} = {}{rest}", shown.join(", "));
    }
    if flags.0 != 0 {
        let _ = writeln!(text, "  flags      {flags}");
    }
}

fn number(word: u32, kind: WordType) -> String {
    match kind {
        WordType::F4 => F32Bits(word).to_string(),
        WordType::I4 => word.cast_signed().to_string(),
        WordType::F8 | WordType::U4 | WordType::U2 => word.to_string(),
    }
}

/// A factor in few digits.
fn times(x: f64) -> String {
    if x < 1e6 { format!("{x:.3}") } else { format!("{x:.3e}") }
}

/// The report for programs.
pub fn json(report: &Report) -> String {
    let real = |x: f64| if x.is_finite() { json!(x) } else { json!(format!("{x}").to_lowercase()) };
    let counts = |counts: &refdata::verify::Counts| {
        json!({
            "agreed": counts.agreed, "deviated": counts.deviated,
            "not_finite": counts.not_finite, "undetermined": counts.undetermined,
        })
    };
    let outputs: Vec<_> =
        report.outputs.iter().map(|(name, of)| json!({ "output": name, "counts": counts(of) })).collect();
    let worst: Vec<_> = report
        .worst
        .iter()
        .map(|Worst { element, flags, inputs }| {
            let inputs: serde_json::Map<_, _> = inputs
                .iter()
                .map(|(name, _, words)| {
                    (name.clone(), json!(words.iter().map(|w| format!("{w:08x}")).collect::<Vec<_>>()))
                })
                .collect();
            json!({
                "sample": element.sample, "component": element.component,
                "verdict": element.verdict.name(),
                "expected": real(element.expected), "nearest_bits": format!("{:08x}", element.nearest),
                "actual": real(element.actual), "actual_bits": format!("{:08x}", element.bits),
                "error": real(element.error()), "bound": real(element.bound), "ratio": real(element.ratio()),
                "flags": flags.to_string(), "inputs": inputs,
            })
        })
        .collect();
    let value = json!({
        "status": if report.findings.is_empty() { "pass" } else { "fail" },
        "suite": report.suite, "profile": report.profile,
        "samples": report.samples, "rows": report.rows, "matched": report.matched,
        "outputs": outputs, "total": counts(&report.total()),
        "findings": report.findings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "worst": worst,
    });
    format!("{value:#}\n")
}
