//! What the tests of formulas and relations share: random numbers, inputs and a list of broken
//! identities.

use glam::{DMat4, DQuat, DVec3, DVec4};

use judge::formula::{Args, Formula, Kind, Param, Rule};

/// SplitMix64: a page of test inputs needs no better generator, and no dependency.
pub(crate) struct Rng(u64);

impl Rng {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number in `[-r, r)`.
    pub(crate) fn within(&mut self, r: f64) -> f64 {
        (2.0 * self.unit() - 1.0) * r
    }

    /// A point with w = 1 and coordinates in `[-2, 2)`.
    pub(crate) fn point(&mut self) -> DVec4 {
        DVec4::new(self.within(2.0), self.within(2.0), self.within(2.0), 1.0)
    }

    pub(crate) fn rigid(&mut self) -> DMat4 {
        let axis = DVec3::new(self.within(1.0), self.within(1.0), 1.5).normalize();
        let turn = DQuat::from_axis_angle(axis, self.within(3.0));
        DMat4::from_rotation_translation(turn, self.point().truncate())
    }
}

/// Inputs of a formula inside its domain: points, rigid matrices, numbers in `[0, 1)`, the integer
/// 3; weights sum to 1.
pub(crate) fn random_words(formula: &Formula, rng: &mut Rng) -> Vec<f64> {
    let mut words = Vec::new();
    for param in formula.inputs {
        for _ in 0..param.array.unwrap_or(1) {
            match param.kind {
                Kind::Int => words.push(3.0),
                Kind::Float => words.push(rng.unit()),
                Kind::Vec2 => {
                    let x = rng.unit();
                    words.extend([x, 1.0 - x]);
                }
                Kind::Vec3 => words.extend(rng.point().truncate().to_array()),
                Kind::Vec4 => words.extend(rng.point().to_array()),
                Kind::Mat4 => words.extend(rng.rigid().to_cols_array()),
            }
        }
    }
    words
}

/// Outputs of a formula that has one set of outputs.
pub(crate) fn evaluate(formula: &Formula, words: &[f64]) -> Vec<f64> {
    let Rule::Pointwise(f) = formula.rule else { panic!("{} emits vertices", formula.name) };
    let mut out = vec![0.0; formula.outputs.iter().map(Param::words).sum()];
    f(&Args::new(formula.inputs, words), &mut out);
    out
}

/// The identities that were checked and whether each was broken, in the order of the first check.
#[derive(Default)]
pub(crate) struct Broken(Vec<(&'static str, bool)>);

impl Broken {
    /// Notes `identity` unless `left` is near `right`; NaN is near nothing.
    pub(crate) fn near(&mut self, identity: &'static str, left: DVec4, right: DVec4) {
        for k in 0..4 {
            self.equal(identity, left[k], right[k]);
        }
    }

    /// Notes `identity` unless `left` is near `right`; NaN is near nothing.
    pub(crate) fn equal(&mut self, identity: &'static str, left: f64, right: f64) {
        self.that(identity, approx::relative_eq!(left, right, epsilon = 1e-12, max_relative = 1e-12));
    }

    /// Notes `identity` unless it holds.
    pub(crate) fn that(&mut self, identity: &'static str, holds: bool) {
        match self.0.iter_mut().find(|(name, _)| *name == identity) {
            Some((_, broken)) => *broken |= !holds,
            None => self.0.push((identity, !holds)),
        }
    }

    /// The identities that did not hold.
    pub(crate) fn list(self) -> Vec<&'static str> {
        self.0.into_iter().filter_map(|(name, broken)| broken.then_some(name)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broken_identities_are_noted_and_nan_breaks() {
        let mut broken = Broken::default();
        broken.equal("fine", 1.0, 1.0 + 1e-14);
        broken.equal("off", 1.0, 1.0 + 1e-4);
        broken.near("nan", DVec4::NAN, DVec4::NAN);
        assert_eq!(broken.list(), ["off", "nan"]);
    }
}
