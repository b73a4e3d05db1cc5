//! Modules that a template engine of Jinja's kind fills in: `{% if … %}`, `{% for … %}` and `{{ … }}` (Tera, MiniJinja).
//!
//! The engine's values are not here. One text that it may write is read, with every byte where its author wrote it: a
//! loop once, one of several branches, and a number or a name in the place of each value.

/// What a template is made of.
enum Part {
    /// Bytes that stay.
    Text(usize, usize),
    /// A value.
    Value(usize, usize),
    /// Branches of an `if`; of anything else one.
    Branches { all: Vec<Vec<Part>>, is_if: bool },
}

/// Which branches of an `if` are taken.
#[derive(Clone, Copy, PartialEq)]
enum Taken {
    First,
    /// The first one that closes the braces that it opens, or the last one.
    Closed,
    Last,
}

/// A text that an engine may write of a template, as long as the template; `None` for what is none.
pub fn filled(text: &str) -> Option<String> {
    text.contains("{%").then_some(())?;
    let mut rest = tags(text)?.into_iter().peekable();
    let parts = block(&mut rest)?;
    rest.peek().is_none().then_some(())?;
    let written = |taken: Taken| {
        let mut out: Vec<u8> = text.bytes().map(|b| if b == b'\n' { b } else { b' ' }).collect();
        write(text, &parts, taken, &mut out);
        String::from_utf8(out).ok()
    };
    let mut all = [Taken::First, Taken::Closed, Taken::Last].into_iter().filter_map(written);
    all.find(|text| open(text) == 0)
}

/// Braces that are opened and not closed.
fn open(text: &str) -> i64 {
    text.bytes().map(|b| i64::from(b == b'{') - i64::from(b == b'}')).sum()
}

#[derive(Clone, Copy)]
enum Tag<'t> {
    Text(usize, usize),
    Value(usize, usize),
    Statement(&'t str),
}

/// The text in pieces, comments of the engine left out.
fn tags(text: &str) -> Option<Vec<Tag<'_>>> {
    let mut found = Vec::new();
    let mut at = 0;
    loop {
        let rest = &text[at..];
        let next = ["{{", "{%", "{#"].iter().filter_map(|mark| Some((rest.find(mark)?, *mark))).min();
        let Some((start, mark)) = next else {
            found.push(Tag::Text(at, text.len()));
            return Some(found);
        };
        let close = match mark {
            "{{" => "}}",
            "{%" => "%}",
            _ => "#}",
        };
        found.push(Tag::Text(at, at + start));
        let from = at + start;
        let to = from + 2 + text[from + 2..].find(close)?;
        match mark {
            "{{" => found.push(Tag::Value(from, to + 2)),
            "{%" => found.push(Tag::Statement(text[from + 2..to].trim_matches(['-', '+']).trim())),
            _ => {}
        }
        at = to + 2;
    }
}

/// The parts up to a statement that belongs to what is around them.
fn block<'t>(rest: &mut std::iter::Peekable<impl Iterator<Item = Tag<'t>>>) -> Option<Vec<Part>> {
    let mut parts = Vec::new();
    while let Some(tag) = rest.peek().copied() {
        let statement = match tag {
            Tag::Text(from, to) => {
                parts.push(Part::Text(from, to));
                rest.next();
                continue;
            }
            Tag::Value(from, to) => {
                parts.push(Part::Value(from, to));
                rest.next();
                continue;
            }
            Tag::Statement(statement) => statement,
        };
        let word = statement.split_whitespace().next().unwrap_or("");
        match word {
            "elif" | "else" => return Some(parts),
            word if word.starts_with("end") => return Some(parts),
            "if" | "for" | "block" | "macro" | "filter" | "raw" => {
                let is_if = word == "if";
                let mut all = Vec::new();
                loop {
                    rest.next();
                    all.push(block(rest)?);
                    let Some(Tag::Statement(end)) = rest.peek().copied() else { return None };
                    if end.starts_with("end") {
                        rest.next();
                        break;
                    }
                }
                parts.push(Part::Branches { all, is_if });
            }
            // `set`, `include`, `import` and the like write nothing that is here.
            _ => {
                rest.next();
            }
        }
    }
    Some(parts)
}

fn write(text: &str, parts: &[Part], taken: Taken, out: &mut [u8]) {
    for part in parts {
        match part {
            Part::Text(from, to) => out[*from..*to].copy_from_slice(&text.as_bytes()[*from..*to]),
            Part::Value(from, to) => value(text, *from, *to, out),
            Part::Branches { all, is_if } => {
                let closed = |branch: &&Vec<Part>| {
                    let mut own = vec![b' '; text.len()];
                    write(text, branch, taken, &mut own);
                    own.iter().filter(|b| **b == b'{').count() == own.iter().filter(|b| **b == b'}').count()
                };
                let branch = match taken {
                    _ if !is_if => all.first(),
                    Taken::First => all.first(),
                    Taken::Closed => all.iter().find(closed).or(all.last()),
                    Taken::Last => all.last(),
                };
                if let Some(branch) = branch {
                    write(text, branch, taken, out);
                }
            }
        }
    }
}

/// A value of the engine: a part of a name beside letters, the name of a type behind `:` and `<`, a number elsewhere.
fn value(text: &str, from: usize, to: usize, out: &mut [u8]) {
    let before = text[..from].bytes().next_back().unwrap_or(b' ');
    let word = |b: u8| b.is_ascii_alphanumeric() || b == b'_';
    let of_type = matches!(text[..from].trim_end().bytes().next_back(), Some(b':' | b'<'));
    if word(before) || of_type {
        for (k, b) in text.bytes().enumerate().take(to).skip(from) {
            out[k] = if word(b) { b } else { b'_' };
        }
        if !word(before) {
            out[from] = b'T';
        }
    } else {
        // The number stands right before its suffix, if there is one.
        out[to - 1] = b'7';
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str) -> String {
        let filled = filled(text).unwrap();
        assert_eq!(filled.len(), text.len());
        filled.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn values_become_numbers_and_names() {
        assert_eq!(told("{% set a = 1 %}let x = {{ n }}u * 2u;"), "let x = 7u * 2u;");
        assert_eq!(told("{% set a = 1 %}x_{{ names[0] }} = y;"), "x____names_0____ = y;");
        assert_eq!(told("{% set a = 1 %}var x: {{ t }};"), "var x: T__t___;");
    }

    #[test]
    fn one_branch_is_taken_and_a_loop_once() {
        assert_eq!(told("{% if a %}x{% elif b %}y{% else %}z{% endif %};"), "x ;");
        assert_eq!(told("{% for a in b -%}x{# {% #}{%- endfor %};"), "x ;");
        assert_eq!(told("{% if a %} { { {% else %} { {% endif %} }"), "{ }", "the branch that can be closed");
    }

    #[test]
    fn what_is_no_template_is_left_alone() {
        assert!(filled("let x = {{ n }};").is_none(), "placeholders alone");
        assert!(filled("{% if a %}x").is_none(), "without an end");
        assert!(filled("x % y; { x }").is_none());
    }
}
