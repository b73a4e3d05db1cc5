//! Whole numbers of hosts: literals, constants, sums and products of them, and sizes of types.

use std::ops::Range;

use super::structure;
use super::value::{Value, Values};
use super::vertex::Format;

/// Constants inside of constants that are followed.
const DEEPEST: usize = 8;

/// The number that an expression is.
pub fn number(values: &Values<'_, '_>, value: &Value) -> Option<u64> {
    within(values, value, DEEPEST)
}

fn within(values: &Values<'_, '_>, value: &Value, depth: usize) -> Option<u64> {
    let depth = depth.checked_sub(1)?;
    let code = values.code;
    let value = values.resolve(value)?;
    let range = value.tokens.clone();
    let part = |tokens: Range<usize>| within(values, &Value { tokens, frame: value.frame.clone() }, depth);
    for (mark, join) in [('+', u64::checked_add as fn(u64, u64) -> Option<u64>), ('*', u64::checked_mul)] {
        let own = code.bracket(range.start);
        let at = range.clone().skip(1).rev().find(|at| code.is_mark(*at, mark) && code.bracket(*at) == own);
        if let Some(at) = at {
            return join(part(range.start..at)?, part(at + 1..range.end)?);
        }
    }
    if range.len() == 1 {
        return literal(code.word(range.start)?);
    }
    let text = code.file.slice(code.span(&range));
    if text.ends_with("32Array.BYTES_PER_ELEMENT") {
        return Some(4);
    }
    let call = values.call(&range)?;
    let name = code.word(call.name);
    // `Float32x3.size()`, and `NonZeroU64::new(…)`.
    if name == Some("size") && code.elements(call.open).is_empty() {
        let before = Value { tokens: range.start..call.name - 1, frame: value.frame.clone() };
        return Format::named(values.word(&before)?).map(|f| f.size);
    }
    if let (Some("new" | "new_unchecked" | "size_of_val"), [only]) = (name, code.elements(call.open).as_slice()) {
        return if name == Some("size_of_val") { None } else { part(only.clone()) };
    }
    None
}

/// `size_of::<Type>()` in an expression that is nothing else: the type.
pub fn size_of(values: &Values<'_, '_>, value: &Value) -> Option<Range<usize>> {
    let code = values.code;
    let value = values.resolve(value)?;
    let at = value.tokens.clone().find(|at| code.word(*at) == Some("size_of"))?;
    let path = |t: usize| code.word(t).is_some_and(|w| ["std", "core", "mem"].contains(&w)) || code.is_mark(t, ':');
    let open = at + 3;
    let end = value.tokens.end;
    let whole = (value.tokens.start..at).all(path)
        && code.is_mark(open, '<')
        && code.is_mark(end - 1, ')')
        && code.is_mark(end - 2, '(')
        && code.is_mark(end - 3, '>');
    (whole && open + 1 < end - 3).then(|| open + 1..end - 3)
}

/// The bytes that an expression counts: a number, or the size of a type whose layout is known.
pub fn bytes(values: &Values<'_, '_>, value: &Value) -> Option<u64> {
    match size_of(values, value) {
        Some(ty) => structure::size(values, ty),
        None => number(values, value),
    }
}

fn literal(word: &str) -> Option<u64> {
    let plain: String = word.chars().filter(|c| *c != '_').collect();
    if let Some(hex) = plain.strip_prefix("0x") {
        return u64::from_str_radix(hex, 16).ok();
    }
    let digits = ["u32", "u64", "usize", "i32", "u16", "n"].iter().find_map(|s| plain.strip_suffix(s));
    digits.unwrap_or(&plain).parse().ok()
}
