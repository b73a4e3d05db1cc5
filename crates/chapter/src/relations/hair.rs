//! Relations of the strip that the geometry stage of the hair emits: five vertices of a curve between
//! the second and the third node, each with position, `v`, `l`, `t`.

use super::spline::{collinear, derivatives, on_line};
use property::ball::{Ball, cross, direction, dot, exact, length, minus, outputs, xyz};
use property::rule::{Claims, Exact, Rule, Words, hash, on_grid, plain, put, with};
use property::{Observed, Sample};

const NEEDS: &[(&str, Words)] = &[("gl_Position", Words::Exactly(16)), ("mc", Words::Exactly(16))];

/// Vertices of a strip.
const VERTICES: usize = 5;
/// Words of a vertex, and where `v`, `l` and `t` begin.
const WORDS: usize = 13;
const V: usize = 4;
const L: usize = 7;
const T: usize = 10;

type Nodes = [[f64; 4]; 4];

fn nodes(sample: &Sample) -> Option<Nodes> {
    let words = sample.get("gl_Position");
    (words.len() == 16).then(|| std::array::from_fn(|node| std::array::from_fn(|k| words[4 * node + k])))
}

/// The sample under the identity with other nodes.
fn placed(sample: &Sample, nodes: Nodes) -> Option<Sample> {
    with(&plain(sample)?, |s| put(s, "gl_Position", nodes.as_flattened()))
}

/// Claims that there are five vertices; whether there are.
fn five(o: &Observed, claims: &mut Claims<'_>) -> bool {
    claims.equal("number of vertices", Ball::from(o.vertices as f64), Ball::from(VERTICES as f64));
    claims.equal("words of a strip", Ball::from(o.words.len() as f64), Ball::from((VERTICES * WORDS) as f64));
    o.vertices == VERTICES && o.words.len() == VERTICES * WORDS
}

fn position(o: &Observed, vertex: usize) -> [Ball; 4] {
    outputs(o, vertex * WORDS)
}

fn vector(o: &Observed, vertex: usize, at: usize) -> [Ball; 3] {
    outputs(o, vertex * WORDS + at)
}

/// Directions of the curve at the five vertices, from the positions; `None` where the curve may
/// stand still.
fn tangents(o: &Observed) -> [Option<[Ball; 3]>; VERTICES] {
    derivatives(std::array::from_fn(|vertex| position(o, vertex))).map(|slope| direction(xyz(slope)))
}

pub(super) static HAIR_STRIP: Rule = Rule {
    name: "hair_strip",
    statement: "five vertices run from the second node to the third",
    needs: NEEDS,
    inputs: |sample| Some(vec![plain(sample)?]),
    claims: |inputs, o, claims| {
        if let (true, Some(q)) = (five(&o[0], claims), nodes(&inputs[0])) {
            claims.equal_vec("first position", position(&o[0], 0), exact(q[1]));
            claims.equal_vec("last position", position(&o[0], 4), exact(q[2]));
        }
    },
};

pub(super) static HAIR_UNIT: Rule = Rule {
    name: "hair_unit",
    statement: "v, l and t have length 1 where their vectors are not 0",
    needs: NEEDS,
    inputs: |sample| Some(vec![plain(sample)?]),
    claims: |_, o, claims| {
        if !five(&o[0], claims) {
            return;
        }
        for (vertex, tangent) in tangents(&o[0]).into_iter().enumerate() {
            let moves = tangent.is_some();
            let away = !length(xyz(position(&o[0], vertex))).may_be_zero();
            for (name, at, defined) in [("|v|", V, away), ("|l|", L, true), ("|t|", T, moves)] {
                if defined {
                    claims.equal(name, length(vector(&o[0], vertex, at)), Ball::from(1.0));
                }
            }
        }
    },
};

pub(super) static HAIR_TANGENT: Rule = Rule {
    name: "hair_tangent",
    statement: "t is the direction in which the positions follow each other",
    needs: NEEDS,
    inputs: |sample| Some(vec![plain(sample)?]),
    claims: |_, o, claims| {
        if five(&o[0], claims) {
            for (vertex, tangent) in tangents(&o[0]).into_iter().enumerate() {
                if let Some(tangent) = tangent {
                    claims.equal_vec("t", vector(&o[0], vertex, T), tangent);
                }
            }
        }
    },
};

pub(super) static HAIR_VIEW: Rule = Rule {
    name: "hair_view",
    statement: "v points from the position to the origin",
    needs: NEEDS,
    inputs: |sample| Some(vec![plain(sample)?]),
    claims: |_, o, claims| {
        if five(&o[0], claims) {
            for vertex in 0..VERTICES {
                if let Some(from_origin) = direction(xyz(position(&o[0], vertex))) {
                    claims.equal_vec("v", vector(&o[0], vertex, V), from_origin.map(|x| -x));
                }
            }
        }
    },
};

pub(super) static HAIR_LIGHT: Rule = Rule {
    name: "hair_light",
    statement: "the lines along l from all vertices meet in one light",
    needs: NEEDS,
    inputs: |sample| Some(vec![plain(sample)?]),
    claims: |_, o, claims| {
        if !five(&o[0], claims) {
            return;
        }
        let (p, l) = (xyz(position(&o[0], 0)), vector(&o[0], 0, L));
        for vertex in 1..VERTICES {
            // Two lines meet only when they lie in one plane, and a light is ahead of both: seen from
            // the first vertex the second one moves against the turn of l.
            let way = minus(xyz(position(&o[0], vertex)), p);
            let other = vector(&o[0], vertex, L);
            claims.equal("distance of two lines to the light", dot(way, cross(l, other)), Ball::from(0.0));
            claims.at_most("l turns against the way", dot(way, minus(other, l)), Ball::from(0.0));
        }
    },
};

pub(super) static HAIR_REVERSED: Rule = Rule {
    name: "hair_reversed",
    statement: "the nodes in reverse order give the same vertices in reverse order, with t turned round",
    needs: NEEDS,
    inputs: |sample| {
        let [q0, q1, q2, q3] = nodes(sample)?;
        Some(vec![plain(sample)?, placed(sample, [q3, q2, q1, q0])?])
    },
    claims: |_, o, claims| {
        if !(five(&o[0], claims) && five(&o[1], claims)) {
            return;
        }
        for (vertex, tangent) in tangents(&o[0]).into_iter().enumerate() {
            let back = VERTICES - 1 - vertex;
            claims.equal_vec("gl_Position", position(&o[0], vertex), position(&o[1], back));
            claims.equal_vec("l", vector(&o[0], vertex, L), vector(&o[1], back, L));
            if let Some(tangent) = tangent {
                let turned = vector(&o[1], back, T).map(|x| -x);
                claims.equal_vec("t", widened(vector(&o[0], vertex, T), tangent), turned);
            }
        }
    },
};

/// A unit vector with the radius of one that is computed from positions: near a standstill of the
/// curve a small error of the derivative turns it far.
fn widened(unit: [Ball; 3], tangent: [Ball; 3]) -> [Ball; 3] {
    std::array::from_fn(|k| Ball { mid: unit[k].mid, rad: unit[k].rad + 2.0 * tangent[k].rad })
}

pub(super) static HAIR_AFFINE: Rule = Rule {
    name: "hair_affine",
    statement: "an affine map of the nodes maps the positions",
    needs: NEEDS,
    inputs: |sample| {
        let first = placed(sample, nodes(sample)?.map(|q| q.map(on_grid)))?;
        let map = Exact::affine(hash(&first));
        let second = placed(&first, nodes(&first)?.map(|q| map.apply(q)))?;
        Some(vec![first, second])
    },
    claims: |inputs, o, claims| {
        let map = Exact::affine(hash(&inputs[0]));
        if five(&o[0], claims) && five(&o[1], claims) {
            for vertex in 0..VERTICES {
                let image = map.apply_ball(position(&o[0], vertex));
                claims.equal_vec("gl_Position", position(&o[1], vertex), image);
            }
        }
    },
};

pub(super) static HAIR_COLLINEAR: Rule = Rule {
    name: "hair_collinear",
    statement: "nodes on a line keep the strip on it",
    needs: NEEDS,
    inputs: |sample| {
        let [a, b, ..] = nodes(sample)?.map(|q| q.map(on_grid));
        Some(vec![placed(sample, collinear(a, b, hash(sample)))?])
    },
    claims: |inputs, o, claims| {
        let (true, Some(q)) = (five(&o[0], claims), nodes(&inputs[0])) else { return };
        let ways = q.map(|node| std::array::from_fn(|k| node[k] - q[1][k]));
        let size = |v: [f64; 4]| v.iter().map(|x| x * x).sum::<f64>();
        let along = ways.into_iter().fold([0.0; 4], |a, b| if size(b) > size(a) { b } else { a });
        for vertex in 0..VERTICES {
            on_line(position(&o[0], vertex), q[1], along, claims);
        }
    },
};

pub(super) static HAIR_C1: Rule = Rule {
    name: "hair_c1",
    statement: "neighbouring pieces of a strand meet with the same position and the same t",
    needs: NEEDS,
    inputs: |sample| {
        let [q0, q1, q2, q3] = nodes(sample)?;
        // Any point does as the fifth node.
        Some(vec![plain(sample)?, placed(sample, [q1, q2, q3, [q0[1], q0[2], q0[0], q0[3]]])?])
    },
    claims: |_, o, claims| {
        if !(five(&o[0], claims) && five(&o[1], claims)) {
            return;
        }
        claims.equal_vec("gl_Position", position(&o[0], 4), position(&o[1], 0));
        claims.equal_vec("l", vector(&o[0], 4, L), vector(&o[1], 0, L));
        if let (Some(before), Some(after)) = (tangents(&o[0])[4], tangents(&o[1])[0]) {
            let (left, right) = (vector(&o[0], 4, T), vector(&o[1], 0, T));
            claims.equal_vec("t", widened(left, before), widened(right, after));
        }
    },
};
