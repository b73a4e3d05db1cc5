//! Work in parts on all cores.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

/// Does the parts of a work on all cores. Gives what comes of them, in their order. Machines and tapes take much room:
/// `make` is called about once for each core, and what it makes is used again.
pub(super) fn parts<T: Send, R: Send>(
    count: usize,
    make: impl Fn() -> T + Sync,
    work: impl Fn(&mut T, usize) -> R + Sync,
) -> Vec<R> {
    Idle::default().parts(count, make, work)
}

/// What threads work with, from one work to the next.
pub(super) struct Idle<T>(Mutex<Vec<T>>);

impl<T> Default for Idle<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Send> Idle<T> {
    /// Adds up something about what threads worked with.
    pub(super) fn sum<const N: usize>(&self, of: impl Fn(&T) -> [u64; N]) -> [u64; N] {
        let idle = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        idle.iter().fold([0; N], |sum, one| std::array::from_fn(|k| sum[k] + of(one)[k]))
    }

    /// [`parts`] with what was left from the work before.
    pub(super) fn parts<R: Send>(
        &self,
        count: usize,
        make: impl Fn() -> T + Sync,
        work: impl Fn(&mut T, usize) -> R + Sync,
    ) -> Vec<R> {
        let idle = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let one = |part| {
            let left = idle().pop();
            let mut with = left.unwrap_or_else(&make);
            let result = work(&mut with, part);
            idle().push(with);
            result
        };
        (0..count).into_par_iter().map(one).collect()
    }
}
