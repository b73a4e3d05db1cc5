//! A function with some precisions on devices that err as far as they may, beside binary32.

use std::sync::Arc;

use rayon::prelude::*;

use super::tolerance::Tolerance;
use crate::adversary::{Device, Strategy};
use crate::fuzz::{Beside, Event, Harm, Narrowing, ROUNDS, Ready};
use base::value::Batch;
use judge::profile::Profile;
use lanes::{Stage, interrupt};
use program::DISCARD;
use program::interp::{Binary32, Executable, Machine, OutputColumn, SLOTS};
use property::Sample;

/// An edge may move: one sample of so many may fall to its other side.
const AT_EDGES: u64 = 64;

/// An output that is off by more than it may.
#[derive(Clone, Debug)]
pub struct Off {
    /// The sample.
    pub sample: Sample,
    /// The vertex and the word of the output.
    pub place: (usize, usize),
    /// Its value in binary32, and on the device.
    pub values: [f32; 2],
    /// The error in units of what is allowed.
    pub ratio: f64,
    /// Where digits or the range were lost first.
    pub event: Option<(Harm, Event)>,
    /// The device.
    pub strategy: Strategy,
}

/// What came of some samples on some devices.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Samples, once for each device.
    pub samples: u64,
    /// The largest error in units of what is allowed, apart from edges.
    pub worst: f64,
    /// Samples that are off, apart from edges.
    pub off: u64,
    /// Samples that are off where a decision fell to the other side of an edge.
    pub jumps: u64,
    /// The one that is off by most, apart from edges.
    pub most: Option<Off>,
    /// One at an edge.
    pub jump: Option<Off>,
}

impl Outcome {
    /// True where the outputs stay within what is allowed.
    pub fn holds(&self) -> bool {
        self.off == 0 && self.jumps * AT_EDGES <= self.samples
    }

    /// The sample that shows why not.
    pub fn shown(&self) -> Option<&Off> {
        if self.off > 0 { self.most.as_ref() } else { self.jump.as_ref().filter(|_| !self.holds()) }
    }

    fn join(mut self, other: Self) -> Self {
        self.samples += other.samples;
        self.off += other.off;
        self.jumps += other.jumps;
        self.worst = self.worst.max(other.worst);
        let larger =
            |a: &Option<Off>, b: &Option<Off>| b.as_ref().is_some_and(|b| a.as_ref().is_none_or(|a| b.ratio > a.ratio));
        if larger(&self.most, &other.most) {
            self.most = other.most;
        }
        self.jump = self.jump.or(other.jump);
        self
    }
}

/// The devices of a trial.
pub struct Devices<'p> {
    /// What `highp` is computed by: exactly, to tell what lower precision does alone.
    pub profile: &'p Profile,
    /// Seed of their choices.
    pub seed: u64,
}

impl Devices<'_> {
    fn narrowing(&self, strategy: Strategy) -> Narrowing {
        Narrowing::Device(Arc::new(Device::new(self.profile, Stage::Compute, strategy, self.seed)))
    }

    /// Runs samples of a batch on a device for each strategy.
    pub fn run(
        &self,
        (ready, lowered): (&Ready, Option<&Executable>),
        tolerances: &[Tolerance],
        batch: &Batch,
        strategies: &[Strategy],
    ) -> Outcome {
        let samples = batch.invocation_count() as u64 * strategies.len() as u64;
        // Nothing is lower: all is as in binary32.
        let Some(lowered) = lowered else { return Outcome { samples, ..Outcome::default() } };
        let on = |strategy: &Strategy| one(ready, lowered, tolerances, batch, *strategy, self.narrowing(*strategy));
        strategies.iter().map(on).fold(Outcome::default(), Outcome::join)
    }

    /// The largest error on a device that has binary16 and rounds to the nearest.
    pub fn binary16(
        &self,
        ready: &Ready,
        lowered: Option<&Executable>,
        tolerances: &[Tolerance],
        batch: &Batch,
    ) -> Outcome {
        let Some(lowered) = lowered else { return Outcome::default() };
        one(ready, lowered, tolerances, batch, Strategy::Random, Narrowing::Binary16)
    }
}

fn one(
    ready: &Ready,
    lowered: &Executable,
    tolerances: &[Tolerance],
    batch: &Batch,
    strategy: Strategy,
    narrowing: Narrowing,
) -> Outcome {
    let all: Vec<usize> = (0..batch.invocation_count()).collect();
    all.par_chunks(SLOTS)
        .map_init(
            || {
                let device = Machine::new(lowered, Beside::new(narrowing.clone()), ROUNDS);
                (device, Machine::new(&ready.executable, Binary32::default(), ROUNDS))
            },
            |(device, wide), chunk| {
                if interrupt::asked() {
                    return Outcome::default();
                }
                device.run_some(batch, chunk);
                wide.run_some(batch, chunk);
                device.take_findings();
                wide.take_findings();
                let mut outcome = Outcome { samples: chunk.len() as u64, ..Outcome::default() };
                for (slot, &invocation) in chunk.iter().enumerate() {
                    let Some((ratio, place, values)) = farthest(ready, tolerances, &*wide, &*device, slot) else {
                        continue;
                    };
                    let jumped = device.as_domain().jumped(slot);
                    let found = || {
                        let order = [Harm::Overflow, Harm::Underflow, Harm::Digits];
                        let event =
                            order.into_iter().find_map(|harm| Some((harm, device.as_domain().event(harm, slot)?)));
                        Some(Off { sample: Sample::of(batch, invocation), place, values, ratio, event, strategy })
                    };
                    if ratio > 1.0 && jumped {
                        outcome.jumps += 1;
                        outcome.jump = outcome.jump.take().or_else(found);
                        continue;
                    }
                    if ratio > 1.0 {
                        outcome.off += 1;
                        if outcome.most.as_ref().is_none_or(|most| most.ratio < ratio) {
                            outcome.most = found();
                        }
                    }
                    outcome.worst = outcome.worst.max(ratio);
                }
                outcome
            },
        )
        .reduce(Outcome::default, Outcome::join)
}

/// An error in units of what is allowed, the vertex and word where it is, and both values there.
type Farthest = (f64, (usize, usize), [f32; 2]);

fn farthest(
    ready: &Ready,
    tolerances: &[Tolerance],
    wide: &Machine<'_, Binary32>,
    device: &Machine<'_, Beside>,
    slot: usize,
) -> Option<Farthest> {
    let record = &ready.kernel.output.vertex;
    let mut most: Option<Farthest> = None;
    let mut note = |ratio: f64, place, values| {
        if ratio > most.map_or(0.0, |(most, ..)| most) {
            most = Some((ratio, place, values));
        }
    };
    for vertex in 0..wide.room() {
        if wide.is_emitting() && vertex as u32 >= wide.emitted()[slot] {
            continue;
        }
        let real = |word: usize| match (wide.output(vertex, word), device.output(vertex, word)) {
            (OutputColumn::Real(a), OutputColumn::Real(b)) => Some([a.values()[slot], b.lowered()[slot]]),
            _ => None,
        };
        let words = |word: usize| match (wide.output(vertex, word), device.output(vertex, word)) {
            (OutputColumn::Word(a), OutputColumn::Word(b)) => Some([a[slot], b[slot]]),
            _ => None,
        };
        let discards = record.index_of(DISCARD).and_then(|field| words(record.range(field).start));
        if let Some([a, b]) = discards {
            if a != b {
                note(f64::INFINITY, (vertex, record.range(record.index_of(DISCARD)?).start), [a as f32, b as f32]);
            }
            if a != 0 || b != 0 {
                continue;
            }
        }
        for (field, tolerance) in tolerances.iter().enumerate() {
            let range = record.range(field);
            if let (Tolerance::Pixels(viewport), 4) = (tolerance, range.len()) {
                let all: Option<Vec<[f32; 2]>> = range.clone().map(real).collect();
                let Some(all) = all.filter(|all| all.iter().all(|[a, _]| a.is_finite())) else { continue };
                let side = |side: usize| [all[0][side], all[1][side], all[2][side], all[3][side]];
                let ratio = Tolerance::of_position(*viewport, side(0), side(1));
                let k = usize::from((all[1][0] - all[1][1]).abs() > (all[0][0] - all[0][1]).abs());
                note(ratio, (vertex, range.start + k), all[k]);
                continue;
            }
            for word in range {
                match (real(word), words(word)) {
                    (Some([a, b]), _) if a.is_finite() => note(tolerance.ratio(a, b), (vertex, word), [a, b]),
                    (None, Some([a, b])) if a != b => note(f64::INFINITY, (vertex, word), [a as f32, b as f32]),
                    _ => {}
                }
            }
        }
    }
    most
}
