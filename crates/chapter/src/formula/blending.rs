//! Vertex blending between bones (section 9.3.2).

use glam::{DMat4, DVec4};

use super::{segment::segment_distance, weight::bone_weight};
use judge::formula::{Args, Formula, Kind, Param, Rule};

/// Most bones that the skinning shader has room for.
pub const MAXBONES: usize = 8;

/// Exponent c of (80) in the skinning shader.
pub const EXPONENT: f64 = 16.0;

/// A vertex blended between two bones by weights of its own, put through `mc`, and the positions
/// that either bone alone would give. Weights that do not sum to 1 leave their sum in w (81).
pub static TWO_BONES: Formula = Formula {
    name: "two_bones",
    source: "(75): u = w0 B0 M0⁻¹ P + w1 B1 M1⁻¹ P, with blendMatrix[i] = B_i M_i⁻¹",
    inputs: &[
        Param::new("position", Kind::Vec4),
        Param::new("weight", Kind::Vec2),
        Param::array("blendMatrix", Kind::Mat4, 2),
        Param::new("mc", Kind::Mat4),
    ],
    outputs: &[
        Param::new("gl_Position", Kind::Vec4),
        Param::new("candidate0", Kind::Vec4),
        Param::new("candidate1", Kind::Vec4),
    ],
    rule: Rule::Pointwise(two_bones),
};

/// A vertex blended between up to [`MAXBONES`] bones, weighted by its distances to them. The weights
/// are not normalised: their sum stays in w (81). NaN when `numberOfBones` is not in `0..=MAXBONES`;
/// without a bone the sum is zero.
pub static SKINNING: Formula = Formula {
    name: "skinning",
    source: "(76), (79), (80), (81): u = Σ (d_i + 1)^-16 B_i M_i⁻¹ P, with blendMatrix[i] = B_i M_i⁻¹",
    inputs: &[
        Param::new("position", Kind::Vec4),
        Param::new("modelViewMatrix", Kind::Mat4),
        Param::new("projectionMatrix", Kind::Mat4),
        Param::new("numberOfBones", Kind::Int),
        Param::array("p0", Kind::Vec4, MAXBONES),
        Param::array("p1", Kind::Vec4, MAXBONES),
        Param::array("blendMatrix", Kind::Mat4, MAXBONES),
    ],
    outputs: &[Param::new("gl_Position", Kind::Vec4)],
    rule: Rule::Pointwise(skinning),
};

/// (76): Σ w_i (B_i M_i⁻¹) P over pairs of weight and `B_i M_i⁻¹`.
pub fn blend(p: DVec4, bones: impl IntoIterator<Item = (f64, DMat4)>) -> DVec4 {
    bones.into_iter().fold(DVec4::ZERO, |u, (w, matrix)| u + matrix * p * w)
}

/// (77): whether the weights are those of a convex combination: none negative, the sum 1 to within
/// `epsilon`.
pub fn is_convex(weights: &[f64], epsilon: f64) -> bool {
    weights.iter().all(|&w| w >= 0.0) && (weights.iter().sum::<f64>() - 1.0).abs() <= epsilon
}

/// (81): the real coordinates of a homogeneous column, with w = 1. NaN when w = 0.
pub fn homogeneous_divide(u: DVec4) -> DVec4 {
    if u.w == 0.0 { DVec4::NAN } else { u / u.w }
}

fn two_bones(args: &Args<'_>, out: &mut [f64]) {
    let (p, weight) = (args.vec4(0), args.vec2(1));
    let bones = [args.mat4_at(2, 0), args.mat4_at(2, 1)];
    let u = blend(p, [(weight.x, bones[0]), (weight.y, bones[1])]);
    (args.mat4(3) * u).write_to_slice(&mut out[..4]);
    (bones[0] * p).write_to_slice(&mut out[4..8]);
    (bones[1] * p).write_to_slice(&mut out[8..]);
}

fn skinning(args: &Args<'_>, out: &mut [f64]) {
    let count = args.float(3);
    if !(0.0..=MAXBONES as f64).contains(&count) {
        out.fill(f64::NAN);
        return;
    }
    let p = args.mat4(1) * args.vec4(0);
    let u = blend(
        p,
        (0..count as usize).map(|i| {
            let distance = segment_distance(p, args.vec4_at(4, i), args.vec4_at(5, i));
            (bone_weight(distance, EXPONENT), args.mat4_at(6, i))
        }),
    );
    (args.mat4(2) * u).write_to_slice(out);
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::formula::testing::{Broken, Rng, evaluate, random_words};

    type Bones = [(f64, DMat4); 3];

    fn broken(blend: impl Fn(DVec4, Bones) -> DVec4) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(76));
        for _ in 0..100 {
            let p = rng.point();
            let bones: Bones = std::array::from_fn(|_| (rng.unit(), rng.rigid()));
            let sum: f64 = bones.iter().map(|b| b.0).sum();
            let real = |bones| homogeneous_divide(blend(p, bones));
            broken.near("rest", real(bones.map(|(w, _)| (w, DMat4::IDENTITY))), p);
            let common = rng.rigid();
            broken.near("common motion", real(bones.map(|(w, _)| (w, common))), common * p);
            let [a, b, c] = bones;
            broken.near("order", blend(p, [c, a, b]), blend(p, bones));
            let normalised = bones.map(|(w, m)| (w / sum, m));
            broken.that("convex weights", is_convex(&normalised.map(|b| b.0), 1e-15));
            broken.near("homogeneous divide", real(bones), blend(p, normalised));
            broken.equal("sum of weights", blend(p, bones).w, sum);
            let candidates = bones.map(|(_, m)| m * p);
            let (low, high) = (candidates[0].min(candidates[1]), candidates[0].max(candidates[1]));
            let (low, high) = (low.min(candidates[2]) - 1e-12, high.max(candidates[2]) + 1e-12);
            let u = real(bones);
            broken.that("hull", u.cmpge(low).all() && u.cmple(high).all());
        }
        broken.list()
    }

    #[test]
    fn identities_hold() {
        assert!(broken(blend).is_empty());
    }

    #[test]
    fn perturbed_formulas_break_identities() {
        let stretched = |p, b| (blend(p, b).truncate() * 1.0001).extend(blend(p, b).w);
        assert_eq!(broken(stretched), ["rest", "common motion"]);
        let wrong_w = |p, b| blend(p, b).truncate().extend(1.0);
        assert_eq!(broken(wrong_w), ["rest", "common motion", "homogeneous divide", "sum of weights", "hull"]);
        let transposed = |p, b: Bones| blend(p, b.map(|(w, m)| (w, m.transpose())));
        assert!(broken(transposed).contains(&"common motion"));
        let first_heavier = |p, [a, b, c]: Bones| blend(p, [(a.0 * 1.0001, a.1), b, c]);
        assert_eq!(broken(first_heavier), ["order", "homogeneous divide", "sum of weights"]);
        let outside = |p, [a, b, c]: Bones| blend(p, [(-a.0, a.1), b, c]);
        assert!(broken(outside).contains(&"hull"));
    }

    #[test]
    fn convexity_needs_both_conditions() {
        assert!(is_convex(&[0.25, 0.75], 1e-15));
        assert!(!is_convex(&[0.25, 0.7501], 1e-15));
        assert!(!is_convex(&[-0.25, 1.25], 1e-15));
        assert!(homogeneous_divide(DVec4::X).is_nan());
    }

    // P = (1,0,0). Bone 0 leaves it, bone 1 turns it by 90° about z to (0,1,0); weights 1/4 and 3/4
    // give (1/4, 3/4, 0).
    #[test]
    fn two_bones_by_hand() {
        let mut words = vec![1.0, 0.0, 0.0, 1.0, 0.25, 0.75];
        words.extend(DMat4::IDENTITY.to_cols_array());
        words.extend([0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        words.extend(DMat4::IDENTITY.to_cols_array());
        let candidates = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0];
        let out = evaluate(&TWO_BONES, &words);
        assert_eq!(out[..4], [0.25, 0.75, 0.0, 1.0]);
        assert_eq!(out[4..], candidates);
    }

    // The vertex (0,1,0) lies on bone 0 (from the origin to (0,2,0)), weight 1, and 1 from bone 1
    // (from (1,1,0) to (3,1,0)), weight 2^-16. Bone 0 moves by (0,0,1), bone 1 by (0,0,-1), the
    // projection doubles z: u = (0, 1 + 2^-16, 2 (1 - 2^-16), 1 + 2^-16).
    #[test]
    fn skinning_by_hand() {
        let mut words = vec![0.0, 1.0, 0.0, 1.0];
        words.extend(DMat4::IDENTITY.to_cols_array());
        words.extend(DMat4::from_scale(glam::DVec3::new(1.0, 1.0, 2.0)).to_cols_array());
        words.push(2.0);
        let mut roots = [DVec4::NAN; MAXBONES];
        let mut tips = roots;
        let mut matrices = [DMat4::NAN; MAXBONES];
        (roots[0], tips[0]) = (DVec4::W, DVec4::new(0.0, 2.0, 0.0, 1.0));
        (roots[1], tips[1]) = (DVec4::new(1.0, 1.0, 0.0, 1.0), DVec4::new(3.0, 1.0, 0.0, 1.0));
        matrices[0] = DMat4::from_translation(glam::DVec3::Z);
        matrices[1] = DMat4::from_translation(glam::DVec3::NEG_Z);
        words.extend(roots.iter().chain(&tips).flat_map(|v| v.to_array()));
        words.extend(matrices.iter().flat_map(|m| m.to_cols_array()));
        let w = 2f64.powi(-16);
        for (got, want) in evaluate(&SKINNING, &words).into_iter().zip([0.0, 1.0 + w, 2.0 - 2.0 * w, 1.0 + w]) {
            assert_relative_eq!(got, want, max_relative = 1e-15);
        }
    }

    #[test]
    fn bones_that_do_not_exist_give_no_position() {
        let mut words = random_words(&SKINNING, &mut Rng::new(8));
        assert!(evaluate(&SKINNING, &words).iter().all(|w| !w.is_nan()));
        for count in [-1.0, 9.0] {
            words[36] = count;
            assert!(evaluate(&SKINNING, &words).iter().all(|w| w.is_nan()));
        }
        words[36] = 0.0;
        assert_eq!(evaluate(&SKINNING, &words), [0.0; 4], "a sum of nothing");
    }
}
