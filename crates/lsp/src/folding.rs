//! What can be folded: bodies, comments, and parts between directives of the preprocessor.

use base::text::{SourceFile, Span};
use ls_types::{FoldingRange, FoldingRangeKind};

use crate::walk::parts;
use crate::workspace::Workspace;

impl Workspace {
    /// The foldable parts of a file, in the order of the text.
    pub fn folding(&self, name: &str) -> Vec<FoldingRange> {
        let Some(file) = self.file(name) else { return Vec::new() };
        let mut found: Vec<(usize, usize, Option<FoldingRangeKind>)> = Vec::new();
        for unit in self.own_units(name) {
            let mut add = |span: Span, kind| {
                if let (Some(start), Some(end)) =
                    (unit.place_in(name, Span::at(span.start)), unit.place_in(name, Span::at(span.end)))
                {
                    found.push((file.position(start.start).line, file.position(end.start).line, kind));
                }
            };
            parts(&unit.shader).bodies.into_iter().for_each(|body| add(body, None));
            let comments = unit.shader.comments().iter().filter(|c| c.block);
            comments.for_each(|c| add(c.span, Some(FoldingRangeKind::Comment)));
        }
        if !self.own_units(name).is_empty() {
            found.extend(conditions(file).into_iter().map(|(from, to)| (from, to, Some(FoldingRangeKind::Region))));
        }
        found.retain(|(from, to, _)| from < to);
        found.sort_by_key(|(from, to, _)| (*from, std::cmp::Reverse(*to)));
        found.dedup_by_key(|(from, _, _)| *from);
        let line = |line: usize| u32::try_from(line - 1).unwrap_or(u32::MAX);
        let range = |(from, to, kind)| FoldingRange {
            start_line: line(from),
            end_line: line(to),
            kind,
            ..FoldingRange::default()
        };
        found.into_iter().map(range).collect()
    }
}

/// From each `#if`, `#elif` and `#else` to the line before the directive that ends it.
fn conditions(file: &SourceFile) -> Vec<(usize, usize)> {
    let (mut open, mut found) = (Vec::new(), Vec::new());
    for line in 1..=file.line_count() {
        let Some(directive) = file.line_text(line).trim_start().strip_prefix('#').map(str::trim_start) else {
            continue;
        };
        if directive.starts_with("if") {
            open.push(line);
        } else if directive.starts_with("el") {
            found.extend(open.pop().map(|from: usize| (from, line - 1)));
            open.push(line);
        } else if directive.starts_with("endif") {
            found.extend(open.pop().map(|from| (from, line)));
        }
    }
    found
}
