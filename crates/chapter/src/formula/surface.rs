//! Points of a sphere and of a cylinder over a grid (section 9.1).

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec4};

use judge::formula::{Args, Formula, Kind, Param, Rule};

/// Unit sphere over `parameter` = (s, t), both in `[0, 1]`, put through `mc`.
pub static SPHERE: Formula = Formula {
    name: "sphere",
    source: "section 9.1: (sin φ cos θ, cos φ, sin φ sin θ), θ = 2π s, φ = π t",
    inputs: &[Param::new("parameter", Kind::Vec2), Param::new("mc", Kind::Mat4)],
    outputs: &[Param::new("gl_Position", Kind::Vec4)],
    rule: Rule::Pointwise(sphere),
};

/// Side of a cylinder of radius 1 and height 2 over `parameter` = (s, t), both in `[0, 1]`, put
/// through `mc`.
pub static CYLINDER: Formula = Formula {
    name: "cylinder",
    source: "section 9.1: (cos θ, 2t-1, sin θ), θ = 2π s",
    inputs: &[Param::new("parameter", Kind::Vec2), Param::new("mc", Kind::Mat4)],
    outputs: &[Param::new("gl_Position", Kind::Vec4)],
    rule: Rule::Pointwise(cylinder),
};

/// The point of the unit sphere with azimuth 2π s and polar angle π t, measured from +y.
pub fn sphere_point(parameter: DVec2) -> DVec4 {
    let (sin_th, cos_th) = (TAU * parameter.x).sin_cos();
    let (sin_ph, cos_ph) = (PI * parameter.y).sin_cos();
    DVec4::new(sin_ph * cos_th, cos_ph, sin_ph * sin_th, 1.0)
}

/// The point of the cylinder with azimuth 2π s at the height 2t - 1.
pub fn cylinder_point(parameter: DVec2) -> DVec4 {
    let (sin_th, cos_th) = (TAU * parameter.x).sin_cos();
    DVec4::new(cos_th, 2.0 * parameter.y - 1.0, sin_th, 1.0)
}

fn sphere(args: &Args<'_>, out: &mut [f64]) {
    (args.mat4(1) * sphere_point(args.vec2(0))).write_to_slice(out);
}

fn cylinder(args: &Args<'_>, out: &mut [f64]) {
    (args.mat4(1) * cylinder_point(args.vec2(0))).write_to_slice(out);
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use glam::{DMat4, Vec4Swizzles};

    use super::*;
    use crate::formula::testing::{Broken, Rng, evaluate};

    fn broken_sphere(point: impl Fn(DVec2) -> DVec4) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(72));
        for _ in 0..100 {
            let (s, t) = (rng.unit(), rng.unit());
            let p = point(DVec2::new(s, t));
            broken.equal("radius", p.truncate().length(), 1.0);
            broken.equal("w", p.w, 1.0);
            broken.near("seam", point(DVec2::new(0.0, t)), point(DVec2::new(1.0, t)));
            broken.near("north", point(DVec2::new(s, 0.0)), DVec4::new(0.0, 1.0, 0.0, 1.0));
            broken.near("south", point(DVec2::new(s, 1.0)), DVec4::new(0.0, -1.0, 0.0, 1.0));
            let antipode = point(DVec2::new(s + 0.5, 1.0 - t));
            broken.near("antipode", antipode, (-p.truncate()).extend(1.0));
        }
        broken.list()
    }

    fn broken_cylinder(point: impl Fn(DVec2) -> DVec4) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(9));
        for _ in 0..100 {
            let (s, t) = (rng.unit(), rng.unit());
            let p = point(DVec2::new(s, t));
            broken.equal("radius", p.x.hypot(p.z), 1.0);
            broken.equal("w", p.w, 1.0);
            for t in [0.0, t, 1.0] {
                broken.that("height", (-1.0..=1.0).contains(&point(DVec2::new(s, t)).y));
            }
            broken.equal("bottom", point(DVec2::new(s, 0.0)).y, -1.0);
            broken.near("seam", point(DVec2::new(0.0, t)), point(DVec2::new(1.0, t)));
        }
        broken.list()
    }

    #[test]
    fn identities_hold() {
        assert!(broken_sphere(sphere_point).is_empty());
        assert!(broken_cylinder(cylinder_point).is_empty());
    }

    #[test]
    fn perturbed_formulas_break_identities() {
        let scaled = |p: DVec4| (p.truncate() * 1.0001).extend(p.w);
        assert_eq!(broken_sphere(|q| scaled(sphere_point(q))), ["radius", "north", "south"]);
        assert_eq!(broken_sphere(|q| sphere_point(DVec2::new(q.x * 1.0001, q.y))), ["seam", "antipode"]);
        assert_eq!(broken_sphere(|q| sphere_point(DVec2::new(q.x, q.y * 1.0001))), ["south", "antipode"]);
        assert_eq!(broken_sphere(|q| sphere_point(q) * 1.0001), ["radius", "w", "north", "south", "antipode"]);
        assert_eq!(broken_cylinder(|q| scaled(cylinder_point(q))), ["radius", "height", "bottom"]);
        assert_eq!(broken_cylinder(|q| cylinder_point(q).yxzw()), ["radius", "bottom"]);
    }

    // θ = 2π/8 = π/4 and φ = π/3: sin φ = √3/2, cos φ = 1/2, sin θ = cos θ = √2/2, so the point is
    // (√6/4, 1/2, √6/4).
    #[test]
    fn sphere_at_an_eighth_turn_and_a_third_of_the_way_down() {
        let p = sphere_point(DVec2::new(0.125, 1.0 / 3.0));
        let x = 6f64.sqrt() / 4.0;
        assert_relative_eq!(p.x, x, max_relative = 1e-15);
        assert_relative_eq!(p.y, 0.5, max_relative = 1e-15);
        assert_relative_eq!(p.z, x, max_relative = 1e-15);
    }

    // θ = 2π/6: (cos 60°, 2·3/4 - 1, sin 60°) = (1/2, 1/2, √3/2).
    #[test]
    fn cylinder_at_a_sixth_turn() {
        let p = cylinder_point(DVec2::new(1.0 / 6.0, 0.75));
        assert_relative_eq!(p.x, 0.5, max_relative = 1e-15);
        assert_relative_eq!(p.y, 0.5);
        assert_relative_eq!(p.z, 3f64.sqrt() / 2.0, max_relative = 1e-15);
    }

    // s = 1/4, t = 1/2 is the point (0, 0, 1). With mc[c][r] = 10c + r it becomes the sum of the third
    // and the fourth column, (20 + 30, 21 + 31, 22 + 32, 23 + 33).
    #[test]
    fn mc_acts_from_the_left_column_by_column() {
        let cols: [f64; 16] = std::array::from_fn(|i| (10 * (i / 4) + i % 4) as f64);
        let mut words = vec![0.25, 0.5];
        words.extend(cols);
        let out = evaluate(&SPHERE, &words);
        for (k, want) in [50.0, 52.0, 54.0, 56.0].into_iter().enumerate() {
            assert_relative_eq!(out[k], want, max_relative = 1e-14);
        }
        let transposed: Vec<f64> =
            [0.25, 0.5].into_iter().chain(DMat4::from_cols_array(&cols).transpose().to_cols_array()).collect();
        assert!(evaluate(&SPHERE, &transposed)[0] < 10.0);
    }
}
