//! A finding with all that is known about it.

use maud::{Markup, html};

use super::text::{Message, count, number};
use crate::word::word;
use base::value::{F32Bits, Scalar};
use engine::suite::run::{Case, Finding, FindingKind, Report};
use judge::verdict::diagnosis::{Diagnosis, Divergence, Fault, Stand};
use judge::verdict::{Blame, Deviation, Value};

/// Whose fault a finding is, in a word or two.
pub(super) fn who(finding: &Finding, lane: &str) -> String {
    let blame = finding.case.as_ref().and_then(|case| case.deviation.as_ref()).map(|deviation| deviation.blame);
    match (finding.kind, blame) {
        (FindingKind::Deviation, Some(Blame::Shader)) | (FindingKind::Undefined, _) => "The shader".to_owned(),
        (FindingKind::Deviation, _) => format!("The lane {lane}"),
        (FindingKind::Guessed, _) => "A guessed range".to_owned(),
        (FindingKind::Relation, _) => "A relation".to_owned(),
        (FindingKind::Translation, _) => "A translation".to_owned(),
        (FindingKind::Coverage, _) => "Not drawn".to_owned(),
        (FindingKind::Floor, _) => "Too little judged".to_owned(),
        (FindingKind::Vacuous, _) => "Nothing tested".to_owned(),
        (FindingKind::Quality, _) => "Lane quality".to_owned(),
        (FindingKind::VacuousBound, _) => "Wide bounds".to_owned(),
        (FindingKind::Range, _) => "Range".to_owned(),
        (FindingKind::RoundedLiteral, _) => "A rounded constant".to_owned(),
        (FindingKind::Flaky, _) => format!("The lane {lane}, which is flaky"),
        (FindingKind::UnexpectedPass, _) => "An expectation".to_owned(),
    }
}

/// Whose fault the deviations of a lane are, in a few words, where they are the fault of one part.
pub(super) fn blamed(report: &Report) -> Option<String> {
    let wrong = |finding: &&Finding| matches!(finding.kind, FindingKind::Deviation | FindingKind::Undefined);
    let deviations = report.findings.iter().filter(wrong);
    let mut faults: Vec<String> = deviations.filter_map(fault).collect();
    faults.dedup();
    match &faults[..] {
        [] => None,
        [one] => Some(one.clone()),
        [_, ..] => Some("more than one".to_owned()),
    }
}

fn fault(finding: &Finding) -> Option<String> {
    let case = finding.case.as_ref()?;
    if finding.kind == FindingKind::Undefined {
        return Some("the shader".to_owned());
    }
    if case.deviation.as_ref()?.blame == Blame::Shader {
        return Some("the shader".to_owned());
    }
    Some(match &case.diagnosis.cross_check.as_ref()?.fault {
        Fault::Executor { executor, .. } => format!("executor {executor}"),
        Fault::Translator { front_end, .. } => format!("translator {front_end}"),
        Fault::Either { executor, front_end } => format!("executor {executor} or translator {front_end}"),
        Fault::Pair { executor, front_end } => format!("{executor} with {front_end}"),
        Fault::OneGroup { executor, front_end } => format!("{executor}, {front_end} or our bound"),
        Fault::Everyone { .. } => "our own meaning or bound, perhaps".to_owned(),
        Fault::Mixed { .. } => "no single part".to_owned(),
        Fault::Position { executor, .. } => format!("memory or readback of {executor}"),
        Fault::Neighbours { executor, .. } => format!("invocations of {executor} that disturb each other"),
        Fault::Unsteady { executor, front_end } => format!("chance in {executor} or {front_end}"),
        Fault::Shader => "the shader".to_owned(),
    })
}

/// How often a finding shows, where that is counted.
pub(super) fn how_many(finding: &Finding) -> Option<String> {
    let unit = match finding.kind {
        FindingKind::Coverage => ["segment", "segments"],
        FindingKind::Floor | FindingKind::Vacuous | FindingKind::VacuousBound | FindingKind::UnexpectedPass => {
            return None;
        }
        FindingKind::Deviation
        | FindingKind::Undefined
        | FindingKind::Guessed
        | FindingKind::Relation
        | FindingKind::Translation
        | FindingKind::Quality
        | FindingKind::Range
        | FindingKind::RoundedLiteral
        | FindingKind::Flaky => ["sample", "samples"],
    };
    let unit = unit[usize::from(finding.count != 1)];
    (finding.count > 0).then(|| format!("{} {unit}", count(finding.count)))
}

/// A finding, with a name of its own for what can be copied.
pub(super) fn finding(finding: &Finding, lane: &str, name: &str) -> Markup {
    html! {
        section.finding.warning[finding.kind.is_warning()] {
            h4 { (who(finding, lane)) }
            p { (Message(&finding.message)) }
            @if let Some(many) = how_many(finding) { p.quiet { (many) } }
            @if let Some(case) = &finding.case {
                (sides(case))
                (because(&case.diagnosis))
                (inputs(case))
            }
            @if let Some(command) = &finding.reproduce {
                @if let Some((_, line)) = command.split_once("--case '") {
                    (copied("Inputs as bits", &format!("{name}-inputs"), line.trim_end_matches('\'')))
                }
                (copied("Run it again", &format!("{name}-command"), command))
            }
        }
    }
}

/// Text with a button that copies it.
pub(super) fn copied(title: &str, name: &str, content: &str) -> Markup {
    html! {
        h5 { (title) }
        div.copy { code id=(name) { (content) } button type="button" data-copy=(name) { "Copy" } }
    }
}

/// A row of a table with its name in front.
fn row(name: &str, shown: &str) -> Markup {
    html! { tr { th scope="row" { (name) } td.mono { (shown) } } }
}

/// The component that deviates, on all sides.
fn sides(case: &Case) -> Markup {
    let Some((deviation, value)) = case.deviation.as_ref().and_then(|d| Some((d, d.value()?))) else {
        return Markup::default();
    };
    let Value { component, vertex, expected, meaning, actual, scalar, bound } = value;
    let allowed = if deviation.blame == Blame::Lane { format!(" ± {bound:.1e}") } else { String::new() };
    let bits = F32Bits(*actual);
    html! {
        h5 { (component) @if let Some(vertex) = vertex { " of vertex " (vertex) } }
        table {
            @if let Some(expected) = expected {
                (row(&case.against, &format!("{expected:?}")))
            }
            (row("shader means", &format!("{meaning:?}{allowed}")))
            @if *scalar == Scalar::F32 {
                (row("lane gave", &format!("{bits}   0x{actual:08x}   {}", bits.to_hex_float())))
                @if let Some(off) = off(deviation, value) { (row("off by", &off)) }
            } @else {
                (row("lane gave", &word(*actual, *scalar)))
            }
        }
    }
}

/// How far the side to blame is off.
fn off(deviation: &Deviation, value: &Value) -> Option<String> {
    let found = match deviation.blame {
        Blame::Shader => value.meaning,
        Blame::Lane => f64::from(f32::from_bits(value.actual)),
    };
    let target = deviation.target(value);
    let off = (found - target).abs();
    let ulp = off / base::value::ulp_at(target);
    let times = match deviation.blame {
        Blame::Lane if value.bound > 0.0 => format!(", {} times what is allowed", number(off / value.bound)),
        Blame::Lane | Blame::Shader => String::new(),
    };
    off.is_finite().then(|| format!("{}, {} ULP{times}", number(off), number(ulp)))
}

/// Where a deviation comes from.
fn because(diagnosis: &Diagnosis) -> Markup {
    let Diagnosis { literals, no_value, origin, divergence, written, relation: _, position: _, cross_check } =
        diagnosis;
    let reasons = literals.iter().map(ToString::to_string).chain(no_value.iter().map(ToString::to_string));
    let reasons: Vec<String> = reasons.chain(origin.iter().map(ToString::to_string)).collect();
    html! {
        @if !reasons.is_empty() {
            h5 { "Because" }
            @for reason in reasons { div { (Message(reason)) } }
        }
        @if let (Some(written), None) = (written, divergence) {
            h5 { "Written at" }
            div { (Message(written)) }
        }
        @if let Some(cross_check) = cross_check {
            h5 { "Whose fault, by all lanes" }
            p { (Message(&cross_check.fault)) }
            @for stand in Stand::ALL {
                @let lanes = cross_check.with(stand);
                @if !lanes.is_empty() { div.mono { (stand.name()) ": " (lanes.join(", ")) } }
            }
        }
        @if let Some(divergence) = divergence {
            h5 { "Where lane and shader part first" }
            table { (parting(divergence)) }
        }
    }
}

/// The rows about the first operation after which lane and shader differ.
fn parting(divergence: &Divergence) -> Markup {
    let Divergence { place, args, meaning, bound, actual, condition, path } = divergence;
    html! {
        (row("operation", &place.to_string()))
        @if *path {
            (row("lane", "goes another way here"))
        } @else {
            @if !args.is_empty() {
                (row("arguments", &args.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ")))
            }
            (row("means", &format!("{meaning:?} ± {bound:.1e}")))
            (row("lane has", &format!("{:?}", F32Bits(*actual))))
            @if condition.is_finite() { (row("condition number", &number(*condition))) }
        }
    }
}

fn inputs(case: &Case) -> Markup {
    html! {
        h5 { @if case.tried > 0 { "Smallest inputs that show it" } @else { "Inputs" } }
        table {
            @for input in &case.inputs { tr { th.mono scope="row" { (input.shown()) } td.mono { (input.values()) } } }
        }
        @if case.tried > 0 {
            p.quiet { "Shrunk in " (case.rounds) " rounds from " (case.tried) " candidates." }
        }
    }
}
