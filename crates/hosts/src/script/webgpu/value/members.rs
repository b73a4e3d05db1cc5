//! Members of objects: what the file gives them.

use std::ops::Range;

use super::{Value, Values};
use crate::script::code::Write;
use crate::script::language::Language;

impl<'t> Values<'_, 't> {
    /// A member of the object whose method this is: the one value that the file gives it.
    pub(super) fn member(&self, name: &str, at: usize) -> Option<Value> {
        let code = self.code;
        if name.contains('.') {
            return None;
        }
        let own = |w: &&Write| (w.target == name && self.is_of_self(w)) || self.is_of_new(w, name, at);
        let mut found: Vec<Range<usize>> = code.writes.iter().filter(own).map(|w| w.value.clone()).collect();
        for open in (0..code.tokens.len()).filter(|t| code.is_mark(*t, '{')) {
            let made = open.checked_sub(1).and_then(|b| code.word(b));
            let owner = || self.implemented(at);
            let is_struct =
                open.checked_sub(2).is_some_and(|b| matches!(code.word(b), Some("struct" | "for" | "impl")));
            if code.language == Language::Rust && !is_struct && made.is_some_and(|m| m == "Self" || owner() == Some(m))
            {
                found.extend(code.property(open, name));
            }
        }
        match found.as_slice() {
            [only] => Some(Value { tokens: only.clone(), frame: None }),
            _ => None,
        }
    }

    /// True for `object.name = …` where the object is a new one of the class around a token.
    fn is_of_new(&self, write: &Write, name: &str, at: usize) -> bool {
        let code = self.code;
        let object = write.target.strip_suffix(name).and_then(|rest| rest.strip_suffix('.'));
        let Some(object) = object.filter(|o| !o.contains('.') && code.language == Language::JavaScript) else {
            return false;
        };
        let Some(class) = self.class(at) else { return false };
        let made = |w: &Write| {
            let of = (code.word(w.value.start) == Some("new")).then(|| code.word(w.value.start + 1)).flatten();
            of == Some(class) || (of == Some("this") && self.class(w.at) == Some(class))
        };
        let body = code.around(write.at).into_iter().next();
        let mut declared = code
            .writes
            .iter()
            .filter(|w| w.declares && w.target == object && body.as_ref().is_some_and(|b| b.contains(&w.at)));
        declared.next().is_some_and(|w| made(w) && declared.next().is_none())
    }

    /// The class that a token stands in.
    fn class(&self, at: usize) -> Option<&'t str> {
        let code = self.code;
        let mut open = code.bracket(at);
        while let Some(brace) = open {
            let head = (brace.saturating_sub(4)..brace).rev().find(|t| code.word(*t) == Some("class"));
            if let Some(head) = head.filter(|_| code.is_mark(brace, '{')) {
                return code.word(head + 1);
            }
            open = code.bracket(brace);
        }
        None
    }

    /// The type whose `impl` a token stands in.
    pub(super) fn implemented(&self, at: usize) -> Option<&'t str> {
        let code = self.code;
        let mut open = code.bracket(at);
        while let Some(brace) = open {
            let start = brace.saturating_sub(16);
            let head = (start..brace).rev().take_while(|t| !code.is_mark(*t, '}') && !code.is_mark(*t, ';'));
            if let Some(at) = head.into_iter().find(|t| code.word(*t) == Some("impl")) {
                let last = (at..brace).rev().find(|t| code.word(*t) == Some("for")).unwrap_or(at);
                return (last + 1..brace).filter(|t| code.bracket(*t) == code.bracket(brace)).find_map(|t| {
                    code.word(t).filter(|w| w.starts_with(char::is_uppercase) && !code.is_mark(t + 1, ':'))
                });
            }
            open = code.bracket(brace);
        }
        None
    }
}
