//! The strings of a file, joined as the program joins them, with what they are kept under.

use base::text::{SourceFile, Span};

use super::language::{Form, Language};
use crate::host::Literal;

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

#[derive(Clone, Copy, Debug)]
enum Token<'t> {
    Word(&'t str),
    Mark(char),
    String { place: Span, inner: Span, form: Form },
}

/// The texts that may be shaders, in their order.
pub fn texts(file: &SourceFile, language: Language) -> Vec<Text> {
    let tokens = tokens(file.text(), language);
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if !matches!(tokens[at], Token::String { .. }) {
            at += 1;
            continue;
        }
        let chain = list(&tokens, at, file).unwrap_or_else(|| sum(&tokens, at, language));
        at = chain.end.max(at + 1);
        found.extend(text(file, &tokens, &chain));
    }
    found
}

/// Tokens that make one text.
struct Chain {
    /// The first token.
    start: usize,
    /// Behind the last one.
    end: usize,
    /// The strings.
    parts: Vec<usize>,
    /// What stands between them.
    between: &'static str,
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
    Some(Chain { start: start - 1, end: at + 6, parts, between, partial: false })
}

/// `"…" + "…"`, and in Python `"…" "…"`.
fn sum(tokens: &[Token<'_>], start: usize, language: Language) -> Chain {
    let (mut parts, mut end) = (vec![start], start + 1);
    let is_string = |at: usize| matches!(tokens.get(at), Some(Token::String { .. }));
    let is_plus = |at: usize| matches!(tokens.get(at), Some(Token::Mark('+')));
    loop {
        if language == Language::Python && is_string(end) {
            parts.push(end);
            end += 1;
        } else if is_plus(end) && is_string(end + 1) {
            parts.push(end + 1);
            end += 2;
        } else {
            break;
        }
    }
    let partial = is_plus(end) || start.checked_sub(1).is_some_and(is_plus);
    Chain { start, end, parts, between: "", partial }
}

fn text(file: &SourceFile, tokens: &[Token<'_>], chain: &Chain) -> Option<Text> {
    let mut partial = chain.partial;
    if is_formatted(tokens, chain, &mut partial) {
        return None;
    }
    let mut literal = Literal::default();
    let mut place: Option<Span> = None;
    for &part in &chain.parts {
        let Token::String { place: whole, inner, form } = tokens[part] else { return None };
        if place.is_some() {
            literal.made(chain.between, Span::at(inner.start));
        }
        place = Some(place.map_or(whole, |p: Span| p.to(whole)));
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

/// True when the text is a format, in which more stands than can be known.
fn is_formatted(tokens: &[Token<'_>], chain: &Chain, partial: &mut bool) -> bool {
    let before = |back: usize| chain.start.checked_sub(back).and_then(|at| tokens.get(at));
    if let Some(Token::Mark('(')) = before(1) {
        let called = if matches!(before(2), Some(Token::Mark('!'))) { before(3) } else { before(2) };
        // What a test expects of a tool that writes shaders is no shader of a program.
        const EXPECTED: [&str; 6] =
            ["toContain", "toBe", "toEqual", "toStrictEqual", "toMatch", "toMatchInlineSnapshot"];
        if matches!(called, Some(Token::Word(word)) if EXPECTED.contains(word)) {
            return true;
        }
        if matches!(called, Some(Token::Word("format" | "println" | "print" | "write" | "printf"))) {
            return true;
        }
    }
    match tokens.get(chain.end..chain.end + 2) {
        Some([Token::Mark('%'), _] | [Token::Mark('.'), Token::Word("format" | "formatted" | "format_map")]) => true,
        Some([Token::Mark('.'), Token::Word(method)]) => {
            const SAME: [&str; 8] =
                ["strip", "trim", "trimIndent", "encode", "trimStart", "trimEnd", "lstrip", "stripIndent"];
            *partial |= !SAME.contains(method);
            false
        }
        _ => false,
    }
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
        let stands_for = if before.is_empty() && behind.is_empty() { " " } else { FILLED_IN };
        literal.made(stands_for, Span::new(inner.start + hole.start, inner.start + hole.end));
        at = hole.end;
    }
    Some(filled)
}

/// Places of `${…}` from `at` on.
fn holes(text: &str, at: usize) -> impl Iterator<Item = Span> {
    let starts = text[at..].match_indices("${").map(move |(i, _)| at + i);
    starts.filter(|start| !text[..*start].ends_with('\\')).map(|start| Span::new(start, closing(text, start + 2)))
}

/// Behind the brace that ends what is filled in.
fn closing(text: &str, start: usize) -> usize {
    let mut depth = 1;
    for (i, c) in text[start..].char_indices() {
        depth = match c {
            '{' => depth + 1,
            '}' => depth - 1,
            _ => depth,
        };
        if depth == 0 {
            return start + i + 1;
        }
    }
    text.len()
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

fn tokens(text: &str, language: Language) -> Vec<Token<'_>> {
    let mut found: Vec<Token<'_>> = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let before = text[..at].chars().next_back();
        if c.is_whitespace() {
            at += c.len_utf8();
        } else if rest.starts_with(language.comment()) {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if language.has_block_comments() && rest.starts_with("/*") {
            at += rest.find("*/").map_or(rest.len(), |end| end + 2);
        } else if let Some(opening) = language.opening(rest, before) {
            let inner = at + opening.length;
            match end_of(text, inner, opening.close, opening.form) {
                Some(end) => {
                    let after = end + opening.close.len();
                    if opening.form != Form::Character {
                        let (place, inner) = (Span::new(at, after), Span::new(inner, end));
                        found.push(Token::String { place, inner, form: opening.form });
                    }
                    at = after;
                }
                None => at += opening.length,
            }
        } else if c.is_alphanumeric() || c == '_' {
            let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            found.push(Token::Word(&rest[..length]));
            at += length;
        } else if language == Language::JavaScript && c == '/' && begins_pattern(found.last()) {
            at += pattern(rest);
        } else {
            found.push(Token::Mark(c));
            at += c.len_utf8();
        }
    }
    found
}

/// Where a string ends whose text begins at `start`; none for one that does not.
fn end_of(text: &str, start: usize, close: &str, form: Form) -> Option<usize> {
    let mut at = start;
    loop {
        let rest = text.get(at..)?;
        let c = rest.chars().next()?;
        if rest.starts_with(close) {
            return Some(at);
        }
        let escapes = !matches!(form, Form::Raw | Form::RawTemplate);
        match c {
            '\\' if escapes => at += 1 + rest[1..].chars().next().map_or(0, char::len_utf8),
            '\n' if matches!(form, Form::Line | Form::Character) => return None,
            // `'a'` and no more: else it is a lifetime, or a word in prose.
            _ if form == Form::Character && at > start => return None,
            '$' if form == Form::Template && rest.starts_with("${") => at = closing(text, at + 2),
            _ => at += c.len_utf8(),
        }
    }
}

/// True when a `/` behind this token begins a regular expression.
fn begins_pattern(before: Option<&Token<'_>>) -> bool {
    match before {
        None => true,
        Some(Token::Mark(mark)) => !matches!(mark, ')' | ']' | '}'),
        Some(Token::Word(word)) => matches!(*word, "return" | "typeof" | "case"),
        Some(Token::String { .. }) => false,
    }
}

/// Bytes of the regular expression at the start; one for a `/` that begins none.
fn pattern(text: &str) -> usize {
    let (mut class, mut escaped) = (false, false);
    for (i, c) in text.char_indices().skip(1) {
        match c {
            '\n' => return 1,
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '[' => class = true,
            ']' => class = false,
            '/' if !class => return i + 1,
            _ => {}
        }
    }
    1
}
