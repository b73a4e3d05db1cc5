//! Names of the components of vectors.

/// The three sets of names; a swizzle keeps to one of them.
pub const SETS: [&str; 3] = ["xyzw", "rgba", "stpq"];

/// Which component a letter names, whatever its set: 0 to 3.
pub fn component(letter: char) -> Option<usize> {
    SETS.iter().find_map(|set| set.find(letter))
}

#[cfg(test)]
mod tests {
    use super::component;

    #[test]
    fn every_set_counts_from_0() {
        for (letter, index) in [('x', 0), ('w', 3), ('g', 1), ('a', 3), ('s', 0), ('p', 2)] {
            assert_eq!(component(letter), Some(index), "{letter}");
        }
        assert_eq!(component('u'), None);
    }
}
