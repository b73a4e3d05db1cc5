//! A run: suites on lanes, in stages or from sources of inputs. Each suite in one way on one lane is a job, whose result
//! is a [`Part`] that can be joined with those of other shards.
//!
//! Lines on the screen, checkpoints and the page of a run observe a session. `mutate`, `fuzz`, `calibrate` and
//! `refdata` have jobs of other kinds (mutants, functions, operations, blocks) and loops of their own.

use std::cell::RefCell;
use std::ops::ControlFlow;

use crate::shard::Shard;
use crate::suite::Suite;
use crate::suite::run::{
    Entry, Outcome, Part, Peer, Prepared, Request, Sampled, Share, Way, cross_check, max_samples, run_part, stage_of,
};
use judge::profile::Promises;
use lanes::{Lane, LaneError, Stage, embedded, interrupt};
use program::InputSource;

/// What is run of every suite.
#[derive(Clone)]
pub struct Session<'a> {
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
}

/// A suite in one stage of one lane, with inputs from one source.
pub struct Job<'a> {
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

impl Job<'_> {
    /// The place of its result in a report.
    pub fn entry(&self, outcome: Outcome) -> Entry {
        let (suite, shader) = (self.prepared.suite.name.clone(), self.prepared.shader.clone());
        Entry { suite, shader, on: Some((self.peer.name(), self.way.0)), outcome }
    }
}

/// What an earlier run left of a job.
pub enum Earlier {
    /// Nothing: it runs from the start.
    Nothing,
    /// It goes on from here.
    Begun(Box<Sampled>),
    /// It is done.
    Done(Box<Part>),
}

/// Who sets a session up suite by suite, and is told what comes of it.
pub trait Observer {
    /// Why a session ends before its time.
    type Error;

    /// Makes a suite ready, given by its place in the run. `None` for one that cannot run, which the observer notes.
    ///
    /// # Errors
    /// What ends the session.
    fn prepare(&mut self, suite: usize) -> Result<Option<Prepared>, Self::Error>;

    /// What is asked of a suite on a lane.
    ///
    /// # Errors
    /// What ends the session.
    fn request(&mut self, suite: usize, prepared: &Prepared, peer: Peer<'_>) -> Result<Request, Self::Error>;

    /// A job begins, or goes on.
    fn begin(&mut self, _: &Job<'_>) -> Earlier {
        Earlier::Nothing
    }

    /// So many samples of the job are done.
    fn progress(&mut self, _: u64) {}

    /// A batch is done, and the job is so far.
    ///
    /// # Errors
    /// What ends the session.
    fn checkpoint(&mut self, _: &Sampled) -> Result<(), Self::Error> {
        Ok(())
    }

    /// A job ended, or the lane failed. What another session left of a job does not end again.
    ///
    /// # Errors
    /// What ends the session.
    fn end(&mut self, _: &Job<'_>, _: Result<&Part, LaneError>) -> Result<(), Self::Error> {
        Ok(())
    }

    /// A suite ran in all ways, and its lanes were asked about each other's deviations: the results of all jobs that
    /// did not fail, in their order. Where the session is interrupted, those until then.
    ///
    /// # Errors
    /// What ends the session.
    fn suite(&mut self, suite: usize, prepared: &Prepared, parts: Vec<Part>) -> Result<(), Self::Error>;
}

impl<'a> Session<'a> {
    /// Runs all stages of these lanes.
    pub fn new(peers: Vec<Peer<'a>>) -> Self {
        Self { peers, stage: None, sources: None, shard: None, translations: false }
    }

    /// The ways in which a suite runs on a lane: stages, or sources of inputs where these are asked for.
    pub fn ways(&self, suite: &Suite, lane: &dyn Lane) -> Vec<Way> {
        let admitted = |(stage, _): &Way| self.stage.is_none_or(|asked| asked == *stage);
        match self.sources {
            // Sources are ways into a compute stage; a lane without one takes its inputs in one way.
            Some(_) if !lane.description().stages.contains(&Stage::Compute) => Vec::new(),
            Some(sources) => sources.iter().map(|&s| (stage_of(s), Some(s))).filter(admitted).collect(),
            None => suite.stages(lane).into_iter().map(|stage| (stage, None)).filter(admitted).collect(),
        }
    }

    /// Runs so many suites, one after the other, until the process is interrupted.
    ///
    /// # Errors
    /// What the observer ends the session with.
    pub fn run<O: Observer>(&self, suites: usize, observer: &mut O) -> Result<(), O::Error> {
        for suite in 0..suites {
            if let Some(prepared) = observer.prepare(suite)? {
                self.suite(suite, &prepared, observer)?;
            }
            if interrupt::asked() {
                break;
            }
        }
        Ok(())
    }

    fn suite<O: Observer>(&self, suite: usize, prepared: &Prepared, observer: &mut O) -> Result<(), O::Error> {
        let mut parts: Vec<Part> = Vec::new();
        let mut untranslated = false;
        for &peer in &self.peers {
            if self.on(peer, (suite, prepared), observer, &mut parts, &mut untranslated)?.is_break() {
                break;
            }
        }
        // Where a translator fails in front of every device, what the shader means is held against what is expected all the
        // same: the interpreter needs no translator.
        let judged = |part: &Part| part.judged() > 0;
        let alone = untranslated && !parts.iter().any(judged) && self.shard.is_none() && !interrupt::asked();
        if let Some(lane) = alone.then(embedded::open).and_then(Result::ok) {
            let promises = Promises::of_lane(lane.description());
            let peer = Peer { lane: &*lane, promises: &promises };
            let _ = self.on(peer, (suite, prepared), observer, &mut parts, &mut untranslated)?;
        }
        if !interrupt::asked() {
            cross_check(prepared, &self.peers, &mut parts);
        }
        observer.suite(suite, prepared, parts)
    }

    /// Runs a suite on one lane; breaks off when it is interrupted.
    fn on<O: Observer>(
        &self,
        peer: Peer<'_>,
        (suite, prepared): (usize, &Prepared),
        observer: &mut O,
        parts: &mut Vec<Part>,
        untranslated: &mut bool,
    ) -> Result<ControlFlow<()>, O::Error> {
        let request = observer.request(suite, prepared, peer)?;
        for way in self.ways(&prepared.suite, peer.lane) {
            if interrupt::asked() {
                return Ok(ControlFlow::Break(()));
            }
            let most = way.1.map_or(u64::MAX, |source| max_samples(prepared, source));
            let samples = request.samples_of(&prepared.suite).min(most) / self.shard.map_or(1, Shard::count);
            let job = Job { suite, prepared, peer, way, request: &request, samples };
            let resume = match observer.begin(&job) {
                Earlier::Nothing => None,
                Earlier::Begun(sampled) => Some(*sampled),
                Earlier::Done(part) => {
                    parts.push(*part);
                    continue;
                }
            };
            match self.job(&job, resume, observer)? {
                // A device that is given up because the run ends has not failed.
                Err(_) | Ok(None) if interrupt::asked() => return Ok(ControlFlow::Break(())),
                Err(error) => {
                    *untranslated |= matches!(error, LaneError::Translator(_));
                    observer.end(&job, Err(error))?;
                }
                Ok(part) => {
                    let Some(mut part) = part else { return Ok(ControlFlow::Break(())) };
                    // Translations have no lane: the first part of a suite bears what is found out about them.
                    let whole = self.shard.is_some() || !interrupt::asked();
                    if parts.is_empty() && self.translations && whole && self.shard.is_none_or(Shard::is_first) {
                        part.check_translations(prepared, &request);
                    }
                    observer.end(&job, Ok(&part))?;
                    parts.push(part);
                }
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Runs a job; gives nothing when it is interrupted.
    fn job<O: Observer>(
        &self,
        job: &Job<'_>,
        resume: Option<Sampled>,
        observer: &mut O,
    ) -> Result<Result<Option<Part>, LaneError>, O::Error> {
        let mut failed = None;
        let observer = RefCell::new(observer);
        let mut save = |sampled: &Sampled| match observer.borrow_mut().checkpoint(sampled) {
            Ok(()) if self.shard.is_some() && interrupt::asked() => ControlFlow::Break(()),
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                failed = Some(error);
                ControlFlow::Break(())
            }
        };
        let share =
            Share { shard: self.shard.unwrap_or(Shard::WHOLE), resume, save: &mut save, partial: self.shard.is_none() };
        let mut progress = |done| observer.borrow_mut().progress(done);
        let part = run_part(job.prepared, job.peer.lane, job.way, job.request, share, &mut progress);
        failed.map_or(Ok(part), Err)
    }
}
