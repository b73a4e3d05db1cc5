//! Points of an expression: the values of its leaves in samples of its function.

use serde::{Deserialize, Serialize};

use std::ops::Range;

use super::lower::{Drawn, Leaf};
use crate::fuzz::{Domain, InputDomain, Interval, Law, Ready, drawn};
use ::improve::{Points, Term};
use base::value::{Batch, Record, Scalar};
use property::{Stream, mix};

/// Points at which an input is 0, at one of its ends, or 1.
const SPECIAL: usize = 512;

/// What values that are not known are taken from.
const UNKNOWN: [f32; 2] = [-2.0, 2.0];
const TEXEL: [f32; 2] = [0.0, 1.0];

/// What a direction is taken for where nothing is stated.
const DIRECTION: &str = "a direction";

/// What a leaf is: a word of a record, a number of which nothing is known, or one that follows from others.
#[derive(Clone, Debug)]
enum PointSource {
    Word {
        of_case: bool,
        word: usize,
        field: usize,
    },
    /// With a key of its own, so that it is the same wherever the text stands.
    Any([f32; 2], u64),
    Drawn {
        terms: Vec<Term>,
        sources: Vec<PointSource>,
        from: String,
    },
}

pub(super) struct Drawer<'a> {
    ready: &'a Ready,
    domain: &'a Domain,
    key: u64,
    sources: Vec<PointSource>,
}

/// An input of an expression, as it is told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InputRange {
    /// Its text.
    pub name: String,
    /// The smallest and the largest value in the samples.
    #[serde(with = "crate::bits")]
    pub range: [f32; 2],
    /// Where the range comes from: nothing where it is stated.
    pub taken_for: Option<String>,
}

impl<'a> Drawer<'a> {
    /// # Errors
    /// Where a stated range of an input has no end.
    pub(super) fn new(ready: &'a Ready, domain: &'a Domain, key: u64, leaves: &[Leaf]) -> Result<Self, String> {
        let sources: Vec<PointSource> = leaves.iter().map(|leaf| source(ready, leaf)).collect();
        let drawer = Self { ready, domain, key, sources };
        drawer.ends(&drawer.sources, leaves)?;
        Ok(drawer)
    }

    fn ends(&self, sources: &[PointSource], leaves: &[Leaf]) -> Result<(), String> {
        for (source, leaf) in sources.iter().zip(leaves) {
            if let (PointSource::Drawn { sources, .. }, Some(drawn)) = (source, &leaf.drawn) {
                self.ends(sources, &drawn.leaves)?;
            }
            let Some(interval) = self.stated(source).and_then(InputDomain::interval) else { continue };
            if !interval.low.is_finite() || !interval.high.is_finite() {
                let law = Law::Within(interval);
                return Err(format!(
                    "`{}` {law}: a range without an end says nothing about what is lost; state both, such as `--domain '{}=[0.001,1000]'`",
                    leaf.text, leaf.text
                ));
            }
        }
        Ok(())
    }

    fn stated(&self, source: &PointSource) -> Option<&InputDomain> {
        let PointSource::Word { of_case, field, .. } = source else { return None };
        let side = if *of_case { &self.domain.case } else { &self.domain.invocation };
        side.get(*field).filter(|input| input.is_stated())
    }

    /// Samples of the function from number `first` on.
    pub(super) fn batch(&self, first: u64, count: usize) -> Batch {
        drawn(self.ready, self.domain, self.key, (first, count), !self.domain.is_stated())
    }

    /// Points of samples from number `first` on.
    pub(super) fn draw(&self, first: u64, count: usize) -> Vec<Vec<f32>> {
        let batch = self.batch(first, count);
        let at = PointAt { batch: &batch, key: self.key, first };
        let columns: Vec<Vec<f32>> = self.sources.iter().map(|source| at.column(source)).collect();
        let points = (0..batch.invocation_count()).map(|k| columns.iter().map(|column| column[k]).collect());
        points.filter(|point: &Vec<f32>| point.iter().all(|x| x.is_finite())).collect()
    }

    /// Points at the ends of ranges, at 0 and at 1: one input there, or two.
    pub(super) fn special(&self) -> Vec<Vec<f32>> {
        let mut points = self.draw(1 << 40, SPECIAL);
        // What stands for each component of a vector in turn goes with the others.
        if self.sources.iter().any(|source| matches!(source, PointSource::Drawn { terms, .. } if terms.len() > 1)) {
            return points;
        }
        let ranges: Vec<[f32; 2]> = (0..self.sources.len()).map(|leaf| range(&points, leaf)).collect();
        let width = self.sources.len();
        for (k, point) in points.iter_mut().enumerate() {
            for leaf in [k % width, (k / width / 4) % width] {
                let [low, high] = ranges[leaf];
                let wanted = [0.0, low, high, 1.0][(k / width) % 4];
                if self.admits(leaf, wanted, [low, high]) {
                    point[leaf] = wanted;
                }
            }
        }
        points
    }

    fn admits(&self, leaf: usize, x: f32, [low, high]: [f32; 2]) -> bool {
        let source = &self.sources[leaf];
        let Some(input) = self.stated(source) else { return (low..=high).contains(&x) };
        // One component of a vector of length 1 has no value of its own.
        let lone = matches!(input.laws[..], [Law::Within(_)]);
        lone && input.interval().is_some_and(|interval: Interval| interval.contains(f64::from(x)))
    }

    /// What the inputs are, for reports.
    pub(super) fn inputs(&self, leaves: &[Leaf], points: &[Vec<f32>]) -> Vec<InputRange> {
        let taken = self.ready.realistic.taken_for(self.domain);
        let of = |(leaf, source): (usize, &PointSource)| {
            let taken_for = match source {
                PointSource::Any(..) => leaves[leaf].opaque.clone(),
                PointSource::Drawn { from, .. } => Some(from.clone()),
                PointSource::Word { of_case, field, .. } => {
                    let before = if *of_case { self.domain.invocation.len() } else { 0 };
                    taken.get(before + field).copied().flatten().map(str::to_owned)
                }
            };
            InputRange { name: leaves[leaf].text.clone(), range: range(points, leaf), taken_for }
        };
        self.sources.iter().enumerate().map(of).collect()
    }
}

/// The smallest and the largest value of a leaf.
fn range(points: &[Vec<f32>], leaf: usize) -> [f32; 2] {
    let values = || points.iter().map(|point| point[leaf]);
    [values().fold(f32::INFINITY, f32::min), values().fold(f32::NEG_INFINITY, f32::max)]
}

/// Samples, of which leaves take their values.
struct PointAt<'a> {
    batch: &'a Batch,
    key: u64,
    first: u64,
}

impl PointAt<'_> {
    /// The values of a leaf.
    fn column(&self, source: &PointSource) -> Vec<f32> {
        let count = self.batch.invocation_count();
        match source {
            PointSource::Word { of_case, word, .. } => {
                let bits = |k| if *of_case { self.batch.case_of(k) } else { self.batch.invocation(k) }[*word];
                (0..count).map(|k| f32::from_bits(bits(k))).collect()
            }
            PointSource::Any([low, high], own) => {
                let mut stream = Stream::new(mix(self.key ^ own, self.first));
                let mut part = || (stream.bits() >> 40) as f32 / (1u64 << 24) as f32;
                (0..count).map(|_| low + (high - low) * part()).collect()
            }
            PointSource::Drawn { terms, sources, .. } => {
                let points = Points::of_columns(sources.iter().map(|source| self.column(source)).collect());
                let columns: Vec<Vec<f32>> = terms.iter().map(|term| ::improve::run(term, &points)).collect();
                (0..count).map(|k| columns[k % columns.len()][k]).collect()
            }
        }
    }
}

/// Whether the text of an input is a vector of length 1.
pub(super) fn is_unit(ready: &Ready, domain: &Domain, text: &str) -> bool {
    let taken = ready.realistic.taken_for(domain);
    let kernel = &ready.kernel;
    let inputs = domain.invocation.iter().chain(&domain.case).zip(taken);
    let fields = kernel.invocation.fields().iter().chain(kernel.case.fields());
    let mut named = fields.zip(inputs).filter(|(field, _)| field.name == text);
    named.any(|(_, (input, taken))| input.has(Law::Normalised) || taken == Some(DIRECTION))
}

fn source(ready: &Ready, leaf: &Leaf) -> PointSource {
    if let Some(Drawn { terms, leaves }) = &leaf.drawn {
        let mut from: Vec<&str> = Vec::new();
        for leaf in leaves {
            let name = leaf.of.as_ref().map_or(leaf.text.as_str(), |of| of.vector.as_str());
            if !from.contains(&name) {
                from.push(name);
            }
        }
        let from = format!("what follows from {}", from.join(", "));
        let sources = leaves.iter().map(|leaf| source(ready, leaf)).collect();
        return PointSource::Drawn { terms: terms.clone(), sources, from };
    }
    let own = leaf.text.bytes().fold(0x1eaf_u64, |key, byte| mix(key, u64::from(byte)));
    if let Some(why) = &leaf.opaque {
        return PointSource::Any(if why.contains("texture") || why.contains("texel") { TEXEL } else { UNKNOWN }, own);
    }
    let find = |record: &Record, of_case: bool| {
        let all = record.fields().iter().enumerate();
        let found = all.filter(|(_, field)| field.shape.scalar == Scalar::F32).find_map(|(k, field)| {
            let rest = leaf.text.strip_prefix(&field.name)?;
            Some((k, component(rest, record.range(k))?))
        });
        found.map(|(field, word)| PointSource::Word { of_case, word, field })
    };
    let kernel = &ready.kernel;
    find(&kernel.invocation, false).or_else(|| find(&kernel.case, true)).unwrap_or(PointSource::Any(UNKNOWN, own))
}

/// The word that a text behind the name of a field means: nothing, a component, an index.
fn component(rest: &str, words: Range<usize>) -> Option<usize> {
    let at = match rest {
        "" => 0,
        _ => match rest.strip_prefix('.') {
            Some(name) if name.len() == 1 => ["xyzw", "rgba", "stpq"].iter().find_map(|set| set.find(name))?,
            _ => rest.strip_prefix('[')?.strip_suffix(']')?.parse().ok()?,
        },
    };
    (rest.is_empty() == (words.len() == 1) && at < words.len()).then_some(words.start + at)
}
