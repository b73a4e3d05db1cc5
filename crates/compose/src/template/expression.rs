//! What stands between the braces of a template, evaluated by minijinja. Names that nothing states are given values first,
//! as text, so that `{{ n / 4 }}` and `{{ n }}` fit together.

use std::collections::BTreeMap;

use minijinja::value::{Kwargs, Value};
use minijinja::{Environment, Error, ErrorKind};

/// Names with values: those that are stated, and those of loops.
pub(super) type Scope = BTreeMap<String, Value>;

/// A name, with what follows it: `o_lens[0]`, `loop.first`.
pub(super) struct Path {
    pub range: std::ops::Range<usize>,
    /// Its first word.
    pub root: String,
}

/// The paths of an expression, outermost ones: no functions, filters and names of arguments.
pub(super) fn paths(text: &str) -> Vec<Path> {
    const WORDS: [&str; 12] = ["and", "or", "not", "in", "is", "if", "else", "true", "false", "none", "True", "False"];
    let bytes = text.as_bytes();
    let word = |c: u8| c.is_ascii_alphanumeric() || c == b'_';
    let mut found: Vec<Path> = Vec::new();
    let (mut at, mut piped) = (0, false);
    while at < bytes.len() {
        match bytes[at] {
            quote @ (b'"' | b'\'') => {
                at = text[at + 1..].find(char::from(quote)).map_or(bytes.len(), |end| at + end + 2);
                piped = false;
            }
            c if c.is_ascii_alphabetic() || c == b'_' => {
                let start = at;
                at += bytes[at..].iter().take_while(|c| word(**c)).count();
                let name = &text[start..at];
                let next = text[at..].trim_start();
                let named = next.starts_with('=') && !next.starts_with("==");
                let skipped = piped || WORDS.contains(&name) || next.starts_with('(') || named;
                if (name, next.starts_with(char::is_alphabetic)) != ("is", true) {
                    piped = name == "is";
                }
                if skipped {
                    continue;
                }
                loop {
                    match bytes.get(at) {
                        Some(b'.') if bytes.get(at + 1).is_some_and(|c| word(*c)) => {
                            at += 1 + bytes[at + 1..].iter().take_while(|c| word(**c)).count();
                        }
                        Some(b'[') => match closed(text, at) {
                            Some(end) => at = end,
                            None => break,
                        },
                        _ => break,
                    }
                }
                found.push(Path { range: start..at, root: name.to_owned() });
            }
            c if c.is_ascii_digit() => at += bytes[at..].iter().take_while(|c| word(**c) || **c == b'.').count(),
            c => {
                if !c.is_ascii_whitespace() {
                    piped = c == b'|';
                }
                at += 1;
            }
        }
    }
    found
}

/// Behind the bracket that closes the one at a place.
fn closed(text: &str, open: usize) -> Option<usize> {
    let mut depth = 0_usize;
    for (k, c) in text[open..].char_indices() {
        match c {
            '[' => depth += 1,
            ']' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(open + k + 1);
        }
    }
    None
}

/// A value as it is stated: a number, a truth value, a list or a text in quotes as such, all else as text.
pub(super) fn stated(text: &str) -> Value {
    let literal = text.starts_with(['[', '{', '"', '\'', '-', '+']) || text.starts_with(|c: char| c.is_ascii_digit());
    let literal = literal || matches!(text, "true" | "false");
    let value = literal.then(|| Engine::default().value(text, &Scope::new()).ok()).flatten();
    value.unwrap_or_else(|| Value::from(text))
}

pub(super) struct Engine(Environment<'static>);

impl Default for Engine {
    fn default() -> Self {
        let mut environment = Environment::new();
        environment.set_undefined_behavior(minijinja::UndefinedBehavior::Strict);
        environment.add_function("range", range);
        // Filters of Tera that Jinja writes in another way.
        environment.add_filter("nth", |all: Vec<Value>, kwargs: Kwargs| -> Result<Value, Error> {
            let n: usize = kwargs.get("n")?;
            all.get(n).cloned().ok_or_else(|| Error::new(ErrorKind::InvalidOperation, "there are fewer elements"))
        });
        environment.add_filter("replace", |text: String, kwargs: Kwargs| -> Result<String, Error> {
            let (from, to): (String, String) = (kwargs.get("from")?, kwargs.get("to")?);
            Ok(text.replace(&from, &to))
        });
        Self(environment)
    }
}

impl Engine {
    /// The value of an expression; its reason where it has none.
    pub(super) fn value(&self, expression: &str, scope: &Scope) -> Result<Value, String> {
        let told = |error: Error| error.to_string();
        let expression = of_tera(expression);
        let value = self.0.compile_expression(&expression).map_err(told)?.eval(scope).map_err(told)?;
        if value.is_undefined() { Err("it has no value".to_owned()) } else { Ok(value) }
    }
}

/// `n / 4 | int` rounds the quotient in Tera and 4 in Jinja, where nobody would write it: brackets make it that of Tera.
fn of_tera(expression: &str) -> std::borrow::Cow<'_, str> {
    let found = ["int", "round"].into_iter().find_map(|filter| {
        let sum = expression.trim_end().strip_suffix(filter)?.trim_end().strip_suffix('|')?;
        let plain = |c: char| c.is_alphanumeric() || "_.[] +-*/%".contains(c);
        let reckoned = sum.contains(['+', '-', '*', '/', '%']) && sum.chars().all(plain);
        reckoned.then(|| format!("({}) | {filter}", sum.trim()))
    });
    found.map_or(expression.into(), Into::into)
}

/// `range(n)`, `range(a, b)` of Jinja, and `range(start=a, end=b)` of Tera.
fn range(first: Option<i64>, second: Option<i64>, kwargs: Kwargs) -> Result<Vec<i64>, Error> {
    const MOST: i64 = 1 << 12;
    let (start, end) = match (first, second) {
        (Some(start), Some(end)) => (start, end),
        (Some(end), None) => (0, end),
        _ => (kwargs.get::<Option<i64>>("start")?.unwrap_or(0), kwargs.get("end")?),
    };
    if end - start > MOST {
        return Err(Error::new(ErrorKind::InvalidOperation, format!("a loop of more than {MOST} rounds")));
    }
    Ok((start..end).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_names_with_what_follows_them() {
        let found = |text: &'static str| paths(text).into_iter().map(|p| &text[p.range]).collect::<Vec<_>>();
        assert_eq!(found("o_lens[0] / 4 + loop.index0"), ["o_lens[0]", "loop.index0"]);
        assert_eq!(found("kind == \"Relu\" and not flag"), ["kind", "flag"]);
        assert_eq!(found("range(end = size) | nth(n=k)"), ["size", "k"]);
        assert_eq!(found("alpha | float"), ["alpha"]);
        assert_eq!(found("shape[chunks[1]][2]"), ["shape[chunks[1]][2]"]);
    }

    #[test]
    fn values_are_what_they_are_stated_as() {
        let (engine, mut scope) = (Engine::default(), Scope::new());
        scope.insert("n".to_owned(), stated("[256, 8]"));
        scope.insert("kind".to_owned(), stated("Relu"));
        let value = |text: &str| engine.value(text, &scope).map(|v| v.to_string());
        assert_eq!(value("n[0] / 4").as_deref(), Ok("64.0"));
        assert!(engine.value("kind == 'Relu'", &scope).unwrap().is_true());
        assert_eq!(value("n | nth(n=1)").as_deref(), Ok("8"));
        assert_eq!(value("range(end=3) | length").as_deref(), Ok("3"));
        assert!(value("missing").is_err() && value("n[0] +").is_err());
    }
}
