//! Texts put together from parts of files, with the way back to each part.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{SourceFile, Span};

/// A text under construction: parts copied from files, and text of our own between them.
#[derive(Clone, Debug, Default)]
pub struct Assembly {
    text: String,
    parts: Vec<Part>,
}

/// Bytes of an assembled text and where they come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Part {
    /// The bytes in the assembled text.
    span: Span,
    /// The file that they come from, or that the text of our own belongs to.
    file: SourceFile,
    /// Offset of the first byte in that file.
    at: usize,
    /// True for a copy; text of our own stands for the `len` bytes from `at` on, as a whole.
    copied: bool,
    /// Bytes that text of our own stands for.
    len: usize,
}

impl Assembly {
    /// No text.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the bytes of `span` of `file`, cut to what the file has. Parts of an assembled file lead
    /// back to where they came from at first.
    pub fn copy(&mut self, file: &SourceFile, span: Span) {
        let span = Span::new(span.start.min(file.text().len()), span.end.min(file.text().len()));
        let base = self.text.len();
        self.text.push_str(file.slice(span));
        let Some(parts) = file.parts() else {
            let to = Span::new(base, base + span.len());
            self.parts.push(Part { span: to, file: file.clone(), at: span.start, copied: true, len: 0 });
            return;
        };
        for part in parts.iter().filter(|p| p.span.start < span.end && span.start < p.span.end) {
            let (start, end) = (part.span.start.max(span.start), part.span.end.min(span.end));
            let at = if part.copied { part.at + (start - part.span.start) } else { part.at };
            let to = Span::new(base + start - span.start, base + end - span.start);
            self.parts.push(Part { span: to, file: part.file.clone(), at, copied: part.copied, len: part.len });
        }
    }

    /// Adds text that stands in no file. Whatever is said about it is said about the byte `at` of `file`.
    pub fn insert(&mut self, text: &str, file: &SourceFile, at: usize) {
        self.replace(text, file, Span::at(at));
    }

    /// Adds text that stands for a span of `file`, such as another name for the one that is there.
    pub fn replace(&mut self, text: &str, file: &SourceFile, span: Span) {
        let to = Span::new(self.text.len(), self.text.len() + text.len());
        let (file, place) = file.origin(span);
        self.text.push_str(text);
        self.parts.push(Part { span: to, file, at: place.start, copied: false, len: place.len() });
    }

    /// The text, as a file called `name` that knows where its parts come from.
    pub fn finish(self, name: impl Into<Arc<str>>) -> SourceFile {
        SourceFile::new(name, self.text).with_parts(self.parts)
    }
}

impl SourceFile {
    /// True for a text that is put together from parts of files.
    pub fn is_assembled(&self) -> bool {
        self.parts().is_some()
    }

    /// The files that an assembled text has parts of, each once, by name; none for another text.
    pub fn sources(&self) -> BTreeMap<&str, &SourceFile> {
        self.parts().into_iter().flatten().map(|part| (part.file.name(), &part.file)).collect()
    }

    /// The bytes of a file that a span of an assembled text copies; none where it has bytes of something else.
    pub fn copied(&self, span: Span) -> Option<(SourceFile, Span)> {
        let parts = self.parts()?;
        let last = parts.partition_point(|p| p.span.start <= span.start).checked_sub(1)?;
        let part = parts.get(last).filter(|p| p.copied && span.end <= p.span.end)?;
        let start = part.at + (span.start - part.span.start);
        Some((part.file.clone(), Span::new(start, start + span.len())))
    }

    /// The file and place that a span of an assembled text comes from; this file and the span itself for
    /// a text that was not assembled. A span over several parts ends with the first of them.
    pub fn origin(&self, span: Span) -> (SourceFile, Span) {
        let Some(parts) = self.parts() else { return (self.clone(), span) };
        let index = parts.partition_point(|p| p.span.start <= span.start);
        // Behind several empty parts at one offset, the last holds the offset, if any does.
        let Some(part) = index.checked_sub(1).map(|i| &parts[i]) else { return (self.clone(), span) };
        if !part.copied {
            let len = if span.is_empty() { 0 } else { part.len };
            return (part.file.clone(), Span::new(part.at, part.at + len));
        }
        let end = span.end.clamp(part.span.start, part.span.end).max(span.start.min(part.span.end));
        let back = |offset: usize| part.at + (offset.min(part.span.end) - part.span.start);
        (part.file.clone(), Span::new(back(span.start), back(end)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joined() -> SourceFile {
        let (a, b) = (SourceFile::new("a.glsl", "one\ninclude\nthree\n"), SourceFile::new("b.glsl", "x\nwanted\n"));
        let mut assembly = Assembly::new();
        assembly.copy(&a, Span::new(0, 4));
        assembly.copy(&b, Span::new(0, b.text().len()));
        assembly.copy(&a, Span::new(11, a.text().len()));
        assembly.finish("a.glsl")
    }

    #[test]
    fn places_lead_back_to_the_file_they_come_from() {
        let file = joined();
        assert_eq!(file.text(), "one\nx\nwanted\n\nthree\n");
        let place = |needle: &str| file.locate(file.text().find(needle).unwrap());
        assert_eq!(place("one"), "a.glsl:1:1");
        assert_eq!(place("anted"), "b.glsl:2:2");
        assert_eq!(place("three"), "a.glsl:3:1");
        assert_eq!(file.sources().into_keys().collect::<Vec<_>>(), ["a.glsl", "b.glsl"]);
        let at = file.text().find("wanted").unwrap();
        let (origin, span) = file.origin(Span::new(at, at + 6));
        assert_eq!((origin.name(), origin.slice(span)), ("b.glsl", "wanted"));
    }

    #[test]
    fn a_span_over_a_border_ends_with_its_first_part() {
        let file = joined();
        let start = file.text().find("wanted").unwrap();
        let (origin, span) = file.origin(Span::new(start, file.text().len()));
        assert_eq!((origin.name(), origin.slice(span)), ("b.glsl", "wanted\n"));
    }

    #[test]
    fn what_stands_for_a_name_leads_back_to_the_whole_name() {
        let file = joined();
        let mut assembly = Assembly::new();
        let at = file.text().find("wanted").unwrap();
        assembly.replace("other", &file, Span::new(at, at + 6));
        let (origin, span) = assembly.finish("c").origin(Span::new(0, 5));
        assert_eq!((origin.name(), origin.slice(span)), ("b.glsl", "wanted"));
    }

    #[test]
    fn what_is_copied_whole_is_known() {
        let file = joined();
        assert!(file.is_assembled() && !SourceFile::new("a", "b").is_assembled());
        let at = file.text().find("wanted").unwrap();
        let (origin, span) = file.copied(Span::new(at, at + 6)).unwrap();
        assert_eq!((origin.name(), origin.slice(span)), ("b.glsl", "wanted"));
        assert!(file.copied(Span::new(at, file.text().len())).is_none());
        let mut assembly = Assembly::new();
        assembly.replace("other", &file, Span::new(at, at + 6));
        assert!(assembly.finish("c").copied(Span::new(0, 5)).is_none());
    }

    #[test]
    fn assembled_parts_of_assembled_texts_lead_back_all_the_way() {
        let file = joined();
        let mut assembly = Assembly::new();
        let at = file.text().find("three").unwrap();
        assembly.insert("own ", &file, at);
        assembly.copy(&file, Span::new(2, file.text().len()));
        let twice = assembly.finish("wrapped");
        let place = |needle: &str| twice.locate(twice.text().find(needle).unwrap());
        assert_eq!(place("own"), "a.glsl:3:1");
        assert_eq!(place("anted"), "b.glsl:2:2");
        assert_eq!(place("hree"), "a.glsl:3:2");
    }
}
