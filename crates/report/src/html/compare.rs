//! The page of a comparison: a table of the pairs, and what is known of each, with its charts.

use maud::{Markup, PreEscaped, html};

use super::Site;
use super::charts::Chart;
use super::curve::Over;
use super::page::document;
use super::text::{count, printable, slug};
use crate::compare::Summary;
use engine::InputValue;
use engine::compare::{Accuracy, Compared, Curve, OnLane, Worst};

/// Makes the page of a comparison.
///
/// # Errors
/// Why a chart cannot be encoded.
pub fn write(summary: &Summary) -> Result<Site, String> {
    let mut plots = Vec::new();
    for (number, pair) in summary.pairs.iter().enumerate() {
        for curve in &pair.curves {
            for over in Over::ALL {
                let (name, chart) = (file(pair, number, curve, over), Chart::Curve(curve, over));
                plots.push((format!("{name}.svg"), chart.svg(&name).into_bytes()));
                plots.push((format!("{name}.png"), chart.png()?));
            }
        }
    }
    let body = html! { (printable(text(summary))) };
    Ok(Site { index: document("compare", &body), plots })
}

fn file(pair: &Compared, number: usize, curve: &Curve, over: Over) -> String {
    format!("{}-{number}-{}-{}", slug(&pair.functions[0]), slug(&curve.input), over.name())
}

fn text(summary: &Summary) -> Markup {
    let known = summary.pairs.iter().filter(|pair| pair.is_known()).count();
    let unlike = summary.pairs.iter().filter(|pair| pair.unlike.0 > 0).count();
    // Most samples of such a function could mean the same or not.
    let open = summary.pairs.iter().any(|pair| pair.is_known() && pair.unlike.0 == 0 && pair.equal * 2 < pair.samples);
    let headline = match (known, unlike) {
        (0, _) => "Nothing could be compared".to_owned(),
        (1, 0) if open => "No difference was found; most samples are undetermined".to_owned(),
        (n, 0) if open => format!("No difference was found in {n} functions; for some, most samples are undetermined"),
        (1, 0) => "The function means the same in both".to_owned(),
        (n, 0) => format!("All {n} functions mean the same in both"),
        (n, unlike) => format!("{unlike} of {n} functions mean something else"),
    };
    html! {
        div.top { span { b { "shadercheck" } } }
        header.hero.fail[unlike > 0 || known == 0] {
            h1 { (headline) }
            p.quiet { "First: " code { (summary.texts[0]) } ". Second: " code { (summary.texts[1]) } "." }
        }
        h2 { "Functions" }
        (table(summary))
        @for (number, pair) in summary.pairs.iter().enumerate() { (section(pair, number)) }
        @if summary.unpaired.iter().any(|side| !side.is_empty()) { (alone(summary)) }
        footer {
            "shadercheck " (env!("CARGO_PKG_VERSION")) ", seed " (summary.seed)
            ". The charts are beside this page in " code { "plots" } "; the same for programs is in "
            code { "report.json" } "."
        }
    }
}

fn standing(pair: &Compared) -> &'static str {
    match (pair.is_known(), pair.unlike.0) {
        (_, 0) if pair.weak().is_some() => "weak",
        (false, _) => "not compared",
        (true, 0) => "equal",
        (true, _) => "unlike",
    }
}

fn table(summary: &Summary) -> Markup {
    html! {
        table {
            tr {
                th { "First" } th { "Second" } th { "Real numbers" } th { "Samples" } th { "Widest bound, first" }
                th { "Widest bound, second" } th { "Median first ÷ second" }
            }
            @for (number, pair) in summary.pairs.iter().enumerate() {
                @let accuracy = pair.accuracy.first();
                tr {
                    td.mono { a href={ "#pair-" (number) } { (pair.functions[0]) } }
                    td.mono { (pair.functions[1]) }
                    td { (standing(pair)) }
                    td { (count(pair.samples)) }
                    @for side in 0..2 { td { (widest(accuracy, side)) } }
                    td { (accuracy.and_then(|a| a.median_ratio).map_or_else(String::new, |ratio| format!("{ratio:.3}"))) }
                }
            }
        }
    }
}

fn widest(accuracy: Option<&Accuracy>, side: usize) -> String {
    let worst = accuracy.and_then(|accuracy| accuracy.widest[side].as_ref());
    worst.map_or_else(|| "none".to_owned(), |worst| format!("{:.4e} ULP", worst.ulp[side]))
}

fn section(pair: &Compared, number: usize) -> Markup {
    html! {
        section.pair id={ "pair-" (number) } {
            h3.mono { (pair.functions[0]) @if pair.functions[0] != pair.functions[1] { " = " (pair.functions[1]) } }
            p.quiet { code { (pair.at[0]) } " and " code { (pair.at[1]) } }
            @if let Some(why) = &pair.not_compared { p { b { "Not compared" } ": " (why) "." } }
            @else { (compared(pair, number)) }
        }
    }
}

fn compared(pair: &Compared, number: usize) -> Markup {
    html! {
        p {
            (count(pair.equal)) " of " (count(pair.samples)) " samples mean the same"
            @if pair.unlike.0 > 0 {
                ", " b { (count(pair.unlike.0)) " something else" } ", " (count(pair.unlike.1))
                " of them by more than a conforming device may be off"
                @if pair.unbounded > 0 { ", " (count(pair.unbounded)) " where nothing bounds that" }
            }
            @if let Some(reason) = pair.weak() { ", most are undetermined (" (reason.to_string()) ")" }
            "."
        }
        @if let Some(smallest) = &pair.smallest {
            p { (smallest.message) "." }
            h5 { "Smallest inputs that show it" }
            (inputs(&smallest.inputs))
            p.mono { (smallest.reproduce) }
        }
        @if let Some(accuracy) = pair.accuracy.first() {
            @for side in 0..2 {
                @if let Some(Worst { inputs: at, ulp }) = &accuracy.gains[side] {
                    p {
                        "The " (["first", "second"][side]) " gains most by " (accuracy.profile) ": "
                        (format!("{:.4e}", ulp[side])) " against " (format!("{:.4e}", ulp[1 - side])) " ULP, at "
                        span.mono { (at.iter().map(shown).collect::<Vec<_>>().join("; ")) } "."
                    }
                }
            }
        }
        @for lane in &pair.lanes { (on_lane(lane)) }
        @for curve in &pair.curves {
            h5 { "Over " code { (curve.input) } ": " code { (curve.output) } }
            @if curve.fixed.len() > 1 {
                p.quiet { "The others stay at " span.mono { (others(curve)) } "." }
            }
            div.curves {
                @for over in Over::ALL {
                    (PreEscaped(Chart::Curve(curve, over).svg(&file(pair, number, curve, over))))
                }
            }
            p.quiet { "Bounds by " (curve.profile) "; there is no line where nothing bounds an output." }
        }
    }
}

/// The inputs that stand still; a vector of which one component varies is among them.
fn others(curve: &Curve) -> String {
    let varies = |input: &&InputValue| input.plain_name() == curve.input;
    curve.fixed.iter().filter(|input| !varies(input)).map(shown).collect::<Vec<_>>().join("; ")
}

fn shown(input: &InputValue) -> String {
    format!("{} = {}", input.shown(), input.values())
}

fn inputs(all: &[InputValue]) -> Markup {
    html! {
        table {
            @for input in all {
                tr { th.mono scope="row" { (input.shown()) } td.mono { (input.values()) } }
            }
        }
    }
}

fn on_lane(lane: &OnLane) -> Markup {
    let says = match (&lane.not_run, &lane.farthest) {
        (Some(why), _) => format!("not run: {why}"),
        (None, None) if lane.samples == 0 => "no sample that means the same in both was run".to_owned(),
        (None, None) => format!("{} samples, all with the same bits", count(lane.samples)),
        (None, Some((far, _))) if far.is_finite() => {
            format!("{} of {} samples with the same bits; at most {far} ULP apart", lane.same, lane.samples)
        }
        (None, Some(_)) => format!("{} of {} samples with the same bits; a number and none", lane.same, lane.samples),
    };
    html! { p { b { (lane.lane) } ": " (says) "." } }
}

fn alone(summary: &Summary) -> Markup {
    html! {
        h2 { "Without a partner" }
        table {
            tr { th { "Text" } th { "Function" } th { "Why" } }
            @for (which, side) in ["first", "second"].iter().zip(&summary.unpaired) {
                @for one in side {
                    tr {
                        td { (which) }
                        td.mono { (one.function) }
                        td { (one.why.as_deref().unwrap_or("the other text has no function of this name")) }
                    }
                }
            }
        }
    }
}
