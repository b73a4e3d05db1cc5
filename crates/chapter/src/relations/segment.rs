//! Relations of the distance to a segment (78), (79).

use property::Sample;
use property::ball::{Ball, exact, length, minus, output};
use property::rule::{Exact, Rule, Words, grid_point, hash, point, put_point, with};

const NEEDS: &[(&str, Words)] = &[("p", Words::Point), ("p0", Words::Point), ("p1", Words::Point)];

/// The sample with these three points.
fn placed(sample: &Sample, p: [f64; 4], p0: [f64; 4], p1: [f64; 4]) -> Option<Sample> {
    with(sample, |s| {
        put_point(s, "p", p)?;
        put_point(s, "p0", p0)?;
        put_point(s, "p1", p1)
    })
}

/// The three points on the grid; `None` unless all have w = 1.
fn points(sample: &Sample) -> Option<[[f64; 4]; 3]> {
    let points = [grid_point(sample, "p")?, grid_point(sample, "p0")?, grid_point(sample, "p1")?];
    points.iter().all(|p| p[3] == 1.0).then_some(points)
}

/// Distance between two points.
fn between(a: [f64; 4], b: [f64; 4]) -> Ball {
    length(minus(exact(a), exact(b)))
}

/// `a + scale (c - b)`, exact on the grid for a scale that is a small integer or half of one.
fn step(a: [f64; 4], scale: f64, b: [f64; 4], c: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|k| a[k] + scale * (c[k] - b[k]))
}

/// A step at a right angle to the segment and as long as it is wide in some plane; zero when the
/// segment is a point or lies along the axis left out.
fn aside(p0: [f64; 4], p1: [f64; 4], choice: u64) -> [f64; 4] {
    let (i, j) = [(0, 1), (1, 2), (2, 0)][(choice % 3) as usize];
    let mut side = [0.0; 4];
    (side[i], side[j]) = (p0[j] - p1[j], p1[i] - p0[i]);
    side
}

pub(super) static SEGMENT_NOT_NEGATIVE: Rule = Rule {
    name: "segment_not_negative",
    statement: "a distance is not negative",
    needs: NEEDS,
    inputs: |sample| Some(vec![sample.clone()]),
    claims: |_, o, claims| claims.holds("d ≥ 0", output(&o[0], 0).mid >= 0.0),
};

pub(super) static SEGMENT_ZERO_ON_IT: Rule = Rule {
    name: "segment_zero_on_it",
    statement: "the ends and the middle of the segment are at the distance 0",
    needs: NEEDS,
    inputs: |sample| {
        let [_, p0, p1] = points(sample)?;
        [p0, p1, step(p0, 0.5, p0, p1)].into_iter().map(|p| placed(sample, p, p0, p1)).collect()
    },
    claims: |_, o, claims| {
        for o in o {
            claims.equal("d on the segment", output(o, 0), Ball::from(0.0));
        }
    },
};

pub(super) static SEGMENT_CASES: Rule = Rule {
    name: "segment_cases",
    statement: "beyond an end the distance is that to the end; beside the segment it is the way aside",
    needs: NEEDS,
    inputs: |sample| {
        let [_, p0, p1] = points(sample)?;
        let first = placed(sample, step(p0, -1.0, p0, p1), p0, p1)?;
        let side = aside(p0, p1, hash(&first));
        let beside = |from: [f64; 4]| placed(sample, std::array::from_fn(|k| from[k] + side[k]), p0, p1);
        Some(vec![first, placed(sample, step(p1, 2.0, p0, p1), p0, p1)?, beside(p0)?, beside(step(p0, 0.5, p0, p1))?])
    },
    claims: |inputs, o, claims| {
        let Some([_, p0, p1]) = points(&inputs[0]) else { return };
        claims.equal("d before the start", output(&o[0], 0), between(p0, p1));
        claims.equal("d past the end", output(&o[1], 0), between(p0, p1) * 2.0);
        let side = length(exact(aside(p0, p1, hash(&inputs[0]))));
        claims.equal("d beside the start", output(&o[2], 0), side);
        claims.equal("d beside the middle", output(&o[3], 0), side);
    },
};

pub(super) static SEGMENT_SWAPPED: Rule = Rule {
    name: "segment_swapped",
    statement: "the ends exchanged give the same distance",
    needs: NEEDS,
    inputs: |sample| {
        let (p, p0, p1) = (point(sample, "p")?, point(sample, "p0")?, point(sample, "p1")?);
        Some(vec![sample.clone(), placed(sample, p, p1, p0)?])
    },
    claims: |_, o, claims| claims.equal("d", output(&o[0], 0), output(&o[1], 0)),
};

pub(super) static SEGMENT_NO_FARTHER: Rule = Rule {
    name: "segment_no_farther",
    statement: "no point of the segment is nearer than the distance",
    needs: NEEDS,
    inputs: |sample| {
        let [p, p0, p1] = points(sample)?;
        Some(vec![placed(sample, p, p0, p1)?])
    },
    claims: |inputs, o, claims| {
        let Some([p, p0, p1]) = points(&inputs[0]) else { return };
        for part in 0..=8 {
            let on_it = step(p0, f64::from(part) / 8.0, p0, p1);
            claims.at_most("d and the way to a point of the segment", output(&o[0], 0), between(p, on_it));
        }
    },
};

pub(super) static SEGMENT_SPLIT: Rule = Rule {
    name: "segment_split",
    statement: "the distance is the lesser of those to the two halves",
    needs: NEEDS,
    inputs: |sample| {
        let [p, p0, p1] = points(sample)?;
        let middle = step(p0, 0.5, p0, p1);
        Some(vec![placed(sample, p, p0, p1)?, placed(sample, p, p0, middle)?, placed(sample, p, middle, p1)?])
    },
    claims: |_, o, claims| {
        claims.equal("d", output(&o[0], 0), output(&o[1], 0).min(output(&o[2], 0)));
    },
};

pub(super) static SEGMENT_LIPSCHITZ: Rule = Rule {
    name: "segment_lipschitz",
    statement: "the distance changes by no more than the point moves",
    needs: NEEDS,
    inputs: |sample| {
        let [p, p0, p1] = points(sample)?;
        let first = placed(sample, p, p0, p1)?;
        let choice = hash(&first);
        let [x, y, z] = std::array::from_fn(|k| p[k] + ((choice >> (8 * k)) % 256) as f64 / 128.0 - 1.0);
        Some(vec![first, placed(sample, [x, y, z, 1.0], p0, p1)?])
    },
    claims: |inputs, o, claims| {
        let (Some(p), Some(q)) = (point(&inputs[0], "p"), point(&inputs[1], "p")) else { return };
        let [d, e] = [output(&o[0], 0), output(&o[1], 0)];
        claims.at_most("rise of d", e, d + between(p, q));
        claims.at_most("fall of d", d, e + between(p, q));
    },
};

pub(super) static SEGMENT_DEGENERATE: Rule = Rule {
    name: "segment_degenerate",
    statement: "a segment whose ends coincide is a point",
    needs: NEEDS,
    inputs: |sample| {
        let (p, p0) = (point(sample, "p")?, point(sample, "p0")?);
        Some(vec![placed(sample, p, p0, p0)?])
    },
    claims: |inputs, o, claims| {
        if let (Some(p), Some(p0)) = (point(&inputs[0], "p"), point(&inputs[0], "p0")) {
            claims.equal("d", output(&o[0], 0), between(p, p0));
        }
    },
};

pub(super) static SEGMENT_RIGID: Rule = Rule {
    name: "segment_rigid",
    statement: "a rigid motion of all three points keeps the distance",
    needs: NEEDS,
    inputs: |sample| {
        let [p, p0, p1] = points(sample)?;
        let first = placed(sample, p, p0, p1)?;
        let motion = Exact::rigid(hash(&first));
        let second = placed(sample, motion.apply(p), motion.apply(p0), motion.apply(p1))?;
        Some(vec![first, second])
    },
    claims: |_, o, claims| claims.equal("d", output(&o[0], 0), output(&o[1], 0)),
};
