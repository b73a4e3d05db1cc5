//! What an expression of a host stands for, as far as simple paths lead: a variable with one value, a parameter with the
//! argument of a call in the same file, the result of a function of the file. Where there are two answers there is none.

mod functions;
mod members;
mod patterns;

use std::ops::Range;
use std::rc::Rc;

use crate::script::code::{Call, Code, Write};
use crate::script::language::Language;
use crate::script::token::Token;

/// Variables, parameters and functions that are followed one behind the other.
const DEEPEST: usize = 12;

/// A call that leads into a function of the file.
pub struct Frame {
    /// Index of the function.
    function: usize,
    call: Call,
    outer: Option<Rc<Self>>,
}

/// Tokens of an expression, with the call through which its function was entered.
#[derive(Clone)]
pub struct Value {
    pub tokens: Range<usize>,
    pub frame: Option<Rc<Frame>>,
}

/// What an object says under a key.
pub enum Entry {
    /// Nothing, and nothing else can say it.
    Absent,
    /// Perhaps something: other objects are joined to this one, or a condition is in front.
    Unknown,
    Value(Value),
}

impl Entry {
    /// The value, if there is one.
    pub fn value(self) -> Option<Value> {
        match self {
            Self::Value(value) => Some(value),
            Self::Absent | Self::Unknown => None,
        }
    }
}

/// The expressions of a file.
#[derive(Clone, Copy)]
pub struct Values<'c, 't> {
    pub code: &'c Code<'t>,
}

impl<'t> Values<'_, 't> {
    /// The expression that this one comes to; none where a variable on the way is not known.
    pub fn resolve(&self, value: &Value) -> Option<Value> {
        let mut value = value.clone();
        for _ in 0..DEEPEST {
            value.tokens = self.stripped(value.tokens.clone());
            if value.tokens.is_empty() {
                return None;
            }
            value = match (self.name(&value.tokens), self.call(&value.tokens)) {
                (Some(name), _) => self.variable(&name, &value)?,
                (None, Some(call)) => match self.result(call, &value) {
                    Some(result) => result,
                    None => return Some(value),
                },
                (None, None) => return Some(value),
            };
        }
        None
    }

    /// The expression without what does not change what it stands for.
    fn stripped(&self, mut range: Range<usize>) -> Range<usize> {
        let code = self.code;
        loop {
            let before = range.clone();
            let word = |at: usize| code.word(at);
            while range.start < range.end
                && (code.is_mark(range.start, '&')
                    || code.is_mark(range.start, '*')
                    || (range.len() > 1 && matches!(word(range.start), Some("mut" | "await"))))
            {
                range.start += 1;
            }
            let whole = |open: usize, range: &Range<usize>| code.other(open) == range.end.checked_sub(1);
            if range.len() > 2 && code.is_mark(range.start, '(') && whole(range.start, &range) {
                range = range.start + 1..range.end - 1;
            }
            while range.len() > 1 && ['?', '!'].iter().any(|c| code.is_mark(range.end - 1, *c)) {
                range.end -= 1;
            }
            if range.len() > 2 && word(range.end - 1) == Some("await") && code.is_mark(range.end - 2, '.') {
                range.end -= 2;
            }
            let own = range.start.checked_sub(1).and_then(|_| code.bracket(range.start));
            let cast = |at: &usize| matches!(word(*at), Some("as" | "satisfies")) && code.bracket(*at) == own;
            if let Some(at) = range.clone().skip(1).find(cast) {
                range.end = at;
            }
            if range.len() > 4
                && code.is_mark(range.end - 1, ')')
                && let Some(open) = code.other(range.end - 1).filter(|open| *open > range.start + 1)
                && code.is_mark(open - 2, '.')
                && matches!(
                    word(open - 1),
                    Some(
                        "into"
                            | "clone"
                            | "as_ref"
                            | "as_str"
                            | "as_slice"
                            | "unwrap"
                            | "to_string"
                            | "to_owned"
                            | "to_vec"
                            | "expect"
                            | "borrow"
                            | "deref"
                            | "trim"
                    )
                )
            {
                range.end = open - 2;
            }
            if let Some(call) = self.call(&range)
                && matches!(word(call.name), Some("Some" | "Borrowed" | "Owned" | "Ok" | "from" | "new"))
                && (!matches!(word(call.name), Some("from" | "new"))
                    || call
                        .name
                        .checked_sub(3)
                        .and_then(word)
                        .is_some_and(|t| ["Cow", "String", "Arc", "Rc", "Box"].contains(&t)))
                && let [only] = code.elements(call.open).as_slice()
            {
                range = only.clone();
            }
            if range == before {
                return range;
            }
        }
    }

    /// The variable that all tokens are: `name`, `self.name`, `Self::NAME`, `object.name`.
    fn name(&self, range: &Range<usize>) -> Option<String> {
        let code = self.code;
        let mut text = String::new();
        for at in range.clone() {
            match code.tokens[at] {
                Token::Word(word) => text.push_str(word),
                Token::Mark(c @ ('.' | ':')) => text.push(c),
                Token::Mark('?' | '!') => {}
                Token::Mark(_) | Token::String { .. } => return None,
            }
        }
        let first = text.chars().next()?;
        (first.is_alphabetic() || first == '_').then_some(text)
    }

    /// The call that all tokens are, be it of a path or of a method.
    pub fn call(&self, range: &Range<usize>) -> Option<Call> {
        let code = self.code;
        let close = range.end.checked_sub(1).filter(|at| code.is_mark(*at, ')'))?;
        let open = code.other(close).filter(|open| *open > range.start)?;
        code.word(open - 1)?;
        let path = |at: usize| {
            matches!(code.tokens[at], Token::Word(_) | Token::Mark('.' | ':' | '?' | '!' | '(' | ')' | '&' | '<' | '>'))
                || code.bracket(at) != code.bracket(range.start)
        };
        (range.start..open).all(path).then_some(Call { name: open - 1, open })
    }

    /// The value of a variable where it stands.
    fn variable(&self, name: &str, from: &Value) -> Option<Value> {
        let code = self.code;
        let at = from.tokens.start;
        if let Some(member) = name.strip_prefix("self.").or_else(|| name.strip_prefix("this.")) {
            return self.member(member, at);
        }
        if let Some((path, last)) = name.rsplit_once("::") {
            return self.constant(path.rsplit("::").next().unwrap_or(path), last, at);
        }
        if let Some((object, key)) = name.rsplit_once('.') {
            let object = self.variable_or_none(object, from)?;
            let object = self.resolve(&object)?;
            return self.field(&object, key).value();
        }
        let all: Vec<&Write> =
            code.writes.iter().filter(|w| w.target == name && !self.is_of_self(w) && !w.value.contains(&at)).collect();
        for body in code.around(at) {
            if let Some(element) = self.of_list(name, &body, from) {
                return Some(element);
            }
            if self.is_bound_otherwise(name, &body, at) {
                return None;
            }
            let inside: Vec<&Write> = all.iter().copied().filter(|w| body.contains(&w.at)).collect();
            let reaches = |w: &&Write| {
                w.declares
                    && w.value.end <= at
                    && code
                        .bracket(w.at)
                        .is_none_or(|open| code.other(open).is_some_and(|close| open < at && at < close))
            };
            let declared = inside.iter().copied().rfind(reaches);
            let from_there = declared.map_or(body.start, |w| w.at);
            let written: Vec<&Write> = inside.iter().copied().filter(|w| !w.declares && w.at > from_there).collect();
            match (declared, written.as_slice()) {
                (Some(only), []) | (None, &[only]) => {
                    if self.is_changed(name, &body) {
                        return None;
                    }
                    return Some(Value { tokens: only.value.clone(), frame: from.frame.clone() });
                }
                (None, []) => {}
                _ => return None,
            }
            if code.has_parameter(&body, name) {
                return self.argument(name, &body, from);
            }
        }
        let outside: Vec<&&Write> = all.iter().filter(|w| code.around(w.at).is_empty()).collect();
        match outside.as_slice() {
            [only] => Some(Value { tokens: only.value.clone(), frame: None }),
            _ => None,
        }
    }

    /// True where a method of a list changes the variable: what it was declared with is not all of it.
    fn is_changed(&self, name: &str, body: &Range<usize>) -> bool {
        const METHODS: [&str; 15] = [
            "push",
            "extend",
            "extend_from_slice",
            "append",
            "insert",
            "remove",
            "pop",
            "truncate",
            "clear",
            "resize",
            "retain",
            "drain",
            "splice",
            "unshift",
            "shift",
        ];
        let code = self.code;
        body.clone().filter(|at| code.word(*at) == Some(name)).any(|at| {
            let of_another = at.checked_sub(1).is_some_and(|before| code.is_mark(before, '.'));
            let method = code.is_mark(at + 1, '.') && code.is_mark(at + 3, '(');
            !of_another && method && code.word(at + 2).is_some_and(|word| METHODS.contains(&word))
        })
    }

    fn variable_or_none(&self, name: &str, from: &Value) -> Option<Value> {
        let parts = name.chars().all(|c| c.is_alphanumeric() || "_.".contains(c));
        parts.then(|| self.variable(name, from)).flatten()
    }

    /// True for `self.name = …`.
    fn is_of_self(&self, write: &Write) -> bool {
        let dot = write.at.checked_sub(1).filter(|at| self.code.is_mark(*at, '.'));
        dot.and_then(|at| at.checked_sub(1)).is_some_and(|at| matches!(self.code.word(at), Some("self" | "this")))
    }

    /// True where a pattern, a loop or a closure gives the name a value that is not seen.
    fn is_bound_otherwise(&self, name: &str, body: &Range<usize>, at: usize) -> bool {
        let code = self.code;
        (body.start..at).filter(|t| code.word(*t) == Some(name)).any(|t| {
            let before = |back: usize| t.checked_sub(back).and_then(|b| code.tokens.get(b)).copied();
            // The head of a loop of JavaScript: what it declares stands behind `const`, `let` or `var`.
            let in_head = |open: usize| {
                code.language != Language::Rust
                    && code.is_mark(open, '(')
                    && open.checked_sub(1).is_some_and(|b| code.word(b) == Some("for"))
            };
            let in_pattern = code
                .bracket(t)
                .filter(|open| body.contains(open) && *open > body.start && !in_head(*open))
                .is_some_and(|open| {
                    let mut start = open;
                    // `let Some((a, b)) =`, `let Self { a, b } =`
                    while let Some(earlier) = start
                        .checked_sub(1)
                        .filter(|b| {
                            code.word(*b).is_some_and(|w| !["let", "const", "var", "for"].contains(&w))
                                || code.is_mark(*b, ':')
                                || code.is_mark(*b, '(')
                                || code.is_mark(*b, '[')
                                || code.is_mark(*b, '{')
                        })
                        .filter(|b| *b > body.start && start - b < 2 && open - b < 8)
                    {
                        start = earlier;
                    }
                    start.checked_sub(1).is_some_and(|b| matches!(code.word(b), Some("let" | "const" | "var" | "for")))
                });
            let looped = matches!(before(1), Some(Token::Word("for")))
                || (matches!(before(1), Some(Token::Word("const" | "let" | "var")))
                    && matches!(before(2), Some(Token::Mark('(')))
                    && matches!(before(3), Some(Token::Word("for" | "await"))));
            in_pattern || looped || (code.language == Language::Rust && self.is_closure_parameter(t))
        })
    }

    /// True between the bars of a closure.
    fn is_closure_parameter(&self, at: usize) -> bool {
        let bar = |at: usize| self.code.is_mark(at, '|');
        let before = (at.saturating_sub(6)..at)
            .rev()
            .take_while(|t| matches!(self.code.tokens[*t], Token::Word(_) | Token::Mark('|' | ',' | '&' | ':')));
        before.into_iter().any(|t| {
            bar(t)
                && t.checked_sub(1)
                    .is_some_and(|b| matches!(self.code.tokens[b], Token::Mark('(' | ',' | '=') | Token::Word("move")))
        })
    }

    /// A constant of a type or a module.
    fn constant(&self, owner: &str, name: &str, at: usize) -> Option<Value> {
        let code = self.code;
        let owner = if owner == "Self" { self.implemented(at)? } else { owner };
        let of_owner = |w: &&Write| w.target == name && code.around(w.at).is_empty();
        let all: Vec<&Write> = code.writes.iter().filter(of_owner).collect();
        let own: Vec<&&Write> = all.iter().filter(|w| self.implemented(w.at) == Some(owner)).collect();
        match (own.as_slice(), owner.starts_with(char::is_lowercase), all.as_slice()) {
            ([only], _, _) => Some(Value { tokens: only.value.clone(), frame: None }),
            ([], true, [only]) if ["self", "super"].contains(&owner) => {
                Some(Value { tokens: only.value.clone(), frame: None })
            }
            _ => None,
        }
    }

    /// The brace of the object that a value comes to.
    pub fn object(&self, value: &Value) -> Option<(usize, Value)> {
        let code = self.code;
        let value = self.resolve(value)?;
        let close = value.tokens.end.checked_sub(1).filter(|at| code.is_mark(*at, '}'))?;
        let open = code.other(close).filter(|open| value.tokens.contains(open))?;
        let path = |at: usize| matches!(code.tokens[at], Token::Word(_) | Token::Mark(':'));
        let keyword = |at: usize| {
            matches!(code.word(at), Some("if" | "match" | "unsafe" | "loop" | "for" | "while" | "async" | "function"))
        };
        (value.tokens.start..open).all(|at| path(at) && !keyword(at)).then_some((open, value))
    }

    /// What an object says under a key of Rust; JavaScript has the same keys in its own spelling.
    pub fn field(&self, object: &Value, key: &str) -> Entry {
        match self.object(object) {
            Some((open, object)) => self.entry(open, &object, key),
            None => Entry::Unknown,
        }
    }

    /// The same for the object that a brace opens.
    pub fn entry(&self, open: usize, object: &Value, key: &str) -> Entry {
        let code = self.code;
        let camel = camel(key);
        let key = if code.language == Language::Rust { key } else { camel.as_str() };
        let elements = code.elements(open);
        let mut unknown = false;
        for element in &elements {
            let at = element.start;
            if code.is_mark(at, '.') || code.is_mark(at, '#') || code.is_mark(at, '[') {
                unknown = true;
            }
            if code.key(at) == Some(key) && code.is_mark(at + 1, ':') {
                return Entry::Value(Value { tokens: at + 2..element.end, frame: object.frame.clone() });
            }
            if code.key(at) == Some(key) && element.len() == 1 {
                return Entry::Value(Value { tokens: element.clone(), frame: object.frame.clone() });
            }
        }
        if unknown { Entry::Unknown } else { Entry::Absent }
    }

    /// True where an object says something under a key of JavaScript that is none of these: it is another interface's.
    pub fn says_more(&self, object: &Value, known: &[&str]) -> bool {
        let Some((open, _)) = self.object(object) else { return false };
        let elements = self.code.elements(open);
        elements.iter().filter_map(|element| self.code.key(element.start)).any(|key| !known.contains(&key))
    }

    /// The elements of a list in brackets; none where not all are seen.
    pub fn list(&self, value: &Value) -> Option<Vec<Value>> {
        let code = self.code;
        let value = self.resolve(value)?;
        let close = value.tokens.end.checked_sub(1).filter(|at| code.is_mark(*at, ']'))?;
        let open = code.other(close).filter(|open| value.tokens.contains(open))?;
        let vec = code.word(value.tokens.start) == Some("vec") && code.is_mark(value.tokens.start + 1, '!');
        if open != value.tokens.start + if vec { 2 } else { 0 } {
            return None;
        }
        let elements = code.elements(open);
        let spread = |e: &Range<usize>| {
            code.is_mark(e.start, '.')
                || code.is_mark(e.start, '#')
                || e.clone().any(|t| code.is_mark(t, ';') && code.bracket(t) == Some(open))
        };
        if elements.iter().any(spread) {
            return None;
        }
        Some(elements.into_iter().map(|tokens| Value { tokens, frame: value.frame.clone() }).collect())
    }

    /// The last word of a path: `wgpu::VertexFormat::Float32x3`; in JavaScript, the string that stands for it.
    pub fn word(&self, value: &Value) -> Option<&'t str> {
        let code = self.code;
        let tokens = self.stripped(value.tokens.clone());
        if let Some((text, _)) = code.string(&tokens) {
            return Some(text);
        }
        let path = tokens.clone().all(|at| matches!(code.tokens[at], Token::Word(_) | Token::Mark(':' | '.')));
        let last = code.word(tokens.end.checked_sub(1)?).filter(|_| path)?;
        let plain = tokens.len() > 1 || matches!(last, "true" | "false") || last.starts_with(char::is_uppercase);
        if plain && !last.chars().all(|c| c.is_uppercase() || c == '_' || c.is_ascii_digit()) {
            return Some(last);
        }
        let resolved = self.resolve(value).filter(|v| v.tokens != tokens)?;
        self.word(&resolved)
    }
}

/// `entry_point` as JavaScript spells it.
fn camel(key: &str) -> String {
    let mut parts = key.split('_');
    let mut text = parts.next().unwrap_or("").to_owned();
    for part in parts {
        let mut letters = part.chars();
        text.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        text.push_str(letters.as_str());
    }
    text
}
