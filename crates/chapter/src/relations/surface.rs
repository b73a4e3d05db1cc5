//! Relations of the sphere and the cylinder.

use property::Sample;
use property::ball::{Ball, exact, length, minus, output, outputs, plus, xyz};
use property::rule::{Rule, Words, number, on_grid, plain, put, with};

const NEEDS: &[(&str, Words)] = &[("parameter", Words::Exactly(2)), ("mc", Words::Exactly(16))];

/// The sample under the identity at the grid point (s, t).
fn at(sample: &Sample, s: f64, t: f64) -> Option<Sample> {
    with(&plain(sample)?, |p| put(p, "parameter", &[s, t]))
}

/// The grid point of a sample; `None` outside the unit square.
fn parameter(sample: &Sample) -> Option<[f64; 2]> {
    let [s, t] = sample.get("parameter")[..] else { return None };
    [s, t].iter().all(|x| (0.0..=1.0).contains(x)).then_some([s, t])
}

pub(super) static SURFACE_SEAM: Rule = Rule {
    name: "surface_seam",
    statement: "s = 0 and s = 1 give the same point",
    needs: NEEDS,
    inputs: |sample| {
        let [_, t] = parameter(sample)?;
        Some(vec![at(sample, 0.0, t)?, at(sample, 1.0, t)?])
    },
    claims: |_, o, claims| claims.equal_vec::<4>("gl_Position", outputs(&o[0], 0), outputs(&o[1], 0)),
};

pub(super) static SPHERE_RADIUS: Rule = Rule {
    name: "sphere_radius",
    statement: "every point is 1 away from the centre, with w = 1",
    needs: NEEDS,
    inputs: |sample| Some(vec![plain(sample)?]),
    claims: |_, o, claims| {
        let p = outputs(&o[0], 0);
        claims.equal("|p|", length(xyz(p)), Ball::from(1.0));
        claims.equal("gl_Position.w", p[3], Ball::from(1.0));
    },
};

pub(super) static SPHERE_POLES: Rule = Rule {
    name: "sphere_poles",
    statement: "t = 0 is the pole (0, 1, 0) and t = 1 the pole (0, -1, 0), whatever s",
    needs: NEEDS,
    inputs: |sample| {
        let [s, _] = parameter(sample)?;
        Some(vec![at(sample, s, 0.0)?, at(sample, s, 1.0)?])
    },
    claims: |_, o, claims| {
        claims.equal_vec("north", outputs(&o[0], 0), exact([0.0, 1.0, 0.0, 1.0]));
        claims.equal_vec("south", outputs(&o[1], 0), exact([0.0, -1.0, 0.0, 1.0]));
    },
};

pub(super) static SPHERE_ANTIPODE: Rule = Rule {
    name: "sphere_antipode",
    statement: "half a turn on and as far from the other pole lies the opposite point",
    needs: NEEDS,
    inputs: |sample| {
        let [s, t] = parameter(sample)?.map(on_grid);
        let across = if s < 0.5 { s + 0.5 } else { s - 0.5 };
        Some(vec![at(sample, s, t)?, at(sample, across, 1.0 - t)?])
    },
    claims: |_, o, claims| {
        let [p, q] = [outputs(&o[0], 0), outputs(&o[1], 0)];
        claims.equal_vec("sum of opposite points", plus(xyz(p), xyz(q), 1.0), exact([0.0; 3]));
        claims.equal("gl_Position.w", p[3], q[3]);
    },
};

pub(super) static CYLINDER_RADIUS: Rule = Rule {
    name: "cylinder_radius",
    statement: "every point is 1 away from the y axis, with w = 1",
    needs: NEEDS,
    inputs: |sample| Some(vec![plain(sample)?]),
    claims: |_, o, claims| {
        let [x, _, z, w] = outputs(&o[0], 0);
        claims.equal("√(x² + z²)", length([x, z]), Ball::from(1.0));
        claims.equal("gl_Position.w", w, Ball::from(1.0));
    },
};

pub(super) static CYLINDER_HEIGHT: Rule = Rule {
    name: "cylinder_height",
    statement: "y stays between -1 and 1, starts at -1 and is odd about t = 1/2",
    needs: NEEDS,
    inputs: |sample| {
        let [s, t] = parameter(sample)?.map(on_grid);
        Some(vec![at(sample, s, t)?, at(sample, s, 1.0 - t)?, at(sample, s, 0.0)?])
    },
    claims: |_, o, claims| {
        let [y, mirrored, bottom] = [&o[0], &o[1], &o[2]].map(|o| output(o, 1));
        claims.at_most("-1 ≤ y", Ball::from(-1.0), y);
        claims.at_most("y ≤ 1", y, Ball::from(1.0));
        claims.equal("y(t) and -y(1-t)", y, -mirrored);
        claims.equal("y(0)", bottom, Ball::from(-1.0));
    },
};

pub(super) static CYLINDER_STRAIGHT: Rule = Rule {
    name: "cylinder_straight",
    statement: "points with the same s lie above each other",
    needs: NEEDS,
    inputs: |sample| {
        let s = number(sample, "parameter")?;
        Some(vec![plain(sample)?, at(sample, s, 0.0)?])
    },
    claims: |_, o, claims| {
        let [x, _, z, _] = minus(outputs(&o[0], 0), outputs(&o[1], 0));
        claims.equal_vec("difference of x and z", [x, z], exact([0.0; 2]));
    },
};
