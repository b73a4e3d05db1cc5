//! Distance of a point to a bone (section 9.3.2).

use glam::DVec4;

use judge::formula::{Args, Formula, Kind, Param, Rule};

/// Distance of the point `p` to the segment from `p0` to `p1`, all with the same w.
pub static SEGMENT_DISTANCE: Formula = Formula {
    name: "segment_distance",
    source: "(78), (79): |V2 - V1 t| with t = V1·V2 / V1² held in [0, 1]",
    inputs: &[Param::new("p", Kind::Vec4), Param::new("p0", Kind::Vec4), Param::new("p1", Kind::Vec4)],
    outputs: &[Param::new("return", Kind::Float)],
    rule: Rule::Pointwise(evaluate),
};

/// (78): distance of `p` to the line through `p0` and `p1`. NaN when these coincide.
pub fn line_distance(p: DVec4, p0: DVec4, p1: DVec4) -> f64 {
    let (v1, v2) = (p1 - p0, p - p0);
    let t = v1.dot(v2) / v1.length_squared();
    (v2 - v1 * t).length()
}

/// (79): distance of `p` to the segment from `p0` to `p1`, in its three cases. A segment whose ends
/// coincide is a point.
pub fn segment_distance(p: DVec4, p0: DVec4, p1: DVec4) -> f64 {
    let (v1, v2) = (p1 - p0, p - p0);
    let squared = v1.length_squared();
    let along = v1.dot(v2);
    if squared == 0.0 || along <= 0.0 {
        v2.length()
    } else if along >= squared {
        (v2 - v1).length()
    } else {
        (v2 - v1 * (along / squared)).length()
    }
}

fn evaluate(args: &Args<'_>, out: &mut [f64]) {
    out[0] = segment_distance(args.vec4(0), args.vec4(1), args.vec4(2));
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::formula::testing::{Broken, Rng, evaluate};

    fn clamped(p: DVec4, p0: DVec4, p1: DVec4) -> f64 {
        let (v1, v2) = (p1 - p0, p - p0);
        let squared = v1.length_squared();
        let t = if squared > 0.0 { (v1.dot(v2) / squared).clamp(0.0, 1.0) } else { 0.0 };
        (v2 - v1 * t).length()
    }

    fn broken(distance: impl Fn(DVec4, DVec4, DVec4) -> f64) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(79));
        for _ in 0..200 {
            let (p, q, p0, p1, s) = (rng.point(), rng.point(), rng.point(), rng.point(), rng.unit());
            let d = distance(p, p0, p1);
            broken.that("not negative", d >= 0.0);
            broken.equal("on the segment", distance(p0.lerp(p1, s), p0, p1), 0.0);
            broken.that("zero beside it", distance(p0 + (p0 - p1) * 0.01, p0, p1) > 1e-6);
            broken.equal("swapped", distance(p, p1, p0), d);
            broken.that("1-Lipschitz", (distance(q, p0, p1) - d).abs() <= (q - p).length() + 1e-12);
            broken.equal("clamped form", clamped(p, p0, p1), d);
            broken.equal("degenerate", distance(p, p0, p0), (p - p0).length());
            let map = rng.rigid();
            broken.equal("rigid", distance(map * p, map * p0, map * p1), d);
        }
        broken.list()
    }

    #[test]
    fn identities_hold() {
        assert!(broken(segment_distance).is_empty());
    }

    #[test]
    fn perturbed_formulas_break_identities() {
        assert_eq!(broken(line_distance), ["zero beside it", "clamped form", "degenerate"]);
        let scaled = |p, p0, p1| segment_distance(p, p0, p1) * 1.0001;
        assert_eq!(broken(scaled), ["clamped form", "degenerate"]);
        let shifted = |p: DVec4, p0, p1| segment_distance(p + DVec4::X * 1e-4, p0, p1);
        assert_eq!(broken(shifted), ["on the segment", "clamped form", "degenerate", "rigid"]);
        let long = |p, p0: DVec4, p1| segment_distance(p, p0, p0 + (p1 - p0) * 1.0001);
        assert_eq!(broken(long), ["swapped", "clamped form"]);
    }

    // Segment from the origin to (4,0,0). (2,3,0): foot (2,0,0), d = 3. (-3,4,0): before the start,
    // d = 5. (7,0,4): past the end, d = |(3,0,4)| = 5, but 4 from the line.
    #[test]
    fn the_three_cases_by_hand() {
        let (p0, p1) = (DVec4::W, DVec4::new(4.0, 0.0, 0.0, 1.0));
        for ([x, y, z], want) in [([2.0, 3.0, 0.0], 3.0), ([-3.0, 4.0, 0.0], 5.0), ([7.0, 0.0, 4.0], 5.0)] {
            let mut words = vec![x, y, z, 1.0];
            words.extend(p0.to_array());
            words.extend(p1.to_array());
            assert_eq!(evaluate(&SEGMENT_DISTANCE, &words), [want]);
        }
        assert_relative_eq!(line_distance(DVec4::new(7.0, 0.0, 4.0, 1.0), p0, p1), 4.0);
    }

    #[test]
    fn no_line_goes_through_one_point() {
        assert!(line_distance(DVec4::X, DVec4::W, DVec4::W).is_nan());
    }
}
