//! Blocks of Markdown: fenced and indented ones, and those of HTML between.

use pulldown_cmark::{CodeBlockKind, Event, Parser, Tag, TagEnd};

use base::text::Span;

use super::blocks::Blocks;
use super::html;
use crate::Literal;

/// Reads a whole document.
pub fn read(blocks: &mut Blocks<'_>) {
    let file = blocks.file;
    let mut tag: Option<String> = None;
    let mut lines: Vec<Span> = Vec::new();
    let mut html: Option<Span> = None;
    for (event, range) in Parser::new(file.text()).into_offset_iter() {
        let place = Span::new(range.start, range.end);
        match event {
            Event::Start(Tag::Heading { level, .. }) => blocks.heading(level as usize),
            Event::Start(Tag::CodeBlock(kind)) => {
                lines.clear();
                tag = Some(match kind {
                    CodeBlockKind::Fenced(info) => info.to_string(),
                    CodeBlockKind::Indented => String::new(),
                });
            }
            Event::Text(_) if tag.is_some() => lines.push(place),
            Event::End(TagEnd::CodeBlock) => {
                if let Some(tag) = tag.take() {
                    blocks.add(&tag, Literal::lines(file, &lines));
                }
            }
            Event::Html(_) => html = Some(html.map_or(place, |h| h.to(place))),
            Event::End(TagEnd::HtmlBlock) => {
                if let Some(place) = html.take() {
                    html::read(blocks, place);
                }
            }
            _ => {}
        }
    }
}
