//! Suites on lanes ahead of their turn: other threads run what may come next, so that all cores are busy also where one
//! suite keeps a single one busy.
//!
//! The thread of the run takes the results in their order, and says and joins what it would have said without this. Lanes
//! that belong to one thread are left to it.

use std::collections::{BTreeMap, VecDeque};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;

use super::{Check, Suites, ways};
use crate::shard::Shard;
use crate::suite::run::{Part, Peer, Prepared, Sampled, Share, run_part};
use judge::profile::Promises;
use lanes::{Lane, LaneError, Sharing, Stage, interrupt};
use program::InputSource;

/// Threads at most: each has the batches and machines of a suite in memory.
const MOST: usize = 8;

/// Suites for each thread that are begun before their turn.
const EARLY: usize = 2;

/// How long a thread waits before it looks whether the run is interrupted.
const SIGNAL: Duration = Duration::from_millis(50);

/// Room of a thread for calls: what the thread of the run has.
const STACK: usize = 8 << 20;

/// What came of a suite on a lane in one of its ways.
type Outcome = Result<Option<Part>, LaneError>;

/// A lane that threads share.
struct SharedPeer<'a> {
    lane: &'a (dyn Lane + Sync),
    promises: &'a Promises,
    /// One thread at a time.
    in_turn: bool,
}

/// What the threads know of a run.
struct Errand<'a, S> {
    suites: &'a S,
    /// The lanes by their number in the run; `None` for one that is left to the thread of the run.
    peers: Vec<Option<SharedPeer<'a>>>,
    stage: Option<Stage>,
    sources: Option<&'a [InputSource]>,
}

/// A suite on a lane.
#[derive(Default)]
struct Unit {
    /// What came of its ways, until it is taken.
    outcomes: VecDeque<Outcome>,
    /// How far the way is that is under way.
    steps: Arc<AtomicU64>,
    /// A thread has done what it will do: the rest is left to the thread of the run.
    over: bool,
}

/// A suite that some thread makes ready; none in it where that fails.
type Ready = Arc<OnceLock<Option<Arc<Prepared>>>>;

#[derive(Default)]
struct State {
    /// By suite and number of the lane, once they are begun.
    units: BTreeMap<(usize, usize), Unit>,
    /// For each lane, the first suite that has not begun on it.
    begun: Vec<usize>,
    ready: BTreeMap<usize, Ready>,
    /// The suite whose turn it is.
    turn: usize,
    over: bool,
}

/// What is done ahead of its turn.
pub(super) struct Ahead {
    /// For each lane of the run, whether threads share it.
    shared: Vec<bool>,
    state: Mutex<State>,
    changed: Condvar,
}

impl Ahead {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The suite whose turn it is now: what another thread made ready, or what `make` gives.
    ///
    /// # Errors
    /// That of `make`.
    pub(super) fn turn<E>(
        &self,
        suite: usize,
        make: impl Fn() -> Result<Arc<Prepared>, E>,
    ) -> Result<Arc<Prepared>, E> {
        {
            let mut state = self.state();
            state.turn = suite;
            state.ready = state.ready.split_off(&suite);
        }
        self.changed.notify_all();
        self.ready(suite, &make).map_or_else(make, Ok)
    }

    /// A suite that is made ready by the first that asks for it. `None` where that fails.
    fn ready<E>(&self, suite: usize, make: impl Fn() -> Result<Arc<Prepared>, E>) -> Option<Arc<Prepared>> {
        let ready = Arc::clone(self.state().ready.entry(suite).or_default());
        ready.get_or_init(|| make().ok()).clone()
    }

    /// True where the next outcome of a suite on the lane of a number is there.
    pub(super) fn has(&self, unit: (usize, usize)) -> bool {
        self.state().units.get(&unit).is_some_and(|unit| !unit.outcomes.is_empty())
    }

    /// The next outcome of a suite on the lane of a number, once it is there; `None` for what the caller has to do.
    pub(super) fn take(&self, unit: (usize, usize), progress: &mut dyn FnMut(u64)) -> Option<Outcome> {
        if !self.shared.get(unit.1).is_some_and(|lane| *lane) {
            return None;
        }
        let mut state = self.state();
        loop {
            let steps = match state.units.get_mut(&unit) {
                Some(found) => match found.outcomes.pop_front() {
                    Some(outcome) => return Some(outcome),
                    None if found.over => return None,
                    None => found.steps.load(Ordering::Relaxed),
                },
                // Nobody begins it any more.
                None if interrupt::asked() => return None,
                None => 0,
            };
            progress(steps);
            state = self.wait(state);
        }
    }

    /// Waits for a change, or as long as a signal may take to be seen.
    fn wait<'s>(&self, state: MutexGuard<'s, State>) -> MutexGuard<'s, State> {
        self.changed.wait_timeout(state, SIGNAL).unwrap_or_else(PoisonError::into_inner).0
    }

    /// Ends the threads once they have done what they are at.
    fn end(&self) {
        self.state().over = true;
        self.changed.notify_all();
    }
}

impl<S: Suites> Errand<'_, S> {
    /// Does one unit after the other, for as long as there are some.
    fn run(&self, ahead: &Ahead, early: usize) {
        while let Some(unit) = self.next(ahead, early) {
            let _begun = Begun { ahead, unit };
            // What is left is left to the thread of the run.
            let _ = self.unit(ahead, unit);
        }
    }

    /// The unit whose turn comes first, of those that may begin.
    fn next(&self, ahead: &Ahead, early: usize) -> Option<(usize, usize)> {
        let mut state = ahead.state();
        loop {
            if state.over || interrupt::asked() {
                return None;
            }
            let busy = |lane: usize| state.units.iter().any(|(of, unit)| of.1 == lane && !unit.over);
            let free = |lane: usize| self.peers[lane].as_ref().is_some_and(|peer| !peer.in_turn || !busy(lane));
            let lanes = (0..self.peers.len()).filter(|&lane| free(lane));
            let end = self.suites.count().min(state.turn + early);
            let next = |lane: usize| (state.begun[lane].max(state.turn), lane);
            if let Some(unit) = lanes.map(next).filter(|unit| unit.0 < end).min() {
                state.units.insert(unit, Unit::default());
                state.begun[unit.1] = unit.0 + 1;
                return Some(unit);
            }
            state = ahead.wait(state);
        }
    }

    /// Runs a suite on a lane; `None` where the thread of the run has to tell why that cannot be.
    fn unit(&self, ahead: &Ahead, (suite, lane): (usize, usize)) -> Option<()> {
        let SharedPeer { lane: peer, promises, .. } = self.peers[lane].as_ref()?;
        let prepared = ahead.ready(suite, || self.suites.prepare(suite))?;
        let request = self.suites.request(suite, &prepared, Peer { lane: *peer, promises }).ok()?;
        let steps = Arc::clone(&ahead.state().units.get(&(suite, lane))?.steps);
        for way in ways(self.stage, self.sources, &prepared.suite, *peer) {
            if interrupt::asked() {
                break;
            }
            steps.store(0, Ordering::Relaxed);
            let mut save = |_: &Sampled| ControlFlow::Continue(());
            let share = Share { shard: Shard::WHOLE, resume: None, save: &mut save, partial: true };
            let mut progress = |done| steps.store(done, Ordering::Relaxed);
            let outcome = run_part(&prepared, *peer, way, &request, share, &mut progress);
            ahead.state().units.get_mut(&(suite, lane))?.outcomes.push_back(outcome);
            ahead.changed.notify_all();
        }
        Some(())
    }
}

/// A unit that a thread is at, until it lets go of it, be it by a panic.
struct Begun<'a> {
    ahead: &'a Ahead,
    unit: (usize, usize),
}

impl Drop for Begun<'_> {
    fn drop(&mut self) {
        if let Some(unit) = self.ahead.state().units.get_mut(&self.unit) {
            unit.over = true;
        }
        self.ahead.changed.notify_all();
    }
}

/// How many threads are worth their room on this machine.
pub(super) fn threads() -> usize {
    thread::available_parallelism().map_or(1, usize::from).min(MOST)
}

/// Runs a check while other threads, at most so many, do what may come next.
pub(super) fn side_by_side<'a, S, R>(
    check: &mut Check<'a, S>,
    threads: usize,
    run: impl FnOnce(&mut Check<'a, S>) -> R,
) -> R
where
    S: Suites + Clone + Send + Sync,
{
    let peers: Vec<Option<SharedPeer<'a>>> = check.peers.iter().map(shared).collect();
    let threads = threads.min(check.suites.count() * peers.iter().flatten().count());
    // A single thread would have the thread of the run wait for it.
    if threads < 2 {
        return run(check);
    }
    let state = State { begun: vec![0; peers.len()], ..State::default() };
    let ahead = Arc::new(Ahead {
        shared: peers.iter().map(Option::is_some).collect(),
        state: Mutex::new(state),
        changed: Condvar::new(),
    });
    let suites = check.suites.clone();
    let errand = Errand { suites: &suites, peers, stage: check.stage, sources: check.sources };
    let found = thread::scope(|scope| {
        let _end = End(&ahead);
        let spawn = || {
            let thread = thread::Builder::new().stack_size(STACK);
            thread.spawn_scoped(scope, || errand.run(&ahead, EARLY * threads))
        };
        // A system without room for more threads has fewer; without any, nothing is ahead.
        if (0..threads).map_while(|_| spawn().ok()).count() > 0 {
            check.ahead = Some(Arc::clone(&ahead));
        }
        run(check)
    });
    check.ahead = None;
    found
}

/// Ends the threads also where the run panics.
struct End<'a>(&'a Ahead);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.end();
    }
}

/// A lane as other threads have it.
fn shared<'a>(peer: &Peer<'a>) -> Option<SharedPeer<'a>> {
    let promises = peer.promises;
    match peer.lane.sharing() {
        Sharing::Alone => None,
        Sharing::InTurn(lane) => Some(SharedPeer { lane, promises, in_turn: true }),
        Sharing::Free(lane) => Some(SharedPeer { lane, promises, in_turn: false }),
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;
    use std::sync::atomic::AtomicUsize;

    use super::super::Event;
    use super::*;
    use crate::session::{self, Observer, Reached};
    use crate::suite;
    use crate::suite::run::{DEFAULT_SEED, Request, RunError, prepare};
    use base::text::SourceFile;
    use lanes::{Description, Runner, embedded};
    use program::Kernel;

    /// Suites about functions of `x`, by what is returned; one that is no expression cannot run.
    #[derive(Clone)]
    struct Functions(&'static [&'static str]);

    impl Suites for Functions {
        type Error = Infallible;

        fn count(&self) -> usize {
            self.0.len()
        }

        fn prepare(&self, number: usize) -> Result<Arc<Prepared>, RunError> {
            let toml = "suite = \"f\"\nshader = \"f.glsl\"\nstage = \"function\"\nentry = \"f\"\n\n\
                        [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n";
            let suite = suite::parse(&SourceFile::new("f.suite.toml", toml)).unwrap();
            let text = format!("#version 450 core\nfloat f(float x) {{ return {}; }}\n", self.0[number]);
            prepare(&suite, &SourceFile::new("f.glsl", text)).map(Arc::new)
        }

        fn request(&self, _: usize, _: &Prepared, peer: Peer<'_>) -> Result<Request, Infallible> {
            Ok(Request {
                samples: Some(300),
                seed: DEFAULT_SEED,
                quick: false,
                replay: Vec::new(),
                replay_only: false,
                promises: peer.promises.clone(),
                arguments: String::new(),
            })
        }
    }

    /// The embedded lane under another kind of sharing, which counts the threads that use it.
    struct Planted {
        description: Description,
        sharing: u8,
        now: AtomicUsize,
        most: AtomicUsize,
    }

    impl Planted {
        fn new(sharing: u8) -> Self {
            let description = embedded::open().unwrap().description().clone();
            Self { description, sharing, now: AtomicUsize::new(0), most: AtomicUsize::new(0) }
        }
    }

    impl Lane for Planted {
        fn description(&self) -> &Description {
            &self.description
        }

        fn sharing(&self) -> Sharing<'_> {
            match self.sharing {
                0 => Sharing::Alone,
                1 => Sharing::InTurn(self),
                _ => Sharing::Free(self),
            }
        }

        fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
            let now = self.now.fetch_add(1, Ordering::SeqCst) + 1;
            self.most.fetch_max(now, Ordering::SeqCst);
            thread::sleep(Duration::from_millis(3));
            let runner = embedded::open().unwrap().prepare(kernel, capacity);
            self.now.fetch_sub(1, Ordering::SeqCst);
            runner
        }
    }

    /// Everything that happens, in words.
    #[derive(Default)]
    struct Told(Vec<String>);

    impl Observer<Check<'_, Functions>> for Told {
        fn event(&mut self, event: Event<'_>) -> Result<(), Infallible> {
            self.0.push(match event {
                Event::Prepared(suite, Ok(_)) => format!("{suite} is ready"),
                Event::Prepared(suite, Err(error)) => format!("{suite}: {error}"),
                Event::Begun(task) => format!("{} {:?} {}", task.suite, task.way, task.samples),
                Event::Ended(task, Ok(part)) => format!("{} {}", task.suite, serde_json::to_string(part).unwrap()),
                Event::Ended(task, Err(error)) => format!("{} failed: {error}", task.suite),
                Event::Suite(suite, _, parts) => format!("{suite} has {}", parts.len()),
            });
            Ok(())
        }
    }

    #[test]
    fn a_run_with_threads_ahead_tells_what_it_tells_without() {
        let suites = Functions(&["sin(x)", "x * x - 1.0", "vec2(", "sqrt(x)", "floor(x) / 0.3", "exp(x) - x"]);
        let planted = [0, 1, 2].map(Planted::new);
        let promises = Promises::of_lane(planted[0].description());
        let peers = || planted.iter().map(|lane| Peer { lane, promises: &promises }).collect::<Vec<_>>();
        let told = |threads: usize| {
            let (mut check, mut told) = (Check::new(suites.clone(), peers()), Told::default());
            check.translations = true;
            side_by_side(&mut check, threads, |check| {
                let Ok(found) = session::run(check, None, Reached::default(), &mut told);
                let found = serde_json::to_string(&found.unwrap()).unwrap();
                told.0.push(found);
            });
            told.0
        };
        let alone = told(1);
        assert!(
            alone.len() > 30
                && alone.iter().any(|line| line.contains("agreed"))
                && alone.iter().any(|line| line.contains("does not compile")),
            "{alone:?}"
        );
        for threads in [2, 3, 8] {
            let beside = told(threads);
            for (a, b) in alone.iter().zip(&beside) {
                assert_eq!(a, b, "{threads} threads");
            }
            assert_eq!(alone.len(), beside.len());
        }
        let most = planted.each_ref().map(|lane| lane.most.load(Ordering::SeqCst));
        assert_eq!(most[..2], [1, 1], "one thread at a time");
    }

    #[test]
    fn what_a_thread_does_not_bring_back_is_left_to_the_run() {
        let ahead = Ahead { shared: vec![true], state: Mutex::default(), changed: Condvar::new() };
        let steps = Arc::new(AtomicU64::new(7));
        ahead.state().units.insert((0, 0), Unit { steps: Arc::clone(&steps), ..Unit::default() });
        let panicked = thread::scope(|scope| {
            let thread = scope.spawn(|| {
                let _begun = Begun { ahead: &ahead, unit: (0, 0) };
                while steps.load(Ordering::SeqCst) != 0 {
                    thread::yield_now();
                }
                std::panic::resume_unwind(Box::new("planted"));
            });
            let mut seen = Vec::new();
            let outcome = ahead.take((0, 0), &mut |done| {
                seen.push(done);
                steps.store(0, Ordering::SeqCst);
            });
            assert!(outcome.is_none());
            assert_eq!(seen[0], 7, "how far it is, is told while it goes on");
            thread.join()
        });
        assert!(panicked.is_err());
    }
}
