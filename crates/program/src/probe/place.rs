//! The author's text of an expression.

use naga::{Expression, Function, Handle};

use crate::{Program, Written};
use base::text::Span;

/// The author's text of an expression, or of the statement that computes it where it has none.
pub fn span(program: &Program, function: &Function, handle: Handle<Expression>, statement: naga::Span) -> Option<Span> {
    let range = function.expressions.get_span(handle).to_range().or_else(|| statement.to_range())?;
    let span = Span::new(range.start, range.end);
    // naga's reader of WGSL has the name of a call alone.
    let call = (program.written != Written::Glsl).then(|| call(program.file.text(), span)).flatten();
    // One that goes over parts of a composed text has no text of one file.
    let in_one_file = |call: &Span| {
        let (origin, there) = program.file.origin(*call);
        origin.slice(there) == program.file.slice(*call)
    };
    Some(call.filter(in_one_file).unwrap_or(span))
}

/// A call whose name has a span, up to its closing bracket; `None` for what is no call.
fn call(text: &str, name: Span) -> Option<Span> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let (before, rest) = (text.get(..name.start)?, text.get(name.end..)?);
    let declared = before.trim_end().ends_with("fn");
    if declared || !text.get(name.start..name.end)?.chars().all(is_name) || !rest.starts_with('(') {
        return None;
    }
    let mut depth = 0_usize;
    let end = rest.find(|c| {
        depth = if c == '(' { depth + 1 } else { depth - usize::from(c == ')') };
        depth == 0
    })?;
    Some(Span::new(name.start, name.end + end + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_a_call_stands_for_the_call() {
        let text = "fn f(v: vec3f) -> f32 { return dot(normalize(v), cross(v, v)) + w; }";
        let of = |name: &str| {
            let start = text.find(name).unwrap();
            call(text, Span::new(start, start + name.len())).map(|span| &text[span.start..span.end])
        };
        assert_eq!(of("normalize"), Some("normalize(v)"));
        assert_eq!(of("dot"), Some("dot(normalize(v), cross(v, v))"));
        assert_eq!((of("w"), of("f"), of("v), cross")), (None, None, None));
        assert_eq!(call("f(", Span::new(0, 1)), None);
    }
}
