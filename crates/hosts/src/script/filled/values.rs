//! What constant expressions come to: texts with the places of their parts, numbers, and what is kept as it is written.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use base::text::{Assembly, SourceFile, Span};

use super::files::Files;
use super::syntax::{Node, Param, Reader, Step, part};
use crate::Literal;
use crate::script::language::Form;
use crate::script::strings::holes;

/// Values within values that are followed.
const DEEPEST: usize = 40;

/// Expressions that are worked out for one file.
const MOST_STEPS: usize = 40_000;

/// Bytes of one text.
const LONGEST: usize = 1 << 19;

/// Marks around the number of a hole whose value is unknown. They stand in no text.
pub(super) const OPEN: (char, char) = ('\u{F0000}', '\u{F0001}');

/// A value.
#[derive(Clone)]
pub(super) enum Value {
    Text(SourceFile),
    Number(f64),
    Truth(bool),
    Nothing,
    /// An object, a list or a function, and where its names are looked up.
    Kept(Rc<Node>, Scope),
    /// All that a file exports.
    File(usize),
}

/// Where names are looked up.
#[derive(Clone)]
pub(super) struct Scope {
    pub file: usize,
    pub frame: Option<Rc<Frame>>,
}

/// Names of a function.
pub(super) struct Frame {
    names: RefCell<Vec<Named>>,
    outer: Option<Rc<Self>>,
}

struct Named {
    name: String,
    /// None where it is not known.
    value: Option<Value>,
    /// What to tell where the value is used, and is assumed.
    note: Option<String>,
}

impl Frame {
    /// No names, within those of another.
    pub(super) fn within(outer: Option<Rc<Self>>) -> Rc<Self> {
        Rc::new(Self { names: RefCell::default(), outer })
    }

    /// Adds a name; its value is unknown where there is none.
    pub(super) fn add(&self, name: &str, value: Option<Value>) {
        self.names.borrow_mut().push(Named { name: name.to_owned(), value, note: None });
    }

    /// The value of a name, which may be unknown, and what to tell of it; none where this and all around it lack the name.
    fn value(&self, name: &str) -> Option<(Option<Value>, Option<String>)> {
        let names = self.names.borrow();
        let own = names.iter().rev().find(|own| own.name == name).map(|own| (own.value.clone(), own.note.clone()));
        own.or_else(|| self.outer.as_ref()?.value(name))
    }
}

/// A hole whose value is unknown.
pub(super) struct Open {
    /// What stands in it.
    pub written: String,
    /// Its place.
    pub file: SourceFile,
    pub span: Span,
}

/// Works out expressions of files.
pub(super) struct Values<'f> {
    pub files: &'f Files,
    pub open: RefCell<Vec<Open>>,
    /// What to tell of what is taken for known.
    pub assumed: RefCell<Vec<String>>,
    /// Strings that were read, by their file and place.
    pub used: RefCell<Vec<(usize, Span)>>,
    steps: Cell<usize>,
}

impl<'f> Values<'f> {
    pub(super) fn new(files: &'f Files) -> Self {
        Self {
            files,
            open: RefCell::default(),
            assumed: RefCell::default(),
            used: RefCell::default(),
            steps: Cell::new(0),
        }
    }

    /// What an expression comes to.
    pub(super) fn value(&self, node: &Rc<Node>, scope: &Scope, depth: usize) -> Option<Value> {
        self.steps.set(self.steps.get() + 1);
        if depth > DEEPEST || self.steps.get() > MOST_STEPS {
            return None;
        }
        let of = |node: &Rc<Node>| self.value(node, scope, depth + 1);
        match &**node {
            Node::Number(value) => Some(Value::Number(*value)),
            Node::Truth(value) => Some(Value::Truth(*value)),
            Node::Nothing => Some(Value::Nothing),
            Node::Object(_) | Node::List(_) | Node::Function(_) => Some(Value::Kept(node.clone(), scope.clone())),
            Node::String(inner, form) => self.text(*inner, *form, scope, depth).map(Value::Text),
            Node::Name(name) => self.name(name, scope, depth),
            Node::Member(object, key) => match &**object {
                Node::Name(name) if name == "Math" => constant(key),
                _ => self.member(&of(object)?, key, depth),
            },
            Node::Index(object, index) => match (of(object)?, of(index)?) {
                (Value::Kept(list, own), Value::Number(index)) => match &*list {
                    Node::List(all) => self.value(all.get(whole(index)?)?, &own, depth + 1),
                    _ => None,
                },
                (object, Value::Text(key)) => self.member(&object, key.text(), depth),
                _ => None,
            },
            Node::Call(callee, args) => self.call(callee, args, scope, depth),
            Node::Unary('!', operand) => Some(Value::Truth(!truth(&of(operand)?)?)),
            Node::Unary(sign, operand) => match of(operand)? {
                Value::Number(value) => Some(Value::Number(if *sign == '-' { -value } else { value })),
                _ => None,
            },
            Node::Binary("||", left, right) => of(left).and_then(|left| match truth(&left)? {
                true => Some(left),
                false => of(right),
            }),
            Node::Binary("&&", left, right) => of(left).and_then(|left| match truth(&left)? {
                true => of(right),
                false => Some(left),
            }),
            Node::Binary("??", left, right) => of(left).and_then(|left| match left {
                Value::Nothing => of(right),
                _ => Some(left),
            }),
            Node::Binary(op, left, right) => binary(op, &of(left)?, &of(right)?),
            Node::Choice(condition, place, then, other) => match of(condition).as_ref().and_then(truth) {
                Some(true) => of(then),
                Some(false) => of(other),
                None => self.either((condition, *place), scope, &|| of(then), &|| of(other)),
            },
            Node::Unknown => None,
        }
    }

    /// The value of a name where it stands.
    pub(super) fn name(&self, name: &str, scope: &Scope, depth: usize) -> Option<Value> {
        if let Some((known, note)) = scope.frame.as_ref().and_then(|frame| frame.value(name)) {
            note.into_iter().for_each(|note| self.assume(note));
            return known;
        }
        if depth > DEEPEST {
            return None;
        }
        if let Some(node) = self.files.declared(scope.file, name) {
            return self.value(&node, &Scope { file: scope.file, frame: None }, depth + 1);
        }
        let import = self.files.import(scope.file, name)?;
        let file = self.files.linked(scope.file, &import.path)?;
        match (self.files.plain_text(file), import.name) {
            (Some(text), _) => Some(Value::Text(text.clone())),
            (None, None) => Some(Value::File(file)),
            (None, Some(name)) => self.exported(file, &name, depth + 1),
        }
    }

    /// What a file exports under a name.
    fn exported(&self, file: usize, name: &str, depth: usize) -> Option<Value> {
        if depth > DEEPEST {
            return None;
        }
        let scope = Scope { file, frame: None };
        if let Some(own) = self.files.exported_as(file, name) {
            let Some(path) = own.path else { return self.name(&own.name, &scope, depth + 1) };
            return self.exported(self.files.linked(file, &path)?, &own.name, depth + 1);
        }
        if let Some(node) = self.files.declared(file, name) {
            return self.value(&node, &scope, depth + 1);
        }
        let all = self.files.passed_on(file);
        all.iter().find_map(|path| self.exported(self.files.linked(file, path)?, name, depth + 1))
    }

    fn member(&self, object: &Value, key: &str, depth: usize) -> Option<Value> {
        match object {
            Value::File(file) => self.exported(*file, key, depth + 1),
            Value::Kept(node, scope) => match &**node {
                Node::Object(all) => {
                    let (_, value) = all.iter().rev().find(|(known, _)| known == key)?;
                    self.value(value, scope, depth + 1)
                }
                Node::List(all) if key == "length" => Some(Value::Number(f64::from(u32::try_from(all.len()).ok()?))),
                _ => None,
            },
            _ => None,
        }
    }

    fn call(&self, callee: &Rc<Node>, args: &[Rc<Node>], scope: &Scope, depth: usize) -> Option<Value> {
        let of = |node: &Rc<Node>| self.value(node, scope, depth + 1);
        if let Node::Member(object, method) = &**callee {
            if let Node::Name(name) = &**object {
                match (name.as_str(), method.as_str()) {
                    ("Math", _) => return of_numbers(method, &self.numbers(args, scope, depth)?),
                    ("Object", "freeze") => return of(args.first()?),
                    _ => {}
                }
            }
            match (of(object), method.as_str()) {
                (Some(Value::Text(text)), "trim" | "toString" | "trimStart" | "trimEnd") => {
                    return Some(Value::Text(text));
                }
                (Some(number @ Value::Number(_)), "toString") if args.is_empty() => return Some(number),
                (Some(Value::Number(number)), "toFixed") => {
                    let digits = self.numbers(args, scope, depth)?.first().copied().and_then(whole).unwrap_or(0);
                    let written = format!("{number:.*}", digits.min(20));
                    return Some(Value::Text(SourceFile::new("", written)));
                }
                (Some(Value::Kept(list, own)), "join") => return self.joined(&list, &own, args.first(), scope, depth),
                _ => {}
            }
        }
        if matches!(&**callee, Node::Name(name) if name == "String") {
            return of(args.first()?);
        }
        let Value::Kept(node, own) = of(callee)? else { return None };
        let Node::Function(function) = &*node else { return None };
        let given: Vec<Option<Value>> = args.iter().map(of).collect();
        let frame = self.frame(&function.params, &given, own.frame.clone(), own.file, depth);
        self.result(&function.steps, &Scope { file: own.file, frame: Some(frame) }, depth)
    }

    /// The names of a function with arguments; with those that their declarations say, where its caller is not seen.
    pub(super) fn frame(
        &self,
        params: &[Param],
        given: &[Option<Value>],
        outer: Option<Rc<Frame>>,
        file: usize,
        depth: usize,
    ) -> Rc<Frame> {
        let is_open = given.is_empty();
        let frame = Frame::within(outer);
        for param in params {
            let given = match (given.get(param.at).cloned(), &param.key) {
                (Some(argument), Some(key)) => argument.map(|argument| self.member(&argument, key, depth)),
                (argument, _) => argument,
            };
            let (value, note) = match given {
                Some(Some(Value::Nothing)) | None => {
                    let scope = Scope { file, frame: Some(frame.clone()) };
                    let value = param.plain.as_ref().and_then(|plain| self.value(plain, &scope, depth + 1));
                    let written = value.as_ref().and_then(text_of).map(|text| text.text().to_owned());
                    let called = self.files.file(file).map(SourceFile::name).unwrap_or_default();
                    let note = written.map(|written| format!("`{}` of {called} is taken for `{written}`", param.name));
                    (value, note.filter(|_| is_open))
                }
                Some(value) => (value, None),
            };
            frame.names.borrow_mut().push(Named { name: param.name.clone(), value, note });
        }
        frame
    }

    /// What a function returns.
    fn result(&self, steps: &[Step], scope: &Scope, depth: usize) -> Option<Value> {
        let (first, rest) = steps.split_first()?;
        match first {
            Step::Constant(name, value) => {
                let value = self.value(value, scope, depth + 1);
                if let Some(frame) = &scope.frame {
                    frame.add(name, value);
                }
                self.result(rest, scope, depth)
            }
            Step::Return(value) => self.value(value, scope, depth + 1),
            Step::If(condition, place, result) => {
                let then = || self.value(result.as_ref()?, scope, depth + 1);
                let other = || self.result(rest, scope, depth);
                match self.value(condition, scope, depth + 1).as_ref().and_then(truth) {
                    Some(true) => then(),
                    Some(false) => other(),
                    None if result.is_none() => other(),
                    None => self.either((condition, *place), scope, &then, &other),
                }
            }
        }
    }

    /// One of two values, under a condition that is not known: the one where what it asks for is not so, or else the one that
    /// is known.
    fn either(
        &self,
        (condition, place): (&Node, Span),
        scope: &Scope,
        then: &dyn Fn() -> Option<Value>,
        other: &dyn Fn() -> Option<Value>,
    ) -> Option<Value> {
        let (first, second) = if denies(condition) { (then, other) } else { (other, then) };
        let (value, taken) = match first() {
            Some(value) => (value, denies(condition)),
            None => (second()?, !denies(condition)),
        };
        if let Some(file) = self.files.file(scope.file) {
            let written = file.slice(place).split_whitespace().collect::<Vec<_>>().join(" ");
            self.assume(format!("`{written}` at {} is not known, and taken for {taken}", file.locate(place.start)));
        }
        Some(value)
    }

    fn assume(&self, note: String) {
        let mut assumed = self.assumed.borrow_mut();
        if !assumed.contains(&note) {
            assumed.push(note);
        }
    }

    fn numbers(&self, args: &[Rc<Node>], scope: &Scope, depth: usize) -> Option<Vec<f64>> {
        let number = |node| match self.value(node, scope, depth + 1)? {
            Value::Number(value) => Some(value),
            _ => None,
        };
        args.iter().map(number).collect()
    }

    /// `[…].join('\n')`
    fn joined(
        &self,
        list: &Rc<Node>,
        own: &Scope,
        between: Option<&Rc<Node>>,
        scope: &Scope,
        depth: usize,
    ) -> Option<Value> {
        let Node::List(all) = &**list else { return None };
        let between = match between {
            None => SourceFile::new("", ","),
            Some(node) => text_of(&self.value(node, scope, depth + 1)?)?,
        };
        let mut out = Assembly::new();
        for (at, node) in all.iter().enumerate() {
            if at > 0 {
                copy(&mut out, &between);
            }
            copy(&mut out, &text_of(&self.value(node, own, depth + 1)?)?);
        }
        Some(Value::Text(out.finish("")))
    }

    /// The text of a string, with the values of what is filled in. A value that is unknown is [`OPEN`].
    pub(super) fn text(&self, inner: Span, form: Form, scope: &Scope, depth: usize) -> Option<SourceFile> {
        let file = self.files.file(scope.file)?;
        self.used.borrow_mut().push((scope.file, inner));
        let mut out = Assembly::new();
        if form != Form::Template {
            let mut literal = Literal::default();
            match form {
                Form::Raw | Form::RawTemplate => literal.verbatim_raw(file, inner),
                _ => escaped(&mut literal, file, inner)?,
            }
            return Some(literal.assembled(file, file.name()));
        }
        let (text, mut at, mut length) = (file.slice(inner), 0, 0);
        loop {
            let hole = holes(text, at).next();
            let end = hole.map_or(text.len(), |hole| hole.start);
            let mut literal = Literal::default();
            escaped(&mut literal, file, Span::new(inner.start + at, inner.start + end))?;
            copy(&mut out, &literal.assembled(file, file.name()));
            let Some(hole) = hole else { return Some(out.finish(file.name())) };
            let place = Span::new(inner.start + hole.start, inner.start + hole.end);
            let within = Span::new(place.start + 2, place.end.saturating_sub(1).max(place.start + 2));
            let value = self.value(&self.hole(file, within), scope, depth + 1);
            match value.as_ref().and_then(text_of) {
                Some(known) => {
                    length += known.text().len();
                    (length <= LONGEST).then_some(())?;
                    if known.is_assembled() || !known.name().is_empty() {
                        copy(&mut out, &known);
                    } else {
                        out.replace(known.text(), file, place);
                    }
                }
                None => {
                    let mut open = self.open.borrow_mut();
                    let written = file.slice(within).split_whitespace().collect::<Vec<_>>().join(" ");
                    out.replace(&format!("{}{}{}", OPEN.0, open.len(), OPEN.1), file, place);
                    open.push(Open { written, file: file.clone(), span: place });
                }
            }
            at = hole.end;
        }
    }

    fn hole(&self, file: &SourceFile, within: Span) -> Rc<Node> {
        let (tokens, places) = part(file, within);
        let mut reader = Reader::new(file, &tokens, &places, 0);
        let node = reader.expression();
        if reader.at < tokens.len() { Rc::new(Node::Unknown) } else { node }
    }
}

/// True for a condition that is true where what it asks for is not so.
fn denies(condition: &Node) -> bool {
    match condition {
        Node::Unary('!', inner) => !denies(inner),
        Node::Binary("!==" | "!=", ..) => true,
        _ => false,
    }
}

/// The text that a value is written as; none for an object.
fn text_of(value: &Value) -> Option<SourceFile> {
    match value {
        Value::Text(text) => Some(text.clone()),
        Value::Number(number) if number.is_finite() => Some(SourceFile::new("", number.to_string())),
        Value::Truth(truth) => Some(SourceFile::new("", truth.to_string())),
        Value::Number(_) | Value::Nothing | Value::Kept(..) | Value::File(_) => None,
    }
}

/// Adds a part of a string. Before most characters, a backslash means nothing in JavaScript.
fn escaped(literal: &mut Literal, file: &SourceFile, span: Span) -> Option<()> {
    let text = file.slice(span);
    let mut at = 0;
    while let Some(start) = text[at..].find('\\').map(|offset| at + offset) {
        let next = text[start + 1..].chars().next()?;
        let end = start + 1 + next.len_utf8();
        let host = |from: usize, to: usize| Span::new(span.start + from, span.start + to);
        if "ntr\"'`\\\n\r".contains(next) {
            literal.escaped(file, host(at, end))?;
        } else {
            (!"xubfv".contains(next) && !next.is_ascii_digit()).then_some(())?;
            literal.escaped(file, host(at, start))?;
            literal.made(&next.to_string(), host(start, end));
        }
        at = end;
    }
    literal.escaped(file, Span::new(span.start + at, span.end))
}

fn copy(out: &mut Assembly, text: &SourceFile) {
    out.copy(text, Span::new(0, text.text().len()));
}

fn whole(number: f64) -> Option<usize> {
    let fits = number.fract() == 0.0 && (0.0..=65536.0).contains(&number);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it fits")]
    fits.then_some(number as usize)
}

fn has_open(text: &SourceFile) -> bool {
    text.text().contains(OPEN.0)
}

fn truth(value: &Value) -> Option<bool> {
    match value {
        Value::Text(text) if has_open(text) => None,
        Value::Text(text) => Some(!text.text().is_empty()),
        Value::Number(number) => Some(*number != 0.0),
        Value::Truth(truth) => Some(*truth),
        Value::Nothing => Some(false),
        Value::Kept(..) | Value::File(_) => Some(true),
    }
}

fn binary(op: &str, left: &Value, right: &Value) -> Option<Value> {
    if let "===" | "==" | "!==" | "!=" = op {
        let same = match (left, right) {
            (Value::Text(a), Value::Text(b)) if !has_open(a) && !has_open(b) => a.text() == b.text(),
            (Value::Number(a), Value::Number(b)) => a == b,
            (Value::Truth(a), Value::Truth(b)) => a == b,
            (Value::Nothing, Value::Nothing) => true,
            (Value::Nothing, Value::Text(_) | Value::Number(_) | Value::Kept(..))
            | (Value::Text(_) | Value::Number(_) | Value::Kept(..), Value::Nothing) => false,
            _ => return None,
        };
        return Some(Value::Truth(same == op.starts_with('=')));
    }
    if let ("+", true) = (op, matches!(left, Value::Text(_)) || matches!(right, Value::Text(_))) {
        let mut out = Assembly::new();
        let (left, right) = (text_of(left)?, text_of(right)?);
        (left.text().len() + right.text().len() <= LONGEST).then_some(())?;
        copy(&mut out, &left);
        copy(&mut out, &right);
        return Some(Value::Text(out.finish("")));
    }
    let (Value::Number(a), Value::Number(b)) = (left, right) else { return None };
    let (a, b) = (*a, *b);
    Some(match op {
        "+" => Value::Number(a + b),
        "-" => Value::Number(a - b),
        "*" => Value::Number(a * b),
        "/" => Value::Number(a / b),
        "%" => Value::Number(a % b),
        "<" => Value::Truth(a < b),
        ">" => Value::Truth(a > b),
        "<=" => Value::Truth(a <= b),
        ">=" => Value::Truth(a >= b),
        "<<" | ">>" => Value::Number(shifted(op, a, b)?),
        _ => return None,
    })
}

/// A shift of a number of 32 bits.
fn shifted(op: &str, a: f64, b: f64) -> Option<f64> {
    let fits = a.fract() == 0.0 && a.abs() < f64::from(1_u32 << 31);
    let by = u32::try_from(whole(b)?).ok().filter(|by| *by < 32 && fits)?;
    #[expect(clippy::cast_possible_truncation, reason = "it fits")]
    let a = a as i32;
    Some(f64::from(if op == "<<" { a.wrapping_shl(by) } else { a >> by }))
}

/// A constant of `Math`.
fn constant(name: &str) -> Option<Value> {
    use std::f64::consts;
    Some(Value::Number(match name {
        "PI" => consts::PI,
        "E" => consts::E,
        "SQRT2" => consts::SQRT_2,
        "SQRT1_2" => consts::FRAC_1_SQRT_2,
        "LN2" => consts::LN_2,
        "LN10" => consts::LN_10,
        "LOG2E" => consts::LOG2_E,
        "LOG10E" => consts::LOG10_E,
        _ => return None,
    }))
}

/// A function of `Math`.
fn of_numbers(name: &str, args: &[f64]) -> Option<Value> {
    let first = *args.first()?;
    Some(Value::Number(match name {
        "max" => args.iter().copied().fold(first, f64::max),
        "min" => args.iter().copied().fold(first, f64::min),
        "floor" => first.floor(),
        "ceil" => first.ceil(),
        "round" => (first + 0.5).floor(),
        "trunc" => first.trunc(),
        "abs" => first.abs(),
        "sqrt" => first.sqrt(),
        "log2" if first > 0.0 && first.fract() == 0.0 => exact_log2(first)?,
        "pow" => power(first, *args.get(1)?)?,
        _ => return None,
    }))
}

/// The logarithm of a power of two.
fn exact_log2(number: f64) -> Option<f64> {
    (0..64_u32).map(f64::from).find(|k| power(2.0, *k) == Some(number))
}

/// A power with a small whole exponent.
fn power(base: f64, exponent: f64) -> Option<f64> {
    let count = whole(exponent).filter(|count| *count <= 64)?;
    Some(std::iter::repeat_n(base, count).product())
}
