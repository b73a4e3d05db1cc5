//! A finding for people: what is wrong, where, with which inputs, by how much, and whose fault it is.

use std::fmt::Write as _;

use super::text::Style;
use crate::word::word;
use base::value::{F32Bits, Scalar};
use engine::suite::run::{Case, Finding};
use judge::verdict::diagnosis::{CrossCheck, Diagnosis, Place, Stand};
use judge::verdict::{Blame, Deviation, MEANING, Value};

/// Characters of a line after its label.
const WIDE: usize = 87;
/// Inputs that are shown.
const INPUTS: usize = 10;
/// Inputs of a case whose bits are shown as well.
const WITH_BITS: usize = 3;

/// Words of an input that are shown; a longer one is cut in the middle, the command has it whole.
const SHOWN: usize = 16;

/// One finding with all that is known about it.
#[cfg(feature = "run")]
pub(super) fn block(on: &str, shader: &str, finding: &Finding) -> String {
    let mut text = String::new();
    one(&mut text, on, shader, finding, false, false);
    text
}

/// One finding. Its inputs and the command are left out when an earlier finding has `reported` them.
pub(super) fn one(text: &mut String, on: &str, shader: &str, finding: &Finding, reported: bool, color: bool) {
    let style = Style::new(color);
    let _ = writeln!(text, "\n{}{on}: {}{}", style.bold, finding.message, style.off);
    let _ = writeln!(text, "  file       {shader}");
    if let Some((label, place)) = finding.case.as_ref().and_then(|case| at(&case.diagnosis)) {
        excerpt(text, label, place);
    }
    if finding.count > 0 {
        let _ = writeln!(text, "  samples    {}", finding.count);
    }
    if let Some(case) = &finding.case {
        case_text(text, case, reported);
    }
    if let Some(command) = finding.reproduce.as_ref().filter(|_| !reported) {
        let _ = writeln!(text, "  reproduce  {command}");
    }
}

fn case_text(text: &mut String, case: &Case, reported: bool) {
    // A case that was asked for is shown as it is.
    let mut label = if case.tried > 0 { "smallest" } else { "case" };
    if reported {
        let _ = writeln!(text, "  {label:<9}  as above");
    }
    let shown = if reported { 0 } else { INPUTS };
    for input in case.inputs.iter().take(shown) {
        let (name, bits, decimal) = (input.shown(), &input.bits, &input.decimal);
        if input.is_identity() {
            let _ = writeln!(text, "  {label:<9}  {name} = identity");
            label = "";
            continue;
        }
        let shown = bits.len().min(SHOWN);
        if let Some(few) = input.few() {
            let _ = writeln!(text, "  {label:<9}  {name}: {few}");
            label = "";
            continue;
        }
        let more = if bits.len() > shown { format!(", … {} more", bits.len() - shown) } else { String::new() };
        let hex: Vec<String> = bits[..shown].iter().map(|b| format!("{b:08x}")).collect();
        let _ = writeln!(text, "  {label:<9}  {name} = {}{more}", decimal[..shown].join(", "));
        // The decimal number is exact, and the command has the bits.
        if case.inputs.len() <= WITH_BITS {
            let _ = writeln!(text, "             bits {}{more}", hex.join(" "));
        }
        label = "";
    }
    if case.inputs.len() > INPUTS && !reported {
        let _ = writeln!(text, "             … {} more inputs; the command has them", case.inputs.len() - INPUTS);
    }
    if let Some((deviation, value)) = case.deviation.as_ref().and_then(|d| Some((d, d.value()?)))
        && value.scalar == Scalar::F32
    {
        sides(text, &case.against, deviation, value);
    }
    origins(text, &case.diagnosis);
    if let Some(deviation) = &case.deviation {
        fault(text, &case.against, deviation, &case.diagnosis);
    } else if let Some(cross_check) = &case.diagnosis.cross_check {
        collected(text, cross_check);
    }
    if case.tried > 0 && !reported {
        let _ = writeln!(text, "  shrunk     in {} rounds from {} candidates", case.rounds, case.tried);
    }
}

/// Where a deviation shows first in the author's text, and a word for it: where it comes from, or else where the
/// wrong output gets its value.
fn at(diagnosis: &Diagnosis) -> Option<(&'static str, &Place)> {
    let known = place(diagnosis).map(|place| ("at", place));
    known.or_else(|| diagnosis.written.as_ref().map(|place| ("computed", place)))
}

/// The line of a place with a mark below what stands there.
fn excerpt(text: &mut String, label: &str, place: &Place) {
    let Place { at, text: marked, line, expansion } = place;
    let expanded = expansion.as_ref().map_or_else(String::new, |name| format!(", in the expansion of `{name}`"));
    let _ = writeln!(text, "  {label:<9}  {at}{expanded}");
    let column = at.position.map(|position| position.column);
    let Some(column) = column.filter(|column| (1..=line.chars().count()).contains(column)) else { return };
    // A long line is cut before and after the mark.
    let begin = if column > WIDE { column - WIDE / 2 } else { 1 };
    let shown: String = line.chars().skip(begin - 1).take(WIDE).map(visible).collect();
    let before = column - begin;
    let marked = marked.lines().next().unwrap_or_default().chars().count();
    let marks = marked.clamp(1, shown.chars().count().saturating_sub(before).max(1));
    // Blanks that all lines have are of no use.
    let blank = shown.chars().take(before).take_while(|c| *c == ' ').count();
    let shown: String = shown.chars().skip(blank).collect();
    let _ = writeln!(text, "           | {shown}");
    let _ = writeln!(text, "           | {}{}", " ".repeat(before - blank), "^".repeat(marks));
}

/// A character of a line that takes one column, and does nothing else to a terminal.
fn visible(c: char) -> char {
    match c {
        '\t' => ' ',
        c if c.is_control() => '\u{fffd}',
        c => c,
    }
}

/// Whose fault a deviation is, and what the lanes of the run say of it.
fn fault(text: &mut String, against: &str, deviation: &Deviation, diagnosis: &Diagnosis) {
    match (deviation.blame, &diagnosis.cross_check) {
        (Blame::Shader, _) if against == MEANING => {
            labelled(text, "fault", "the shader: it would be so on any device");
        }
        (Blame::Shader, _) => {
            let said = format!("the shader: its own meaning is not what its {against} says");
            labelled(text, "fault", &said);
        }
        (Blame::Lane, Some(cross_check)) => {
            collected(text, cross_check);
        }
        (Blame::Lane, None) => {}
    }
}

/// Whose fault it is as the lanes of the run show it, and what each of them says.
fn collected(text: &mut String, cross_check: &CrossCheck) {
    labelled(text, "fault", &cross_check.fault.to_string());
    let said = Stand::ALL.map(|stand| (stand, cross_check.with(stand)));
    let said = said.iter().filter(|(_, lanes)| !lanes.is_empty());
    let said: Vec<String> = said.map(|(stand, lanes)| format!("{}: {}", stand.name(), lanes.join(", "))).collect();
    if !said.is_empty() {
        labelled(text, "witnesses", &said.join("; "));
    }
}

/// A text behind a label, broken at blanks.
fn labelled(text: &mut String, label: &str, said: &str) {
    let mut label = label;
    let mut line = String::new();
    for word in said.split(' ') {
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > WIDE {
            let _ = writeln!(text, "  {label:<9}  {line}");
            (label, line) = ("", String::new());
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    let _ = writeln!(text, "  {label:<9}  {line}");
}

/// Where a deviation comes from.
fn origins(text: &mut String, diagnosis: &Diagnosis) {
    let Diagnosis { literals, no_value, origin, divergence, .. } = diagnosis;
    for literal in literals {
        let _ = writeln!(text, "  because    {literal}");
    }
    if let Some(no_value) = no_value {
        let _ = writeln!(text, "  because    {no_value}");
    }
    if let Some(origin) = origin {
        let _ = writeln!(text, "  because    {origin}");
    }
    if let Some(divergence) = divergence {
        let _ = writeln!(text, "  first at   {divergence}");
    }
}

/// A component on all sides.
fn sides(text: &mut String, against: &str, deviation: &Deviation, value: &Value) {
    let Value { component, expected, meaning, actual, scalar, bound, .. } = value;
    if let Some(expected) = expected {
        let _ = writeln!(text, "  {against:<9}  {component} = {expected:?}");
    }
    let allowed = if deviation.blame == Blame::Lane { format!(" ± {bound:.1e}") } else { String::new() };
    let _ = writeln!(text, "  shader     {component} = {meaning:?}{allowed}");
    let bits = F32Bits(*actual);
    if *scalar != Scalar::F32 {
        // Integers are right or wrong: how far they are off in ULP of binary32 says nothing.
        let _ = writeln!(text, "  lane       {component} = {}", word(*actual, *scalar));
        return;
    }
    let _ = writeln!(text, "  lane       {component} = {bits} (0x{actual:08x}, {})", bits.to_hex_float());
    let found = match deviation.blame {
        Blame::Shader => *meaning,
        Blame::Lane => f64::from(bits.to_f32()),
    };
    let off = (found - deviation.target(value)).abs();
    // The distance of a NaN is NaN, and that of an expected 0 in ULP is astronomical.
    if off.is_finite() {
        let ulp = off / base::value::ulp_at(deviation.target(value));
        let ulp = if ulp < 1e9 { format!("{ulp:.1}") } else { format!("{ulp:.1e}") };
        let times = match deviation.blame {
            Blame::Lane if *bound > 0.0 => format!("{:.1} times what is allowed, ", off / bound),
            Blame::Lane | Blame::Shader => String::new(),
        };
        let _ = writeln!(text, "  off by     {off:.3e}: {times}{ulp} ULP");
    }
}

/// Where a deviation shows first in the author's text.
pub(super) fn place(diagnosis: &Diagnosis) -> Option<&Place> {
    let literal = diagnosis.literals.first().map(|literal| &literal.place);
    let no_value = diagnosis.no_value.as_ref().and_then(|no_value| no_value.place.as_ref());
    let divergence = diagnosis.divergence.as_ref().map(|divergence| &divergence.place);
    literal.or(no_value).or(divergence)
}

#[cfg(test)]
mod tests {
    use super::Place;

    fn marked(at: &str, marked: &str, line: &str) -> String {
        let mut text = String::new();
        let place = Place { at: at.into(), text: marked.into(), line: line.into(), expansion: None };
        super::excerpt(&mut text, "at", &place);
        text
    }

    #[test]
    fn a_place_is_shown_with_a_mark_below_it() {
        assert_eq!(
            marked("a.vert:3:11", "sin(x)", "    f = a + sin(x);"),
            "  at         a.vert:3:11\n           | f = a + sin(x);\n           |       ^^^^^^\n"
        );
        assert_eq!(marked("a.vert", "", ""), "  at         a.vert\n");
        // What goes on in the next line is marked to the end of its own.
        let two = marked("a.vert:1:5", "sin(\n  x)", "x = sin(");
        assert!(two.ends_with("| x = sin(\n           |     ^^^^\n"), "{two}");
        let long = marked("a.vert:1:301", "y", &format!("{}y{}", "x".repeat(300), "z".repeat(300)));
        assert!(long.lines().all(|line| line.chars().count() <= 102), "{long}");
        let (shown, mark) = (long.lines().nth(1).unwrap(), long.lines().nth(2).unwrap());
        assert_eq!(shown.chars().nth(mark.find('^').unwrap()), Some('y'));
        // Without a place in the line there is no mark.
        assert_eq!(marked("a.vert:1:9", "y", "short").lines().count(), 1);
    }

    #[test]
    fn long_texts_are_broken_at_blanks() {
        let mut text = String::new();
        super::labelled(&mut text, "fault", &"word ".repeat(40));
        assert!(text.lines().count() == 3 && text.lines().all(|line| line.len() <= 100), "{text}");
        assert!(text.starts_with("  fault      word word") && text.contains("\n             word"), "{text}");
    }
}
