//! Whether a word that an invocation gives is that of another one: memory that is addressed wrongly hands on what belongs
//! elsewhere, and invocations that disturb each other give something else.

use base::value::{Batch, Scalar};
use program::interp::{Binary32, Executable, FUEL};

/// How near a device is to strict binary32 at the least where it computes the same, as part of the number.
const NEAR: f64 = 1.0 / (1 << 10) as f64;

/// A word of an output.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word {
    pub vertex: usize,
    pub word: usize,
    pub scalar: Scalar,
}

/// The invocations of a batch, of `among`, that mean this word where it was found; all of them where the interpreter says
/// nothing.
pub(crate) fn that_mean(executable: &Executable, batch: &Batch, of: Word, found: u32, among: &[usize]) -> Vec<usize> {
    let Ok(meaning) = executable.run::<Binary32>(batch, FUEL) else { return among.to_vec() };
    let gives = |&k: &usize| {
        of.vertex < meaning.stored(k)
            && meaning.vertex(k, of.vertex).get(of.word).is_some_and(|&word| same(word, found, of.scalar))
    };
    among.iter().copied().filter(gives).collect()
}

fn same(a: u32, b: u32, scalar: Scalar) -> bool {
    if scalar != Scalar::F32 || a == b {
        return a == b;
    }
    let (a, b) = (f64::from(f32::from_bits(a)), f64::from(f32::from_bits(b)));
    (a.is_nan() && b.is_nan()) || (a - b).abs() <= NEAR * a.abs().max(b.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_near_and_whole_ones_equal() {
        let bits = |x: f32| x.to_bits();
        assert!(same(bits(1.0), bits(1.0001), Scalar::F32) && !same(bits(1.0), bits(1.01), Scalar::F32));
        assert!(same(bits(0.0), bits(-0.0), Scalar::F32) && same(bits(f32::NAN), 0x7fc0_0001, Scalar::F32));
        assert!(same(7, 7, Scalar::I32) && !same(7, 8, Scalar::U32));
    }
}
