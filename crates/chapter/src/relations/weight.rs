//! Relations of the weight by distance (80).

use property::Sample;
use property::ball::{Ball, output};
use property::rule::{Rule, Words, number, put, with};

const NEEDS: &[(&str, Words)] = &[("d", Words::Exactly(1)), ("c", Words::Exactly(1))];

fn set(sample: &Sample, name: &str, value: f64) -> Option<Sample> {
    with(sample, |s| put(s, name, &[value]))
}

pub(super) static WEIGHT_ONE_AT_ZERO: Rule = Rule {
    name: "weight_one_at_zero",
    statement: "on the bone the weight is 1",
    needs: NEEDS,
    inputs: |sample| Some(vec![set(sample, "d", 0.0)?]),
    claims: |_, o, claims| claims.equal("w(0)", output(&o[0], 0), Ball::from(1.0)),
};

pub(super) static WEIGHT_RANGE: Rule = Rule {
    name: "weight_range",
    statement: "a weight is above 0 and no more than 1",
    needs: NEEDS,
    inputs: |sample| (number(sample, "d")? >= 0.0).then(|| vec![sample.clone()]),
    claims: |_, o, claims| {
        let w = output(&o[0], 0);
        claims.holds("w > 0", w.mid > 0.0);
        claims.at_most("w ≤ 1", w, Ball::from(1.0));
    },
};

pub(super) static WEIGHT_FALLS: Rule = Rule {
    name: "weight_falls",
    statement: "a nearer bone, or the same bone with a lesser exponent, has no lesser weight",
    needs: NEEDS,
    inputs: |sample| {
        let (d, c) = (number(sample, "d")?, number(sample, "c")?);
        (d >= 0.0 && c >= 0.0).then_some(())?;
        Some(vec![sample.clone(), set(sample, "d", d / 2.0)?, set(sample, "c", c / 2.0)?])
    },
    claims: |_, o, claims| {
        let [w, nearer, slower] = [&o[0], &o[1], &o[2]].map(|o| output(o, 0));
        claims.at_most("w(d) ≤ w(d/2)", w, nearer);
        claims.at_most("w with c ≤ w with c/2", w, slower);
    },
};

pub(super) static WEIGHT_SQUARES: Rule = Rule {
    name: "weight_squares",
    statement: "half the exponent gives the square root of the weight",
    needs: NEEDS,
    inputs: |sample| {
        let (d, c) = (number(sample, "d")?, number(sample, "c")?);
        (d >= 0.0).then_some(())?;
        Some(vec![sample.clone(), set(sample, "c", c / 2.0)?])
    },
    claims: |_, o, claims| {
        let root = output(&o[1], 0);
        claims.equal("w(c) and w(c/2)²", output(&o[0], 0), root * root);
    },
};
