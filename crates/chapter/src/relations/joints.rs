//! Relations of rigid parts at joints.

use property::ball::{exact, outputs, plus};
use property::rule::{
    Claims, Exact, IDENTITY, Rule, Words, grid_point, hash, number, plain, point, put, put_point, with,
};
use property::{Observed, Sample};

const NEEDS: &[(&str, Words)] = &[
    ("position", Words::Point),
    ("part", Words::Exactly(1)),
    ("partMatrix", Words::Each(16)),
    ("mc", Words::Exactly(16)),
];

/// The sample under the identity, with every part's matrix replaced.
fn placed(sample: &Sample, matrix: impl Fn(usize, [f64; 16]) -> [f64; 16]) -> Option<Sample> {
    with(&plain(sample)?, |s| {
        let mut words = s.get("partMatrix");
        for (part, words) in words.chunks_exact_mut(16).enumerate() {
            let old = std::array::from_fn(|k| words[k]);
            words.copy_from_slice(&matrix(part, old));
        }
        put(s, "partMatrix", &words)
    })
}

fn same(_: &[Sample], o: &[Observed], claims: &mut Claims<'_>) {
    claims.equal_vec::<4>("gl_Position", outputs(&o[0], 0), outputs(&o[1], 0));
}

pub(super) static JOINTS_REST: Rule = Rule {
    name: "joints_rest",
    statement: "parts that have not moved leave the vertex where it is",
    needs: NEEDS,
    inputs: |sample| Some(vec![placed(sample, |_, _| IDENTITY)?]),
    claims: |inputs, o, claims| {
        if let Some(position) = point(&inputs[0], "position") {
            claims.equal_vec("gl_Position", outputs(&o[0], 0), exact(position));
        }
    },
};

pub(super) static JOINTS_OWN_PART: Rule = Rule {
    name: "joints_own_part",
    statement: "the other parts' motion does not move the vertex",
    needs: NEEDS,
    inputs: |sample| {
        let own = number(sample, "part")?;
        let others = |part: usize, matrix| if part as f64 == own { matrix } else { IDENTITY };
        Some(vec![plain(sample)?, placed(sample, others)?])
    },
    claims: same,
};

pub(super) static JOINTS_COMMON_MOTION: Rule = Rule {
    name: "joints_common_motion",
    statement: "a rotation of all parts rotates the vertex",
    needs: NEEDS,
    inputs: |sample| {
        let first = plain(sample)?;
        let map = Exact::turn(hash(&first));
        let second = placed(&first, |_, matrix| map.after(matrix))?;
        Some(vec![first, second])
    },
    claims: |inputs, o, claims| {
        let map = Exact::turn(hash(&inputs[0]));
        claims.equal_vec("gl_Position", outputs(&o[1], 0), map.apply_ball(outputs(&o[0], 0)));
    },
};

pub(super) static JOINTS_FOLLOW: Rule = Rule {
    name: "joints_follow",
    statement: "a vertex follows the rigid motion of its part",
    needs: NEEDS,
    inputs: |sample| {
        let map = |s: &Sample| {
            let p = grid_point(s, "position")?;
            with(s, |s| put_point(s, "position", p))
        };
        let rest = map(&placed(sample, |_, _| IDENTITY)?)?;
        let motion = Exact::rigid(hash(&rest));
        let moved = placed(&rest, |_, _| motion.matrix())?;
        Some(vec![rest, moved])
    },
    claims: |inputs, o, claims| {
        let motion = Exact::rigid(hash(&inputs[0]));
        if let Some(position) = point(&inputs[0], "position") {
            claims.equal_vec("gl_Position", outputs(&o[1], 0), exact(motion.apply(position)));
        }
    },
};

pub(super) static JOINTS_COLLAPSE: Rule = Rule {
    name: "joints_collapse",
    statement: "between two parts half a turn about y apart the connecting part collapses to the axis",
    needs: NEEDS,
    inputs: |sample| {
        let apart = placed(sample, |part, _| {
            let mut matrix = IDENTITY;
            if part == 1 {
                (matrix[0], matrix[10]) = (-1.0, -1.0);
            }
            matrix
        })?;
        // The connecting part's edge runs from a vertex of part 0 to that of part 1.
        (sample.words("partMatrix")?.len() >= 32).then_some(())?;
        Some(vec![with(&apart, |s| put(s, "part", &[0.0]))?, with(&apart, |s| put(s, "part", &[1.0]))?])
    },
    claims: |inputs, o, claims| {
        let Some(position) = point(&inputs[0], "position") else { return };
        let middle = plus(outputs(&o[0], 0), outputs(&o[1], 0), 1.0).map(|x| x * 0.5);
        claims.equal_vec("middle of the edge", middle, exact([0.0, position[1], 0.0, position[3]]));
    },
};
