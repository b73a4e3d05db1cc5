//! The name that was probably meant.

/// The one candidate that is nearest to `given`: equal but for spaces or capitals, or at most a third
/// of its letters away. None when two are equally near.
pub fn nearest<'c>(given: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let given = given.trim();
    let mut scored: Vec<(usize, &str)> = candidates
        .into_iter()
        .map(|c| {
            let same = c.eq_ignore_ascii_case(given);
            (if same { usize::from(c != given) } else { strsim::damerau_levenshtein(given, c) }, c)
        })
        .collect();
    scored.sort_unstable();
    scored.dedup();
    let &(distance, name) = scored.first()?;
    let unique = scored.get(1).is_none_or(|&(second, _)| second > distance);
    let near = distance <= (given.chars().count().max(name.chars().count()) / 3).max(1);
    // One letter for another is no resemblance.
    let resembles = distance < given.chars().count();
    (unique && near && resembles).then_some(name)
}

/// The names in backquotes: "`a`", "`a` and `b`", "`a`, `b` and `c`"; the first ten of many.
pub fn list(names: &[&str]) -> String {
    const MOST: usize = 10;
    let mut quoted: Vec<String> = names.iter().take(MOST).map(|n| format!("`{n}`")).collect();
    if names.len() > MOST {
        quoted.push(format!("{} more", names.len() - MOST));
    }
    match quoted.split_last() {
        None => "none".to_owned(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    }
}

/// As [`list`], in Japanese.
pub fn list_in_japanese(names: &[&str]) -> String {
    const MOST: usize = 10;
    let quoted: Vec<String> = names.iter().take(MOST).map(|n| format!("`{n}`")).collect();
    let more = names.len().saturating_sub(MOST);
    let rest = if more > 0 { format!(" ほか {more} 個") } else { String::new() };
    quoted.join("、") + &rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_read_like_a_sentence() {
        assert_eq!(list(&["a"]), "`a`");
        assert_eq!(list(&["a", "b", "c"]), "`a`, `b` and `c`");
        assert!(list(&["a"; 12]).ends_with("`a` and 2 more"));
    }

    #[test]
    fn the_nearest_name_is_unique_and_near() {
        assert_eq!(nearest("modelVeiw", ["modelView", "projection"]), Some("modelView"));
        assert_eq!(nearest("MC", ["mc", "t"]), Some("mc"));
        assert_eq!(nearest("mc ", ["mc"]), Some("mc"));
        assert_eq!(nearest("p1", ["parameter"]), None);
        assert_eq!(nearest("p2", ["p0", "p1"]), None, "two are equally near");
        assert_eq!(nearest("x", ["y"]), None);
        assert_eq!(nearest("a", []), None);
    }
}
