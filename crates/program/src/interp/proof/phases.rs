//! Which barrier was the last before an access, and in which round of the loops around it.
//!
//! Two invocations of a workgroup touch a memory with no barrier between only where the last barrier that orders this
//! memory was the same for both. A barrier in a loop is another one in each round.

use std::collections::BTreeMap;
use std::rc::Rc;

use number::linear::Unknown;

/// A barrier of the text: its place, and the rounds of the loops around it that were walked one by one.
pub(super) type BarrierId = (usize, Vec<u32>);

/// How the round of an access follows from that of the barrier before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Since {
    /// So many rounds later.
    Rounds(i128),
    /// In the first round, whenever the barrier was.
    First,
}

/// The last barrier, with the loops in which both still are, by their rounds.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Last {
    pub barrier: Option<BarrierId>,
    pub rounds: BTreeMap<Unknown, Since>,
}

/// Barriers that may have been the last ones, for a kind of memory.
pub(super) type Lasts = Vec<Last>;

/// The same for each kind of memory, and what fences have announced.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Phases {
    pub of: [Rc<Lasts>; 3],
    fenced: [bool; 3],
    /// The last barrier of any kind.
    any: Option<Last>,
}

/// Kinds of memory that a barrier may order.
pub(super) const KINDS: [naga::Barrier; 3] =
    [naga::Barrier::WORK_GROUP, naga::Barrier::STORAGE, naga::Barrier::TEXTURE];

impl Phases {
    /// The beginning of a kernel.
    pub(super) fn begin() -> Self {
        let start = || Rc::new(vec![Last { barrier: None, rounds: BTreeMap::new() }]);
        Self { of: [start(), start(), start()], fenced: [false; 3], any: None }
    }

    /// Passes a barrier inside of loops with these rounds.
    pub(super) fn pass(&mut self, barrier: BarrierId, rounds: &[Unknown], orders: naga::Barrier) {
        let rounds = rounds.iter().map(|round| (*round, Since::Rounds(0))).collect();
        let last = Last { barrier: Some(barrier), rounds };
        for (k, kind) in KINDS.into_iter().enumerate() {
            if orders.contains(kind) || self.fenced[k] {
                self.of[k] = Rc::new(vec![last.clone()]);
            } else if !self.of[k].contains(&last) {
                Rc::make_mut(&mut self.of[k]).push(last.clone());
            }
        }
        self.fenced = [false; 3];
        self.any = Some(last);
    }

    /// A fence orders together with the barrier before it, and with the one behind it.
    pub(super) fn fence(&mut self, orders: naga::Barrier) {
        for k in (0..KINDS.len()).filter(|&k| orders.contains(KINDS[k])) {
            self.fenced[k] = true;
            if let Some(last) = &self.any {
                self.of[k] = Rc::new(vec![last.clone()]);
            }
        }
    }

    /// What holds behind two ways.
    pub(super) fn joined(&self, other: &Self) -> Self {
        let one = |k: usize| {
            let mut all = (*self.of[k]).clone();
            all.extend(other.of[k].iter().filter(|last| !self.of[k].contains(last)).cloned());
            Rc::new(all)
        };
        let fenced = std::array::from_fn(|k| self.fenced[k] && other.fenced[k]);
        let any = if self.any == other.any { self.any.clone() } else { None };
        Self { of: [one(0), one(1), one(2)], fenced, any }
    }

    /// The beginning of any round of a loop, by the beginning of the first one and the end of a round.
    pub(super) fn head(&self, end: Option<&Self>, round: Unknown) -> Self {
        let one = |k: usize| {
            let Some(end) = end else { return Rc::clone(&self.of[k]) };
            // Where a round may pass no barrier, the rounds since then are not known.
            let survives = end.of[k].iter().any(|last| self.of[k].contains(last));
            let mut all: Lasts = Vec::new();
            for last in self.of[k].iter() {
                let mut last = last.clone();
                if !survives {
                    last.rounds.insert(round, Since::First);
                }
                all.push(last);
            }
            for last in end.of[k].iter().filter(|last| !self.of[k].contains(last)) {
                let mut last = last.clone();
                match last.rounds.get_mut(&round) {
                    Some(Since::Rounds(count)) if !survives => *count += 1,
                    _ => {
                        last.rounds.remove(&round);
                    }
                }
                if !all.contains(&last) {
                    all.push(last);
                }
            }
            Rc::new(all)
        };
        Self { of: [one(0), one(1), one(2)], fenced: [false; 3], any: None }
    }

    /// Behind a loop, its rounds have no say.
    pub(super) fn without(&self, round: Unknown) -> Self {
        let one = |k: usize| {
            let mut all: Lasts = Vec::new();
            for last in self.of[k].iter() {
                let mut last = last.clone();
                last.rounds.remove(&round);
                if !all.contains(&last) {
                    all.push(last);
                }
            }
            Rc::new(all)
        };
        let any = self.any.clone().map(|mut last| {
            last.rounds.remove(&round);
            last
        });
        Self { of: [one(0), one(1), one(2)], fenced: self.fenced, any }
    }
}

#[cfg(test)]
mod tests {
    use super::Phases;
    use naga::Barrier;

    #[test]
    fn a_loop_without_a_barrier_keeps_what_was_before() {
        let begin = Phases::begin();
        assert_eq!(begin.head(Some(&begin), 7).of, begin.of);
    }

    #[test]
    fn a_barrier_orders_what_it_names_and_a_fence_beside_it_the_rest() {
        let (mut named, mut fenced) = (Phases::begin(), Phases::begin());
        named.pass((1, Vec::new()), &[], Barrier::WORK_GROUP);
        assert_eq!(named.of.each_ref().map(|of| of.len()), [1, 2, 2]);
        fenced.fence(Barrier::STORAGE);
        fenced.pass((1, Vec::new()), &[], Barrier::WORK_GROUP);
        assert_eq!(fenced.of.each_ref().map(|of| of.len()), [1, 1, 2]);
    }
}
