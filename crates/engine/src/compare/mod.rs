//! Two functions of one signature beside each other, in whatever languages they are written.
//!
//! ```text
//! samples ─┬─ meaning of the first ─────┬─ equal in real numbers, or the smallest input and both values
//!          ├─ meaning of the second ────┘
//!          ├─ bounds of both by a profile ── which one a device computes more accurately, and where
//!          └─ lanes run both ─────────────── bits that are alike, and the largest distance
//! ```

mod accuracy;
mod curve;
mod meaning;
mod on_lanes;
mod pairing;
mod resolution;
mod same_bits;

use serde::{Deserialize, Serialize};

use crate::activity;
use crate::fuzz::{Domain, PILOT, Ready, Subject, drawn, given, stream_key};
use base::value::Batch;
use judge::profile::Profile;
use judge::verdict::{ENDLESS, Oracle, Reason, Reference, Rounds};
use lanes::{Lane, interrupt};
use program::interp::Binary64;
use property::{Sample, regressions};

pub use accuracy::{Accuracy, Worst};
pub use curve::{Curve, Point};
pub use meaning::Unlike;
pub use on_lanes::OnLane;
pub use pairing::{Pairing, Unpaired, pairing};
pub use resolution::Resolution;
pub use same_bits::SameBits;

/// Samples of one batch.
const BATCH: usize = 1 << 14;

/// One sample of so many is of any size, whatever the inputs are taken for.
const ARBITRARY: u64 = 4;

/// Samples of a batch that are looked at though only one of the functions ends.
const ONE_SIDED: usize = 8;

/// What a comparison is asked for.
#[derive(Clone, Debug)]
pub struct Request<'p> {
    /// Samples of each pair of functions.
    pub samples: u64,
    /// Seed of the inputs.
    pub seed: u64,
    /// Inputs that are compared alone, as `name=words` parts.
    pub case: Option<String>,
    /// What bounds are derived from: at least one.
    pub profiles: Vec<&'p Profile>,
    /// The command line up to the function, for reproduction.
    pub command: String,
    /// Whether both are followed over their inputs, for charts.
    pub curves: bool,
    /// Whether it is asked if both have the same bits on every conforming device.
    pub same_bits: bool,
}

/// What came of a pair of functions.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Compared {
    /// Names of the two.
    pub functions: [String; 2],
    /// `name:line:column` of each.
    pub at: [String; 2],
    /// Why they are not compared.
    pub not_compared: Option<String>,
    /// Outputs that one of the two has alone.
    pub alone: Vec<String>,
    /// Samples that were compared.
    pub samples: u64,
    /// Samples that mean the same in both.
    pub equal: u64,
    /// Samples about which nothing can be said, by reason.
    pub undetermined: Vec<(Reason, u64)>,
    /// Samples that mean something else; the first number is of all of them, the second of those whose difference is larger
    /// than a device of the first profile may be off in either.
    pub unlike: (u64, u64),
    /// How many of the samples that mean something else have outputs for which nothing bounds a device.
    pub unbounded: u64,
    /// The smallest input of these.
    pub smallest: Option<Unlike>,
    /// Bounds of the two, by profile.
    pub accuracy: Vec<Accuracy>,
    /// For functions of one number: how finely neighbouring inputs are told apart.
    pub resolution: Option<[Resolution; 2]>,
    /// Outputs of lanes.
    pub lanes: Vec<OnLane>,
    /// For each output that both have, whether its bits are the same on every conforming device, where that was asked for.
    #[serde(default)]
    pub same_bits: Vec<SameBits>,
    /// Both over components of their inputs, where that was asked for: of a whole run alone.
    #[serde(skip)]
    pub curves: Vec<Curve>,
}

impl Compared {
    /// True when something is known of the two: some sample means the same in both, or something else.
    pub fn is_known(&self) -> bool {
        self.equal + self.unlike.0 > 0
    }

    /// Why little is known of two functions between which no difference was found: what leaves most samples undetermined,
    /// where that is more than half of them.
    pub fn weak(&self) -> Option<Reason> {
        let open: u64 = self.undetermined.iter().map(|(_, count)| count).sum();
        let (most, _) = self.undetermined.iter().max_by_key(|(_, count)| *count)?;
        (self.unlike.0 == 0 && open > self.equal).then_some(*most)
    }
}

/// Two programs, bound to each other.
struct ReadyPair<'a> {
    sides: [&'a Ready; 2],
    oracles: [Oracle; 2],
    /// What the second means, expected of the first.
    reference: Reference,
    /// The same the other way round, where the second has no input of its own.
    reverse: Option<Reference>,
}

/// Compares two functions on inputs of the first.
///
/// # Errors
/// What is wrong with the case that was asked for.
pub fn run(
    subjects: [&Subject; 2],
    domain: &Domain,
    lanes: &[&dyn Lane],
    request: &Request<'_>,
) -> Result<Compared, String> {
    let mut compared = Compared {
        functions: subjects.map(|subject| subject.label.clone()),
        at: subjects.map(|subject| subject.at.clone()),
        not_compared: None,
        alone: Vec::new(),
        samples: 0,
        equal: 0,
        undetermined: Vec::new(),
        unlike: (0, 0),
        unbounded: 0,
        smallest: None,
        accuracy: Vec::new(),
        resolution: None,
        lanes: Vec::new(),
        same_bits: Vec::new(),
        curves: Vec::new(),
    };
    let pair = match bind(subjects) {
        Ok(pair) => pair,
        Err(why) => {
            compared.not_compared = Some(why);
            return Ok(compared);
        }
    };
    let _doing = activity::doing(format!("compares `{}`", subjects[0].label));
    compared.alone = alone(&pair);
    let ready = pair.sides[0];
    let case = request.case.as_ref().map(|text| given(ready, text)).transpose()?;
    let constant = ready.kernel.invocation.words() + ready.kernel.case.words() == 0;
    let samples = if case.is_some() || constant { 1 } else { request.samples };
    let arbitrary = if case.is_some() || constant || domain.is_stated() { 0 } else { samples / ARBITRARY };
    let key = stream_key(request.seed, &subjects[0].label);
    let mut meaning = meaning::Meanings::default();
    let mut accuracy: Vec<_> = request.profiles.iter().map(|profile| accuracy::Gauge::new(&pair, profile)).collect();
    let mut on: Vec<_> =
        lanes.iter().map(|lane| on_lanes::Both::new(*lane, &pair, BATCH.min(samples as usize))).collect();
    let pilot = || drawn(ready, domain, key, (0, PILOT), !domain.is_stated());
    let mut bits = request.same_bits.then(|| same_bits::Bits::new(&pair, request.profiles[0], &pilot()));
    for (realistic, count) in [(true, samples - arbitrary), (false, arbitrary)] {
        let mut first = 0;
        while first < count && !interrupt::asked() {
            let some = (count - first).min(BATCH as u64) as usize;
            let batch = match &case {
                Some(sample) => Sample::batch(std::slice::from_ref(sample)),
                None => drawn(ready, domain, key, (first, some), realistic && !domain.is_stated()),
            };
            let (batch, ending, left_out) = pair.that_end(batch);
            let fed = pair.fed(&batch);
            let differing = meaning.see((&pair, request.profiles[0]), &batch, &fed, realistic);
            // What was under way when the run was to end is not counted.
            let Some(differing) = differing else { break };
            meaning.leave_open(Reason::LongLoop, left_out);
            // What does not end in one of the two would hold a lane up.
            let (batch, fed) = match ending < batch.invocation_count() {
                true => (batch.apart(0..ending), fed.apart(0..ending)),
                false => (batch, fed),
            };
            // Of inputs that may never come, extremes say little.
            if realistic {
                accuracy.iter_mut().for_each(|gauge| gauge.see(&batch, &fed));
                on.iter_mut().for_each(|both| both.see(&batch, &fed, &differing));
                bits.iter_mut().for_each(|bits| bits.see(&batch, &fed));
            }
            first += some as u64;
            compared.samples += some as u64;
        }
    }
    let names = compared.functions.clone();
    let reproduce = |sample: &Sample| {
        let function = if names[0] == names[1] { names[0].clone() } else { format!("{}={}", names[0], names[1]) };
        let function = if function.contains(['(', ' ']) { format!("'{function}'") } else { function };
        let inputs = regressions::inputs_text(sample);
        format!("{} --function {function} --seed {} --case '{inputs}'", request.command, request.seed)
    };
    let smallest = meaning.finish((&pair, request.profiles[0]), domain, &reproduce, &mut compared);
    if request.curves && !interrupt::asked() {
        let around = smallest.or_else(|| accuracy.iter_mut().find_map(accuracy::Gauge::widest));
        let around = around.or_else(|| Some(Sample::of(&drawn(ready, domain, key, (0, 1), true), 0)));
        let profile = request.profiles[0];
        compared.curves = around.map_or_else(Vec::new, |at| curve::curves(&pair, profile, domain, key, &at));
    }
    compared.accuracy = accuracy.into_iter().map(accuracy::Gauge::finish).collect();
    compared.resolution = if case.is_none() && !interrupt::asked() { resolution::of(&pair, domain, key) } else { None };
    compared.same_bits = bits.map_or_else(Vec::new, |bits| bits.finish(&reproduce));
    compared.lanes = on.into_iter().map(on_lanes::Both::finish).collect();
    Ok(compared)
}

fn bind(subjects: [&Subject; 2]) -> Result<ReadyPair<'_>, String> {
    let ready = |subject: &'_ Subject| match &subject.ready {
        Ok(_) => Ok(()),
        Err(why) => Err(format!("{} cannot be run: {why}", subject.at)),
    };
    subjects.into_iter().try_for_each(ready)?;
    let [Ok(a), Ok(b)] = subjects.map(|subject| subject.ready.as_ref()) else { return Err("cannot be run".to_owned()) };
    let by = |of: &Subject| format!("`{}` at {}", of.label, of.at);
    let bound =
        |one: &Ready, other: &Ready, of: &Subject| Reference::model(&other.program, &by(of), None, &one.program);
    let reference = bound(a, b, subjects[1]).map_err(|error| error.to_string())?;
    let reverse = bound(b, a, subjects[0]).ok().map(|reverse| reverse.with_fuel(ENDLESS));
    let oracle = |ready: &Ready| match Oracle::new(&ready.program) {
        Ok(oracle) => Ok(oracle.with_fuel(ENDLESS)),
        Err(error) => Err(error.locate(&ready.program)),
    };
    let reference = reference.with_fuel(ENDLESS);
    Ok(ReadyPair { sides: [a, b], oracles: [oracle(a)?, oracle(b)?], reference, reverse })
}

/// Outputs that only one of the two has.
fn alone(pair: &ReadyPair<'_>) -> Vec<String> {
    let pairs = pair.reference.pairs();
    let of = |side: usize, used: &dyn Fn(usize) -> bool| -> Vec<String> {
        let record = &pair.sides[side].kernel.output.vertex;
        let fields = record.fields().iter().enumerate();
        let rest = fields.filter(|(k, _)| !used(record.range(*k).start));
        rest.map(|(_, field)| format!("`{}`", field.name)).collect()
    };
    let first = of(0, &|word| pairs.iter().any(|(own, _)| own.start == word));
    [first, of(1, &|word| pairs.iter().any(|(_, other)| other.start == word))].concat()
}

impl ReadyPair<'_> {
    /// The samples of which something can be said, and how many are left out: those that go on for too long in either
    /// function. Where one function ends soon and the other does not end, they do not mean the same; some of these stay, behind
    /// those that end in both, whose number comes second.
    fn that_end(&self, batch: Batch) -> (Batch, usize, u64) {
        if !self.sides.iter().any(|ready| ready.executable.has_loops()) {
            let ending = batch.invocation_count();
            return (batch, ending, 0);
        }
        let fed = self.fed(&batch);
        let of = |side: usize, batch| Rounds::of::<Binary64>(&self.sides[side].executable, batch);
        let (first, second) = (of(0, &batch), of(1, &fed));
        let all: Vec<Rounds> = first.iter().zip(&second).map(|(first, second)| *first.max(second)).collect();
        let mut order = Rounds::order(&all);
        let ending = order.len();
        let one_ends = |k: &usize| all[*k] == Rounds::Endless && first[*k].min(second[*k]) <= Rounds::Some;
        order.extend((0..all.len()).filter(one_ends).take(ONE_SIDED));
        let left_out = (all.len() - order.len()) as u64;
        (batch.apart(order.into_iter()), ending, left_out)
    }

    /// The samples as the second function gets them.
    fn fed(&self, batch: &Batch) -> Batch {
        let all: Vec<usize> = (0..batch.invocation_count()).collect();
        self.reference.fed(batch, &all).expect("the reference is another program")
    }
}
