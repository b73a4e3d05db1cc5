//! Conditions at which invocations of a work group part.

use std::collections::BTreeMap;

use syntax::ast::ExprId;

use super::value::Number;
use super::walk::Walk;

/// What is known of a condition, over all visits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// All invocations that come to it find the same.
    Together,
    /// Nothing is known.
    Unknown,
    /// These two find different things.
    Apart(usize, usize),
}

/// What is known of the conditions of a kernel.
pub type Splits = BTreeMap<ExprId, Split>;

impl Walk<'_> {
    /// Keeps what a condition is for the invocations that are here.
    pub(super) fn note_split(&mut self, id: ExprId, condition: &Number) {
        let mut here = (0..self.lanes).filter(|lane| self.state.active[*lane] != 0);
        let Some(first) = here.next() else { return };
        let found = if condition.is_known() {
            let other = here.find(|lane| (condition.lane(*lane) != 0) != (condition.lane(first) != 0));
            other.map_or(Split::Together, |other| Split::Apart(first, other))
        } else if self.terms.origin_of(condition).uniform {
            Split::Together
        } else {
            Split::Unknown
        };
        let before = self.splits.get(&id).copied();
        let all = match (before, found) {
            (Some(Split::Apart(a, b)), _) => Split::Apart(a, b),
            (Some(Split::Unknown), Split::Together) => Split::Unknown,
            _ => found,
        };
        self.splits.insert(id, all);
    }
}
