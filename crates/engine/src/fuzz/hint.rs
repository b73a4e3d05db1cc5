//! Domains as they are written: `--domain "x=[0,1]"`, and comments such as
//! `// shadercheck: x in [0,1], normalised n`.

use super::domain::{Interval, Law, Stated};

/// How domains are written, for messages.
pub const FORMS: &str = "`x in [0, 1]`, `x in (0, inf)`, `x > 0`, `normalised n`, `nonzero v`, `rotation m`, `whole k`";

/// The mark that comments for this tool begin with.
pub const MARK: &str = "shadercheck:";

/// Words of comments that are about something else.
const OTHER: [&str; 2] = ["ignore", "ignore-file"];

/// Reads the value of `--domain`: `x=[0,1]`, `f.x=[0,1]`, `n=normalised`; several with `;` between.
///
/// # Errors
/// What cannot be read, with how domains are written.
pub fn option(text: &str) -> Result<Vec<Stated>, String> {
    let one = |part: &str| {
        let (input, law) = part.split_once('=').ok_or_else(|| format!("`{part}` has no `=`; write `x=[0,1]`"))?;
        let (input, law) = (name(input)?, law.trim());
        let law = match word(law) {
            Some(law) => law,
            None => Law::Within(interval(law)?),
        };
        Ok(Stated { input, law, at: "--domain".to_owned(), whole_file: true })
    };
    text.split(';').map(str::trim).filter(|part| !part.is_empty()).map(one).collect()
}

/// Reads a comment without its `//` or `/*`; none when it states no domain: it is not for this tool, or
/// silences a rule.
///
/// # Errors
/// What cannot be read, with how domains are written.
pub fn comment(text: &str, at: &str) -> Option<Result<Vec<Stated>, String>> {
    let body = text.trim_start_matches(|c: char| c.is_whitespace() || "/*!".contains(c));
    let body = body.strip_prefix(MARK)?.trim().trim_end_matches("*/").trim();
    let first = body.split(|c: char| !(c.is_alphanumeric() || c == '-' || c == '_')).next().unwrap_or("");
    if OTHER.contains(&first) {
        return None;
    }
    Some(clauses(body).into_iter().map(|part| clause(part, at)).collect())
}

/// Parts between commas and `;`, those inside of brackets left out.
fn clauses(text: &str) -> Vec<&str> {
    let (mut parts, mut start, mut depth) = (Vec::new(), 0, 0_i32);
    for (at, c) in text.char_indices() {
        match c {
            '[' | '(' => depth += 1,
            ']' | ')' => depth -= 1,
            ',' | ';' if depth <= 0 => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts.into_iter().map(str::trim).filter(|part| !part.is_empty()).collect()
}

fn clause(text: &str, at: &str) -> Result<Stated, String> {
    let stated = |input: &str, law| Ok(Stated { input: name(input)?, law, at: at.to_owned(), whole_file: false });
    if let Some((input, range)) = text.split_once(" in ") {
        return stated(input, Law::Within(interval(range.trim())?));
    }
    for (sign, open) in [(">=", false), ("<=", false), (">", true), ("<", true)] {
        let Some((input, end)) = text.split_once(sign) else { continue };
        let end = end_of(end.trim())?;
        let (low, high) = if sign.starts_with('>') { (end, f64::INFINITY) } else { (f64::NEG_INFINITY, end) };
        let interval = Interval { low, high, open_low: open && sign == ">", open_high: open && sign == "<" };
        return stated(input, Law::Within(interval));
    }
    let mut words = text.split_whitespace();
    if let (Some(a), Some(b), None) = (words.next(), words.next(), words.next()) {
        if let Some(law) = word(a) {
            return stated(b, law);
        }
        if let Some(law) = word(b) {
            return stated(a, law);
        }
    }
    Err(format!("`{text}` is no domain; write {FORMS}"))
}

fn word(text: &str) -> Option<Law> {
    Some(match text {
        "normalised" | "normalized" | "unit" => Law::Normalised,
        "nonzero" => Law::NonZero,
        "rotation" | "orthonormal" => Law::Rotation,
        "whole" | "integer" => Law::Whole,
        _ => return None,
    })
}

/// The name of an input, with members and indices.
fn name(text: &str) -> Result<String, String> {
    let text = text.trim();
    let good = |c: char| c.is_alphanumeric() || "_.[]".contains(c);
    if text.is_empty() || !text.chars().all(good) || text.starts_with(|c: char| c.is_ascii_digit()) {
        return Err(format!("`{text}` is no name of an input; write {FORMS}"));
    }
    Ok(text.to_owned())
}

/// `[0, 1]`, `(0, 1]`, …
fn interval(text: &str) -> Result<Interval, String> {
    let bad = || format!("`{text}` is no range; write `[0, 1]`, with `(` or `)` where the end is left out");
    let open_low = text.starts_with('(');
    let open_high = text.ends_with(')');
    let inside = text.strip_prefix(['[', '(']).and_then(|t| t.strip_suffix([']', ')'])).ok_or_else(bad)?;
    let (low, high) = inside.split_once(',').ok_or_else(bad)?;
    let (low, high) = (end_of(low.trim())?, end_of(high.trim())?);
    let empty = low > high || (low == high && (open_low || open_high));
    if empty {
        return Err(format!("`{text}` is empty"));
    }
    Ok(Interval { low, high, open_low, open_high })
}

fn end_of(text: &str) -> Result<f64, String> {
    let (sign, size) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest.trim_start()));
    let value = match size {
        "pi" => Ok(std::f64::consts::PI),
        "inf" => Ok(f64::INFINITY),
        _ => size.parse::<f64>().ok().filter(|v| !v.is_nan()).ok_or(()),
    };
    value.map(|v| sign * v).map_err(|()| format!("`{text}` is no number; `pi` and `inf` can be written too"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hints(text: &str) -> Vec<String> {
        let read = comment(text, "").unwrap().unwrap();
        read.iter().map(|s| format!("{} {}", s.input, s.law)).collect()
    }

    #[test]
    fn comments_state_domains() {
        assert_eq!(hints("// shadercheck: x in [0,1], normalised n"), ["x in [0, 1]", "n normalised"]);
        assert_eq!(
            hints("/* shadercheck: s.a in (0, inf); v nonzero */"),
            ["s.a in (0, inf]", "v nonzero"].map(|s| s.replace("inf]", "inf)"))
        );
        assert_eq!(hints("// shadercheck: t >= -1, u < 2"), ["t in [-1, inf]", "u in [-inf, 2)"]);
    }

    #[test]
    fn other_comments_are_left_alone() {
        assert!(comment("// x in [0,1]", "").is_none());
        assert!(comment("// shadercheck: ignore[N014]", "").is_none());
        assert!(comment("// shadercheck: ignore-file[N014]", "").is_none());
    }

    #[test]
    fn what_cannot_be_read_is_reported() {
        for (text, why) in [
            ("// shadercheck: x on [0,1]", "`x on [0,1]` is no domain"),
            ("// shadercheck: x in [1,0]", "`[1,0]` is empty"),
            ("// shadercheck: x in 0..1", "`0..1` is no range"),
            ("// shadercheck: x > one", "`one` is no number"),
        ] {
            let error = comment(text, "").unwrap().unwrap_err();
            assert!(error.starts_with(why), "{error}");
        }
        assert!(option("x").unwrap_err().starts_with("`x` has no `=`"));
        assert!(option("3=[0,1]").is_err());
    }

    #[test]
    fn options_state_several_domains() {
        let stated = option("x=[0,1]; f.n=normalised").unwrap();
        assert_eq!(stated.iter().map(|s| s.input.as_str()).collect::<Vec<_>>(), ["x", "f.n"]);
    }
}
