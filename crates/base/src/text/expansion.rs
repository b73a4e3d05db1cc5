//! Uses of macros in a text: what a macro writes stands where it is used.
//!
//! Arguments of a macro keep their own places. Reporters ask the text for the name of the macro at a place, and
//! nothing is repaired inside a use.

use std::sync::Arc;

use super::{SourceFile, Span};

/// A use of a macro. The bytes of its arguments belong to the author; everything else that it expands to has the
/// place of the whole use.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Expansion {
    /// The use: the name, with its arguments where it has some.
    pub span: Span,
    /// The name of the macro.
    pub name: Arc<str>,
    /// The name in the `#define`; none for a macro that the text does not define.
    pub definition: Option<Span>,
}

impl SourceFile {
    /// The same text, which knows where macros are expanded in it. Texts are equal without it.
    #[must_use]
    pub fn with_expansions(mut self, mut expansions: Vec<Expansion>) -> Self {
        expansions.sort();
        expansions.dedup_by_key(|expansion| expansion.span);
        self.expansions = (!expansions.is_empty()).then(|| expansions.into());
        self
    }

    /// True when a macro is expanded somewhere.
    pub fn has_expansions(&self) -> bool {
        self.expansions.is_some()
    }

    /// The macro that wrote what has this place; none for the author's own text, arguments of macros included.
    pub fn expansion(&self, span: Span) -> Option<&Expansion> {
        let all = self.expansions.as_deref()?;
        all.binary_search_by_key(&span, |expansion| expansion.span).ok().map(|at| &all[at])
    }

    /// True for a place inside of a use of a macro, or over one of its ends: what is changed there is changed
    /// wherever the macro puts it.
    pub fn cuts_expansion(&self, span: Span) -> bool {
        let inside = |offset: usize, use_: Span| use_.start < offset && offset < use_.end;
        let cut = |e: &Expansion| {
            let ends = inside(span.start, e.span) || inside(span.end, e.span);
            let within = e.span.start <= span.start && span.end <= e.span.end && span.len() < e.span.len();
            ends || within && !span.is_empty()
        };
        self.expansions.iter().flat_map(|all| all.iter()).any(cut)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_use_is_found_by_its_whole_place_alone() {
        let plain = SourceFile::new("a.vert", "x = SQ(p + 1);");
        let at = Span::new(4, 13);
        let file = plain.clone().with_expansions(vec![Expansion { span: at, name: "SQ".into(), definition: None }]);
        assert_eq!(file.expansion(at).map(|e| &*e.name), Some("SQ"));
        assert_eq!(file.expansion(Span::new(7, 12)), None, "an argument is the author's");
        assert_eq!(file.expansion(Span::new(0, 13)), None, "so is what stands around");
        assert_eq!(file, plain);
        let cuts = [(4, 13), (0, 14), (4, 4), (13, 13), (7, 12), (7, 7), (0, 8), (4, 6)];
        let cuts = cuts.map(|(start, end)| file.cuts_expansion(Span::new(start, end)));
        assert_eq!(cuts, [false, false, false, false, true, true, true, true]);
        assert!(!plain.cuts_expansion(Span::new(7, 12)) && !plain.has_expansions());
    }
}
