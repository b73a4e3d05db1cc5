//! Names that a writer of naga has changed, found again.

/// How near a name in a translation is to the one that stood in the module: 0 for the name itself,
/// more for what a writer makes of it, `None` for another name.
///
/// A writer puts `gen_` before reserved beginnings, `_` behind keywords and digits, `_` and a number
/// behind names that are taken, and makes one underscore of several.
pub(super) fn distance(found: &str, wanted: &str) -> Option<u32> {
    if found == wanted {
        return Some(0);
    }
    let wanted = single_underscores(wanted);
    let wanted = wanted.trim_end_matches('_');
    let prefixed = found.strip_prefix("gen_").filter(|rest| rest.starts_with(wanted));
    let rest = prefixed.unwrap_or(found).strip_prefix(wanted)?;
    let number = match rest.strip_prefix('_') {
        Some(number) => number,
        None if rest.is_empty() => "",
        None => return None,
    };
    if !number.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    Some(if number.is_empty() { 1 } else { 2 })
}

fn single_underscores(name: &str) -> String {
    let mut out = String::with_capacity(name.len());
    for c in name.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '_') {
        if c != '_' || !out.ends_with('_') {
            out.push(c);
        }
    }
    out
}

/// The one of `all` whose name is nearest to `wanted`. `None` when no name is near, or two are equally
/// near: a guess would compare one variable with another.
pub(super) fn nearest<'n, T>(all: impl Iterator<Item = (T, Option<&'n str>)>, wanted: &str) -> Option<T> {
    let mut best: Option<(u32, T)> = None;
    let mut tied = false;
    for (item, name) in all {
        let Some(near) = name.and_then(|name| distance(name, wanted)) else { continue };
        match best.as_ref().map(|(known, _)| near.cmp(known)) {
            Some(std::cmp::Ordering::Greater) => {}
            Some(std::cmp::Ordering::Equal) => tied = true,
            Some(std::cmp::Ordering::Less) | None => (best, tied) = (Some((near, item)), false),
        }
    }
    best.filter(|_| !tied).map(|(_, item)| item)
}

#[cfg(test)]
mod tests {
    use super::{distance, nearest};

    #[test]
    fn names_of_writers_are_seen_through() {
        assert_eq!(distance("mc", "mc"), Some(0));
        for found in ["gl_Position", "gen_gl_Position", "gen_gl_Position_", "gl_Position_12"] {
            assert!(distance(found, "gl_Position").is_some(), "{found}");
        }
        assert_eq!(distance("q0_", "q0"), Some(1));
        assert_eq!(distance("q0_1", "q0"), Some(2));
        assert_eq!(distance("a_b", "a__b"), Some(1));
        for (found, wanted) in [("q01", "q0"), ("q", "q0"), ("q0_x", "q0"), ("gen_q1", "q0"), ("Q0", "q0")] {
            assert_eq!(distance(found, wanted), None, "{found}");
        }
    }

    #[test]
    fn the_nearest_name_is_taken_and_no_guess_is_made() {
        let of = |names: &[&'static str]| nearest(names.iter().map(|n| (*n, Some(*n))), "v");
        assert_eq!(of(&["v_1", "v", "w"]), Some("v"));
        assert_eq!(of(&["w", "v_1"]), Some("v_1"));
        assert_eq!(of(&["v_1", "v_2"]), None);
        assert_eq!(of(&["v_1", "v_2", "v"]), Some("v"));
        assert_eq!(of(&["w"]), None);
    }
}
