//! Whether the run was asked to end. What is under way then ends soon, and what was found so far is reported.
//!
//! Signals are sent to a process, and so there is one such question for all of it.
//!
//! Waits for devices and loops of the interpreter look at the flag. A slot that is given up is undetermined, or its
//! batch is not counted; a part of a run goes on from its checkpoint instead.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::Duration;

/// Longest wait for a device once the run was asked to end.
pub const GRACE: Duration = Duration::from_secs(3);

/// Number of the signal that asked; 0 for none.
static ASKED: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);

/// Where a handler of signals writes the number of the one that came.
pub fn flag() -> Arc<AtomicUsize> {
    ASKED.clone()
}

/// The signal that asked the run to end; `None` as long as it goes on.
pub fn signal() -> Option<u8> {
    u8::try_from(ASKED.load(Ordering::Relaxed)).ok().filter(|signal| *signal != 0)
}

/// True once the run was asked to end.
pub fn asked() -> bool {
    signal().is_some()
}
