//! Weight of a bone by its distance (section 9.3.2).

use judge::formula::{Args, Formula, Kind, Param, Rule};

/// Weight of a bone at the distance `d >= 0`, falling with the exponent `c`. NaN for `d < 0`.
pub static BONE_WEIGHT: Formula = Formula {
    name: "bone_weight",
    source: "(80): w = (d + 1)^-c, c = 16, 64, ...",
    inputs: &[Param::new("d", Kind::Float), Param::new("c", Kind::Float)],
    outputs: &[Param::new("return", Kind::Float)],
    rule: Rule::Pointwise(evaluate),
};

/// (80): the weight of a bone at the distance `d`. NaN for `d < 0`, which is no distance.
pub fn bone_weight(d: f64, c: f64) -> f64 {
    if d >= 0.0 { (d + 1.0).powf(-c) } else { f64::NAN }
}

fn evaluate(args: &Args<'_>, out: &mut [f64]) {
    out[0] = bone_weight(args.float(0), args.float(1));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::testing::{Broken, Rng, evaluate};

    fn broken(weight: impl Fn(f64, f64) -> f64) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(80));
        for _ in 0..200 {
            let (d, e, c) = (rng.unit() * 2.0, rng.unit() * 2.0, 1.0 + rng.unit() * 63.0);
            broken.equal("one at zero", weight(0.0, c), 1.0);
            for d in [0.0, d] {
                broken.that("range", weight(d, c) > 0.0 && weight(d, c) <= 1.0);
            }
            broken.that("falling", weight(d.min(e), c) >= weight(d.max(e), c));
            broken.equal("exponents add", weight(d, c) * weight(d, 1.5), weight(d, c + 1.5));
        }
        broken.list()
    }

    #[test]
    fn identities_hold() {
        assert!(broken(bone_weight).is_empty());
    }

    #[test]
    fn perturbed_formulas_break_identities() {
        assert_eq!(broken(|d, c| bone_weight(d, c) * 1.0001), ["one at zero", "range", "exponents add"]);
        assert_eq!(broken(|d, c| bone_weight(d, c + 1e-4)), ["exponents add"]);
        assert_eq!(broken(|d, c| bone_weight(d, -c)), ["range", "falling"]);
        assert_eq!(broken(|d, c| d.powf(-c)), ["one at zero", "range"]);
    }

    // d = 1: 2^-16; d = 3: 4^-64 = 2^-128, below the normal range of binary32.
    #[test]
    fn powers_of_two_by_hand() {
        assert_eq!(evaluate(&BONE_WEIGHT, &[1.0, 16.0]), [2f64.powi(-16)]);
        assert_eq!(evaluate(&BONE_WEIGHT, &[3.0, 64.0]), [2f64.powi(-128)]);
    }

    #[test]
    fn a_negative_distance_has_no_weight() {
        assert!(bone_weight(-0.5, 16.0).is_nan());
        assert!(bone_weight(f64::NAN, 16.0).is_nan());
    }
}
