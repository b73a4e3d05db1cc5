//! Slots that run side by side, and sets of them.

/// Invocations that run side by side: enough to hide the cost of an instruction, few enough that the
/// columns of a shader stay in the cache.
pub const SLOTS: usize = 128;

/// One 32-bit word for each slot: a signed or unsigned integer, or a boolean as 0 or 1.
pub type Words = [u32; SLOTS];

const PARTS: usize = SLOTS / 64;

/// A set of slots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mask([u64; PARTS]);

impl Mask {
    /// No slot.
    pub const NONE: Self = Self([0; PARTS]);
    /// All slots.
    pub const ALL: Self = Self([u64::MAX; PARTS]);

    /// The first `count` slots.
    pub fn first(count: usize) -> Self {
        Self::where_(|slot| slot < count)
    }

    /// The slots for which `test` holds.
    #[inline]
    pub fn where_(test: impl Fn(usize) -> bool) -> Self {
        let mut flags = [0_u8; SLOTS];
        for (slot, flag) in flags.iter_mut().enumerate() {
            *flag = u8::from(test(slot));
        }
        let mut parts = [0; PARTS];
        for (k, eight) in flags.chunks_exact(8).enumerate() {
            let eight = eight.iter().rev().fold(0, |word, &flag| word << 8 | u64::from(flag));
            // The product brings the lowest bit of each byte into the highest byte.
            let bits = eight.wrapping_mul(0x0102_0408_1020_4080) >> 56;
            parts[k / 8] |= bits << (k % 8 * 8);
        }
        Self(parts)
    }

    /// The slots in which a boolean is true.
    pub fn of(words: &Words) -> Self {
        Self::where_(|slot| words[slot] != 0)
    }

    /// True when no slot is in the set.
    pub fn is_empty(&self) -> bool {
        *self == Self::NONE
    }

    /// True when every slot is in the set.
    pub fn is_full(&self) -> bool {
        *self == Self::ALL
    }

    /// True when the slot is in the set.
    pub fn has(&self, slot: usize) -> bool {
        self.0[slot / 64] >> (slot % 64) & 1 == 1
    }

    /// Adds a slot.
    pub fn insert(&mut self, slot: usize) {
        self.0[slot / 64] |= 1 << (slot % 64);
    }

    /// Slots of both sets.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] & other.0[k]))
    }

    /// Slots of either set.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] | other.0[k]))
    }

    /// Slots of this set that are not in the other.
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] & !other.0[k]))
    }

    /// Number of slots.
    pub fn count(&self) -> usize {
        self.0.iter().map(|part| part.count_ones() as usize).sum()
    }

    /// The slots, in order.
    pub fn slots(self) -> impl Iterator<Item = usize> {
        self.0.into_iter().enumerate().flat_map(|(k, mut part)| {
            std::iter::from_fn(move || {
                let bit = part.trailing_zeros() as usize;
                (part != 0).then(|| {
                    part &= part - 1;
                    k * 64 + bit
                })
            })
        })
    }

    /// Calls `f` for each slot, in order.
    #[inline]
    pub fn each(&self, mut f: impl FnMut(usize)) {
        for (k, &part) in self.0.iter().enumerate() {
            if part == u64::MAX {
                (k * 64..(k + 1) * 64).for_each(&mut f);
            } else {
                let mut part = part;
                while part != 0 {
                    f(k * 64 + part.trailing_zeros() as usize);
                    part &= part - 1;
                }
            }
        }
    }

    /// Copies `from` to `to` in the slots of the set.
    #[inline]
    pub fn merge<T: Copy>(&self, from: &[T; SLOTS], to: &mut [T; SLOTS]) {
        for (k, &part) in self.0.iter().enumerate() {
            let slots = k * 64..(k + 1) * 64;
            match part {
                0 => {}
                u64::MAX => to[slots.clone()].copy_from_slice(&from[slots]),
                _ => {
                    for (bit, (to, from)) in to[slots.clone()].iter_mut().zip(&from[slots]).enumerate() {
                        *to = if part >> bit & 1 == 1 { *from } else { *to };
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_combined_slot_by_slot() {
        let even = Mask::where_(|slot| slot % 2 == 0);
        let low = Mask::first(70);
        assert_eq!(even.and(low).count(), 35);
        assert_eq!(even.or(low).count(), 35 + SLOTS / 2);
        assert_eq!(low.minus(even).slots().take(3).collect::<Vec<_>>(), [1, 3, 5]);
        assert_eq!(low.slots().last(), Some(69));
        for slot in 0..SLOTS {
            assert_eq!(Mask::where_(|at| at == slot).slots().collect::<Vec<_>>(), [slot]);
        }
        assert!(Mask::ALL.is_full() && Mask::NONE.is_empty() && !even.has(1) && even.has(SLOTS - 2));
    }

    #[test]
    fn a_merge_leaves_other_slots_alone() {
        let mut to = [1_u32; SLOTS];
        Mask::where_(|slot| slot == 3 || slot >= 100).merge(&[2; SLOTS], &mut to);
        assert_eq!((to[2], to[3], to[4], to[99], to[100], to[SLOTS - 1]), (1, 2, 1, 1, 2, 2));
    }
}
