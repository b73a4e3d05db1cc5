//! Morphing between two shapes (section 9.2.1).

use glam::DVec4;

use judge::formula::{Args, Formula, Kind, Param, Rule};

/// Two corresponding vertices blended by `t` in `[0, 1]`, put through `mc`.
pub static MORPH: Formula = Formula {
    name: "morph",
    source: "(72): P = (1-s) P0 + s P1, with t0 = 0 and t1 = 1",
    inputs: &[
        Param::new("p0", Kind::Vec4),
        Param::new("p1", Kind::Vec4),
        Param::new("t", Kind::Float),
        Param::new("mc", Kind::Mat4),
    ],
    outputs: &[Param::new("gl_Position", Kind::Vec4)],
    rule: Rule::Pointwise(evaluate),
};

/// (72): the position at time `t` of a vertex that moves from `p0` at `t0` to `p1` at `t1`. NaN when
/// `t0 = t1`. Times outside `[t0, t1]` extrapolate.
pub fn position_at(t: f64, (t0, p0): (f64, DVec4), (t1, p1): (f64, DVec4)) -> DVec4 {
    if t0 == t1 {
        return DVec4::NAN;
    }
    let s = (t - t0) / (t1 - t0);
    p0 * (1.0 - s) + p1 * s
}

fn evaluate(args: &Args<'_>, out: &mut [f64]) {
    let position = position_at(args.float(2), (0.0, args.vec4(0)), (1.0, args.vec4(1)));
    (args.mat4(3) * position).write_to_slice(out);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::testing::{Broken, Rng, evaluate};

    type End = (f64, DVec4);

    fn broken(at: impl Fn(f64, End, End) -> DVec4) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(72));
        for _ in 0..100 {
            let (a, b) = ((rng.within(3.0), rng.point()), (4.0 + rng.unit(), rng.point()));
            let s = rng.unit();
            let t = a.0 + s * (b.0 - a.0);
            let p = at(t, a, b);
            broken.near("start", at(a.0, a, b), a.1);
            broken.near("end", at(b.0, a, b), b.1);
            let length = (b.1 - a.1).length();
            broken.equal("on the segment", (p - a.1).length() + (b.1 - p).length(), length);
            broken.near("swapped", at(a.0 + b.0 - t, (a.0, b.1), (b.0, a.1)), p);
            let map = rng.rigid();
            broken.near("affine", at(t, (a.0, map * a.1), (b.0, map * b.1)), map * p);
        }
        broken.list()
    }

    #[test]
    fn identities_hold() {
        assert!(broken(position_at).is_empty());
    }

    #[test]
    fn perturbed_formulas_break_identities() {
        let shift = DVec4::new(1e-4, 0.0, 0.0, 0.0);
        assert_eq!(broken(|t, a, b| position_at(t + 1e-4, a, b)), ["start", "end", "swapped"]);
        assert_eq!(broken(|t, a, b| position_at(t, a, b) + shift), ["start", "end", "on the segment", "affine"]);
        assert_eq!(broken(|t, a, b| position_at(t, (a.0, b.1), (b.0, a.1))), ["start", "end"]);
    }

    // A quarter of the way from (0,4,8) to (4,0,8): (1,3,8); time 3 is a quarter of [2,6].
    #[test]
    fn a_quarter_of_the_way() {
        let (p0, p1) = (DVec4::new(0.0, 4.0, 8.0, 1.0), DVec4::new(4.0, 0.0, 8.0, 1.0));
        assert_eq!(position_at(3.0, (2.0, p0), (6.0, p1)), DVec4::new(1.0, 3.0, 8.0, 1.0));
        let mut words = p0.to_array().to_vec();
        words.extend(p1.to_array());
        words.push(0.25);
        // mc doubles x and exchanges y and z.
        words.extend([2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(evaluate(&MORPH, &words), [2.0, 8.0, 3.0, 1.0]);
    }

    #[test]
    fn an_empty_interval_of_time_has_no_position() {
        assert!(position_at(1.0, (1.0, DVec4::W), (1.0, DVec4::ONE)).is_nan());
    }
}
