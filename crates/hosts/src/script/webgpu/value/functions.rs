//! Functions of a host file: what their parameters are given, and what they give back.

use std::ops::Range;
use std::rc::Rc;

use super::{Frame, Value, Values};
use crate::script::code::{Call, Function};
use crate::script::language::Language;

/// Calls of one function that are followed.
const MOST_CALLS: usize = 16;

/// Calls inside of calls that are followed.
const MOST_OUTER: usize = 3;

impl<'t> Values<'_, 't> {
    /// The ways in which the function around a token is entered: one without a call where the file has none.
    pub fn frames(&self, at: usize) -> Vec<Option<Rc<Frame>>> {
        self.frames_within(at, MOST_OUTER)
    }

    pub(super) fn frames_within(&self, at: usize, depth: usize) -> Vec<Option<Rc<Frame>>> {
        let Some(function) = self.function_around(at).filter(|_| depth > 0) else { return vec![None] };
        let mut found = Vec::new();
        for call in self.calls_of(function) {
            for outer in self.frames_within(call.name, depth - 1) {
                found.push(Some(Rc::new(Frame { function, call, outer })));
                if found.len() >= MOST_CALLS {
                    return found;
                }
            }
        }
        if found.is_empty() { vec![None] } else { found }
    }

    /// The innermost function around a token.
    pub(super) fn function_around(&self, at: usize) -> Option<usize> {
        let all = self.code.functions.iter().enumerate().filter(|(_, f)| f.body.contains(&at));
        all.min_by_key(|(_, f)| f.body.len()).map(|(index, _)| index)
    }

    /// The name of a function, with its token.
    pub(super) fn name_of(&self, function: &Function) -> Option<(&'t str, usize)> {
        let code = self.code;
        let before = function.parameters.start.checked_sub(1)?;
        if code.language == Language::Rust {
            let start = before.saturating_sub(16);
            let at = (start..=before).rev().find(|at| code.word(*at) == Some("fn"))? + 1;
            return code.word(at).map(|name| (name, at));
        }
        match code.word(before) {
            Some("function" | "async") => {}
            Some(name) => return Some((name, before)),
            None => {}
        }
        // `const name = async (…) => {`
        let equals = (before.saturating_sub(2)..=before).rev().find(|at| code.is_mark(*at, '='))?;
        let at = equals.checked_sub(1)?;
        code.word(at).map(|name| (name, at))
    }

    pub(super) fn parameters(&self, function: &Function) -> Vec<Range<usize>> {
        self.code.elements(function.parameters.start)
    }

    pub(super) fn takes_self(&self, function: &Function) -> bool {
        let first = self.parameters(function).into_iter().next();
        self.code.language == Language::Rust && first.is_some_and(|mut p| p.any(|t| self.code.word(t) == Some("self")))
    }

    pub(super) fn calls_of(&self, index: usize) -> Vec<Call> {
        let code = self.code;
        let function = &code.functions[index];
        let Some((name, defined)) = self.name_of(function) else { return Vec::new() };
        // Two functions of one name are not told apart.
        let same = |f: &Function| self.name_of(f).is_some_and(|(n, _)| n == name);
        if code.functions.iter().filter(|f| same(f)).count() > 1 {
            return Vec::new();
        }
        let of_object = |call: &Call| call.name > 0 && code.is_mark(call.name - 1, '.');
        let own = |call: &Call| call.name >= 2 && matches!(code.word(call.name - 2), Some("self" | "this"));
        let fits = |call: &Call| match code.language {
            Language::Rust => of_object(call) == self.takes_self(function),
            _ => !of_object(call) || own(call),
        };
        let here = |call: &Call| code.word(call.name) == Some(name) && call.name != defined;
        code.calls().filter(here).filter(fits).collect()
    }

    /// What a call gives for a parameter.
    pub(super) fn argument(&self, name: &str, body: &Range<usize>, from: &Value) -> Option<Value> {
        let code = self.code;
        let frame = from.frame.as_ref()?;
        let function = &code.functions[frame.function];
        if function.body != *body {
            return None;
        }
        let parameters = self.parameters(function);
        let skipped = usize::from(self.takes_self(function));
        let arguments = code.elements(frame.call.open);
        for (index, parameter) in parameters.iter().skip(skipped).enumerate() {
            let argument = || {
                let tokens = arguments.get(index)?.clone();
                Some(Value { tokens, frame: frame.outer.clone() })
            };
            let first = if code.word(parameter.start) == Some("mut") { parameter.start + 1 } else { parameter.start };
            if code.word(first) == Some(name) {
                // A default, or an argument that is left out.
                return argument();
            }
            if code.is_mark(first, '{') && code.property(first, name).is_some() {
                let object = self.resolve(&argument()?)?;
                return self.field(&object, name).value();
            }
        }
        None
    }

    /// What a call of a function of the file gives back.
    pub(super) fn result(&self, call: Call, from: &Value) -> Option<Value> {
        let code = self.code;
        let name = code.word(call.name)?;
        let named = |f: &Function| self.name_of(f).is_some_and(|(n, _)| n == name);
        let path = |back: usize| call.name.checked_sub(back);
        let owner = path(3).filter(|_| path(1).is_some_and(|b| code.is_mark(b, ':'))).and_then(|b| code.word(b));
        let owner = if owner == Some("Self") { self.implemented(call.name) } else { owner };
        let method = path(1).is_some_and(|b| code.is_mark(b, '.'));
        let of_self = path(2).is_some_and(|b| matches!(code.word(b), Some("self" | "this")));
        if method && !of_self {
            return None;
        }
        let fits = |f: &Function| match owner {
            Some(owner) => self.implemented(f.body.start) == Some(owner),
            None => method || code.language != Language::Rust || self.implemented(f.body.start).is_none(),
        };
        let mut all = code.functions.iter().enumerate().filter(|(_, f)| named(f) && fits(f));
        let (index, function) = all.next().filter(|_| all.next().is_none())?;
        let returns: Vec<usize> = function
            .body
            .clone()
            .filter(|t| code.word(*t) == Some("return") && self.function_around(*t) == Some(index))
            .collect();
        let close = function.body.end.saturating_sub(1);
        let is_value = code.language == Language::JavaScript && !code.is_mark(function.body.start, '{');
        let tokens = match (code.language, returns.as_slice()) {
            _ if is_value => function.body.clone(),
            (_, [only]) if code.bracket(*only) == Some(function.body.start) => only + 1..code.end_of_value(only + 1),
            (Language::Rust, []) => {
                let open = function.body.start;
                let last = (open + 1..close).rev().find(|t| code.is_mark(*t, ';') && code.bracket(*t) == Some(open));
                last.unwrap_or(open) + 1..close
            }
            _ => return None,
        };
        (!tokens.is_empty())
            .then(|| Value { tokens, frame: Some(Rc::new(Frame { function: index, call, outer: from.frame.clone() })) })
    }
}
