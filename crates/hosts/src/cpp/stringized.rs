//! Shaders that a macro makes a string of: `#define GLSL(x) "#version 150\n" #x`.

use tree_sitter::Node;

use base::text::Span;

use super::embedded::Candidate;
use super::tree::{descendants, elements, span};
use crate::HostFile;
use crate::Literal;
use crate::marks;

/// A macro whose body is literals and arguments made strings.
struct Stringizer {
    name: String,
    parts: Vec<Part>,
    /// Number of parameters.
    count: usize,
}

enum Part {
    Text(String),
    Argument(usize),
}

/// The invocations of such macros in a file.
pub fn find(host: &HostFile, root: Node<'_>) -> Vec<Candidate> {
    let text = host.file.text();
    let mut macros: Vec<Stringizer> = Vec::new();
    if text.contains("#define") || text.contains("# define") {
        let all = descendants(root).filter(|n| n.kind() == "preproc_function_def");
        macros.extend(all.filter_map(|n| stringizer(host, n)));
    }
    macros.extend(of_headers(text));
    let mut found = Vec::new();
    for stringizer in &macros {
        for (at, _) in text.match_indices(stringizer.name.as_str()) {
            found.extend(invocation(host, stringizer, at));
        }
    }
    found
}

fn stringizer(host: &HostFile, definition: Node<'_>) -> Option<Stringizer> {
    let name = host.text(definition.child_by_field_name("name")?).to_owned();
    let list = definition.child_by_field_name("parameters")?;
    let mut parameters: Vec<&str> = elements(list).into_iter().map(|p| host.text(p)).filter(|p| *p != "...").collect();
    if host.text(list).contains("...") {
        parameters.push("__VA_ARGS__");
    }
    let mut rest = host.text(definition.child_by_field_name("value")?).trim();
    let mut parts = Vec::new();
    while !rest.is_empty() {
        if let Some(inner) = rest.strip_prefix('"') {
            let end = inner.find('"').filter(|e| !inner[..*e].replace("\\n", "").contains('\\'))?;
            parts.push(Part::Text(inner[..end].replace("\\n", "\n")));
            rest = inner[end + 1..].trim_start();
        } else {
            let inner = rest.strip_prefix('#')?.trim_start();
            let end = inner.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(inner.len());
            parts.push(Part::Argument(parameters.iter().position(|p| *p == &inner[..end])?));
            rest = inner[end..].trim_start();
        }
    }
    let any = parts.iter().any(|p| matches!(p, Part::Argument(_)));
    any.then_some(Stringizer { name, parts, count: parameters.len() })
}

/// Macros that a header defines. What has a function of a shader between its brackets, and is no code of the host, can only be
/// made a string.
fn of_headers(text: &str) -> Vec<Stringizer> {
    let mut found: Vec<Stringizer> = Vec::new();
    for (open, _) in text.match_indices('(') {
        let before = text[..open].trim_end();
        let name = before.rsplit(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or("");
        let is_macro =
            name.len() > 2 && name.bytes().all(|b| b.is_ascii_uppercase() || b == b'_' || b.is_ascii_digit());
        let is_value = before[..before.len() - name.len()].trim_end().ends_with(['=', '(', ',', '{']);
        let known = |own: &Stringizer| own.name == name;
        if !is_macro || !is_value || found.iter().any(known) || text.contains(&format!("define {name}")) {
            continue;
        }
        let Some((arguments, _)) = split(text, open, 1) else { continue };
        let inside = arguments.first().map_or("", |place| &text[place.range()]);
        if inside.contains('\n') && !inside.starts_with('"') && (marks::is_module(inside) || marks::has_main(inside)) {
            found.push(Stringizer { name: name.to_owned(), parts: vec![Part::Argument(0)], count: 1 });
        }
    }
    found
}

/// The invocation whose macro name stands at `at`.
fn invocation(host: &HostFile, stringizer: &Stringizer, at: usize) -> Option<Candidate> {
    let text = host.file.text();
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let line = text[..at].rsplit('\n').next().unwrap_or("");
    if text[..at].chars().next_back().is_some_and(word) || line.trim_start().starts_with('#') || line.contains("//") {
        return None;
    }
    let after = at + stringizer.name.len();
    let open = after + text[after..].find(|c: char| !c.is_whitespace())?;
    if !text[open..].starts_with('(') {
        return None;
    }
    let (arguments, end) = split(text, open, stringizer.count)?;
    let mut literal = Literal::default();
    let before = literal_before(host, at);
    if let Some(node) = before {
        literal.add(node, &host.file)?;
    }
    let name = Span::new(at, after);
    for part in &stringizer.parts {
        match part {
            Part::Text(made) => literal.made(made, name),
            Part::Argument(index) => literal.argument(&host.file, *arguments.get(*index)?),
        }
    }
    let start = before.map_or(at, |n| span(n).start);
    Some(Candidate { literal, place: Span::new(start, end), variable: variable_before(text, start), joined: false })
}

/// The arguments of an invocation, and the offset behind it. The last one takes all that is left.
fn split(text: &str, open: usize, count: usize) -> Option<(Vec<Span>, usize)> {
    let (mut depth, mut start) = (0usize, open + 1);
    let mut found = Vec::new();
    for (at, c) in text[open..].char_indices().map(|(i, c)| (open + i, c)) {
        match c {
            '(' => depth += 1,
            ')' if depth == 1 => {
                found.push(trimmed(text, Span::new(start, at)));
                return Some((found, at + 1));
            }
            ')' => depth = depth.checked_sub(1)?,
            ',' if depth == 1 && found.len() + 1 < count => {
                found.push(trimmed(text, Span::new(start, at)));
                start = at + 1;
            }
            _ => {}
        }
    }
    None
}

fn trimmed(text: &str, place: Span) -> Span {
    let inner = text.get(place.range()).unwrap_or("");
    let start = place.start + inner.len() - inner.trim_start().len();
    Span::new(start, start + inner.trim().len())
}

/// The string literal that ends right before `at`.
fn literal_before(host: &HostFile, at: usize) -> Option<Node<'_>> {
    let end = host.file.text()[..at].trim_end().len();
    let last = end.checked_sub(1).filter(|_| host.file.text()[..end].ends_with('"'))?;
    let node = host.root()?.descendant_for_byte_range(last, end)?;
    std::iter::successors(Some(node), Node::parent)
        .take_while(|n| n.end_byte() == end)
        .filter(|n| matches!(n.kind(), "string_literal" | "raw_string_literal" | "concatenated_string"))
        .last()
}

/// The variable of `name =` or `name[] =` before an offset.
fn variable_before(text: &str, at: usize) -> Option<(String, Span)> {
    let head = text[..at].trim_end().strip_suffix('=')?.trim_end();
    let head = head.strip_suffix(']').and_then(|h| h.rfind('[').map(|o| h[..o].trim_end())).unwrap_or(head);
    let name = head.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("");
    (!name.is_empty()).then(|| (name.to_owned(), Span::new(head.len() - name.len(), head.len())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variable_before_an_invocation() {
        let name = |text: &str| variable_before(text, text.len()).map(|v| v.0);
        assert_eq!(name("const char *vs = ").as_deref(), Some("vs"));
        assert_eq!(name("const char 頂点[] =").as_deref(), Some("頂点"));
        assert_eq!(name("f(").as_deref(), None);
        assert_eq!(name("頂 =").as_deref(), Some("頂"));
        assert_eq!(name("、=").as_deref(), None);
    }

    #[test]
    fn arguments_are_split_at_their_commas() {
        let split = |text: &str, count| split(text, 0, count).map(|(all, end)| (all.len(), end));
        assert_eq!(split("(150, vec2(1, 2), x) y", 2), Some((2, 20)));
        assert_eq!(split("(a; b)", 1), Some((1, 6)));
        assert_eq!(split("(a; b", 1), None);
    }
}
