//! Morph targets (section 9.2.2).

use glam::DVec4;

use judge::formula::{Args, Formula, Kind, Param, Rule};

/// Number of targets of the shader.
pub const TARGETS: usize = 4;

/// A base position moved towards targets, each by its own weight, put through `mc`. Any weights,
/// whatever their sum and sign.
pub static MORPH_TARGETS: Formula = Formula {
    name: "morph_targets",
    source: "(73), (74): P = P_N + Σ w_i (P_i - P_N)",
    inputs: &[
        Param::new("pn", Kind::Vec4),
        Param::new("p1", Kind::Vec4),
        Param::new("p2", Kind::Vec4),
        Param::new("p3", Kind::Vec4),
        Param::new("p4", Kind::Vec4),
        Param::array("w", Kind::Float, TARGETS),
        Param::new("mc", Kind::Mat4),
    ],
    outputs: &[Param::new("gl_Position", Kind::Vec4)],
    rule: Rule::Pointwise(evaluate),
};

/// (73): how far a target lies from the base.
pub fn displacement(base: DVec4, target: DVec4) -> DVec4 {
    target - base
}

/// (74): the base moved by the weighted displacements of (target, weight) pairs.
pub fn blend(base: DVec4, targets: impl IntoIterator<Item = (DVec4, f64)>) -> DVec4 {
    targets.into_iter().fold(base, |sum, (target, w)| sum + displacement(base, target) * w)
}

fn evaluate(args: &Args<'_>, out: &mut [f64]) {
    let targets = (0..TARGETS).map(|i| (args.vec4(1 + i), args.float_at(5, i)));
    (args.mat4(6) * blend(args.vec4(0), targets)).write_to_slice(out);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::testing::{Broken, Rng, evaluate};

    type Targets = [(DVec4, f64); 3];

    fn broken(at: impl Fn(DVec4, Targets) -> DVec4) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(74));
        for _ in 0..100 {
            let base = rng.point();
            let targets: Targets = std::array::from_fn(|_| (rng.point(), rng.within(2.0)));
            let with = |w: [f64; 3]| at(base, std::array::from_fn(|i| (targets[i].0, w[i])));
            broken.near("no weight", with([0.0; 3]), base);
            broken.near("one weight", with([0.0, 1.0, 0.0]), targets[1].0);
            let [a, b, c] = targets;
            broken.near("order", at(base, [c, a, b]), at(base, targets));
            let w = targets.map(|t| t.1);
            broken.near("sum of weights", with(w.map(|w| 2.0 * w)) - base, (with(w) - base) * 2.0);
        }
        broken.list()
    }

    #[test]
    fn identities_hold() {
        assert!(broken(blend).is_empty());
    }

    #[test]
    fn perturbed_formulas_break_identities() {
        let scaled = |base, t: Targets| blend(base, t.map(|(p, w)| (p, w * 1.0001)));
        assert_eq!(broken(scaled), ["one weight"]);
        // Displacements from the origin in place of the base, as if the targets were displacements.
        let absolute = |base: DVec4, t: Targets| t.iter().fold(base, |sum, (p, w)| sum + *p * *w);
        assert_eq!(broken(absolute), ["one weight"]);
        // A normalised blend, right only when the weights sum to 1.
        let normalised = |base, t: Targets| {
            let sum: f64 = t.iter().map(|t| t.1).sum();
            blend(base, t.map(|(p, w)| (p, if sum == 0.0 { 0.0 } else { w / sum })))
        };
        assert_eq!(broken(normalised), ["sum of weights"]);
        let first_twice = |base, [a, b, c]: Targets| blend(base, [(b.0, a.1), b, c]);
        assert_eq!(broken(first_twice), ["order"]);
    }

    // Base (1,1,1); targets (2,1,1), (1,3,1), (1,1,5), (0,0,0) are away by (1,0,0), (0,2,0), (0,0,4),
    // (-1,-1,-1); weights 1, 1/2, 1/4, 2 give (1,1,1) + (1,0,0) + (0,1,0) + (0,0,1) - (2,2,2) = 0.
    #[test]
    fn four_targets_by_hand() {
        let mut words = Vec::new();
        for p in [[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [1.0, 3.0, 1.0], [1.0, 1.0, 5.0], [0.0, 0.0, 0.0]] {
            words.extend(p);
            words.push(1.0);
        }
        words.extend([1.0, 0.5, 0.25, 2.0]);
        words.extend(glam::DMat4::IDENTITY.to_cols_array());
        assert_eq!(evaluate(&MORPH_TARGETS, &words), [0.0, 0.0, 0.0, 1.0]);
    }
}
