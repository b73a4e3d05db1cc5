//! The job of `check`: suites on lanes, in stages or from sources of inputs. Each suite in one way on one lane is a task,
//! whose result is a [`Part`] that can be joined with those of other shards.

mod ahead;

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::session::{self, At, Job, Observer, Reached};
use crate::shard::Shard;
use crate::suite::Suite;
use crate::suite::run::{
    Entry, Outcome, Part, Peer, Prepared, Request, RunError, Sampled, Share, Way, cross_check, max_samples, run_part,
    stage_of,
};
use judge::profile::Promises;
use lanes::{Lane, LaneError, Stage, embedded, interrupt};
use program::InputSource;

use ahead::Ahead;

/// Suites on lanes.
#[derive(Clone)]
pub struct Check<'a, S> {
    /// The suites.
    pub suites: S,
    /// The lanes, in the order in which they run.
    pub peers: Vec<Peer<'a>>,
    /// Only this stage of each lane.
    pub stage: Option<Stage>,
    /// Inputs from these sources in turn, in place of the usual run of each stage.
    pub sources: Option<&'a [InputSource]>,
    /// Which part of the samples, handed over as a whole. `None` for a whole run, of which what was judged until it is
    /// interrupted is of use.
    pub shard: Option<Shard>,
    /// Whether the shader's translations are compared as well, once for each suite.
    pub translations: bool,
    /// What other threads did before its turn came.
    ahead: Option<Arc<Ahead>>,
}

/// The suites of a run, by their places in it.
pub trait Suites {
    /// What ends the run.
    type Error;

    /// How many there are.
    fn count(&self) -> usize;

    /// Makes one ready.
    ///
    /// # Errors
    /// Why it cannot run.
    fn prepare(&self, suite: usize) -> Result<Arc<Prepared>, RunError>;

    /// What is asked of it on a lane.
    ///
    /// # Errors
    /// What ends the run.
    fn request(&self, suite: usize, prepared: &Prepared, peer: Peer<'_>) -> Result<Request, Self::Error>;
}

/// A suite in one stage of one lane, with inputs from one source.
pub struct Task<'a> {
    /// Place of the suite in the run, from 0.
    pub suite: usize,
    /// The suite.
    pub prepared: &'a Prepared,
    /// The lane.
    pub peer: Peer<'a>,
    /// Stage and source.
    pub way: Way,
    /// What the run is asked for.
    pub request: &'a Request,
    /// Samples that are generated.
    pub samples: u64,
}

impl Task<'_> {
    /// The place of its result in a report.
    pub fn entry(&self, outcome: Outcome) -> Entry {
        let (suite, shader) = (self.prepared.suite.name.clone(), self.prepared.shader.clone());
        Entry { suite, shader, on: Some((self.peer.name(), self.way.0)), outcome }
    }
}

/// What came of the suites.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Found {
    /// What each task found that did not fail.
    pub parts: Vec<Part>,
    /// For each of these, the place of its suite.
    pub of: Vec<usize>,
    /// How far the task behind them is.
    under_way: Option<Sampled>,
}

/// What happens in a run.
pub enum Event<'e> {
    /// A suite is ready, or cannot run.
    Prepared(usize, Result<&'e Prepared, RunError>),
    /// A task begins, or goes on.
    Begun(&'e Task<'e>),
    /// A task ended, or the lane failed. What was done before does not end again.
    Ended(&'e Task<'e>, Result<&'e Part, LaneError>),
    /// A suite ran in all ways, and its lanes were asked about each other's deviations: the results of all its tasks that
    /// did not fail, in their order. Where the run is interrupted, those until then.
    Suite(usize, &'e Prepared, &'e [Part]),
}

impl<'a, S: Suites> Check<'a, S> {
    /// Runs all stages of these lanes.
    pub fn new(suites: S, peers: Vec<Peer<'a>>) -> Self {
        Self { suites, peers, stage: None, sources: None, shard: None, translations: false, ahead: None }
    }

    /// The ways in which a suite runs on a lane: stages, or sources of inputs where these are asked for.
    pub fn ways(&self, suite: &Suite, lane: &dyn Lane) -> Vec<Way> {
        ways(self.stage, self.sources, suite, lane)
    }

    /// Runs the suite behind the `first` parts on the lane of a number; breaks off when it is interrupted. `earlier` has what
    /// was done of it before.
    fn on(
        &self,
        (number, peer): (usize, Peer<'_>),
        (suite, prepared, first): (usize, &Prepared, usize),
        earlier: &mut dyn Iterator<Item = Part>,
        at: &mut At<'_, Self>,
    ) -> Result<ControlFlow<(), bool>, S::Error> {
        let request = self.suites.request(suite, prepared, peer)?;
        let mut untranslated = false;
        for way in self.ways(&prepared.suite, peer.lane) {
            // What other threads did until the run was interrupted is told like what this one did.
            if interrupt::asked() && !self.ahead.as_ref().is_some_and(|ahead| ahead.has((suite, number))) {
                return Ok(ControlFlow::Break(()));
            }
            let most = way.1.map_or(u64::MAX, |source| max_samples(prepared, source));
            let samples = request.samples_of(&prepared.suite).min(most) / self.shard.map_or(1, Shard::count);
            let task = Task { suite, prepared, peer, way, request: &request, samples };
            if let Some(part) = earlier.next() {
                at.part.add(suite, part);
                continue;
            }
            at.observer.event(Event::Begun(&task))?;
            let mut progress = |done| at.observer.progress(done);
            let result = match self.ahead.as_ref().and_then(|ahead| ahead.take((suite, number), &mut progress)) {
                Some(result) => result,
                None => self.task(&task, at)?,
            };
            match result {
                // A device that is given up because the run ends has not failed.
                Err(_) | Ok(None) if interrupt::asked() => return Ok(ControlFlow::Break(())),
                Err(error) => {
                    untranslated |= matches!(error, LaneError::Translator(_));
                    at.observer.event(Event::Ended(&task, Err(error)))?;
                }
                Ok(part) => {
                    let Some(mut part) = part else { return Ok(ControlFlow::Break(())) };
                    // Translations have no lane: the first part of a suite bears what is found out about them.
                    let whole = self.shard.is_some() || !interrupt::asked();
                    let is_first = at.part.parts.len() == first && self.shard.is_none_or(Shard::is_first);
                    if is_first && self.translations && whole {
                        part.check_translations(prepared, &request);
                    }
                    at.observer.event(Event::Ended(&task, Ok(&part)))?;
                    at.part.under_way = None;
                    at.part.add(suite, part);
                    at.checkpoint()?;
                }
            }
        }
        Ok(ControlFlow::Continue(untranslated))
    }

    /// Runs a task; gives nothing when it is interrupted.
    fn task(&self, task: &Task<'_>, at: &mut At<'_, Self>) -> Result<Result<Option<Part>, LaneError>, S::Error> {
        let mut failed = None;
        let resume = at.part.under_way.take();
        let at = RefCell::new(at);
        let mut save = |sampled: &Sampled| {
            // A whole run has no checkpoints.
            if self.shard.is_none() {
                return ControlFlow::Continue(());
            }
            let mut at = at.borrow_mut();
            at.part.under_way = Some(sampled.clone());
            match at.checkpoint() {
                Ok(()) if interrupt::asked() => ControlFlow::Break(()),
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    failed = Some(error);
                    ControlFlow::Break(())
                }
            }
        };
        let share =
            Share { shard: self.shard.unwrap_or(Shard::WHOLE), resume, save: &mut save, partial: self.shard.is_none() };
        let mut progress = |done| at.borrow_mut().observer.progress(done);
        let part = run_part(task.prepared, task.peer.lane, task.way, task.request, share, &mut progress);
        failed.map_or(Ok(part), Err)
    }
}

impl Found {
    fn add(&mut self, suite: usize, part: Part) {
        self.parts.push(part);
        self.of.push(suite);
    }
}

impl<'a, S: Suites> Job for Check<'a, S> {
    type Unit = usize;
    type Part = Found;
    type Error = S::Error;
    type Event<'e> = Event<'e>;

    const SHARED_WITHIN: bool = true;

    fn unit(&mut self, number: u64, _: &mut At<'_, Self>) -> Result<Option<usize>, S::Error> {
        Ok(Some(number as usize).filter(|suite| *suite < self.suites.count()))
    }

    fn run(&mut self, (_, suite): (u64, usize), at: &mut At<'_, Self>) -> Result<(), S::Error> {
        let make = || self.suites.prepare(suite);
        let prepared = match self.ahead.as_ref().map_or_else(make, |ahead| ahead.turn(suite, make)) {
            Ok(prepared) => prepared,
            Err(error) => return at.observer.event(Event::Prepared(suite, Err(error))),
        };
        at.observer.event(Event::Prepared(suite, Ok(&prepared)))?;
        // What was done of it before stands in its place again, task by task.
        let first = at.part.of.partition_point(|&of| of < suite);
        at.part.of.truncate(first);
        let mut earlier = at.part.parts.split_off(first).into_iter();
        let this = (suite, &*prepared, first);
        let mut untranslated = false;
        for (number, &peer) in self.peers.iter().enumerate() {
            match self.on((number, peer), this, &mut earlier, at)? {
                ControlFlow::Continue(failed) => untranslated |= failed,
                ControlFlow::Break(()) => break,
            }
        }
        // Where a translator fails in front of every device, what the shader means is held against what is expected all the
        // same: the interpreter needs no translator.
        let judged = |part: &Part| part.judged() > 0;
        let none = !at.part.parts[first..].iter().any(judged);
        let alone = untranslated && none && self.shard.is_none() && !interrupt::asked();
        if let Some(lane) = alone.then(embedded::open).and_then(Result::ok) {
            let promises = Promises::of_lane(lane.description());
            let peer = Peer { lane: &*lane, promises: &promises };
            let _ = self.on((self.peers.len(), peer), this, &mut earlier, at)?;
        }
        if !interrupt::asked() {
            cross_check(&prepared, &self.peers, &mut at.part.parts[first..]);
        }
        at.observer.event(Event::Suite(suite, &prepared, &at.part.parts[first..]))
    }
}

/// Those ways, for what a run is asked for.
fn ways(stage: Option<Stage>, sources: Option<&[InputSource]>, suite: &Suite, lane: &dyn Lane) -> Vec<Way> {
    let admitted = |way: &Way| stage.is_none_or(|asked| asked == way.0);
    match sources {
        // Sources are ways into a compute stage; a lane without one takes its inputs in one way.
        Some(_) if !lane.description().stages.contains(&Stage::Compute) => Vec::new(),
        Some(sources) => sources.iter().map(|&s| (stage_of(s), Some(s))).filter(admitted).collect(),
        None => suite.stages(lane).into_iter().map(|stage| (stage, None)).filter(admitted).collect(),
    }
}

/// Runs all of a check, on all cores: what lanes share with other threads is done ahead of its turn, and told in its turn.
/// The result is that of [`session::run`].
///
/// # Errors
/// What the suites or the observer end the run with.
pub fn run_whole<'a, S>(check: &mut Check<'a, S>, observer: &mut dyn Observer<Check<'a, S>>) -> Result<(), S::Error>
where
    S: Suites + Clone + Send + Sync,
    S::Error: Send,
{
    ahead::side_by_side(check, ahead::threads(), |check| {
        session::run(check, None, Reached::default(), observer).map(drop)
    })
}

/// One suite that is ready, as the only one of a run.
pub struct One<R> {
    /// The suite.
    pub prepared: Arc<Prepared>,
    /// What is asked of it on a lane.
    pub request: R,
}

impl<R: Fn(&Prepared, Peer<'_>) -> Request> Suites for One<R> {
    type Error = std::convert::Infallible;

    fn count(&self) -> usize {
        1
    }

    fn prepare(&self, _: usize) -> Result<Arc<Prepared>, RunError> {
        Ok(Arc::clone(&self.prepared))
    }

    fn request(&self, _: usize, prepared: &Prepared, peer: Peer<'_>) -> Result<Request, Self::Error> {
        Ok((self.request)(prepared, peer))
    }
}
