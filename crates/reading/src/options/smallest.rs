//! The settings of a row that an error needs.

use syntax::Setting;

/// A set of the settings with which `holds` is true, and without any of which it is not, each in order; none where it is not true of any that
/// was tried, or `holds` gives up.
pub(super) fn smallest(row: &[Setting], holds: &mut dyn FnMut(&[Setting]) -> Option<bool>) -> Option<Vec<Setting>> {
    let (mut needed, mut rest) = (Vec::new(), row.to_vec());
    loop {
        if !needed.is_empty() && holds(&needed)? {
            return Some(needed);
        }
        if rest.is_empty() {
            return None;
        }
        // The shortest part of the rest that suffices ends with one that is needed.
        let (mut few, mut enough) = (0, rest.len());
        while enough - few > 1 {
            let middle = few + (enough - few) / 2;
            let mut tried: Vec<Setting> = needed.iter().chain(&rest[..middle]).cloned().collect();
            tried.sort();
            if holds(&tried)? {
                enough = middle;
            } else {
                few = middle;
            }
        }
        needed.push(rest.remove(enough - 1));
        needed.sort();
        rest.truncate(enough - 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn setting(at: usize) -> Setting {
        Setting { at: Some(at), name: format!("S{at}"), value: None }
    }

    #[test]
    fn what_an_error_needs_is_found_among_many() {
        let row: Vec<Setting> = (0..100).map(setting).collect();
        for wanted in [vec![0], vec![99], vec![3, 57], vec![0, 50, 99]] {
            let mut asked = 0;
            let found = smallest(&row, &mut |tried| {
                asked += 1;
                Some(wanted.iter().all(|at| tried.iter().any(|s| s.at == Some(*at))))
            });
            let mut at: Vec<usize> = found.unwrap().iter().filter_map(|s| s.at).collect();
            at.sort_unstable();
            assert_eq!(at, wanted);
            assert!(asked <= wanted.len() * 8 + 1, "{asked} readings");
        }
    }

    #[test]
    fn what_holds_nowhere_has_no_set() {
        assert!(smallest(&[setting(0)], &mut |_| Some(false)).is_none());
        assert!(smallest(&[setting(0)], &mut |_| None).is_none());
    }
}
