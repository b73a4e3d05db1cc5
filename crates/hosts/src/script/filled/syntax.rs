//! Expressions of JavaScript and TypeScript, as far as a constant text is made of them.
//!
//! What is not read is [`Node::Unknown`] where it stands: an object with a value that is computed still has its others.

use std::rc::Rc;

use base::text::{SourceFile, Span};

use crate::script::language::{Form, Language};
use crate::script::token::{Token, tokens};

/// Expressions within expressions that are read.
const DEEPEST: usize = 48;

/// Tokens of a type that are passed over.
const LONGEST_TYPE: usize = 64;

/// An expression.
#[derive(Debug)]
pub(super) enum Node {
    Number(f64),
    Truth(bool),
    /// `undefined` and `null`.
    Nothing,
    /// A string or a template: what stands between its marks.
    String(Span, Form),
    Name(String),
    Member(Rc<Self>, String),
    Index(Rc<Self>, Rc<Self>),
    Call(Rc<Self>, Vec<Rc<Self>>),
    Unary(char, Rc<Self>),
    Binary(&'static str, Rc<Self>, Rc<Self>),
    /// `a ? b : c`, with the place of the condition.
    Choice(Rc<Self>, Span, Rc<Self>, Rc<Self>),
    Object(Vec<(String, Rc<Self>)>),
    List(Vec<Rc<Self>>),
    Function(Rc<Function>),
    Unknown,
}

/// A function that gives one expression.
#[derive(Debug)]
pub(super) struct Function {
    pub params: Vec<Param>,
    /// What its body does, in its order.
    pub steps: Vec<Step>,
}

/// A statement of a function.
#[derive(Debug)]
pub(super) enum Step {
    Constant(String, Rc<Node>),
    /// What is returned under a condition, whose place is given; none where the function ends with an error.
    If(Rc<Node>, Span, Option<Rc<Node>>),
    Return(Rc<Node>),
}

/// A name that a function takes.
#[derive(Debug)]
pub(super) struct Param {
    pub name: String,
    /// The argument.
    pub at: usize,
    /// The member of it, in a pattern.
    pub key: Option<String>,
    /// What it is where nothing is given: a default, or the first of the values that its type names.
    pub plain: Option<Rc<Node>>,
}

/// The tokens of a part of a file, with places in the file.
pub(super) fn part(file: &SourceFile, span: Span) -> (Vec<Token<'_>>, Vec<Span>) {
    let (mut found, mut places) = tokens(file.slice(span), Language::JavaScript);
    let moved = |place: Span| Span::new(place.start + span.start, place.end + span.start);
    for token in &mut found {
        if let Token::String { place, inner, .. } = token {
            (*place, *inner) = (moved(*place), moved(*inner));
        }
    }
    places.iter_mut().for_each(|place| *place = moved(*place));
    (found, places)
}

/// Reads expressions from tokens.
pub(super) struct Reader<'a, 't> {
    pub file: &'a SourceFile,
    pub tokens: &'a [Token<'t>],
    pub places: &'a [Span],
    /// The next token.
    pub at: usize,
    depth: usize,
}

/// Operators between two operands, those that bind least first.
const BINARY: [&[&str]; 7] = [
    &["??", "||"],
    &["&&"],
    &["===", "!==", "==", "!="],
    &["<=", ">=", "<", ">"],
    &["<<", ">>"],
    &["+", "-"],
    &["*", "/", "%"],
];

impl<'a, 't> Reader<'a, 't> {
    pub(super) fn new(file: &'a SourceFile, tokens: &'a [Token<'t>], places: &'a [Span], at: usize) -> Self {
        Self { file, tokens, places, at, depth: 0 }
    }

    fn mark(&self, at: usize) -> Option<char> {
        match self.tokens.get(at)? {
            Token::Mark(c) => Some(*c),
            Token::Word(_) | Token::String { .. } => None,
        }
    }

    fn word(&self, at: usize) -> Option<&'t str> {
        match self.tokens.get(at)? {
            Token::Word(word) => Some(word),
            Token::Mark(_) | Token::String { .. } => None,
        }
    }

    fn takes(&mut self, mark: char) -> bool {
        let there = self.mark(self.at) == Some(mark);
        self.at += usize::from(there);
        there
    }

    /// True for an arrow at a token.
    fn is_arrow(&self, at: usize) -> bool {
        self.mark(at) == Some('=') && self.mark(at + 1) == Some('>') && self.touch(at)
    }

    fn touch(&self, at: usize) -> bool {
        matches!((self.places.get(at), self.places.get(at + 1)), (Some(a), Some(b)) if a.end == b.start)
    }

    /// Behind the bracket that closes the one at a token.
    pub(super) fn behind(&self, open: usize) -> usize {
        let mut depth = 0_usize;
        for at in open..self.tokens.len() {
            match self.mark(at) {
                Some('(' | '[' | '{') => depth += 1,
                Some(')' | ']' | '}') => depth = depth.saturating_sub(1),
                _ => {}
            }
            if depth == 0 {
                return at + 1;
            }
        }
        self.tokens.len()
    }

    /// The expression at the next token. What cannot be read is passed over up to the end of its element.
    pub(super) fn expression(&mut self) -> Rc<Node> {
        if self.depth >= DEEPEST {
            self.skip();
            return Rc::new(Node::Unknown);
        }
        self.depth += 1;
        let found = self.choice();
        self.depth -= 1;
        let ends = |c: char| ",;)]}:".contains(c);
        match (found, self.tokens.get(self.at)) {
            (Some(node), None) => node,
            (Some(node), Some(Token::Mark(c))) if ends(*c) => node,
            // The next statement, where none is marked.
            (Some(node), Some(_)) if self.is_new_line() => node,
            _ => {
                self.skip();
                Rc::new(Node::Unknown)
            }
        }
    }

    /// The place of the tokens from one on.
    fn span(&self, start: usize) -> Span {
        let place = |at: usize| self.places.get(at).copied().unwrap_or_default();
        place(start).to(place(self.at.saturating_sub(1).max(start)))
    }

    fn is_new_line(&self) -> bool {
        let pair = self.at.checked_sub(1).and_then(|before| self.places.get(before)).zip(self.places.get(self.at));
        pair.is_some_and(|(a, b)| self.file.slice(Span::new(a.end, b.start.max(a.end))).contains('\n'))
    }

    fn skip(&mut self) {
        while let Some(token) = self.tokens.get(self.at) {
            match token {
                Token::Mark('(' | '[' | '{') => self.at = self.behind(self.at),
                Token::Mark(',' | ';' | ')' | ']' | '}') => return,
                _ => self.at += 1,
            }
        }
    }

    fn choice(&mut self) -> Option<Rc<Node>> {
        let start = self.at;
        let condition = self.binary(0)?;
        let place = self.span(start);
        if self.mark(self.at) != Some('?') || matches!(self.mark(self.at + 1), Some('.' | '?')) {
            return Some(condition);
        }
        self.at += 1;
        let then = self.expression();
        self.takes(':').then_some(())?;
        let other = self.expression();
        Some(Rc::new(Node::Choice(condition, place, then, other)))
    }

    fn binary(&mut self, level: usize) -> Option<Rc<Node>> {
        let Some(own) = BINARY.get(level) else { return self.unary() };
        let mut left = self.binary(level + 1)?;
        while let Some(op) = self.operator().filter(|op| own.contains(op)) {
            self.at += op.len();
            let right = self.binary(level + 1)?;
            left = Rc::new(Node::Binary(op, left, right));
        }
        Some(left)
    }

    /// The operator at the next token: the longest one. None for one that writes.
    fn operator(&self) -> Option<&'static str> {
        let mut length = 0;
        while length < 4 && self.mark(self.at + length).is_some_and(|c| "?|&=!<>+-*/%".contains(c)) {
            length += 1;
            if !self.touch(self.at + length - 1) {
                break;
            }
        }
        let written: String = (0..length).filter_map(|k| self.mark(self.at + k)).collect();
        // A sign may stand behind the operator.
        let all = BINARY.iter().flat_map(|level| level.iter()).copied();
        all.filter(|op| written.strip_prefix(op).is_some_and(|rest| ["", "-", "+", "!"].contains(&rest)))
            .max_by_key(|op| op.len())
    }

    fn unary(&mut self) -> Option<Rc<Node>> {
        if let Some(c @ ('-' | '+' | '!')) = self.mark(self.at) {
            self.at += 1;
            self.depth += 1;
            (self.depth < DEEPEST).then_some(())?;
            let operand = self.unary()?;
            self.depth -= 1;
            return Some(Rc::new(Node::Unary(c, operand)));
        }
        self.postfix()
    }

    fn postfix(&mut self) -> Option<Rc<Node>> {
        let mut node = self.primary()?;
        loop {
            if self.mark(self.at) == Some('?') && self.mark(self.at + 1) == Some('.') && self.touch(self.at) {
                self.at += 1;
                continue;
            }
            match self.tokens.get(self.at) {
                Some(Token::Mark('.')) => {
                    let name = self.word(self.at + 1)?;
                    self.at += 2;
                    node = Rc::new(Node::Member(node, name.to_owned()));
                }
                Some(Token::Mark('!')) if self.mark(self.at + 1) != Some('=') => self.at += 1,
                Some(Token::Mark('[')) => {
                    self.at += 1;
                    let index = self.expression();
                    self.takes(']').then_some(())?;
                    node = Rc::new(Node::Index(node, index));
                }
                Some(Token::Mark('(')) => node = Rc::new(Node::Call(node, self.elements())),
                Some(Token::Word("as" | "satisfies")) => {
                    self.at += 1;
                    self.skip_type();
                }
                // `wgsl` in front of a text changes nothing of it.
                Some(Token::String { inner, form: Form::Template, .. }) => {
                    let tag = match &*node {
                        Node::Name(name) => name.as_str(),
                        Node::Member(_, name) => name.as_str(),
                        _ => return None,
                    };
                    ["wgsl", "shader", "code", "raw"].contains(&tag).then_some(())?;
                    let form = if tag == "raw" { Form::RawTemplate } else { Form::Template };
                    node = Rc::new(Node::String(*inner, form));
                    self.at += 1;
                }
                _ => return Some(node),
            }
        }
    }

    /// Passes over a type.
    fn skip_type(&mut self) {
        let (mut depth, start) = (0_usize, self.at);
        for _ in 0..LONGEST_TYPE {
            let goes_on = self.at == start || self.mark(self.at - 1).is_some_and(|c| "|&<,:>=".contains(c));
            match self.tokens.get(self.at) {
                // The body behind what a function gives.
                Some(Token::Mark('{')) if depth == 0 && !goes_on => return,
                None | Some(Token::Mark(',' | ';' | ')' | ']' | '}' | '=' | '?')) if depth == 0 => return,
                Some(Token::Word("as" | "satisfies")) if depth == 0 => return,
                Some(Token::Mark('(' | '[' | '{')) => {
                    self.at = self.behind(self.at);
                    continue;
                }
                Some(Token::Mark('<')) => depth += 1,
                Some(Token::Mark('>')) => depth = depth.saturating_sub(1),
                None => return,
                Some(_) => {}
            }
            self.at += 1;
            if depth == 0 && self.is_new_line() && self.word(self.at).is_some() {
                return;
            }
        }
    }

    fn primary(&mut self) -> Option<Rc<Node>> {
        let at = self.at;
        if matches!(self.word(at), Some("async")) {
            return None;
        }
        match *self.tokens.get(at)? {
            Token::String { inner, form, .. } => {
                self.at += 1;
                Some(Rc::new(Node::String(inner, form)))
            }
            Token::Mark('(') => {
                if let Some(arrow) = self.arrow_behind(at) {
                    return Some(self.arrow(at, arrow));
                }
                self.at += 1;
                let node = self.expression();
                self.takes(')').then_some(node)
            }
            Token::Mark('[') => Some(Rc::new(Node::List(self.elements()))),
            Token::Mark('{') => Some(self.object()),
            Token::Mark('.') => self.number(),
            Token::Mark(_) => None,
            Token::Word(word) if word.starts_with(|c: char| c.is_ascii_digit()) => self.number(),
            Token::Word("function") => {
                let open = at + if self.mark(at + 1) == Some('(') { 1 } else { 2 };
                (self.mark(open) == Some('(')).then(|| self.function(open))
            }
            Token::Word("new" | "await" | "typeof" | "class" | "this" | "void" | "yield") => None,
            Token::Word(word) => {
                if self.is_arrow(at + 1) {
                    let param = Param { name: word.to_owned(), at: 0, key: None, plain: None };
                    self.at += 3;
                    return Some(self.body(vec![param]));
                }
                self.at += 1;
                Some(Rc::new(match word {
                    "true" | "false" => Node::Truth(word == "true"),
                    "undefined" | "null" => Node::Nothing,
                    _ => Node::Name(word.to_owned()),
                }))
            }
        }
    }

    /// A number, whose tokens are those of its digits and points.
    fn number(&mut self) -> Option<Rc<Node>> {
        let start = self.places.get(self.at)?.start;
        let text = &self.file.text()[start..];
        let hex = text.starts_with("0x") || text.starts_with("0X");
        let mut before = ' ';
        let length = text.find(|c: char| {
            let sign = !hex && matches!(before, 'e' | 'E') && matches!(c, '+' | '-');
            before = c;
            !(c.is_ascii_alphanumeric() || c == '_' || (c == '.' && !hex) || sign)
        });
        let end = start + length.unwrap_or(text.len());
        while self.places.get(self.at).is_some_and(|place| place.start < end) {
            self.at += 1;
        }
        let plain: String = self.file.text()[start..end].chars().filter(|c| *c != '_').collect();
        let radix = |prefix: &str, radix: u32| {
            let digits = plain.strip_prefix(prefix)?;
            u32::from_str_radix(digits, radix).ok().map(f64::from)
        };
        let value = radix("0x", 16).or_else(|| radix("0b", 2)).or_else(|| radix("0o", 8));
        value.or_else(|| plain.parse().ok()).map(|value| Rc::new(Node::Number(value)))
    }

    /// Expressions between brackets, the first of which is the next token.
    fn elements(&mut self) -> Vec<Rc<Node>> {
        let end = self.behind(self.at);
        let mut found = Vec::new();
        self.at += 1;
        while self.at + 1 < end {
            found.push(self.expression());
            if !self.takes(',') && self.at + 1 < end {
                // More than an element.
                found.pop();
                found.push(Rc::new(Node::Unknown));
                self.skip();
                if !self.takes(',') {
                    break;
                }
            }
        }
        self.at = end;
        found
    }

    fn object(&mut self) -> Rc<Node> {
        let end = self.behind(self.at);
        let mut found: Vec<(String, Rc<Node>)> = Vec::new();
        self.at += 1;
        while self.at + 1 < end {
            let key = match self.tokens.get(self.at) {
                Some(Token::Word(word)) => Some((*word).to_owned()),
                Some(Token::String { inner, .. }) => Some(self.file.slice(*inner).to_owned()),
                _ => None,
            };
            match (key, self.mark(self.at + 1)) {
                (Some(key), Some(':')) => {
                    self.at += 2;
                    let value = self.expression();
                    found.push((key, value));
                }
                // `get name() { return …; }`
                (Some(get), None) if get == "get" && self.mark(self.at + 2) == Some('(') => {
                    let name = self.word(self.at + 1).unwrap_or_default().to_owned();
                    let function = self.function(self.at + 2);
                    found.push((name, Rc::new(Node::Call(function, Vec::new()))));
                }
                (Some(key), Some('(')) => {
                    let function = self.function(self.at + 1);
                    found.push((key, function));
                }
                (Some(key), Some(',' | '}')) => {
                    self.at += 1;
                    found.push((key.clone(), Rc::new(Node::Name(key))));
                }
                // What is spread may have any key, and what stands in front of it another value then.
                _ => found.iter_mut().for_each(|(_, value)| *value = Rc::new(Node::Unknown)),
            }
            self.skip();
            if !self.takes(',') {
                break;
            }
        }
        self.at = end;
        Rc::new(Node::Object(found))
    }

    /// Where the arrow stands behind the parameters that a parenthesis opens.
    fn arrow_behind(&self, open: usize) -> Option<usize> {
        let end = self.behind(open);
        if self.is_arrow(end) {
            return Some(end);
        }
        (self.mark(end) == Some(':')).then_some(())?;
        let mut ahead = Self { at: end + 1, ..*self };
        ahead.skip_type();
        self.is_arrow(ahead.at).then_some(ahead.at)
    }

    fn arrow(&mut self, open: usize, arrow: usize) -> Rc<Node> {
        let params = self.params(open);
        self.at = arrow + 2;
        self.body(params)
    }

    /// A function whose parameters begin at a parenthesis, with a body in braces.
    pub(super) fn function(&mut self, open: usize) -> Rc<Node> {
        let params = self.params(open);
        self.at = self.behind(open);
        if self.takes(':') {
            self.skip_type();
        }
        if self.mark(self.at) == Some('{') { self.body(params) } else { Rc::new(Node::Unknown) }
    }

    /// The names between parentheses.
    pub(super) fn params(&mut self, open: usize) -> Vec<Param> {
        let (end, mut found, mut count) = (self.behind(open), Vec::new(), 0);
        self.at = open + 1;
        while self.at + 1 < end {
            if self.mark(self.at) == Some('{') {
                let close = self.behind(self.at);
                self.at += 1;
                while self.at + 1 < close {
                    found.extend(self.param(count, true));
                    self.skip();
                    self.at += 1;
                }
                self.at = close;
            } else {
                found.extend(self.param(count, false));
            }
            self.skip();
            self.at += 1;
            count += 1;
        }
        found
    }

    fn param(&mut self, at: usize, in_pattern: bool) -> Option<Param> {
        let key = self.word(self.at)?.to_owned();
        self.at += 1;
        let mut name = key.clone();
        let mut plain = None;
        if in_pattern {
            if self.takes(':') {
                self.word(self.at)?.clone_into(&mut name);
                self.at += 1;
            }
        } else {
            self.takes('?');
            if self.takes(':') {
                // `access: 'read' | 'read_write'`
                if let Some(Token::String { inner, form, .. }) = self.tokens.get(self.at) {
                    plain = Some(Rc::new(Node::String(*inner, *form)));
                }
                self.skip_type();
            }
        }
        if self.mark(self.at) == Some('=') {
            self.at += 1;
            plain = Some(self.expression());
        }
        Some(Param { name, at, key: in_pattern.then_some(key), plain })
    }

    /// What a function does: an expression, or constants and what it returns, under conditions as well.
    fn body(&mut self, params: Vec<Param>) -> Rc<Node> {
        if self.mark(self.at) != Some('{') {
            let steps = vec![Step::Return(self.expression())];
            return Rc::new(Node::Function(Rc::new(Function { params, steps })));
        }
        let end = self.behind(self.at);
        self.at += 1;
        let mut steps = Vec::new();
        while self.at + 1 < end && self.step(&mut steps).is_some() {
            self.takes(';');
        }
        self.at = end;
        Rc::new(Node::Function(Rc::new(Function { params, steps })))
    }

    /// Reads a statement; none behind the last one that is read.
    fn step(&mut self, steps: &mut Vec<Step>) -> Option<()> {
        match self.word(self.at)? {
            "const" => {
                self.at += 1;
                if let Some(name) = self.word(self.at) {
                    self.at += 1;
                    if self.takes(':') {
                        self.skip_type();
                    }
                    let value = if self.takes('=') { self.expression() } else { Rc::new(Node::Unknown) };
                    steps.push(Step::Constant(name.to_owned(), value));
                    return Some(());
                }
                // Names of a pattern.
                let end = self.behind(self.at);
                let names = (self.at..end).filter_map(|at| self.word(at));
                steps.extend(names.map(|name| Step::Constant(name.to_owned(), Rc::new(Node::Unknown))));
                self.at = end;
                self.skip();
                Some(())
            }
            "return" => {
                self.at += 1;
                steps.push(Step::Return(self.expression()));
                None
            }
            "if" if self.mark(self.at + 1) == Some('(') => {
                let start = self.at + 2;
                self.at = start;
                let condition = self.expression();
                let place = self.span(start);
                self.takes(')').then_some(())?;
                let block = self.takes('{');
                let result = match self.word(self.at) {
                    Some("return") => {
                        self.at += 1;
                        Some(self.expression())
                    }
                    Some("throw") => {
                        self.at += 1;
                        self.skip();
                        None
                    }
                    _ => return None,
                };
                self.takes(';');
                (!block || self.takes('}')).then_some(())?;
                (self.word(self.at) != Some("else")).then_some(())?;
                steps.push(Step::If(condition, place, result));
                Some(())
            }
            _ => None,
        }
    }
}
