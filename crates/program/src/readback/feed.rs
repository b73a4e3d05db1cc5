//! Where the words come from that a module of a stage takes.

use base::value::Scalar;

/// Bits of a word of a buffer that the shader does not have: a NaN with a payload of its own. A translation that reads
/// beside its inputs gets it.
const PADDING: u32 = 0x7fda_dada;

/// Where a word comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feed {
    /// A word of the program's invocation record.
    Invocation(u32),
    /// A word of the program's case record.
    Case(u32),
    /// An ordinary number that no record has: what a buffer holds, or a device tells. It follows from the number and
    /// the invocation.
    MadeUp(u32, Scalar),
    /// Zero.
    Zero,
    /// Nothing that the shader has.
    Padding,
}

impl Feed {
    /// The word for an invocation with these words of the records.
    pub fn word(self, index: usize, invocation: &[u32], case: &[u32]) -> u32 {
        match self {
            Self::Invocation(word) => invocation.get(word as usize).copied().unwrap_or(PADDING),
            Self::Case(word) => case.get(word as usize).copied().unwrap_or(PADDING),
            Self::MadeUp(seed, scalar) => made_up(seed, index, scalar),
            Self::Zero => 0,
            Self::Padding => PADDING,
        }
    }
}

/// A number from -2 to 2, or a small one without a fraction.
fn made_up(seed: u32, index: usize, scalar: Scalar) -> u32 {
    let mut bits = u64::from(seed) << 32 ^ index as u64 ^ 0x9e37_79b9_7f4a_7c15;
    // The finaliser of splitmix64.
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    let bits = ((bits ^ bits >> 31) >> 32) as u32;
    match scalar {
        Scalar::F32 => ((bits >> 8) as f32 / (1 << 22) as f32 - 2.0).to_bits(),
        Scalar::I32 | Scalar::U32 => bits % 4,
        Scalar::Bool => bits % 2,
    }
}

#[cfg(test)]
mod tests {
    use super::{Feed, PADDING, made_up};
    use base::value::Scalar;

    #[test]
    fn numbers_that_are_made_up_differ_by_place_and_invocation() {
        let float = |seed, index| f32::from_bits(made_up(seed, index, Scalar::F32));
        assert!(float(1, 0).abs() <= 2.0 && float(1, 0) != float(1, 1) && float(1, 0) != float(2, 0));
        assert_eq!(float(7, 3), float(7, 3));
        assert!((0..100).all(|k| made_up(k, 5, Scalar::I32) < 4 && made_up(k, 5, Scalar::Bool) < 2));
    }

    #[test]
    fn what_no_record_has_is_no_input() {
        assert_eq!(Feed::Case(2).word(0, &[], &[5, 6]), PADDING);
        assert_eq!(Feed::Case(1).word(0, &[], &[5, 6]), 6);
        assert_eq!(Feed::Padding.word(0, &[1], &[2]), PADDING);
    }
}
