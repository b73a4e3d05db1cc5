//! The strings of a file, joined as the program joins them, with what they are kept under.

use base::text::{SourceFile, Span};

use super::language::{Form, Language};
use super::token::{Token, closing};
use crate::Literal;

/// Tokens of a value that stands between two strings.
const LONGEST_VALUE: usize = 24;

/// Stands for what a template fills in.
const FILLED_IN: &str = "filled_in";

/// A text of a file: one string, or several that are joined.
#[derive(Clone, Debug)]
pub struct Text {
    /// The text and its places.
    pub literal: Literal,
    /// From the first to the last quotation mark.
    pub place: Span,
    /// What it is kept under, and what it is given to beside it: the nearest first.
    pub names: Vec<String>,
    /// True when something is filled in, or joined that is no string.
    pub partial: bool,
}

/// The texts that may be shaders, in their order.
pub fn texts(file: &SourceFile, language: Language, tokens: &[Token<'_>]) -> Vec<Text> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if !matches!(tokens[at], Token::String { .. }) {
            at += 1;
            continue;
        }
        let chain = list(tokens, at, file).unwrap_or_else(|| sum(tokens, at, language));
        at = chain.end.max(at + 1);
        if !(language == Language::Python && is_docstring(file, tokens, &chain)) {
            found.extend(text(file, tokens, &chain, language));
        }
    }
    found
}

/// True for a string that is a statement of its own: prose, with examples in it.
fn is_docstring(file: &SourceFile, tokens: &[Token<'_>], chain: &Chain) -> bool {
    let Some(Token::String { place, .. }) = tokens.get(chain.start) else { return false };
    let text = file.text();
    let first = text[..place.start].rsplit('\n').next().is_some_and(|before| before.trim().is_empty());
    let last = text[place.end..].split('\n').next().is_some_and(|behind| behind.trim().is_empty());
    let before = chain.start.checked_sub(1).and_then(|at| tokens.get(at));
    let of_head = matches!(before, None | Some(Token::Mark(':')));
    first && last && of_head && text[place.start..].starts_with("\"\"\"")
}

/// The strings at these places that are texts by themselves, with nothing filled in.
pub fn modules(file: &SourceFile, tokens: &[Token<'_>], places: &[Span]) -> Vec<Text> {
    let whole = |(at, token): (usize, &Token<'_>)| {
        let Token::String { place, inner, form } = *token else { return None };
        places.contains(&place).then_some(())?;
        let mut literal = Literal::default();
        match form {
            Form::Line | Form::Escaped => literal.escaped(file, inner)?,
            Form::Raw => literal.verbatim_raw(file, inner),
            Form::Template => (!template(&mut literal, file, inner, true)?).then_some(())?,
            Form::RawTemplate | Form::Braces | Form::Character => return None,
        }
        let chain =
            Chain { start: at, end: at + 1, parts: vec![at], between: "", behind_value: Vec::new(), partial: false };
        Some(Text { literal, place, names: names(file, tokens, &chain), partial: false })
    };
    tokens.iter().enumerate().filter_map(whole).collect()
}

/// True for a text with a function of a stage, as WGSL writes it.
pub fn has_entry_point(text: &str) -> bool {
    text.contains("fn ") && ["@compute", "@vertex", "@fragment"].iter().any(|stage| text.contains(stage))
}

/// The strings that hold a function of a stage in WGSL, and to which nothing is joined.
pub fn with_entry_points<'t>(file: &'t SourceFile, tokens: &'t [Token<'t>]) -> impl Iterator<Item = Span> + 't {
    tokens.iter().enumerate().filter_map(move |(at, token)| {
        let Token::String { place, inner, .. } = *token else { return None };
        let text = file.slice(inner);
        let whole = text.matches('{').count() == text.matches('}').count();
        (is_alone(tokens, at) && whole && has_entry_point(text)).then_some(place)
    })
}

/// True for a string to which nothing is joined. A call behind it, or a mark of a template in front of it, may make another
/// text of it.
pub fn is_alone(tokens: &[Token<'_>], at: usize) -> bool {
    let joins = |at: Option<usize>| {
        let token = at.and_then(|at| tokens.get(at));
        matches!(token, Some(Token::Mark('+' | '.' | '%') | Token::String { .. }))
    };
    !joins(at.checked_sub(1)) && !joins(Some(at + 1))
}

/// Tokens that make one text.
struct Chain {
    /// The first token.
    start: usize,
    /// Behind the last one.
    end: usize,
    parts: Vec<usize>,
    /// What stands between them.
    between: &'static str,
    /// Strings behind a value that is no string and joined to them.
    behind_value: Vec<usize>,
    /// True when something else is joined to them.
    partial: bool,
}

/// `["…", "…"].join("\n")`
fn list(tokens: &[Token<'_>], start: usize, file: &SourceFile) -> Option<Chain> {
    matches!(tokens.get(start.checked_sub(1)?)?, Token::Mark('[')).then_some(())?;
    let (mut parts, mut at) = (Vec::new(), start);
    loop {
        match tokens.get(at)? {
            Token::String { .. } => parts.push(at),
            Token::Mark(']') => break,
            _ => return None,
        }
        at += if matches!(tokens.get(at + 1)?, Token::Mark(',')) { 2 } else { 1 };
    }
    let [Token::Mark('.'), Token::Word("join"), Token::Mark('('), Token::String { inner, .. }, Token::Mark(')')] =
        tokens.get(at + 1..at + 6)?
    else {
        return None;
    };
    let between = match file.slice(*inner) {
        "\\n" => "\n",
        "" => "",
        _ => return None,
    };
    Some(Chain { start: start - 1, end: at + 6, parts, between, behind_value: Vec::new(), partial: false })
}

/// `"…" + "…"`, and in Python `"…" "…"`; between them values may stand: `"…" + COUNT + "…"`.
fn sum(tokens: &[Token<'_>], start: usize, language: Language) -> Chain {
    let (mut parts, mut behind_value, mut end) = (vec![start], Vec::new(), start + 1);
    let is_string = |at: usize| matches!(tokens.get(at), Some(Token::String { .. }));
    let is_plus = |at: usize| matches!(tokens.get(at), Some(Token::Mark('+')));
    loop {
        if language == Language::Python && is_string(end) {
            parts.push(end);
            end += 1;
        } else if is_plus(end) && is_string(end + 1) {
            parts.push(end + 1);
            end += 2;
        } else if is_plus(end)
            && let Some(next) = behind_value_at(tokens, end + 1)
        {
            parts.push(next);
            behind_value.push(next);
            end = next + 1;
        } else {
            break;
        }
    }
    let partial = is_plus(end) || start.checked_sub(1).is_some_and(is_plus) || !behind_value.is_empty();
    Chain { start, end, parts, between: "", behind_value, partial }
}

/// The string behind a value and a `+`: a name, a member, a call, or something in parentheses without a string.
fn behind_value_at(tokens: &[Token<'_>], start: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for at in start..tokens.len().min(start + LONGEST_VALUE) {
        match tokens[at] {
            Token::Mark('(' | '[') => depth += 1,
            Token::Mark(')' | ']') => depth = depth.checked_sub(1)?,
            Token::Mark('+') if depth == 0 && at > start => {
                return matches!(tokens.get(at + 1), Some(Token::String { .. })).then_some(at + 1);
            }
            Token::Mark('.') => {}
            Token::Mark(_) if depth > 0 => {}
            Token::Word(_) => {}
            _ => return None,
        }
    }
    None
}

fn text(file: &SourceFile, tokens: &[Token<'_>], chain: &Chain, language: Language) -> Option<Text> {
    let mut partial = chain.partial;
    let formatted = formatted(tokens, chain, &mut partial);
    if formatted == Formatted::Otherwise {
        return None;
    }
    let mut literal = Literal::default();
    let mut place: Option<Span> = None;
    for &part in &chain.parts {
        let Token::String { place: whole, inner, form } = tokens[part] else { return None };
        if let Some(before) = place {
            if chain.behind_value.contains(&part) {
                literal.made(stand_in(&literal.text), Span::new(before.end, whole.start));
            } else {
                literal.made(chain.between, Span::at(inner.start));
            }
        }
        place = Some(place.map_or(whole, |p: Span| p.to(whole)));
        let later = language == Language::Python && formatted == Formatted::No && has_double_braces(file.slice(inner));
        partial |= later;
        if formatted == Formatted::Braces || form == Form::Braces || later {
            partial |= in_braces(&mut literal, file, inner, form != Form::Raw)?;
            continue;
        }
        match form {
            Form::Line | Form::Escaped => literal.escaped(file, inner)?,
            Form::Raw => literal.verbatim_raw(file, inner),
            Form::Template => partial |= template(&mut literal, file, inner, true)?,
            Form::RawTemplate => partial |= template(&mut literal, file, inner, false)?,
            Form::Braces | Form::Character => return None,
        }
    }
    let hooks = hooks(&mut literal)?;
    Some(Text { literal, place: place?, names: names(file, tokens, chain), partial: partial || hooks })
}

/// What stands for a value in a text: a name inside of an expression, and nothing where lines are put together.
fn stand_in(before: &str) -> &'static str {
    let text = before.trim_end_matches([' ', '\t']);
    if text.is_empty() || text.ends_with([';', '}', '{', '\n', '\r']) { " " } else { FILLED_IN }
}

/// What is filled into a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Formatted {
    /// Nothing, or what its own form says.
    No,
    /// Single braces.
    Braces,
    /// More than can be known.
    Otherwise,
}

fn formatted(tokens: &[Token<'_>], chain: &Chain, partial: &mut bool) -> Formatted {
    let before = |back: usize| chain.start.checked_sub(back).and_then(|at| tokens.get(at));
    if let Some(Token::Mark('(')) = before(1) {
        let is_macro = matches!(before(2), Some(Token::Mark('!')));
        match if is_macro { before(3) } else { before(2) } {
            Some(Token::Word("format")) if is_macro => return Formatted::Braces,
            Some(Token::Word("format" | "println" | "print" | "write" | "printf")) => return Formatted::Otherwise,
            Some(Token::Word(word)) if EXPECTED.contains(word) => return Formatted::Otherwise,
            _ => {}
        }
    }
    match tokens.get(chain.end..chain.end + 2) {
        Some([Token::Mark('.'), Token::Word("format" | "format_map")]) => Formatted::Braces,
        Some([Token::Mark('%'), _] | [Token::Mark('.'), Token::Word("formatted")]) => Formatted::Otherwise,
        Some([Token::Mark('.'), Token::Word(method)]) => {
            const SAME: [&str; 8] =
                ["strip", "trim", "trimIndent", "encode", "trimStart", "trimEnd", "lstrip", "stripIndent"];
            *partial |= !SAME.contains(method);
            Formatted::No
        }
        _ => Formatted::No,
    }
}

/// What a test expects of a tool that writes shaders is no shader of a program.
const EXPECTED: [&str; 6] = ["toContain", "toBe", "toEqual", "toStrictEqual", "toMatch", "toMatchInlineSnapshot"];

/// True for a string that a test compares something with.
pub fn is_expected(tokens: &[Token<'_>], at: usize) -> bool {
    let before = |back: usize| at.checked_sub(back).and_then(|at| tokens.get(at));
    matches!((before(1), before(2)), (Some(Token::Mark('(')), Some(Token::Word(word))) if EXPECTED.contains(word))
}

/// True for a text whose blocks are in double braces: it is formatted elsewhere.
fn has_double_braces(text: &str) -> bool {
    let mut opened = text.match_indices("{{").map(|(at, _)| text[at + 2..].starts_with(['\n', '\r'])).peekable();
    opened.peek().is_some() && opened.all(|ends_line| ends_line) && text.contains("}}")
}

/// Adds the text of a format in which single braces are filled in and double ones stand for one. True when something is
/// filled in; none for braces that are no format.
fn in_braces(literal: &mut Literal, file: &SourceFile, inner: Span, escapes: bool) -> Option<bool> {
    let text = file.slice(inner);
    let (mut at, mut filled) = (0, false);
    while at < text.len() {
        let end = text[at..].find(['{', '}']).map_or(text.len(), |end| at + end);
        let double = text[end..].starts_with("{{") || text[end..].starts_with("}}");
        let plain = Span::new(inner.start + at, inner.start + end + usize::from(double));
        if escapes {
            literal.escaped(file, plain)?;
        } else {
            literal.verbatim_raw(file, plain);
        }
        if double {
            at = end + 2;
        } else if end < text.len() {
            text[end..].starts_with('{').then_some(())?;
            let hole = end + text[end..].find('}')? + 1;
            let name = |c: char| c.is_alphanumeric() || "_.[]():, ".contains(c);
            text[end + 1..hole - 1].chars().all(name).then_some(())?;
            literal.made(FILLED_IN, Span::new(inner.start + end, inner.start + hole));
            (at, filled) = (hole, true);
        } else {
            break;
        }
    }
    Some(filled)
}

/// Adds the text of a template. True when something is filled in.
fn template(literal: &mut Literal, file: &SourceFile, inner: Span, escapes: bool) -> Option<bool> {
    let text = file.slice(inner);
    let (mut at, mut filled) = (0, false);
    while at < text.len() {
        let hole = holes(text, at).next();
        let end = hole.map_or(text.len(), |hole| hole.start);
        let plain = Span::new(inner.start + at, inner.start + end);
        if escapes {
            literal.escaped(file, plain)?;
        } else {
            literal.verbatim_raw(file, plain);
        }
        let Some(hole) = hole else { break };
        filled = true;
        let line = |c: char| c == '\n';
        let before = text[..hole.start].rsplit(line).next().unwrap_or("").trim();
        let behind = text[hole.end..].split(line).next().unwrap_or("").trim();
        // Alone in its line it stands for lines.
        let lines = before.is_empty() && behind.is_empty();
        // `${N}.0`: digits of a number.
        let is_number = text[hole.end..].strip_prefix('.').is_some_and(|rest| !rest.starts_with(char::is_alphabetic));
        let stands_for = match (lines, is_number) {
            (true, _) => " ".to_owned(),
            (false, true) => "1".to_owned(),
            (false, false) => named(&text[hole.start..hole.end]),
        };
        literal.made(&stands_for, Span::new(inner.start + hole.start, inner.start + hole.end));
        at = hole.end;
    }
    Some(filled)
}

/// Stands for what is filled in: one name for each variable, or member of an object.
fn named(value: &str) -> String {
    let value = value.trim_start_matches("${").trim_end_matches('}').trim();
    let is_path = value.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.');
    let words = value.split(['.', '_']).filter(|word| is_path && !word.is_empty());
    std::iter::once(FILLED_IN).chain(words).collect::<Vec<_>>().join("_")
}

/// Places of `${…}` from `at` on.
pub fn holes(text: &str, at: usize) -> impl Iterator<Item = Span> {
    let starts = text[at..].match_indices("${").map(move |(i, _)| at + i);
    starts.filter(|start| !text[..*start].ends_with('\\')).map(|start| Span::new(start, closing(text, start + 2)))
}

/// Takes `$` out of the text: `$name` of a template becomes a name that nothing declares. True where there is one;
/// none for a text with other marks of a template.
fn hooks(literal: &mut Literal) -> Option<bool> {
    let text = &literal.text;
    let marks = ["{{", "<%", "%(", "%s", "%d", "%i", "%f", "@{", "#{", "@@"];
    let code = |line: &&str| !line.trim_start().starts_with('#') && !line.trim_start().starts_with("//");
    if marks.iter().any(|mark| text.contains(mark)) || text.lines().filter(code).any(has_angle_hook) {
        return None;
    }
    let joined = ["#include", "#pragma", "#import"].iter().any(|directive| text.contains(directive));
    let at: Vec<usize> = text.match_indices('$').map(|(at, _)| at).collect();
    at.iter().for_each(|at| literal.blank(Span::new(*at, at + 1)));
    Some(joined || !at.is_empty())
}

/// True for a line with `<name>` or `<name(…)>`.
fn has_angle_hook(line: &str) -> bool {
    line.match_indices('<').any(|(at, _)| {
        let rest = &line[at + 1..];
        let Some(end) = rest.find('>') else { return false };
        let inside = &rest[..end];
        let plain = |c: char| c.is_alphanumeric() || "_.(), ".contains(c);
        let balanced = inside.matches('(').count() == inside.matches(')').count();
        inside.starts_with(|c: char| c.is_alphabetic() || c == '_') && inside.chars().all(plain) && balanced
    })
}

/// What a text is kept under or given to.
fn names(file: &SourceFile, tokens: &[Token<'_>], chain: &Chain) -> Vec<String> {
    let token = |at: Option<usize>| at.and_then(|at| tokens.get(at)).copied();
    let mut at = chain.start.checked_sub(1);
    let back = |at: Option<usize>| at.and_then(|at| at.checked_sub(1));
    // A tag, and the parenthesis around several strings.
    if matches!(token(at), Some(Token::Word(word)) if word != "return") {
        at = back(at);
    }
    if matches!((token(at), token(back(at))), (Some(Token::Mark('(')), Some(Token::Mark('=' | ':')))) {
        at = back(at);
    }
    let written = |token: Option<Token<'_>>| match token {
        Some(Token::Word(word)) => Some(word.to_owned()),
        Some(Token::String { inner, .. }) => Some(file.slice(inner).to_owned()),
        _ => None,
    };
    let mut found = Vec::new();
    match token(at) {
        Some(Token::Mark('=')) => {
            // `name: type = …`
            let mut before = back(at);
            for _ in 0..6 {
                before = match token(before) {
                    Some(Token::Mark(':')) => {
                        found.extend(written(token(back(before))));
                        break;
                    }
                    Some(Token::Word(_) | Token::Mark('&' | '\'' | '<' | '>' | '[' | ']')) => back(before),
                    _ => break,
                };
            }
            if found.is_empty() {
                found.extend(written(token(back(at))));
            }
        }
        // Another argument is what this one is only where it is a constant or a text, as `gl.VERTEX_SHADER`.
        Some(Token::Mark(',')) => match token(back(at)) {
            Some(Token::Word(word)) if word.contains(|c: char| c.is_ascii_lowercase()) => {}
            token => found.extend(written(token)),
        },
        Some(Token::Mark(':' | '(')) => found.extend(written(token(back(at)))),
        _ => {}
    }
    found.retain(|name| !name.is_empty() && name.len() <= 60 && !name.contains(char::is_whitespace));
    found
}
