//! A shader with the places that findings are about.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::escape::Escaped;
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
pub(super) fn listing(out: &mut String, text: &str, notes: &Notes, near: Option<usize>) {
    out.push_str("<div class=\"source mono\" tabindex=\"0\" role=\"region\" aria-label=\"Source\">");
    let shown = |number: usize| near.is_none_or(|near| notes.keys().any(|noted| noted.abs_diff(number) <= near));
    for (number, line) in text.lines().enumerate().map(|(k, line)| (k + 1, line)) {
        if !shown(number) {
            if shown(number + 1) && number > 1 {
                out.push_str("<div class=\"quiet\">⋯</div>");
            }
            continue;
        }
        let here = notes.get(&number).map_or(&[][..], Vec::as_slice);
        let class = if here.is_empty() { "" } else { " class=\"hit\"" };
        let _ = write!(out, "<div{class}><span class=\"no\">{number}</span>");
        let letters: Vec<char> = line.chars().collect();
        // The first note is marked in the line; several may overlap.
        let marked = here.first().filter(|n| n.length > 0 && n.column > 0 && n.column <= letters.len());
        match marked {
            Some(Note { column, length, .. }) => {
                let (from, to) = (column - 1, (column - 1 + length).min(letters.len()));
                let part = |range: std::ops::Range<usize>| letters[range].iter().collect::<String>();
                let _ = write!(
                    out,
                    "{}<mark>{}</mark>{}",
                    Escaped(part(0..from)),
                    Escaped(part(from..to)),
                    Escaped(part(to..letters.len()))
                );
            }
            None => {
                let _ = write!(out, "{}", Escaped(line));
            }
        }
        out.push_str("</div>");
        for note in here {
            let _ = write!(out, "<div class=\"told\">{}</div>", Escaped(&note.told));
        }
    }
    out.push_str("</div>\n");
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
        let mut out = String::new();
        listing(&mut out, text, &notes, None);
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
        let mut out = String::new();
        listing(&mut out, &text, &notes, Some(2));
        let has = |k: usize| out.contains(&format!("line{k}</div>")) || out.contains(&format!("</mark>{k}</div>"));
        assert!((1..=30).all(|k| has(k) == (8..=12).contains(&k)), "{out}");
    }

    #[test]
    fn a_place_beyond_the_text_marks_nothing() {
        let mut notes = Notes::new();
        note(&mut notes, "f", &at("f:1:9"), "x", "gone");
        note(&mut notes, "f", &at("f:7:1"), "x", "gone too");
        let mut out = String::new();
        listing(&mut out, "ab\n", &notes, None);
        assert!(!out.contains("<mark>") && out.contains("gone"), "{out}");
    }
}
