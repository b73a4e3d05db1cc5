//! What a host puts around a text: errors that may be right with its help are told on request.
//!
//! A text without `main` and `#version` is a piece of a shader; one with an `#include`, or with characters of another
//! preprocessor, is put together before it is compiled; what an `#if` asks may be set from outside; and a name that
//! nothing declares may be declared in a piece, or in a text that host code writes.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap, HashSet};

use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::SourceFile;
use syntax::ast::{ExprKind, ItemKind};
use syntax::errors::Around;
use syntax::symbols::SymbolKind;
use syntax::types::Type;
use syntax::wgsl::Module;
use syntax::{BuiltinFunction, Profile, Shader, Stage, Token, TokenKind, TokenPlace, Version, errors, is_macro};

use super::conditions::{self, Conditions};
use super::dialect;
use super::project::{Project, ShaderFile};
use super::slip;
use hosts::{HostFile, marks};

mod replaced;

pub use replaced::{is_at_replaced_word, replaced_words, with_replaced_comments};

/// Those of the errors of a text that its host may take away. `stated` is what the host is known to add nothing to.
pub fn doubtful(shader: &Shader, found: &[Diagnostic], stated: Around) -> Vec<bool> {
    if found.is_empty() {
        return Vec::new();
    }
    // Where reading ended at a limit is known, whatever a host adds.
    if found.iter().any(|d| d.code == errors::TOO_DEEP) {
        return found.iter().map(|d| d.code != errors::TOO_DEEP).collect();
    }
    let file = shader.file();
    if dialect::needs_another_reader(shader) || found.iter().any(|d| dialect::is_mark(file, d)) {
        return vec![true; found.len()];
    }
    // What holds nothing of a shader under the name of one is told as it is; others may stand in what it includes.
    let is_empty = shader.unit().items.iter().all(|i| i.kind == ItemKind::Error);
    if shader.stage() != Stage::Library && is_empty && found.iter().any(|d| d.code == errors::SYNTAX) {
        return found.iter().map(|error| rests(error).contains(Around::NAMES)).collect();
    }
    let conditions = Conditions::of(shader);
    let mut surroundings = Surroundings::new(shader, &conditions, found);
    surroundings.open.remove(stated);
    let open = surroundings.open;
    let mut kept = under_conditions(shader, &surroundings.asked, found);
    // WGSL has no versions, and read as GLSL it is nothing but marks.
    if shader.version().span.is_none() && shader.wgsl().is_none() {
        // What is written for the first versions is compiled as such where nobody can state another.
        let of_es = shader.version().profile == Profile::Es && stated.contains(Around::ENABLED);
        let old = (is_old(shader) || of_es) && has_main(shader) && !open.contains(Around::ENABLED);
        under_versions(shader, found, &mut kept, if old { &ANY_VERSION[..1] } else { &ANY_VERSION });
    }
    let mut doubtful: Vec<bool> =
        found.iter().zip(kept).map(|(error, kept)| !kept || surroundings.rests(error).intersects(open)).collect();
    // No version of WGSL converts values, and no text around a module gives what it declares another type.
    if shader.wgsl().is_some() && !found.iter().any(|d| d.code == errors::SYNTAX) {
        found.iter().zip(&mut doubtful).filter(|(d, _)| errors::is_of_types(d.code)).for_each(|(_, d)| *d = false);
    }
    // What follows in the grammar may follow from that.
    let is_first = |(error, doubtful): &(&Diagnostic, &bool)| **doubtful && error.code == errors::SYNTAX;
    let first = found.iter().zip(&doubtful).filter(is_first).map(|(error, _)| error.span.start).min();
    let last = found.iter().filter(|error| error.code == errors::SYNTAX).map(|error| error.span.start).max();
    for (error, doubtful) in found.iter().zip(&mut doubtful) {
        let start = error.span.start;
        // Between two ends of the grammar nothing is read as it is meant.
        let reach = error.code == errors::SYNTAX || last.is_some_and(|last| start < last);
        *doubtful |= reach && first.is_some_and(|first| start >= first);
    }
    doubtful
}

/// True for a module in WGSL with declarations that an engine rewrites: no reader of the language takes it as it stands.
pub fn is_rewritten(text: &str) -> bool {
    dialect::declares_otherwise(text)
}

/// What a text leaves to its surroundings.
fn of(shader: &Shader, asked: &BTreeSet<String>, found: &[Diagnostic]) -> Around {
    let file = shader.file();
    let versioned = shader.version().span.is_some();
    let unknown_stage = shader.stage() == Stage::Library;
    let misspelt = found.iter().any(|d| d.code == errors::MISSING_MAIN && !d.span.is_empty());
    // What is called a stage and states its version wants to be one.
    let is_piece = !has_main(shader) && !misspelt && (!versioned || unknown_stage);
    let rewritten = shader.holes().iter().any(|hole| hole.whole);
    let joined = rewritten || found.iter().any(|d| d.code == errors::INCLUDE) || dialect::imports(file.text());
    // Geometry stages of GLSL 1.20 are enabled, and have words and qualifiers that no version has.
    let of_old_stages = shader.extensions().iter().any(|e| e.name.ends_with("_geometry_shader4"));
    let extended = shader.requires_unknown_extension() || of_old_stages;
    let many = asked.len() > conditions::MOST_ASKED;
    // Two of them are of two shaders, of which one file has the texts.
    let again = |d: &Diagnostic| d.code == errors::REDEFINITION && file.slice(d.span) == "main";
    // Who has to put a version in front of the extensions that a text needs puts these there as well.
    let late = |d: &Diagnostic| d.code == errors::EXTENSION && syntax::needs_stated_version(file.slice(d.span));
    let when = |open: bool, what: Around| if open { what } else { Around::empty() };
    // Anyone may define a macro that nothing in the text defines.
    Around::VALUES
        // Who puts a version in front may put more there.
        | when(!versioned, Around::NAMES)
        | when(!versioned && found.iter().any(late), Around::ENABLED)
        | when(unknown_stage, Around::STAGE)
        | when(joined, Around::NAMES | Around::ENABLED | Around::MACROS)
        | when(rewritten, Around::GRAMMAR)
        | when(extended, Around::NAMES | Around::TYPES)
        // Of what depends on many names, each of them alone says little.
        | when(found.iter().any(again), Around::WHOLE)
        | when(many, Around::NAMES | Around::TYPES | Around::MACROS)
        | when(is_piece, Around::all().difference(Around::TYPES))
}

fn has_main(shader: &Shader) -> bool {
    // Entry points of WGSL have any name, and stand there where the grammar ends before them.
    if shader.wgsl().is_some() {
        return marks::ENTRY_POINTS.iter().any(|mark| shader.file().text().contains(mark));
    }
    shader.tokens().iter().any(|t| t.kind == TokenKind::Word && shader.file().slice(t.span) == "main")
}

/// A text and what it leaves open.
pub struct Surroundings<'a> {
    shader: &'a Shader,
    conditions: &'a Conditions,
    /// Macros that an `#if` asks for and nothing in the text defines.
    asked: BTreeSet<String>,
    open: Around,
    /// A file that it includes is not there.
    lacks_file: bool,
    /// It lacks names of which none that it has was meant.
    lacks_names: bool,
}

impl<'a> Surroundings<'a> {
    /// Those of a text in which these errors were found.
    pub fn new(shader: &'a Shader, conditions: &'a Conditions, found: &[Diagnostic]) -> Self {
        let mut asked = conditions.undefined(true);
        asked.retain(|name| !shader.defines().iter().any(|(own, _)| own == name));
        Self::with(shader, conditions, found, asked)
    }

    /// Those of a text that is in order whatever its host defines: as it stands, and so far as it is read otherwise.
    pub fn of_whole(shader: &'a Shader, conditions: &'a Conditions, found: &[Diagnostic]) -> Self {
        Self::with(shader, conditions, found, BTreeSet::new())
    }

    fn with(shader: &'a Shader, conditions: &'a Conditions, found: &[Diagnostic], asked: BTreeSet<String>) -> Self {
        let lacks_file = found.iter().any(|d| d.code == errors::INCLUDE);
        let lacks_names = found.iter().any(|d| rests(d).contains(Around::NAMES | Around::VALUES) && !is_slip(d));
        Self { shader, conditions, open: of(shader, &asked, found), asked, lacks_file, lacks_names }
    }

    /// True for an error that rests on something open, or on anything of `more`; what stands in a macro aside.
    pub fn leave_open(&self, error: &Diagnostic, more: Around) -> bool {
        self.rests(error).difference(Around::VALUES).intersects(self.open | more)
    }

    /// What an error rests on: what its code does, and what its place shows.
    fn rests(&self, error: &Diagnostic) -> Around {
        let file = self.shader.file();
        let mut rests = rests(error);
        if slip::is_plain(self.shader, error) {
            rests.remove(Around::GRAMMAR | Around::VALUES | Around::WHOLE);
        }
        // Of a module only those are told that are slips.
        if error.code == errors::UNKNOWN_DIRECTIVE && self.shader.wgsl().is_some() {
            rests = Around::empty();
        }
        // Where more than the version is stated elsewhere, so may a name be; and where other names are, so may one that is like
        // another.
        let like_others = || self.lacks_names && resembles_global(self.shader, error);
        if is_slip(error) && !self.open.contains(Around::ENABLED) && !like_others() {
            rests.remove(Around::NAMES);
        }
        if errors::is_name(error.code) || !self.is_at_macro(error) {
            rests.remove(Around::VALUES);
        }
        // Several texts are one stage, and one of them has its `main`.
        if error.code == errors::MISSING_MAIN && error.span.is_empty() {
            return Around::all();
        }
        // What is filled in makes a text that holds.
        let is_filled_in = || self.shader.holes().iter().any(|hole| hole.span.touches(error.span));
        if errors::is_of_the_text(error.code) && is_filled_in() {
            return Around::all();
        }
        // An engine calls this `main` from its own.
        if error.code == errors::FUNCTION && file.slice(error.span) == "main" {
            rests |= Around::NAMES;
        }
        // A file may have further overloads of built-in functions too.
        if error.code == errors::NO_OVERLOAD && self.lacks_file {
            rests |= Around::NAMES;
        }
        if is_bindless(file, error) {
            rests |= Around::ENABLED;
        }
        // A block may include its members.
        if error.code == errors::UNKNOWN_FIELD && self.open.contains(Around::MACROS) && self.may_have_more(error) {
            rests |= Around::NAMES;
        }
        if error.code == errors::CONSTRUCTOR && file.expansion(error.span).is_some() {
            rests |= Around::GRAMMAR;
        }
        rests
    }

    /// True for a member of a structure or block that is not all there: a directive stands among its members.
    fn may_have_more(&self, error: &Diagnostic) -> bool {
        let shader = self.shader;
        let structure = shader.arena().iter().find_map(|(_, e)| match &e.kind {
            ExprKind::Field { base, field } if field.span == error.span => match shader.type_of(*base) {
                Type::Struct(structure) => Some(structure.span),
                _ => None,
            },
            _ => None,
        });
        let declared = structure.and_then(|name| shader.unit().items.iter().find(|i| i.span.contains(name.start)));
        declared.is_none_or(|item| shader.file().slice(item.span).contains('#'))
    }

    /// True for an error at a macro that nothing in the text defines.
    fn is_at_macro(&self, error: &Diagnostic) -> bool {
        let beside = self.open.contains(Around::MACROS)
            && error.code == errors::SYNTAX
            && (at_macro(self.shader, error) || behind_word(self.shader, error) || at_call(self.shader, error));
        beside
            || is_at_unknown_macro(self.shader, self.conditions, error)
            || is_of_unknown_value(self.shader, &self.asked, error)
    }
}

/// What an error rests on, as far as its code and its word say it.
pub fn rests(error: &Diagnostic) -> Around {
    let mut rests = errors::rests_on(error.code);
    let word = error.file.slice(error.span);
    // No text declares names of the language: versions have them, and stages.
    if errors::is_name(error.code) && (word.starts_with("gl_") || BuiltinFunction::from_name(word).is_some()) {
        rests = Around::STAGE | Around::TYPES;
    }
    // Another name is meant.
    if error.code == errors::MISSING_MAIN && !error.span.is_empty() {
        rests.remove(Around::NAMES);
    }
    // What stands in front may define the outputs of old versions as variables.
    if error.code == errors::REDECLARATION && ["gl_FragColor", "gl_FragData"].contains(&word) {
        rests |= Around::NAMES;
    }
    // Another text may have further overloads.
    if error.code == errors::NO_OVERLOAD && BuiltinFunction::from_name(word).is_none() {
        rests |= Around::NAMES;
    }
    rests
}

/// True for a name that comes with another, which was meant. A slip happens once in the code, unless what is meant stands further down;
/// and what the text has in quotes as well, in a comment or in data in front, is known to its host by that name.
pub fn is_slip(error: &Diagnostic) -> bool {
    let word = error.file.slice(error.span);
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let once = || {
        let code = marks::without_comments(error.file.text());
        code.split(|c| !part(c)).filter(|w| *w == word).nth(1).is_none()
    };
    let quoted = || error.file.text().contains(&format!("\"{word}\""));
    errors::is_name(error.code) && error.help.is_some() && (!error.related.is_empty() || once()) && !quoted()
}

/// True for a name that is like one which the text declares at file scope. What stands around an open text declares names there
/// as well, and calls them alike: `lightColor` beside `lightColors`.
pub fn resembles_global(shader: &Shader, error: &Diagnostic) -> bool {
    let Some(meant) = error.help.as_deref().and_then(|help| help.split('`').nth(1)) else { return false };
    let mut symbols = shader.symbols().map(|(_, symbol)| symbol).filter(|symbol| symbol.name == meant).peekable();
    if symbols.peek().is_none() {
        return shader.functions().any(|(_, function)| function.name.name == meant);
    }
    symbols.all(|s| matches!(s.kind, SymbolKind::Global(_) | SymbolKind::BlockMember(_) | SymbolKind::BlockInstance(_)))
}

/// True for an error that is none where a name stands for something else: another function, or one more of them.
pub fn is_of_another(error: &Diagnostic) -> bool {
    [errors::NO_OVERLOAD, errors::REDEFINITION].contains(&error.code)
}

/// True for an error about types in a line with a macro that an `#ifdef` of the text asks for: whoever defines it says what it stands for,
/// which may be a vector.
pub fn is_of_unknown_value(shader: &Shader, asked: &BTreeSet<String>, error: &Diagnostic) -> bool {
    let rests = errors::rests_on(error.code);
    if !rests.contains(Around::VALUES) || rests.intersects(Around::NAMES | Around::WHOLE) {
        return false;
    }
    let file = shader.file();
    let line = file.position(error.span.start).line;
    shader.tokens().iter().any(|token| {
        token.place == TokenPlace::Text
            && asked.contains(file.slice(token.span))
            && file.position(token.span.start).line == line
    })
}

/// True for an error at a word in capitals, or behind one: a macro that another text defines.
fn at_macro(shader: &Shader, error: &Diagnostic) -> bool {
    let file = shader.file();
    let tokens = shader.tokens();
    // Comments and directives may stand between.
    let before = &tokens[..tokens.partition_point(|t| t.span.end <= error.span.start)];
    let last = before.iter().rev().find(|t| t.place == TokenPlace::Text);
    is_macro(file.slice(error.span)) || last.is_some_and(|token| is_macro(file.slice(token.span)))
}

/// True for an error at the second of two words in a line, of which an include may define the first: `inline float f()`.
fn behind_word(shader: &Shader, error: &Diagnostic) -> bool {
    let (file, tokens) = (shader.file(), shader.tokens());
    let at = tokens.partition_point(|t| t.span.start < error.span.start);
    let [before, own] = tokens.get(at.saturating_sub(1)..=at).unwrap_or(&[]) else { return false };
    let line = |token: &Token| file.position(token.span.start).line;
    [before, own].iter().all(|token| token.kind == TokenKind::Word) && line(before) == line(own)
}

/// True for an error in or behind a line outside of all blocks that is a call and ends there, `Declare(1)`: a macro that an
/// include may define.
fn at_call(shader: &Shader, error: &Diagnostic) -> bool {
    let text = shader.file().text();
    let is_call = |line: &str| {
        let line = line.split("//").next().unwrap_or(line);
        let Some((name, arguments)) = line.trim_end().split_once('(') else { return false };
        let words = ["if", "for", "while", "switch", "return", "layout"];
        syntax::words::identifier(name) == name.trim_end()
            && !name.is_empty()
            && !words.contains(&name.trim_end())
            && arguments.ends_with(')')
    };
    let start = text[..error.span.start].rfind('\n').map_or(0, |at| at + 1);
    let own = text[start..].lines().next().unwrap_or("");
    let before = text[..start].lines().rev().find(|line| !line.trim().is_empty());
    is_call(own) || before.is_some_and(is_call)
}

/// True for an error at a word in capitals that no text in sight defines: a qualifier or a type, as an engine calls it.
fn is_at_unknown_macro(shader: &Shader, conditions: &Conditions, error: &Diagnostic) -> bool {
    let file = shader.file();
    // `layout(FORMAT, binding = 0)`
    let qualifier = error.code == errors::LAYOUT && is_macro(file.slice(error.span));
    if !qualifier && !errors::rests_on(error.code).contains(Around::GRAMMAR | Around::VALUES) {
        return false;
    }
    let tokens = shader.tokens();
    let last = tokens[..tokens.partition_point(|t| t.span.end <= error.span.start)].last();
    let last = last.map_or("", |token| file.slice(token.span));
    let undefined = |word: &str| is_macro(word) && !conditions.defined.contains(word);
    // Where the macro is defined, what it stands for may use one that is not.
    let body = file.expansion(error.span).and_then(|e| e.definition);
    let body = body.map_or("", |at| file.text()[at.end..].lines().next().unwrap_or(""));
    let mut words = body.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    // A slip happens once. Who puts a version in front puts macros there.
    let again = |word: &str| {
        shader.version().span.is_none() || tokens.iter().filter(|t| file.slice(t.span) == word).nth(1).is_some()
    };
    let wanted = |word: &str| undefined(word) && again(word);
    wanted(file.slice(error.span)) || wanted(last) || words.any(undefined)
}

/// True for a text in a shader's file that is C++: shaders in raw strings, which host code includes.
pub fn is_raw_string_file(text: &str) -> bool {
    let opens =
        |at: usize| text[at + 2..].find(['(', '"', '\n']).is_some_and(|end| text[at + 2 + end..].starts_with('('));
    let in_front = |at: usize| text[..at].rsplit('\n').next().unwrap_or("").trim();
    text.match_indices("R\"")
        .any(|(at, _)| opens(at) && (in_front(at).is_empty() || in_front(at).ends_with(['=', '('])))
}

/// True for a macro that nothing defines where the text defines one with nearly its name.
pub fn is_slip_of_macro(shader: &Shader, name: &str) -> bool {
    base::nearest(name, Conditions::of(shader).defined.iter().map(String::as_str)).is_some()
}

/// True for a sampler that is made of a handle, which an extension in front brings.
fn is_bindless(file: &SourceFile, error: &Diagnostic) -> bool {
    const OPAQUE: [&str; 6] = ["sampler", "isampler", "usampler", "image", "iimage", "uimage"];
    let at = &file.text()[error.span.start..];
    error.code == errors::CONSTRUCTOR && OPAQUE.iter().any(|word| at.starts_with(word))
}

/// For each error, whether it stays whatever is defined from outside of that which an `#if` asks and the text does not
/// define: each name by itself, and all of them. Where a definition leaves the place of an error out, it says nothing, but of
/// an `#error`, which is there to be left out.
fn under_conditions(shader: &Shader, asked: &BTreeSet<String>, found: &[Diagnostic]) -> Vec<bool> {
    if asked.len() > conditions::MOST_ASKED {
        return vec![true; found.len()];
    }
    let mut kept = vec![true; found.len()];
    for defines in conditions::each_and_all(asked) {
        let defines = [&defines[..], shader.defines()].concat();
        let other = shader.with_defines(&defines);
        for (kept, error) in kept.iter_mut().zip(found).filter(|(kept, _)| **kept) {
            let left_out = conditions::place_of(&other.shader, error.span) == Some(TokenPlace::Inactive);
            // An `#error` asks whoever defines macros for one of them.
            let asks = error.code == errors::ERROR_DIRECTIVE;
            *kept = if left_out { !asks } else { stands_in(&other.diagnostics, error) };
        }
    }
    kept
}

/// True where the same error stands at the same place.
pub fn stands_in(found: &[Diagnostic], error: &Diagnostic) -> bool {
    found.iter().any(|d| d.code == error.code && d.span.start == error.span.start)
}

/// What a host may state in front of a text without a version: the oldest and newest of each language.
const ANY_VERSION: [(u32, Profile); 3] = [(100, Profile::Es), (310, Profile::Es), (460, Profile::Compatibility)];

/// Takes out what is in order in a version that suits the text no worse. Where it stands, names are not told.
fn under_versions(shader: &Shader, found: &[Diagnostic], kept: &mut [bool], versions: &[(u32, Profile)]) {
    // What stands in front declares names and states precisions as well.
    let of_names = |d: &Diagnostic| rests(d).contains(Around::NAMES);
    let told = found.iter().filter(|d| !of_names(d)).count();
    if told == 0 {
        return;
    }
    for &(number, profile) in versions {
        let other = Shader::parse_behind(shader.file(), shader.stage(), Version { number, profile, span: None });
        let other = other.diagnostics;
        if other.iter().filter(|d| !of_names(d)).count() > told {
            continue;
        }
        for (kept, error) in kept.iter_mut().zip(found).filter(|(_, d)| !of_names(d)) {
            *kept &= stands_in(&other, error);
        }
    }
}

/// For each error of a text without a version, whether it stays in every version of GLSL ES that suits the text.
pub fn holds_in_es(shader: &Shader, found: &[Diagnostic]) -> Vec<bool> {
    let mut kept = vec![true; found.len()];
    if shader.version().span.is_none() {
        under_versions(shader, found, &mut kept, &ANY_VERSION[..2]);
    }
    kept
}

/// True for a text with words that later versions have no more.
fn is_old(shader: &Shader) -> bool {
    const OLD: [&str; 6] = ["attribute", "varying", "gl_FragColor", "gl_Vertex", "gl_FragData", "ftransform"];
    let is = |t: &Token| {
        t.kind == TokenKind::Word && t.place == TokenPlace::Text && OLD.contains(&shader.file().slice(t.span))
    };
    shader.tokens().iter().any(is)
}

/// True where other texts may declare the name that a module in WGSL lacks: the module is a piece, or filled in, or another
/// text was found to declare it. What it imports is there: without it, nothing is known to be lacking.
pub fn declares_elsewhere(shader: &Shader, error: &Diagnostic) -> bool {
    let is_whole = |m: &Module| !m.entry_points.is_empty() && !m.varies && !m.filled;
    error.why.is_some() || !shader.wgsl().is_some_and(is_whole)
}

/// True for a name that a module in WGSL lacks and that host code has somewhere: it may put a declaration in front. Of a text in
/// GLSL, host code looks names up as well, and has to say that it defines this one.
pub fn is_of_host(project: &Project, shader: &Shader, error: &Diagnostic) -> bool {
    let name = error.file.slice(error.span);
    if !errors::is_name(error.code) || name.is_empty() {
        return false;
    }
    let of_wgsl = shader.wgsl().is_some();
    // A module in a string is itself a part of its host file.
    let own = |host: &HostFile| {
        let rest = error.file.name().strip_prefix(host.file.name());
        if rest.is_some_and(|rest| rest.starts_with('#')) { error.file.text().matches(name).count() } else { 0 }
    };
    let has = |host: &HostFile| {
        let text = host.file.text();
        text.contains(name) && marks::has_word(text, name) && text.matches(name).count() > own(host)
    };
    if of_wgsl { project.hosts().any(has) } else { project.hosts().any(|host| is_defined_in(host.file.text(), name)) }
}

/// True for a name in quotes behind what speaks of definitions: `defineVector(out, "plane", v)`, `defines["WIDE"] = n`.
fn is_defined_in(text: &str, name: &str) -> bool {
    text.match_indices(name).any(|(at, _)| {
        let quoted = |quote: char| text[..at].ends_with(quote) && text[at + name.len()..].starts_with(quote);
        let line = text[..at].rfind('\n').map_or(0, |end| end + 1);
        (quoted('"') || quoted('\'')) && text[line..at].to_ascii_lowercase().contains("define")
    })
}

/// True for an error that is about a name, or at a macro: something in front may declare it.
pub fn is_about_a_name(error: &Diagnostic) -> bool {
    errors::is_name(error.code) || (error.code == errors::SYNTAX && is_macro(error.file.slice(error.span)))
}

/// True for what leaves a text in order: what is no error, and one at a value that hosts define, which is a name in capitals, or a
/// macro that has two values.
pub fn leaves_in_order(found: &Diagnostic) -> bool {
    let defined = || found.file.line_at(found.span.start).trim_start().starts_with('#');
    let of_host = || found.code == errors::UNKNOWN_NAME || (found.code == errors::MACRO && defined());
    found.severity < Severity::Error || (is_macro(found.file.slice(found.span)) && of_host())
}

/// Names that hosts supply, as texts show that lack the same ones.
pub struct Supplied(bool);

/// In how many different texts a name is missing that a host supplies.
const MISSING_IN: usize = 3;

/// How many such names there are where a host supplies them: copies of a text have one mistake.
const MISSING_NAMES: usize = 2;

/// What the shaders of a project lack together.
pub fn supplied(project: &Project) -> Supplied {
    let mut missing: HashMap<&str, HashSet<Cow<'_, str>>> = HashMap::new();
    for shader in project.shaders() {
        for error in shader.front_end.iter().filter(|d| errors::is_name(d.code) && d.help.is_none()) {
            // What several texts take in is one.
            let included = || error.file.origin(error.span).0.text().to_owned();
            let text = if error.file.is_assembled() { included().into() } else { error.file.text().into() };
            missing.entry(error.file.slice(error.span)).or_default().insert(text);
        }
    }
    Supplied(missing.values().filter(|texts| texts.len() >= MISSING_IN).count() >= MISSING_NAMES)
}

impl Supplied {
    /// True for an error that goes away when the host supplies a name.
    pub fn may_be(&self, error: &Diagnostic) -> bool {
        self.0 && errors::is_name(error.code) && error.help.is_none()
    }
}

/// Marks at which the grammar ends again and again in a project: another tool reads its texts before a compiler does.
pub struct Marks<'p>(HashSet<&'p str>);

/// In how many different lines such a mark stands: a slip happens once, and copies of a text have one mistake.
const MARKED: usize = 3;

/// What the texts of a project have in common that is no GLSL.
pub fn repeated_marks(project: &Project) -> Marks<'_> {
    let mut lines: HashMap<&str, HashSet<&str>> = HashMap::new();
    for (error, mark) in project.shaders().flat_map(marked) {
        let line = error.file.position(error.span.start).line;
        lines.entry(mark).or_default().insert(error.file.line_text(line).trim());
    }
    Marks(lines.into_iter().filter(|(_, lines)| lines.len() >= MARKED).map(|(mark, _)| mark).collect())
}

impl Marks<'_> {
    /// True for a text with such a mark: nothing of it says what is wrong in GLSL.
    pub fn are_in(&self, shader: &ShaderFile) -> bool {
        !self.0.is_empty() && marked(shader).any(|(_, mark)| self.0.contains(mark))
    }
}

/// Errors of the grammar with the mark that each stands at; what is filled in is known.
fn marked(shader: &ShaderFile) -> impl Iterator<Item = (&Diagnostic, &str)> {
    let holes = shader.shader.holes();
    let found = shader.front_end.iter().chain(&shader.on_request);
    let found = found.filter(|error| !holes.iter().any(|hole| hole.span.touches(error.span)));
    found.filter_map(|error| Some((error, mark(error)?)))
}

/// The mark that an error of the grammar stands at; none at a word, or at what ends or divides something: there something is
/// missing in front.
fn mark(error: &Diagnostic) -> Option<&str> {
    if ![errors::SYNTAX, errors::TOKEN].contains(&error.code) {
        return None;
    }
    let rest = error.file.text().get(error.span.start..)?.trim_start_matches([' ', '\t']);
    let first = rest.chars().next().filter(|c| !c.is_alphanumeric() && !"_;,.(){}=\r\n".contains(*c))?;
    Some(&rest[..first.len_utf8()])
}

/// True for what is wrong in whatever a text without its context is put into.
pub fn holds_anywhere(code: Code) -> bool {
    let of_rules = code.0.starts_with('T') || code.0 == "N014";
    let rests = errors::rests_on(code);
    // What is left out may be the `return`.
    if code == errors::RETURN_TYPE {
        return false;
    }
    // The front end gives codes of rules as well.
    if rests.is_empty() { of_rules } else { !rests.intersects(!(Around::TYPES | Around::VALUES)) }
}
