//! Edits on a text, and the map of positions between the text before and after.

use thiserror::Error;

use super::Span;

/// Replaces the bytes of `span` by `replacement`. An empty span inserts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// The bytes to replace, in the original text.
    pub span: Span,
    /// What stands there afterwards.
    pub replacement: String,
}

impl Edit {
    /// Replaces `span`.
    pub fn replace(span: Span, replacement: impl Into<String>) -> Self {
        Self { span, replacement: replacement.into() }
    }

    /// Inserts before the byte at `offset`.
    pub fn insert(offset: usize, text: impl Into<String>) -> Self {
        Self { span: Span::at(offset), replacement: text.into() }
    }

    /// Removes `span`.
    pub fn delete(span: Span) -> Self {
        Self { span, replacement: String::new() }
    }
}

/// Why edits cannot be applied together.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum EditConflict {
    /// Two edits touch the same bytes.
    #[error("two edits overlap at bytes {first:?} and {second:?}")]
    Overlap {
        /// The edit that starts first.
        first: Span,
        /// The edit that runs into it.
        second: Span,
    },
    /// An edit ends past the text, or cuts a character in two.
    #[error("an edit at bytes {0:?} does not lie on characters of the text")]
    OutOfText(Span),
}

/// Edits of one text, in any order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EditList {
    edits: Vec<Edit>,
}

impl EditList {
    /// No edit.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an edit. Insertions at the same offset keep the order in which they were added.
    pub fn push(&mut self, edit: Edit) {
        self.edits.push(edit);
    }

    /// The edits, in the order in which they were added.
    pub fn edits(&self) -> &[Edit] {
        &self.edits
    }

    /// True when there is no edit.
    pub fn is_empty(&self) -> bool {
        self.edits.is_empty()
    }

    /// Applies all edits at once.
    ///
    /// # Errors
    /// [`EditConflict`] when two edits overlap or one does not fit the text. Nothing is applied then.
    pub fn apply(&self, text: &str) -> Result<Edited, EditConflict> {
        let mut sorted: Vec<&Edit> = self.edits.iter().collect();
        // Stable, so that insertions at one place stay in order; an insertion goes before a
        // replacement that starts at the same byte.
        sorted.sort_by_key(|e| (e.span.start, e.span.end));
        let mut out = String::with_capacity(text.len());
        let mut pieces = Vec::with_capacity(sorted.len());
        let mut at = 0;
        let mut last: Option<Span> = None;
        for edit in sorted {
            let Span { start, end } = edit.span;
            if end > text.len() || !text.is_char_boundary(start) || !text.is_char_boundary(end) {
                return Err(EditConflict::OutOfText(edit.span));
            }
            if start < at {
                return Err(EditConflict::Overlap { first: last.unwrap_or_default(), second: edit.span });
            }
            out.push_str(&text[at..start]);
            let new = Span::new(out.len(), out.len() + edit.replacement.len());
            out.push_str(&edit.replacement);
            pieces.push(Piece { old: edit.span, new });
            at = end;
            last = Some(edit.span);
        }
        out.push_str(&text[at..]);
        let map = PositionMap { pieces, old_len: text.len(), new_len: out.len() };
        Ok(Edited { text: out, map })
    }
}

impl FromIterator<Edit> for EditList {
    fn from_iter<I: IntoIterator<Item = Edit>>(iter: I) -> Self {
        Self { edits: iter.into_iter().collect() }
    }
}

/// A text after edits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edited {
    /// The new text.
    pub text: String,
    /// Where its bytes came from.
    pub map: PositionMap,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Piece {
    old: Span,
    new: Span,
}

/// Maps byte offsets between a text and its edited form, both ways. Unchanged text maps exactly;
/// an offset inside a replacement maps to the place of the edit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PositionMap {
    pieces: Vec<Piece>,
    old_len: usize,
    new_len: usize,
}

impl PositionMap {
    /// The map of a text of `len` bytes without edits.
    pub fn identity(len: usize) -> Self {
        Self { pieces: Vec::new(), old_len: len, new_len: len }
    }

    /// Offset in the original text of an offset in the edited text. Inside a replacement: its
    /// start, or the last byte that it replaced when the offset lies that far in.
    pub fn to_original(&self, offset: usize) -> usize {
        map(&self.pieces, offset, |p| (p.new, p.old)).min(self.old_len)
    }

    /// Offset in the edited text of an offset in the original text.
    pub fn to_edited(&self, offset: usize) -> usize {
        map(&self.pieces, offset, |p| (p.old, p.new)).min(self.new_len)
    }

    /// A span of the edited text as a span of the original one.
    pub fn span_to_original(&self, span: Span) -> Span {
        let start = self.to_original(span.start);
        // The end is exclusive: map the last byte, so that an insertion right behind stays out.
        let end = if span.is_empty() { start } else { self.to_original(span.end - 1) + 1 };
        Span::new(start, end.min(self.old_len))
    }
}

fn map(pieces: &[Piece], offset: usize, sides: impl Fn(&Piece) -> (Span, Span)) -> usize {
    let after = pieces.partition_point(|p| sides(p).0.start <= offset);
    // Of several pieces at one offset (insertions), the last one that starts there decides.
    match after.checked_sub(1).map(|i| sides(&pieces[i])) {
        None => offset,
        Some((from, to)) if offset >= from.end => to.end + (offset - from.end),
        Some((from, to)) => to.start + (offset - from.start).min(to.len().saturating_sub(1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(edits: &[(usize, usize, &str)]) -> EditList {
        edits.iter().map(|&(s, e, r)| Edit::replace(Span::new(s, e), r)).collect()
    }

    #[test]
    fn positions_survive_both_ways() {
        let text = "in vec4 p0, p1; // 頂点\nuniform mat4 mc;";
        let edited = list(&[(0, 0, "layout(location=0) "), (10, 12, ";\nin vec4 ")]).apply(text).unwrap();
        for needle in ["p1", "頂点", "mc"] {
            let old = text.find(needle).unwrap();
            let new = edited.text.find(needle).unwrap();
            assert_eq!(edited.map.to_original(new), old, "{needle}");
            assert_eq!(edited.map.to_edited(old), new, "{needle}");
        }
        // Inside the insertion: the place where it was made.
        assert_eq!(edited.map.to_original(5), 0);
    }

    #[test]
    fn insertions_at_one_place_keep_their_order() {
        let edited = list(&[(1, 1, "x"), (1, 1, "y"), (1, 2, "Z")]).apply("abc").unwrap();
        assert_eq!(edited.text, "axyZc");
        assert_eq!(edited.map.to_original(4), 2);
    }

    #[test]
    fn overlapping_edits_are_refused() {
        assert!(matches!(list(&[(0, 3, "a"), (2, 4, "b")]).apply("abcdef"), Err(EditConflict::Overlap { .. })));
    }

    #[test]
    fn an_edit_that_cuts_a_character_is_refused() {
        assert!(matches!(list(&[(1, 2, "")]).apply("頂"), Err(EditConflict::OutOfText(_))));
    }

    #[test]
    fn a_mapped_span_leaves_out_an_insertion_behind_it() {
        let edited = list(&[(3, 3, "....")]).apply("abcdef").unwrap();
        assert_eq!(edited.map.span_to_original(Span::new(0, 3)), Span::new(0, 3));
    }
}
