//! Rigid parts at joints (section 9.3.1).

use glam::DVec4;

use judge::formula::{Args, Formula, Kind, Param, Rule};

/// Number of parts of the shader.
pub const PARTS: usize = 4;

/// A vertex moved by the rigid transform of its part, put through `mc`. NaN when `part` is not in
/// `0..PARTS`. A connecting part owns no vertices: its faces are drawn between vertices of its two
/// neighbours, each of which carries its own part's number.
pub static JOINTS: Formula = Formula {
    name: "joints",
    source: "section 9.3.1: P' = M_part P",
    inputs: &[
        Param::new("position", Kind::Vec4),
        Param::new("part", Kind::Int),
        Param::array("partMatrix", Kind::Mat4, PARTS),
        Param::new("mc", Kind::Mat4),
    ],
    outputs: &[Param::new("gl_Position", Kind::Vec4)],
    rule: Rule::Pointwise(evaluate),
};

fn evaluate(args: &Args<'_>, out: &mut [f64]) {
    let part = args.float(1);
    let position =
        if (0.0..PARTS as f64).contains(&part) { args.mat4_at(2, part as usize) * args.vec4(0) } else { DVec4::NAN };
    (args.mat4(3) * position).write_to_slice(out);
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;
    use glam::DMat4;

    use super::*;
    use crate::formula::testing::{Broken, Rng, evaluate};

    fn place(position: DVec4, part: i32, matrices: [DMat4; PARTS]) -> DVec4 {
        let mut words = position.to_array().to_vec();
        words.push(f64::from(part));
        words.extend(matrices.iter().flat_map(|m| m.to_cols_array()));
        words.extend(DMat4::IDENTITY.to_cols_array());
        DVec4::from_slice(&evaluate(&JOINTS, &words))
    }

    fn broken(place: impl Fn(DVec4, i32, [DMat4; PARTS]) -> DVec4) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(93));
        for i in 0..100 {
            let (p, q, part) = (rng.point(), rng.point(), i % PARTS as i32);
            let matrices: [DMat4; PARTS] = std::array::from_fn(|_| rng.rigid());
            let at = place(p, part, matrices);
            broken.near("rest", place(p, part, [DMat4::IDENTITY; PARTS]), p);
            broken.equal("rigid", (place(q, part, matrices) - at).length(), (q - p).length());
            let mut others = [DMat4::IDENTITY; PARTS];
            others[part as usize] = matrices[part as usize];
            broken.near("own part", place(p, part, others), at);
            let common = rng.rigid();
            broken.near("common motion", place(p, part, matrices.map(|m| common * m)), common * at);
        }
        broken.list()
    }

    #[test]
    fn identities_hold() {
        assert!(broken(place).is_empty());
    }

    #[test]
    fn perturbed_formulas_break_identities() {
        assert_eq!(broken(|p, part, m| place(p, (part + 1) % 4, m)), ["own part"]);
        assert_eq!(broken(|p, part, m| place(p, part, m.map(|m| m.transpose()))), ["rigid", "common motion"]);
        let stretched = |p, part, m| (place(p, part, m).truncate() * 1.0001).extend(1.0);
        assert_eq!(broken(stretched), ["rest", "rigid", "common motion"]);
    }

    // Two rings of radius 1 around the y axis, joined by straight edges; the second part turns by the
    // angle a about y. The midpoint of an edge is ((1 + cos a)/2, 0, ±(sin a)/2), at the distance
    // √((1+cos a)/2) = cos(a/2) from the axis: a half turn collapses the connecting part to a point.
    #[test]
    fn the_connecting_part_collapses_as_its_neighbours_turn_apart() {
        let waist = |a: f64| {
            let mut m = [DMat4::IDENTITY; PARTS];
            m[1] = DMat4::from_rotation_y(a);
            let lower = place(DVec4::new(1.0, -1.0, 0.0, 1.0), 0, m);
            let upper = place(DVec4::new(1.0, 1.0, 0.0, 1.0), 1, m);
            let middle = (lower + upper) / 2.0;
            middle.x.hypot(middle.z)
        };
        for a in [0.0, 0.5, 2.0, PI] {
            assert_relative_eq!(waist(a), (a / 2.0).cos(), epsilon = 1e-15);
        }
        assert!(waist(PI) < 1e-15);
    }

    // Rotation by 90° about z takes (1,0,0) to (0,1,0); the translation (2,3,4) follows.
    #[test]
    fn a_quarter_turn_by_hand() {
        let mut m = [DMat4::IDENTITY; PARTS];
        m[2] =
            DMat4::from_cols_array(&[0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 2.0, 3.0, 4.0, 1.0]);
        assert_eq!(place(DVec4::new(1.0, 0.0, 0.0, 1.0), 2, m), DVec4::new(2.0, 4.0, 4.0, 1.0));
    }

    #[test]
    fn a_part_that_does_not_exist_has_no_position() {
        for part in [-1, 4] {
            assert!(place(DVec4::W, part, [DMat4::IDENTITY; PARTS]).is_nan());
        }
    }
}
