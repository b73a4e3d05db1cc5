//! Characters that are no part of the language, and texts in quotes, which an extension brings.

use super::super::lexer::{Lex, Piece};
use std::borrow::Cow;

use super::super::{Extension, errors};
use super::Preprocessor;
use base::diagnostic::Safety;
use base::text::{Edit, Span};

impl Preprocessor<'_> {
    /// A line with each text in quotes as one piece, where an extension brings such texts. One that is never closed stays
    /// as it is.
    pub(super) fn with_texts<'l>(&self, line: &'l [Piece]) -> Cow<'l, [Piece]> {
        let comes = |e: &Extension| e.name == "GL_EXT_debug_printf" && e.behavior != "disable";
        if line.iter().all(|piece| piece.lex != Lex::Unknown) || !self.extensions.iter().any(comes) {
            return Cow::Borrowed(line);
        }
        let (mut out, mut rest) = (Vec::new(), line);
        while let Some((&piece, behind)) = rest.split_first() {
            let (piece, behind) = self.quoted(piece, behind).unwrap_or((piece, behind));
            out.push(piece);
            rest = behind;
        }
        Cow::Owned(out)
    }

    /// The text in quotes that begins with a piece, and what stands behind it; none where no other quote follows.
    fn quoted<'l>(&self, begin: Piece, rest: &'l [Piece]) -> Option<(Piece, &'l [Piece])> {
        let inside = self.sink.file.slice(begin.span).strip_prefix('"')?;
        let closes = |piece: &Piece| piece.lex == Lex::Unknown && self.sink.file.slice(piece.span).contains('"');
        let (end, behind) = if inside.contains('"') {
            (begin.span, rest)
        } else {
            let last = rest.iter().position(closes)?;
            (rest[last].span, &rest[last + 1..])
        };
        Some((Piece { lex: Lex::Quoted, span: begin.span.to(end), ..begin }, behind))
    }

    /// Tells of the first hole, and keeps those of directives, which decide over what is read.
    pub(super) fn holes_of(&mut self, line: &[Piece], directive: bool) {
        // What a compiler does not know behind `#pragma` it leaves alone (GLSL 4.60, 3.3).
        if directive && line.get(1).is_some_and(|p| self.sink.file.slice(p.span) == "pragma") {
            return;
        }
        let Some(hole) = line.iter().find(|p| p.lex == Lex::Hole).filter(|_| self.active()) else { return };
        if self.sink.holes.is_empty() {
            let shown: String = self.sink.file.slice(hole.span).chars().take(24).collect();
            let d =
                self.sink.start(errors::TOKEN, hole.span, format!("`{}` is not part of GLSL", shown.escape_debug()));
            self.sink.push(
                d.with_label("not part of the language")
                    .with_why("a template engine, or another preprocessor, puts something in its place"),
            );
        }
        self.sink.holes.extend(line.iter().filter(|p| p.lex == Lex::Hole).map(|p| p.span));
        let body = line.get(1).is_some_and(|p| self.sink.file.slice(p.span) == "define") && line.get(2) != Some(hole);
        if directive && !body {
            self.holes.push(hole.span);
        }
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
