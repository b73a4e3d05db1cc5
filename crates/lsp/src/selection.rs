//! What a selection grows to: names, expressions, statements, blocks, functions.

use base::text::Span;
use ls_types::SelectionRange;

use crate::walk::parts;
use crate::workspace::Workspace;

impl Workspace {
    /// The spans around a place, from the innermost to the whole file.
    pub fn selection(&self, name: &str, offset: usize) -> Option<SelectionRange> {
        let file = self.file(name)?;
        let mut spans = vec![Span::new(0, file.text().len())];
        for unit in self.own_units(name) {
            let parts = parts(&unit.shader);
            let tokens = unit.shader.tokens().iter().map(|t| t.span);
            let exprs = unit.shader.arena().iter().map(|(_, e)| e.span);
            let all = tokens.chain(exprs).chain(parts.spans).chain(parts.bodies);
            spans.extend(all.filter_map(|s| unit.place_in(name, s)).filter(|s| s.start <= offset && offset <= s.end));
        }
        spans.retain(|s| !s.is_empty());
        spans.sort_by_key(|s| (std::cmp::Reverse(s.len()), s.start));
        spans.dedup();
        let mut found: Option<SelectionRange> = None;
        let mut last = Span::new(0, file.text().len());
        for span in spans {
            // Each lies inside of the one before.
            if span.start >= last.start && span.end <= last.end {
                let range = self.encoding.range(file, span);
                found = Some(SelectionRange { range, parent: found.map(Box::new) });
                last = span;
            }
        }
        found
    }
}
