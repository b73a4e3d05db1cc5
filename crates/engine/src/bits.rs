//! Numbers in parts of a run that are read back as the same bits, wherever they are: in arrays, in lists, beside other
//! things. JSON has neither NaN nor infinity, and readers of its numbers may round. For `#[serde(with = "crate::bits")]`.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::InputValue;
use ::improve::Proof;

/// Something with numbers in it.
pub trait Bits: Sized {
    /// The same with the words of the numbers.
    type Words: Serialize + DeserializeOwned;

    /// Its words.
    fn words(&self) -> Self::Words;

    /// What has these words.
    fn of(words: Self::Words) -> Self;
}

/// Writes the words.
///
/// # Errors
/// Those of the writer.
pub fn serialize<T: Bits, S: Serializer>(value: &T, to: S) -> Result<S::Ok, S::Error> {
    value.words().serialize(to)
}

/// Reads the words.
///
/// # Errors
/// When there is something else.
pub fn deserialize<'de, T: Bits, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    T::Words::deserialize(from).map(T::of)
}

impl Bits for f64 {
    type Words = u64;

    fn words(&self) -> u64 {
        self.to_bits()
    }

    fn of(words: u64) -> Self {
        Self::from_bits(words)
    }
}

impl Bits for f32 {
    type Words = u32;

    fn words(&self) -> u32 {
        self.to_bits()
    }

    fn of(words: u32) -> Self {
        Self::from_bits(words)
    }
}

impl<T: Bits> Bits for [T; 2] {
    type Words = [T::Words; 2];

    fn words(&self) -> Self::Words {
        self.each_ref().map(T::words)
    }

    fn of(words: Self::Words) -> Self {
        words.map(T::of)
    }
}

impl<T: Bits> Bits for Option<T> {
    type Words = Option<T::Words>;

    fn words(&self) -> Self::Words {
        self.as_ref().map(T::words)
    }

    fn of(words: Self::Words) -> Self {
        words.map(T::of)
    }
}

impl<T: Bits> Bits for Vec<T> {
    type Words = Vec<T::Words>;

    fn words(&self) -> Self::Words {
        self.iter().map(T::words).collect()
    }

    fn of(words: Self::Words) -> Self {
        words.into_iter().map(T::of).collect()
    }
}

impl<A: Bits, B: Bits> Bits for (A, B) {
    type Words = (A::Words, B::Words);

    fn words(&self) -> Self::Words {
        (self.0.words(), self.1.words())
    }

    fn of((a, b): Self::Words) -> Self {
        (A::of(a), B::of(b))
    }
}

impl<A: Bits, B: Bits, C: Bits> Bits for (A, B, C) {
    type Words = (A::Words, B::Words, C::Words);

    fn words(&self) -> Self::Words {
        (self.0.words(), self.1.words(), self.2.words())
    }

    fn of((a, b, c): Self::Words) -> Self {
        (A::of(a), B::of(b), C::of(c))
    }
}

impl Bits for String {
    type Words = Self;

    fn words(&self) -> Self {
        self.clone()
    }

    fn of(words: Self) -> Self {
        words
    }
}

impl Bits for Proof {
    type Words = ([usize; 6], Option<(Vec<u32>, u64)>, Option<Vec<u32>>);

    fn words(&self) -> Self::Words {
        let Self { points, many_bits, open, rounded, unequal, lost, lost_at, won } = self;
        ([*points, *many_bits, *open, *rounded, *lost, *won], unequal.words(), lost_at.words())
    }

    fn of(([points, many_bits, open, rounded, lost, won], unequal, lost_at): Self::Words) -> Self {
        let (unequal, lost_at) = (Bits::of(unequal), Bits::of(lost_at));
        Self { points, many_bits, open, rounded, unequal, lost, lost_at, won }
    }
}

impl Bits for InputValue {
    type Words = Self;

    fn words(&self) -> Self {
        self.clone()
    }

    fn of(words: Self) -> Self {
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_comes_back_with_its_bits() {
        #[derive(Serialize, Deserialize)]
        struct Numbers(#[serde(with = "crate::bits")] Vec<(f32, [Option<f64>; 2])>);
        let odd = f64::from_bits(0x7ff8_0000_0000_0001);
        let all =
            vec![(f32::NEG_INFINITY, [Some(0.1 + 0.2), None]), (-0.0, [Some(odd), Some(f64::MIN_POSITIVE / 3.0)])];
        let Numbers(back) = serde_json::from_str(&serde_json::to_string(&Numbers(all.clone())).unwrap()).unwrap();
        assert_eq!(back.words(), all.words());
    }
}
