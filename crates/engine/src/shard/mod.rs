//! Parts of a run that is larger than one machine: which samples belong to which part, where a part finds out
//! which one it is, and the text in which it hands over what it found.
//!
//! A shard is a contiguous part of the work: shard `I/N` of `n` units has the units `n·I/N..n·(I+1)/N`. Inputs
//! depend on the seed and on their number alone, so that the shards of a run together see what one run
//! sees, for every `N`.
//!
//! Because a shard is contiguous, a checkpoint is one number. What is done once in a run is done by the first shard.

mod auto;
mod sealed;

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use thiserror::Error;

pub use auto::{AutoError, COUNT, INDEX, detect};
pub use sealed::{Identity, Mismatch, SCHEMA, SCHEMA_VERSION, SealError, Sealed, Sort, open, seal};

/// Most shards of a run: file names have five digits for them.
pub const MOST: u64 = 100_000;

/// One part of a run, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Shard {
    index: u64,
    count: u64,
}

/// Why something is no shard.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum ShardError {
    /// Not of the form `I/N`.
    #[error("`{0}` is no shard; give I/N, such as 0/4 for the first of four, or `auto`")]
    Form(String),
    /// No shards at all.
    #[error("a run in 0 shards does nothing; the number of shards is 1 or more")]
    None,
    /// Too many.
    #[error("{0} shards are too many; there may be {MOST}")]
    TooMany(u64),
    /// A number behind the last.
    #[error("there is no shard {index} of {count}: shards are counted from 0, so that the last one is {}/{count}", .count - 1)]
    OutOfRange {
        /// The number.
        index: u64,
        /// The number of shards.
        count: u64,
    },
}

impl Shard {
    /// The whole run as its only shard.
    pub const WHOLE: Self = Self { index: 0, count: 1 };

    /// Shard `index`, counted from 0, of `count`.
    ///
    /// # Errors
    /// [`ShardError`] when there is no such shard.
    pub fn new(index: u64, count: u64) -> Result<Self, ShardError> {
        match count {
            0 => Err(ShardError::None),
            MOST.. if count > MOST => Err(ShardError::TooMany(count)),
            _ if index >= count => Err(ShardError::OutOfRange { index, count }),
            _ => Ok(Self { index, count }),
        }
    }

    /// Its number, from 0.
    pub fn index(self) -> u64 {
        self.index
    }

    /// How many shards the run has.
    pub fn count(self) -> u64 {
        self.count
    }

    /// True for the shard that also does what is done once for a run.
    pub fn is_first(self) -> bool {
        self.index == 0
    }

    /// Its part of `units` units of work. The parts of all shards follow each other without a gap; where
    /// there are fewer units than shards, some are empty.
    pub fn range(self, units: u64) -> Range<u64> {
        let at = |index: u64| (u128::from(units) * u128::from(index) / u128::from(self.count)) as u64;
        at(self.index)..at(self.index + 1)
    }

    /// Names of its files begin like this: `shard-00003-of-00016`.
    pub fn stem(self) -> String {
        format!("shard-{:05}-of-{:05}", self.index, self.count)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let form = || ShardError::Form(text.to_owned());
        let (index, count) = text.split_once('/').ok_or_else(form)?;
        let number = |text: &str| text.parse().map_err(|_| form());
        Self::new(number(index)?, number(count)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_follow_each_other_without_a_gap() {
        for units in [0, 1, 2, 6, 7, 8, 65_536, 100_000_001, u64::MAX] {
            for count in [1, 2, 3, 7, 64, MOST] {
                let mut end = 0;
                for index in [0, 1, count / 2, count.saturating_sub(1)] {
                    if let Ok(shard) = Shard::new(index, count) {
                        let sizes = units / count..=units.div_ceil(count);
                        let range = shard.range(units);
                        assert!(sizes.contains(&(range.end - range.start)), "{shard} of {units}: {range:?}");
                    }
                }
                for index in 0..count.min(64) {
                    let range = Shard::new(index, count).unwrap().range(units);
                    assert_eq!(range.start, end, "{index}/{count} of {units}");
                    end = range.end;
                }
                assert_eq!(Shard::new(count - 1, count).unwrap().range(units).end, units);
            }
        }
    }

    #[test]
    fn the_form_is_checked_and_shards_are_counted_from_0() {
        assert_eq!("3/4".parse(), Shard::new(3, 4));
        assert_eq!("3/4".parse::<Shard>().unwrap().stem(), "shard-00003-of-00004");
        let error = |text: &str| text.parse::<Shard>().unwrap_err().to_string();
        assert_eq!(error("4/4"), "there is no shard 4 of 4: shards are counted from 0, so that the last one is 3/4");
        assert_eq!(error("0/0"), "a run in 0 shards does nothing; the number of shards is 1 or more");
        assert_eq!(error("0/100001"), "100001 shards are too many; there may be 100000");
        for text in ["", "3", "a/4", "-1/4", "1/", "1/2/3", "1.0/2"] {
            assert!(error(text).contains("is no shard; give I/N"), "{text}");
        }
    }
}
