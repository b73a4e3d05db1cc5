//! The words of a name.

/// The words of a name as they stand in it. A word ends at a mark or a digit, which are parts of none, and where a capital
/// follows a small letter: `u_lightDir2` has `u`, `light` and `Dir`.
pub fn parts(name: &str) -> impl Iterator<Item = &str> {
    name.split(|c: char| !c.is_alphabetic()).flat_map(humps)
}

/// The same in small letters.
pub fn words(name: &str) -> Vec<String> {
    parts(name).map(str::to_lowercase).collect()
}

/// The name that a text begins with; empty where it begins with none.
pub fn identifier(text: &str) -> &str {
    let end = text.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(text.len());
    &text[..end]
}

/// Parts of a run of letters, each from a capital behind a small letter on.
fn humps(run: &str) -> impl Iterator<Item = &str> {
    let pairs = run.char_indices().zip(run.chars().skip(1));
    let ends = pairs.filter(|((_, a), b)| a.is_lowercase() && b.is_uppercase()).map(|((at, a), _)| at + a.len_utf8());
    let ends = ends.chain(std::iter::once(run.len()));
    let mut start = 0;
    ends.map(move |end| {
        let part = &run[start..end];
        start = end;
        part
    })
    .filter(|part| !part.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_words() {
        for (name, expected) in [
            ("lightProjection", &["light", "projection"][..]),
            ("light_projection", &["light", "projection"]),
            ("u_MVP", &["u", "mvp"]),
            ("VS_SOURCE", &["vs", "source"]),
            ("vs2", &["vs"]),
            ("normal0", &["normal"]),
            ("bones[3].headPos", &["bones", "head", "pos"]),
            ("größeX", &["größe", "x"]),
            ("_", &[]),
            ("", &[]),
        ] {
            assert_eq!(words(name), expected, "{name}");
        }
        assert_eq!(parts("a_TexCoord").collect::<Vec<_>>(), ["a", "Tex", "Coord"]);
    }
}
