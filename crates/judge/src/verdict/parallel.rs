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
    let idle = Mutex::new(Vec::new());
    let take = || idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
    (0..count)
        .into_par_iter()
        .map(|part| {
            let mut with = take().unwrap_or_else(&make);
            let result = work(&mut with, part);
            idle.lock().unwrap_or_else(PoisonError::into_inner).push(with);
            result
        })
        .collect()
}
