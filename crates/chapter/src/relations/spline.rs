//! Relations of the curves through nodes `q0..q3`, from `q1` at s = 0 to `q2` at s = 1, and of the
//! Hermite curve.
//!
//! Derivatives come from values: five values of a cubic at s = 0, 1/4, ..., 1 give its derivative
//! without a truncation error, so that no relation needs an output that a curve may not have.

use property::ball::{Ball, cross, exact, minus, outputs, plus, xyz};
use property::rule::{Claims, Exact, Rule, Words, grid_point, hash, number, on_grid, point, put, put_point, with};
use property::{Observed, Sample};

const NODES: [&str; 4] = ["q0", "q1", "q2", "q3"];

const NEEDS: &[(&str, Words)] =
    &[("q0", Words::Point), ("q1", Words::Point), ("q2", Words::Point), ("q3", Words::Point), ("s", Words::Exactly(1))];

/// Derivative at the first of four values of a cubic that lie 1/4 apart.
pub(super) fn start_derivative(f: [[Ball; 4]; 4]) -> [Ball; 4] {
    combination(f, [-11.0, 18.0, -9.0, 2.0], 6.0 / 4.0)
}

/// Derivative at the middle of five values of a cubic that lie 1/4 apart, from those around it.
pub(super) fn middle_derivative(f: [[Ball; 4]; 5]) -> [Ball; 4] {
    combination([f[0], f[1], f[3], f[4]], [1.0, -8.0, 8.0, -1.0], 12.0 / 4.0)
}

/// Derivatives at all five values of a cubic that lie 1/4 apart.
pub(super) fn derivatives(f: [[Ball; 4]; 5]) -> [[Ball; 4]; 5] {
    let back = |i: usize, j: usize, k: usize, l: usize| start_derivative([f[i], f[j], f[k], f[l]]).map(|x| -x);
    [
        start_derivative([f[0], f[1], f[2], f[3]]),
        start_derivative([f[1], f[2], f[3], f[4]]),
        middle_derivative(f),
        back(3, 2, 1, 0),
        back(4, 3, 2, 1),
    ]
}

fn combination(f: [[Ball; 4]; 4], factors: [f64; 4], divisor: f64) -> [Ball; 4] {
    let zero = exact([0.0; 4]);
    f.into_iter().zip(factors).fold(zero, |sum, (value, factor)| plus(sum, value, factor / divisor))
}

fn nodes(sample: &Sample) -> Option<[[f64; 4]; 4]> {
    let [a, b, c, d] = NODES.map(|name| point(sample, name));
    Some([a?, b?, c?, d?])
}

fn put_nodes(sample: &mut Sample, nodes: [[f64; 4]; 4]) -> Option<()> {
    NODES.into_iter().zip(nodes).try_for_each(|(name, node)| put_point(sample, name, node))
}

fn at(sample: &Sample, s: f64) -> Option<Sample> {
    with(sample, |copy| put(copy, "s", &[s]))
}

/// The sample at s = 0, 1/4, 1/2, 3/4, 1.
fn quarters(sample: &Sample) -> Option<Vec<Sample>> {
    [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().map(|s| at(sample, s)).collect()
}

/// The positions of five outputs.
fn five(o: &[Observed]) -> [[Ball; 4]; 5] {
    std::array::from_fn(|k| outputs(&o[k], 0))
}

/// Claims the ends and end tangents of a cubic given at five places, which make it this cubic.
fn ends_and_tangents(o: &[Observed], ends: [[f64; 4]; 2], tangents: [[f64; 4]; 2], claims: &mut Claims<'_>) {
    let points = five(o);
    let slopes = derivatives(points);
    claims.equal_vec("start", points[0], exact(ends[0]));
    claims.equal_vec("end", points[4], exact(ends[1]));
    claims.equal_vec("tangent at the start", slopes[0], exact(tangents[0]));
    claims.equal_vec("tangent at the end", slopes[4], exact(tangents[1]));
}

/// Half the difference of the neighbours, times `scale`, at `q1` and `q2`.
fn central([q0, q1, q2, q3]: [[f64; 4]; 4], scale: f64) -> [[f64; 4]; 2] {
    let half = |a: [f64; 4], b: [f64; 4]| std::array::from_fn(|k| (b[k] - a[k]) / 2.0 * scale);
    [half(q0, q2), half(q1, q3)]
}

fn catmull_rom(inputs: &[Sample], o: &[Observed], claims: &mut Claims<'_>) {
    if let Some(q) = nodes(&inputs[0]) {
        ends_and_tangents(o, [q[1], q[2]], central(q, 1.0), claims);
    }
}

fn polyline(inputs: &[Sample], o: &[Observed], claims: &mut Claims<'_>) {
    if let Some(q) = nodes(&inputs[0]) {
        ends_and_tangents(o, [q[1], q[2]], [[0.0; 4]; 2], claims);
        // On the segment at 3s² - 2s³: 5/32 at 1/4, half at 1/2.
        for (k, part) in [(1, 5.0 / 32.0), (2, 0.5), (3, 27.0 / 32.0)] {
            let on_it: [f64; 4] = std::array::from_fn(|i| q[1][i] + part * (q[2][i] - q[1][i]));
            claims.equal_vec("point of the straight line", outputs(&o[k], 0), exact(on_it));
        }
    }
}

pub(super) static SPLINE_ENDS: Rule = Rule {
    name: "spline_ends",
    statement: "the curve goes through q1 at s = 0 and q2 at s = 1",
    needs: NEEDS,
    inputs: |sample| Some(vec![at(sample, 0.0)?, at(sample, 1.0)?]),
    claims: |inputs, o, claims| {
        if let Some([_, q1, q2, _]) = nodes(&inputs[0]) {
            claims.equal_vec("start", outputs(&o[0], 0), exact(q1));
            claims.equal_vec("end", outputs(&o[1], 0), exact(q2));
        }
    },
};

pub(super) static SPLINE_REVERSED: Rule = Rule {
    name: "spline_reversed",
    statement: "the nodes in reverse order and s reversed (and the bias, if any) give the same point",
    needs: NEEDS,
    inputs: |sample| {
        let s = on_grid(number(sample, "s")?);
        let first = at(sample, s)?;
        let second = with(&at(sample, 1.0 - s)?, |copy| {
            let [q0, q1, q2, q3] = nodes(copy)?;
            put_nodes(copy, [q3, q2, q1, q0])?;
            match number(copy, "bias") {
                Some(bias) => put(copy, "bias", &[-bias]),
                None => Some(()),
            }
        })?;
        Some(vec![first, second])
    },
    claims: |_, o, claims| claims.equal_vec::<4>("return", outputs(&o[0], 0), outputs(&o[1], 0)),
};

pub(super) static SPLINE_AFFINE: Rule = Rule {
    name: "spline_affine",
    statement: "an affine map of the nodes maps the point",
    needs: NEEDS,
    inputs: |sample| mapped(sample, &NODES),
    claims: affine,
};

/// The sample with these points on the grid, and with an affine map of them.
fn mapped(sample: &Sample, names: &[&str]) -> Option<Vec<Sample>> {
    let first = with(sample, |copy| {
        names.iter().try_for_each(|name| {
            let p = grid_point(copy, name)?;
            put_point(copy, name, p)
        })
    })?;
    let map = Exact::affine(hash(&first));
    let second = with(&first, |copy| {
        names.iter().try_for_each(|name| {
            let p = point(copy, name)?;
            put_point(copy, name, map.apply(p))
        })
    })?;
    Some(vec![first, second])
}

fn affine(inputs: &[Sample], o: &[Observed], claims: &mut Claims<'_>) {
    let map = Exact::affine(hash(&inputs[0]));
    claims.equal_vec("return", outputs(&o[1], 0), map.apply_ball(outputs(&o[0], 0)));
}

/// Claims that a position lies on the line through `from` along `way`, with w as at `from`.
pub(super) fn on_line(p: [Ball; 4], from: [f64; 4], way: [f64; 4], claims: &mut Claims<'_>) {
    let off = cross(xyz(minus(p, exact(from))), xyz(exact(way)));
    claims.equal_vec("off the line", off, exact([0.0; 3]));
    claims.equal("w", p[3], Ball::from(from[3]));
}

/// Four nodes on the line through the first node towards the second, some of them coinciding.
pub(super) fn collinear(a: [f64; 4], b: [f64; 4], choice: u64) -> [[f64; 4]; 4] {
    std::array::from_fn(|k| {
        let step = ((choice >> (4 * k)) % 5) as f64 - 2.0;
        std::array::from_fn(|i| a[i] + step * (b[i] - a[i]))
    })
}

pub(super) static SPLINE_COLLINEAR: Rule = Rule {
    name: "spline_collinear",
    statement: "nodes on a line keep the curve on it",
    needs: NEEDS,
    inputs: |sample| {
        let (a, b) = (grid_point(sample, "q0")?, grid_point(sample, "q1")?);
        let line = collinear(a, b, hash(sample));
        Some(vec![with(sample, |copy| put_nodes(copy, line))?])
    },
    claims: |inputs, o, claims| {
        let Some(q) = nodes(&inputs[0]) else { return };
        // The node farthest from q1 gives the direction; all coincide when there is none.
        let way = |node: [f64; 4]| -> [f64; 4] { std::array::from_fn(|k| node[k] - q[1][k]) };
        let size = |v: [f64; 4]| v.iter().map(|x| x * x).sum::<f64>();
        let along = q.map(way).into_iter().fold([0.0; 4], |a, b| if size(b) > size(a) { b } else { a });
        if along == [0.0; 4] {
            claims.equal_vec("return", outputs(&o[0], 0), exact(q[1]));
        } else {
            on_line(outputs(&o[0], 0), q[1], along, claims);
        }
    },
};

pub(super) static SPLINE_C1: Rule = Rule {
    name: "spline_c1",
    statement: "neighbouring pieces have the same tangent where they meet (with continuity 0, if any)",
    needs: NEEDS,
    inputs: |sample| {
        let smooth = with(sample, |copy| match copy.words("continuity") {
            Some(_) => put(copy, "continuity", &[0.0]),
            None => Some(()),
        })?;
        let [q0, q1, q2, q3] = nodes(&smooth)?;
        // Any point does as the fifth node.
        let q4 = [q0[1], q0[2], q0[0], q0[3]];
        let next = with(&smooth, |copy| put_nodes(copy, [q1, q2, q3, q4]))?;
        let mut samples = quarters(&smooth)?;
        samples.extend(quarters(&next)?);
        Some(samples)
    },
    claims: |_, o, claims| {
        let (piece, next) = (derivatives(five(o)), derivatives(five(&o[5..])));
        claims.equal_vec("tangent", piece[4], next[0]);
    },
};

pub(super) static CATMULL_ROM_TANGENTS: Rule = Rule {
    name: "catmull_rom_tangents",
    statement: "the tangent at a node is half the difference of its neighbours",
    needs: NEEDS,
    inputs: quarters,
    claims: catmull_rom,
};

pub(super) static CATMULL_ROM_DERIVATIVE: Rule = Rule {
    name: "catmull_rom_derivative",
    statement: "the derivative is that of the position",
    needs: NEEDS,
    inputs: quarters,
    claims: |_, o, claims| {
        for (slope, o) in derivatives(five(o)).into_iter().zip(o) {
            claims.equal_vec("derivative", outputs(o, 4), slope);
        }
    },
};

pub(super) static CARDINAL_IS_CATMULL_ROM: Rule = Rule {
    name: "cardinal_is_catmull_rom",
    statement: "w = 0 gives the curve with Catmull-Rom's ends and tangents",
    needs: NEEDS,
    inputs: |sample| quarters(&with(sample, |copy| put(copy, "w", &[0.0]))?),
    claims: catmull_rom,
};

pub(super) static CARDINAL_POLYLINE: Rule = Rule {
    name: "cardinal_polyline",
    statement: "w = 1 has zero tangents and runs along the straight line",
    needs: NEEDS,
    inputs: |sample| quarters(&with(sample, |copy| put(copy, "w", &[1.0]))?),
    claims: polyline,
};

pub(super) static CARDINAL_TANGENTS: Rule = Rule {
    name: "cardinal_tangents",
    statement: "the tangents are those of Catmull-Rom scaled by 1 - w",
    needs: NEEDS,
    inputs: |sample| {
        number(sample, "w")?;
        quarters(sample)
    },
    claims: |inputs, o, claims| {
        if let (Some(q), Some(w)) = (nodes(&inputs[0]), number(&inputs[0], "w")) {
            ends_and_tangents(o, [q[1], q[2]], central(q, 1.0 - w), claims);
        }
    },
};

fn shaped(sample: &Sample, tension: Option<f64>, bias: Option<f64>, continuity: Option<f64>) -> Option<Sample> {
    with(sample, |copy| {
        for (name, value) in [("tension", tension), ("bias", bias), ("continuity", continuity)] {
            let value = value.or_else(|| number(copy, name))?;
            put(copy, name, &[value])?;
        }
        Some(())
    })
}

pub(super) static KOCHANEK_BARTELS_IS_CATMULL_ROM: Rule = Rule {
    name: "kochanek_bartels_is_catmull_rom",
    statement: "tension, bias and continuity 0 give the curve with Catmull-Rom's ends and tangents",
    needs: NEEDS,
    inputs: |sample| quarters(&shaped(sample, Some(0.0), Some(0.0), Some(0.0))?),
    claims: catmull_rom,
};

pub(super) static KOCHANEK_BARTELS_POLYLINE: Rule = Rule {
    name: "kochanek_bartels_polyline",
    statement: "tension 1 has zero tangents and runs along the straight line",
    needs: NEEDS,
    inputs: |sample| quarters(&shaped(sample, Some(1.0), None, None)?),
    claims: polyline,
};

pub(super) static KOCHANEK_BARTELS_BIAS: Rule = Rule {
    name: "kochanek_bartels_bias",
    statement: "bias 1 leaves the difference before a node as its tangent, bias -1 the one after it",
    needs: NEEDS,
    inputs: |sample| {
        let mut samples = quarters(&shaped(sample, Some(0.0), Some(1.0), Some(0.0))?)?;
        samples.extend(quarters(&shaped(sample, Some(0.0), Some(-1.0), Some(0.0))?)?);
        Some(samples)
    },
    claims: |inputs, o, claims| {
        let Some([q0, q1, q2, q3]) = nodes(&inputs[0]) else { return };
        let way = |a: [f64; 4], b: [f64; 4]| -> [f64; 4] { std::array::from_fn(|k| b[k] - a[k]) };
        ends_and_tangents(o, [q1, q2], [way(q0, q1), way(q1, q2)], claims);
        ends_and_tangents(&o[5..], [q1, q2], [way(q1, q2), way(q2, q3)], claims);
    },
};

pub(super) static KOCHANEK_BARTELS_CORNER: Rule = Rule {
    name: "kochanek_bartels_corner",
    statement: "continuity -1 gives each end the straight line's tangent",
    needs: NEEDS,
    inputs: |sample| quarters(&shaped(sample, Some(0.0), Some(0.0), Some(-1.0))?),
    claims: |inputs, o, claims| {
        if let Some([_, q1, q2, _]) = nodes(&inputs[0]) {
            let way = std::array::from_fn(|k| q2[k] - q1[k]);
            ends_and_tangents(o, [q1, q2], [way, way], claims);
        }
    },
};

const HERMITE: &[(&str, Words)] = &[
    ("p0", Words::Point),
    ("p1", Words::Point),
    ("m0", Words::Exactly(4)),
    ("m1", Words::Exactly(4)),
    ("s", Words::Exactly(1)),
];

pub(super) static HERMITE_TANGENTS: Rule = Rule {
    name: "hermite_tangents",
    statement: "the curve goes from p0 with the tangent m0 to p1 with the tangent m1",
    needs: HERMITE,
    inputs: quarters,
    claims: |inputs, o, claims| {
        if let [Some(p0), Some(p1), Some(m0), Some(m1)] = ["p0", "p1", "m0", "m1"].map(|name| point(&inputs[0], name)) {
            ends_and_tangents(o, [p0, p1], [m0, m1], claims);
        }
    },
};

pub(super) static HERMITE_REVERSED: Rule = Rule {
    name: "hermite_reversed",
    statement: "the ends exchanged, the tangents exchanged and turned round, and s reversed give the same point",
    needs: HERMITE,
    inputs: |sample| {
        let s = on_grid(number(sample, "s")?);
        let first = at(sample, s)?;
        let second = with(&at(sample, 1.0 - s)?, |copy| {
            let (p0, p1, m0, m1) = (point(copy, "p0")?, point(copy, "p1")?, point(copy, "m0")?, point(copy, "m1")?);
            put_point(copy, "p0", p1)?;
            put_point(copy, "p1", p0)?;
            put_point(copy, "m0", m1.map(|x| -x))?;
            put_point(copy, "m1", m0.map(|x| -x))
        })?;
        Some(vec![first, second])
    },
    claims: |_, o, claims| claims.equal_vec::<4>("return", outputs(&o[0], 0), outputs(&o[1], 0)),
};

pub(super) static HERMITE_AFFINE: Rule = Rule {
    name: "hermite_affine",
    statement: "an affine map of the ends, with its linear part for the tangents, maps the point",
    needs: HERMITE,
    inputs: |sample| mapped(sample, &["p0", "p1", "m0", "m1"]),
    claims: affine,
};

pub(super) static HERMITE_COLLINEAR: Rule = Rule {
    name: "hermite_collinear",
    statement: "tangents along the line between the ends keep the curve on it",
    needs: HERMITE,
    inputs: |sample| {
        let (p0, p1, choice) = (grid_point(sample, "p0")?, grid_point(sample, "p1")?, hash(sample));
        let along = |shift: u32| {
            let step = ((choice >> shift) % 7) as f64 - 3.0;
            std::array::from_fn(|k| step * (p1[k] - p0[k]))
        };
        let straight = with(sample, |copy| {
            put_point(copy, "p0", p0)?;
            put_point(copy, "p1", p1)?;
            put_point(copy, "m0", along(0))?;
            put_point(copy, "m1", along(4))
        })?;
        Some(vec![straight])
    },
    claims: |inputs, o, claims| {
        if let (Some(p0), Some(p1)) = (point(&inputs[0], "p0"), point(&inputs[0], "p1")) {
            on_line(outputs(&o[0], 0), p0, std::array::from_fn(|k| p1[k] - p0[k]), claims);
        }
    },
};
