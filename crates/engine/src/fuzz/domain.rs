//! Which inputs a function takes: what its author or the command line states, and what stands in where
//! nothing is stated.

use serde::{Deserialize, Serialize};
use std::fmt;

use super::realistic::Realistic;
use base::value::{Field, Scalar};
use property::Sample;
use property::shrink;

/// Inputs beyond this size, and nearer to 0 than its inverse, are not moderate.
pub const MODERATE: f64 = 1024.0;

/// Numbers nearer to 0 than this part of their range are hardly meant: 2^-64.
const TINY: f64 = 1.0 / (1_u128 << 64) as f64;

/// How far the length of a normalised vector may be from 1, and the columns of a rotation from
/// orthonormal: what rounding to binary32 does to them.
const NEAR_ONE: f64 = 4e-7;

/// A range of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Lower end.
    #[serde(with = "base::value::exact")]
    pub low: f64,
    /// Upper end.
    #[serde(with = "base::value::exact")]
    pub high: f64,
    /// The lower end itself is left out.
    pub open_low: bool,
    /// The upper end itself is left out.
    pub open_high: bool,
}

impl Interval {
    /// True for a number inside.
    pub fn contains(&self, x: f64) -> bool {
        let above = if self.open_low { x > self.low } else { x >= self.low };
        above && if self.open_high { x < self.high } else { x <= self.high }
    }
}

/// Something that holds for every value of an input.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Law {
    /// Each component lies in the range.
    Within(Interval),
    /// Vectors of length 1.
    Normalised,
    /// Not all components are 0.
    NonZero,
    /// Square matrices whose columns are orthonormal.
    Rotation,
    /// Each component is a whole number.
    Whole,
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Within(i) => {
                let (open, close) = (if i.open_low { '(' } else { '[' }, if i.open_high { ')' } else { ']' });
                write!(f, "in {open}{}, {}{close}", i.low, i.high)
            }
            Self::Normalised => f.write_str("normalised"),
            Self::NonZero => f.write_str("nonzero"),
            Self::Rotation => f.write_str("rotation"),
            Self::Whole => f.write_str("whole"),
        }
    }
}

/// A law for an input by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Stated {
    /// Name of the input, of a structure whose members it holds for, or either with the name of the
    /// function and a point before it.
    pub input: String,
    /// Law that the input keeps.
    pub law: Law,
    /// Where it was said, for messages.
    pub at: String,
    /// True for what is said of every function that has such an input.
    pub whole_file: bool,
}

impl Stated {
    /// True when it speaks about this input of this function.
    pub fn is_about(&self, function: &str, input: &str) -> bool {
        let names =
            |name: &str| input == name || input.strip_prefix(name).is_some_and(|rest| rest.starts_with(['.', '[']));
        names(&self.input)
            || self.input.strip_prefix(function).and_then(|rest| rest.strip_prefix('.')).is_some_and(names)
    }
}

/// The laws of one input.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputDomain {
    /// All of them; empty where nothing is stated.
    pub laws: Vec<Law>,
}

impl InputDomain {
    /// True when something is stated.
    pub fn is_stated(&self) -> bool {
        !self.laws.is_empty()
    }

    /// The range that all components lie in.
    pub fn interval(&self) -> Option<Interval> {
        self.laws.iter().find_map(|law| match law {
            Law::Within(interval) => Some(*interval),
            Law::Normalised | Law::NonZero | Law::Rotation | Law::Whole => None,
        })
    }

    /// True when this law holds.
    pub fn has(&self, law: Law) -> bool {
        self.laws.contains(&law)
    }

    /// True for a number that counts: of moderate size where nothing is stated. Of a stated range all do but
    /// those that are hardly meant: beyond the moderate where it has no end, and far nearer to 0 than it
    /// is wide.
    fn counts(&self, x: f64) -> bool {
        if !self.is_stated() || self.laws == [Law::NonZero] {
            return is_moderate(x);
        }
        let (most, width) = match self.interval() {
            Some(Interval { low, high, .. }) if low.is_finite() && high.is_finite() => {
                (f64::INFINITY, low.abs().max(high.abs()))
            }
            Some(Interval { low, high, .. }) => {
                let end = if low.is_finite() { low.abs() } else { high.abs() };
                (if end.is_finite() { end.max(MODERATE) } else { MODERATE }, 1.0)
            }
            None => (MODERATE, 1.0),
        };
        x == 0.0 || (x.abs() <= most && x.abs() >= TINY * width)
    }

    /// True for words that keep all laws and hold neither NaN nor infinity.
    pub fn admits(&self, field: &Field, words: &[u32]) -> bool {
        let values: Vec<f64> = words.iter().map(|&w| number(w, field.shape.scalar)).collect();
        if !values.iter().all(|v| v.is_finite()) {
            return false;
        }
        let elements = || values.chunks(field.shape.element_words().max(1));
        self.laws.iter().all(|law| match law {
            Law::Within(interval) => values.iter().all(|&v| interval.contains(v)),
            Law::NonZero => elements().all(|e| e.iter().any(|v| *v != 0.0)),
            Law::Whole => values.iter().all(|v| v.fract() == 0.0),
            Law::Normalised => elements().all(|e| (dot(e, e).sqrt() - 1.0).abs() <= NEAR_ONE),
            Law::Rotation => elements().all(|e| is_rotation(e, usize::from(field.shape.rows))),
        })
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn is_rotation(matrix: &[f64], rows: usize) -> bool {
    let columns: Vec<&[f64]> = matrix.chunks(rows.max(1)).collect();
    columns.iter().enumerate().all(|(i, a)| {
        columns.iter().enumerate().all(|(j, b)| (dot(a, b) - f64::from(u8::from(i == j))).abs() <= NEAR_ONE)
    })
}

/// A word as a number.
pub fn number(word: u32, scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F32 => f64::from(f32::from_bits(word)),
        Scalar::I32 => f64::from(word.cast_signed()),
        Scalar::U32 | Scalar::Bool => f64::from(word),
    }
}

/// The inputs of one function.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Domain {
    /// In the order of the invocation's fields.
    pub invocation: Vec<InputDomain>,
    /// In the order of the fields of the case.
    pub case: Vec<InputDomain>,
}

impl Domain {
    /// The laws of each input, out of all that are stated.
    pub fn new(function: &str, invocation: &[Field], case: &[Field], stated: &[Stated]) -> Self {
        let of = |field: &Field| InputDomain {
            laws: stated.iter().filter(|s| s.is_about(function, &field.name)).map(|s| s.law).collect(),
        };
        Self { invocation: invocation.iter().map(of).collect(), case: case.iter().map(of).collect() }
    }

    /// True when every input has a stated domain.
    pub fn is_stated(&self) -> bool {
        self.invocation.iter().chain(&self.case).all(InputDomain::is_stated)
    }

    fn all<'a>(&'a self, sample: &'a Sample) -> impl Iterator<Item = (&'a InputDomain, &'a Field, &'a [u32])> {
        let side = |inputs: &'a [InputDomain], record: &'a base::value::Record, words: &'a [u32]| {
            let fields = record.fields().iter().enumerate();
            fields.zip(inputs).map(move |((k, field), input)| (input, field, &words[record.range(k)]))
        };
        side(&self.invocation, &sample.invocation_record, &sample.invocation).chain(side(
            &self.case,
            &sample.case_record,
            &sample.case,
        ))
    }

    /// True for a sample that counts: inputs with a stated domain lie in it, and the others are of
    /// moderate size.
    pub fn counts(&self, sample: &Sample) -> bool {
        self.all(sample).all(|(input, field, words)| words.iter().all(|&w| input.counts(number(w, field.shape.scalar))))
    }

    /// True for a sample that keeps all laws.
    pub fn keeps(&self, sample: &Sample) -> bool {
        self.all(sample).all(|(input, field, words)| input.admits(field, words))
    }
}

fn is_moderate(x: f64) -> bool {
    x == 0.0 || (x.abs() <= MODERATE && x.abs() >= 1.0 / MODERATE)
}

/// What a sample says about a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standing {
    /// Its inputs are stated or realistic: what goes wrong is an error.
    Counts,
    /// Its inputs are of ordinary size; nobody stated that they come.
    Unstated,
    /// Inputs beyond the moderate.
    Extreme,
}

/// What the candidates of shrinking have to be, beside keeping all laws.
#[derive(Clone, Copy)]
pub enum Within<'a> {
    /// Any that keeps the laws.
    Laws,
    /// Of moderate size where nothing is stated.
    Moderate,
    /// As a program would give them.
    Realistic(&'a Realistic),
}

/// A domain for shrinking.
pub struct Shrinking<'a> {
    /// The laws.
    pub domain: &'a Domain,
    /// What candidates must be beside keeping the laws.
    pub within: Within<'a>,
}

/// Numbers that inputs of one size may become together.
const SIZES: [f32; 8] = [1.0, 2.0, 0.5, 4.0, 16.0, 0.125, 1024.0, 0.0];

impl shrink::Domain for Shrinking<'_> {
    fn admits(&self, sample: &Sample) -> bool {
        self.domain.keeps(sample)
            && match self.within {
                Within::Laws => true,
                Within::Moderate => self.domain.counts(sample),
                Within::Realistic(realistic) => realistic.admits(self.domain, sample),
            }
    }

    /// All numbers of one size become another together, so that equal and opposite inputs stay so: a sum
    /// that cancels is not lost by making its terms plainer. Each word is a group; the first that has a
    /// size stands for it.
    fn simpler(&self, sample: &Sample, group: usize, k: usize) -> Option<Sample> {
        let all: Vec<u32> = sample.invocation.iter().chain(&sample.case).copied().collect();
        let scalar = |at: usize| match at.checked_sub(sample.invocation.len()) {
            None => sample.invocation_record.scalar_of(at),
            Some(at) => sample.case_record.scalar_of(at),
        };
        let size = all.get(group)? & 0x7fff_ffff;
        let same = |at: usize| all[at] & 0x7fff_ffff == size && scalar(at) == Scalar::F32;
        let mut new = sample.clone();
        let set = |new: &mut Sample, at: usize, value: f32| {
            let word = value.to_bits() | (all[at] & 0x8000_0000);
            match at.checked_sub(sample.invocation.len()) {
                None => new.invocation[at] = word,
                Some(at) => new.case[at] = word,
            }
        };
        let value = f32::from_bits(size);
        let power = f32::from_bits(size & 0x7f80_0000);
        let target = match k.checked_sub(SIZES.len()) {
            None => SIZES[k],
            Some(0) => value.round(),
            Some(1) => power,
            Some(2) => value * 0.5,
            Some(3) => match self.within {
                // Vectors and matrices that keep a law between components become plainer together.
                Within::Realistic(realistic) => return realistic.plainer(self.domain, sample, group),
                Within::Laws | Within::Moderate => return None,
            },
            Some(_) => return None,
        };
        if same(group) && (0..group).all(|at| !same(at)) {
            (0..all.len()).filter(|&at| same(at)).for_each(|at| set(&mut new, at, target));
        }
        Some(new)
    }

    fn groups(&self) -> usize {
        MOST_GROUPS
    }
}

/// Words of a sample that are looked at as the first of their size.
const MOST_GROUPS: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;
    use base::value::Shape;

    fn input(laws: &[Law]) -> InputDomain {
        InputDomain { laws: laws.to_vec() }
    }

    fn admits(laws: &[Law], shape: Shape, values: &[f32]) -> bool {
        let words: Vec<u32> = values.iter().map(|v| v.to_bits()).collect();
        input(laws).admits(&Field { name: "x".into(), shape }, &words)
    }

    #[test]
    fn each_law_refuses_what_breaks_it() {
        let unit = Interval { low: 0.0, high: 1.0, open_low: true, open_high: false };
        assert!(admits(&[Law::Within(unit)], Shape::VEC2, &[1.0, 1e-30]));
        assert!(!admits(&[Law::Within(unit)], Shape::VEC2, &[1.0, 0.0]));
        assert!(admits(&[Law::Normalised], Shape::VEC3, &[0.6, 0.8, 0.0]));
        assert!(!admits(&[Law::Normalised], Shape::VEC3, &[0.6, 0.81, 0.0]));
        assert!(
            !admits(&[Law::NonZero], Shape::VEC2, &[0.0, -0.0]) && admits(&[Law::NonZero], Shape::VEC2, &[0.0, 1.0])
        );
        assert!(!admits(&[Law::Whole], Shape::FLOAT, &[0.5]) && admits(&[Law::Whole], Shape::FLOAT, &[-3.0]));
        let mat2 = Shape { scalar: Scalar::F32, columns: 2, rows: 2, array: None, half: false };
        assert!(admits(&[Law::Rotation], mat2, &[0.0, 1.0, -1.0, 0.0]));
        assert!(!admits(&[Law::Rotation], mat2, &[2.0, 0.0, 0.0, 1.0]));
        assert!(!admits(&[], Shape::FLOAT, &[f32::NAN]) && !admits(&[], Shape::FLOAT, &[f32::INFINITY]));
    }

    #[test]
    fn what_is_hardly_meant_does_not_count() {
        let within = |low, high| input(&[Law::Within(Interval { low, high, open_low: false, open_high: false })]);
        let counts = |input: &InputDomain, x: f64| input.counts(x);
        assert!(counts(&input(&[]), 1000.0) && !counts(&input(&[]), 1e4) && !counts(&input(&[]), 1e-4));
        assert!(
            counts(&within(0.0, 1.0), 1e-18) && !counts(&within(0.0, 1.0), 1e-20) && counts(&within(0.0, 1.0), 0.0)
        );
        assert!(counts(&within(1e20, 1e21), 1e20) && counts(&within(1e-30, 1e-29), 1e-30));
        let positive = within(0.0, f64::INFINITY);
        assert!(counts(&positive, 1000.0) && !counts(&positive, 1e30));
        assert!(counts(&input(&[Law::Normalised]), 1e-10) && !counts(&input(&[Law::NonZero]), 1e-10));
    }

    #[test]
    fn names_reach_members_and_functions() {
        let stated =
            |input: &str| Stated { input: input.into(), law: Law::NonZero, at: String::new(), whole_file: false };
        assert!(stated("x").is_about("f", "x") && stated("f.x").is_about("f", "x") && stated("s").is_about("f", "s.a"));
        assert!(stated("w").is_about("f", "w[2].a") && stated("s.a").is_about("f", "s.a"));
        assert!(!stated("x").is_about("f", "xy") && !stated("g.x").is_about("f", "x"));
    }
}
