//! A progress bar on a terminal for one thing after the other; nothing elsewhere.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Progress of one thing after the other.
pub struct Bar {
    bar: ProgressBar,
}

impl Bar {
    /// A bar on standard error; hidden when it is no terminal, or not wanted.
    pub fn new(wanted: bool) -> Self {
        let target = if wanted { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        if let Ok(style) =
            ProgressStyle::with_template("{msg:40} [{bar:30}] {human_pos}/{human_len} {per_sec} {eta} left")
        {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar }
    }

    /// Begins something that has so many steps.
    pub fn start(&self, what: &str, on: &str, steps: u64) {
        self.bar.reset();
        self.bar.set_length(steps);
        self.bar.set_message(format!("{what} on {on}"));
        // It takes a thread, which some systems have not.
        if !self.bar.is_hidden() {
            self.bar.enable_steady_tick(Duration::from_millis(200));
        }
    }

    /// Steps done.
    pub fn at(&self, done: u64) {
        self.bar.set_position(done);
    }

    /// Prints something without tearing the bar.
    pub fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
