//! What host code replaces in texts: comments and words that it has in quotes.

use std::collections::HashSet;

use base::diagnostic::Diagnostic;
use syntax::{errors, is_macro};

use super::super::project::{Project, ShaderFile};

/// The texts with a comment that host code has in quotes, in whole or as a beginning: `"// PLACEHOLDER: "`. It stands for what
/// the host puts there.
pub fn with_replaced_comments(project: &Project) -> HashSet<&str> {
    let marks: Vec<&str> = project.hosts().flat_map(|host| quoted_comments(host.file.text())).collect();
    if marks.is_empty() {
        return HashSet::new();
    }
    let has = |shader: &&ShaderFile| {
        let text = shader.shader.file();
        let comments = shader.shader.comments().iter().map(|comment| text.slice(comment.span));
        comments.into_iter().any(|comment| marks.iter().any(|mark| comment.starts_with(mark)))
    };
    project.shaders().filter(has).map(|shader| shader.file.name()).collect()
}

/// Words in marks that a host has in quotes and that no shader language has: `"{PRECISION}"`, `'%COUNT%'`. The host puts
/// something in their place.
pub fn replaced_words(project: &Project) -> HashSet<&str> {
    project.hosts().flat_map(|host| quoted_words(host.file.text())).collect()
}

/// True for an error of the grammar at a word that a host replaces.
pub fn is_at_replaced_word(error: &Diagnostic, words: &HashSet<&str>) -> bool {
    let text = error.file.text();
    let near = |word: &&str| {
        let start = (error.span.start + 1).saturating_sub(word.len());
        let from = (start..=error.span.start).find(|at| text.is_char_boundary(*at)).unwrap_or(error.span.start);
        text.get(from..).is_some_and(|rest| rest.find(*word).is_some_and(|at| from + at <= error.span.start))
    };
    errors::is_of_the_text(error.code) && words.iter().any(near)
}

/// Words of capitals in braces or the like, in quotes.
fn quoted_words(text: &str) -> impl Iterator<Item = &str> {
    let quoted = |(at, open): (usize, &str)| {
        let quote = text[..at].chars().next_back().filter(|c| ['"', '\'', '`'].contains(c))?;
        let inside = text[at..].split([quote, '\n', '\\']).next()?;
        let close = match open {
            "{" => "}",
            "[" => "]",
            "<" => ">",
            other => other,
        };
        let word = inside.trim_start_matches(open).trim_end_matches(close);
        (inside.ends_with(close) && word.len() + 1 < inside.len() && word.len() > 1 && is_macro(word)).then_some(inside)
    };
    text.match_indices(['{', '[', '<', '%', '@', '$']).filter_map(quoted)
}

/// Comments in quotes that have a word in capitals.
fn quoted_comments(text: &str) -> impl Iterator<Item = &str> {
    let quoted = |(at, _): (usize, &str)| {
        let quote = text[..at].chars().next_back().filter(|c| ['"', '\'', '`'].contains(c))?;
        let inside = text[at..].split([quote, '\n', '\\']).next()?;
        let capitals = |word: &str| word.len() > 3 && is_macro(word);
        inside.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').any(capitals).then_some(inside)
    };
    text.match_indices("//").filter_map(quoted)
}
