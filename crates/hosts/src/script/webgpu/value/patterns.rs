//! Patterns that give several names a value each.

use std::ops::Range;

use super::{Value, Values};
use crate::script::language::Language;

impl Values<'_, '_> {
    /// What `const [a, b] = [x, y]` gives a name in front of its use, and so with `await Promise.all([x, y])`. None where
    /// that is not the one place that gives it a value.
    pub(super) fn of_list(&self, name: &str, body: &Range<usize>, from: &Value) -> Option<Value> {
        let code = self.code;
        if code.language != Language::JavaScript || code.has_parameter(body, name) {
            return None;
        }
        let pattern = |at: usize| {
            let open = code.bracket(at).filter(|open| code.is_mark(*open, '['))?;
            let declares = matches!(code.word(open.checked_sub(1)?)?, "const" | "let" | "var");
            let equals = code.other(open)? + 1;
            (declares && code.is_mark(equals, '=')).then_some((open, equals))
        };
        let mut named = (body.start..from.tokens.start).filter(|at| code.word(*at) == Some(name)).filter_map(pattern);
        let (open, equals) = named.next().filter(|_| named.next().is_none())?;
        if code.writes.iter().any(|w| w.target == name && body.contains(&w.at)) {
            return None;
        }
        let index = code.elements(open).iter().position(|e| e.len() == 1 && code.word(e.start) == Some(name))?;
        let whole = Value { tokens: equals + 1..code.end_of_value(equals + 1), frame: from.frame.clone() };
        let whole = self.resolve(&whole)?;
        let list = match self.call(&whole.tokens).filter(|c| code.word(c.name) == Some("all")) {
            Some(call) => {
                let tokens = code.elements(call.open).into_iter().next()?;
                self.list(&Value { tokens, frame: whole.frame })?
            }
            None => self.list(&whole)?,
        };
        list.into_iter().nth(index)
    }
}
