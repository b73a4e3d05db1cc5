//! Characters that are no part of the language, and texts in quotes, which an extension brings.

use super::super::errors;
use super::super::lexer::{Lex, Piece};
use super::Preprocessor;
use crate::diagnostic::Safety;
use crate::text::{Edit, Span};

impl Preprocessor<'_> {
    /// Where the text in quotes ends that begins with a piece of a line, and the piece behind it.
    pub(super) fn quoted(&self, line: &[Piece], first: usize) -> (Span, usize) {
        let has = |piece: &Piece, text: &str| self.sink.file.slice(piece.span).contains(text);
        let begin = &line[first];
        if self.sink.file.slice(begin.span)[1..].contains('"') {
            return (begin.span, first + 1);
        }
        let close = line[first + 1..].iter().position(|piece| piece.lex == Lex::Unknown && has(piece, "\""));
        let last = close.map_or(line.len() - 1, |k| first + 1 + k);
        (line[last].span, last + 1)
    }

    /// Tells of characters that are no part of the language.
    pub(super) fn unknown(&mut self, span: Span) {
        let text = self.sink.file.slice(span).to_owned();
        let shown: String = text.chars().take(8).collect();
        let start = self.sink.start(errors::TOKEN, span, "").with_label("not part of the language");
        let diagnostic = if text.chars().all(|c| c.is_whitespace()) {
            // Input methods for Chinese and Japanese type it; it looks like two blanks.
            let edits = vec![Edit::replace(span, " ")];
            let mut d = start.with_fix("Replace it by an ordinary blank", Safety::Safe, edits);
            d.message = "a blank that is not ASCII stands here".into();
            d.label = "looks like a blank, but is none to a compiler".into();
            d
        } else {
            let mut d = start.with_help("only comments may hold characters outside ASCII, or `@`, `$`, quotes");
            d.message = format!("`{}` is not part of GLSL", shown.escape_debug()).into();
            d
        };
        self.sink.push(diagnostic);
    }
}
