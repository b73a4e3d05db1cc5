//! Listings of TeX: `lstlisting`, `verbatim` and `minted`.

use base::text::Span;

use super::blocks::Blocks;
use crate::Literal;

const ENVIRONMENTS: [&str; 8] =
    ["lstlisting", "verbatim", "Verbatim", "minted", "alltt", "BVerbatim", "LVerbatim", "listing"];
const HEADINGS: [&str; 6] = ["\\part", "\\chapter", "\\section", "\\subsection", "\\subsubsection", "\\paragraph"];

/// Reads a whole document.
pub fn read(blocks: &mut Blocks<'_>) {
    let file = blocks.file;
    let text = file.text();
    let mut at = 0;
    while at < text.len() {
        let end = text[at..].find('\n').map_or(text.len(), |i| at + i + 1);
        let line = &text[at..end];
        // A comment says nothing.
        let shown = line.find('%').filter(|i| !line[..*i].ends_with('\\')).map_or(line, |i| &line[..i]);
        let level = HEADINGS
            .iter()
            .rposition(|h| shown.trim_start().strip_prefix(h).is_some_and(|r| r.starts_with(['{', '*', '['])));
        if let Some(level) = level {
            blocks.heading(level + 1);
        }
        let begun = ENVIRONMENTS.iter().find_map(|name| {
            let from = shown.find(&format!("\\begin{{{name}}}"))?;
            // `listing` is a float around the code of `minted`.
            (*name != "listing").then_some((*name, at + from + name.len() + "\\begin{}".len()))
        });
        at = end;
        if let Some((name, behind)) = begun {
            let (tag, inside) = head(text, behind);
            let close = format!("\\end{{{name}}}");
            let stop = text[inside..].find(&close).map_or(text.len(), |i| inside + i);
            blocks.add(&tag, Literal::part(file, Span::new(inside, stop)));
            at = stop;
        }
    }
}

/// The language in the options behind `\begin{…}`, and where the text begins.
fn head(text: &str, from: usize) -> (String, usize) {
    let mut at = from;
    let mut tag = String::new();
    while let Some((open, close)) = [('[', ']'), ('{', '}')].into_iter().find(|(o, _)| text[at..].starts_with(*o)) {
        let line = text[at..].lines().next().unwrap_or("");
        // Options may go on over lines; braces in them close what they open.
        let mut depth = 0_usize;
        let length = text[at..].char_indices().find_map(|(i, c)| {
            depth = if c == open { depth + 1 } else { depth };
            depth = if c == close { depth.saturating_sub(1) } else { depth };
            (depth == 0).then_some(i + 1)
        });
        let Some(length) = length.filter(|l| *l < 400.max(line.len())) else { break };
        let inner = &text[at + 1..at + length - 1];
        let language = inner
            .split(',')
            .find_map(|o| o.trim().strip_prefix("language=").or_else(|| o.trim().strip_prefix("language =")));
        let language = language.map(|l| l.trim().trim_matches(['{', '}']).rsplit(']').next().unwrap_or("").trim());
        if let Some(language) = language.or((open == '{').then_some(inner.trim())) {
            tag = language.to_owned();
        }
        at += length;
    }
    let rest = &text[at..];
    let blank = rest.len() - rest.trim_start_matches([' ', '\t', '\r']).len();
    let line_break = usize::from(rest[blank..].starts_with('\n'));
    (tag, if line_break == 1 { at + blank + 1 } else { at })
}
