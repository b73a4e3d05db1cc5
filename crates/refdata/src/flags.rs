//! What is special about a sample.

use std::fmt;

/// One property of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Flag {
    /// An output lies below the normal range of binary32, where a device may flush it to zero.
    Underflow = 1,
    /// An output, or a value on the way to it, may be too large for binary32.
    Overflow = 1 << 1,
    /// The bound of an output is more than 2^-10 of its size.
    IllConditioned = 1 << 2,
    /// The nearest point of a segment is one of its ends.
    SegmentEnd = 1 << 3,
    /// A segment of length 0, two nodes at one place, or a direction of the zero vector.
    Degenerate = 1 << 4,
    /// The profile promises nothing for an operation, or for its arguments.
    NoPromise = 1 << 5,
    /// A comparison in the shader, or the choice of a texel, could go either way.
    Branch = 1 << 6,
    /// An output has no value.
    NoValue = 1 << 7,
    /// An input is NaN.
    InputNan = 1 << 8,
    /// An input is infinite.
    InputInfinite = 1 << 9,
    /// An input is subnormal in binary32.
    InputSubnormal = 1 << 10,
    /// An input is -0.
    InputNegativeZero = 1 << 11,
    /// An output is infinite.
    Infinite = 1 << 12,
}

impl Flag {
    /// All of them, by their bits.
    pub const ALL: [Self; 13] = [
        Self::Underflow,
        Self::Overflow,
        Self::IllConditioned,
        Self::SegmentEnd,
        Self::Degenerate,
        Self::NoPromise,
        Self::Branch,
        Self::NoValue,
        Self::InputNan,
        Self::InputInfinite,
        Self::InputSubnormal,
        Self::InputNegativeZero,
        Self::Infinite,
    ];

    /// Name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Underflow => "Underflow",
            Self::Overflow => "Overflow",
            Self::IllConditioned => "IllConditioned",
            Self::SegmentEnd => "SegmentEnd",
            Self::Degenerate => "Degenerate",
            Self::NoPromise => "NoPromise",
            Self::Branch => "Branch",
            Self::NoValue => "NoValue",
            Self::InputNan => "InputNan",
            Self::InputInfinite => "InputInfinite",
            Self::InputSubnormal => "InputSubnormal",
            Self::InputNegativeZero => "InputNegativeZero",
            Self::Infinite => "Infinite",
        }
    }

    /// What it says, in a sentence.
    pub fn about(self) -> &'static str {
        match self {
            Self::Underflow => "an output lies below the normal range of binary32",
            Self::Overflow => "an output, or a value on the way to it, may be too large for binary32",
            Self::IllConditioned => "the bound of an output is more than 2^-10 of its size",
            Self::SegmentEnd => "the nearest point of a segment is one of its ends",
            Self::Degenerate => "a segment of length 0, two nodes at one place, or a direction of the zero vector",
            Self::NoPromise => "the profile promises nothing for an operation, or for its arguments",
            Self::Branch => "a comparison in the shader could go either way",
            Self::NoValue => "an output has no value",
            Self::InputNan => "an input is NaN",
            Self::InputInfinite => "an input is infinite",
            Self::InputSubnormal => "an input is subnormal in binary32",
            Self::InputNegativeZero => "an input is -0",
            Self::Infinite => "an output is infinite",
        }
    }
}

/// A set of flags, as files hold it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(pub u16);

impl Flags {
    /// Adds a flag.
    #[inline]
    pub fn set(&mut self, flag: Flag) {
        self.0 |= flag as u16;
    }

    /// True when the flag is in the set.
    pub fn has(self, flag: Flag) -> bool {
        self.0 & flag as u16 != 0
    }

    /// Adds what is special about the bits of a binary32 input.
    #[inline]
    pub fn input(&mut self, bits: u32) {
        if !is_special(bits) {
            return;
        }
        self.set(match bits & 0x7fff_ffff {
            0 => Flag::InputNegativeZero,
            1..=0x007f_ffff => Flag::InputSubnormal,
            0x7f80_0000 => Flag::InputInfinite,
            _ => Flag::InputNan,
        });
    }
}

/// True for the bits of NaN, infinities, subnormal numbers and -0.
#[inline(always)]
fn is_special(bits: u32) -> bool {
    ((bits & 0x7fff_ffff).wrapping_sub(0x0080_0000) >= 0x7f00_0000) & (bits != 0)
}

/// True when some of these inputs have a flag: a loop without branches.
#[inline(always)]
pub fn any_special(words: &[u32]) -> bool {
    let mut any = false;
    for &bits in words {
        any |= is_special(bits);
    }
    any
}

impl fmt::Display for Flags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = Flag::ALL.into_iter().filter(|&flag| self.has(flag)).map(Flag::name).collect();
        f.write_str(&names.join("|"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_are_told_apart_by_their_bits() {
        let of = |x: f32| {
            let mut flags = Flags::default();
            flags.input(x.to_bits());
            flags.to_string()
        };
        for plain in [0.0, 1.0, -2.0, f32::MAX, f32::MIN_POSITIVE, -f32::MIN_POSITIVE] {
            assert_eq!(of(plain), "", "{plain}");
            assert!(!any_special(&[plain.to_bits(); 20]), "{plain}");
        }
        for special in [-0.0, 1e-40, f32::NEG_INFINITY, f32::NAN] {
            let mut words = [0x3f80_0000; 20];
            words[13] = f32::to_bits(special);
            assert!(any_special(&words), "{special}");
        }
        assert_eq!(of(-0.0), "InputNegativeZero");
        assert_eq!((of(1e-40), of(-1e-45)), ("InputSubnormal".into(), "InputSubnormal".into()));
        assert_eq!((of(f32::INFINITY), of(f32::NEG_INFINITY)), ("InputInfinite".into(), "InputInfinite".into()));
        assert_eq!(of(-f32::NAN), "InputNan");
    }

    #[test]
    fn every_flag_has_a_bit_of_its_own() {
        let all = Flag::ALL.into_iter().fold(0, |all, flag| {
            assert_eq!(all & flag as u16, 0, "{}", flag.name());
            all | flag as u16
        });
        assert_eq!(all.count_ones() as usize, Flag::ALL.len());
    }
}
