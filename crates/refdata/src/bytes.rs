//! Bytes of an array that were computed as numbers and are not copied for it.

use std::ops::Deref;

use bytemuck::Pod;

/// The bytes of an array, the least significant of each number first, in the room of the numbers.
#[derive(Clone, Debug)]
pub enum Bytes {
    /// As they were read, or gathered.
    Plain(Vec<u8>),
    /// Of numbers of 16 bits.
    Short(Vec<u16>),
    /// Of numbers of 32 bits.
    Word(Vec<u32>),
    /// Of binary32.
    Single(Vec<f32>),
    /// Of binary64.
    Double(Vec<f64>),
}

/// Numbers whose room can hold bytes.
pub trait Held: Pod {
    /// The bytes of the numbers as they lie in memory.
    fn held(numbers: Vec<Self>) -> Bytes;
}

macro_rules! held {
    ($number:ty, $kind:ident) => {
        impl Held for $number {
            fn held(numbers: Vec<Self>) -> Bytes {
                Bytes::$kind(numbers)
            }
        }
    };
}

held!(u16, Short);
held!(u32, Word);
held!(f32, Single);
held!(f64, Double);

impl Bytes {
    /// The bytes of numbers, in the order of files.
    pub fn of<X: Held>(mut numbers: Vec<X>) -> Self {
        least_first::<X>(bytemuck::cast_slice_mut(&mut numbers));
        X::held(numbers)
    }

    /// The bytes alone; copied where their room is one of numbers.
    pub fn into_vec(self) -> Vec<u8> {
        match self {
            Self::Plain(bytes) => bytes,
            Self::Short(_) | Self::Word(_) | Self::Single(_) | Self::Double(_) => self.to_vec(),
        }
    }
}

/// Turns bytes of numbers round on machines that have the most significant one first.
pub(super) fn least_first<X>(bytes: &mut [u8]) {
    if cfg!(target_endian = "big") {
        bytes.chunks_exact_mut(size_of::<X>()).for_each(<[u8]>::reverse);
    }
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Plain(bytes) => bytes,
            Self::Short(numbers) => bytemuck::cast_slice(numbers),
            Self::Word(numbers) => bytemuck::cast_slice(numbers),
            Self::Single(numbers) => bytemuck::cast_slice(numbers),
            Self::Double(numbers) => bytemuck::cast_slice(numbers),
        }
    }
}

impl AsRef<[u8]> for Bytes {
    fn as_ref(&self) -> &[u8] {
        self
    }
}

impl From<Vec<u8>> for Bytes {
    fn from(bytes: Vec<u8>) -> Self {
        Self::Plain(bytes)
    }
}

impl PartialEq for Bytes {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_their_bytes_are_one() {
        let plain = Bytes::from(vec![1, 2, 3, 4, 0, 0, 0, 1]);
        assert_eq!(Bytes::of(vec![0x0403_0201_u32, 0x0100_0000]), plain);
        assert_eq!(Bytes::of(vec![0x0201_u16, 0x0403, 0, 0x0100]), plain);
        assert_eq!(Bytes::of(vec![f32::from_bits(0x0403_0201), f32::from_bits(0x0100_0000)]), plain);
        assert_eq!(Bytes::of(vec![f64::from_bits(0x0100_0000_0403_0201)]), plain);
        assert_ne!(Bytes::of(vec![0x0403_0202_u32, 0x0100_0000]), plain);
        assert_eq!(Bytes::of(vec![0x0403_0201_u32]).into_vec(), [1, 2, 3, 4]);
    }
}
