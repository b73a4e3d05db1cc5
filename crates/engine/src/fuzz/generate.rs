//! Inputs of a function from its domain. A sample depends on the seed, the function and its number alone.

use std::sync::Arc;

use rayon::prelude::*;

use super::domain::{Domain, InputDomain, Interval, Law, MODERATE};
use super::subject::Ready;
use base::value::{Batch, Field, Record, Scalar};
use property::{Stream, mix};

/// How far the inputs of a sample reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reach {
    /// Moderate sizes.
    Moderate,
    /// All of binary32, subnormal and huge numbers included.
    Wide,
}

/// Ordinary numbers in which shaders are often wrong.
const SPECIAL: [f32; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    2.0,
    -2.0,
    1.000_000_1,
    0.999_999_94,
    std::f32::consts::PI,
    std::f32::consts::FRAC_PI_2,
    255.0,
    MODERATE as f32,
];

/// The same at the ends of binary32.
const EXTREME: [f32; 12] = [
    0.0,
    -0.0,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    f32::from_bits(1),
    f32::from_bits(0x8000_0001),
    f32::from_bits(0x007f_ffff),
    1e19,
    -1e19,
    1e-23,
];

/// The key of the inputs of a function, which [`batch`](super::batch) takes.
pub fn stream_key(seed: u64, label: &str) -> u64 {
    property::mix(seed, text_key(label))
}

fn text_key(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |key, byte| Stream::new(key ^ u64::from(byte)).bits())
}

/// Samples of one batch, and words of its largest record in all.
const BATCH: usize = 1 << 16;
const BATCH_WORDS: usize = 1 << 22;

/// Most samples of one batch of a function.
pub fn batch_size(ready: &Ready) -> usize {
    let kernel = &ready.kernel;
    let widest = kernel.output.words().max(kernel.invocation.words()).max(kernel.case.words()).max(1);
    BATCH.min(BATCH_WORDS / widest).max(1)
}

/// Samples of a function from number `first` on: as a program would give them, or of any size.
pub fn drawn(ready: &Ready, domain: &Domain, key: u64, (first, count): (u64, usize), realistic: bool) -> Batch {
    let records = (&ready.kernel.invocation, &ready.kernel.case);
    if realistic {
        ready.realistic.batch(records, domain, key, first, count)
    } else {
        batch(records.0, records.1, domain, key, first, count)
    }
}

/// Makes `count` samples from number `first` on, each with uniforms of its own.
pub fn batch(
    invocation: &Arc<Record>,
    case: &Arc<Record>,
    domain: &Domain,
    key: u64,
    first: u64,
    count: usize,
) -> Batch {
    let (words, case_words) = (invocation.words(), case.words());
    let rows: Vec<(Vec<u32>, Vec<u32>)> = (0..count)
        .into_par_iter()
        .with_min_len(512)
        .map(|k| {
            let mut stream = Stream::new(mix(key, first + k as u64));
            let mut sample = Maker { stream: &mut stream, reach: Reach::Moderate, mixed: false };
            // Most samples are moderate; some have a single extreme component, some nothing else.
            match sample.stream.below(16) {
                0 => sample.reach = Reach::Wide,
                1 | 2 => sample.mixed = true,
                _ => {}
            }
            let a = sample.fill(invocation, &domain.invocation);
            let b = sample.fill(case, &domain.case);
            (a, b)
        })
        .collect();
    let mut batch = Batch::with_capacity(invocation.clone(), case.clone(), 1, count);
    batch.invocations.reserve(words * count);
    batch.cases.reserve(case_words * count);
    for (a, b) in rows {
        batch.invocations.extend(a);
        batch.cases.extend(b);
    }
    batch
}

/// The nearest number of binary16; what is larger than all of them is the largest.
fn halved(x: f32) -> f32 {
    if x.is_finite() { program::interp::halved(x.clamp(-65504.0, 65504.0)) } else { x }
}

struct Maker<'s> {
    stream: &'s mut Stream,
    reach: Reach,
    mixed: bool,
}

impl Maker<'_> {
    /// The words of one record.
    fn fill(&mut self, record: &Record, inputs: &[InputDomain]) -> Vec<u32> {
        let mut words = vec![0; record.words()];
        for (k, (field, input)) in record.fields().iter().zip(inputs).enumerate() {
            let range = record.range(k);
            let (before, rest) = words.split_at_mut(range.start);
            let out = &mut rest[..range.len()];
            self.input(field, input, out);
            if !input.is_stated() {
                // Structure between inputs: equal, parallel, opposite, nearly equal ones.
                let other = (0..k).rev().find(|&j| record.fields()[j].shape == field.shape && !inputs[j].is_stated());
                if let Some(other) = other.filter(|_| field.shape.scalar == Scalar::F32) {
                    self.related(&before[record.range(other)], out);
                }
            }
        }
        words
    }

    /// One input, kept inside of its domain.
    fn input(&mut self, field: &Field, input: &InputDomain, out: &mut [u32]) {
        for _ in 0..16 {
            if field.shape.scalar == Scalar::F32 {
                self.reals(field, input, out);
                if field.shape.half {
                    out.iter_mut().for_each(|word| *word = halved(f32::from_bits(*word)).to_bits());
                }
            } else {
                let interval = input.interval();
                out.iter_mut().for_each(|word| *word = self.whole(field.shape.scalar, interval));
            }
            if !input.is_stated() || input.admits(field, out) {
                return;
            }
        }
        // A law that few words keep: the plainest ones that keep it.
        let candidates = [0.0_f32, 1.0, -1.0, 0.5];
        let middle = input.interval().map(|i| (0.5 * i.low + 0.5 * i.high) as f32);
        for value in candidates.into_iter().chain(middle) {
            out.fill(encode(f64::from(value), field.shape.scalar));
            if input.admits(field, out) {
                return;
            }
        }
    }

    fn reals(&mut self, field: &Field, input: &InputDomain, out: &mut [u32]) {
        let shape = field.shape;
        let per = shape.element_words();
        let whole_array = shape.array.is_some().then(|| self.stream.below(8));
        for element in out.chunks_mut(per) {
            if shape.columns > 1 {
                self.matrix(input, usize::from(shape.rows), element);
            } else {
                self.vector(input, element);
            }
        }
        match whole_array {
            // All elements alike; none but one; none at all.
            Some(0) => {
                let first = out[..per].to_vec();
                out.chunks_mut(per).for_each(|element| element.copy_from_slice(&first));
            }
            Some(1) => {
                let kept = self.stream.below(out.len() / per);
                let others = out.chunks_mut(per).enumerate().filter(|(k, _)| *k != kept);
                others.for_each(|(_, element)| element.fill(0));
            }
            Some(2) if self.stream.one_in(2) => out.fill(0),
            _ => {}
        }
    }

    fn vector(&mut self, input: &InputDomain, out: &mut [u32]) {
        let interval = input.interval();
        let n = out.len();
        if input.has(Law::Normalised) {
            return self.direction(out);
        }
        if n > 1 {
            match self.stream.below(12) {
                0 => out.fill(0),
                1 => {
                    out.fill(0);
                    let at = self.stream.below(n);
                    out[at] = if self.stream.one_in(2) { 1.0_f32 } else { -1.0 }.to_bits();
                }
                2 => self.direction(out),
                3 => out.fill(self.real(interval).to_bits()),
                4..=6 => {
                    let scale = f64::from(self.real(interval));
                    for word in out.iter_mut() {
                        *word = ((scale * self.stream.between(-1.0, 1.0)) as f32).to_bits();
                    }
                }
                _ => out.iter_mut().for_each(|word| *word = self.real(interval).to_bits()),
            }
            // What is structured need not lie in the range; the caller tries again then.
        } else {
            out[0] = self.real(interval).to_bits();
        }
        if input.has(Law::Whole) {
            out.iter_mut().for_each(|word| *word = f32::from_bits(*word).round().to_bits());
        }
    }

    /// A vector of length 1; often along an axis.
    fn direction(&mut self, out: &mut [u32]) {
        direction(out, self.stream, |stream| stream.one_in(6));
    }

    fn matrix(&mut self, input: &InputDomain, rows: usize, out: &mut [u32]) {
        let interval = input.interval();
        let columns = out.len() / rows;
        let kind = if input.has(Law::Rotation) { 4 } else { self.stream.below(9) };
        match kind {
            0 | 3 => {
                let scale = if kind == 0 { 1.0 } else { self.real(None) };
                out.fill(0);
                for k in 0..rows.min(columns) {
                    out[k * rows + k] = scale.to_bits();
                }
            }
            1 => out.fill(0),
            2 => {
                // Singular: all columns are multiples of one.
                let column: Vec<f32> = (0..rows).map(|_| self.real(None)).collect();
                for part in out.chunks_mut(rows) {
                    let factor = [1.0, 2.0, -1.0, 0.0][self.stream.below(4)];
                    part.iter_mut().zip(&column).for_each(|(word, x)| *word = (factor * x).to_bits());
                }
            }
            4 => {
                let quarter = self.stream.one_in(4);
                rotation(rows, quarter, self.stream, out);
            }
            _ => out.iter_mut().for_each(|word| *word = self.real(interval).to_bits()),
        }
    }

    /// Now and then, puts something in that is related to another input.
    fn related(&mut self, other: &[u32], out: &mut [u32]) {
        let other = other.iter().map(|&w| f32::from_bits(w));
        match self.stream.below(32) {
            0 | 1 => out.iter_mut().zip(other).for_each(|(word, x)| *word = x.to_bits()),
            2 => out.iter_mut().zip(other).for_each(|(word, x)| *word = (-x).to_bits()),
            3 => {
                let factor = [2.0, 0.5, -3.0, 1e3][self.stream.below(4)];
                out.iter_mut().zip(other).for_each(|(word, x)| *word = clamp(factor * x).to_bits());
            }
            4 | 5 => {
                // Nearly equal: the last bits of some components.
                for (word, x) in out.iter_mut().zip(other) {
                    let moved = if self.stream.one_in(2) { x.next_up() } else { x };
                    let near = if self.stream.one_in(4) { moved * 1.000_1 } else { moved };
                    *word = clamp(near).to_bits();
                }
            }
            _ => {}
        }
    }

    fn real(&mut self, interval: Option<Interval>) -> f32 {
        if let Some(interval) = interval {
            return self.inside(interval);
        }
        let wide = self.reach == Reach::Wide || (self.mixed && self.stream.one_in(4));
        if wide {
            return match self.stream.below(6) {
                0 => EXTREME[self.stream.below(EXTREME.len())],
                _ => self.log_uniform(-149.0, 128.0),
            };
        }
        match self.stream.below(10) {
            0 => SPECIAL[self.stream.below(SPECIAL.len())],
            1 => self.stream.below(17) as f32 - 8.0,
            2..=4 => self.stream.between(-1.0, 1.0) as f32,
            _ => self.log_uniform(-MODERATE.log2(), MODERATE.log2()),
        }
    }

    fn log_uniform(&mut self, low: f64, high: f64) -> f32 {
        let size = self.stream.between(low, high).exp2() as f32;
        clamp(if self.stream.one_in(2) { size } else { -size })
    }

    /// A number of a range: its ends and their neighbours, evenly spread, and near to 0 or to the lower end.
    fn inside(&mut self, interval: Interval) -> f32 {
        let low = (interval.low as f32).max(f32::MIN);
        let high = (interval.high as f32).min(f32::MAX);
        let bounded = interval.low.is_finite() && interval.high.is_finite();
        let value = match self.stream.below(8) {
            0 => {
                let specials = [low, high, low.next_up(), high.next_down(), 0.0, -0.0, 1.0, -1.0, 0.5];
                specials[self.stream.below(specials.len())]
            }
            1..=4 if bounded => self.stream.between(f64::from(low), f64::from(high)) as f32,
            1..=4 => self.log_uniform(-10.0, 10.0),
            _ if interval.contains(0.0) => {
                let most = f64::from(low.abs().max(high.abs())).max(f64::from(f32::MIN_POSITIVE)).log2();
                self.log_uniform(most - 24.0, most)
            }
            _ => {
                // From the end that is nearer to 0.
                let (near, far) = if low.abs() <= high.abs() { (low, high) } else { (high, low) };
                let part = self.stream.between(-24.0, 0.0).exp2();
                (f64::from(near) + (f64::from(far) - f64::from(near)) * part) as f32
            }
        };
        let value = if interval.contains(f64::from(value)) { value } else { -value };
        if interval.contains(f64::from(value)) {
            value
        } else {
            self.stream.between(f64::from(low), f64::from(high)) as f32
        }
    }

    /// A word that is no real number.
    fn whole(&mut self, scalar: Scalar, interval: Option<Interval>) -> u32 {
        if scalar == Scalar::Bool {
            return u32::from(self.stream.one_in(2));
        }
        let value = match interval {
            Some(interval) => f64::from(self.inside(interval)).round(),
            None if self.reach == Reach::Wide && self.stream.one_in(4) => {
                return [0, 1, u32::MAX, 0x7fff_ffff, 0x8000_0000, 0x10000, 32][self.stream.below(7)];
            }
            // Whole numbers mostly count or choose.
            None => match self.stream.below(8) {
                0 => [0.0, 1.0, 2.0, -1.0][self.stream.below(4)],
                1 => self.stream.between(0.0, MODERATE).round(),
                2 if scalar == Scalar::I32 => -(self.stream.below(16) as f64),
                _ => self.stream.below(16) as f64,
            },
        };
        encode(value, scalar)
    }
}

/// A vector of length 1, along an axis where `along` says so.
pub(super) fn direction(out: &mut [u32], stream: &mut Stream, along: impl FnOnce(&mut Stream) -> bool) {
    let n = out.len();
    let mut v: Vec<f64> = (0..n).map(|_| stream.between(-1.0, 1.0)).collect();
    if along(stream) {
        let axis = stream.below(n);
        v.iter_mut().enumerate().for_each(|(k, x)| *x = if k == axis { x.signum() } else { 0.0 });
    }
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let length = if length > 0.0 { length } else { 1.0 };
    for (word, x) in out.iter_mut().zip(v) {
        *word = ((x / length) as f32).to_bits();
    }
}

/// Orthonormal columns, by Gram and Schmidt; axes mapped to axes for a `quarter` turn.
pub(super) fn rotation(rows: usize, quarter: bool, stream: &mut Stream, out: &mut [u32]) {
    let columns = out.len() / rows;
    let mut done: Vec<Vec<f64>> = Vec::new();
    for k in 0..columns {
        let mut v: Vec<f64> = (0..rows).map(|_| stream.between(-1.0, 1.0)).collect();
        if quarter {
            v = (0..rows).map(|row| f64::from(u8::from(row == (k + 1) % rows))).collect();
        }
        for before in &done {
            let along: f64 = v.iter().zip(before).map(|(a, b)| a * b).sum();
            v.iter_mut().zip(before).for_each(|(a, b)| *a -= along * b);
        }
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let v: Vec<f64> = v.iter().map(|x| x / length).collect();
        for (word, x) in out[k * rows..].iter_mut().zip(&v) {
            *word = (*x as f32).to_bits();
        }
        done.push(v);
    }
}

/// A value that keeps what is stated, the ends of ranges among them.
pub(super) fn within_laws(field: &Field, input: &InputDomain, stream: &mut Stream, out: &mut [u32]) {
    Maker { stream, reach: Reach::Moderate, mixed: false }.input(field, input, out);
}

fn encode(value: f64, scalar: Scalar) -> u32 {
    match scalar {
        Scalar::F32 => (value as f32).to_bits(),
        Scalar::I32 => (value as i32).cast_unsigned(),
        Scalar::U32 => value as u32,
        Scalar::Bool => u32::from(value != 0.0),
    }
}

fn clamp(x: f32) -> f32 {
    x.clamp(f32::MIN, f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzz::domain::{Stated, number};
    use crate::fuzz::hint;
    use base::value::Shape;

    fn record(fields: &[(&str, Shape)]) -> Arc<Record> {
        let field = |&(name, shape): &(&str, Shape)| Field { name: name.into(), shape };
        Arc::new(Record::new(fields.iter().map(field).collect()))
    }

    fn samples(fields: &[(&str, Shape)], stated: &[&str]) -> (Batch, Domain) {
        let record = record(fields);
        let stated: Vec<Stated> = stated.iter().flat_map(|text| hint::option(text).unwrap()).collect();
        let domain = Domain::new("f", record.fields(), &[], &stated);
        (batch(&record, &Arc::default(), &domain, 7, 0, 4096), domain)
    }

    fn rows(batch: &Batch) -> impl Iterator<Item = Vec<f64>> + '_ {
        let record = &batch.invocation_record;
        (0..batch.invocation_count())
            .map(|i| batch.invocation(i).iter().enumerate().map(|(w, &x)| number(x, record.scalar_of(w))).collect())
    }

    #[test]
    fn samples_are_the_same_whatever_the_batch() {
        let record = record(&[("a", Shape::VEC3), ("b", Shape::FLOAT)]);
        let domain = Domain::new("f", record.fields(), &[], &[]);
        let whole = batch(&record, &Arc::default(), &domain, 3, 0, 100);
        let part = batch(&record, &Arc::default(), &domain, 3, 60, 10);
        assert_eq!(part.invocations, whole.invocations[60 * 4..70 * 4]);
    }

    #[test]
    fn every_special_class_of_vectors_comes_up_and_all_are_finite() {
        let (batch, _) = samples(&[("a", Shape::VEC3), ("b", Shape::VEC3)], &[]);
        let count = |is: &dyn Fn(&[f64], &[f64]) -> bool| rows(&batch).filter(|r| is(&r[..3], &r[3..])).count();
        assert!(rows(&batch).flatten().all(f64::is_finite));
        let cross = |a: &[f64], b: &[f64]| (0..3).all(|k| a[k] * b[(k + 1) % 3] == a[(k + 1) % 3] * b[k]);
        let zero = |a: &[f64]| a.iter().all(|x| *x == 0.0);
        let length = |a: &[f64]| a.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(count(&|a, _| zero(a)) > 50);
        assert!(count(&|a, b| a == b && !zero(a)) > 50);
        assert!(count(&|a, b| cross(a, b) && a != b && !zero(a) && !zero(b)) > 20);
        assert!(count(&|a, _| (length(a) - 1.0).abs() < 1e-6) > 100);
        assert!(count(&|a, _| a.iter().any(|x| x.abs() > 1e20)) > 100);
        assert!(count(&|a, _| a.iter().any(|x| *x != 0.0 && x.abs() < 1.2e-38)) > 50);
    }

    #[test]
    fn identity_and_singular_matrices_come_up() {
        let mat2 = Shape { scalar: Scalar::F32, columns: 2, rows: 2, array: None, half: false };
        let (batch, _) = samples(&[("m", mat2)], &[]);
        assert!(rows(&batch).filter(|m| m[..] == [1.0, 0.0, 0.0, 1.0]).count() > 100);
        let singular = |m: &Vec<f64>| m[0] * m[3] == m[1] * m[2] && m.iter().any(|x| *x != 0.0);
        assert!(rows(&batch).filter(singular).count() > 100);
    }

    #[test]
    fn stated_domains_are_kept() {
        let fields = [("x", Shape::FLOAT), ("n", Shape::VEC3), ("k", Shape::INT), ("v", Shape::VEC2.array_of(3))];
        let mat3 = Shape { scalar: Scalar::F32, columns: 3, rows: 3, array: None, half: false };
        let fields = [&fields[..], &[("m", mat3)]].concat();
        let (batch, domain) =
            samples(&fields, &["x=(0,1]", "n=normalised", "k=[2,5]", "v=[-1,1];v=nonzero", "m=rotation"]);
        for i in 0..batch.invocation_count() {
            for (k, field) in batch.invocation_record.fields().iter().enumerate() {
                let words = &batch.invocation(i)[batch.invocation_record.range(k)];
                assert!(domain.invocation[k].admits(field, words), "{} {words:x?}", field.name);
            }
        }
        assert!(rows(&batch).any(|r| r[0] == 1.0) && rows(&batch).any(|r| r[0] < 1e-6));
        assert!((2..=5).all(|k| rows(&batch).any(|r| r[4] == f64::from(k))));
    }
}
