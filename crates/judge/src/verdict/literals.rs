//! The numbers that an author wrote, before they became binary32.

use crate::tape::Literal;
use program::Program;
use program::interp::{Executable, Site, source_span};

/// What a literal of a module stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Written {
    /// The number that the module has.
    pub module: f64,
    /// The number that the author wrote, and how far that may be from what was meant.
    pub literal: Literal,
    /// How far other front ends may be from the number of the module, which fold the same expression.
    pub spread: f64,
}

impl Written {
    /// What the author wrote, where that is another number than the module's.
    pub(super) fn other(self) -> Option<Literal> {
        (self.literal != Literal { value: self.module, slack: 0.0 }).then_some(self.literal)
    }
}

/// How many units in the last place front ends may be apart that fold an expression with the functions of a library in C.
const FOLDED: f64 = 4.0;

/// Literals that are other numbers than their binary32, or are folded in several ways, by the number of their site.
/// `meant` says what literals of the text are meant to be, where that is not what is written.
pub(super) fn written(
    program: &Program,
    executable: &Executable,
    meant: Option<&dyn Fn(f64) -> f64>,
) -> Vec<Option<Written>> {
    let mut literals = vec![None; executable.site_count()];
    let meant = meant.map(|meant| program.constants.meant(meant));
    for (site, value) in executable.literals() {
        let module = f64::from(value);
        let span = source_span(executable.place(site).span);
        let written = match program.constants.find(span, value) {
            Some((at, constant)) => {
                let value = meant.as_ref().map_or_else(|| constant.value(), |meant| meant[at]);
                let literal = Literal { value, slack: 0.0 };
                Written { module, literal, spread: constant.spread(module) }
            }
            None => {
                let literal = alone(program, executable, site, value);
                let spread = match text(program, executable, site) {
                    // What is not followed here has no value to hold a front end to.
                    Some(text) if is_folded(text) => f64::INFINITY,
                    Some(_) => FOLDED * literal.slack,
                    None => 0.0,
                };
                Written { module, literal, spread }
            }
        };
        let same = Written { module, literal: Literal { value: module, slack: 0.0 }, spread: 0.0 };
        literals[site.index()] = (written != same).then_some(written);
    }
    literals
}

/// A literal that no expression of the author's text explains, by the text.
fn alone(program: &Program, executable: &Executable, site: Site, value: f32) -> Literal {
    let exact = f64::from(value);
    match text(program, executable, site).and_then(number) {
        // A text that says something else altogether is not the text of this literal.
        Some(written) if written as f32 == value => Literal { value: written, slack: 0.0 },
        _ if is_plain(value) => Literal { value: exact, slack: 0.0 },
        _ => Literal { value: exact, slack: base::value::ulp_at(exact) },
    }
}

/// Whether a text is a constant expression with calls or a remainder, of numbers alone: one rounding in it may move the
/// result as far as it likes, at a jump or where terms cancel.
fn is_folded(text: &str) -> bool {
    const TYPES: [&str; 9] = ["f32", "f16", "i32", "u32", "bool", "true", "false", "f", "u"];
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut rest = text;
    let mut computes = text.contains('%');
    while let Some(at) = rest.find(is_word) {
        let end = rest[at..].find(|c| !is_word(c)).map_or(rest.len(), |length| at + length);
        let (word, behind) = (&rest[at..end], rest[end..].trim_start());
        let is_number = word.starts_with(|c: char| c.is_ascii_digit());
        // `bitcast<f32>(1u)`
        let is_called = behind.starts_with(['(', '<']) && !is_number;
        let is_type = TYPES.contains(&word);
        let is_member = rest[..at].trim_end().ends_with('.');
        // A name, for which another text stands.
        if !is_number && !is_called && !is_type && !is_member {
            return false;
        }
        computes |= is_called && !is_constructor(word);
        rest = &rest[end..];
    }
    computes
}

/// Whether a word is a type of numbers, or of vectors or matrices of them.
fn is_constructor(word: &str) -> bool {
    const SCALARS: [&str; 7] = ["float", "int", "uint", "bool", "f32", "i32", "u32"];
    SCALARS.contains(&word)
        || word.trim_start_matches(['i', 'u', 'b', 'd']).starts_with("vec")
        || word.starts_with("mat")
}

/// The text of a site.
fn text<'p>(program: &'p Program, executable: &Executable, site: Site) -> Option<&'p str> {
    let whole = program.file.text();
    let text = whole.get(executable.place(site).span.to_range()?)?;
    Some(declared(whole, text).unwrap_or(text))
}

/// What a constant of WGSL without a type is declared as. Where such a constant is used, a module has a
/// literal in its place.
fn declared<'t>(whole: &'t str, name: &str) -> Option<&'t str> {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    if !name.starts_with(|c: char| c.is_alphabetic()) || !name.chars().all(word) {
        return None;
    }
    whole.match_indices("const").find_map(|(at, keyword)| {
        let rest = whole[at + keyword.len()..].trim_start().strip_prefix(name)?.trim_start().strip_prefix('=')?;
        Some(rest.split_once(';')?.0.trim())
    })
}

/// A number with few digits, such as 16 or 0.375, is meant as it stands.
fn is_plain(value: f32) -> bool {
    value.to_bits() & 0xfff == 0
}

/// The value of an expression of numbers, `+ - * /` and parentheses; `None` for any other text.
fn number(text: &str) -> Option<f64> {
    let mut rest = text.trim();
    let value = sum(&mut rest)?;
    rest.trim_start().is_empty().then_some(value)
}

fn sum(rest: &mut &str) -> Option<f64> {
    let mut value = product(rest)?;
    loop {
        *rest = rest.trim_start();
        match rest.chars().next() {
            Some('+') => value += operand(rest, product)?,
            Some('-') => value -= operand(rest, product)?,
            _ => return Some(value),
        }
    }
}

fn product(rest: &mut &str) -> Option<f64> {
    let mut value = factor(rest)?;
    loop {
        *rest = rest.trim_start();
        match rest.chars().next() {
            Some('*') => value *= operand(rest, factor)?,
            Some('/') => value /= operand(rest, factor)?,
            _ => return Some(value),
        }
    }
}

/// What stands behind an operator of one character.
fn operand(rest: &mut &str, read: fn(&mut &str) -> Option<f64>) -> Option<f64> {
    *rest = &rest[1..];
    read(rest)
}

fn factor(rest: &mut &str) -> Option<f64> {
    *rest = rest.trim_start();
    match rest.chars().next()? {
        '-' => operand(rest, factor).map(|value| -value),
        '+' => operand(rest, factor),
        '(' => {
            let value = operand(rest, sum)?;
            *rest = rest.trim_start().strip_prefix(')')?;
            Some(value)
        }
        _ => literal(rest),
    }
}

fn literal(rest: &mut &str) -> Option<f64> {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let mut end = digits(rest);
    let mut real = false;
    if rest[end..].starts_with('.') {
        real = true;
        end += 1 + digits(&rest[end + 1..]);
    }
    if rest[end..].starts_with(['e', 'E']) {
        let sign = usize::from(rest[end + 1..].starts_with(['+', '-']));
        let exponent = digits(&rest[end + 1 + sign..]);
        if exponent > 0 {
            real = true;
            end += 1 + sign + exponent;
        }
    }
    // Division of whole numbers means something else.
    let value = rest[..end].parse().ok().filter(|_| real)?;
    *rest = rest[end..].strip_prefix(['f', 'F']).unwrap_or(&rest[end..]);
    // `1.0x`, or `f32` of another language.
    (!rest.starts_with(|c: char| c.is_alphanumeric() || c == '_' || c == '.')).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_without_a_type_are_found_by_their_name() {
        let text = "const TAU = 6.28 ; const TAU2 = 2.0 * 6.28;";
        assert_eq!(declared(text, "TAU"), Some("6.28"));
        assert_eq!(declared(text, "TAU2"), Some("2.0 * 6.28"));
        assert_eq!(declared(text, "TA"), None);
        assert_eq!(declared(text, "6.28"), None);
    }

    #[test]
    fn texts_of_numbers_are_read_in_full() {
        for (text, value) in [
            ("6.28318530717958648", std::f64::consts::TAU),
            ("1.0/3.0", 1.0 / 3.0),
            (" -2.5e-1f ", -0.25),
            ("(1.0 + 2.0) * .5", 1.5),
            ("4.0 - 3.0 - 2.0", -1.0),
            ("+1.", 1.0),
            ("1E2", 100.0),
        ] {
            assert_eq!(number(text), Some(value), "{text}");
        }
    }

    #[test]
    fn other_texts_are_not_numbers() {
        for text in ["", "pi", "float(4)", "1.0x", "1/3", "2", "1.0 2.0", "(1.0", "0x10", "1.0e", "1..0", "１.0"] {
            assert_eq!(number(text), None, "{text}");
        }
    }

    #[test]
    fn constant_expressions_that_compute_are_told_from_others() {
        for text in [
            "5.0 % 3.0",
            "select(1.0, 2.0, !vec2<bool>(true)) % 0.7",
            "bitcast<f32>(1u)",
            "sin(1.0).x",
            "vec2f(sin(1e-6), 1.0f)",
        ] {
            assert!(is_folded(text), "{text}");
        }
        for text in
            ["6.28", "vec3<f32>(1.0, 2.0, 3.0)", "f32(3i)", "x % 2.0", "sin(turn)", "TAU * 2.0", "mix(a, b, 0.5)"]
        {
            assert!(!is_folded(text), "{text}");
        }
    }

    #[test]
    fn short_numbers_are_plain() {
        for value in [0.0, 1.0, -16.0, 0.375, 1000.0] {
            assert!(is_plain(value), "{value}");
        }
        for value in [0.1, std::f32::consts::PI, 1.0 / 3.0] {
            assert!(!is_plain(value), "{value}");
        }
    }
}
