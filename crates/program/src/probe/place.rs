//! The author's text of an expression.

use naga::{Expression, Function, Handle};

use base::text::Span;

/// The author's text of an expression, or of the statement that computes it where it has none.
pub fn span(function: &Function, handle: Handle<Expression>, statement: naga::Span) -> Option<Span> {
    let range = function.expressions.get_span(handle).to_range().or_else(|| statement.to_range())?;
    Some(Span::new(range.start, range.end))
}
