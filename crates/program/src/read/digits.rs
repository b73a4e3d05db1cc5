//! The digits that an author wrote, for texts of which there is no syntax tree.
//!
//! A compiler of HLSL or Slang writes numbers of binary32, and folds constant expressions before. Both are found in the
//! tokens of the text: numbers, and expressions of nothing but numbers and names of constants, which are those of GLSL.
//! They become declarations of a text of our own, whose constants then lead back to the author's places.

use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

use base::text::{Assembly, SourceFile, Span};
use syntax::wgsl::tokens;
use syntax::{Shader, Stage, Token, TokenKind};

use crate::Constants;

/// Constants of a text in a language like C.
pub(super) fn constants(file: &SourceFile) -> Constants {
    // Places are those of this text, wherever it was put together from.
    let file = &SourceFile::new(file.name(), file.text());
    let tokens = tokens(file.text());
    let mut digits = Digits { file, tokens: &tokens, names: HashSet::new(), out: Assembly::new(), count: 0 };
    // The dialect with the most implicit conversions is nearest to HLSL.
    digits.out.insert("#version 460\n", file, 0);
    digits.declared();
    digits.expressions();
    let own = digits.out.finish(file.name());
    let shader = Shader::parse(&own, Stage::Library).shader;
    let place = |offset: usize| own.copied(Span::new(offset, offset + 1)).map(|(_, span)| span);
    Constants::new(Arc::new(shader)).moved(&|span| {
        let ends = [place(span.start), span.end.checked_sub(1).and_then(place)];
        let [Some(first), Some(last)] = ends else { return Span::default() };
        first.to(last)
    })
}

struct Digits<'a> {
    file: &'a SourceFile,
    tokens: &'a [Token],
    /// Names of constants.
    names: HashSet<&'a str>,
    out: Assembly,
    count: usize,
}

impl<'a> Digits<'a> {
    fn word(&self, at: usize) -> &'a str {
        self.tokens.get(at).map_or("", |token| &self.file.text()[token.span.range()])
    }

    fn is_number(&self, at: usize) -> bool {
        self.tokens.get(at).is_some_and(|token| token.kind == TokenKind::Number)
    }

    /// True where a token begins another line than the one before it.
    fn begins_line(&self, at: usize) -> bool {
        let (Some(token), Some(before)) = (self.tokens.get(at), at.checked_sub(1).and_then(|k| self.tokens.get(k)))
        else {
            return true;
        };
        self.file.text()[before.span.end..token.span.start].contains('\n')
    }

    /// `const float NAME = …;` and `#define NAME …`.
    fn declared(&mut self) {
        for at in 0..self.tokens.len() {
            let (name, from, end) = match (self.word(at), self.word(at + 1)) {
                ("#", "define") => {
                    let end = (at + 3..).find(|&k| self.begins_line(k)).unwrap_or(self.tokens.len());
                    (at + 2, at + 3, end)
                }
                ("const", "float" | "double" | "half") if self.word(at + 3) == "=" => {
                    let end = (at + 4..self.tokens.len()).find(|&k| matches!(self.word(k), ";" | ",")).unwrap_or(at);
                    (at + 2, at + 4, end)
                }
                _ => continue,
            };
            if from >= end || self.is_number(name) || self.end_of(from) != end || !self.is_valued(from..end) {
                continue;
            }
            let own = self.word(name);
            // Which of two definitions holds is the preprocessor's to know.
            if self.names.insert(own) {
                self.write(&format!("const float {own} = "), from..end);
            }
        }
    }

    /// All numbers, and what a compiler may fold of them.
    fn expressions(&mut self) {
        let mut at = 0;
        while at < self.tokens.len() {
            if self.is_number(at) {
                self.write_numbered(at..at + 1);
            }
            let before = at.checked_sub(1).map_or(";", |k| self.word(k));
            let starts = matches!(before, "(" | "," | "=" | ";" | "{" | "[" | "?" | ":" | "return" | "<" | ">");
            if starts {
                let end = self.end_of(at);
                let ends = matches!(self.word(end), ")" | "," | ";" | "]" | "}" | "?" | ":" | "<" | ">");
                if ends && end > at + 1 && self.is_valued(at..end) {
                    self.write_numbered(at..end);
                }
            }
            // A product is folded from its left, where nothing stands in front of it that binds as strongly.
            if starts || matches!(before, "+" | "-") {
                let end = self.product(at);
                if end > at + 1 && self.is_valued(at..end) {
                    self.write_numbered(at..end);
                }
            }
            at += 1;
        }
    }

    /// The token behind the constant expression that begins here: what is no part of one, or closes more than it opens.
    fn end_of(&self, from: usize) -> usize {
        let mut depth = 0_usize;
        (from..self.tokens.len())
            .find(|&at| {
                let word = self.word(at);
                match word {
                    "(" => depth += 1,
                    ")" if depth == 0 => return true,
                    ")" => depth -= 1,
                    "+" | "-" | "*" | "/" => {}
                    _ => {
                        return !self.is_number(at) && !self.names.contains(word)
                            || at > from && self.is_operand(at - 1);
                    }
                }
                false
            })
            .unwrap_or(self.tokens.len())
    }

    fn is_operand(&self, at: usize) -> bool {
        self.is_number(at) || self.word(at) == ")" || self.names.contains(self.word(at))
    }

    /// The token behind factors that are numbers or names.
    fn product(&self, from: usize) -> usize {
        let factor = |at: usize| {
            let call = matches!(self.word(at + 1), "(" | "[" | ".");
            (self.is_number(at) || self.names.contains(self.word(at))) && !call
        };
        let mut end = if factor(from) { from + 1 } else { return from };
        while matches!(self.word(end), "*" | "/") && factor(end + 1) {
            end += 2;
        }
        end
    }

    /// True for tokens that have a value, and brackets in pairs.
    fn is_valued(&self, range: Range<usize>) -> bool {
        let count = |bracket: &str| range.clone().filter(|&at| self.word(at) == bracket).count();
        range.clone().any(|at| self.is_number(at) || self.names.contains(self.word(at))) && count("(") == count(")")
    }

    fn write_numbered(&mut self, range: Range<usize>) {
        self.count += 1;
        let head = format!("const float sc_{} = ", self.count);
        self.write(&head, range);
    }

    fn write(&mut self, head: &str, range: Range<usize>) {
        let first = self.tokens[range.start].span;
        self.out.insert(head, self.file, first.start);
        for at in range {
            let span = self.tokens[at].span;
            // Suffixes of numbers are other ones in GLSL.
            let digits = match self.word(at) {
                word if self.is_number(at) && !word.starts_with("0x") => {
                    word.trim_end_matches(['f', 'F', 'h', 'H', 'l', 'L'])
                }
                word => word,
            };
            self.out.copy(self.file, Span::new(span.start, span.start + digits.len()));
            self.out.insert(" ", self.file, span.end);
        }
        self.out.insert(";\n", self.file, first.start);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number that is meant by a literal of the module, with the text that it stands for.
    fn found(text: &str, value: f32) -> Option<(f64, String)> {
        let file = SourceFile::new("a.hlsl", text);
        let constants = constants(&file);
        let (_, constant) = constants.find(None, value)?;
        Some((constant.value(), file.slice(constant.span).to_owned()))
    }

    #[test]
    fn literals_have_the_digits_of_their_author() {
        let text = "float f(float x) { return x * 0.1f + 1.055h; }";
        assert_eq!(found(text, 0.1), Some((0.1, "0.1".to_owned())));
        assert_eq!(found(text, 1.055), Some((1.055, "1.055".to_owned())));
        assert_eq!(found(text, 0.7), None, "no other number");
    }

    #[test]
    fn constant_expressions_are_folded_in_real_numbers() {
        let text = "#define G 0.7\nstatic const float K = G * 3.0;\n\
                    float f(float x) { return pow(x, 1.0 / 2.4) + 2.0 * K * x + (0.3 - 0.1) - 0.9 * G; }";
        let value = |value: f64| found(text, value as f32).map(|(value, _)| value);
        for meant in [1.0 / 2.4, 0.7 * 3.0, 2.0 * (0.7 * 3.0), 0.3 - 0.1, 0.9 * 0.7] {
            assert!(value(meant).is_some_and(|value| (value - meant).abs() < 1e-15), "{meant}: {:?}", value(meant));
        }
        assert_eq!(found(text, (1.0_f64 / 2.4) as f32).unwrap().1.replace(' ', ""), "1.0/2.4");
    }

    #[test]
    fn what_is_no_constant_is_none() {
        for text in
            ["f(x - 0.5 * y", "}{)(", "float a = x / 2.0 * 3.3;", "#define A(x) x * 0.1", "1.0.0 0x1F 1e", "#define"]
        {
            constants(&SourceFile::new("a.hlsl", text));
        }
        // The quotient binds first.
        assert_eq!(found("float a = x / 2.1 * 3.3;", 2.1 * 3.3), None);
    }
}
