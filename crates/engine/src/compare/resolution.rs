//! How finely a function of one number tells neighbouring inputs apart in strict binary32, and whether it goes up and down
//! where its real numbers do not.

use std::collections::HashSet;

use serde::{Deserialize, Serialize};

use super::{ReadyPair, drawn};
use crate::fuzz::{Domain, ROUNDS, Ready};
use base::value::{Batch, Scalar};
use program::interp::{Binary32, Binary64};

/// Places that are looked at.
const PLACES: usize = 64;

/// Neighbouring inputs at each of them.
const NEIGHBOURS: usize = 256;

/// What neighbouring inputs give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Resolution {
    /// Inputs, in runs of neighbours.
    pub inputs: u64,
    /// Distinct outputs, counted in each run.
    pub distinct: u64,
    /// Steps that go down where the real numbers go up, or the other way.
    pub reversed: u64,
}

/// Both functions, where the first has one binary32 number as its input and both give numbers; `None` elsewhere.
pub(super) fn of(pair: &ReadyPair<'_>, domain: &Domain, key: u64) -> Option<[Resolution; 2]> {
    let ready = pair.sides[0];
    let (own, case) = (&ready.kernel.invocation, &ready.kernel.case);
    if own.words() + case.words() != 1 || own.words() != 1 || own.scalar_of(0) != Scalar::F32 {
        return None;
    }
    let pairs = pair.reference.pairs();
    let is_number = |side: usize, word: usize| pair.sides[side].kernel.output.vertex.scalar_of(word) == Scalar::F32;
    if !pairs.iter().all(|(own, other)| is_number(0, own.start) && is_number(1, other.start)) {
        return None;
    }
    let places = drawn(ready, domain, key, (0, PLACES), !domain.is_stated());
    let mut runs = Batch::with_capacity(own.clone(), case.clone(), 1, PLACES * NEIGHBOURS);
    for &from in &places.invocations {
        let x = f32::from_bits(from);
        if x.is_finite() && x != 0.0 && (from & 0x7fff_ffff) < 0x7f00_0000 {
            // Towards larger sizes: bits of numbers of one sign are in the order of their size.
            runs.invocations.extend((0..NEIGHBOURS as u32).map(|k| from + k));
        }
    }
    let fed = pair.fed(&runs);
    let words =
        |side: usize| pairs.iter().flat_map(move |(own, other)| if side == 0 { own.clone() } else { other.clone() });
    Some([
        read(pair.sides[0], &runs, &words(0).collect::<Vec<_>>()),
        read(pair.sides[1], &fed, &words(1).collect::<Vec<_>>()),
    ])
}

fn read(ready: &Ready, runs: &Batch, words: &[usize]) -> Resolution {
    let mut resolution = Resolution::default();
    let rounded = ready.executable.run::<Binary32>(runs, ROUNDS);
    let (Ok(rounded), Ok(meant)) = (rounded, ready.executable.run::<Binary64>(runs, ROUNDS)) else { return resolution };
    for first in (0..runs.invocation_count()).step_by(NEIGHBOURS) {
        let run = first..(first + NEIGHBOURS).min(runs.invocation_count());
        resolution.inputs += run.len() as u64;
        let outputs = |k: usize| words.iter().map(|&word| rounded.vertex(k, 0)[word]).collect::<Vec<u32>>();
        resolution.distinct += run.clone().map(outputs).collect::<HashSet<_>>().len() as u64;
        for (k, &word) in run.clone().skip(1).flat_map(|k| words.iter().map(move |word| (k, word))) {
            let number = |k: usize| f64::from(f32::from_bits(rounded.vertex(k, 0)[word]));
            let (step, real) = (number(k) - number(k - 1), meant.vertex(k, 0)[word] - meant.vertex(k - 1, 0)[word]);
            resolution.reversed += u64::from(step * real < 0.0);
        }
    }
    resolution
}
