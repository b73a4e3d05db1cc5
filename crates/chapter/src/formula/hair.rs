//! One piece of a strand of hair (the hair note, geometry stage).

use glam::{DVec3, DVec4};

use super::spline::Cubic;
use judge::formula::{Args, Emission, Formula, Kind, Param, Rule};

/// Number of straight pieces that a segment is drawn with.
pub const DIVISION: u32 = 4;

/// Position of the light, w = 1.
pub const LIGHT: DVec4 = DVec4::new(1.0, 6.0, 4.0, 1.0);

/// The Catmull-Rom curve between the second and the third of four nodes (`gl_Position` of the four
/// vertices of a line with adjacency) as one strip of five vertices. Per vertex: the position put
/// through `mc`, and the unit vectors to the viewer at the origin, to the light and along the curve.
/// A direction is NaN where its vector is zero.
pub static HAIR: Formula = Formula {
    name: "hair",
    source: "hair note: Catmull-Rom at s = i/4, v = -P/|P|, l = (L - P)/|L - P|, t = P'/|P'|",
    inputs: &[Param::array("gl_Position", Kind::Vec4, 4), Param::new("mc", Kind::Mat4)],
    outputs: &[
        Param::new("gl_Position", Kind::Vec4),
        Param::new("v", Kind::Vec3),
        Param::new("l", Kind::Vec3),
        Param::new("t", Kind::Vec3),
    ],
    rule: Rule::Emission(evaluate),
};

/// The direction of a vector. NaN for the zero vector.
pub fn direction(vector: DVec3) -> DVec3 {
    vector / vector.length()
}

fn evaluate(args: &Args<'_>, out: &mut Emission) {
    let (cubic, mc) = (Cubic::catmull_rom(std::array::from_fn(|k| args.vec4_at(0, k))), args.mat4(1));
    for i in 0..=DIVISION {
        let s = f64::from(i) / f64::from(DIVISION);
        let position = cubic.position(s);
        let mut vertex = [0.0; 13];
        (mc * position).write_to_slice(&mut vertex[..4]);
        (-direction(position.truncate())).write_to_slice(&mut vertex[4..7]);
        direction((LIGHT - position * LIGHT.w).truncate()).write_to_slice(&mut vertex[7..10]);
        direction(cubic.derivative(s).truncate()).write_to_slice(&mut vertex[10..]);
        out.emit(&vertex);
    }
    out.end_strip();
}

#[cfg(test)]
mod tests {
    use glam::DMat4;

    use super::*;
    use crate::formula::testing::{Broken, Rng};

    fn emit(nodes: [DVec4; 4]) -> Emission {
        let mut words: Vec<f64> = nodes.iter().flat_map(|q| q.to_array()).collect();
        words.extend(DMat4::IDENTITY.to_cols_array());
        let mut out = Emission::default();
        evaluate(&Args::new(HAIR.inputs, &words), &mut out);
        out
    }

    fn vec3(vertex: &[f64], at: usize) -> DVec3 {
        DVec3::from_slice(&vertex[at..])
    }

    fn broken(emit: impl Fn([DVec4; 4]) -> Emission) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(12));
        for _ in 0..100 {
            let nodes: [DVec4; 4] = std::array::from_fn(|_| rng.point());
            let out = emit(nodes);
            broken.that("five vertices", out.strips == [0; 5]);
            let vertices: Vec<&[f64]> = out.words.chunks_exact(13).collect();
            let point = |i: usize| DVec4::from_slice(vertices[i]);
            broken.near("start", point(0), nodes[1]);
            broken.near("end", point(4), nodes[2]);
            // The fourth difference of a cubic is 0.
            let fourth = point(0) - point(1) * 4.0 + point(2) * 6.0 - point(3) * 4.0 + point(4);
            broken.near("cubic", fourth, DVec4::ZERO);
            for vertex in &vertices {
                for at in [4, 7, 10] {
                    broken.equal("unit", vec3(vertex, at).length(), 1.0);
                }
                let (p, v, l) = (vec3(vertex, 0), vec3(vertex, 4), vec3(vertex, 7));
                broken.equal("viewer", v.dot(p), -p.length());
                broken.equal("light", l.dot(DVec3::new(1.0, 6.0, 4.0) - p), (DVec3::new(1.0, 6.0, 4.0) - p).length());
            }
            broken.equal("tangent", vec3(vertices[0], 10).dot(direction((nodes[2] - nodes[0]).truncate())), 1.0);
        }
        broken.list()
    }

    fn changed(change: impl Fn(&mut [f64])) -> impl Fn([DVec4; 4]) -> Emission {
        move |nodes| {
            let mut out = emit(nodes);
            out.words.chunks_exact_mut(13).for_each(&change);
            out
        }
    }

    #[test]
    fn identities_hold() {
        assert!(broken(emit).is_empty());
    }

    #[test]
    fn perturbed_formulas_break_identities() {
        assert_eq!(broken(changed(|v| v[0] += 1e-4)), ["start", "end", "viewer", "light"]);
        assert_eq!(broken(changed(|v| v[3] = 0.0)), ["start", "end"]);
        assert_eq!(broken(changed(|v| v[4] = -v[4])), ["viewer"]);
        assert_eq!(broken(changed(|v| v.swap(7, 8))), ["light"]);
        assert_eq!(broken(changed(|v| v[10..].iter_mut().for_each(|x| *x = -*x))), ["tangent"]);
        assert_eq!(broken(changed(|v| v[12] *= 1.001)), ["unit", "tangent"]);
        let last_vertex = |nodes| {
            let mut out = emit(nodes);
            out.words[4 * 13 + 1] += 1e-4;
            out
        };
        assert_eq!(broken(last_vertex), ["end", "cubic", "viewer", "light"]);
        let two_strips = |nodes| {
            let mut out = emit(nodes);
            out.strips[4] = 1;
            out
        };
        assert_eq!(broken(two_strips), ["five vertices"]);
    }

    // Nodes 0, 1, 2, 3 on the line (x, 6, 4): the curve runs evenly from x = 1 to x = 2 with the
    // tangent (1,0,0). The first vertex sits in the light, so it has no light direction; the others
    // see it along -x. The last one sees the viewer along -(2,6,4)/√56.
    #[test]
    fn a_straight_strand_through_the_light() {
        let out = emit([0.0, 1.0, 2.0, 3.0].map(|x| DVec4::new(x, 6.0, 4.0, 1.0)));
        for (i, vertex) in out.words.chunks_exact(13).enumerate() {
            assert_eq!(vertex[..4], [1.0 + i as f64 / 4.0, 6.0, 4.0, 1.0]);
            assert_eq!(vertex[10..], [1.0, 0.0, 0.0]);
            if i == 0 {
                assert!(vec3(vertex, 7).is_nan());
            } else {
                assert_eq!(vertex[7..10], [-1.0, 0.0, 0.0]);
            }
        }
        let v = vec3(&out.words[4 * 13..], 4);
        assert!((v + DVec3::new(2.0, 6.0, 4.0) / 56f64.sqrt()).length() < 1e-15);
    }

    #[test]
    fn coinciding_nodes_have_no_tangent() {
        let out = emit([DVec4::ONE; 4]);
        assert!(out.words.chunks_exact(13).all(|v| v[10..].iter().all(|x| x.is_nan())));
        assert!(out.words.chunks_exact(13).all(|v| v[..10].iter().all(|x| !x.is_nan())));
    }
}
