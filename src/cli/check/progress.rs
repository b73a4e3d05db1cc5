//! Progress of a run on a terminal; nothing elsewhere.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use lanes::{LaneName, Stage};
use report::check::short;

/// Parts of the bar.
const PARTS: u64 = 1000;

/// A suite on a stage of a lane, that is to be run.
#[derive(Clone, Debug)]
pub struct Task {
    /// Place of the suite in the run, from 0.
    pub suite: usize,
    /// Lane and stage.
    pub on: (LaneName, Stage),
    /// Samples, as far as they are known before.
    pub samples: u64,
}

/// How far a run is, and how long the rest takes.
#[derive(Clone, Debug, Default)]
struct Pace {
    /// What is still to be run, and what is running as the first.
    left: Vec<Task>,
    /// Samples of all that has been run, and how long that took, by lane and stage.
    spent: Vec<((LaneName, Stage), u64, Duration)>,
    all: u64,
}

impl Pace {
    fn new(tasks: Vec<Task>) -> Self {
        let all = tasks.iter().map(|task| task.samples).sum();
        Self { left: tasks, spent: Vec::new(), all }
    }

    /// Takes a task that has ended, with all before it: they did not run.
    fn end(&mut self, suite: usize, on: (LaneName, Stage), took: Duration) {
        let Some(at) = self.left.iter().position(|task| task.suite == suite && task.on == on) else { return };
        let ended: Vec<Task> = self.left.drain(..=at).collect();
        let Some(task) = ended.last() else { return };
        match self.spent.iter_mut().find(|(known, ..)| *known == on) {
            Some((_, samples, time)) => (*samples, *time) = (*samples + task.samples, *time + took),
            None => self.spent.push((on, task.samples, took)),
        }
    }

    /// Seconds that a sample takes on a lane and stage: as measured there, or else on all others.
    fn each(&self, on: (LaneName, Stage), now: (u64, Duration)) -> Option<f64> {
        let mean = |samples: u64, time: Duration| (samples > 0).then(|| time.as_secs_f64() / samples as f64);
        let own = self.spent.iter().filter(|(known, ..)| *known == on);
        let own = own.fold((0, Duration::ZERO), |(n, t), (_, samples, time)| (n + samples, t + *time));
        let others = self.spent.iter().fold(now, |(n, t), (_, samples, time)| (n + samples, t + *time));
        mean(own.0, own.1).or_else(|| mean(others.0, others.1))
    }

    /// How long the rest takes, when `done` samples of the first task took `took`; `None` when nothing is known.
    fn remaining(&self, done: u64, took: Duration) -> Option<Duration> {
        let mut seconds = 0.0;
        for (k, task) in self.left.iter().enumerate() {
            let rest = if k == 0 { task.samples.saturating_sub(done) } else { task.samples };
            // The task that runs tells best how long it takes.
            let own = (k == 0 && done > 0).then(|| took.as_secs_f64() / done as f64);
            seconds += rest as f64 * own.or_else(|| self.each(task.on, (done, took)))?;
        }
        Some(Duration::from_secs_f64(seconds))
    }

    /// Samples that are done, those of the first task included.
    fn done(&self, of_first: u64) -> u64 {
        let left: u64 = self.left.iter().map(|task| task.samples).sum();
        let first = self.left.first().map_or(0, |task| of_first.min(task.samples));
        self.all.saturating_sub(left) + first
    }
}

/// Progress of a run.
pub struct Progress {
    bar: ProgressBar,
    pace: Pace,
    suites: usize,
    begun: Instant,
    now: Option<Now>,
}

/// What is running.
struct Now {
    suite: usize,
    name: String,
    on: (LaneName, Stage),
    samples: u64,
    begun: Instant,
}

impl Progress {
    /// A bar on standard error; hidden when it is no terminal, or not wanted.
    pub fn new(wanted: bool, suites: usize, tasks: Vec<Task>) -> Self {
        let target = if wanted { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(PARTS), target);
        if let Ok(style) = ProgressStyle::with_template("[{bar:24}] {prefix}\n  {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar, pace: Pace::new(tasks), suites, begun: Instant::now(), now: None }
    }

    /// Begins a suite, given by its place in the run, on a stage of a lane.
    pub fn start(&mut self, (suite, name): (usize, &str), lane: LaneName, stage: Stage, samples: u64) {
        self.end();
        let (name, on) = (name.to_owned(), (lane, stage));
        self.now = Some(Now { suite, name, on, samples, begun: Instant::now() });
        if !self.bar.is_hidden() {
            self.bar.enable_steady_tick(Duration::from_millis(200));
        }
        self.at(0);
    }

    fn end(&mut self) {
        if let Some(now) = self.now.take() {
            self.pace.end(now.suite, now.on, now.begun.elapsed());
        }
    }

    /// Samples done of the suite that runs.
    pub fn at(&self, done: u64) {
        let Some(now) = &self.now else { return };
        let all = self.pace.done(done);
        let part = (PARTS * all).checked_div(self.pace.all).unwrap_or_default().min(PARTS);
        self.bar.set_position(part);
        let left = self.pace.remaining(done, now.begun.elapsed());
        let left = left.map_or_else(String::new, |left| format!("  {} left", clock(left)));
        let rate = all as f64 / self.begun.elapsed().as_secs_f64().max(1e-3);
        let (suite, suites) = (now.suite + 1, self.suites);
        self.bar.set_prefix(format!(
            "{:>3} %  suite {suite} of {suites}  {} samples/s{left}",
            100 * part / PARTS,
            short(rate as u64)
        ));
        let (lane, stage) = now.on;
        let of = format!("{} of {}", short(done), short(now.samples));
        self.bar.set_message(format!("{} on {lane}/{stage}  {of}", now.name));
    }

    /// Prints something without tearing the bar.
    pub fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Removes the bar.
    pub fn finish(&mut self) {
        self.end();
        self.bar.finish_and_clear();
    }
}

/// Minutes and seconds.
fn clock(time: Duration) -> String {
    let seconds = time.as_secs_f64().ceil() as u64;
    match seconds {
        0..3600 => format!("{}:{:02}", seconds / 60, seconds % 60),
        _ => format!("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAST: (LaneName, Stage) = ("fast", Stage::Compute);
    const SLOW: (LaneName, Stage) = ("slow", Stage::Compute);

    fn pace() -> Pace {
        let task = |suite, on| Task { suite, on, samples: 1000 };
        Pace::new(vec![task(0, FAST), task(0, SLOW), task(1, FAST), task(1, SLOW)])
    }

    fn seconds(pace: &Pace, done: u64, took: u64) -> Option<u64> {
        pace.remaining(done, Duration::from_secs(took)).map(|time| time.as_secs_f64().round() as u64)
    }

    #[test]
    fn each_lane_has_a_pace_of_its_own() {
        let mut pace = pace();
        assert_eq!(seconds(&pace, 0, 3), None, "nothing is known yet");
        // One second for 500 samples: what is not known is taken to be alike.
        assert_eq!(seconds(&pace, 500, 1), Some(7));
        pace.end(0, FAST, Duration::from_secs(2));
        assert_eq!(seconds(&pace, 100, 10), Some(90 + 2 + 11), "the slow lane by what all took so far");
        pace.end(0, SLOW, Duration::from_secs(100));
        assert_eq!(seconds(&pace, 0, 0), Some(2 + 100));
        assert_eq!((pace.done(0), pace.done(250), pace.done(5000)), (2000, 2250, 3000));
        pace.end(1, SLOW, Duration::from_secs(100));
        assert_eq!((seconds(&pace, 0, 0), pace.done(0)), (Some(0), 4000), "what was passed over is done");
    }

    #[test]
    fn times_are_reported_in_minutes() {
        let all = [0.0, 0.2, 59.9, 61.0, 3599.0, 3661.0].map(|s| clock(Duration::from_secs_f64(s)));
        assert_eq!(all, ["0:00", "0:01", "1:00", "1:01", "59:59", "1:01:01"]);
    }

    #[test]
    fn a_bar_that_nobody_sees_keeps_count_all_the_same() {
        let mut progress = Progress::new(false, 1, pace().left);
        progress.start((0, "sphere"), FAST.0, FAST.1, 1000);
        progress.at(500);
        assert_eq!(progress.pace.left.len(), 4);
        progress.start((0, "sphere"), SLOW.0, SLOW.1, 1000);
        assert_eq!(progress.pace.left.len(), 3);
        assert_eq!(progress.suspend(|| 7), 7);
        progress.finish();
        assert_eq!(progress.pace.left.len(), 2);
    }
}
