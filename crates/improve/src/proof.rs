//! Whether a proposal is the original in real numbers: at many points, first in binary64, and in numbers of many bits where
//! binary64 does not decide.

use crate::graph::{Points, values};
use crate::real::{Real, is_finite, near, same};
use crate::regimes::Split;
use crate::single::wide;
use crate::term::Term;

/// What binary64 may differ by, as part of the size, where it is believed.
const BELIEVED: f64 = 1e-9;

/// By how much a series, or the digits of a constant, may be off: a sixteenth of a unit in the last place of binary32.
pub(crate) const ROUNDED: f64 = 1.0 / (1u64 << 28) as f64;

/// Points at which numbers of many bits are computed.
const MANY_BITS: usize = 1 << 12;

/// What was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Proof {
    /// Points that were looked at.
    pub points: usize,
    /// Of these, those at which numbers of many bits decided.
    pub many_bits: usize,
    /// Those that neither decided: binary64 loses too many digits there, and there are too many of them.
    pub open: usize,
    /// Points at which the two differ, by less than binary32 can show: series, and constants with few digits.
    pub rounded: usize,
    /// A point at which they differ, and by what part of the original.
    pub unequal: Option<(Vec<f32>, f64)>,
    /// Points at which the original has a value and the proposal has none.
    pub lost: usize,
    /// A point of these.
    pub lost_at: Option<Vec<f32>>,
    /// Points at which the proposal has a value and the original has none.
    pub won: usize,
}

impl Proof {
    /// True when nothing speaks against the proposal.
    pub fn holds(&self) -> bool {
        self.unequal.is_none() && self.lost == 0
    }
}

/// Holds a proposal against its original.
///
/// # Errors
/// When there is no memory for numbers of many bits.
pub fn prove(original: &Term, split: &Split, terms: &[Term], points: &Points) -> Result<Proof, String> {
    let mut proof = Proof { points: points.len(), ..Proof::default() };
    let meant = wide(original, points);
    let mut by_term: Vec<(usize, Vec<usize>)> = split.terms().into_iter().map(|term| (term, Vec::new())).collect();
    by_term.sort_by_key(|(term, _)| *term);
    by_term.dedup_by_key(|(term, _)| *term);
    for at in 0..points.len() {
        let chosen = split.chosen(points, at);
        if let Some((_, all)) = by_term.iter_mut().find(|(term, _)| *term == chosen) {
            all.push(at);
        }
    }
    for (term, which) in by_term {
        let own = points.chosen(&which);
        let found = wide(&terms[term], &own);
        let mut doubtful: Vec<(f64, usize)> = Vec::new();
        for (k, &at) in which.iter().enumerate() {
            let (a, b) = (meant[at], found[k]);
            let far = (a - b).abs() / a.abs();
            if !(far <= BELIEVED || (a == 0.0 && b == 0.0)) {
                doubtful.push((if far.is_nan() { f64::INFINITY } else { far }, at));
            }
        }
        doubtful.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        // Half of them where they are farthest apart, half anywhere among the rest.
        let first = doubtful.len().min(MANY_BITS / 2);
        let rest = &doubtful[first..];
        let step = rest.len().div_ceil(MANY_BITS / 2).max(1);
        let chosen: Vec<usize> = doubtful[..first].iter().chain(rest.iter().step_by(step)).map(|(_, at)| *at).collect();
        proof.open += doubtful.len() - chosen.len();
        proof.many_bits += chosen.len();
        decide(&mut proof, original, &terms[term], &points.chosen(&chosen))?;
    }
    Ok(proof)
}

/// Decides at points with numbers of many bits.
fn decide(proof: &mut Proof, original: &Term, term: &Term, points: &Points) -> Result<(), String> {
    let last = |term: &Term| -> Result<std::sync::Arc<[Real]>, String> {
        let all = values(term, points)?;
        all.last().map(|known| known.reals.clone()).ok_or_else(|| "the expression is empty".to_owned())
    };
    let (meant, found) = (last(original)?, last(term)?);
    for (k, (a, b)) in meant.iter().zip(found.iter()).enumerate() {
        let point = || points.point(k);
        // What binary32 does not hold is no value.
        let fits = |x: &Real| is_finite(x) && near(x).abs() <= f64::from(f32::MAX);
        match (fits(a), is_finite(b)) {
            (false, true) => proof.won += 1,
            (false, false) => {}
            (true, false) => {
                proof.lost += 1;
                proof.lost_at.get_or_insert_with(point);
            }
            (true, true) if same(a, b) => {}
            (true, true) => {
                let far = (near(a) - near(b)).abs();
                let part = far / near(a).abs().max(f64::from(f32::MIN_POSITIVE));
                if part <= ROUNDED {
                    proof.rounded += 1;
                } else if proof.unequal.as_ref().is_none_or(|(_, most)| part > *most) {
                    proof.unequal = Some((point(), part));
                }
            }
        }
    }
    Ok(())
}
