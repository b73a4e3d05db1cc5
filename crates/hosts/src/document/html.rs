//! Blocks of HTML: `<pre>`, and scripts whose type is that of a shader.

use base::text::{SourceFile, Span};

use super::blocks::Blocks;
use crate::Literal;

/// Reads a part of a document.
pub fn read(blocks: &mut Blocks<'_>, place: Span) {
    let file = blocks.file;
    let text = file.slice(place);
    let mut at = 0;
    while let Some(open) = text[at..].find('<').map(|i| at + i) {
        let rest = &text[open..];
        if rest.starts_with("<!--") {
            at = rest.find("-->").map_or(text.len(), |i| open + i + 3);
            continue;
        }
        let Some(tag) = Tag::read(rest) else {
            at = open + 1;
            continue;
        };
        let inside = open + tag.length;
        at = inside;
        if let Some(level) = tag.name.strip_prefix('h').and_then(|l| l.parse::<usize>().ok()).filter(|l| *l < 7) {
            blocks.heading(level);
        }
        if !matches!(tag.name.as_str(), "pre" | "script" | "style" | "textarea") {
            continue;
        }
        let end = closing(text, inside, &tag.name);
        let body = Span::new(place.start + inside, place.start + end);
        let told = [tag.value("class"), tag.value("id"), tag.value("type")].join(" ").to_ascii_lowercase();
        match tag.name.as_str() {
            "pre" => {
                let (inner, literal) = preformatted(file, body);
                blocks.add(&language(&format!("{told} {inner}")), literal);
            }
            "script" if is_shader_type(tag.value("type")) => {
                blocks.add_whole(&format!("glsl {}", stage(&told)), body);
            }
            "script" if is_run(tag.value("type")) && !body.is_empty() => blocks.run(body),
            _ => {}
        }
        at = end;
    }
}

/// True for `x-shader/x-vertex`, `text/glsl` and the like, of which browsers run nothing.
fn is_shader_type(ty: &str) -> bool {
    let ty = ty.to_ascii_lowercase();
    ty.contains("shader") || ty.contains("glsl")
}

/// True for the type of a script that browsers run.
fn is_run(ty: &str) -> bool {
    let ty = ty.to_ascii_lowercase();
    ty.is_empty() || ty == "module" || ty.contains("javascript") || ty.contains("ecmascript")
}

/// Where the element ends that starts before `from`.
fn closing(text: &str, from: usize, name: &str) -> usize {
    let bytes = text.as_bytes();
    let ends =
        |at: usize| bytes.get(at + 2..at + 2 + name.len()).is_some_and(|n| n.eq_ignore_ascii_case(name.as_bytes()));
    text[from..].match_indices("</").map(|(i, _)| from + i).find(|at| ends(*at)).unwrap_or(text.len())
}

/// The language that classes tell: `language-glsl`, `brush: cpp`.
fn language(told: &str) -> String {
    let words = told.split(|c: char| c.is_whitespace() || ":;,".contains(c));
    let prefixes = ["language-", "lang-", "brush-", "highlight-source-"];
    let stripped = words.map(|w| prefixes.iter().fold(w, |w, p| w.strip_prefix(p).unwrap_or(w)));
    stripped.filter(|w| super::kind::is_language(w)).collect::<Vec<_>>().join(" ")
}

/// The word for the stage in the type or name of a script.
fn stage(told: &str) -> &'static str {
    let has = |word: &str| told.contains(word);
    match (has("vertex") || has("x-vert") || has("vs"), has("fragment") || has("x-frag") || has("fs")) {
        (true, false) => "vert",
        (false, true) => "frag",
        _ => "",
    }
}

/// The text of a `<pre>`: tags left out, references to characters resolved. With the classes of what it holds.
fn preformatted(file: &SourceFile, place: Span) -> (String, Literal) {
    let text = file.slice(place);
    let mut literal = Literal::default();
    let mut classes = String::new();
    let (mut at, mut plain) = (0, 0);
    let copy = |literal: &mut Literal, from: usize, to: usize| {
        literal.markup(file, Span::new(place.start + from, place.start + to));
    };
    while let Some(next) = text[at..].find(['<', '&']).map(|i| at + i) {
        let rest = &text[next..];
        if rest.starts_with('&') {
            let Some((character, length)) = reference(rest) else {
                at = next + 1;
                continue;
            };
            copy(&mut literal, plain, next);
            let written = Span::new(place.start + next, place.start + next + length);
            literal.made(character.encode_utf8(&mut [0; 4]), written);
            (at, plain) = (next + length, next + length);
        } else if let Some(tag) = Tag::read(rest) {
            copy(&mut literal, plain, next);
            classes.push_str(&format!("{} ", tag.value("class").to_ascii_lowercase()));
            let line_break = tag.name == "br";
            if line_break {
                literal.made("\n", Span::new(place.start + next, place.start + next + tag.length));
            }
            (at, plain) = (next + tag.length, next + tag.length);
        } else {
            at = next + 1;
        }
    }
    copy(&mut literal, plain, text.len());
    (classes, literal)
}

/// The character that a reference at the start of a text means, and the length of the reference.
fn reference(text: &str) -> Option<(char, usize)> {
    let end = text.get(..text.len().min(12)).or_else(|| text.get(..8)).unwrap_or(text).find(';')?;
    let name = text.get(1..end)?;
    let number = name.strip_prefix('#').map(|n| match n.strip_prefix(['x', 'X']) {
        Some(hexadecimal) => u32::from_str_radix(hexadecimal, 16),
        None => n.parse(),
    });
    let character = match (number, name) {
        (Some(number), _) => char::from_u32(number.ok()?)?,
        (None, "lt") => '<',
        (None, "gt") => '>',
        (None, "amp") => '&',
        (None, "quot") => '"',
        (None, "apos") => '\'',
        (None, "nbsp") => ' ',
        _ => return None,
    };
    Some((if character == '\u{a0}' { ' ' } else { character }, end + 1))
}

/// A tag that opens or closes an element.
struct Tag<'t> {
    /// In small letters; with `/` in front when it closes.
    name: String,
    attributes: &'t str,
    length: usize,
}

impl<'t> Tag<'t> {
    /// The tag at the start of a text. `<` in code is none.
    fn read(text: &'t str) -> Option<Self> {
        let body = text.strip_prefix('<')?;
        let slash = usize::from(body.starts_with('/'));
        let named = &body[slash..];
        let name_end = named.find(|c: char| !c.is_ascii_alphanumeric() && c != '-').unwrap_or(named.len());
        if !named.starts_with(|c: char| c.is_ascii_alphabetic()) {
            return None;
        }
        let mut quote = None;
        for (at, c) in named[name_end..].char_indices() {
            match (quote, c) {
                (None, '>') => {
                    let attributes = &named[name_end..name_end + at];
                    let name = format!("{}{}", &body[..slash], named[..name_end].to_ascii_lowercase());
                    return Some(Self { name, attributes, length: 1 + slash + name_end + at + 1 });
                }
                (None, '<') => return None,
                (None, '"' | '\'') => quote = Some(c),
                (Some(q), c) if q == c => quote = None,
                _ => {}
            }
        }
        None
    }

    /// Value of an attribute; empty when it is not there.
    fn value(&self, name: &str) -> &'t str {
        let mut rest = self.attributes;
        while let Some(at) = rest.find('=') {
            let key = rest[..at].trim_end().rsplit(|c: char| c.is_whitespace() || c == '"' || c == '\'').next();
            let behind = rest[at + 1..].trim_start();
            let (value, after) = match behind.chars().next() {
                Some(q @ ('"' | '\'')) => behind[1..].split_once(q).unwrap_or((&behind[1..], "")),
                _ => behind.split_at(behind.find(char::is_whitespace).unwrap_or(behind.len())),
            };
            if key.is_some_and(|k| k.eq_ignore_ascii_case(name)) {
                return value;
            }
            rest = after;
        }
        ""
    }
}
