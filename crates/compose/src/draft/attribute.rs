//! Attributes of early drafts: several in double brackets, and those that became something else.

use base::text::Span;
use syntax::errors;

use super::{Pass, Stride};
use crate::token::{Kind, behind_template};

/// Where to read what became of the early drafts.
const HELP: &str = "write it as the language has it today (https://www.w3.org/TR/WGSL)";

/// Built-in values by their names then and now.
const BUILTINS: &[(&str, &str)] = &[
    ("frag_coord", "position"),
    ("vertex_idx", "vertex_index"),
    ("instance_idx", "instance_index"),
    ("local_invocation_idx", "local_invocation_index"),
    ("sample_mask_in", "sample_mask"),
    ("sample_mask_out", "sample_mask"),
];

impl Pass<'_> {
    /// `[[a, b(c)]]` at a token; the token behind it.
    pub(super) fn bracketed(&mut self, open: usize) -> usize {
        let end = self.behind[open];
        let is_whole = self.word(end.saturating_sub(1)) == "]" && self.behind[open + 1] + 1 == end;
        if !is_whole {
            let help = "close it with `]]`";
            let message = "this attribute of an early draft of WGSL has no end";
            self.problems.add(errors::EARLY_DRAFT, self.file, self.span(open, open + 2), message, help);
            return open + 2;
        }
        let whole = self.span(open, end);
        let (mut at, mut copied) = (open + 2, whole.start);
        while at < end - 2 {
            let next = self.attribute(at, &mut copied, end);
            at = if self.word(next) == "," { next + 1 } else { next.max(at + 1) };
        }
        self.change(Span::new(copied, whole.end), "", "`[[…]]` is `@…`");
        end
    }

    /// One attribute of several in brackets. `copied` is the end of what is done.
    fn attribute(&mut self, at: usize, copied: &mut usize, end: usize) -> usize {
        let first = self.word(at - 1) == "[";
        // `[[location 0]]` is older than `[[location(0)]]`.
        let bare = matches!(self.tokens[at + 1].kind, Kind::Number | Kind::Word);
        let next = match self.word(at + 1) {
            "(" => self.behind[at + 1],
            _ if bare => at + 2,
            _ => at + 1,
        };
        let own = self.span(at, next);
        let gap = if first { "" } else { " " };
        let name = self.word(at).to_owned();
        let argument = self.word(if bare { at + 1 } else { at + 2 }).to_owned();
        let kind = "`[[…]]` is `@…`";
        if self.special(at, next, end, Span::new(*copied, own.end)) {
            *copied = own.end;
            return next;
        }
        let before = Span::new(*copied, own.start);
        match name.as_str() {
            "stage" => {
                // The size of a work group was one invocation where nothing was said.
                let mut words =
                    (at..self.tokens.len()).map(|k| self.word(k)).take_while(|word| !matches!(*word, "fn" | "{"));
                let sized = words.any(|word| word == "workgroup_size");
                self.change(
                    Span::new(before.start, self.tokens[if bare { at + 1 } else { at + 2 }].span.start),
                    if argument == "compute" && !sized {
                        format!("{gap}@workgroup_size(1) @")
                    } else {
                        format!("{gap}@")
                    },
                    kind,
                );
                *copied = if bare { own.end } else { self.span(at, next - 1).end };
            }
            "location" | "group" | "binding" | "set" | "builtin" | "workgroup_size" | "interpolate" | "size"
            | "align" | "invariant" | "diagnostic" | "must_use" | "id" => {
                let new = if name == "set" { "group" } else { &name };
                self.change(before.to(self.tokens[at].span), format!("{gap}@{new}"), kind);
                if bare {
                    self.change(Span::new(self.tokens[at].span.end, own.end), format!("({argument})"), kind);
                } else if let Some((_, now)) = BUILTINS.iter().find(|(old, _)| name == "builtin" && *old == argument) {
                    self.change(self.tokens[at + 2].span, *now, "built-in values have their names of today");
                }
                *copied = own.end;
            }
            _ => {
                self.refuse(own, &format!("the attribute `{name}`"), HELP);
                self.change(before.to(own), "", kind);
                *copied = own.end;
            }
        }
        next
    }

    /// Attributes that became something else than an attribute: they are removed with the `span` before them. False
    /// for all others.
    fn special(&mut self, at: usize, next: usize, end: usize, span: Span) -> bool {
        let name = self.word(at).to_owned();
        let argument = self.word(at + 2).to_owned();
        match name.as_str() {
            "block" => self.change(span, "", "structures need no `block`"),
            "stride" => {
                let element = self.element(end);
                if argument == "0" {
                    // What a template leaves open is that of the elements.
                } else if let (Ok(bytes), Some(element)) = (argument.parse(), element) {
                    self.strides.push(Stride { span: self.span(at, next), bytes, element });
                } else {
                    self.refuse(self.span(at, next), "this `stride`", HELP);
                }
                self.change(span, "", "the stride of an array follows from its elements");
            }
            "access" => {
                self.access(at, end, &argument);
                self.change(span, "", "`[[access]]` is a part of the type");
            }
            "override" | "constant_id" => {
                let id = if self.word(at + 1) == "(" { format!("@id({argument})") } else { String::new() };
                self.change(span, id, "`[[override]]` is `override`");
                self.overrides = Some(end);
            }
            _ => return false,
        }
        true
    }

    /// The type of the elements of the array behind an attribute.
    fn element(&self, array: usize) -> Option<std::ops::Range<usize>> {
        if self.word(array) != "array" {
            return None;
        }
        let close = behind_template(self.tokens, array + 1).checked_sub(1)?;
        let mut depth = 0_usize;
        let comma = (array + 2..close).find(|&at| {
            match self.word(at) {
                "<" | "(" => depth += 1,
                ">" | ")" => depth = depth.saturating_sub(1),
                _ => {}
            }
            depth == 0 && self.word(at) == ","
        });
        Some(array + 2..comma.unwrap_or(close))
    }

    /// `[[access(read)]] T` and `var<storage> x : [[access(read)]] T`.
    fn access(&mut self, at: usize, behind: usize, access: &str) {
        let kind = "`[[access]]` is a part of the type";
        if self.word(behind).starts_with("texture_storage") {
            let close = behind_template(self.tokens, behind + 1);
            if close > behind + 1 {
                self.change(Span::at(self.tokens[close - 1].span.start), format!(", {access}"), kind);
                return;
            }
        }
        let start = (0..at).rev().take_while(|&k| !matches!(self.word(k), ";" | "}")).find(|&k| self.word(k) == "var");
        let Some(start) = start.filter(|&start| self.word(start + 1) == "<" && self.word(start + 3) == ">") else {
            self.refuse(self.span(at, behind), "this `access`", "say it of the variable: `var<storage, read_write>`");
            return;
        };
        // A buffer that is only written is one that is written.
        let access = if access == "write" { "read_write" } else { access };
        self.change(Span::at(self.tokens[start + 3].span.start), format!(", {access}"), kind);
    }

    /// `@stage(vertex)`, `@block`, `@stride(16)` and `@override`, which came between the brackets and today's attributes.
    pub(super) fn single(&mut self, at: usize) -> usize {
        let next = if self.word(at + 2) == "(" { self.behind[at + 2] } else { at + 2 };
        match self.word(at + 1) {
            "stage" if next == at + 5 => {
                self.change(self.span(at, at + 3), "@", "`@stage(…)` is the stage alone");
                self.change(self.tokens[at + 4].span, "", "`@stage(…)` is the stage alone");
            }
            "block" | "stride" | "access" | "override" | "constant_id" => {
                self.special(at + 1, next, next, self.span(at, next));
            }
            _ => {
                // What stands in parentheses is read by itself.
                return at + 2;
            }
        }
        next
    }
}
