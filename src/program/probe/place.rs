//! The author's text of an expression.

use naga::{Expression, Function, Handle, MathFunction};

use crate::program::Program;
use crate::text::Span;

/// The author's text of an expression, or of the statement that computes it.
pub fn span(program: &Program, function: &Function, handle: Handle<Expression>, statement: naga::Span) -> Option<Span> {
    let mut found = function.expressions.get_span(handle).to_range();
    // naga's GLSL front end gives calls of built-in functions no place, but their arguments have one.
    if let (None, Expression::Math { fun, arg, .. }) = (&found, &function.expressions[handle]) {
        found = function.expressions.get_span(*arg).to_range();
        if let Some(argument) = &found {
            let text = &program.lowered.edited.text;
            found = call(text, argument.start, fun).filter(|call| call.end >= argument.end).or(found);
        }
    }
    let range = found.or_else(|| statement.to_range())?;
    Some(program.lowered.edited.map.span_to_original(Span::new(range.start, range.end)))
}

/// The call of a built-in function whose first argument starts at a byte.
fn call(text: &str, argument: usize, fun: &MathFunction) -> Option<std::ops::Range<usize>> {
    // The argument may stand in parentheses of its own.
    let mut head = text.get(..argument)?.trim_end();
    loop {
        let open = head.strip_suffix('(')?.trim_end();
        let name = open.rsplit(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or_default();
        if name.is_empty() {
            head = open;
            continue;
        }
        let start = open.len() - name.len();
        return is_name(name, fun).then(|| closing(text, head.len() - 1).map(|end| start..end)).flatten();
    }
}

/// GLSL's name of a function, or naga's own for it.
fn is_name(name: &str, fun: &MathFunction) -> bool {
    let own = format!("{fun:?}").to_lowercase();
    let name = name.to_lowercase();
    own == name || matches!((name.as_str(), fun), ("atan", MathFunction::Atan2) | ("roundeven", MathFunction::Round))
}

/// Behind the parenthesis that closes the one at `open`.
fn closing(text: &str, open: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for (at, c) in text[open..].char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(open + at + 1);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_is_found_from_its_first_argument() {
        let text = "y = 2.0 * sin( (a + g(b)) ) + c;";
        let found = |fun| call(text, text.find('a').unwrap(), &fun).map(|range| &text[range]);
        assert_eq!(found(MathFunction::Sin), Some("sin( (a + g(b)) )"));
        assert_eq!(found(MathFunction::Cos), None);
        assert_eq!(call("atan(y, x", 5, &MathFunction::Atan2), None);
        assert_eq!(call("(y)", 1, &MathFunction::Sin), None);
    }
}
