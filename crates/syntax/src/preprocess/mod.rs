//! Directives and macros: from the tokens of the text to the tokens that are compiled.

mod branch;
mod condition;
mod extension;
mod foreign;
pub(crate) mod limit;
mod macros;
pub mod plain;
pub(crate) mod setting;

use super::lexer::{Lex, Piece, Pieces};
use super::sink::Sink;
use super::{Extension, Profile, Token, TokenKind, TokenPlace, Version, errors};
use base::diagnostic::{Safety, message};
use base::text::{Edit, Span};
use branch::Conditional;
pub(crate) use macros::Tok;
use macros::{Macro, Macros, Spelling};
use setting::Setting;

/// What the preprocessor leaves.
pub(crate) struct Preprocessed {
    pub tokens: Vec<Tok>,
    pub version: Version,
    pub extensions: Vec<Extension>,
    pub raw: Vec<Token>,
    /// An `#include` was met: names may be declared in text that is not here.
    pub incomplete: bool,
    /// Directives of which another tool makes something.
    pub holes: Vec<Span>,
    /// Macros for want of which an `#error` is reached.
    pub wanted: Vec<String>,
    /// What a text that is not GLSL has besides.
    pub directives: Vec<plain::Foreign>,
}

struct Preprocessor<'a> {
    sink: &'a mut Sink,
    /// Macros that are given from outside.
    given: &'a [(String, String)],
    /// Lines that count as if they said something else, the first last.
    settings: Vec<&'a Setting>,
    macros: Macros,
    conditionals: Vec<Conditional>,
    pending: Vec<Tok>,
    out: Vec<Tok>,
    version: Version,
    extensions: Vec<Extension>,
    line_shift: i64,
    wanted: Vec<String>,
    incomplete: bool,
    /// A token or directive stands before the line at hand.
    begun: bool,
    /// Characters outside of the language in bodies of macros, with their names.
    foreign: Vec<(String, Span)>,
    /// Directives of another tool, or with a hole.
    holes: Vec<Span>,
    /// Set where the text is not GLSL.
    plain: Option<plain::State>,
}

/// A text that stands before another and is not here.
#[derive(Clone, Debug)]
pub(crate) struct InFront {
    /// The version that it states.
    pub version: Version,
    /// True where it is known to declare names as well: what the other text lacks is not told then.
    pub names: bool,
}

/// Runs all directives. `defines` are macros that are given from outside, as by a compiler's option. The settings stand
/// in the order of the text.
pub(crate) fn run(
    pieces: &Pieces,
    (defines, settings): (&[(String, String)], &[Setting]),
    before: Option<InFront>,
    sink: &mut Sink,
) -> Preprocessed {
    let mut this = Preprocessor::new(defines, before, sink);
    this.settings = settings.iter().rev().collect();
    this.predefine();
    this.run(pieces)
}

impl<'a> Preprocessor<'a> {
    fn new(defines: &'a [(String, String)], before: Option<InFront>, sink: &'a mut Sink) -> Self {
        // Who defines `GL_ES` means a compiler of GLSL ES, in which a text without a version is of the first.
        let assumed = match defines.iter().any(|(name, _)| name == "GL_ES") {
            true => Version { number: 100, profile: Profile::Es, span: None },
            false => Version { number: 110, profile: Profile::Compatibility, span: None },
        };
        Self {
            sink,
            given: defines,
            settings: Vec::new(),
            macros: Macros::new(),
            conditionals: Vec::new(),
            pending: Vec::new(),
            out: Vec::new(),
            wanted: Vec::new(),
            incomplete: before.as_ref().is_some_and(|before| before.names),
            version: before.map_or(assumed, |before| before.version),
            extensions: Vec::new(),
            line_shift: 0,
            begun: false,
            foreign: Vec::new(),
            holes: Vec::new(),
            plain: None,
        }
    }

    fn run(mut self, pieces: &Pieces) -> Preprocessed {
        let this = &mut self;
        this.open_comment(pieces);
        this.given.iter().for_each(|(name, value)| this.given(name, value));
        let all = limit::within(&pieces.pieces, this.sink);
        let mut raw = Vec::with_capacity(all.len());
        let mut at = 0;
        while at < all.len() && this.out.len() <= macros::MOST_TOKENS {
            let rest = &all[at..];
            let len = rest.iter().skip(1).position(|p| p.first).map_or(rest.len(), |n| n + 1);
            let len = if this.plain.is_some() { this.plain_line(rest, len) } else { len };
            let line = &rest[..len];
            at += len;
            this.set_before(line[0].span.start);
            let active = this.active();
            let directive = line[0].lex == Lex::Hash && !this.is_substitution(line);
            this.holes_of(line, directive);
            let place = if directive {
                this.directive(line);
                // The directives of the outermost #if are no part of what it leaves out.
                let word = line.get(1).map(|p| this.slice(p)).unwrap_or_default();
                let conditional = matches!(word.as_str(), "if" | "ifdef" | "ifndef" | "elif" | "else" | "endif");
                if active || this.active() || (conditional && this.outer_active()) {
                    TokenPlace::Directive
                } else {
                    TokenPlace::Inactive
                }
            } else if active {
                this.text(line);
                TokenPlace::Text
            } else {
                TokenPlace::Inactive
            };
            // What is filled in may be nothing.
            this.begun |= line.iter().any(|p| p.lex != Lex::Hole);
            raw.extend(line.iter().map(|p| Token { kind: kind(p.lex), span: p.span, place }));
        }
        this.flush();
        for (name, span) in std::mem::take(&mut this.foreign) {
            let uses = raw.iter().filter(|t| t.place != TokenPlace::Inactive && this.sink.file.slice(t.span) == name);
            if uses.count() > 1 {
                this.unknown(span);
            }
        }
        for open in std::mem::take(&mut this.conditionals) {
            let diagnostic = this
                .sink
                .start(errors::CONDITIONAL, open.span, "this `#if` has no `#endif`")
                .with_label("opened here")
                .with_help("add `#endif` where it ends");
            this.sink.push(diagnostic);
        }
        this.sink.expanded();
        let Preprocessor { out: tokens, version, extensions, incomplete, holes, wanted, plain, .. } = self;
        let directives = plain.map(|state| state.directives).unwrap_or_default();
        Preprocessed { tokens, version, extensions, raw, incomplete, holes, wanted, directives }
    }

    fn open_comment(&mut self, pieces: &Pieces) {
        if let Some(span) = pieces.open_comment {
            let diagnostic = self
                .sink
                .start(errors::TOKEN, span, "this comment is never closed")
                .with_label("the comment starts here")
                .with_why("everything up to the end of the file belongs to it")
                .with_help("put `*/` where the comment ends");
            self.sink.push(diagnostic);
        }
    }
}

fn kind(lex: Lex) -> TokenKind {
    match lex {
        Lex::Word => TokenKind::Word,
        Lex::Number => TokenKind::Number,
        Lex::Unknown | Lex::Hole => TokenKind::Unknown,
        _ => TokenKind::Punctuation,
    }
}

impl Preprocessor<'_> {
    fn active(&self) -> bool {
        self.conditionals.last().is_none_or(|c| c.active)
    }

    /// True when the innermost `#if` itself stands in compiled text.
    fn outer_active(&self) -> bool {
        self.conditionals.iter().rev().nth(1).is_none_or(|c| c.active)
    }

    fn number(&mut self, name: &str, value: &str) {
        let body = vec![(Lex::Number, Spelling::Made(value.into()))];
        self.macros.insert(name.to_owned(), Macro { params: None, body, definition: None });
    }

    /// A macro from outside: `WIDTH`, or `load(buffer,at)` with parameters.
    fn given(&mut self, name: &str, value: &str) {
        let spelled = |piece: &Piece| (piece.lex, Spelling::Made(value[piece.span.range()].into()));
        let body = super::lexer::lex(value).pieces.iter().map(spelled).collect();
        let (name, params) = match name.strip_suffix(')').and_then(|name| name.split_once('(')) {
            Some((name, "")) => (name, Some(Vec::new())),
            Some((name, params)) => (name, Some(params.split(',').map(|param| param.trim().to_owned()).collect())),
            None => (name, None),
        };
        self.macros.insert(name.to_owned(), Macro { params, body, definition: None });
    }

    /// Macros that depend on the version.
    fn predefine(&mut self) {
        let own = ["GL_ES", "GL_core_profile", "GL_compatibility_profile", "GL_es_profile", "GL_ARB_texture_rectangle"];
        for name in own {
            self.macros.remove(name);
        }
        let number = self.version.number;
        self.number("__VERSION__", &number.to_string());
        match self.version.profile {
            Profile::Es => {
                self.number("GL_ES", "1");
                self.number("GL_es_profile", "1");
            }
            Profile::Core | Profile::Compatibility if number >= 150 => {
                // Both names exist in the compatibility profile (GLSL 1.50, section 3.3).
                self.number("GL_core_profile", "1");
                if self.version.profile == Profile::Compatibility {
                    self.number("GL_compatibility_profile", "1");
                }
            }
            Profile::Core | Profile::Compatibility => {}
        }
        if self.version.profile != Profile::Es {
            // Part of OpenGL since 3.1, and of every implementation before.
            self.number("GL_ARB_texture_rectangle", "1");
        }
        if self.version.profile == Profile::Es || number >= 130 {
            self.number("GL_FRAGMENT_PRECISION_HIGH", "1");
        }
    }

    fn text(&mut self, line: &[Piece]) {
        if self.plain.is_some() {
            return self.plain_text(line);
        }
        for piece in self.with_texts(line).iter() {
            match piece.lex {
                Lex::Unknown => {
                    self.unknown(piece.span);
                    // The parser must know that something stands here, unless it is a blank.
                    if !self.sink.file.slice(piece.span).chars().all(char::is_whitespace) {
                        self.pending.push(Tok::new(piece));
                    }
                }
                _ => self.pending.push(Tok::new(piece)),
            }
        }
    }

    fn flush(&mut self) {
        let pending = std::mem::take(&mut self.pending);
        let end = pending.last().map(|tok| tok.span);
        let tokens = macros::expand(pending, &self.macros, self.line_shift, self.sink);
        self.out.extend(tokens);
        limit::expanded(self.out.len(), end, self.sink);
    }

    fn slice(&self, piece: &Piece) -> String {
        self.sink.file.slice(piece.span).to_owned()
    }

    fn directive(&mut self, line: &[Piece]) {
        let Some(name) = line.get(1) else { return };
        let span = line[0].span.to(line[line.len() - 1].span);
        let rest = &line[2..];
        let word = self.slice(name);
        let (word, name, rest) =
            if self.plain.is_some() { self.plain_words(word, name, rest) } else { (word, name, rest) };
        match word.as_str() {
            "elif" | "elifdef" | "elifndef" if self.plain.is_some() => self.plain_elif(&word, rest, span),
            "if" | "ifdef" | "ifndef" => self.open(&word, name, rest, span),
            "elif" => self.elif(rest, span),
            "else" => self.otherwise(rest, span),
            "endif" => {
                self.extra(rest, "endif");
                if self.conditionals.pop().is_none() {
                    self.stray("endif", span);
                }
            }
            _ if !self.active() => {}
            _ if self.is_foreign(&word) => self.foreign_directive(word, rest, span),
            "define" if self.is_set(rest, span.start) => {}
            "define" => {
                self.flush();
                self.define(rest, span);
            }
            "undef" => {
                self.flush();
                match rest {
                    [one] if one.lex == Lex::Word => {
                        let name = self.slice(one);
                        if self.is_predefined(&name) {
                            return self.predefined(&name, one.span);
                        }
                        self.macros.remove(&name);
                    }
                    _ => self.malformed(span, "`#undef` takes one name"),
                }
            }
            "error" => {
                self.wanted.extend(self.conditionals.last().and_then(|open| open.wants.clone()));
                let text = line
                    .get(2)
                    .map_or(String::new(), |p| self.sink.file.slice(Span::new(p.span.start, span.end)).to_owned());
                let text = text.trim();
                let message =
                    if text.is_empty() { "`#error` is reached".to_owned() } else { format!("#error: {text}") };
                self.sink.error(errors::ERROR_DIRECTIVE, span, message, "reached here");
            }
            "pragma" => {}
            "version" => self.version(rest, span),
            "extension" => self.extension(rest, span),
            "line" => self.line(rest, span),
            _ => self.unknown_directive(&word, name, span),
        }
    }

    fn unknown_directive(&mut self, word: &str, name: &Piece, span: Span) {
        self.incomplete |= word == "include";
        let start = |code, message: String| self.sink.start(code, span, message);
        let diagnostic = if word == "include" {
            start(errors::INCLUDE, "`#include` is not part of GLSL".to_owned())
                .with_label("the file is not read")
                .with_help("compilers refuse it; put the text here, or let the host join the files")
        } else {
            let all = [
                "define",
                "undef",
                "if",
                "ifdef",
                "ifndef",
                "else",
                "elif",
                "endif",
                "error",
                "pragma",
                "extension",
                "version",
                "line",
            ];
            let mut d = start(errors::UNKNOWN_DIRECTIVE, format!("`#{word}` is no directive of GLSL"));
            d.span = name.span;
            d.label = "unknown directive".into();
            match super::names::nearest(word, all) {
                Some(near) => d.with_help(format!("did you mean `#{near}`?")),
                None => {
                    self.holes.push(name.span);
                    d
                }
            }
        };
        self.sink.push(diagnostic);
    }

    fn malformed(&mut self, span: Span, message: &str) {
        self.sink.error(errors::DIRECTIVE, span, message, "this directive");
    }

    fn is_predefined(&self, name: &str) -> bool {
        matches!(name, "__LINE__" | "__FILE__" | "__VERSION__")
            || (name == "GL_ES" && self.version.profile == Profile::Es)
    }

    fn predefined(&mut self, name: &str, span: Span) {
        let message = message!("the language defines `{name}` itself", "`{name}` は言語が定義するマクロです");
        let d = self.sink.start(errors::RESERVED, span, message).with_label(message!("reserved", "予約されています"));
        self.sink.push(
            d.with_why(message!("macros that start with `GL_` are reserved", "`GL_` で始まるマクロは予約されています"))
                .with_help(message!("choose another name", "別の名前にしてください")),
        );
    }

    fn extra(&mut self, rest: &[Piece], name: &str) {
        // Preprocessors of WGSL take the name of what ends here without a comment sign.
        if let Some(first) = rest.first().filter(|_| self.plain.is_none()) {
            let span = first.span.to(rest[rest.len() - 1].span);
            let diagnostic = self
                .sink
                .start(errors::DIRECTIVE, span, format!("nothing may follow `#{name}`"))
                .with_label("this is too much")
                .with_fix("Put it into a comment", Safety::Safe, vec![Edit::insert(span.start, "// ")]);
            self.sink.push(diagnostic);
        }
    }

    fn define(&mut self, rest: &[Piece], span: Span) {
        let Some((name, body)) = rest.split_first().filter(|(n, _)| n.lex == Lex::Word) else {
            return self.malformed(span, "`#define` needs a name");
        };
        let text = self.slice(name);
        if self.plain.is_none() && (self.is_predefined(&text) || text.starts_with("GL_")) || text == "defined" {
            return self.predefined(&text, name.span);
        }
        // Only `(` right behind the name opens parameters.
        let (params, body) = match body.split_first() {
            Some((open, after)) if open.lex == Lex::LParen && !open.spaced => {
                let Some(close) = after.iter().position(|p| p.lex == Lex::RParen) else {
                    return self.malformed(span, "the parameters of this macro have no closing `)`");
                };
                let (inside, body) = (&after[..close], &after[close + 1..]);
                let good = inside.is_empty()
                    || (inside.len() % 2 == 1
                        && inside
                            .iter()
                            .enumerate()
                            .all(|(i, p)| p.lex == if i % 2 == 0 { Lex::Word } else { Lex::Comma }));
                if !good {
                    return self.malformed(span, "the parameters of a macro are names separated by commas");
                }
                let names = inside.iter().filter(|p| p.lex == Lex::Word).map(|p| self.slice(p)).collect();
                (Some(names), body)
            }
            _ => (None, body),
        };
        let body = self.with_texts(body);
        // What is left behind preprocessing counts: GLSL 4.20 and GLSL ES 3.00, section 3.1.
        let later = self.version.number >= if self.version.profile == Profile::Es { 300 } else { 420 };
        let plain = self.plain.is_some();
        for piece in body.iter().filter(|p| p.lex == Lex::Unknown && !plain) {
            match later {
                true => self.foreign.push((text.clone(), piece.span)),
                false => self.unknown(piece.span),
            }
        }
        let plain = self.plain.is_some();
        let body =
            body.iter().filter(|p| plain || p.lex != Lex::Unknown).map(|p| (p.lex, Spelling::Source(p.span))).collect();
        if text == "defined" || text.starts_with("__") && self.macros.contains_key(&text) {
            return self.malformed(span, &format!("`{text}` cannot be redefined"));
        }
        let new = Macro { params, body, definition: Some(name.span) };
        // Where only marked names are replaced, the text overrides what is given, as naga_oil has it.
        if let Some(old) = self.macros.get(&text)
            && !self.marked()
            && !self.same(old, &new)
        {
            let message = format!("macro `{text}` is defined twice with different bodies");
            let diagnostic = self.sink.start(errors::MACRO, name.span, message).with_label("second definition");
            let diagnostic = if self.given.iter().any(|(name, _)| *name == text) {
                let help = format!("put this line between `#ifndef {text}` and `#endif`");
                diagnostic.with_why("the first one is given from outside").with_help(help)
            } else {
                diagnostic.with_help(format!("put `#undef {text}` before it, or remove one of them"))
            };
            self.sink.push(diagnostic);
        }
        self.macros.insert(text, new);
    }

    fn same(&self, a: &Macro, b: &Macro) -> bool {
        let text = |s: &Spelling| match s {
            Spelling::Source(span) => self.sink.file.slice(*span).to_owned(),
            Spelling::Made(text) => text.to_string(),
        };
        a.params == b.params
            && a.body.len() == b.body.len()
            && a.body.iter().zip(&b.body).all(|(x, y)| x.0 == y.0 && text(&x.1) == text(&y.1))
    }

    fn version(&mut self, rest: &[Piece], span: Span) {
        // What is filled in states it.
        if rest.first().is_some_and(|p| p.lex == Lex::Hole) {
            return;
        }
        let number = rest.first().map(|p| self.slice(p)).unwrap_or_default();
        let known = [100, 110, 120, 130, 140, 150, 300, 310, 320, 330, 400, 410, 420, 430, 440, 450, 460];
        let Some(number) = number.parse::<u32>().ok().filter(|n| known.contains(n)) else {
            let diagnostic = self
                .sink
                .start(errors::DIRECTIVE, rest.first().map_or(span, |p| p.span), "this is no version of GLSL")
                .with_label("unknown version")
                .with_help("versions are 110, 120, 130, 140, 150, 330, 400 to 460, and 100, 300, 310, 320 of GLSL ES");
            return self.sink.push(diagnostic);
        };
        let es_number = matches!(number, 100 | 300 | 310 | 320);
        let profile = match rest.get(1).map(|p| self.slice(p)).as_deref() {
            None if number == 100 => Profile::Es,
            None if number >= 150 => Profile::Core,
            None => Profile::Compatibility,
            Some("es") if es_number => Profile::Es,
            Some("core") if number >= 150 && !es_number => Profile::Core,
            Some("compatibility") if number >= 150 && !es_number => Profile::Compatibility,
            Some(other) => {
                let message = format!("`{other}` is no profile of version {number}");
                self.sink.error(errors::DIRECTIVE, rest[1].span, message, "unknown profile");
                if es_number { Profile::Es } else { Profile::Core }
            }
        };
        if let Some(third) = rest.get(2) {
            self.sink.error(errors::DIRECTIVE, third.span, "nothing may follow the profile", "this is too much");
        }
        if self.version.span.is_some() {
            self.flush();
            return self.malformed(span, "a second `#version`");
        }
        if self.begun {
            let d = self
                .sink
                .start(
                    errors::LATE_VERSION,
                    span,
                    message!("`#version` must be the first thing in the text", "`#version` はテキストの先頭に書きます"),
                )
                .with_label(message!("too late", "遅すぎます"))
                .with_why(message!(
                    "only blanks and comments may stand before it",
                    "前に置けるのは空白とコメントだけです"
                ))
                .with_help(message!("move it to the first line", "一行目へ移してください"));
            self.sink.push(d);
        }
        self.flush();
        self.version = Version { number, profile, span: Some(span) };
        self.predefine();
    }

    fn extension(&mut self, rest: &[Piece], span: Span) {
        self.flush();
        match rest {
            [name, colon, behavior] if name.lex == Lex::Word && colon.lex == Lex::Colon => {
                let (name, behavior_text) = (self.slice(name), self.slice(behavior));
                if !matches!(behavior_text.as_str(), "require" | "enable" | "warn" | "disable") {
                    let diagnostic = self
                        .sink
                        .start(
                            errors::DIRECTIVE,
                            behavior.span,
                            format!("`{behavior_text}` is no behaviour of an extension"),
                        )
                        .with_label("unknown behaviour")
                        .with_help("write `require`, `enable`, `warn` or `disable`");
                    self.sink.push(diagnostic);
                }
                self.known_extension(&name, &behavior_text, span);
                if behavior_text != "disable" && name != "all" {
                    self.number(&name, "1");
                }
                self.extensions.push(Extension { name, behavior: behavior_text, span });
            }
            _ => self.malformed(span, "`#extension` is written as `#extension NAME : enable`"),
        }
    }

    fn line(&mut self, rest: &[Piece], span: Span) {
        self.flush();
        let first = rest.first().and_then(|p| self.slice(p).parse::<i64>().ok());
        match first {
            Some(line) => {
                let here = i64::try_from(self.sink.file.position(span.start).line).unwrap_or(0);
                self.line_shift = line - (here + 1);
            }
            // A macro or an expression is allowed; the places in our messages do not follow #line.
            None if rest.iter().all(|p| p.lex != Lex::Unknown) && !rest.is_empty() => {}
            None => self.malformed(span, "`#line` needs a number"),
        }
    }
}
