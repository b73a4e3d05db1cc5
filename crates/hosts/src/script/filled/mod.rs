//! Modules in WGSL that JavaScript and TypeScript put together of templates, for commands that run them.
//!
//! ```text
//! template ─ holes ─ expression ─┬─ value: of this file, or of one that it imports ─┐
//!                                └─ unknown: what its place asks for (`holes`) ─────┴─▶ text of a module
//! ```
//!
//! A value is known where constants, templates and functions of one expression lead to it. What is not known is an input of the
//! text, as a declaration that it lacks is, and every such choice is told. The linter reads modules whose parts it knows: what the host
//! fills in elsewhere may be another thing.

mod files;
mod holes;
mod rests;
mod syntax;
#[cfg(test)]
mod tests;
mod values;

use std::rc::Rc;

use ::syntax::Shader;
use base::diagnostic::Severity;
use base::text::{Assembly, SourceFile, Span};

use self::syntax::{Node, Reader};
use super::code::Code;
use super::language::{Form, Language};
use super::strings;
use super::token::Token;
use crate::document::document_of;
use crate::paths::extension;
use files::{Files, is_changed, value_behind};
use values::{Frame, OPEN, Scope, Values};

/// Times that files are read which those before them import.
const ROUNDS: usize = 12;

/// Texts of one file.
const MOST: usize = 64;

/// Reads what a file imports: by the name of the file, and the path that it writes.
pub type Imports<'i> = dyn FnMut(&str, &str) -> Option<SourceFile> + 'i;

/// The paths that an import may mean: as it is written, with an ending, or as the index of a folder. `a.js` is `a.ts` where
/// the compiler of TypeScript has still to write it.
pub fn candidates(path: &str) -> Vec<String> {
    const ENDINGS: [&str; 4] = ["ts", "js", "tsx", "mjs"];
    let mut all = vec![path.to_owned()];
    all.extend(ENDINGS.iter().map(|ending| format!("{path}.{ending}")));
    all.extend(ENDINGS.iter().map(|ending| format!("{path}/index.{ending}")));
    all.extend(path.strip_suffix(".js").map(|path| format!("{path}.ts")));
    all
}

/// A module that is put together.
#[derive(Clone, Debug)]
pub struct Filled {
    /// Its text, with a name for messages; places lead back to the files that it is of.
    pub text: SourceFile,
    /// The template that it begins with.
    pub place: Span,
    /// What to tell of what is taken.
    pub notes: Vec<String>,
    /// Names that stand for values which are not known.
    pub made_up: Vec<String>,
    /// What is not known, so that an error of the text need not be its author's.
    pub open: Option<String>,
    /// True for a text without a function of a stage: a part of others.
    pub part: bool,
    /// Functions whose findings rest on what is taken.
    pub resting: Vec<String>,
}

/// The modules that templates of a file make, and the parts of modules that none of them has. `known` are the places of
/// strings that are read otherwise. Nothing for a file that is no JavaScript.
pub fn filled(file: &SourceFile, known: &[Span], imports: &mut Imports<'_>) -> Vec<Filled> {
    let may_hold = file.text().contains("fn ") || file.text().contains("${");
    // The scripts of a page have its name.
    let is_page = || ["html", "htm"].contains(&extension(document_of(file.name())));
    let is_code = Language::of(file.name()).map_or_else(is_page, |language| language == Language::JavaScript);
    if !is_code || !may_hold || file.text().contains([OPEN.0, OPEN.1]) {
        return Vec::new();
    }
    let code = Code::new(file, Language::JavaScript);
    let mut files = Files::new(file);
    for _ in 0..ROUNDS {
        let found = read(&code, &files, known);
        let used = files.used();
        if !files.read(imports) {
            return with_sources(found, &used);
        }
    }
    read(&code, &files, known)
}

fn with_sources(mut found: Vec<Filled>, used: &[String]) -> Vec<Filled> {
    if !used.is_empty() {
        let names: Vec<&str> = used.iter().map(String::as_str).take(6).collect();
        let more = used.len() - names.len();
        let rest = if more > 0 { format!(" and {more} more files") } else { String::new() };
        let note = format!("what templates are filled with is read from {}{rest}", names.join(", "));
        found.first_mut().into_iter().for_each(|first| first.notes.insert(0, note.clone()));
    }
    found
}

/// A text, the strings that it is of, and whether it has a function of a stage.
struct Candidate {
    filled: Filled,
    /// What it is kept under.
    called: String,
    used: Vec<(usize, Span)>,
    inner: Span,
    whole: bool,
}

fn read(code: &Code<'_>, files: &Files, known: &[Span]) -> Vec<Filled> {
    let mut all: Vec<Candidate> = Vec::new();
    for (at, token) in code.tokens.iter().enumerate() {
        let Token::String { place, inner, form } = *token else { continue };
        let text = code.file.slice(inner);
        let open = form == Form::Template && text.contains("${");
        let written = text.contains("fn ") || strings::has_entry_point(text) || (open && is_marked(code, at));
        if !written || known.contains(&place) || strings::is_expected(&code.tokens, at) || all.len() >= MOST {
            continue;
        }
        if strings::is_alone(&code.tokens, at) || is_tagged(code, at) {
            all.extend(candidate(code, files, at, (place, inner, form)));
        }
    }
    let has = |one: &Candidate, inner: Span| one.inner != inner && one.used.contains(&(0, inner));
    let is_part = |one: &Candidate| !one.whole && all.iter().any(|other| has(other, one.inner));
    let kept: Vec<bool> = all.iter().map(|one| !is_part(one)).collect();
    let mut found: Vec<Filled> = Vec::new();
    for (one, _) in all.into_iter().zip(kept).filter(|(_, kept)| *kept) {
        let mut filled = one.filled;
        let mut name = format!("{}#{}.wgsl", code.file.name(), one.called);
        if found.iter().any(|other| other.text.name() == name) {
            let line = code.file.position(filled.place.start).line;
            name = format!("{}#{}:{line}.wgsl", code.file.name(), one.called);
        }
        let (mut out, end) = (Assembly::new(), filled.text.text().len());
        out.copy(&filled.text, Span::new(0, end));
        filled.text = out.finish(name);
        found.push(filled);
    }
    found
}

/// The text that a string makes; none for one that is no module and no part of one.
fn candidate(code: &Code<'_>, files: &Files, at: usize, (place, inner, form): (Span, Span, Form)) -> Option<Candidate> {
    let values = Values::new(files);
    let scope = Scope { file: 0, frame: frames(code, &values, at) };
    let text = values.text(inner, form, &scope, 0)?;
    let used = values.used.take();
    let open = values.open.take();
    let mut assumed = values.assumed.take();
    let closed = holes::closed(&text, &open);
    let unknown = closed.open.or_else(|| assumed.first().cloned());
    assumed.extend(closed.notes);
    let written = closed.file.text();
    let whole = strings::has_entry_point(written);
    let line = code.file.position(place.start).line;
    let called = name(code, at).unwrap_or_else(|| line.to_string());
    // The text of another language has words of WGSL as well.
    let parsed = Shader::parse_wgsl(&closed.file);
    let broken = parsed
        .diagnostics
        .iter()
        .any(|found| found.severity == Severity::Error && ::syntax::errors::is_of_the_text(found.code));
    let defines = parsed.shader.functions().any(|(_, own)| own.definition.is_some());
    // What is wrong in a text with holes may follow from what was taken for them.
    let runs = if whole { !broken || unknown.is_none() } else { !broken && defines };
    let filled = Filled {
        text: closed.file,
        place,
        notes: assumed,
        made_up: closed.made_up,
        open: unknown,
        part: !whole,
        resting: closed.resting,
    };
    runs.then_some(Candidate { filled, called, used, inner, whole })
}

/// True for a template that says that it is WGSL: `wgsl` in front of it, or in a comment there.
fn is_marked(code: &Code<'_>, at: usize) -> bool {
    let start = code.place(at).start;
    let front = code.file.text()[..start].trim_end();
    is_tagged(code, at) || front.ends_with("*/") && front.rsplit("/*").next().is_some_and(|own| own.contains("wgsl"))
}

fn is_tagged(code: &Code<'_>, at: usize) -> bool {
    at.checked_sub(1).and_then(|before| code.word(before)) == Some("wgsl")
}

/// Where the parameters begin of the arrow that stands in front of a token.
fn arrow_before(code: &Code<'_>, at: usize) -> Option<usize> {
    let arrow = at.checked_sub(2).filter(|arrow| code.is_mark(*arrow, '=') && code.is_mark(arrow + 1, '>'))?;
    // `(…): string =>`
    let mut close = arrow.checked_sub(1)?;
    if code.word(close).is_some()
        && close.checked_sub(2).is_some_and(|at| code.is_mark(at + 1, ':') && code.is_mark(at, ')'))
    {
        close -= 2;
    }
    if code.is_mark(close, ')') { code.other(close) } else { code.word(close).map(|_| close) }
}

/// The first token of the expression that gives a string: with the function around it, and a word in front.
fn start(code: &Code<'_>, at: usize) -> usize {
    let tagged = is_tagged(code, at);
    let at = if tagged { at - 1 } else { at };
    arrow_before(code, at).unwrap_or(at)
}

/// What a text is kept under.
fn name(code: &Code<'_>, at: usize) -> Option<String> {
    let start = start(code, at);
    if let Some(write) = code.writes.iter().find(|write| write.value.start == start) {
        return write.target.rsplit('.').next().map(str::to_owned);
    }
    let before = |back: usize| start.checked_sub(back);
    if before(1).is_some_and(|at| code.is_mark(at, '=')) {
        // `NAME: (group: number) => string = …` is written in more words than a name with a type.
        return before(2).and_then(|at| code.word(at)).map(str::to_owned);
    }
    if before(1).and_then(|at| code.word(at)) == Some("return") {
        let body = code.around(at).into_iter().next()?;
        let own = code.functions.iter().find(|function| function.body == body)?;
        let before = own.parameters.start.checked_sub(1)?;
        return match code.word(before) {
            Some("function") | None => {
                code.writes.iter().find(|write| write.value.start == own.parameters.start).map(|w| w.target.clone())
            }
            Some(word) => Some(word.to_owned()),
        };
    }
    before(1).filter(|at| code.is_mark(*at, ':'))?;
    before(2).and_then(|at| code.key(at)).map(str::to_owned)
}

/// Names of the functions and blocks around a token. What is given to a function is not known.
fn frames(code: &Code<'_>, values: &Values<'_>, at: usize) -> Option<Rc<Frame>> {
    let mut blocks = Vec::new();
    let mut open = code.bracket(at);
    while let Some(own) = open {
        blocks.push(own);
        open = code.bracket(own);
    }
    let places: Vec<Span> = (0..code.tokens.len()).map(|at| code.place(at)).collect();
    let reader = |at: usize| Reader::new(code.file, &code.tokens, &places, at);
    let mut frame: Option<Rc<Frame>> = None;
    let add = |params: usize, frame: Option<Rc<Frame>>| -> Rc<Frame> {
        if let (Some(word), false) = (code.word(params), code.is_mark(params, '(')) {
            let own = Frame::within(frame);
            own.add(word, None);
            return own;
        }
        values.frame(&reader(params).params(params), &[], frame, 0, 0)
    };
    for open in blocks.into_iter().rev() {
        if let Some(params) = arrow_before(code, open) {
            frame = Some(add(params, frame));
        }
        if !code.is_mark(open, '{') {
            continue;
        }
        if let Some(own) = code.functions.iter().find(|function| function.body.start == open)
            && arrow_before(code, open).is_none()
        {
            frame = Some(add(own.parameters.start, frame));
        }
        let own = Frame::within(frame);
        bound_by_head(code, open, &own);
        constants(code, values, &reader, (open, at), &own);
        frame = Some(own);
    }
    match arrow_before(code, if is_tagged(code, at) { at - 1 } else { at }) {
        Some(params) => Some(add(params, frame)),
        None => frame,
    }
}

/// Adds names of the head of a loop, whose values change.
fn bound_by_head(code: &Code<'_>, open: usize, frame: &Frame) {
    let Some(close) = open.checked_sub(1).filter(|at| code.is_mark(*at, ')')) else { return };
    let Some(start) = code.other(close) else { return };
    if !start.checked_sub(1).and_then(|at| code.word(at)).is_some_and(|word| ["for", "catch", "await"].contains(&word))
    {
        return;
    }
    let names = (start + 1..close).take_while(|at| !matches!(code.word(*at), Some("of" | "in")));
    names.filter_map(|at| code.word(at)).for_each(|name| frame.add(name, None));
}

/// Adds the variables that a block declares in front of a token.
fn constants<'a, 't>(
    code: &Code<'t>,
    values: &Values<'_>,
    reader: &dyn Fn(usize) -> Reader<'a, 't>,
    (open, end): (usize, usize),
    frame: &Rc<Frame>,
) {
    let scope = Scope { file: 0, frame: Some(frame.clone()) };
    for at in (open + 1..end).filter(|at| code.bracket(*at) == Some(open)) {
        let further = code.is_mark(at, ',') && code.is_mark(at + 2, '=');
        let kind = if further { Some("let") } else { code.word(at) };
        let Some(kind @ ("const" | "let" | "var")) = kind else { continue };
        let Some(name) = code.word(at + 1) else {
            pattern(code, values, reader, at + 1, &scope);
            continue;
        };
        let behind = if further { &code.tokens[at + 2..] } else { &code.tokens[..] };
        let steady = kind == "const" || !is_changed(behind, name);
        let node = value_behind(&mut reader(at + 2), &code.tokens).filter(|_| steady);
        let value = node.and_then(|node| values.value(&node, &scope, 0));
        frame.add(name, value);
    }
}

/// Adds the names of `const { a, b: c } = object`.
fn pattern<'a, 't>(
    code: &Code<'t>,
    values: &Values<'_>,
    reader: &dyn Fn(usize) -> Reader<'a, 't>,
    open: usize,
    scope: &Scope,
) {
    let Some(close) = code.other(open).filter(|close| *close > open) else { return };
    let node = value_behind(&mut reader(close + 1), &code.tokens);
    for element in code.elements(open) {
        let Some(key) = code.word(element.start) else { continue };
        let renamed = code.is_mark(element.start + 1, ':');
        let name = if renamed { code.word(element.start + 2) } else { Some(key) };
        let Some(name) = name else { continue };
        let member = node.as_ref().map(|node| Rc::new(Node::Member(node.clone(), key.to_owned())));
        let value = member.filter(|_| code.is_mark(open, '{')).and_then(|node| values.value(&node, scope, 0));
        if let Some(frame) = &scope.frame {
            frame.add(name, value);
        }
    }
}
