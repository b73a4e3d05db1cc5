//! SIGINT and SIGTERM: runs end early and report what they found, other commands remove what they had begun to write.

use std::io;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level;

use disk::fresh;

/// Has a run end early at the first signal; a second one ends the process at once.
///
/// # Errors
/// When the system takes no handler.
#[cfg(feature = "run")]
pub fn listen() -> io::Result<()> {
    use signal_hook::flag;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    let again = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first signal finds the flag as it is before it is set.
        flag::register_conditional_shutdown(signal, 128 + signal, again.clone())?;
        flag::register(signal, again.clone())?;
        flag::register_usize(signal, lanes::interrupt::flag(), signal as usize)?;
    }
    Ok(())
}

/// Has a signal remove unfinished files before it ends the process.
///
/// # Errors
/// When the system takes no handler.
pub fn clean_up() -> io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        for signal in signals.forever() {
            fresh::abandon();
            // Whoever started the process sees that the signal ended it.
            let _ = low_level::emulate_default_handler(signal);
        }
    })?;
    Ok(())
}
