//! Relations of morphing: two shapes (72) and targets (73), (74).

use property::Sample;
use property::ball::{Ball, exact, minus, outputs, plus};
use property::rule::{Exact, Rule, Words, grid_point, hash, number, on_grid, plain, point, put, put_point, with};

const MORPH: &[(&str, Words)] =
    &[("p0", Words::Point), ("p1", Words::Point), ("t", Words::Exactly(1)), ("mc", Words::Exactly(16))];

fn at(sample: &Sample, t: f64) -> Option<Sample> {
    with(&plain(sample)?, |s| put(s, "t", &[t]))
}

pub(super) static MORPH_ENDS: Rule = Rule {
    name: "morph_ends",
    statement: "t = 0 gives p0 and t = 1 gives p1",
    needs: MORPH,
    inputs: |sample| Some(vec![at(sample, 0.0)?, at(sample, 1.0)?]),
    claims: |inputs, o, claims| {
        for (k, name) in ["p0", "p1"].into_iter().enumerate() {
            if let Some(end) = point(&inputs[k], name) {
                claims.equal_vec(name, outputs(&o[k], 0), exact(end));
            }
        }
    },
};

pub(super) static MORPH_ON_SEGMENT: Rule = Rule {
    name: "morph_on_segment",
    statement: "for t in [0, 1] the point lies on the segment from p0 to p1",
    needs: MORPH,
    inputs: |sample| {
        (0.0..=1.0).contains(&number(sample, "t")?).then_some(())?;
        Some(vec![plain(sample)?])
    },
    claims: |inputs, o, claims| {
        let (Some(p0), Some(p1)) = (point(&inputs[0], "p0"), point(&inputs[0], "p1")) else { return };
        let p: [Ball; 4] = outputs(&o[0], 0);
        let (way, along) = (minus(exact(p1), exact(p0)), minus(p, exact(p0)));
        for (k, value) in p.into_iter().enumerate() {
            claims.at_most("beyond the lower end", Ball::from(p0[k].min(p1[k])), value);
            claims.at_most("beyond the upper end", value, Ball::from(p0[k].max(p1[k])));
            let next = (k + 1) % 4;
            claims.equal("off the line", along[k] * way[next], along[next] * way[k]);
        }
    },
};

pub(super) static MORPH_SWAPPED: Rule = Rule {
    name: "morph_swapped",
    statement: "the ends swapped and t reversed give the same point",
    needs: MORPH,
    inputs: |sample| {
        // On the grid 1 - t is exact.
        let t = on_grid(number(sample, "t")?);
        let first = at(sample, t)?;
        let second = with(&first, |s| {
            let (p0, p1) = (point(s, "p0")?, point(s, "p1")?);
            put_point(s, "p0", p1)?;
            put_point(s, "p1", p0)?;
            put(s, "t", &[1.0 - t])
        })?;
        Some(vec![first, second])
    },
    claims: |_, o, claims| claims.equal_vec::<4>("gl_Position", outputs(&o[0], 0), outputs(&o[1], 0)),
};

pub(super) static MORPH_AFFINE: Rule = Rule {
    name: "morph_affine",
    statement: "an affine map of p0 and p1 maps the point",
    needs: MORPH,
    inputs: |sample| {
        let first = with(&plain(sample)?, |s| {
            for name in ["p0", "p1"] {
                let p = grid_point(s, name)?;
                put_point(s, name, p)?;
            }
            Some(())
        })?;
        let map = Exact::affine(hash(&first));
        let second = with(&first, |s| {
            for name in ["p0", "p1"] {
                let p = point(s, name)?;
                put_point(s, name, map.apply(p))?;
            }
            Some(())
        })?;
        Some(vec![first, second])
    },
    claims: |inputs, o, claims| {
        let map = Exact::affine(hash(&inputs[0]));
        claims.equal_vec("gl_Position", outputs(&o[1], 0), map.apply_ball(outputs(&o[0], 0)));
    },
};

const TARGETS: &[(&str, Words)] = &[
    ("pn", Words::Point),
    ("p1", Words::Point),
    ("p2", Words::Point),
    ("p3", Words::Point),
    ("p4", Words::Point),
    ("w", Words::Exactly(4)),
    ("mc", Words::Exactly(16)),
];

const NAMES: [&str; 4] = ["p1", "p2", "p3", "p4"];

fn weighted(sample: &Sample, weights: &[f64]) -> Option<Sample> {
    with(&plain(sample)?, |s| put(s, "w", weights))
}

pub(super) static TARGETS_BASE: Rule = Rule {
    name: "targets_base",
    statement: "without weights the base stays",
    needs: TARGETS,
    inputs: |sample| Some(vec![weighted(sample, &[0.0; 4])?]),
    claims: |inputs, o, claims| {
        if let Some(base) = point(&inputs[0], "pn") {
            claims.equal_vec("gl_Position", outputs(&o[0], 0), exact(base));
        }
    },
};

pub(super) static TARGETS_SINGLE: Rule = Rule {
    name: "targets_single",
    statement: "a single weight of 1 gives that target",
    needs: TARGETS,
    inputs: |sample| {
        (0..4).map(|k| weighted(sample, &std::array::from_fn::<f64, 4, _>(|i| f64::from(u8::from(i == k))))).collect()
    },
    claims: |inputs, o, claims| {
        for (k, name) in NAMES.into_iter().enumerate() {
            if let Some(target) = point(&inputs[k], name) {
                claims.equal_vec(name, outputs(&o[k], 0), exact(target));
            }
        }
    },
};

pub(super) static TARGETS_PERMUTED: Rule = Rule {
    name: "targets_permuted",
    statement: "the order of the targets does not matter",
    needs: TARGETS,
    inputs: |sample| {
        let turned = with(&plain(sample)?, |s| {
            let points: Option<Vec<_>> = NAMES.iter().map(|name| point(s, name)).collect();
            for (name, p) in NAMES.into_iter().zip(points?.into_iter().cycle().skip(1)) {
                put_point(s, name, p)?;
            }
            let mut weights = s.get("w");
            weights.rotate_left(1);
            put(s, "w", &weights)
        })?;
        Some(vec![plain(sample)?, turned])
    },
    claims: |_, o, claims| claims.equal_vec::<4>("gl_Position", outputs(&o[0], 0), outputs(&o[1], 0)),
};

pub(super) static TARGETS_LINEAR: Rule = Rule {
    name: "targets_linear",
    statement: "twice the weights move the base twice as far, whatever their sum",
    needs: TARGETS,
    inputs: |sample| {
        let doubled: Vec<f64> = sample.get("w").iter().map(|w| 2.0 * w).collect();
        Some(vec![plain(sample)?, weighted(sample, &doubled)?])
    },
    claims: |inputs, o, claims| {
        let Some(base) = point(&inputs[0], "pn").map(exact) else { return };
        let [once, twice] = [&o[0], &o[1]].map(|o| minus(outputs(o, 0), base));
        claims.equal_vec("displacement", twice, plus(once, once, 1.0));
    },
};
