//! Blocks of AsciiDoc: `[source,glsl]` with `----`, `....` or fences, or with the paragraph that follows.

use base::text::Span;

use super::blocks::Blocks;
use crate::Literal;

/// Reads a whole document.
pub fn read(blocks: &mut Blocks<'_>) {
    let file = blocks.file;
    let mut tag: Option<String> = None;
    let mut open: Option<(String, usize)> = None;
    let mut at = 0;
    for line in file.text().split_inclusive('\n') {
        let (start, end) = (at, at + line.len());
        at = end;
        let trimmed = line.trim_end();
        if let Some((mark, from)) = &open {
            let closes = if mark.is_empty() { trimmed.is_empty() } else { trimmed == mark };
            if closes || end == file.text().len() {
                let to = if closes { start } else { end };
                blocks.add(&tag.take().unwrap_or_default(), Literal::part(file, Span::new(*from, to)));
                open = None;
            }
            continue;
        }
        let level = trimmed.len() - trimmed.trim_start_matches('=').len();
        if level > 0 && trimmed[level..].starts_with(' ') {
            blocks.heading(level);
        } else if let Some(attributes) = trimmed.strip_prefix('[').and_then(|t| t.strip_suffix(']')) {
            tag = source(attributes).or(tag);
        } else if is_delimiter(trimmed) {
            open = Some((trimmed.to_owned(), end));
        } else if let Some(language) = trimmed.strip_prefix("```") {
            tag = tag.or_else(|| Some(language.to_owned()));
            open = Some(("```".to_owned(), end));
        } else if trimmed.is_empty() || trimmed.starts_with('.') {
            // A title may stand between the attributes and the block.
            tag = tag.filter(|_| !trimmed.is_empty());
        } else if tag.is_some() {
            open = Some((String::new(), start));
        }
    }
}

/// The language in the attributes of a block: `source,glsl,linenums`, `source%linenums,glsl`, `,glsl`.
fn source(attributes: &str) -> Option<String> {
    let mut parts = attributes.split(',').map(str::trim);
    let first = parts.next()?;
    let style = first.split(['%', '#', '.']).next().unwrap_or("");
    let is_source = style == "source" || style == "listing" || style.is_empty();
    let language = parts.next().unwrap_or("").trim_start_matches("language=").trim_matches('"').to_owned();
    is_source.then_some(language)
}

/// True for a line that opens and closes a listing or a literal block.
fn is_delimiter(line: &str) -> bool {
    line.len() >= 4 && (line.bytes().all(|b| b == b'-') || line.bytes().all(|b| b == b'.'))
}
