//! Which functions of a module rest on something that is taken for known.

use std::collections::HashSet;

use base::text::Span;
use syntax::TokenKind;

/// A declaration of a module.
struct Item<'t> {
    name: &'t str,
    span: Span,
    function: bool,
    /// What it mentions.
    words: HashSet<&'t str>,
}

/// The functions that have one of these places in them, and those that use what has one.
pub(super) fn resting(text: &str, places: &[usize]) -> Vec<String> {
    if places.is_empty() {
        return Vec::new();
    }
    let items = items(text);
    let has = |item: &Item<'_>| places.iter().any(|place| item.span.start <= *place && *place < item.span.end);
    let mut found: HashSet<&str> = items.iter().filter(|item| has(item)).map(|item| item.name).collect();
    loop {
        let uses = |item: &&Item<'_>| !found.contains(item.name) && !item.words.is_disjoint(&found);
        let new: Vec<&str> = items.iter().filter(uses).map(|item| item.name).collect();
        if new.is_empty() {
            break;
        }
        found.extend(new);
    }
    let mut functions: Vec<String> = items
        .iter()
        .filter(|item| item.function && found.contains(item.name))
        .map(|item| item.name.to_owned())
        .collect();
    functions.sort();
    functions.dedup();
    functions
}

/// The declarations of a module, each with the attributes in front of it.
fn items(text: &str) -> Vec<Item<'_>> {
    let tokens = syntax::wgsl::tokens(text);
    let written = |at: usize| tokens.get(at).and_then(|token| text.get(token.span.range())).unwrap_or("");
    let (mut found, mut start, mut depth) = (Vec::new(), 0, 0_usize);
    for at in 0..tokens.len() {
        match written(at) {
            "{" | "(" | "[" => depth += 1,
            ")" | "]" => depth = depth.saturating_sub(1),
            "}" => {
                depth = depth.saturating_sub(1);
                if depth == 0 {
                    found.extend(item(text, &tokens, start..at + 1));
                    start = at + 1;
                }
            }
            ";" if depth == 0 => {
                found.extend(item(text, &tokens, start..at + 1));
                start = at + 1;
            }
            _ => {}
        }
    }
    found
}

fn item<'t>(text: &'t str, tokens: &[syntax::Token], range: std::ops::Range<usize>) -> Option<Item<'t>> {
    let written = |at: usize| tokens.get(at).and_then(|token| text.get(token.span.range())).unwrap_or("");
    const KINDS: [&str; 7] = ["fn", "struct", "alias", "const", "override", "let", "var"];
    let kind = range.clone().find(|at| KINDS.contains(&written(*at)))?;
    let mut at = kind + 1;
    if written(at) == "<" {
        at = (at..range.end).find(|at| written(*at) == ">")? + 1;
    }
    let span = tokens.get(range.start)?.span.to(tokens.get(range.end - 1)?.span);
    let words = tokens[range].iter().filter(|token| token.kind == TokenKind::Word);
    let words = words.filter_map(|token| text.get(token.span.range())).collect();
    Some(Item { name: written(at), span, function: written(kind) == "fn", words })
}
