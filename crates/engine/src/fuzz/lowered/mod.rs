//! What `mediump` and `lowp` do to a function: it is run on the least device that GLSL ES allows, 11 bits and a range of
//! 2^14, beside strict binary32.
//!
//! A phone may compute so, and a desktop never does. What overflows there, is taken for 0, or lacks the digits that an
//! operation needs is told where the outputs show it.

mod beside;
#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::convert::Infallible;

use rayon::prelude::*;

use super::domain::{Domain, Shrinking, Within};
use super::finding::{Finding, FuzzFindingKind, Part, Severity};
use super::name::{decimal, place};
use super::scan::{Look, ROUNDS};
use super::subject::Ready;
use crate::InputValue;
use crate::activity::shrink;
use base::value::{Batch, Scalar};
use beside::LARGEST;
pub(crate) use beside::{Beside, Event, Harm, Narrowing};
use lanes::interrupt;
use program::interp::{Binary32, Executable, Machine, OutputColumn, SLOTS};
use property::Sample;
use syntax::Stage;

/// Part of an output's size by which it may differ: what is seen of a colour, and more than 11 bits give rise to.
const LIMIT: f64 = 1.0 / 16.0;
/// One sample of so many has to lose digits before it is told, where inputs are stated and where they are not: beside a
/// jump some always do.
const MANY: [u64; 2] = [512, 64];
/// Places that are told for one function.
const REPORTED: usize = 4;

/// What lower precision did to one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Harmed {
    harm: Harm,
    event: Event,
    /// The output word: vertex and word.
    place: (usize, usize),
    wide: f32,
    lowered: f32,
}

impl Harmed {
    fn key(&self) -> (Harm, usize) {
        (self.harm, self.event.site.index())
    }

    /// Some value is not a number any more, or infinite.
    fn is_lost(&self) -> bool {
        !self.lowered.is_finite()
    }
}

struct HarmGroup {
    count: u64,
    lost: bool,
    sample: Sample,
    harmed: Harmed,
}

/// A function at its lower precision.
pub struct Lowered<'a> {
    ready: &'a Ready,
    executable: &'a Executable,
    looked: u64,
    groups: HashMap<(Harm, usize), HarmGroup>,
    /// What inputs are taken for beyond what is usual.
    far: &'a [String],
}

impl<'a> Lowered<'a> {
    /// None for a function in which nothing is lower.
    pub fn new(ready: &'a Ready) -> Option<Self> {
        let executable = ready.lowered.as_ref()?;
        Some(Self { ready, executable, looked: 0, groups: HashMap::new(), far: &[] })
    }

    /// The same for inputs that go as far as `far` says.
    pub fn far(ready: &'a Ready, far: &'a [String]) -> Option<Self> {
        Some(Self { far, ..Self::new(ready)? })
    }

    /// Leaves out what another look tells, where nothing is stated.
    pub fn leave_out(&mut self, other: &Self) {
        let told = |key: &(Harm, usize), lost: bool| {
            other.groups.get(key).is_some_and(|known| {
                let many = known.count * MANY[1] >= other.looked.max(1);
                // What is lost only far out is more than a loss of digits.
                known.lost || many && !lost
            })
        };
        self.groups.retain(|key, group| !told(key, group.lost));
    }

    /// Looks at the samples of a batch that are in no trouble in binary32.
    pub fn look(&mut self, batch: &Batch, looks: &[Look]) {
        let fine: Vec<usize> = looks
            .iter()
            .enumerate()
            .filter(|(_, look)| look.trouble.is_none() && !look.undefined && look.rounds.end())
            .map(|(invocation, _)| invocation)
            .collect();
        self.looked += fine.len() as u64;
        for (invocation, harmed) in fine.iter().zip(harmed(self.ready, self.executable, batch, &fine)) {
            let Some(harmed) = harmed else { continue };
            let group = self.groups.entry(harmed.key()).or_insert_with(|| HarmGroup {
                count: 0,
                lost: false,
                sample: Sample::of(batch, *invocation),
                harmed,
            });
            group.count += 1;
            if harmed.is_lost() && !group.lost {
                (group.lost, group.harmed, group.sample) = (true, harmed, Sample::of(batch, *invocation));
            }
        }
    }

    /// What was found, each with the smallest inputs that show it.
    pub fn findings(
        self,
        domain: &Domain,
        within: Within<'_>,
        part: Part,
        reproduce: &dyn Fn(&Sample) -> String,
    ) -> Vec<Finding> {
        let Self { ready, executable, looked, groups, far } = self;
        let stated = domain.invocation.iter().chain(&domain.case).any(super::domain::InputDomain::is_stated);
        let many = MANY[usize::from(!stated)];
        let mut groups: Vec<HarmGroup> =
            groups.into_values().filter(|group| group.lost || group.count * many >= looked.max(1)).collect();
        groups.sort_by_key(|group| {
            (!group.lost, group.harmed.harm, std::cmp::Reverse(group.count), group.harmed.event.site.index())
        });
        groups.truncate(REPORTED);
        let one = |group: HarmGroup| {
            let key = group.harmed.key();
            let admits = Shrinking { domain, within };
            let same = |h: &Option<Harmed>| h.is_some_and(|h| h.key() == key && h.is_lost() == group.lost);
            let look = |samples: &[Sample]| {
                let batch = Sample::batch(samples);
                harmed(ready, executable, &batch, &(0..samples.len()).collect::<Vec<_>>())
            };
            let mut oracle = |samples: &[Sample]| -> Result<Vec<bool>, Infallible> {
                Ok(if interrupt::asked() { Vec::new() } else { look(samples).iter().map(same).collect() })
            };
            let shrunk = match shrink(vec![group.sample.clone()], &admits, &mut oracle) {
                Ok(shrunk) => shrunk.into_iter().next().map(|s| s.sample),
                Err(never) => match never {},
            };
            let sample = shrunk.unwrap_or_else(|| group.sample.clone());
            let harmed = look(std::slice::from_ref(&sample)).pop().flatten().unwrap_or(group.harmed);
            let (_, word) = harmed.place;
            let output = ready.kernel.output.vertex.word_name(word);
            Finding {
                kind: kind(harmed.harm),
                severity: if stated { Severity::Finding } else { Severity::Warning },
                part,
                cause: Some(kind(harmed.harm).name().replace('_', " ")),
                message: match far {
                    [] => message(&harmed, &output),
                    far => format!("{} (taken: {})", message(&harmed, &output), far.join(", ")),
                },
                place: place(&ready.program, executable, Some(harmed.event.site)),
                lane: None,
                count: group.count,
                counting: group.count,
                inputs: InputValue::all(&sample, &ready.program),
                output: Some(output),
                meaning: Some(f64::from(harmed.wide)),
                found: Some(harmed.lowered.to_bits()),
                scalar: Scalar::F32,
                condition: None,
                worst: None,
                also: Vec::new(),
                diagnosis: None,
                reproduce: Some(reproduce(&sample)),
                own_translator: false,
                better: None,
            }
        };
        groups.into_iter().map(one).collect()
    }
}

fn kind(harm: Harm) -> FuzzFindingKind {
    match harm {
        Harm::Overflow => FuzzFindingKind::MediumpOverflow,
        Harm::Underflow => FuzzFindingKind::MediumpUnderflow,
        Harm::Digits => FuzzFindingKind::MediumpDigits,
    }
}

fn shown(x: f32) -> String {
    if x.is_nan() { "nan".to_owned() } else { format!("{x:?}") }
}

fn message(harmed: &Harmed, output: &str) -> String {
    let Harmed { event, wide, lowered, .. } = harmed;
    let (op, value) = (event.op, shown(event.value));
    let shows = format!("`{output}` is {}, and {} on such a device", shown(*wide), shown(*lowered));
    match harmed.harm {
        Harm::Overflow => format!(
            "overflow at `mediump`: {op} is {value}, and GLSL ES promises numbers up to {LARGEST} (binary16 has them up to \
             65504); {shows}; declare `highp` what it is computed from, or scale it first"
        ),
        Harm::Underflow => format!(
            "underflow at `mediump`: {value} may be taken for 0 by {op}, for the least number that GLSL ES promises is \
             6.1e-5; {shows}; take a larger number, 0.001 beside numbers near 1, or declare it `highp`"
        ),
        Harm::Digits => {
            let step = 2f64.powf(f64::from(event.argument.max(1e-30)).log2().floor() - 10.0);
            format!(
                "digits are lost at `mediump`: numbers as large as {} are {} apart there, and {op} is {value} in binary32 \
                 and {}; {shows}; declare `highp` what it is computed from",
                shown(event.argument),
                decimal(step),
                shown(event.lowered)
            )
        }
    }
}

/// What lower precision does to samples; `None` where the outputs are near to those of binary32.
fn harmed(ready: &Ready, executable: &Executable, batch: &Batch, invocations: &[usize]) -> Vec<Option<Harmed>> {
    let chunks: Vec<Vec<Option<Harmed>>> = invocations
        .par_chunks(SLOTS)
        .map_init(
            || {
                let lowered = Machine::new(executable, Beside::default(), ROUNDS);
                (lowered, Machine::new(&ready.executable, Binary32::default(), ROUNDS))
            },
            |(lowered, wide), chunk| {
                if interrupt::asked() {
                    return vec![None; chunk.len()];
                }
                chunk_of(ready, lowered, wide, batch, chunk)
            },
        )
        .collect();
    chunks.into_iter().flatten().collect()
}

/// An error with the vertex and word where it is, and both values there.
type Worst = (f64, (usize, usize), f32, f32);

fn chunk_of(
    ready: &Ready,
    lowered: &mut Machine<'_, Beside>,
    wide: &mut Machine<'_, Binary32>,
    batch: &Batch,
    invocations: &[usize],
) -> Vec<Option<Harmed>> {
    lowered.run_some(batch, invocations);
    wide.run_some(batch, invocations);
    lowered.take_findings();
    wide.take_findings();
    // Colours are seen beside white, whatever they are.
    let floor = if ready.program.stage == Stage::Fragment { 1.0 } else { LIMIT };
    let record = &ready.kernel.output.vertex;
    let mut worst: Vec<Option<Worst>> = vec![None; invocations.len()];
    for vertex in 0..wide.room() {
        for field in 0..record.fields().len() {
            let range = record.range(field);
            let mut scale = [floor; SLOTS];
            for word in range.clone() {
                if let OutputColumn::Real(column) = wide.output(vertex, word) {
                    scale.iter_mut().zip(column.values()).for_each(|(s, v)| *s = s.max(f64::from(v.abs())));
                }
            }
            for word in range {
                let (OutputColumn::Real(a), OutputColumn::Real(b)) =
                    (wide.output(vertex, word), lowered.output(vertex, word))
                else {
                    continue;
                };
                for (slot, worst) in worst.iter_mut().enumerate() {
                    let (a, b) = (a.values()[slot], b.lowered()[slot]);
                    if !a.is_finite() || wide.is_emitting() && vertex as u32 >= wide.emitted()[slot] {
                        continue;
                    }
                    let error = match b.is_finite() {
                        true => (f64::from(b) - f64::from(a)).abs() / scale[slot],
                        false => f64::INFINITY,
                    };
                    if error > worst.map_or(LIMIT, |(error, ..)| error) {
                        *worst = Some((error, (vertex, word), a, b));
                    }
                }
            }
        }
    }
    let domain = lowered.as_domain();
    let name = |(slot, worst): (usize, Option<Worst>)| {
        let (error, place, wide, lowered) = worst?;
        let order = match error.is_infinite() {
            true => [Harm::Overflow, Harm::Underflow, Harm::Digits],
            false => [Harm::Overflow, Harm::Digits, Harm::Underflow],
        };
        let (harm, event) = order.into_iter().find_map(|harm| Some((harm, domain.event(harm, slot)?)))?;
        Some(Harmed { harm, event, place, wide, lowered })
    };
    worst.into_iter().enumerate().map(name).collect()
}
