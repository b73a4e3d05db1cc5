//! Macros and their expansion (GLSL 4.60 specification, section 3.3).
//!
//! A token carries the names of the macros that made it, and is not expanded by those again
//! (Prosser's algorithm), so that `#define f(x) f(x + 1)` ends.

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use super::super::errors;
use super::super::lexer::{Lex, Piece, lex};
use super::super::sink::Sink;
use base::text::{Expansion, SourceFile, Span};

/// How a token is spelled.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Spelling {
    /// As the text at this place: the token itself, or its place in a macro's body.
    Source(Span),
    /// Made by `##`, or a built-in macro.
    Made(Arc<str>),
}

/// A token behind the preprocessor.
#[derive(Clone, Debug)]
pub(crate) struct Tok {
    pub lex: Lex,
    /// Place in the text: for what a macro writes the whole invocation, for what it is given the place there.
    pub span: Span,
    pub spelling: Spelling,
    pub from_macro: bool,
    /// First of its line in the text.
    pub first: bool,
    pub(super) hide: Option<Arc<Hide>>,
}

#[derive(Debug)]
pub(super) struct Hide {
    name: String,
    rest: Option<Arc<Hide>>,
}

impl Drop for Hide {
    fn drop(&mut self) {
        // Long chains must not be dropped by recursion.
        let mut rest = self.rest.take();
        while let Some(mut inner) = rest.and_then(Arc::into_inner) {
            rest = inner.rest.take();
        }
    }
}

impl Tok {
    pub(crate) fn new(piece: &Piece) -> Self {
        let Piece { lex, span, first, spaced: _ } = *piece;
        Self { lex, span, spelling: Spelling::Source(span), from_macro: false, first, hide: None }
    }

    /// The token behind the last one.
    pub(crate) fn end(offset: usize) -> Self {
        Self::new(&Piece { lex: Lex::End, span: Span::at(offset), first: true, spaced: true })
    }

    /// True for a word, and for what stands for one.
    pub(crate) fn is_word(&self) -> bool {
        matches!(self.lex, Lex::Word | Lex::Hole)
    }

    pub(crate) fn text<'a>(&'a self, file: &'a SourceFile) -> &'a str {
        match &self.spelling {
            Spelling::Source(span) => file.slice(*span),
            Spelling::Made(text) => text,
        }
    }

    fn hidden(&self, name: &str) -> bool {
        self.hide.as_deref().is_some_and(|hide| contains(hide, name))
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Macro {
    /// Names of the parameters; none for an object-like macro.
    pub params: Option<Vec<String>>,
    /// Tokens of the body.
    pub body: Vec<(Lex, Spelling)>,
    /// The name in its `#define`; none for one that the text does not define.
    pub definition: Option<Span>,
}

/// Arguments of a macro call and its place.
type Call = (Vec<Vec<Tok>>, Span);

pub(crate) type Macros = HashMap<String, Macro>;

/// More tokens than any real shader has: a bomb of macros that double.
pub(super) const MOST_TOKENS: usize = 2_000_000;

/// Names of macros whose value depends on the place.
fn builtin(name: &str, span: Span, file: &SourceFile, line_shift: i64) -> Option<String> {
    match name {
        "__LINE__" => {
            let line = i64::try_from(file.position(span.start).line).unwrap_or(0);
            Some((line + line_shift).to_string())
        }
        "__FILE__" => Some("0".to_owned()),
        _ => None,
    }
}

/// Expands all macros in `input`.
pub(crate) fn expand(input: Vec<Tok>, macros: &Macros, line_shift: i64, sink: &mut Sink) -> Vec<Tok> {
    let file = sink.file.clone();
    Expander { macros, line_shift, file, sink, made: 0, depth: 0 }.run(input)
}

/// Macro calls within arguments of macro calls; deeper ones are not expanded.
const DEEPEST: usize = 64;

struct Expander<'a> {
    macros: &'a Macros,
    line_shift: i64,
    file: SourceFile,
    sink: &'a mut Sink,
    made: usize,
    depth: usize,
}

impl Expander<'_> {
    fn run(&mut self, input: Vec<Tok>) -> Vec<Tok> {
        let macros = self.macros;
        let mut out = Vec::with_capacity(input.len());
        let mut queue: VecDeque<Tok> = input.into();
        while let Some(tok) = queue.pop_front() {
            if tok.lex != Lex::Word {
                out.push(tok);
                continue;
            }
            let name = tok.text(&self.file).to_owned();
            if let Some(value) = builtin(&name, tok.span, &self.file, self.line_shift) {
                out.push(Tok { lex: Lex::Number, spelling: Spelling::Made(value.into()), from_macro: true, ..tok });
                continue;
            }
            let Some(found) = macros.get(&name).filter(|_| !tok.hidden(&name)) else {
                out.push(tok);
                continue;
            };
            let (args, span) = match &found.params {
                None => (Vec::new(), tok.span),
                // A function-like macro without parenthesis is an ordinary name.
                Some(_) if queue.front().map(|t| t.lex) != Some(Lex::LParen) => {
                    out.push(tok);
                    continue;
                }
                Some(params) => match self.call(&name, params.len(), &tok, &mut queue) {
                    Ok(call) => call,
                    Err(instead) => {
                        out.push(*instead);
                        continue;
                    }
                },
            };
            // What another macro writes is its expansion, unless the arguments stand behind that.
            if !tok.from_macro || span != tok.span {
                self.sink.expansions.push(Expansion { span, name: name.as_str().into(), definition: found.definition });
            }
            let result = self.substitute(found, &name, &args, &tok, span);
            self.made += result.len() + 1;
            if self.made > MOST_TOKENS {
                let message = format!("macro `{name}` and those before it expand to more than {MOST_TOKENS} tokens");
                self.sink.error(errors::TOO_DEEP, span, message, "this macro");
                return out;
            }
            for tok in result.into_iter().rev() {
                queue.push_front(tok);
            }
        }
        out
    }

    /// Arguments and place of a macro call, or the token that goes on instead of a wrong call.
    fn call(&mut self, name: &str, params: usize, tok: &Tok, queue: &mut VecDeque<Tok>) -> Result<Call, Box<Tok>> {
        let mut error = |span, message: String| self.sink.error(errors::MACRO, span, message, "this macro call");
        let Some((args, close)) = arguments(queue) else {
            error(tok.span, format!("the call of macro `{name}` has no closing `)`"));
            return Err(Box::new(tok.clone()));
        };
        let span = tok.span.to(close);
        let empty = params == 0 && args.len() == 1 && args[0].is_empty();
        if args.len() != params && !empty {
            let plural = if params == 1 { "" } else { "s" };
            error(span, format!("macro `{name}` takes {params} argument{plural}, not {}", args.len()));
            // The parser knows that this was told.
            return Err(Box::new(Tok { lex: Lex::Unknown, span, ..tok.clone() }));
        }
        Ok((args, span))
    }

    fn substitute(&mut self, found: &Macro, name: &str, args: &[Vec<Tok>], tok: &Tok, span: Span) -> Vec<Tok> {
        let file = self.file.clone();
        let hide = Arc::new(Hide { name: name.to_owned(), rest: tok.hide.clone() });
        let params = found.params.as_deref().unwrap_or_default();
        let mut expanded: Vec<Option<Vec<Tok>>> = vec![None; args.len()];
        let mut out: Vec<Tok> = Vec::new();
        let mut paste = false;
        for (i, (kind, spelling)) in found.body.iter().enumerate() {
            if *kind == Lex::HashHash {
                paste = true;
                continue;
            }
            let text = match spelling {
                Spelling::Source(span) => file.slice(*span),
                Spelling::Made(text) => text,
            };
            let param = if *kind == Lex::Word { params.iter().position(|p| p == text) } else { None };
            let piece: Vec<Tok> = match param {
                Some(p) if p < args.len() => {
                    let pasted = paste || found.body.get(i + 1).map(|b| b.0) == Some(Lex::HashHash);
                    let tokens = if pasted || self.depth >= DEEPEST {
                        args[p].clone()
                    } else {
                        match &expanded[p] {
                            Some(tokens) => tokens.clone(),
                            None => {
                                self.depth += 1;
                                let tokens = self.run(args[p].clone());
                                self.depth -= 1;
                                expanded[p] = Some(tokens.clone());
                                tokens
                            }
                        }
                    };
                    tokens
                        .into_iter()
                        .map(|t| {
                            let within = span.start <= t.span.start && t.span.end <= span.end;
                            let span = if within { t.span } else { span };
                            Tok { span, from_macro: true, first: false, hide: Some(union(&hide, &t)), ..t }
                        })
                        .collect()
                }
                _ => vec![Tok {
                    lex: *kind,
                    span,
                    spelling: spelling.clone(),
                    from_macro: true,
                    first: false,
                    hide: Some(Arc::clone(&hide)),
                }],
            };
            let mut piece = piece.into_iter();
            if std::mem::take(&mut paste)
                && let Some(left) = out.pop()
            {
                match piece.next() {
                    None => out.push(left),
                    Some(right) => {
                        let joined: Arc<str> = format!("{}{}", left.text(&file), right.text(&file)).into();
                        // What is no single token stays two.
                        match lex(&joined).pieces.as_slice() {
                            [one] => out.push(Tok { lex: one.lex, span, spelling: Spelling::Made(joined), ..left }),
                            _ => out.extend([left, right]),
                        }
                    }
                }
            }
            out.extend(piece);
        }
        out
    }
}

/// The names that hide `tok`, together with those of `hide`.
fn union(hide: &Arc<Hide>, tok: &Tok) -> Arc<Hide> {
    let mut all = Arc::clone(hide);
    let mut at = tok.hide.as_deref();
    while let Some(inner) = at {
        if !contains(&all, &inner.name) {
            all = Arc::new(Hide { name: inner.name.clone(), rest: Some(all) });
        }
        at = inner.rest.as_deref();
    }
    all
}

fn contains(hide: &Hide, name: &str) -> bool {
    let mut at = Some(hide);
    while let Some(inner) = at {
        if inner.name == name {
            return true;
        }
        at = inner.rest.as_deref();
    }
    false
}

/// Takes `( … )` from the queue: arguments and the place of `)`. Leaves the queue as it was when
/// there is no `)`.
fn arguments(queue: &mut VecDeque<Tok>) -> Option<(Vec<Vec<Tok>>, Span)> {
    let mut depth = 0_usize;
    let mut end = None;
    for (i, tok) in queue.iter().enumerate() {
        match tok.lex {
            Lex::LParen => depth += 1,
            Lex::RParen => {
                depth -= 1;
                if depth == 0 {
                    end = Some(i);
                    break;
                }
            }
            _ => {}
        }
    }
    let end = end?;
    let mut args = vec![Vec::new()];
    let mut close = Span::default();
    for (i, tok) in queue.drain(..=end).enumerate() {
        match tok.lex {
            Lex::LParen => {
                depth += 1;
                if i == 0 {
                    continue;
                }
            }
            Lex::RParen => {
                depth -= 1;
                if i == end {
                    close = tok.span;
                    continue;
                }
            }
            Lex::Comma if depth == 1 => {
                args.push(Vec::new());
                continue;
            }
            _ => {}
        }
        if let Some(last) = args.last_mut() {
            last.push(tok);
        }
    }
    Some((args, close))
}
