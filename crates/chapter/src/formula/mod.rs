//! Reference formulas in binary64. Written by hand from the mathematics; this module imports the
//! standard library and glam alone, so that it shares nothing with the shaders that it judges.
//!
//! A formula has named inputs and outputs: the names of the shader's attributes, uniforms and
//! outputs (of a function: its parameters, and `return`), in the shader's order. Points are
//! homogeneous columns, matrices act from the left. Where a formula has no value (a direction of
//! a zero vector, say) it writes NaN.

pub mod blending;
pub mod hair;
pub mod joints;
pub mod morph;
pub mod morph_targets;
pub mod segment;
pub mod spline;
pub mod surface;
#[cfg(test)]
pub(crate) mod testing;
pub mod weight;

use judge::formula::Formula;

/// All formulas, in the order of the manual.
pub static ALL: &[&Formula] = &[
    &surface::SPHERE,
    &surface::CYLINDER,
    &morph::MORPH,
    &morph_targets::MORPH_TARGETS,
    &joints::JOINTS,
    &blending::TWO_BONES,
    &blending::SKINNING,
    &hair::HAIR,
    &spline::HERMITE,
    &spline::CATMULL_ROM,
    &spline::CARDINAL,
    &spline::KOCHANEK_BARTELS,
    &segment::SEGMENT_DISTANCE,
    &weight::BONE_WEIGHT,
];

/// All formulas.
pub fn all() -> &'static [&'static Formula] {
    ALL
}

/// The formula called `name`.
pub fn by_name(name: &str) -> Option<&'static Formula> {
    all().iter().copied().find(|f| f.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::formula::{Args, Emission, Param, Rule};

    #[test]
    fn names_are_unique_and_found() {
        for formula in all() {
            assert!(std::ptr::eq(by_name(formula.name).unwrap(), *formula), "{}", formula.name);
        }
        assert!(by_name("Sphere").is_none());
    }

    #[test]
    fn inputs_and_outputs_have_unique_names() {
        for formula in all() {
            for params in [formula.inputs, formula.outputs] {
                for (i, param) in params.iter().enumerate() {
                    assert!(params[..i].iter().all(|p| p.name != param.name), "{} {}", formula.name, param.name);
                    assert!(param.words() > 0);
                }
            }
        }
    }

    #[test]
    fn every_output_is_written() {
        // A word that keeps the mark was not written.
        const MARK: f64 = 12345.678;
        let mut rng = testing::Rng::new(1);
        for formula in all() {
            let words = testing::random_words(formula, &mut rng);
            let wanted: usize = formula.outputs.iter().map(Param::words).sum();
            match formula.rule {
                Rule::Pointwise(f) => {
                    let mut out = vec![MARK; wanted];
                    f(&Args::new(formula.inputs, &words), &mut out);
                    assert!(out.iter().all(|&w| w != MARK && !w.is_nan()), "{}: {out:?}", formula.name);
                }
                Rule::Emission(f) => {
                    let mut out = Emission::default();
                    f(&Args::new(formula.inputs, &words), &mut out);
                    assert_eq!(out.words.len(), out.strips.len() * wanted, "{}", formula.name);
                    assert!(!out.strips.is_empty() && out.words.iter().all(|w| !w.is_nan()), "{}", formula.name);
                }
            }
        }
    }
}
