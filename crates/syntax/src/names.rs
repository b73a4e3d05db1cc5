//! Suggestions for misspelt names.

/// Unknown names of a text for which the name that was meant is sought: where more are unknown, none of them is a slip, and
/// to seek for each among all others would take their square.
pub const MOST_SLIPS: usize = 64;

/// The name closest to `name`: at most one change for three characters. The first one wins a tie.
pub fn nearest<'a>(name: &str, among: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let most = (name.chars().count() / 3).clamp(1, 3);
    let mut best: Option<(usize, &str)> = None;
    let own = letters(name);
    for other in among {
        if other.len().abs_diff(name.len()) > 2 * most || other == name {
            continue;
        }
        // Nearly all names end here: a change takes one letter and puts another, and distances are dear.
        let far = |apart: u32| name.is_ascii() && other.is_ascii() && apart as usize > 2 * most;
        if far(apart(&own, &letters(other))) {
            continue;
        }
        // A difference in case alone is the likeliest slip.
        let distance = if other.eq_ignore_ascii_case(name) { 0 } else { strsim::damerau_levenshtein(name, other) };
        if distance <= most && best.is_none_or(|(d, _)| distance < d) {
            best = Some((distance, other));
        }
    }
    // One letter instead of another is no misspelling.
    best.filter(|_| name.chars().count() > 1).map(|(_, name)| name)
}

/// How often each letter stands in a name, whether small or not.
fn letters(name: &str) -> [u8; 32] {
    let mut counts = [0_u8; 32];
    name.bytes().for_each(|byte| counts[usize::from(byte & 31)] = counts[usize::from(byte & 31)].saturating_add(1));
    counts
}

/// Letters that one name has and the other has not.
fn apart(a: &[u8; 32], b: &[u8; 32]) -> u32 {
    a.iter().zip(b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum()
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn suggests_only_what_is_close() {
        assert_eq!(nearest("positon", ["parameter", "position"]), Some("position"));
        assert_eq!(nearest("modelviewmatrix", ["modelViewMatrix"]), Some("modelViewMatrix"));
        assert_eq!(nearest("x", ["y"]), None);
        assert_eq!(nearest("light", ["camera"]), None);
    }
}
