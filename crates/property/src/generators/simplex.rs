//! `simplex`: weights that are not negative and add up to one, formula (77).

use base::value::{Scalar, Shape};

use super::{
    Generator, Group, Options, Place, RangeRule, Role, SPECIAL, Stream, View, arrange, every_shape, float, word,
};

/// Weights of a convex combination over all words of the group. They are multiples of 2^-24, so
/// that their binary32 sum is exactly one in every order. Special: corners, edges with their
/// midpoints, equal weights, a corner missed by 2^-24.
pub struct Simplex;

/// One, in units of 2^-24.
const ONE: u32 = 1 << 24;

/// More weights than this are not sensible and would need a larger buffer.
const MOST: usize = 64;

fn units(units: u32) -> u32 {
    word(f64::from(units) / f64::from(ONE))
}

fn special(stream: &mut Stream, out: &mut [u32]) {
    let n = out.len();
    let (i, j) = (stream.below(n), stream.below(n));
    out.fill(0);
    match stream.below(5) {
        0 => out[i] = units(ONE),
        1 => {
            let part = stream.below(ONE as usize) as u32;
            out[i] = units(part);
            out[j] = units(if i == j { ONE } else { ONE - part });
        }
        2 => {
            out[i] = units(ONE / 2);
            out[j] = units(if i == j { ONE } else { ONE / 2 });
        }
        3 => {
            out.fill(units(ONE / n as u32));
            out[0] = units(ONE - ONE / n as u32 * (n as u32 - 1));
        }
        _ => {
            out[i] = units(1);
            out[j] = units(if i == j { ONE } else { ONE - 1 });
        }
    }
}

impl Generator for Simplex {
    fn name(&self) -> &str {
        "simplex"
    }

    fn about(&self) -> &str {
        "weights that are not negative and add up to exactly one"
    }

    fn range(&self) -> RangeRule {
        RangeRule::None
    }

    fn check(&self, shapes: &[Shape], _options: &Options) -> Result<(), String> {
        every_shape(self.name(), shapes, "floats, vectors and arrays of them", |s| {
            s.scalar == Scalar::F32 && s.columns == 1
        })?;
        let words: usize = shapes.iter().map(|s| s.words()).sum();
        match words {
            1 => Err("generator `simplex` needs at least two weights; one alone is always 1".into()),
            n if n > MOST => Err(format!("generator `simplex` fills up to {MOST} weights, not {n}")),
            _ => Ok(()),
        }
    }

    fn fill(&self, _group: &Group, _place: Place, stream: &mut Stream, out: &mut [u32]) {
        if stream.one_in(SPECIAL) {
            return special(stream, out);
        }
        // Gaps between sorted cuts are spread evenly over the simplex.
        let mut cuts = [ONE; MOST];
        let cuts = &mut cuts[..out.len()];
        let last = cuts.len() - 1;
        for cut in &mut cuts[..last] {
            *cut = stream.below(ONE as usize + 1) as u32;
        }
        cuts.sort_unstable();
        let mut from = 0;
        for (word, &cut) in out.iter_mut().zip(cuts.iter()) {
            *word = units(cut - from);
            from = cut;
        }
    }

    fn admits(&self, _group: &Group, words: &[u32]) -> bool {
        let sum: f64 = words.iter().map(|&w| f64::from(float(w))).sum();
        words.iter().all(|&w| float(w) >= 0.0) && sum == 1.0
    }

    fn role(&self) -> Role {
        Role::Follows
    }

    fn arrange(&self, _group: &Group, view: &View, out: &mut [u32]) {
        let shares = arrange::shares(out.len(), view.at[0]);
        out.iter_mut().zip(shares).for_each(|(out, share)| *out = word(share));
    }

    fn simplest(&self, _group: &Group, out: &mut [u32]) {
        out.fill(0);
        out[0] = units(ONE);
    }

    fn simpler(&self, _group: &Group, words: &[u32], k: usize, out: &mut [u32]) -> bool {
        let n = words.len();
        if k < n {
            // A corner.
            out.fill(0);
            out[k] = units(ONE);
        } else if k < 2 * n {
            // Two equal weights.
            out.fill(0);
            out[k - n] = units(ONE / 2);
            out[(k - n + 1) % n] = units(ONE / 2);
        } else if k < 3 * n {
            // One weight goes to the largest of the others.
            let from = k - 2 * n;
            let to = (0..n).filter(|&i| i != from).max_by(|&a, &b| float(words[a]).total_cmp(&float(words[b])));
            if let Some(to) = to {
                out[to] = (float(words[to]) + float(words[from])).to_bits();
                out[from] = 0;
            }
        } else if k < 3 * n + 4 {
            // Fewer bits; what rounding leaves goes to the largest.
            let steps = [2.0, 8.0, 64.0, 4096.0][k - 3 * n];
            let mut rest = 1.0;
            for w in out.iter_mut() {
                let rounded = (f64::from(float(*w)) * steps).floor() / steps;
                rest -= rounded;
                *w = word(rounded);
            }
            if let Some(largest) = (0..n).max_by(|&a, &b| float(out[a]).total_cmp(&float(out[b]))) {
                out[largest] = word(f64::from(float(out[largest])) + rest);
            }
        } else {
            return false;
        }
        true
    }
}
