//! A shader with the places that findings are about.

use std::collections::BTreeMap;

use maud::{Markup, html};

use base::text::{Location, Position};
use engine::suite::run::Finding;
use judge::verdict::diagnosis::{Origin, Place};

/// Places of a finding in the author's text: `file:line:column`, the text there, and what is wrong with it;
/// the most telling first.
pub(super) fn places(finding: &Finding) -> Vec<(Location, String, String)> {
    let Some(case) = &finding.case else { return Vec::new() };
    let diagnosis = &case.diagnosis;
    let mut all = Vec::new();
    let mut add = |place: &Place, told: String| {
        let expanded = place.expansion.as_ref().map(|name| format!("{told}, in the expansion of `{name}`"));
        all.push((place.at.clone(), place.text.clone(), expanded.unwrap_or(told)));
    };
    for literal in &diagnosis.literals {
        add(&literal.place, format!("stands for {}, off by {:.1e}", literal.stands_for, literal.off));
    }
    if let Some(no_value) = &diagnosis.no_value
        && let Some(place) = &no_value.place
    {
        add(place, "has no value for these arguments".to_owned());
    }
    if let Some(Origin::BuiltIn { op, factor, profile, place: Some(place), .. }) = &diagnosis.origin {
        add(place, format!("`{}` is {factor:.1} times what {profile} allows", op.name()));
    }
    if let Some(divergence) = &diagnosis.divergence {
        add(&divergence.place, "lane and shader part here first".to_owned());
    }
    all
}

/// Something to be told at a place of a text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Note {
    /// Column, from 1.
    pub column: usize,
    /// Characters that are meant; 0 for the whole line.
    pub length: usize,
    /// What is wrong.
    pub told: String,
}

/// Notes by line, from 1.
pub(super) type Notes = BTreeMap<usize, Vec<Note>>;

/// Adds a place, if it is of this file.
pub(super) fn note(notes: &mut Notes, file: &str, at: &Location, meant: &str, told: &str) {
    if let (true, Some(Position { line, column })) = (at.file == file, at.position) {
        let length = meant.lines().next().map_or(0, |first| first.chars().count());
        let new = Note { column, length, told: told.to_owned() };
        let here: &mut Vec<Note> = notes.entry(line).or_default();
        if !here.contains(&new) {
            here.push(new);
        }
    }
}

/// A text with its lines numbered, and notes below the lines that they are about; the whole of it, or only lines
/// so near to a note.
pub(super) fn listing(text: &str, notes: &Notes, near: Option<usize>) -> Markup {
    let shown = |number: usize| near.is_none_or(|near| notes.keys().any(|noted| noted.abs_diff(number) <= near));
    html! {
        div.source.mono tabindex="0" role="region" aria-label="Source" {
            @for (number, text) in text.lines().enumerate().map(|(k, text)| (k + 1, text)) {
                @if shown(number) {
                    @let here = notes.get(&number).map_or(&[][..], Vec::as_slice);
                    div class=[(!here.is_empty()).then_some("hit")] { span.no { (number) } (line(text, here.first())) }
                    @for note in here { div.told { (note.told) } }
                } @else if shown(number + 1) && number > 1 {
                    div.quiet { "⋯" }
                }
            }
        }
    }
}

/// A line with what its first note is about marked; several may overlap.
fn line(text: &str, note: Option<&Note>) -> Markup {
    let letters: Vec<char> = text.chars().collect();
    match note {
        Some(&Note { column, length, .. }) if length > 0 && (1..=letters.len()).contains(&column) => {
            let (from, to) = (column - 1, (column - 1 + length).min(letters.len()));
            let part = |range: std::ops::Range<usize>| letters[range].iter().collect::<String>();
            html! { (part(0..from)) mark { (part(from..to)) } (part(to..letters.len())) }
        }
        Some(_) | None => html! { (text) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> Location {
        text.into()
    }

    #[test]
    fn the_place_is_marked_by_characters_and_everything_is_escaped() {
        let text = "// 球 <script>\nfloat x = 3.14;\n";
        let mut notes = Notes::new();
        note(&mut notes, "a:b.vert", &at("a:b.vert:2:11"), "3.14", "too few <digits>");
        note(&mut notes, "a:b.vert", &at("a:b.vert:2:11"), "3.14", "too few <digits>");
        note(&mut notes, "a:b.vert", &at("other.vert:1:1"), "", "not here");
        let out = listing(text, &notes, None).into_string();
        assert!(out.contains("float x = <mark>3.14</mark>;"), "{out}");
        assert!(out.contains("球 &lt;script&gt;"), "{out}");
        assert_eq!(out.matches("too few &lt;digits&gt;").count(), 1, "{out}");
        assert!(!out.contains("not here"));
    }

    #[test]
    fn an_excerpt_has_the_lines_near_a_note() {
        let text: String = (1..=30).map(|k| format!("line{k}\n")).collect();
        let mut notes = Notes::new();
        note(&mut notes, "f", &at("f:10:1"), "line", "here");
        let out = listing(&text, &notes, Some(2)).into_string();
        let has = |k: usize| out.contains(&format!("line{k}</div>")) || out.contains(&format!("</mark>{k}</div>"));
        assert!((1..=30).all(|k| has(k) == (8..=12).contains(&k)), "{out}");
    }

    #[test]
    fn a_place_beyond_the_text_marks_nothing() {
        let mut notes = Notes::new();
        note(&mut notes, "f", &at("f:1:9"), "x", "gone");
        note(&mut notes, "f", &at("f:7:1"), "x", "gone too");
        let out = listing("ab\n", &notes, None).into_string();
        assert!(!out.contains("<mark>") && out.contains("gone"), "{out}");
    }
}
