//! Lines with `#define` in strings of host code.

use super::{HostMacros, Text, heading, plain_value};
use crate::script::HostText;

/// Reads the lines of one string.
pub fn read(one: &Text, texts: &[Text], found: &mut HostMacros) {
    let HostText::String { text, at, statement, complete } = one else { return };
    if !text.contains("#define") {
        return;
    }
    let joined = text.replace("\\\n", " ");
    let mut lines = joined.split('\n').peekable();
    while let Some(line) = lines.next() {
        let Some(rest) = line.trim_start().strip_prefix("#define") else { continue };
        let rest = rest.trim();
        let name_end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let head_end = match rest[name_end..].starts_with('(') {
            true => rest.find(')').map_or(rest.len(), |end| end + 1),
            false => name_end,
        };
        let (head, body) = rest.split_at(head_end);
        let body = without_comment(body).trim();
        let is_last = lines.peek().is_none();
        let filled_in = body.contains("${") || body.contains("%") && is_filled(body) || is_braces(body) || !complete;
        match is_last.then(|| behind(one, texts)).flatten() {
            _ if heading(head).is_none() || filled_in => {}
            // What is added to the string ends the line.
            Some(Added::Value(value)) if body.is_empty() => found.add(head, &value, *at, *statement),
            Some(_) => {}
            None => found.add(head, body, *at, *statement),
        }
    }
}

enum Added {
    Value(String),
    Unknown,
}

/// What is added behind a string; none where it is whole.
fn behind(one: &Text, texts: &[Text]) -> Option<Added> {
    let k = texts.iter().position(|text| std::ptr::eq(text, one))?;
    let at = match &texts[k + 1..] {
        [HostText::Mark('<'), HostText::Mark('<'), ..] => k + 3,
        [HostText::Mark('+'), ..] => k + 2,
        _ => return None,
    };
    Some(match texts.get(at) {
        Some(HostText::String { text, complete: true, .. }) => Added::Value(text.trim_end().to_owned()),
        Some(HostText::Word(word)) => plain_value(word).map_or(Added::Unknown, |word| Added::Value(word.to_owned())),
        _ => Added::Unknown,
    })
}

fn without_comment(body: &str) -> &str {
    body.split("//").next().unwrap_or(body)
}

/// True for a body with a place that `printf` fills in.
fn is_filled(body: &str) -> bool {
    ["%d", "%i", "%u", "%s", "%f", "%g", "%zu", "%x", "%lu", "%("].iter().any(|mark| body.contains(mark))
}

/// True for a body that is a place of a formatter: `{}`, `{width}`.
fn is_braces(body: &str) -> bool {
    let inside = body.trim().strip_prefix('{').and_then(|body| body.strip_suffix('}'));
    inside.is_some_and(|inside| inside.chars().all(|c| c.is_alphanumeric() || "_:.?".contains(c)))
}
