//! Relations of vertex blending between bones, for two bones with weights of their own and for
//! skinning by distance. Both keep the sum of the weights in w, so positions are compared after the
//! homogeneous divide; where that sum cannot be told from 0 a relation says nothing.

use property::ball::{Ball, exact, output, outputs, plus, real};
use property::rule::{
    Claims, Exact, IDENTITY, Rule, Words, grid_point, hash, number, plain, point, put, put_point, with,
};
use property::{Observed, Sample};

const BLENDING: &[(&str, Words)] = &[("position", Words::Point), ("blendMatrix", Words::Each(16))];

const TWO_BONES: &[(&str, Words)] = &[
    ("position", Words::Point),
    ("weight", Words::Exactly(2)),
    ("blendMatrix", Words::Exactly(32)),
    ("mc", Words::Exactly(16)),
];

const SKINNING: &[(&str, Words)] = &[
    ("position", Words::Point),
    ("modelViewMatrix", Words::Exactly(16)),
    ("projectionMatrix", Words::Exactly(16)),
    ("numberOfBones", Words::Exactly(1)),
    ("p0", Words::Each(4)),
    ("p1", Words::Each(4)),
    ("blendMatrix", Words::Each(16)),
];

/// Names and words of an element of what belongs to a bone.
const BONE: [(&str, usize); 3] = [("p0", 4), ("p1", 4), ("blendMatrix", 16)];

/// The sample with the same matrix for all bones and the identity elsewhere, its position on the grid.
fn all_bones(sample: &Sample, matrix: [f64; 16]) -> Option<Sample> {
    // Without a bone nothing is blended.
    if sample.words("numberOfBones").is_some() {
        bones(sample)?;
    }
    with(&plain(sample)?, |s| {
        let count = s.words("blendMatrix")?.len() / 16;
        put(s, "blendMatrix", &matrix.repeat(count))?;
        if s.words("modelViewMatrix").is_some() {
            put(s, "modelViewMatrix", &IDENTITY)?;
        }
        let p = grid_point(s, "position")?;
        put_point(s, "position", p)
    })
}

/// Number of bones in use; `None` when the arrays do not hold so many.
fn bones(sample: &Sample) -> Option<usize> {
    let count = number(sample, "numberOfBones")?;
    let room = BONE.iter().map(|(name, words)| sample.words(name).map_or(0, <[u32]>::len) / words).min()?;
    (count >= 1.0 && count <= room as f64).then_some(count as usize)
}

/// The skinning sample itself, then one sample for each bone with this bone alone.
fn alone(sample: &Sample) -> Option<Vec<Sample>> {
    let all = plain(sample)?;
    let mut samples = vec![all.clone()];
    for bone in 0..bones(sample)? {
        samples.push(with(&all, |s| {
            for (name, words) in BONE {
                let mut values = s.get(name);
                values.copy_within(bone * words..(bone + 1) * words, 0);
                put(s, name, &values)?;
            }
            put(s, "numberOfBones", &[1.0])
        })?);
    }
    Some(samples)
}

pub(super) static BLEND_REST: Rule = Rule {
    name: "blend_rest",
    statement: "bones that have not moved leave the vertex where it is, whatever the weights",
    needs: BLENDING,
    inputs: |sample| Some(vec![all_bones(sample, IDENTITY)?]),
    claims: |inputs, o, claims| {
        if let (Some(p), Some(u)) = (point(&inputs[0], "position"), real(outputs(&o[0], 0))) {
            claims.equal_vec("u / w", u, exact([p[0], p[1], p[2]]));
        }
    },
};

pub(super) static BLEND_COMMON_MOTION: Rule = Rule {
    name: "blend_common_motion",
    statement: "one rigid motion of all bones moves the vertex, whatever the weights",
    needs: BLENDING,
    inputs: |sample| {
        let rest = all_bones(sample, IDENTITY)?;
        let moved = all_bones(sample, Exact::rigid(hash(&rest)).matrix())?;
        Some(vec![rest, moved])
    },
    claims: |inputs, o, claims| {
        let motion = Exact::rigid(hash(&inputs[0]));
        if let (Some(p), Some(u)) = (point(&inputs[0], "position"), real(outputs(&o[1], 0))) {
            let [x, y, z, _] = motion.apply(p);
            claims.equal_vec("u / w", u, exact([x, y, z]));
        }
    },
};

pub(super) static TWO_BONES_SWAPPED: Rule = Rule {
    name: "two_bones_swapped",
    statement: "the two bones exchanged give the same vertex",
    needs: TWO_BONES,
    inputs: |sample| {
        let swapped = with(&plain(sample)?, |s| {
            for name in ["weight", "blendMatrix"] {
                let mut values = s.get(name);
                let half = values.len() / 2;
                values.rotate_left(half);
                put(s, name, &values)?;
            }
            Some(())
        })?;
        Some(vec![plain(sample)?, swapped])
    },
    claims: |_, o, claims| {
        claims.equal_vec::<4>("gl_Position", outputs(&o[0], 0), outputs(&o[1], 0));
        claims.equal_vec::<4>("candidate0 and candidate1", outputs(&o[0], 4), outputs(&o[1], 8));
        claims.equal_vec::<4>("candidate1 and candidate0", outputs(&o[0], 8), outputs(&o[1], 4));
    },
};

/// Claims what holds between a blended vertex and the weighted candidates that it is made of.
fn blended(u: [Ball; 4], candidates: &[(Ball, [Ball; 3])], claims: &mut Claims<'_>) {
    let zero = Ball::from(0.0);
    let sum = candidates.iter().fold(zero, |sum, (w, _)| sum + *w);
    claims.equal("u.w and the sum of the weights", u[3], sum);
    let Some(u) = real(u) else { return };
    let mut mean = [zero; 3];
    for (w, candidate) in candidates {
        let Some(share) = w.over(sum) else { return };
        mean = std::array::from_fn(|k| mean[k] + candidate[k] * share);
    }
    claims.equal_vec("u / w and the normalised sum", u, mean);
    let hull = |k: usize, pick: fn(Ball, Ball) -> Ball| candidates.iter().map(|c| c.1[k]).reduce(pick);
    for (k, value) in u.into_iter().enumerate() {
        if let (Some(low), Some(high)) = (hull(k, Ball::min), hull(k, Ball::max)) {
            claims.at_most("below the hull of the candidates", low, value);
            claims.at_most("above the hull of the candidates", value, high);
        }
    }
}

pub(super) static TWO_BONES_HULL: Rule = Rule {
    name: "two_bones_hull",
    statement: "the vertex lies between its candidates, at the mean by the normalised weights",
    needs: TWO_BONES,
    inputs: |sample| {
        let weights = sample.get("weight");
        (weights.iter().all(|&w| w >= 0.0) && weights.iter().sum::<f64>() > 0.0).then_some(())?;
        Some(vec![plain(sample)?])
    },
    claims: |inputs, o, claims| {
        let weights = inputs[0].get("weight");
        let candidates: Option<Vec<_>> =
            [4, 8].into_iter().zip(weights).map(|(at, w)| Some((Ball::from(w), real(outputs(&o[0], at))?))).collect();
        if let Some(candidates) = candidates {
            blended(outputs(&o[0], 0), &candidates, claims);
        }
    },
};

pub(super) static TWO_BONES_RAW_WEIGHTS: Rule = Rule {
    name: "two_bones_raw_weights",
    statement: "weights scaled together give the same vertex after the homogeneous divide",
    needs: TWO_BONES,
    inputs: |sample| {
        let scaled = |scale: f64| {
            with(&plain(sample)?, |s| {
                let weights: Vec<f64> = s.get("weight").iter().map(|w| w * scale).collect();
                put(s, "weight", &weights)
            })
        };
        Some(vec![plain(sample)?, scaled(4.0)?, scaled(0.5)?])
    },
    claims: |_, o, claims| {
        let [once, four, half] = [&o[0], &o[1], &o[2]].map(|o| outputs::<4>(o, 0));
        claims.equal_vec("u with weights times 4", four, once.map(|x| x * 4.0));
        if let (Some(once), Some(half)) = (real(once), real(half)) {
            claims.equal_vec("u / w with half the weights", half, once);
        }
    },
};

pub(super) static SKINNING_PERMUTED: Rule = Rule {
    name: "skinning_permuted",
    statement: "the order of the bones does not matter",
    needs: SKINNING,
    inputs: |sample| {
        let count = bones(sample)?;
        let reversed = with(&plain(sample)?, |s| {
            for (name, words) in BONE {
                let values = s.get(name);
                let (used, rest) = values.split_at(count * words);
                let mut turned: Vec<f64> = used.chunks_exact(words).rev().flatten().copied().collect();
                turned.extend(rest);
                put(s, name, &turned)?;
            }
            Some(())
        })?;
        Some(vec![plain(sample)?, reversed])
    },
    claims: |_, o, claims| claims.equal_vec::<4>("gl_Position", outputs(&o[0], 0), outputs(&o[1], 0)),
};

pub(super) static SKINNING_ADDITIVE: Rule = Rule {
    name: "skinning_additive",
    statement: "the vertex is the sum of what each bone alone gives",
    needs: SKINNING,
    inputs: alone,
    claims: |_, o, claims| {
        let sum = o[1..].iter().fold(exact([0.0; 4]), |sum, single| plus(sum, outputs(single, 0), 1.0));
        claims.equal_vec("gl_Position", outputs(&o[0], 0), sum);
    },
};

pub(super) static SKINNING_HULL: Rule = Rule {
    name: "skinning_hull",
    statement: "the vertex lies in the hull of what each bone alone gives, at the mean by the normalised weights",
    needs: SKINNING,
    inputs: alone,
    claims: |_, o, claims| {
        let single = |o: &Observed| Some((output(o, 3), real(outputs(o, 0))?));
        if let Some(candidates) = o[1..].iter().map(single).collect::<Option<Vec<_>>>() {
            blended(outputs(&o[0], 0), &candidates, claims);
        }
    },
};

pub(super) static SKINNING_WEIGHTS: Rule = Rule {
    name: "skinning_weights",
    statement: "no weight is negative or above 1, and their sum is above 0",
    needs: SKINNING,
    inputs: alone,
    claims: |_, o, claims| {
        claims.holds("u.w > 0", output(&o[0], 3).mid > 0.0);
        for single in &o[1..] {
            let w = output(single, 3);
            claims.holds("weight ≥ 0", w.mid >= 0.0);
            claims.at_most("weight ≤ 1", w, Ball::from(1.0));
        }
    },
};

pub(super) static SKINNING_NEAREST: Rule = Rule {
    name: "skinning_nearest",
    statement: "a bone through the vertex has the weight 1, whatever its direction",
    needs: SKINNING,
    inputs: |sample| {
        let count = bones(sample)?;
        let through = with(&all_bones(sample, IDENTITY)?, |s| {
            let p = point(s, "position")?;
            for (name, step) in [("p0", -1.0), ("p1", 1.0)] {
                let mut values = s.get(name);
                // A bone around the vertex, along an axis that differs from bone to bone.
                for (bone, end) in values.chunks_exact_mut(4).take(count).enumerate() {
                    end.copy_from_slice(&p);
                    end[bone % 3] += step;
                }
                put(s, name, &values)?;
            }
            Some(())
        })?;
        Some(vec![through])
    },
    claims: |inputs, o, claims| {
        if let Some(count) = bones(&inputs[0]) {
            claims.equal("u.w", output(&o[0], 3), Ball::from(count as f64));
        }
    },
};
