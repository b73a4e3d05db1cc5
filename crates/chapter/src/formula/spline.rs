//! Cubic curves between nodes (the hair note).
//!
//! The Hermite curve is the base; the others choose its tangents from four successive nodes
//! `q0..q3` and run from `q1` (s = 0) to `q2` (s = 1).

use glam::DVec4;

use judge::formula::{Args, Formula, Kind, Param, Rule};

/// Cubic from `p0` with the tangent `m0` to `p1` with the tangent `m1`, at `s` in `[0, 1]`.
pub static HERMITE: Formula = Formula {
    name: "hermite",
    source: "Hermite: P(s) = a s³ + b s² + c s + d, a = 2(P0-P1)+m0+m1, b = -3(P0-P1)-2m0-m1, c = m0, d = P0",
    inputs: &[
        Param::new("p0", Kind::Vec4),
        Param::new("p1", Kind::Vec4),
        Param::new("m0", Kind::Vec4),
        Param::new("m1", Kind::Vec4),
        Param::new("s", Kind::Float),
    ],
    outputs: &[Param::new("return", Kind::Vec4)],
    rule: Rule::Pointwise(hermite),
};

/// Catmull-Rom curve and its derivative at `s` in `[0, 1]`.
pub static CATMULL_ROM: Formula = Formula {
    name: "catmull_rom",
    source: "Catmull-Rom: Hermite with m0 = (q2-q0)/2, m1 = (q3-q1)/2",
    inputs: &[
        Param::new("q0", Kind::Vec4),
        Param::new("q1", Kind::Vec4),
        Param::new("q2", Kind::Vec4),
        Param::new("q3", Kind::Vec4),
        Param::new("s", Kind::Float),
    ],
    outputs: &[Param::new("return", Kind::Vec4), Param::new("derivative", Kind::Vec4)],
    rule: Rule::Pointwise(catmull_rom),
};

/// Cardinal spline: Catmull-Rom with tangents scaled by `1 - w`, at `s` in `[0, 1]`.
pub static CARDINAL: Formula = Formula {
    name: "cardinal",
    source: "Cardinal: Hermite with m0 = (1-w)(q2-q0)/2, m1 = (1-w)(q3-q1)/2",
    inputs: &[
        Param::new("q0", Kind::Vec4),
        Param::new("q1", Kind::Vec4),
        Param::new("q2", Kind::Vec4),
        Param::new("q3", Kind::Vec4),
        Param::new("w", Kind::Float),
        Param::new("s", Kind::Float),
    ],
    outputs: &[Param::new("return", Kind::Vec4)],
    rule: Rule::Pointwise(cardinal),
};

/// Kochanek-Bartels spline at `s` in `[0, 1]`.
pub static KOCHANEK_BARTELS: Formula = Formula {
    name: "kochanek_bartels",
    source: "Kochanek-Bartels: Hermite with the outgoing tangent of q1 and the incoming tangent of q2",
    inputs: &[
        Param::new("q0", Kind::Vec4),
        Param::new("q1", Kind::Vec4),
        Param::new("q2", Kind::Vec4),
        Param::new("q3", Kind::Vec4),
        Param::new("tension", Kind::Float),
        Param::new("bias", Kind::Float),
        Param::new("continuity", Kind::Float),
        Param::new("s", Kind::Float),
    ],
    outputs: &[Param::new("return", Kind::Vec4)],
    rule: Rule::Pointwise(kochanek_bartels),
};

/// A cubic by its coefficients: P(s) = a s³ + b s² + c s + d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// Of s³.
    pub a: DVec4,
    /// Of s².
    pub b: DVec4,
    /// Of s.
    pub c: DVec4,
    /// Constant.
    pub d: DVec4,
}

impl Cubic {
    /// The cubic with these ends and end tangents.
    pub fn hermite(p0: DVec4, p1: DVec4, m0: DVec4, m1: DVec4) -> Self {
        let dp = p0 - p1;
        Self { a: dp * 2.0 + m0 + m1, b: dp * -3.0 - m0 * 2.0 - m1, c: m0, d: p0 }
    }

    /// The Catmull-Rom piece between `q[1]` and `q[2]`.
    pub fn catmull_rom(q: [DVec4; 4]) -> Self {
        Self::cardinal(q, 0.0)
    }

    /// The Cardinal piece between `q[1]` and `q[2]` for the tension `w`.
    pub fn cardinal([q0, q1, q2, q3]: [DVec4; 4], w: f64) -> Self {
        Self::hermite(q1, q2, (q2 - q0) * ((1.0 - w) / 2.0), (q3 - q1) * ((1.0 - w) / 2.0))
    }

    /// The Kochanek-Bartels piece between `q[1]` and `q[2]` for tension, bias and continuity.
    pub fn kochanek_bartels([q0, q1, q2, q3]: [DVec4; 4], [t, b, c]: [f64; 3]) -> Self {
        let outgoing = (q1 - q0) * ((1.0 - t) * (1.0 + b) * (1.0 + c) / 2.0)
            + (q2 - q1) * ((1.0 - t) * (1.0 - b) * (1.0 - c) / 2.0);
        let incoming = (q2 - q1) * ((1.0 - t) * (1.0 + b) * (1.0 - c) / 2.0)
            + (q3 - q2) * ((1.0 - t) * (1.0 - b) * (1.0 + c) / 2.0);
        Self::hermite(q1, q2, outgoing, incoming)
    }

    /// The point at `s`.
    pub fn position(&self, s: f64) -> DVec4 {
        ((self.a * s + self.b) * s + self.c) * s + self.d
    }

    /// The derivative by `s`.
    pub fn derivative(&self, s: f64) -> DVec4 {
        (self.a * (3.0 * s) + self.b * 2.0) * s + self.c
    }
}

fn nodes(args: &Args<'_>) -> [DVec4; 4] {
    [args.vec4(0), args.vec4(1), args.vec4(2), args.vec4(3)]
}

fn hermite(args: &Args<'_>, out: &mut [f64]) {
    let [p0, p1, m0, m1] = nodes(args);
    Cubic::hermite(p0, p1, m0, m1).position(args.float(4)).write_to_slice(out);
}

fn catmull_rom(args: &Args<'_>, out: &mut [f64]) {
    let (cubic, s) = (Cubic::catmull_rom(nodes(args)), args.float(4));
    cubic.position(s).write_to_slice(&mut out[..4]);
    cubic.derivative(s).write_to_slice(&mut out[4..]);
}

fn cardinal(args: &Args<'_>, out: &mut [f64]) {
    Cubic::cardinal(nodes(args), args.float(4)).position(args.float(5)).write_to_slice(out);
}

fn kochanek_bartels(args: &Args<'_>, out: &mut [f64]) {
    let shape = [args.float(4), args.float(5), args.float(6)];
    Cubic::kochanek_bartels(nodes(args), shape).position(args.float(7)).write_to_slice(out);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::testing::{Broken, Rng, evaluate};

    /// Tension, bias and continuity or, for a Cardinal spline, the tension alone.
    type Shape = [f64; 3];

    fn broken(piece: impl Fn([DVec4; 4], Shape) -> Cubic) -> Vec<&'static str> {
        let (mut broken, mut rng) = (Broken::default(), Rng::new(14));
        for _ in 0..100 {
            let q: [DVec4; 5] = std::array::from_fn(|_| rng.point());
            let first = [q[0], q[1], q[2], q[3]];
            let shape @ [t, b, c] = [rng.within(1.0), rng.within(1.0), rng.within(1.0)];
            let (cubic, s) = (piece(first, shape), rng.unit());
            broken.near("start", cubic.position(0.0), q[1]);
            broken.near("end", cubic.position(1.0), q[2]);
            let smooth = [t, b, 0.0];
            let next = piece([q[1], q[2], q[3], q[4]], smooth);
            broken.near("C1", piece(first, smooth).derivative(1.0), next.derivative(0.0));
            let back = piece([q[3], q[2], q[1], q[0]], [t, -b, c]);
            broken.near("reversed", back.position(1.0 - s), cubic.position(s));
            let map = rng.rigid();
            broken.near("affine", piece(first.map(|q| map * q), shape).position(s), map * cubic.position(s));
            let line = [0.0, 1.0, -2.0, 1.5].map(|x| q[0] + (q[1] - q[0]) * x);
            let across = piece(line, shape).position(s) - q[0];
            let along = q[1] - q[0];
            broken.equal("collinear", across.truncate().cross(along.truncate()).length(), 0.0);
            broken.near("Catmull-Rom", piece(first, [0.0; 3]).derivative(0.0), (q[2] - q[0]) / 2.0);
            broken.near("polyline", piece(first, [1.0, b, c]).derivative(1.0), DVec4::ZERO);
        }
        broken.list()
    }

    #[test]
    fn identities_hold() {
        assert!(broken(Cubic::kochanek_bartels).is_empty());
        assert!(broken(|q, [w, _, _]| Cubic::cardinal(q, w)).is_empty());
    }

    #[test]
    fn perturbed_formulas_break_identities() {
        let kb = Cubic::kochanek_bartels;
        let swapped = |[q0, q1, q2, q3]: [DVec4; 4], s| kb([q0, q2, q1, q3], s);
        assert_eq!(broken(swapped), ["start", "end", "C1", "Catmull-Rom"]);
        assert_eq!(broken(|q, [t, b, c]| kb(q, [t + 1e-4, b, c])), ["Catmull-Rom", "polyline"]);
        assert_eq!(broken(|q, [t, b, c]| kb(q, [t, b, c + 1e-4])), ["C1", "Catmull-Rom"]);
        let late = |q, s| {
            let cubic = kb(q, s);
            Cubic { a: cubic.a * 1.0001, ..cubic }
        };
        assert_eq!(broken(late), ["end", "C1", "reversed", "polyline"]);
        let moved = |q, s| {
            let cubic = kb(q, s);
            Cubic { d: cubic.d + DVec4::X * 1e-4, ..cubic }
        };
        assert_eq!(broken(moved), ["start", "end", "affine", "collinear"]);
        // Tangents that take all of the difference in place of half of it.
        let long = |[q0, q1, q2, q3]: [DVec4; 4], _| Cubic::hermite(q1, q2, q2 - q0, q3 - q1);
        assert_eq!(broken(long), ["Catmull-Rom", "polyline"]);
    }

    #[test]
    fn derivative_is_that_of_the_position() {
        let mut rng = Rng::new(3);
        let cubic = Cubic::catmull_rom(std::array::from_fn(|_| rng.point()));
        let h = 1e-5;
        for s in [0.0, 0.25, 0.9] {
            let quotient = (cubic.position(s + h) - cubic.position(s - h)) / (2.0 * h);
            assert!((quotient - cubic.derivative(s)).length() < 1e-8);
            assert!((quotient - cubic.derivative(s + 1e-4)).length() > 1e-5);
        }
    }

    // Ends 0 and 8 on the x axis, tangents (8,0,0) and (0,8,0): at s = 1/2 the Hermite basis is
    // 1/2, 1/2, 1/8, -1/8, so x = 4 + 1 and y = -1.
    #[test]
    fn hermite_by_hand() {
        let mut words = Vec::new();
        for v in [[0.0, 0.0, 0.0, 1.0], [8.0, 0.0, 0.0, 1.0], [8.0, 0.0, 0.0, 0.0], [0.0, 8.0, 0.0, 0.0]] {
            words.extend(v);
        }
        words.push(0.5);
        assert_eq!(evaluate(&HERMITE, &words), [5.0, -1.0, 0.0, 1.0]);
    }

    const NODES: [[f64; 4]; 4] =
        [[0.0, 0.0, 0.0, 1.0], [0.0, 8.0, 0.0, 1.0], [8.0, 8.0, 0.0, 1.0], [8.0, 0.0, 16.0, 1.0]];

    fn words(tail: &[f64]) -> Vec<f64> {
        NODES.iter().flatten().chain(tail).copied().collect()
    }

    // m0 = (4,4,0), m1 = (4,-4,8). At s = 1/2: mean of q1 and q2 (4,8,0) plus (m0-m1)/8 = (0,1,-1).
    // Derivative at 1/2: basis derivatives -3/2, 3/2, -1/4, -1/4: (12,0,0) - (8,0,8)/4 = (10,0,-2).
    #[test]
    fn catmull_rom_by_hand() {
        let out = evaluate(&CATMULL_ROM, &words(&[0.5]));
        assert_eq!(out, [4.0, 9.0, -1.0, 1.0, 10.0, 0.0, -2.0, 0.0]);
    }

    // Half the tangents of Catmull-Rom: (4,8,0) + (0,1,-1)/2.
    #[test]
    fn cardinal_by_hand() {
        assert_eq!(evaluate(&CARDINAL, &words(&[0.5, 0.5])), [4.0, 8.5, -0.5, 1.0]);
    }

    // t = 0, b = 1/2, c = -1/2: (1+b)(1+c)/2 = 3/8, (1-b)(1-c)/2 = 3/8, (1+b)(1-c)/2 = 9/8,
    // (1-b)(1+c)/2 = 1/8. Outgoing 3/8 (0,8,0) + 3/8 (8,0,0) = (3,3,0); incoming 9/8 (8,0,0) +
    // 1/8 (0,-8,16) = (9,-1,2). At s = 1/2: (4,8,0) + (-6,4,-2)/8 = (3.25, 8.5, -0.25).
    #[test]
    fn kochanek_bartels_by_hand() {
        let out = evaluate(&KOCHANEK_BARTELS, &words(&[0.0, 0.5, -0.5, 0.5]));
        assert_eq!(out, [3.25, 8.5, -0.25, 1.0]);
    }
}
