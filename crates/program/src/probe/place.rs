//! The author's text of an expression.

use naga::{Expression, Function, Handle, MathFunction};

use crate::Program;
use base::text::Span;

/// The author's text of an expression, or of the statement that computes it.
pub fn span(program: &Program, function: &Function, handle: Handle<Expression>, statement: naga::Span) -> Option<Span> {
    let mut found = function.expressions.get_span(handle).to_range();
    if let (Some(range), Expression::Math { fun, .. }) = (&found, &function.expressions[handle]) {
        let (whole, lowered) = (Span::new(range.start, range.end), &program.lowered);
        let text = lowered.edited.text.get(range.clone()).unwrap_or_default();
        // A use of a macro, and a call that has its place.
        if lowered.file.expansion(whole).is_some() || is_call(text, fun) {
            return Some(lowered.edited.map.span_to_original(whole));
        }
    }
    // naga's GLSL front end gives calls of built-in functions no place, or that of their arguments.
    if let Expression::Math { fun, arg, .. } = &function.expressions[handle] {
        // The first argument may be a call of that kind itself.
        let mut argument = *arg;
        while let (None, Expression::Math { arg, .. }) =
            (function.expressions.get_span(argument).to_range(), &function.expressions[argument])
        {
            argument = *arg;
        }
        found = found.or_else(|| function.expressions.get_span(argument).to_range());
        if let Some(argument) = &found {
            let text = &program.lowered.edited.text;
            found = call(text, argument.start, fun).filter(|call| call.end >= argument.end).or(found);
        }
    }
    let range = found.or_else(|| statement.to_range())?;
    Some(program.lowered.edited.map.span_to_original(Span::new(range.start, range.end)))
}

/// The call of a built-in function around a byte of its first argument: the innermost one.
fn call(text: &str, argument: usize, fun: &MathFunction) -> Option<std::ops::Range<usize>> {
    let mut closed = 0_usize;
    for (at, c) in text.get(..argument)?.char_indices().rev() {
        match c {
            ')' => closed += 1,
            '(' if closed > 0 => closed -= 1,
            '(' => {
                let head = text[..at].trim_end();
                let name = head.rsplit(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or_default();
                if is_name(name, fun) {
                    return closing(text, at).map(|end| head.len() - name.len()..end);
                }
            }
            // The argument stands in one expression with the call.
            ';' | '{' | '}' => return None,
            _ => {}
        }
    }
    None
}

/// True for the text of one whole call of a built-in function.
fn is_call(text: &str, fun: &MathFunction) -> bool {
    text.find('(').is_some_and(|open| is_name(text[..open].trim_end(), fun) && closing(text, open) == Some(text.len()))
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
        assert!(is_call("sin (a + g(b))", &MathFunction::Sin) && !is_call("sin(a) + sin(b)", &MathFunction::Sin));
        let text = "f(normalize((p - q * r.w).xyz)); sin(y)";
        let found = |fun| call(text, text.find(".xyz").unwrap(), &fun).map(|range| &text[range]);
        assert_eq!(found(MathFunction::Normalize), Some("normalize((p - q * r.w).xyz)"));
        assert_eq!(found(MathFunction::Sin), None);
        assert_eq!(call("sin(x); y", 8, &MathFunction::Sin), None, "another statement");
    }
}
