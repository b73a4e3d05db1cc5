//! The name that somebody probably meant.

/// The candidate that is most similar to `name`; `None` when none is similar enough to be a slip of
/// the pen. Case does not count.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    let mut best: Option<(f64, &str)> = None;
    for candidate in candidates {
        let score = strsim::normalized_damerau_levenshtein(&name, &candidate.to_lowercase());
        if score >= 0.5 && best.is_none_or(|(s, _)| score > s) {
            best = Some((score, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// What to say after an unknown name: the candidate that was probably meant, or else all of them after `all`, such as
/// `lanes are`.
pub fn did_you_mean<'a, I>(name: &str, candidates: I, all: &str) -> String
where
    I: IntoIterator<Item = &'a str>,
{
    let candidates: Vec<&str> = candidates.into_iter().collect();
    match nearest(name, candidates.iter().copied()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("{all} {}", candidates.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::{did_you_mean, nearest};

    #[test]
    fn slips_are_recognised_and_other_words_are_not() {
        let names = ["tolerance", "floors", "title"];
        assert_eq!(nearest("tolerence", names), Some("tolerance"));
        assert_eq!(nearest("Floor", names), Some("floors"));
        assert_eq!(nearest("generator", names), None);
        assert_eq!(nearest("", names), None);
    }

    #[test]
    fn without_a_similar_name_all_are_listed() {
        let said = |name| did_you_mean(name, ["cosine", "tangent"], "there are:");
        assert_eq!(said("cosin"), "did you mean `cosine`?");
        assert_eq!(said("x"), "there are: cosine, tangent");
    }
}
