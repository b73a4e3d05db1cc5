//! Places as the protocol counts them: lines from 0, and columns in units of the encoding that was agreed on.

use base::text::{Position as TextPosition, SourceFile, Span};
use ls_types::{Position, PositionEncodingKind, Range};

/// In which units columns are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Bytes.
    Utf8,
    /// Units of UTF-16: what every client knows.
    #[default]
    Utf16,
    /// Characters.
    Utf32,
}

impl Encoding {
    /// The first of the client's encodings that is known here, UTF-8 before all others: nothing has to be counted then.
    pub fn agreed(offered: &[PositionEncodingKind]) -> Self {
        let offers = |kind: &PositionEncodingKind| offered.contains(kind);
        if offers(&PositionEncodingKind::UTF8) {
            Self::Utf8
        } else if !offers(&PositionEncodingKind::UTF16) && offers(&PositionEncodingKind::UTF32) {
            Self::Utf32
        } else {
            Self::Utf16
        }
    }

    /// Its name in the protocol.
    pub fn kind(self) -> PositionEncodingKind {
        match self {
            Self::Utf8 => PositionEncodingKind::UTF8,
            Self::Utf16 => PositionEncodingKind::UTF16,
            Self::Utf32 => PositionEncodingKind::UTF32,
        }
    }

    fn width(self, c: char) -> usize {
        match self {
            Self::Utf8 => c.len_utf8(),
            Self::Utf16 => c.len_utf16(),
            Self::Utf32 => 1,
        }
    }

    /// The place of a byte offset.
    pub fn position(self, file: &SourceFile, offset: usize) -> Position {
        let place = file.position(offset);
        let before = file.line_text(place.line).chars().take(place.column - 1);
        let column: usize = before.map(|c| self.width(c)).sum();
        Position::new(number(place.line - 1), number(column))
    }

    /// The byte offset of a place; the end of the line for a column past it, and of the text for a line past it.
    pub fn offset(self, file: &SourceFile, position: Position) -> usize {
        let line = position.line as usize + 1;
        let start = file.offset(TextPosition { line, column: 1 });
        let mut left = position.character as usize;
        let mut at = start;
        for c in file.line_text(line).chars() {
            let width = self.width(c);
            if left < width {
                break;
            }
            left -= width;
            at += c.len_utf8();
        }
        at
    }

    /// A span as a range.
    pub fn range(self, file: &SourceFile, span: Span) -> Range {
        Range::new(self.position(file, span.start), self.position(file, span.end))
    }

    /// A range as a span.
    pub fn span(self, file: &SourceFile, range: Range) -> Span {
        Span::new(self.offset(file, range.start), self.offset(file, range.end))
    }

    /// Length of a text.
    pub fn length(self, text: &str) -> u32 {
        number(text.chars().map(|c| self.width(c)).sum())
    }
}

/// Numbers of the protocol end at 2³¹ − 1.
fn number(value: usize) -> u32 {
    u32::try_from(value).unwrap_or(i32::MAX.unsigned_abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_counts_its_own_units_both_ways() {
        let file = SourceFile::new("a", "// é 𝒗 頂\r\nfloat x;\rint y;\n");
        let at = file.text().find('頂').unwrap();
        for (encoding, column) in [(Encoding::Utf8, 11), (Encoding::Utf16, 8), (Encoding::Utf32, 7)] {
            let position = encoding.position(&file, at);
            assert_eq!(position, Position::new(0, column), "{encoding:?}");
            assert_eq!(encoding.offset(&file, position), at, "{encoding:?}");
            let y = file.text().find('y').unwrap();
            assert_eq!(encoding.position(&file, y), Position::new(2, 4));
            assert_eq!(encoding.offset(&file, Position::new(2, 4)), y);
            assert_eq!(encoding.offset(&file, Position::new(0, 999)), file.text().find('\r').unwrap());
            assert_eq!(encoding.offset(&file, Position::new(999, 0)), file.text().len());
        }
        // Half of a character is its start.
        assert_eq!(Encoding::Utf16.offset(&file, Position::new(0, 6)), file.text().find('𝒗').unwrap());
    }

    #[test]
    fn utf8_is_taken_where_it_is_offered() {
        let kinds = [PositionEncodingKind::UTF16, PositionEncodingKind::UTF8];
        assert_eq!(Encoding::agreed(&kinds), Encoding::Utf8);
        assert_eq!(Encoding::agreed(&[]), Encoding::Utf16);
        assert_eq!(Encoding::agreed(&[PositionEncodingKind::UTF32]), Encoding::Utf32);
    }
}
