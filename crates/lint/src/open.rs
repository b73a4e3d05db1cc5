//! What a host puts around a text: errors that may be right with its help are told on request.
//!
//! A text without `main` and `#version` is a piece of a shader; one with an `#include`, or with characters of another
//! preprocessor, is put together before it is compiled; what an `#if` asks may be set from outside; and a name that
//! nothing declares may be declared in a piece, or in a text that host code writes.

#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, HashMap, HashSet};

use base::diagnostic::{Code, Diagnostic};
use base::text::SourceFile;
use syntax::ast::ItemKind;
use syntax::{BuiltinFunction, Profile, Shader, Stage, Token, TokenKind, TokenPlace, Version, errors, is_macro};

use super::conditions::{self, Conditions};
use super::dialect;
use super::project::Project;

/// Errors about names, which something in front of the text can declare.
const NAMES: &[Code] = &[errors::UNKNOWN_NAME, errors::UNKNOWN_FUNCTION, errors::UNKNOWN_TYPE];

/// Errors that a text in front of this one can repair: names, macros, extensions and versions.
const REPAIRED_IN_FRONT: &[Code] = &[
    errors::TOKEN,
    errors::UNKNOWN_DIRECTIVE,
    errors::DIRECTIVE,
    errors::CONDITIONAL,
    errors::ERROR_DIRECTIVE,
    errors::UNKNOWN_NAME,
    errors::UNKNOWN_FUNCTION,
    errors::UNKNOWN_TYPE,
    errors::MISSING_MAIN,
    errors::LAYOUT,
    errors::VARIABLE_TYPE,
    errors::NEEDS_VERSION,
    errors::EXTENSION,
    errors::IMPLICIT_FLOAT,
    errors::FLOAT_SUFFIX,
    errors::PRECISION,
];

/// Errors that depend on the stage.
const OF_THE_STAGE: &[Code] =
    &[errors::QUALIFIER, errors::LAYOUT, errors::NEEDS_VERSION, errors::EXTENSION, errors::PLACEMENT];

/// Errors inside of functions that hold in every shader that the function is put into.
const OF_A_FUNCTION: &[Code] = &[
    errors::NO_OVERLOAD,
    errors::ASSIGN_TYPE,
    errors::OPERAND_TYPE,
    errors::INDEX,
    errors::CONDITION_TYPE,
    errors::RETURN_TYPE,
    errors::NOT_A_PLACE,
    errors::TOO_MANY,
    errors::TOO_FEW,
    errors::ASSIGN_SIZE,
    errors::MATRIX_SIZE,
    errors::SCALAR_SWIZZLE,
    errors::SWIZZLE,
    errors::VECTOR_RELATION,
    errors::INDEX_RANGE,
    errors::READ_ONLY,
];

/// Errors that stay whatever an unknown extension or definition brings: numbers of components, the grammar, and names
/// of extensions.
const HOLDS_ANYWAY: &[Code] = &[
    errors::SYNTAX,
    errors::EXTENSION,
    errors::TOO_MANY,
    errors::TOO_FEW,
    errors::ASSIGN_SIZE,
    errors::MATRIX_SIZE,
    errors::SWIZZLE,
    errors::LATE_VERSION,
];

/// Those of the errors of a text that its host may take away.
pub fn doubtful(shader: &Shader, found: &[Diagnostic]) -> Vec<bool> {
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
    let has_main = shader.tokens().iter().any(|t| t.kind == TokenKind::Word && file.slice(t.span) == "main");
    let versioned = shader.version().span.is_some();
    // What holds nothing of a shader under the name of one is told as it is.
    let is_empty = shader.unit().items.iter().all(|i| i.kind == ItemKind::Error);
    if shader.stage() != Stage::Library && is_empty && found.iter().any(|d| d.code == errors::SYNTAX) {
        return vec![false; found.len()];
    }
    let misspelt = found.iter().any(|d| d.code == errors::MISSING_MAIN && !d.span.is_empty());
    // What is called a stage and states its version wants to be one.
    if !has_main && !misspelt && (!versioned || shader.stage() == Stage::Library) {
        // Where a piece is not whole by itself, everything may have another meaning.
        let whole = found.iter().all(|d| OF_A_FUNCTION.contains(&d.code) && !is_of_the_user(file, d));
        let mut kept = vec![whole; found.len()];
        if whole && !versioned {
            under_versions(shader, found, &mut kept, &ANY_VERSION);
        }
        return kept.into_iter().map(|kept| !kept).collect();
    }
    let filled_in = dialect::is_filled_in(shader);
    let joined = filled_in || found.iter().any(|d| dialect::is_foreign(file, d)) || dialect::imports(file.text());
    let replaced = filled_in || found.iter().any(|d| d.code != errors::INCLUDE && dialect::is_foreign(file, d));
    let conditions = Conditions::of(shader);
    let mut kept = under_conditions(shader, &conditions, found);
    if !versioned {
        // What is written for the first versions is compiled as such where nobody states another.
        under_versions(shader, found, &mut kept, if is_old(shader) { &ANY_VERSION[..1] } else { &ANY_VERSION });
    }
    // Geometry stages of GLSL 1.20 are enabled, and have words and qualifiers that no version has.
    let of_old_stages = shader.extensions().iter().any(|e| e.name.ends_with("_geometry_shader4"));
    let open = shader.requires_unknown_extension() || of_old_stages;
    let asked = conditions.undefined(true);
    let unknown_stage = shader.stage() == Stage::Library;
    let of = |(error, kept): (&Diagnostic, bool)| {
        !kept
            || (joined && (REPAIRED_IN_FRONT.contains(&error.code) || is_bindless(file, error)))
            || (joined && is_of_the_user(file, error))
            || (open && !HOLDS_ANYWAY.contains(&error.code))
            || (error.code == errors::MISSING_MAIN && error.span.is_empty())
            || is_at_unknown_macro(shader, &conditions, error)
            || is_of_unknown_value(shader, &asked, error)
            // What a template fills in may be what is missing.
            || (filled_in && [errors::REDECLARATION, errors::INITIALISER].contains(&error.code))
            || (filled_in && error.code == errors::CONSTRUCTOR && file.expansion(error.span).is_some())
            // An engine calls this `main` from its own.
            || (!versioned && error.code == errors::FUNCTION && file.slice(error.span) == "main")
            || (joined && error.code == errors::SYNTAX && (replaced || at_macro(shader, error)))
            // A tool may cut the text apart at its marks.
            || (replaced && error.code == errors::REDEFINITION)
            || (unknown_stage && OF_THE_STAGE.contains(&error.code))
            // Who puts a version in front may put more there; a slip comes with what was meant.
            || (!versioned && NAMES.contains(&error.code) && error.help.is_none())
    };
    found.iter().zip(kept).map(of).collect()
}

/// Errors about types of values.
const OF_VALUES: &[Code] = &[
    errors::ASSIGN_TYPE,
    errors::ASSIGN_SIZE,
    errors::OPERAND_TYPE,
    errors::CONSTRUCTOR,
    errors::NO_OVERLOAD,
    errors::RETURN_TYPE,
];

/// True for an error about types in a line with a macro that an `#ifdef` of the text asks for: whoever defines it says what it stands for,
/// which may be a vector.
pub fn is_of_unknown_value(shader: &Shader, asked: &BTreeSet<String>, error: &Diagnostic) -> bool {
    if !OF_VALUES.contains(&error.code) {
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

/// True for a call of a function of the text, of which another text may have further overloads.
fn is_of_the_user(file: &SourceFile, error: &Diagnostic) -> bool {
    error.code == errors::NO_OVERLOAD && BuiltinFunction::from_name(file.slice(error.span)).is_none()
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

/// True for an error at a word in capitals that no text in sight defines: a qualifier or a type, as an engine calls it.
fn is_at_unknown_macro(shader: &Shader, conditions: &Conditions, error: &Diagnostic) -> bool {
    let file = shader.file();
    // `layout(FORMAT, binding = 0)`
    let qualifier = error.code == errors::LAYOUT && is_macro(file.slice(error.span));
    if !qualifier && ![errors::SYNTAX, errors::REDEFINITION].contains(&error.code) {
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
pub fn is_slip(shader: &Shader, name: &str) -> bool {
    base::nearest(name, Conditions::of(shader).defined.iter().map(String::as_str)).is_some()
}

/// True for a sampler that is made of a handle, which an extension in front brings.
fn is_bindless(file: &SourceFile, error: &Diagnostic) -> bool {
    const OPAQUE: [&str; 6] = ["sampler", "isampler", "usampler", "image", "iimage", "uimage"];
    let at = &file.text()[error.span.start..];
    error.code == errors::CONSTRUCTOR && OPAQUE.iter().any(|word| at.starts_with(word))
}

/// For each error, whether it stays whatever is defined from outside of that which an `#if` asks and the text does not
/// define: each name by itself, and all of them. Where a definition leaves the place of an error out, it says nothing.
fn under_conditions(shader: &Shader, conditions: &Conditions, found: &[Diagnostic]) -> Vec<bool> {
    let asked = conditions.undefined(true);
    if asked.len() > conditions::MOST_ASKED {
        return found.iter().map(|d| HOLDS_ANYWAY.contains(&d.code)).collect();
    }
    let mut kept = vec![true; found.len()];
    for defines in conditions::each_and_all(&asked) {
        let other = Shader::parse_with(shader.file(), shader.stage(), &defines);
        for (kept, error) in kept.iter_mut().zip(found).filter(|(kept, _)| **kept) {
            let left_out = conditions::place_of(&other.shader, error.span) == Some(TokenPlace::Inactive);
            *kept = left_out || stands_in(&other.diagnostics, error);
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
    let of_names = |code: Code| NAMES.contains(&code) || [errors::MISSING_MAIN, errors::PRECISION].contains(&code);
    let told = found.iter().filter(|d| !of_names(d.code)).count();
    if told == 0 {
        return;
    }
    for &(number, profile) in versions {
        let other = Shader::parse_behind(shader.file(), shader.stage(), Version { number, profile, span: None });
        let other = other.diagnostics;
        if other.iter().filter(|d| !of_names(d.code)).count() > told {
            continue;
        }
        for (kept, error) in kept.iter_mut().zip(found).filter(|(_, d)| !of_names(d.code)) {
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

/// Names that hosts can put in front of the shaders of a project: words of pieces, and those of texts that host code
/// writes and that are no whole shader.
pub fn names_in_front(project: &Project) -> HashSet<String> {
    let mut names = HashSet::new();
    let mut add = |text: &str| {
        let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        names.extend(words.filter(|w| w.len() > 1).map(str::to_owned));
    };
    for (_, shader) in project.shader_files() {
        if shader.shader.function("main").is_none() {
            let shader = &shader.shader;
            let code =
                shader.tokens().iter().filter(|t| t.kind == TokenKind::Word).map(|t| shader.file().slice(t.span));
            code.for_each(&mut add);
        }
    }
    for host in project.hosts() {
        let mut at = 0;
        for line in host.file.text().split_inclusive('\n') {
            // What a whole shader in a literal declares is its own.
            if let Some(text) = written(line).filter(|_| !host.embedded().iter().any(|e| e.place.contains(at))) {
                add(text);
            }
            at += line.len();
        }
    }
    names
}

/// The part of a line of host code that is GLSL in quotes: a definition or a declaration.
fn written(line: &str) -> Option<&str> {
    let quoted = &line[line.find('"')? + 1..];
    let starts =
        ["#define ", "uniform ", "const ", "in ", "out ", "varying ", "attribute ", "layout", "struct ", "\\n#define "];
    let declares = |start: &&str| quoted.trim_start().starts_with(*start) && quoted.len() > start.len();
    starts.iter().any(declares).then_some(quoted)
}

/// True for an error that is about a name, or at a macro: something in front may declare it.
pub fn is_about_a_name(error: &Diagnostic) -> bool {
    NAMES.contains(&error.code) || (error.code == errors::SYNTAX && is_macro(error.file.slice(error.span)))
}

/// Names that hosts supply, as texts show that lack the same ones.
pub struct Supplied(bool);

/// In how many different texts a name is missing that a host supplies.
const MISSING_IN: usize = 3;

/// How many such names there are where a host supplies them: copies of a text have one mistake.
const MISSING_NAMES: usize = 2;

/// What the shaders of a project lack together.
pub fn supplied(project: &Project) -> Supplied {
    let mut missing: HashMap<&str, HashSet<&str>> = HashMap::new();
    for shader in project.shaders() {
        for error in shader.front_end.iter().filter(|d| NAMES.contains(&d.code) && d.help.is_none()) {
            missing.entry(error.file.slice(error.span)).or_default().insert(error.file.text());
        }
    }
    Supplied(missing.values().filter(|texts| texts.len() >= MISSING_IN).count() >= MISSING_NAMES)
}

impl Supplied {
    /// True for an error that goes away when the host supplies a name.
    pub fn may_be(&self, error: &Diagnostic) -> bool {
        self.0 && NAMES.contains(&error.code) && error.help.is_none()
    }
}
