//! How many tokens are read. What is made of each takes some hundred bytes, so that a text of a few megabytes could take
//! the memory of the machine.

use super::super::lexer::Piece;
use super::super::sink::Sink;
use super::{errors, macros};
use base::text::Span;

/// Tokens of a text, at most.
pub(crate) const MOST_PIECES: usize = 1 << 20;

/// The tokens of a text, as far as they are read.
pub(super) fn within<'p>(pieces: &'p [Piece], sink: &mut Sink) -> &'p [Piece] {
    let Some(beyond) = pieces.get(MOST_PIECES) else { return pieces };
    let diagnostic = sink
        .start(errors::TOO_DEEP, beyond.span, format!("the text has more than {MOST_PIECES} tokens"))
        .with_label("from here on nothing is read")
        .with_why("what a shader takes in memory grows with its tokens")
        .with_help("take tables of numbers from a buffer or a texture, or split the text");
    sink.push(diagnostic);
    &pieces[..MOST_PIECES]
}

/// Reports macros that are each small enough, and too much together. `end` is the last token before them.
pub(super) fn expanded(tokens: usize, end: Option<Span>, sink: &mut Sink) {
    if let Some(span) = end.filter(|_| tokens > macros::MOST_TOKENS) {
        let message = format!("the macros of the text expand to more than {} tokens", macros::MOST_TOKENS);
        sink.error(errors::TOO_DEEP, span, message, "up to here");
    }
}

#[cfg(test)]
mod tests {
    use crate::{Shader, Stage};
    use base::text::SourceFile;

    fn codes(text: String) -> Vec<String> {
        let parsed = Shader::parse(&SourceFile::new("a.frag", text), Stage::Fragment);
        parsed.diagnostics.iter().map(|d| d.code.to_string()).collect()
    }

    #[test]
    fn a_text_of_too_many_tokens_is_reported_and_one_of_many_is_read() {
        let text = |count: usize| format!("#version 330 core\nvoid main() {{{}}}\n", ";".repeat(count));
        assert_eq!(codes(text(10_000)), Vec::<String>::new());
        assert_eq!(codes(text(1 << 20)), ["E004"]);
    }

    #[test]
    fn macros_that_are_too_much_together_are_reported() {
        let doubling: String = (1..20).map(|k| format!("#define A{k} A{0} A{0}\n", k - 1)).collect();
        let text = |count: usize| {
            format!("#version 330 core\n#define A0 ;\n{doubling}void main() {{{}}}\n", "A19\n#line 1\n".repeat(count))
        };
        assert_eq!(codes(text(5)), ["E004"]);
    }
}
