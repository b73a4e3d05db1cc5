//! A line on standard error now and then, for whoever waits where nothing else is printed.

use std::io::Write as _;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use engine::activity;

/// Time after which one thing that goes on is told, and told again.
const EVERY: Duration = Duration::from_secs(10);

/// Tells what goes on until it is dropped.
pub struct Waiting {
    end: Option<Sender<()>>,
    teller: Option<JoinHandle<()>>,
}

impl Waiting {
    /// Begins to tell.
    pub fn begin() -> Self {
        let (end, ended) = channel();
        let tell = move || {
            while ended.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
                if let Some((what, since)) = activity::now().filter(|(_, since)| *since >= EVERY) {
                    // Nobody waits where standard error is gone.
                    let _ = writeln!(std::io::stderr(), "note: {what}, for {} s so far", since.as_secs());
                }
            }
        };
        let teller = std::thread::Builder::new().name("waiting".to_owned()).spawn(tell).ok();
        Self { end: Some(end), teller }
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.end.take();
        if let Some(teller) = self.teller.take() {
            // It ends with what it waits for, and cannot panic.
            let _ = teller.join();
        }
    }
}
