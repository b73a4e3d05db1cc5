//! Which memories the barriers of a workgroup have put in order.
//!
//! A barrier waits for everybody but orders only the memories that it names: a race remains where two invocations
//! meet in a memory of another kind.

use naga::Barrier;

/// Kinds of memory that a barrier may order.
const KINDS: [Barrier; 3] = [Barrier::WORK_GROUP, Barrier::STORAGE, Barrier::TEXTURE];

/// Barriers that a workgroup is behind, and what each has ordered.
///
/// A barrier waits for all invocations, and orders the memories that it names: in WGSL (17.11) `workgroupBarrier` those of
/// workgroups, `storageBarrier` storage buffers; in GLSL (4.60, 8.16 and 8.17) `barrier` what is `shared`, and
/// `memoryBarrierBuffer` beside it buffers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Epochs {
    /// Barriers so far.
    count: u32,
    /// For each kind of memory, the number of the last one that ordered it.
    last: [u32; 3],
    /// Memories that the next barrier orders, for a fence stands before it.
    fenced: [bool; 3],
}

impl Epochs {
    /// The number of barriers so far.
    pub(super) fn now(&self) -> u32 {
        self.count
    }

    /// Counts a barrier, and notes the memories that it and fences beside it order.
    pub(super) fn pass(&mut self, orders: Barrier) {
        self.count += 1;
        for (k, kind) in KINDS.into_iter().enumerate() {
            if orders.contains(kind) || self.fenced[k] {
                self.last[k] = self.count;
            }
        }
        self.fenced = [false; 3];
    }

    /// A fence: authors write it on either side of the barrier, and mean both.
    pub(super) fn fence(&mut self, orders: Barrier) {
        for (k, kind) in KINDS.into_iter().enumerate() {
            if orders.contains(kind) {
                self.last[k] = self.count;
                self.fenced[k] = true;
            }
        }
    }

    /// Whether what was done to a memory of this kind behind `before` barriers is in order with what is done now.
    pub(super) fn order(&self, before: u32, kind: Barrier) -> bool {
        KINDS.into_iter().zip(self.last).any(|(own, last)| own == kind && last > before)
    }
}
