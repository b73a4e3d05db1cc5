//! Templates of hosts: `{{name}}` (Handlebars, Jinja, Tera and many a `replace`), conditions, loops and files that are put in.
//!
//! Expressions are those of Jinja, which minijinja evaluates. The text around them is cut and joined here, so that every byte
//! leads back to its place. What nothing states is taken for what its place needs, and told; see [`assume`].

mod assume;
mod bare;
mod expression;
mod render;
mod tree;
mod valueless;

use base::text::{Assembly, SourceFile, Span};

use crate::stand_in::{self, Role, StandIns};

pub(crate) use bare::declared;
pub(crate) use render::{Rendered, render};
pub(crate) use valueless::assuming;

/// Lets names stand in for placeholders, for readers that run nothing: of each condition, the first branch is read. A text
/// without placeholders stays as it is.
pub(crate) fn stand_in(file: &SourceFile, defines: &[(String, String)]) -> SourceFile {
    let text = file.text();
    let found = marks(text, true);
    if found.is_empty() {
        return file.clone();
    }
    let value = |name: &str| defines.iter().find(|(defined, _)| defined == name).map(|(_, value)| value.as_str());
    let mut out = Assembly::new();
    let mut at = 0;
    // For each condition that is open, whether its text stays.
    let mut open: Vec<bool> = Vec::new();
    let mut names = StandIns::default();
    for Mark { span, what } in found {
        let kept = open.iter().all(|kept| *kept);
        if kept {
            out.copy(file, Span::new(at, span.start.max(at)));
        }
        at = span.end.max(at);
        match what {
            What::Comment => {}
            What::Value(name) if value(&name).is_some() => {
                if kept {
                    out.replace(value(&name).unwrap_or_default(), file, span);
                }
            }
            What::Value(_) => {
                if kept && !in_line_comment(text, span.start) {
                    at = names.put(file, span, &mut out);
                }
            }
            What::Other => match stand_in::role(file.slice(span)) {
                Role::Open => open.push(true),
                Role::Branch => {
                    if let Some(kept) = open.last_mut() {
                        *kept = false;
                    }
                }
                Role::Close => drop(open.pop()),
                Role::Text if kept && !in_line_comment(text, span.start) => at = names.put(file, span, &mut out),
                Role::Text | Role::Nothing => {}
            },
        }
    }
    out.copy(file, Span::new(at, text.len()));
    names.declare(file, &mut out);
    out.finish(file.name())
}

struct Mark {
    span: Span,
    what: What,
}

enum What {
    Value(String),
    Comment,
    Other,
}

/// Pairs of braces of the engines, with what stands between them on one line; of any expressions, if that is asked.
fn marks(text: &str, expressions: bool) -> Vec<Mark> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(start) = text[at..].find('{').map(|offset| at + offset) {
        at = start + 1;
        let Some((open, close)) = [("{{{", "}}}"), ("{{", "}}"), ("{%", "%}"), ("{#", "#}")]
            .into_iter()
            .find(|(open, _)| text[start..].starts_with(open))
        else {
            continue;
        };
        let inside = start + open.len();
        let Some(len) = text[inside..].find(close) else { continue };
        // Blocks within blocks are braces side by side as well, and go on over lines.
        if open != "{#" && text[inside..inside + len].contains(['\n', '\r', '{', ';']) {
            continue;
        }
        let end = inside + len + close.len();
        let part = &text[inside..inside + len];
        let expression = || (expressions && open == "{{" && !part.trim().is_empty()).then_some(What::Other);
        let Some(what) = meaning(open, part).or_else(expression) else { continue };
        found.push(Mark { span: Span::new(start, end), what });
        at = end;
    }
    found
}

/// What a pair of braces says; none for braces of the shader itself.
fn meaning(open: &str, inside: &str) -> Option<What> {
    let trimmed = inside.trim_matches(['-', '~', '&']).trim();
    let words: Vec<&str> = trimmed.split_whitespace().collect();
    let is_name = |word: &str| {
        word.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && word.chars().all(|c| c.is_alphanumeric() || "_-./".contains(c))
    };
    if open == "{#" || (open == "{{" && trimmed.starts_with('!')) {
        return Some(What::Comment);
    }
    Some(match (open, &words[..]) {
        ("{{" | "{{{", ["else"]) => What::Other,
        ("{{" | "{{{", [one]) if is_name(one) => What::Value((*one).to_owned()),
        ("{%", [_, ..]) => What::Other,
        ("{{", [first, ..]) if first.starts_with(['#', '/', '>', '^']) => What::Other,
        // A filter, a call or a path: `{{ x | upper }}`.
        ("{{", [first, "|", ..]) if is_name(first) => What::Other,
        _ => return None,
    })
}

fn in_line_comment(text: &str, at: usize) -> bool {
    let line = text[..at].rfind(['\n', '\r']).map_or(0, |end| end + 1);
    text[line..at].contains("//")
}

#[cfg(test)]
mod tests;
