//! What hosts of WebGPU say of their modules: the files that they name, the entry points that pipelines start, and the
//! structures whose bytes go into buffers.

use std::ops::Range;

use base::text::Span;

use super::code::Code;
use super::language::Language;
use super::token::Token;

/// What a file says.
#[derive(Debug, Default)]
pub struct WebGpu {
    /// Files in WGSL that strings name.
    pub modules: Vec<String>,
    /// True when every module that the file makes is one of these.
    pub modules_are_known: bool,
    /// Names of entry points, with their places.
    pub entry_points: Vec<(String, Span)>,
    /// Structures whose bytes are given away.
    pub structures: Vec<Structure>,
}

/// A structure of the host.
#[derive(Debug)]
pub struct Structure {
    /// Its name.
    pub name: String,
    /// Place of the name.
    pub place: Span,
    /// The fields in order.
    pub fields: Vec<Field>,
}

/// A field of a structure.
#[derive(Debug)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its place.
    pub place: Span,
    /// Bytes and alignment of its type; none for a type that is not known here.
    pub extent: Option<(u64, u64)>,
}

impl WebGpu {
    /// True when there is nothing to hold against modules.
    pub fn is_empty(&self) -> bool {
        self.entry_points.is_empty() && self.structures.is_empty()
    }
}

/// True for a text that may have something to say.
pub fn may_say(text: &str) -> bool {
    text.contains("entry_point") || text.contains("entryPoint") || text.contains("Pod")
}

/// Reads a file.
pub fn read(code: &Code<'_>) -> WebGpu {
    let mut found = WebGpu::default();
    let text = |at: usize| code.tokens.get(at).and_then(|_| code.string(&(at..at + 1)));
    for at in 0..code.tokens.len() {
        if let Some((name, _)) = text(at) {
            let path = name.split('?').next().unwrap_or(name);
            if path.ends_with(".wgsl") {
                found.modules.push(path.to_owned());
            }
        }
        let key = match code.language {
            Language::Rust => "entry_point",
            _ => "entryPoint",
        };
        if code.word(at) == Some(key) && code.is_mark(at + 1, ':') {
            let some = code.word(at + 2) == Some("Some") && code.is_mark(at + 3, '(');
            // What stands behind a string may make another of it.
            let value = if some { at + 4 } else { at + 2 };
            let ends = [',', ')', '}'].iter().any(|c| code.is_mark(value + 1, *c));
            if let Some((name, place)) = text(value).filter(|(name, _)| ends && !name.contains('{')) {
                found.entry_points.push((name.to_owned(), place));
            }
        }
        if code.language == Language::Rust && code.word(at) == Some("struct") {
            found.structures.extend(structure(code, at));
        }
    }
    found.modules_are_known = modules_are_known(code.file.text(), code.language);
    found
}

/// True when the text of every module that is made stands in a file that is named in its place.
fn modules_are_known(text: &str, language: Language) -> bool {
    let behind = |mark: &str, holds: &dyn Fn(&str) -> bool| {
        text.match_indices(mark).all(|(at, _)| holds(&text[at + mark.len()..]))
    };
    if language == Language::Rust {
        let included = |rest: &str| {
            let rest = rest.trim_start();
            let inner = rest.find("Borrowed(").filter(|at| *at < 20).map_or(rest, |at| &rest[at + 9..]);
            inner.trim_start().starts_with("include_str!") || inner.starts_with("s)") || inner.starts_with("_)")
        };
        return behind("ShaderSource::Wgsl(", &included);
    }
    // `code: name`, where the name is that of an import.
    behind("createShaderModule(", &|rest| {
        let Some((_, value)) = rest.split_once("code") else { return false };
        let value = value.trim_start_matches([':', ' ']);
        let name: String = value.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let imported = |line: &str| line.contains("import") && line.contains(".wgsl") && line.contains(&name);
        !name.is_empty() && text.lines().any(imported)
    })
}

/// A structure in C's layout whose bytes may be taken as they are.
fn structure(code: &Code<'_>, at: usize) -> Option<Structure> {
    let name = code.word(at + 1)?;
    let open = (code.is_mark(at + 2, '{')).then_some(at + 2)?;
    let mut start = at;
    if start > 0 && code.is_mark(start - 1, ')') {
        start = code.other(start - 1)?;
    }
    if start > 0 && code.word(start - 1) == Some("pub") {
        start -= 1;
    }
    // Attributes in front: `#[repr(C)]`, `#[derive(…)]`.
    let mut attributes: Vec<Range<usize>> = Vec::new();
    while start > 1 && code.is_mark(start - 1, ']') {
        let bracket = code.other(start - 1)?;
        attributes.push(bracket..start);
        start = bracket.checked_sub(1).filter(|hash| code.is_mark(*hash, '#'))?;
    }
    let has = |word: &str| attributes.iter().any(|r| r.clone().any(|t| code.word(t) == Some(word)));
    let text = code.file.text();
    let pod = has("Pod") || text.contains(&format!("Pod for {name} "));
    let other = ["ShaderType", "align", "packed", "cfg"].into_iter().any(has);
    if !pod || other || !has("C") {
        return None;
    }
    let mut fields = Vec::new();
    for element in code.elements(open) {
        let colon = element.clone().find(|t| code.is_mark(*t, ':') && code.bracket(*t) == Some(open))?;
        let name = code.word(colon.checked_sub(1)?)?;
        if element.clone().any(|t| code.is_mark(t, '#')) {
            return None;
        }
        let ty = colon + 1..element.end;
        fields.push(Field { name: name.to_owned(), place: code.place(colon - 1), extent: extent(code, ty) });
    }
    Some(Structure { name: name.to_owned(), place: code.place(at + 1), fields })
}

/// Bytes and alignment of a type: numbers, arrays of them, and vectors of libraries whose layout has one form.
fn extent(code: &Code<'_>, ty: Range<usize>) -> Option<(u64, u64)> {
    if let Some(Token::Mark('[')) = code.tokens.get(ty.start) {
        let close = code.other(ty.start).filter(|close| close + 1 == ty.end)?;
        let semicolon = (ty.start..close).find(|t| code.is_mark(*t, ';') && code.bracket(*t) == Some(ty.start))?;
        let (size, align) = extent(code, ty.start + 1..semicolon)?;
        let count: u64 = code.word(semicolon + 1).filter(|_| semicolon + 2 == close)?.parse().ok()?;
        return Some((size.checked_mul(count)?, align));
    }
    match (code.word(ty.start)?, ty.len()) {
        ("f32" | "u32" | "i32", 1) => Some((4, 4)),
        ("u8" | "i8", 1) => Some((1, 1)),
        ("u16" | "i16", 1) => Some((2, 2)),
        _ => None,
    }
}
