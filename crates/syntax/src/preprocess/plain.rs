//! Directives in a text that is not GLSL. Hosts of WGSL put `#ifdef`, `#define` and `#include` into their shaders and
//! join them by preprocessors of their own; what these have in common is read here. What leaves it is text, since the
//! compiler that follows reads text.

use super::super::lexer::{CommentStyle, Lex, Piece, lex_with};
use super::super::sink::Sink;
use super::macros::{Spelling, Tok};
use super::{Preprocessor, errors};
use base::diagnostic::Diagnostic;
use base::text::{Assembly, SourceFile, Span};

/// Which names are replaced by what they are defined as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Replacement {
    /// Every name in the text, with arguments where the macro has parameters, as in C.
    Names,
    /// `#{NAME}` and `#NAME` alone, as naga_oil has it.
    Marked,
}

/// A directive that is none of the preprocessor's own: `#import`, for example.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Foreign {
    /// The word behind `#`.
    pub word: String,
    /// The whole directive, from `#` to its last token.
    pub span: Span,
    /// What stands behind the word.
    pub rest: Span,
}

/// A text without its directives.
#[derive(Clone, Debug)]
pub struct Plain {
    /// The text, which leads back to where each part stood.
    pub file: SourceFile,
    /// Directives of others, in the order of the text, at their places in the text as it was.
    pub directives: Vec<Foreign>,
    /// What is wrong, in the text as it was.
    pub diagnostics: Vec<Diagnostic>,
}

/// Runs the directives of a text: `#if`, `#ifdef`, `#ifndef`, `#elif` and `#else if`, `#else`, `#endif`, `#define`,
/// `#undef`, `#error`. `defines` are names with values that are given from outside; an empty value is none.
pub fn plain(file: &SourceFile, defines: &[(String, String)], replacement: Replacement) -> Plain {
    let mut sink = Sink::new(file);
    let mut preprocessor = Preprocessor::new(defines, None, &mut sink);
    preprocessor.plain = Some(State { replacement, directives: Vec::new() });
    let left = preprocessor.run(&lex_with(file.text(), CommentStyle::Wgsl));
    let text = written(&left.tokens, file);
    Plain { file: text, directives: left.directives, diagnostics: sink.finish() }
}

/// What is known about a text that is not GLSL.
pub(super) struct State {
    replacement: Replacement,
    pub(super) directives: Vec<Foreign>,
}

impl Preprocessor<'_> {
    /// True where only marked names are replaced.
    pub(super) fn marked(&self) -> bool {
        self.plain.as_ref().is_some_and(|state| state.replacement == Replacement::Marked)
    }

    /// True for a line that begins with `#{NAME}`, which is no directive.
    pub(super) fn is_substitution(&self, line: &[Piece]) -> bool {
        self.plain.is_some() && line.get(1).is_some_and(|p| p.lex == Lex::LBrace && !p.spaced)
    }

    /// The length of a line: an `#import` with braces goes on until they are closed.
    pub(super) fn plain_line(&self, rest: &[Piece], len: usize) -> usize {
        if rest[0].lex != Lex::Hash || rest.get(1).is_none_or(|p| self.slice(p) != "import") {
            return len;
        }
        let (mut depth, mut end) = (0_usize, len);
        for (at, piece) in rest.iter().enumerate() {
            match piece.lex {
                Lex::LBrace => depth += 1,
                Lex::RBrace => depth = depth.saturating_sub(1),
                _ => {}
            }
            if at + 1 >= len && depth == 0 {
                end = at + 1;
                break;
            }
        }
        // What stands on the line of the closing brace belongs to the directive too.
        end + rest[end..].iter().position(|p| p.first).unwrap_or(rest.len() - end)
    }

    /// `#else if`, `#else ifdef` and `#else ifndef` by the words that C has for them.
    pub(super) fn plain_words<'p>(
        &self,
        word: String,
        name: &'p Piece,
        rest: &'p [Piece],
    ) -> (String, &'p Piece, &'p [Piece]) {
        let second = rest.first().filter(|_| word == "else").map(|p| self.slice(p));
        match (second.as_deref(), rest) {
            (Some(second @ ("if" | "ifdef" | "ifndef")), [first, behind @ ..]) => {
                (format!("el{second}"), first, behind)
            }
            _ => (word, name, rest),
        }
    }

    /// One of the words that go on with an `#if` under a condition.
    pub(super) fn plain_elif(&mut self, word: &str, rest: &[Piece], span: Span) {
        if word == "elif" {
            return self.elif(rest, span);
        }
        let Some(top) = self.conditionals.last() else { return self.stray(word, span) };
        let (done, seen_else) = (top.done, top.seen_else);
        if seen_else {
            self.sink.error(errors::CONDITIONAL, span, format!("`#{word}` behind `#else`"), "must come before `#else`");
        }
        let [name, ..] = rest else { return self.malformed(span, &format!("`#{word}` takes one name")) };
        let value = !done && !seen_else && self.is_defined(&self.slice(name)) == (word == "elifdef");
        if let Some(top) = self.conditionals.last_mut() {
            top.active = value;
            top.done |= value;
        }
    }

    /// True for a directive that is left to others.
    pub(super) fn is_foreign(&self, word: &str) -> bool {
        self.plain.is_some() && !matches!(word, "define" | "undef" | "error" | "pragma")
    }

    pub(super) fn foreign_directive(&mut self, word: String, rest: &[Piece], span: Span) {
        let rest = Span::new(rest.first().map_or(span.end, |p| p.span.start), span.end);
        if let Some(state) = &mut self.plain {
            state.directives.push(Foreign { word, span, rest });
        }
    }

    /// Words in a condition: `true` is 1 and `false` is 0. A name without a value is an error there: counting it as 0,
    /// as C does, would choose a branch that nobody has chosen. False when there was an error.
    pub(super) fn plain_condition(&mut self, tokens: &mut [Tok]) -> bool {
        for at in 0..tokens.len() {
            if tokens[at].lex != Lex::Word {
                continue;
            }
            let value = match tokens[at].text(&self.sink.file) {
                "true" => "1",
                "false" => "0",
                name => {
                    let (name, span) = (name.to_owned(), tokens[at].span);
                    self.valueless(&name, span);
                    return false;
                }
            };
            (tokens[at].lex, tokens[at].spelling) = (Lex::Number, Spelling::Made(value.into()));
        }
        true
    }

    fn valueless(&mut self, name: &str, span: Span) {
        let diagnostic = self
            .sink
            .start(errors::VALUELESS, span, format!("`{name}` has no value"))
            .with_label("nothing defines it")
            .with_help(format!("give its value with `--define {name}=VALUE`"));
        self.sink.push(diagnostic);
    }

    /// A line of text.
    pub(super) fn plain_text(&mut self, line: &[Piece]) {
        let marked = self.marked();
        let mut at = 0;
        while let Some(piece) = line.get(at) {
            at += 1;
            if piece.lex != Lex::Hash {
                let tok = Tok::new(piece);
                // Names stay as they are: nothing is pending that could be expanded.
                if marked {
                    self.out.push(tok)
                } else {
                    self.pending.push(tok)
                }
                continue;
            }
            let near = |p: &Piece| !p.spaced;
            let (name, used) = match &line[at..] {
                [open, name, close, ..]
                    if (open.lex, name.lex, close.lex) == (Lex::LBrace, Lex::Word, Lex::RBrace) && near(open) =>
                {
                    (name, 3)
                }
                [name, ..] if name.lex == Lex::Word && near(name) && marked => (name, 1),
                _ => {
                    self.pending.push(Tok::new(piece));
                    continue;
                }
            };
            let span = piece.span.to(line[at + used - 1].span);
            at += used;
            let text = self.slice(name);
            self.flush();
            match self.macros.get(&text).filter(|found| found.params.is_none() && !found.body.is_empty()) {
                Some(found) => {
                    let body = found.body.iter().cloned();
                    let first = piece.first;
                    let made = body.enumerate().map(|(k, (lex, spelling))| Tok {
                        spelling,
                        from_macro: true,
                        first: first && k == 0,
                        ..Tok::new(&Piece { lex, span, first: false, spaced: false })
                    });
                    let made: Vec<Tok> = made.collect();
                    self.out.extend(made);
                }
                None => self.valueless(&text, span),
            }
        }
    }
}

/// The text of tokens. What stood between two of them on a line stays between them.
fn written(tokens: &[Tok], file: &SourceFile) -> SourceFile {
    let mut out = Assembly::new();
    // What may still be copied in one piece, and the last token with its last character.
    let mut copied = Span::default();
    let mut last: Option<(&Tok, char)> = None;
    for tok in tokens {
        let text = tok.text(file);
        let Some(first) = text.chars().next() else { continue };
        let gap = last.map_or(Span::at(tok.span.start), |(before, _)| Span::new(before.span.end, tok.span.start));
        let own = !tok.from_macro && last.is_none_or(|(before, _)| !before.from_macro);
        if tok.first {
            out.copy(file, copied);
            out.insert("\n", file, tok.span.start);
            let line = file.text()[..tok.span.start].rfind(['\n', '\r']).map_or(0, |at| at + 1);
            let blanks = Span::new(line, tok.span.start);
            copied = if file.slice(blanks).trim().is_empty() { blanks } else { Span::at(tok.span.start) };
        } else if !own || copied.is_empty() || gap.start > tok.span.start {
            out.copy(file, copied);
            copied = Span::at(tok.span.start);
            let same = last.is_some_and(|(before, _)| before.span == tok.span);
            let words = last.is_some_and(|(_, end)| is_word(end) && is_word(first));
            let marks = last.is_some_and(|(_, end)| !is_word(end) && !is_word(first));
            let apart = !gap.is_empty() && file.slice(gap).contains(char::is_whitespace);
            if apart || marks || (words && same) {
                out.insert(" ", file, tok.span.start);
            }
        }
        if tok.from_macro {
            out.copy(file, copied);
            copied = Span::at(tok.span.end);
            out.replace(text, file, tok.span);
        } else {
            copied.end = tok.span.end;
        }
        last = text.chars().next_back().map(|end| (tok, end));
    }
    out.copy(file, copied);
    let rest = tokens.last().map_or(0, |tok| tok.span.end.min(file.text().len()));
    out.insert("\n", file, rest);
    out.finish(file.name())
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(text: &str, defines: &[(&str, &str)], replacement: Replacement) -> Plain {
        let defines: Vec<_> = defines.iter().map(|&(n, v)| (n.to_owned(), v.to_owned())).collect();
        plain(&SourceFile::new("a.wgsl", text), &defines, replacement)
    }

    fn lines(plain: &Plain) -> Vec<&str> {
        assert!(plain.diagnostics.is_empty(), "{:?}", plain.diagnostics);
        plain.file.text().lines().map(str::trim_end).filter(|line| !line.is_empty()).collect()
    }

    #[test]
    fn branches_are_chosen_by_what_is_defined() {
        let text = "#ifdef A\na\n#else ifdef B\nb\n#else if C == 2\nc\n#else\nd\n#endif // A\ne\n";
        let chosen = |defines: &[(&str, &str)]| lines(&run(text, defines, Replacement::Marked)).join(" ");
        assert_eq!(chosen(&[("A", "")]), "a e");
        assert_eq!(chosen(&[("B", "")]), "b e");
        assert_eq!(chosen(&[("C", "2")]), "c e");
        assert_eq!(chosen(&[("C", "true")]), "d e");
    }

    #[test]
    fn a_condition_without_a_value_is_an_error_with_its_place() {
        let out = run("x\n  #if SAMPLES > 1\n#endif\n", &[], Replacement::Marked);
        let [found] = &out.diagnostics[..] else { panic!("{:?}", out.diagnostics) };
        let shown = format!("{} {}", found.code, found.file.locate(found.span.start));
        assert_eq!(shown, "E016 a.wgsl:2:7");
        assert!(found.help.as_ref().is_some_and(|help| help.contains("--define SAMPLES=VALUE")));
        assert!(run("#if defined(SAMPLES) && 1\n#endif\n", &[], Replacement::Names).diagnostics.is_empty());
    }

    #[test]
    fn marked_names_are_replaced_and_others_left() {
        let text = "array<T, #{N}u>; N #N\n#{N}\n";
        assert_eq!(lines(&run(text, &[("N", "10")], Replacement::Marked)), ["array<T, 10u>; N 10", "10"]);
        assert_eq!(run(text, &[], Replacement::Marked).diagnostics.len(), 3);
    }

    #[test]
    fn macros_are_expanded_and_their_uses_keep_their_places() {
        let text = "#define SQ(x) ((x) * (x))\n#define N -1\nlet a = SQ(b + 1) -N;\n@compute fn f() {}\n";
        let out = run(text, &[], Replacement::Names);
        assert_eq!(lines(&out), ["let a = ( (b + 1) * (b + 1) ) - -1;", "@compute fn f() {}"]);
        let at = out.file.text().find("b +").unwrap();
        assert_eq!(out.file.locate(at), "a.wgsl:3:12");
        assert_eq!(out.file.locate(out.file.text().find("fn").unwrap()), "a.wgsl:4:10");
    }

    #[test]
    fn imports_go_on_to_their_closing_brace() {
        let text = "#import a::{\n  b, // the first\n  c::{d},\n}\nfn f() {}\n#import e\n";
        let out = run(text, &[], Replacement::Marked);
        assert_eq!(lines(&out), ["fn f() {}"]);
        let rest: Vec<&str> = out.directives.iter().map(|d| &text[d.rest.range()]).collect();
        assert_eq!(rest, ["a::{\n  b, // the first\n  c::{d},\n}", "e"]);
    }

    #[test]
    fn ten_thousand_nested_conditions_end() {
        let text = "#ifdef A\n".repeat(10_000);
        let whole = format!("{text}x\n{}", "#endif\n".repeat(10_000));
        assert_eq!(lines(&run(&whole, &[("A", "")], Replacement::Marked)), ["x"]);
        assert!(!run(&text, &[], Replacement::Names).diagnostics.is_empty());
    }
}
