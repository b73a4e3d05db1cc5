//! A test on lanes and in real numbers.

use base::text::Span;
use base::value::Batch;
use judge::profile::Profile;
use judge::trace::{self, TracedReal, TracedValue};
use lanes::{Lane, LaneError, LaneName, Stage, embedded};
use program::Probed;
use program::probe::MAX_WORDS;
use property::Sample;

use super::mark::{OWN, WANTED};
use super::record::{MOST, Places};
use super::verdict::{Expectation, Found, Kind};
use crate::fuzz::Ready;

/// How tests are run.
pub struct Request<'a> {
    /// Lanes besides the interpreter in strict binary32, which runs every test.
    pub lanes: &'a [&'a dyn Lane],
    /// All of them, and not the first that can run a test.
    pub all_lanes: bool,
    /// What bounds are derived from.
    pub profile: &'a Profile,
    /// The calls of assertions in the author's file.
    pub sites: &'a [Span],
}

/// What came of a test.
#[derive(Clone, Debug)]
pub struct Ran {
    /// What it expects, in the order in which it does.
    pub expectations: Vec<Expectation>,
    /// Lanes that did not run it, and why.
    pub not_run: Vec<(LaneName, String)>,
}

/// Runs a test.
///
/// # Errors
/// Why it cannot be run, in a sentence without a full stop.
pub fn run(ready: &Ready, request: &Request<'_>) -> Result<Ran, String> {
    // Variables that the assertions of GLSL write to count as inputs, and begin as zero.
    let (invocation, case) = (&ready.kernel.invocation, &ready.kernel.case);
    let mut inputs = invocation.fields().iter().chain(case.fields());
    if let Some(input) = inputs.find(|input| !input.name.starts_with(OWN)) {
        return Err(format!("it reads `{}`, which only a host can give", input.name));
    }
    if let Some(texture) = ready.program.textures.first() {
        return Err(format!("it reads the texture `{}`, which only a host can give", texture.name));
    }
    let places = Places::of(&ready.program.output_layout().vertex);
    let places = places.ok_or("internal error, please report: what it expects got lost")?;
    let sample = |wanted: usize| sample(ready, wanted);
    let probed = ready.program.probed(MAX_WORDS).map_err(|error| error.to_string())?;
    let mut all: Vec<TracedTest> = Vec::new();
    let count = loop {
        let one = traced(ready, &probed, request.profile, &Sample::batch(&[sample(all.len())]))?;
        let count = one.strict()[places.count] as usize;
        if one.endless {
            return Err("a loop goes on for too long".to_owned());
        }
        if count > MOST {
            return Err(format!("it expects {count} things; {MOST} at most are judged: divide it"));
        }
        all.push(one);
        if all.len() >= count {
            break count;
        }
    };
    let batch = Sample::batch(&(0..count.max(1)).map(sample).collect::<Vec<_>>());
    let mut not_run = Vec::new();
    let strict: Vec<Vec<u32>> = all.iter().map(TracedTest::strict).collect();
    let mut ran: Vec<(LaneName, Vec<Vec<u32>>)> = vec![(embedded::STRICT, strict)];
    for lane in request.lanes.iter().filter(|lane| lane.description().name != embedded::STRICT) {
        let name = lane.description().name;
        match on_lane(*lane, ready, &batch) {
            Ok(words) => ran.push((name, words)),
            Err(why) => not_run.push((name, why)),
        }
        if ran.len() > 1 && !request.all_lanes {
            break;
        }
    }
    let one = |k: usize| {
        let strict = &ran[0].1[k];
        let width = (strict[places.width] as usize).min(4);
        // A device that decides otherwise on the way may expect more or less.
        let same = |words: &[u32]| {
            let alike = [places.kind, places.site, places.width].iter().all(|&at| words[at] == strict[at]);
            alike && k < words[places.count] as usize
        };
        let lanes = ran.iter().filter(|(_, all)| same(&all[k]));
        let lanes = lanes.map(|(lane, all)| (*lane, found(&all[k], &places, width))).collect();
        let part = |first: usize, c: usize| all[k].real(first + c);
        let real = (0..width).map(|c| (part(places.actual, c), part(places.expected, c))).collect();
        let site = (strict[places.site] as usize).checked_sub(1).and_then(|site| request.sites.get(site).copied());
        Expectation::judged((site, kind(strict, &places)), lanes, real, all[k].forked)
    };
    Ok(Ran { expectations: (0..count).map(one).collect(), not_run })
}

/// The inputs with which a test runs once.
pub fn batch(ready: &Ready) -> Batch {
    Sample::batch(&[sample(ready, 0)])
}

/// The inputs of a test that writes down one of its expectations.
pub(super) fn sample(ready: &Ready, wanted: usize) -> Sample {
    let (invocation, case) = (&ready.kernel.invocation, &ready.kernel.case);
    let (mut words, of_case) = (vec![0; invocation.words()], vec![0; case.words()]);
    let at = invocation.index_of(WANTED).map(|field| invocation.range(field).start);
    at.into_iter().for_each(|at| words[at] = wanted as u32);
    Sample { invocation_record: invocation.clone(), case_record: case.clone(), invocation: words, case: of_case }
}

/// The output words of a test in binary32 and in real numbers.
struct TracedTest {
    values: Vec<TracedValue>,
    forked: bool,
    endless: bool,
}

impl TracedTest {
    fn strict(&self) -> Vec<u32> {
        self.values.iter().map(|value| value.binary32).collect()
    }

    /// A word in real numbers; one that has none is as binary32 has it.
    fn real(&self, word: usize) -> TracedReal {
        let value = &self.values[word];
        let exact = || TracedReal { value: f64::from(f32::from_bits(value.binary32)), bound: 0.0 };
        value.real.unwrap_or_else(exact)
    }
}

fn traced(ready: &Ready, probed: &Probed, profile: &Profile, batch: &Batch) -> Result<TracedTest, String> {
    let (own, layout) = (ready.program.output_layout().vertex, probed.program.output_layout().vertex);
    let words: Vec<usize> = (0..own.fields().len()).flat_map(|k| layout.range(k)).collect();
    let traced = trace::trace(probed, (profile, Stage::Compute), &words, batch).map_err(|error| error.to_string())?;
    Ok(TracedTest { values: traced.outputs, forked: traced.forked, endless: traced.endless })
}

/// The output words for each expectation.
fn on_lane(lane: &dyn Lane, ready: &Ready, batch: &Batch) -> Result<Vec<Vec<u32>>, String> {
    let stage = crate::fuzz::stage_of(lane, &ready.program);
    let kernel = crate::fuzz::kernel(&ready.program, stage).map_err(|error| error.to_string())?;
    let told = |error: LaneError| error.to_string();
    let count = batch.invocation_count();
    let actual = lane.prepare(&kernel, count).map_err(told)?.run(batch).map_err(told)?;
    Ok((0..count).map(|k| actual.vertex(k, 0).to_vec()).collect())
}

pub(super) fn found(words: &[u32], place: &Places, width: usize) -> Found {
    let floats = |at: usize| words[at..at + width].iter().map(|&bits| f32::from_bits(bits)).collect();
    Found {
        actual: floats(place.actual),
        expected: floats(place.expected),
        words: [words[place.words], words[place.words + 1]],
    }
}

pub(super) fn kind(words: &[u32], place: &Places) -> Kind {
    let tolerance = |k: usize| f64::from(f32::from_bits(words[place.tolerance + k]));
    match words[place.kind] {
        1 => Kind::Condition,
        2 => Kind::Equal,
        3 => Kind::Near { relative: tolerance(0), absolute: tolerance(1) },
        _ => Kind::Ulp(tolerance(0)),
    }
}
