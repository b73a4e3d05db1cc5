//! Orders in which workgroups and invocations come, beside the one of their numbers.
//!
//! Where two accesses meet without an order, that is found in any order. What atomic functions return is not: who comes
//! first is told so, and a race, a stray index or a barrier that is missed may take another one to come first.

use std::collections::{HashMap, HashSet};

use super::memory::Word;

/// An order of workgroups and invocations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Turns {
    /// Order of the workgroups, which run one after the other.
    pub groups: Turn,
    /// Order of the invocations of each workgroup at its memory.
    pub invocations: Turn,
    /// An invocation of each workgroup that runs ahead: its atomic loads give what was there before the others came, as
    /// far as no barrier and no atomic function of its own lies between. The second load of a word sees what they did.
    pub ahead: Option<u32>,
}

/// An order of some things that are numbered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turn {
    /// That of their numbers.
    #[default]
    Natural,
    /// One comes first, the others as they are numbered.
    First(u32),
    /// One comes last.
    Last(u32),
    /// The last one comes first.
    Reversed,
    /// Any order, drawn with this key.
    Shuffled(u64),
}

impl Turn {
    /// The numbers in this order; `None` for the order of the numbers.
    pub(super) fn order(self, count: usize) -> Option<Vec<usize>> {
        let others = |own: u32| (0..count).filter(move |&k| k != own as usize);
        let own = |k: u32| (0..count).filter(move |&other| other == k as usize);
        match self {
            Self::Natural => None,
            Self::First(k) => Some(own(k).chain(others(k)).collect()),
            Self::Last(k) => Some(others(k).chain(own(k)).collect()),
            Self::Reversed => Some((0..count).rev().collect()),
            Self::Shuffled(key) => {
                let mut all: Vec<usize> = (0..count).collect();
                all.sort_by_key(|&k| mixed(key.wrapping_add(k as u64)));
                Some(all)
            }
        }
    }
}

/// A number with the bits of another one mixed (the finalizer of SplitMix64: Steele, Lea, Flood, 2014).
fn mixed(x: u64) -> u64 {
    let x = x.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// What atomic functions made of a word.
#[derive(Debug)]
struct Changes {
    /// What it held before.
    before: u32,
    /// Which invocation left what, in the order of their functions.
    after: Vec<(u32, u32)>,
}

/// What the invocation that runs ahead still sees.
#[derive(Debug, Default)]
pub(super) struct Early {
    /// Words that atomic functions changed since the last barrier.
    changes: HashMap<Word, Changes>,
    /// Words of which it has seen the value before since then.
    seen: HashSet<Word>,
}

impl Early {
    /// A barrier: all see what was done before it.
    pub(super) fn meet(&mut self) {
        self.changes.clear();
        self.seen.clear();
    }

    /// An atomic function of an invocation leaves a value. `ahead` is the one that runs ahead.
    pub(super) fn changed(&mut self, word: Word, (before, after): (u32, u32), local: u32, ahead: u32) {
        self.changes.entry(word).or_insert_with(|| Changes { before, after: Vec::new() }).after.push((local, after));
        if local == ahead {
            self.seen.remove(&word);
        }
    }

    /// What the invocation that runs ahead loads of a word; `None` for what is there.
    pub(super) fn load(&mut self, word: Word, ahead: u32) -> Option<u32> {
        let Changes { before, after } = self.changes.get(&word)?;
        let own = after.iter().rev().find(|(local, _)| *local == ahead).map_or(*before, |(_, after)| *after);
        self.seen.insert(word).then_some(own)
    }
}

#[cfg(test)]
mod tests {
    use super::{Early, Turn};

    #[test]
    fn each_order_has_all_numbers_once() {
        let of = |turn: Turn| turn.order(4).unwrap();
        assert_eq!(Turn::Natural.order(4), None);
        assert_eq!((of(Turn::First(2)), of(Turn::Last(0))), (vec![2, 0, 1, 3], vec![1, 2, 3, 0]));
        assert_eq!(of(Turn::Reversed), [3, 2, 1, 0]);
        let mut drawn = of(Turn::Shuffled(7));
        drawn.sort_unstable();
        assert_eq!(drawn, [0, 1, 2, 3]);
    }

    #[test]
    fn who_runs_ahead_sees_its_own_change_and_no_other_one_time() {
        let mut early = Early::default();
        let word = (0, 5);
        assert_eq!(early.load(word, 1), None);
        early.changed(word, (0, 10), 0, 1);
        early.changed(word, (10, 20), 1, 1);
        early.changed(word, (20, 30), 2, 1);
        assert_eq!((early.load(word, 1), early.load(word, 1)), (Some(20), None));
        early.meet();
        assert_eq!(early.load(word, 1), None);
    }
}
