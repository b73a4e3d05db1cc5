//! A source file in memory and positions in it.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use thiserror::Error;

use super::Location;
use super::assembly::Part;
use super::expansion::Expansion;

/// A half-open range of bytes, `start..end`, in a [`SourceFile`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Span {
    /// Offset of the first byte.
    pub start: usize,
    /// Offset after the last byte.
    pub end: usize,
}

impl Span {
    /// The span `start..end`. An end before the start is moved to the start.
    pub fn new(start: usize, end: usize) -> Self {
        Self { start, end: end.max(start) }
    }

    /// The empty span at `offset`.
    pub fn at(offset: usize) -> Self {
        Self { start: offset, end: offset }
    }

    /// The smallest span that holds both.
    pub fn to(self, other: Self) -> Self {
        Self { start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// True when the span holds no byte.
    pub fn is_empty(self) -> bool {
        self.start == self.end
    }

    /// Length in bytes.
    pub fn len(self) -> usize {
        self.end - self.start
    }

    /// True when `offset` lies inside.
    pub fn contains(self, offset: usize) -> bool {
        self.start <= offset && offset < self.end
    }

    /// True when the two have a byte in common, or one is empty and lies in or at the edge of the other.
    pub fn touches(self, other: Self) -> bool {
        self.start < other.end && other.start < self.end
            || (self.is_empty() || other.is_empty()) && self.start <= other.end && other.start <= self.end
    }

    /// The span as a range, for slicing.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start..self.end
    }
}

/// A place in a text as people name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Position {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters (Unicode scalar values, not bytes), counted from 1.
    pub column: usize,
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// Why bytes are not a source text.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum TextError {
    /// The bytes are not UTF-8 from this place on.
    #[error(
        "{name}:{position}: not UTF-8 (byte 0x{byte:02x}); convert it first, for example with `iconv -f SHIFT_JIS -t UTF-8`"
    )]
    NotUtf8 {
        /// Name of the file.
        name: String,
        /// Place of the first byte that is not UTF-8.
        position: Position,
        /// The byte at that place, shown in hexadecimal.
        byte: u8,
    },
    /// The bytes fit no encoding that is read.
    #[error(
        "{name}:{position}: neither UTF-8 nor Shift_JIS, EUC-JP or UTF-16 with a byte-order mark (byte 0x{byte:02x}); convert the file to UTF-8 first, for example with `iconv -f LATIN1 -t UTF-8`"
    )]
    NoEncoding {
        /// Name of the file.
        name: String,
        /// Place of the first byte that is not UTF-8, or not UTF-16.
        position: Position,
        /// The byte at that place, shown in hexadecimal.
        byte: u8,
    },
}

/// A text with a name and its line starts. Cheap to clone.
#[derive(Clone)]
pub struct SourceFile {
    name: Arc<str>,
    text: Arc<str>,
    line_starts: Arc<[usize]>,
    /// Where an assembled text comes from.
    parts: Option<Arc<[Part]>>,
    /// Where macros are expanded, in the order of the text.
    pub(super) expansions: Option<Arc<[Expansion]>>,
}

/// Where macros are expanded follows from a text.
impl PartialEq for SourceFile {
    fn eq(&self, other: &Self) -> bool {
        (&self.name, &self.text, &self.parts) == (&other.name, &other.text, &other.parts)
    }
}

impl Eq for SourceFile {}

impl fmt::Debug for SourceFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SourceFile({}, {} bytes)", self.name, self.text.len())
    }
}

/// A text with its control characters as escapes, such as `\n` and `\u{1b}`.
pub fn printable(text: &str) -> String {
    let shown = |c: char| if c.is_control() { c.escape_default().collect() } else { String::from(c) };
    text.chars().map(shown).collect()
}

/// Paths as messages show them: with control characters as escapes.
pub trait Shown {
    /// The path in a line of text.
    fn shown(&self) -> String;
}

impl Shown for Path {
    fn shown(&self) -> String {
        printable(&self.display().to_string())
    }
}

impl SourceFile {
    /// A file called `name` (shown in messages) that holds `text`. Control characters of the name are escaped: a line
    /// break in it would begin a line of a report, which readers of logs take for a command.
    pub fn new(name: impl Into<Arc<str>>, text: impl Into<Arc<str>>) -> Self {
        let name: Arc<str> = name.into();
        let name = if name.contains(char::is_control) { printable(&name).into() } else { name };
        let text: Arc<str> = text.into();
        let bytes = text.as_bytes();
        let mut starts = vec![0];
        for (i, &b) in bytes.iter().enumerate() {
            // A line ends at LF, CR LF, or a CR alone.
            if b == b'\n' || (b == b'\r' && bytes.get(i + 1) != Some(&b'\n')) {
                starts.push(i + 1);
            }
        }
        Self { name, text, line_starts: starts.into(), parts: None, expansions: None }
    }

    pub(super) fn with_parts(self, parts: Vec<Part>) -> Self {
        Self { parts: Some(parts.into()), ..self }
    }

    pub(super) fn parts(&self) -> Option<&[Part]> {
        self.parts.as_deref()
    }

    /// Reads bytes as UTF-8.
    ///
    /// # Errors
    /// [`TextError::NotUtf8`] with the place of the first wrong byte.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, TextError> {
        match std::str::from_utf8(bytes) {
            Ok(text) => Ok(Self::new(name, text)),
            Err(error) => {
                let good = std::str::from_utf8(&bytes[..error.valid_up_to()]).unwrap_or_default();
                let before = Self::new(name, good);
                Err(TextError::NotUtf8 {
                    name: before.name().to_owned(),
                    position: before.position(good.len()),
                    byte: bytes[error.valid_up_to()],
                })
            }
        }
    }

    /// The name shown in messages, as the user gave it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text of a span; empty when the span does not lie on character borders inside the text.
    pub fn slice(&self, span: Span) -> &str {
        self.text.get(span.range()).unwrap_or("")
    }

    /// Line and column of a byte offset. An offset inside a character counts as that character;
    /// one past the end counts as the end.
    pub fn position(&self, offset: usize) -> Position {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.line_starts.partition_point(|&start| start <= offset) - 1;
        let start = self.line_starts[line];
        Position { line: line + 1, column: self.text[start..offset].chars().count() + 1 }
    }

    /// Byte offset of a position; the end of the line for a column past it.
    pub fn offset(&self, position: Position) -> usize {
        let Some(line) = position.line.checked_sub(1) else { return 0 };
        let Some(&start) = self.line_starts.get(line) else { return self.text.len() };
        let text = self.line_text(position.line);
        text.char_indices().nth(position.column.saturating_sub(1)).map_or(start + text.len(), |(i, _)| start + i)
    }

    /// Number of lines; a text that ends with a line break has an empty last line.
    pub fn line_count(&self) -> usize {
        self.line_starts.len()
    }

    /// A line without its line break; empty when there is no such line. Lines count from 1.
    pub fn line_text(&self, line: usize) -> &str {
        let Some(&start) = line.checked_sub(1).and_then(|l| self.line_starts.get(l)) else {
            return "";
        };
        let end = self.line_starts.get(line).copied().unwrap_or(self.text.len());
        self.text[start..end].trim_end_matches(['\n', '\r'])
    }

    /// The line in which a byte offset lies; in an assembled text, of the file that it comes from.
    pub fn line_at(&self, offset: usize) -> String {
        let (file, span) = self.origin(Span::at(offset));
        file.line_text(file.position(span.start).line).to_owned()
    }

    /// `name:line:column` of a byte offset; in an assembled text, of the file that it comes from.
    pub fn locate(&self, offset: usize) -> String {
        self.location(offset).to_string()
    }

    /// Where a byte offset stands: in this file, or in the one that it was included from.
    pub fn location(&self, offset: usize) -> Location {
        let (file, span) = self.origin(Span::at(offset));
        Location { file: file.name().to_owned(), position: Some(file.position(span.start)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_not_bytes() {
        let file = SourceFile::new("a.vert", "float x; // 球の頂点\nint y;");
        let offset = file.text().find("頂点").unwrap();
        assert_eq!(file.position(offset), Position { line: 1, column: 15 });
        assert_eq!(file.offset(Position { line: 1, column: 15 }), offset);
        assert_eq!(file.position(file.text().len()), Position { line: 2, column: 7 });
    }

    #[test]
    fn all_three_line_breaks_count() {
        let file = SourceFile::new("a", "a\r\nb\rc\nd");
        assert_eq!(file.line_count(), 4);
        assert_eq!((1..=4).map(|l| file.line_text(l)).collect::<Vec<_>>(), ["a", "b", "c", "d"]);
    }

    #[test]
    fn bytes_that_are_not_utf8_are_refused_with_their_place() {
        let error = SourceFile::from_bytes("s.vert", b"in vec4 p; // \x8b\x85\n").unwrap_err();
        let TextError::NotUtf8 { position, byte, .. } = &error else { panic!("{error}") };
        assert_eq!((*position, *byte), (Position { line: 1, column: 15 }, 0x8b));
        assert!(error.to_string().starts_with("s.vert:1:15: not UTF-8"));
    }
}
