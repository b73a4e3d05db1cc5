//! Which outputs of a function have the same bits on every conforming device, and what leaves the others open.
//!
//! ```text
//! samples ─┬─ tape ─ freedoms of each output ─ fixed, fixed with `precise`, or free because of …
//!          └─ lanes ─ bits beside those of strict binary32 ─ where they differ, and whether they may
//! ```

mod lanes;
mod strict;

use std::collections::BTreeMap;
use std::ops::Range;

use crate::InputValue;
use crate::activity;
use crate::fuzz::{Domain, PILOT, Ready, Subject, batch_size, drawn, given, place, sizes, stream_key, word_of};
use ::lanes::{Lane, Stage, interrupt};
use base::value::{Batch, Field, ulp_at};
use judge::profile::Profile;
use judge::tape::{ExactSlots, Freed, Freedom, Model, Tape};
use judge::verdict::diagnosis::Place;
use judge::verdict::{Oracle, Rounds, edges};
use program::Written;
use program::interp::{Binary64, FUEL, Machine, Mask, Number, OutputColumn, SLOTS, Site};
use property::{Sample, regressions};
use serde::{Deserialize, Serialize};

pub use lanes::{Apart, OnLane};
pub(crate) use strict::StrictBits;

/// Samples that are looked at, at most.
pub const MOST_SAMPLES: u64 = 1 << 14;
/// Samples among which edges are sought.
const EDGES: u64 = 512;

/// What is asked for.
pub struct Request<'a> {
    /// Samples of each function, of which [`MOST_SAMPLES`] are looked at.
    pub samples: u64,
    /// Seed of the inputs.
    pub seed: u64,
    /// Inputs that are looked at alone, as `name=words` parts.
    pub case: Option<&'a str>,
    /// What devices promise.
    pub profile: &'a Profile,
    /// Lanes whose bits stand beside.
    pub lanes: &'a [&'a dyn Lane],
    /// The command line up to the function, for reproduction.
    pub command: &'a str,
}

/// What is known of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// Every conforming device has the same bits.
    Fixed,
    /// The same, but for samples with numbers that are subnormal or not finite.
    FixedButForEdges,
    /// It would be, were everything `precise`.
    FixedByPrecise,
    /// Two conforming devices may have other bits.
    Free,
    /// No sample is decided.
    Unknown,
}

/// A place that leaves an output open.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FreePlace {
    /// How.
    pub freedom: Freedom,
    /// Where it stands; `None` for an input.
    pub place: Option<Place>,
    /// In how many samples.
    pub samples: u64,
}

/// An output.
#[derive(Clone, Debug)]
pub struct OutputBits {
    /// Its name.
    pub name: String,
    /// Samples in which nothing is free, in which only what `precise` keeps is, in which only numbers that are subnormal or
    /// not finite are, in which anything else is, and those that are not decided.
    pub fixed: u64,
    /// See `fixed`.
    pub pinned: u64,
    /// See `fixed`.
    pub edges: u64,
    /// See `fixed`.
    pub free: u64,
    /// See `fixed`.
    pub unknown: u64,
    /// What leaves it open, most samples first.
    pub places: Vec<FreePlace>,
    /// How far two devices may be from each other, the widest of all samples, in ULP of the largest component or, where
    /// that is larger, of its usual size; infinite where nothing bounds it.
    pub spread: Option<(f64, Vec<InputValue>)>,
    /// Where lanes have other bits than strict binary32, each lane once.
    pub apart: Vec<Apart>,
}

impl OutputBits {
    /// What is known of it.
    pub fn standing(&self) -> Standing {
        match self {
            Self { free: 1.., .. } => Standing::Free,
            Self { pinned: 1.., .. } => Standing::FixedByPrecise,
            Self { fixed: 0, edges: 0, .. } => Standing::Unknown,
            Self { edges: 1.., .. } => Standing::FixedButForEdges,
            _ => Standing::Fixed,
        }
    }
}

/// What came of a function.
#[derive(Clone, Debug)]
pub struct BitsReport {
    /// Its name.
    pub function: String,
    /// `name:line:column`.
    pub at: String,
    /// Samples that were looked at.
    pub samples: u64,
    /// Samples that were left out, for a loop does not end soon.
    pub left_out: u64,
    /// Its outputs.
    pub outputs: Vec<OutputBits>,
    /// Lanes that ran it, each with why one did not.
    pub lanes: Vec<OnLane>,
    /// The profile of what devices promise.
    pub profile: String,
    /// True where the language has `precise`.
    pub has_precise: bool,
    /// Textures of which it takes samples: they are read at one texel, and what a filter gives is left to devices.
    pub sampled: Vec<String>,
}

/// What is counted of an output.
struct Counted {
    words: Range<usize>,
    /// The usual size of its largest component.
    usual: f64,
    places: BTreeMap<(Freedom, Option<usize>), (Option<Site>, u64)>,
    widest: Option<(f64, Sample)>,
    bits: OutputBits,
}

/// Gathers what is known of the outputs of a function.
pub(crate) struct Gathering<'a> {
    ready: &'a Ready,
    machine: Machine<'a, Tape<'a>>,
    outputs: Vec<Counted>,
}

impl<'a> Gathering<'a> {
    /// For devices that keep a profile. `pilot` shows how large outputs usually are.
    pub(crate) fn new(ready: &'a Ready, profile: &'a Profile, pilot: &Batch) -> Self {
        let model = Model::Device { profile, stage: Stage::Compute, rearranged: profile.rearrangement };
        let machine = Machine::new(&ready.executable, Tape::new(model).with_decisions(), FUEL);
        let sizes = sizes(ready, pilot);
        let record = &ready.kernel.output.vertex;
        let of = |(k, field): (usize, &Field)| Counted::new(&field.name, record.range(k), &sizes);
        Self { ready, machine, outputs: record.fields().iter().enumerate().map(of).collect() }
    }

    /// The words of each output, and their usual size.
    pub(crate) fn words(&self) -> Vec<(Range<usize>, f64)> {
        self.outputs.iter().map(|own| (own.words.clone(), own.usual)).collect()
    }

    /// Looks at the samples of a batch. For each output, the samples in which every device has the same bits.
    pub(crate) fn see(&mut self, batch: &Batch) -> Vec<Vec<bool>> {
        let mut fixed = vec![vec![false; batch.invocation_count()]; self.outputs.len()];
        let mut first = 0;
        while first < batch.invocation_count() && !interrupt::asked() {
            let slots = self.machine.run(batch, first);
            let all = Mask::first(slots);
            let exact = self.machine.domain().exact();
            let (decisions, unknown) = self.machine.domain().open_decisions(all, &exact);
            for (own, fixed) in self.outputs.iter_mut().zip(&mut fixed) {
                let found = of_output(&mut self.machine, own, (batch, first), (all, &exact), &decisions);
                let own = own.count(&found, all, unknown);
                own.each(|slot| fixed[first + slot] = true);
            }
            first += slots;
        }
        fixed
    }

    /// What was gathered. `apart` gives where lanes differ, by the number of an output.
    pub(crate) fn finish(self, apart: &dyn Fn(usize) -> Vec<Apart>) -> Vec<OutputBits> {
        self.outputs.into_iter().enumerate().map(|(k, own)| own.finish(self.ready, apart(k))).collect()
    }
}

/// Looks at a function.
///
/// # Errors
/// What is wrong with the case that was asked for.
pub fn run(subject: &Subject, ready: &Ready, domain: &Domain, request: &Request<'_>) -> Result<BitsReport, String> {
    let _doing = activity::doing(format!("looks at `{}`", subject.label));
    let case = request.case.map(|text| given(ready, text)).transpose()?;
    let alone = case.is_some() || ready.kernel.invocation.words() + ready.kernel.case.words() == 0;
    let samples = if alone { 1 } else { request.samples.min(MOST_SAMPLES) };
    let size = batch_size(ready).min(samples as usize);
    let key = stream_key(request.seed, &subject.label);
    let drawn = |first: u64, count: usize| drawn(ready, domain, key, (first, count), !domain.is_stated());
    let mut gathering = Gathering::new(ready, request.profile, &drawn(0, PILOT));
    let words = gathering.words();
    let mut on: Vec<lanes::Running<'_>> =
        request.lanes.iter().map(|lane| lanes::Running::new(*lane, ready, size)).collect();
    let mut see = |batch: Batch| -> (u64, u64) {
        let count = batch.invocation_count();
        let order = Rounds::order(&Rounds::of::<Binary64>(&ready.executable, &batch));
        let kept = order.len();
        let batch = if kept < count { batch.apart(order.into_iter()) } else { batch };
        let fixed = gathering.see(&batch);
        let strict = StrictBits::of(&ready.executable, &batch);
        on.iter_mut().for_each(|lane| lane.run(&batch, &words, &fixed, &strict));
        (kept as u64, (count - kept) as u64)
    };
    let (mut first, mut seen) = (0, (0, 0));
    let mut count = |(kept, left_out): (u64, u64)| seen = (seen.0 + kept, seen.1 + left_out);
    while first < samples && !interrupt::asked() {
        let some = (samples - first).min(size as u64) as usize;
        let batch = || drawn(first, some);
        count(see(case.as_ref().map_or_else(batch, |sample| Sample::batch(std::slice::from_ref(sample)))));
        first += some as u64;
    }
    // A comparison of numbers that are free falls either way for few inputs, which chance does not meet.
    if let (false, Ok(oracle)) = (alone || interrupt::asked(), Oracle::new(&ready.program)) {
        let keeps = |sample: &Sample| domain.keeps(sample);
        let found = edges(&oracle, &keeps, &drawn(0, samples.min(EDGES) as usize), Vec::new()).samples;
        found.chunks(size).for_each(|some| count(see(Sample::batch(some))));
    }
    let reproduce = |sample: &Sample| {
        let inputs = regressions::inputs_text(sample);
        format!("{} --function {} --case '{inputs}'", request.command, word_of(&subject.label))
    };
    let apart = |k: usize| on.iter().filter_map(|lane| lane.apart(k, &ready.program, &reproduce)).collect();
    Ok(BitsReport {
        function: subject.label.clone(),
        at: subject.at.clone(),
        samples: seen.0,
        left_out: seen.1,
        outputs: gathering.finish(&apart),
        lanes: on.iter().map(lanes::Running::report).collect(),
        profile: request.profile.name.clone(),
        has_precise: ready.program.written == Written::Glsl,
        sampled: ready.program.sampled(),
    })
}

/// The freedoms of all words of an output, those of all vertices together.
fn of_output(
    machine: &mut Machine<'_, Tape<'_>>,
    own: &mut Counted,
    (batch, first): (&Batch, usize),
    (all, exact): (Mask, &ExactSlots),
    decisions: &[Freed],
) -> Vec<Freed> {
    let mut found: Vec<Freed> = decisions.to_vec();
    let (mut spread, mut size) = ([0.0_f64; SLOTS], [0.0_f64; SLOTS]);
    for vertex in 0..machine.room() {
        for word in own.words.clone() {
            let OutputColumn::Real(&column) = machine.output(vertex, word) else { continue };
            let tape = machine.domain();
            let values = *tape.values(column);
            let written = all.and(Mask::where_(|slot| !values[slot].is_poison()));
            let freedoms = tape.freedoms(column, written, exact);
            found.extend(freedoms.each);
            written.each(|slot| {
                spread[slot] = spread[slot].max(freedoms.spread[slot]);
                size[slot] = size[slot].max(values[slot].abs());
            });
        }
    }
    let usual = own.usual;
    let in_ulp = |slot: usize| match spread[slot] {
        0.0 => 0.0,
        wide if wide.is_finite() && size[slot].is_finite() => wide / ulp_at(size[slot].max(usual)),
        _ => f64::INFINITY,
    };
    if let Some(widest) = all.slots().max_by(|&a, &b| in_ulp(a).total_cmp(&in_ulp(b)).then(b.cmp(&a)))
        && in_ulp(widest) > own.widest.as_ref().map_or(0.0, |(most, _)| *most)
    {
        own.widest = Some((in_ulp(widest), Sample::of(batch, first + widest)));
    }
    found
}

impl Counted {
    fn new(name: &str, words: Range<usize>, sizes: &[f64]) -> Self {
        let bits = OutputBits {
            name: name.to_owned(),
            fixed: 0,
            pinned: 0,
            edges: 0,
            free: 0,
            unknown: 0,
            places: Vec::new(),
            spread: None,
            apart: Vec::new(),
        };
        let usual = sizes[words.clone()].iter().copied().fold(0.0, f64::max);
        Self { words, usual, places: BTreeMap::new(), widest: None, bits }
    }

    /// Counts slots; gives those in which nothing is free.
    fn count(&mut self, found: &[Freed], all: Mask, unknown: Mask) -> Mask {
        let mut places: BTreeMap<(Freedom, Option<usize>), (Option<Site>, Mask)> = BTreeMap::new();
        let [mut pinned, mut edges, mut free] = [Mask::NONE; 3];
        for Freed { freedom, site, slots } in found {
            let kind = match freedom {
                Freedom::Contraction | Freedom::Order => &mut pinned,
                Freedom::Subnormal | Freedom::NotFinite => &mut edges,
                Freedom::Inside | Freedom::Function(_) | Freedom::Decision => &mut free,
            };
            *kind = kind.or(*slots);
            let place = places.entry((*freedom, site.map(Site::index))).or_insert((*site, Mask::NONE));
            place.1 = place.1.or(*slots);
        }
        for (key, (site, slots)) in places {
            self.places.entry(key).or_insert((site, 0)).1 += slots.count() as u64;
        }
        let free = free.and(all);
        let unknown = unknown.and(all).minus(free);
        let pinned = pinned.and(all).minus(free).minus(unknown);
        let edges = edges.and(all).minus(free).minus(unknown).minus(pinned);
        let fixed = all.minus(free).minus(unknown).minus(pinned).minus(edges);
        let bits = &mut self.bits;
        for (count, slots) in [
            (&mut bits.fixed, fixed),
            (&mut bits.pinned, pinned),
            (&mut bits.edges, edges),
            (&mut bits.free, free),
            (&mut bits.unknown, unknown),
        ] {
            *count += slots.count() as u64;
        }
        fixed
    }

    fn finish(self, ready: &Ready, apart: Vec<Apart>) -> OutputBits {
        let mut places: Vec<FreePlace> = self
            .places
            .into_iter()
            .map(|((freedom, _), (site, samples))| FreePlace {
                freedom,
                place: place(&ready.program, &ready.executable, site),
                samples,
            })
            .collect();
        let at = |one: &FreePlace| one.place.as_ref().and_then(|place| place.at.position);
        places.sort_by(|a, b| b.samples.cmp(&a.samples).then_with(|| at(a).cmp(&at(b))));
        let spread = self.widest.map(|(ulp, sample)| (ulp, InputValue::all(&sample, &ready.program)));
        OutputBits { places, spread, apart, ..self.bits }
    }
}
