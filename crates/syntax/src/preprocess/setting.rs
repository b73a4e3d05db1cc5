//! Readings of a text in which a line that defines a macro says something else.

use super::super::lexer::{Lex, Piece};
use super::Preprocessor;

/// What the line says instead.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Setting {
    /// Where its `#` stands, or the comment that holds the directive; none for a macro that no line of the text defines.
    pub at: Option<usize>,
    /// The macro.
    pub name: String,
    /// What it stands for; none where nothing is defined.
    pub value: Option<String>,
}

impl Preprocessor<'_> {
    /// Defines what stands in comments in front of this place, where the comment is not left out itself.
    pub(super) fn set_before(&mut self, at: usize) {
        while let Some(setting) = self.settings.pop_if(|setting| setting.at < Some(at)) {
            // A directive that was not reached is left out.
            let directive = |at: usize| self.sink.file.text()[at..].starts_with('#');
            let reached = !setting.at.is_some_and(directive) && self.active();
            if let Some(value) = setting.value.as_deref().filter(|_| reached) {
                self.flush();
                self.given(&setting.name, value);
            }
        }
    }

    /// True for a `#define` at this place that a setting replaces, which has been done then.
    pub(super) fn is_set(&mut self, rest: &[Piece], at: usize) -> bool {
        let Some(setting) = self.settings.pop_if(|setting| setting.at == Some(at)) else { return false };
        self.flush();
        if let Some(value) = &setting.value {
            self.given(&setting.name, value);
            let name = rest.first().filter(|piece| piece.lex == Lex::Word);
            if let Some(defined) = self.macros.get_mut(&setting.name) {
                defined.definition = name.map(|piece| piece.span);
            }
        }
        true
    }
}
