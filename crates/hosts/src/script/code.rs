//! What a script does, as far as its tokens say: calls with their arguments, values of variables, functions.
//!
//! One reader serves all languages: they have calls, brackets and assignments in common, and no more is asked of them.

use std::ops::Range;

use base::text::{SourceFile, Span};

use super::language::Language;
use super::token::{Token, tokens};

/// A file as tokens.
pub struct Code<'t> {
    /// The file.
    pub file: &'t SourceFile,
    /// Its language.
    pub language: Language,
    /// Its tokens.
    pub tokens: Vec<Token<'t>>,
    /// Their places.
    places: Vec<Span>,
    /// The other one of each pair of brackets.
    partner: Vec<Option<usize>>,
    /// The bracket that each token stands in.
    inside: Vec<Option<usize>>,
    /// Values that variables get.
    pub writes: Vec<Write>,
    /// Its functions, in the order of their bodies.
    pub functions: Vec<Function>,
}

/// A variable that gets a value.
pub struct Write {
    /// The variable with its objects: `material.uniforms`, without `this`.
    pub target: String,
    /// Where the target ends.
    pub at: usize,
    /// Tokens of the value.
    pub value: Range<usize>,
    /// True for one that the statement declares.
    pub declares: bool,
}

/// A function with a body.
pub struct Function {
    /// From the parenthesis that opens its parameters to the one that closes them.
    pub parameters: Range<usize>,
    /// From the first to behind the last brace; of an arrow of JavaScript with a value behind it, that value.
    pub body: Range<usize>,
}

/// A call.
#[derive(Clone, Copy)]
pub struct Call {
    /// The token of the name.
    pub name: usize,
    /// The parenthesis that opens the arguments.
    pub open: usize,
}

impl<'t> Code<'t> {
    /// Reads a file.
    pub fn new(file: &'t SourceFile, language: Language) -> Self {
        let (tokens, places) = tokens(file.text(), language);
        let (partner, inside) = brackets(&tokens);
        let (writes, functions) = (Vec::new(), Vec::new());
        let mut code = Self { file, language, tokens, places, partner, inside, writes, functions };
        code.functions = code.find_functions();
        code.writes = (0..code.tokens.len()).filter_map(|at| code.write(at)).collect();
        code
    }

    /// Place of a token.
    pub fn place(&self, at: usize) -> Span {
        self.places.get(at).copied().unwrap_or_default()
    }

    /// Place of several tokens.
    pub fn span(&self, range: &Range<usize>) -> Span {
        if range.is_empty() { Span::default() } else { self.place(range.start).to(self.place(range.end - 1)) }
    }

    /// The word at a token.
    pub fn word(&self, at: usize) -> Option<&'t str> {
        match self.tokens.get(at)? {
            Token::Word(word) => Some(word),
            Token::Mark(_) | Token::String { .. } => None,
        }
    }

    /// True for this character.
    pub fn is_mark(&self, at: usize, mark: char) -> bool {
        matches!(self.tokens.get(at), Some(Token::Mark(c)) if *c == mark)
    }

    /// The bracket that a token stands in.
    pub fn bracket(&self, at: usize) -> Option<usize> {
        self.inside.get(at).copied().flatten()
    }

    /// The other bracket of a pair.
    pub fn other(&self, at: usize) -> Option<usize> {
        self.partner.get(at).copied().flatten()
    }

    /// All calls, in the order of the text.
    pub fn calls(&self) -> impl Iterator<Item = Call> {
        (0..self.tokens.len())
            .filter(|&at| self.word(at).is_some() && self.is_mark(at + 1, '(') && self.other(at + 1).is_some())
            .map(|at| Call { name: at, open: at + 1 })
    }

    /// The tokens of each argument of a call, or of each element of a list.
    pub fn elements(&self, open: usize) -> Vec<Range<usize>> {
        let Some(close) = self.other(open) else { return Vec::new() };
        let mut found = Vec::new();
        let mut start = open + 1;
        for at in open + 1..=close {
            if at == close || (self.is_mark(at, ',') && self.bracket(at) == Some(open)) {
                if start < at {
                    found.push(start..at);
                }
                start = at + 1;
            }
        }
        found
    }

    /// A variable with its objects that ends at this token, without `this`: its text and its first token.
    pub fn chain(&self, end: usize) -> Option<(String, usize)> {
        let mut names = vec![self.word(end)?];
        let mut start = end;
        loop {
            let dot = start.checked_sub(1).filter(|at| self.is_mark(*at, '.'));
            // `program!.id`, `program?.id`
            let before = dot.and_then(|at| at.checked_sub(1));
            let before =
                before.map(|at| if self.is_mark(at, '!') || self.is_mark(at, '?') { at.saturating_sub(1) } else { at });
            let Some((at, name)) = before.and_then(|at| Some((at, self.word(at)?))) else {
                // A member of what a call or an index gives.
                return dot.is_none().then(|| (own(names), start));
            };
            names.push(name);
            start = at;
        }
    }

    /// The variable that is all of these tokens.
    pub fn variable(&self, range: &Range<usize>) -> Option<String> {
        let mut range = range.clone();
        while range.start < range.end && ['&', '*', '('].iter().any(|c| self.is_mark(range.start, *c)) {
            range.start += 1;
        }
        while range.start < range.end && ['!', ')', '?'].iter().any(|c| self.is_mark(range.end - 1, *c)) {
            range.end -= 1;
        }
        // `program as WebGLProgram`
        if let Some(at) = range.clone().find(|at| self.word(*at) == Some("as")) {
            range.end = at;
        }
        let (name, start) = self.chain(range.end.checked_sub(1)?)?;
        (start == range.start).then_some(name)
    }

    /// The object whose method is called.
    pub fn receiver(&self, call: Call) -> Option<String> {
        let dot = call.name.checked_sub(1).filter(|at| self.is_mark(*at, '.'))?;
        let before = dot.checked_sub(1)?;
        let before =
            if self.is_mark(before, '!') || self.is_mark(before, '?') { before.saturating_sub(1) } else { before };
        self.chain(before).map(|(name, _)| name)
    }

    /// The string that these tokens are, when they are one without escapes.
    pub fn string(&self, range: &Range<usize>) -> Option<(&'t str, Span)> {
        // A string of C in Rust: `c"name"`.
        let start = if range.len() == 2 && self.word(range.start) == Some("c") { range.start + 1 } else { range.start };
        match self.tokens.get(start)? {
            Token::String { inner, .. } if start + 1 == range.end => {
                let text = self.file.slice(*inner);
                let text = text.strip_suffix("\\0").unwrap_or(text);
                (!text.contains(['\\', '\n'])).then_some((text, Span::new(inner.start, inner.start + text.len())))
            }
            _ => None,
        }
    }

    /// The functions around a token, the innermost first, as the ranges of their bodies.
    pub fn around(&self, at: usize) -> Vec<Range<usize>> {
        let mut found: Vec<Range<usize>> =
            self.functions.iter().filter(|f| f.body.contains(&at)).map(|f| f.body.clone()).collect();
        found.sort_by_key(|body| body.len());
        found
    }

    /// True when the function with this body has a parameter of that name.
    pub fn has_parameter(&self, body: &Range<usize>, name: &str) -> bool {
        let mut own = self.functions.iter().filter(|f| f.body == *body);
        own.any(|f| f.parameters.clone().any(|at| self.word(at) == Some(name)))
    }

    /// The value under a key of an object in braces.
    pub fn property(&self, open: usize, key: &str) -> Option<Range<usize>> {
        self.properties(open).into_iter().find(|(at, _)| self.key(*at) == Some(key)).map(|(_, value)| value)
    }

    /// The keys of an object, as tokens, with their values; for a key alone it is its own value.
    pub fn properties(&self, open: usize) -> Vec<(usize, Range<usize>)> {
        let entry = |element: Range<usize>| {
            let at = element.start;
            self.key(at)?;
            if self.is_mark(at + 1, ':') {
                return Some((at, at + 2..element.end));
            }
            (element.len() == 1).then_some((at, element))
        };
        self.elements(open).into_iter().filter_map(entry).collect()
    }

    /// The name of a key.
    pub fn key(&self, at: usize) -> Option<&'t str> {
        match self.tokens.get(at)? {
            Token::Word(word) => Some(word),
            Token::String { inner, .. } => Some(self.file.slice(*inner)),
            Token::Mark(_) => None,
        }
    }

    /// The write whose value is these tokens and no more.
    pub fn kept_in(&self, value: &Range<usize>) -> Option<&Write> {
        let end = |w: &&Write| {
            (value.end..w.value.end).all(|at| ['!', '?', ')', ';'].iter().any(|c| self.is_mark(at, *c)))
                || self.word(value.end) == Some("as")
        };
        self.writes.iter().filter(|w| w.value.start == value.start && w.value.end >= value.end).find(end)
    }

    /// The write that an `=` at this token makes.
    fn write(&self, at: usize) -> Option<Write> {
        if !self.is_mark(at, '=') || at == 0 {
            return None;
        }
        let beside =
            |side: usize, marks: &str| matches!(self.tokens.get(side), Some(Token::Mark(c)) if marks.contains(*c));
        let touches = |a: usize, b: usize| self.place(a).end == self.place(b).start;
        if (beside(at + 1, "=>") && touches(at, at + 1)) || (beside(at - 1, "=!<>+-*/%&|^~") && touches(at - 1, at)) {
            return None;
        }
        // A default of a parameter, an argument by name.
        if self.bracket(at).is_some_and(|open| self.is_mark(open, '(')) {
            return None;
        }
        let end = self.annotated(at - 1).unwrap_or(at - 1);
        let (target, start) = self.chain(end)?;
        let declares = start.checked_sub(1).and_then(|before| self.word(before)).is_some();
        Some(Write { target, at: end, value: at + 1..self.end_of_value(at + 1), declares })
    }

    /// The name in front of the type that ends here: `name: Type`.
    fn annotated(&self, end: usize) -> Option<usize> {
        if self.language == Language::Java {
            return None;
        }
        let mut at = end + 1;
        for _ in 0..=8 {
            at = at.checked_sub(1)?;
            // `[T; N]`
            if self.language == Language::Rust && self.is_mark(at, ']') {
                at = self.other(at)?;
            }
            match self.tokens.get(at)? {
                Token::Mark(':') => {
                    let name = at.checked_sub(1)?;
                    let name =
                        if self.is_mark(name, '!') || self.is_mark(name, '?') { name.saturating_sub(1) } else { name };
                    return self.word(name).map(|_| name);
                }
                Token::Word(_) | Token::Mark('&' | '\'' | '<' | '>' | '[' | ']' | '|' | '?' | '.') => {}
                Token::Mark(_) | Token::String { .. } => return None,
            }
        }
        None
    }

    /// Where the value ends that begins at a token.
    pub fn end_of_value(&self, start: usize) -> usize {
        let own = start.checked_sub(1).and_then(|at| self.bracket(at));
        // Languages in which the end of a line ends a statement, where nothing shows that it goes on.
        let by_line = matches!(self.language, Language::Python | Language::JavaScript | Language::Kotlin);
        let goes_on = |at: usize| matches!(self.tokens.get(at), Some(Token::Mark(c)) if ".+?|&*/=:,".contains(*c));
        let mut at = start;
        while at < self.tokens.len() {
            let outside = self.bracket(at) == own;
            if outside && (self.is_mark(at, ';') || self.is_mark(at, ',')) {
                return at;
            }
            if self.bracket(at).is_none_or(|b| Some(b) == own) && self.other(at).is_some_and(|o| o < start) {
                return at;
            }
            if own.is_some_and(|open| self.other(open) == Some(at)) {
                return at;
            }
            if by_line && outside && at > start && !goes_on(at) && !goes_on(at - 1) {
                let between = Span::new(self.place(at - 1).end, self.place(at).start);
                let closes = self.other(at).is_some_and(|open| open < at);
                if self.file.slice(between).contains('\n') && !closes {
                    return at;
                }
            }
            at += 1;
        }
        at
    }

    fn find_functions(&self) -> Vec<Function> {
        if self.language == Language::Python {
            return self.functions_of_python();
        }
        let mut found = Vec::new();
        for open in (0..self.tokens.len()).filter(|at| self.is_mark(*at, '{')) {
            let Some(close) = self.other(open) else { continue };
            if let Some(parameters) = self.parameters_before(open) {
                found.push(Function { parameters, body: open..close + 1 });
            }
        }
        if self.language == Language::JavaScript {
            found.extend((0..self.tokens.len()).filter_map(|at| self.arrow(at)));
            found.sort_by_key(|f| f.body.start);
        }
        found
    }

    /// The function `name = (…) => value` whose arrow begins at a token.
    fn arrow(&self, at: usize) -> Option<Function> {
        let touches = self.place(at).end == self.place(at + 1).start;
        let braced = self.is_mark(at + 2, '{');
        (self.is_mark(at, '=') && self.is_mark(at + 1, '>') && touches && !braced).then_some(())?;
        let parameters = self.parameters_before(at)?;
        let mut before = parameters.start.checked_sub(1)?;
        if self.word(before) == Some("async") {
            before = before.checked_sub(1)?;
        }
        let named = self.is_mark(before, '=') && before.checked_sub(1).is_some_and(|b| self.word(b).is_some());
        named.then(|| Function { parameters, body: at + 2..self.end_of_value(at + 2) })
    }

    /// The parameters of the function whose body a brace opens.
    fn parameters_before(&self, open: usize) -> Option<Range<usize>> {
        for back in 1..=14 {
            let at = open.checked_sub(back)?;
            match self.tokens.get(at)? {
                Token::Mark(')') => {
                    let start = self.other(at)?;
                    let before = start.checked_sub(1).and_then(|at| self.word(at)).unwrap_or("");
                    let other = ["if", "for", "while", "switch", "catch", "with", "when", "synchronized", "try"];
                    return (!other.contains(&before)).then_some(start..at);
                }
                // A type that is given back, or an arrow.
                Token::Word(word) if !["else", "do", "class", "try", "return", "match"].contains(word) => {}
                Token::Mark('>' | '<' | ':' | '-' | '=' | '&' | '[' | ']' | '|' | '.' | '?') => {}
                Token::Word(_) | Token::Mark(_) | Token::String { .. } => return None,
            }
        }
        None
    }

    fn functions_of_python(&self) -> Vec<Function> {
        let mut found = Vec::new();
        let indent = |at: usize| self.file.position(self.place(at).start).column;
        let line = |at: usize| self.file.position(self.place(at).start).line;
        for def in (0..self.tokens.len()).filter(|at| self.word(*at) == Some("def")) {
            let Some(close) = self.other(def + 2) else { continue };
            let mut end = close + 1;
            while end < self.tokens.len() {
                let first_of_line = line(end) != line(end - 1) && self.bracket(end).is_none();
                if first_of_line && indent(end) <= indent(def) {
                    break;
                }
                end += 1;
            }
            found.push(Function { parameters: def + 2..close, body: close + 1..end });
        }
        found
    }
}

/// A variable without `this` in front.
fn own(mut names: Vec<&str>) -> String {
    if names.len() > 1 && matches!(names.last(), Some(&("this" | "self"))) {
        names.pop();
    }
    names.reverse();
    names.join(".")
}

fn brackets(tokens: &[Token<'_>]) -> (Vec<Option<usize>>, Vec<Option<usize>>) {
    let mut partner = vec![None; tokens.len()];
    let mut inside = vec![None; tokens.len()];
    let mut open: Vec<(usize, char)> = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        if let Token::Mark(c @ (')' | ']' | '}')) = token {
            // One that closes nothing ends what it stands in.
            let wanted = match c {
                ')' => '(',
                ']' => '[',
                _ => '{',
            };
            if let Some(depth) = open.iter().rposition(|(_, c)| *c == wanted) {
                let start = open[depth].0;
                open.truncate(depth);
                (partner[at], partner[start]) = (Some(start), Some(at));
            }
        }
        inside[at] = open.last().map(|(at, _)| *at);
        if let Token::Mark(c @ ('(' | '[' | '{')) = token {
            open.push((at, *c));
        }
    }
    (partner, inside)
}
