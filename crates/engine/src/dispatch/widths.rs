//! Whether what a dispatch gives depends on how many invocations make a subgroup.

use base::value::Scalar;
use program::interp::group::{Outcome, Space, WIDTH};

use super::Dispatched;
use super::host::{Length, Scenario};
use crate::fuzz::{Finding, FuzzFindingKind, Severity};

/// Widths of subgroups that devices have: 4 on some mobile ones and on the CPU, 8 and 16 by Intel, 32 by NVIDIA and Apple,
/// 64 by AMD.
const WIDTHS: [u32; 4] = [WIDTH, 4, 8, 64];

/// Part of a sum that its order may change in binary64, seen in binary32.
const SLACK: f64 = 1e-6;

/// The width that a specialization constant states by its name: a host that sets it asks for subgroups of that width.
fn stated(constants: &[(String, u32)], size: u32) -> Option<u32> {
    let width = constants.iter().find_map(|(name, value)| {
        let name: String = name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_lowercase();
        match &name[..] {
            "subgroupsize" | "warpsize" | "warp" | "wavesize" | "wavefrontsize" => Some(*value),
            "numsubgroups" => size.checked_div(*value),
            _ => None,
        }
    });
    width.filter(|width| width.is_power_of_two() && (WIDTHS[1]..=128).contains(width))
}

impl Dispatched {
    /// Widths at which a dispatch is run: one where nothing asks for it.
    pub(super) fn widths(&self) -> Vec<u32> {
        if !self.executable.has_subgroups() {
            return vec![WIDTH];
        }
        let size: u32 = self.size.iter().product();
        if let Some(width) = stated(&self.program.constants.specialized(), size) {
            return vec![width];
        }
        let fits = |width: &u32| *width < 2 * size || *width == WIDTHS[1];
        WIDTHS.into_iter().filter(fits).collect()
    }

    /// The smallest dispatch that gives something else where another number of invocations makes a subgroup.
    pub(super) fn told_width(&self, lengths: &[Length], command: &str) -> Option<Finding> {
        let widths = self.widths();
        if widths.len() < 2 {
            return None;
        }
        for items in self.sizes() {
            let scenario = self.scenario(items, Some(lengths), 0);
            let outcomes: Vec<(u32, Scenario, Outcome)> = widths
                .iter()
                .map(|&width| {
                    let scenario = Scenario { subgroup: width, ..scenario.clone() };
                    let outcome = self.play_in::<f64>(&scenario, 0);
                    (width, scenario, outcome)
                })
                .filter(|(.., outcome)| outcome.whole && outcome.incidents.is_empty())
                .collect();
            let Some(((first, _, one), others)) = outcomes.split_first() else { continue };
            for (width, scenario, other) in others {
                if let Some(found) = self.difference(one, *first, other, *width) {
                    let kind = FuzzFindingKind::SubgroupWidth;
                    let site = self.executable.subgroup_site();
                    return Some(self.finding(kind, Severity::Finding, found, site, (1, scenario), command));
                }
            }
        }
        None
    }

    /// What one dispatch leaves in a buffer and another one does not, in words.
    fn difference(&self, one: &Outcome, first: u32, other: &Outcome, second: u32) -> Option<String> {
        for (k, shape) in self.executable.memories().iter().enumerate() {
            if shape.space != (Space::Storage { writes: true }) {
                continue;
            }
            let real = |word: usize| shape.at(word as u32).is_some_and(|(_, leaf)| leaf.scalar == Scalar::F32);
            let number = |bits: u32| f64::from(f32::from_bits(bits));
            let differs = |word: usize, a: u32, b: u32| {
                let near = |a: f64, b: f64| (a - b).abs() <= SLACK * a.abs().max(b.abs()).max(SLACK);
                a != b && !(real(word) && near(number(a), number(b)))
            };
            let both = one.contents[k].iter().zip(&other.contents[k]).enumerate();
            let found = both.into_iter().find(|(word, (a, b))| differs(*word, **a, **b));
            if let Some((word, (&a, &b))) = found {
                let shown = |bits: u32| if real(word) { number(bits).to_string() } else { bits.to_string() };
                return Some(format!(
                    "`{}` depends on the width of subgroups: it is {} where {first} invocations make one, and {} where \
                     {second} do",
                    shape.place(word as u32),
                    shown(a),
                    shown(b)
                ));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::stated;

    #[test]
    fn a_constant_of_the_host_states_the_width() {
        let of = |name: &str, value: u32| stated(&[("BLOCK".to_owned(), 8), (name.to_owned(), value)], 128);
        assert_eq!(
            (of("SUBGROUP_SIZE", 32), of("SubGroupSize", 16), of("NUM_SUBGROUPS", 4)),
            (Some(32), Some(16), Some(32))
        );
        assert_eq!((of("SUBGROUP_SIZE", 0), of("SUBGROUP_SIZE", 24), of("SUBGROUP_ROWS", 8)), (None, None, None));
        assert_eq!(of("NUM_SUBGROUPS", 0), None);
    }
}
