//! Versions of drivers, read from the text in which a driver tells what it is.

/// A range of versions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Versions {
    /// The word before the number, such as `Mesa`.
    pub of: String,
    /// The first version of the range; none for no begin.
    pub from: Option<Vec<u64>>,
    /// The first version after the range; none for no end.
    pub before: Option<Vec<u64>>,
}

impl Versions {
    /// True when a driver has a version in the range. One that tells no version is in none.
    pub fn hold(&self, driver: &str) -> bool {
        let Some(version) = after(driver, &self.of) else { return false };
        let less = |a: &[u64], b: &[u64]| {
            let part = |v: &[u64], k: usize| v.get(k).copied().unwrap_or(0);
            let parts = 0..a.len().max(b.len());
            parts.map(|k| part(a, k).cmp(&part(b, k))).find(|order| order.is_ne()).is_some_and(|order| order.is_lt())
        };
        self.from.as_ref().is_none_or(|from| !less(&version, from))
            && self.before.as_ref().is_none_or(|before| less(&version, before))
    }
}

/// The number after a word.
fn after(driver: &str, word: &str) -> Option<Vec<u64>> {
    driver.match_indices(word).find_map(|(at, _)| number(driver[at + word.len()..].trim_start()))
}

/// Numbers with dots between them at the begin of a text.
fn number(text: &str) -> Option<Vec<u64>> {
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    parse(text[..end].trim_end_matches('.'))
}

/// A version such as `22.3.6`; `None` for what is none.
pub fn parse(text: &str) -> Option<Vec<u64>> {
    text.split('.').map(|part| part.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_its_begin_and_not_its_end() {
        let driver =
            |version: &str| format!("llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa {version} (LLVM 15.0.6)");
        let versions = |of: &str, from: &str, before: &str| Versions {
            of: of.to_owned(),
            from: parse(from),
            before: parse(before),
        };
        let mesa = versions("Mesa", "22.3", "24");
        for (version, inside) in
            [("22.3.6", true), ("22.3", true), ("22.2.9", false), ("23.10.0", true), ("24.0.0", false), ("9.0", false)]
        {
            assert_eq!(mesa.hold(&driver(version)), inside, "{version}");
        }
        assert!(versions("LLVM", "15.0.6", "").hold(&driver("1")) && !versions("LLVM", "", "15").hold(&driver("1")));
        assert!(!mesa.hold("SwiftShader driver 5.0.0"), "no version is in no range");
        assert_eq!((parse("1.x"), parse("")), (None, None));
    }
}
