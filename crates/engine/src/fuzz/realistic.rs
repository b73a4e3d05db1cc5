//! Inputs as a program would give them: each by what it is taken for, and those together that belong together.

use std::sync::Arc;

use rayon::prelude::*;

use super::apart;
use super::domain::{Domain, InputDomain, Law, number};
use super::generate::{direction, rotation, within_laws};
use super::presumed::is_share;
use crate::guess::{self, Guess};
use base::value::{Batch, Field, Record, Scalar, Shape};
use property::generators::{Generator, Group, Options, Place, by_name, matrix};
use property::{Sample, Stream, mix};

/// One sample in this many has one input at an edge that programs reach: a direction along an axis, black, the corner
/// of a texture. It is one input alone, so that nothing coincides that does not coincide by itself.
const AT_AN_EDGE: usize = 8;

/// Key of values that are drawn again.
const REDRAWN: u64 = 0x9e37;

/// The number of the values that are drawn far from 0.
pub(super) const FAR: u64 = 5;

/// How short interpolation leaves a direction.
const SHORTENED: f64 = 0.5;

/// How far a matrix that belongs to another may be from what follows from it.
const NEAR: f64 = 1e-4;

/// What realistic inputs of a function are.
pub struct Realistic {
    /// For the invocation and the case, in the order of the fields.
    sides: [Vec<RealisticDraw>; 2],
    links: Vec<Link>,
    /// What goes farther than usual, each in words.
    far: Vec<String>,
}

/// How an input is drawn.
struct RealisticDraw {
    draw: Draw,
    taken_for: &'static str,
    /// Its name or type says what it is: no program gives it anything else.
    sure: bool,
    /// Both ends of what callers give it.
    passed: Option<[f64; 2]>,
}

enum Draw {
    /// Evenly over a range.
    Interval { low: f64, high: f64, closed: bool },
    /// Of length 1, and of the length that interpolation leaves it where `varying`.
    Direction { varying: bool, fourth: Fourth },
    /// In a box around the origin; a fourth component is 1.
    Point { low: f64, high: f64 },
    /// Columns at right angles: of length 1, of one length, or stretched.
    Turn(Stretch),
    /// `gl_FragCoord`, between the centres of two pixels.
    Screen { low: f64, high: f64 },
    /// Bits of any numbers that are packed, or of one real number.
    Bits { real: bool },
    /// By a generator of suites; with both ends of a list whose numbers differ.
    By(&'static dyn Generator, Box<Group>, Option<[i64; 2]>),
}

/// The fourth component of a direction.
#[derive(Clone, Copy, PartialEq)]
enum Fourth {
    /// 0.
    Zero,
    /// 1 or -1: whether a tangent is mirrored.
    Sign,
    /// Like the others: a quaternion.
    Free,
}

#[derive(Clone, Copy, PartialEq)]
enum Stretch {
    None,
    Alike,
    Each,
}

/// An input that follows from another.
struct Link {
    from: (usize, usize),
    to: (usize, usize),
    follow: fn(&[u32], &mut [u32]) -> bool,
}

impl Realistic {
    /// For the fields of the invocation and of the case, with what each is taken for.
    pub fn new(records: [&Record; 2], guess: &dyn Fn(&Field) -> (Guess, bool)) -> Self {
        let one = |field: &Field, uniform: bool| {
            let (guess, varying) = guess(field);
            let sure = guess.is_sure(field.shape, uniform) || is_share(&field.name);
            let (taken_for, passed) = (guess.taken_for, guess.passed);
            RealisticDraw { taken_for, draw: drawn(field, &guess, varying), sure, passed }
        };
        let sides =
            [0, 1].map(|side: usize| records[side].fields().iter().map(|field| one(field, side == 1)).collect());
        let links = links(records, &sides);
        Self { sides, links, far: Vec::new() }
    }

    /// The same with words for what goes farther than usual.
    #[must_use]
    pub fn with_far(self, far: Vec<String>) -> Self {
        Self { far, ..self }
    }

    /// What goes farther than usual, each in words.
    pub fn far(&self) -> &[String] {
        &self.far
    }

    /// Both ends of what callers give each input, those of the invocation first.
    pub fn passed(&self) -> impl Iterator<Item = Option<[f64; 2]>> {
        self.sides.iter().flatten().map(|drawn| drawn.passed)
    }

    /// What each input is taken for where nothing is stated.
    pub fn taken_for<'a>(&'a self, domain: &'a Domain) -> Vec<Option<&'static str>> {
        let side = |side: usize| {
            let inputs = [&domain.invocation, &domain.case][side];
            let all = self.sides[side].iter().zip(inputs);
            all.map(|(drawn, input)| (!input.is_stated()).then_some(drawn.taken_for)).collect::<Vec<_>>()
        };
        [side(0), side(1)].concat()
    }

    /// Makes `count` samples from number `first` on, each with uniforms of its own.
    pub fn batch(
        &self,
        (invocation, case): (&Arc<Record>, &Arc<Record>),
        domain: &Domain,
        key: u64,
        first: u64,
        count: usize,
    ) -> Batch {
        let rows: Vec<[Vec<u32>; 2]> = (0..count)
            .into_par_iter()
            .with_min_len(512)
            .map(|k| self.sample([invocation, case], domain, &mut Stream::new(mix(key, first + k as u64))))
            .collect();
        let mut batch = Batch::with_capacity(invocation.clone(), case.clone(), 1, count);
        for [own, uniforms] in rows {
            batch.invocations.extend(own);
            batch.cases.extend(uniforms);
        }
        batch
    }

    fn sample(&self, records: [&Record; 2], domain: &Domain, stream: &mut Stream) -> [Vec<u32>; 2] {
        let total = self.sides[0].len() + self.sides[1].len();
        let edge = (stream.one_in(AT_AN_EDGE) && total > 0).then(|| stream.below(total));
        let mut counted = 0;
        let mut sides = records.map(|record| vec![0; record.words()]);
        for (side, record) in records.into_iter().enumerate() {
            let inputs = [&domain.invocation, &domain.case][side];
            for (k, (drawn, input)) in self.sides[side].iter().zip(inputs).enumerate() {
                let field = &record.fields()[k];
                let out = &mut sides[side][record.range(k)];
                // Ranges and lengths that are stated say everything; other laws leave room for a guess.
                let open = input.laws.iter().all(|law| matches!(law, Law::NonZero | Law::Whole));
                let mut fits = false;
                for _ in 0..if open { 8 } else { 0 } {
                    drawn.draw.fill(field.shape, stream, edge == Some(counted), out);
                    if input.has(Law::Whole) && field.shape.scalar == Scalar::F32 {
                        out.iter_mut().for_each(|word| *word = f32::from_bits(*word).round().to_bits());
                    }
                    fits = !input.is_stated() || input.admits(field, out);
                    if fits {
                        break;
                    }
                }
                if !fits {
                    within_laws(field, input, stream, out);
                }
                counted += 1;
            }
        }
        self.follow(records, domain, &mut sides);
        sides
    }

    /// Sets what follows from other inputs.
    fn follow(&self, records: [&Record; 2], domain: &Domain, sides: &mut [Vec<u32>; 2]) {
        for link in self.links.iter().filter(|link| !stated(domain, link.to)) {
            let from = sides[link.from.0][records[link.from.0].range(link.from.1)].to_vec();
            (link.follow)(&from, &mut sides[link.to.0][records[link.to.0].range(link.to.1)]);
        }
    }

    /// True for a sample that could have been drawn, but for what is stated.
    pub fn admits(&self, domain: &Domain, sample: &Sample) -> bool {
        let records = [&sample.invocation_record, &sample.case_record];
        let words = [&sample.invocation, &sample.case];
        let follows = |at: (usize, usize)| self.links.iter().any(|link| link.to == at);
        let each = (0..2).all(|side| {
            self.sides[side].iter().enumerate().all(|(k, drawn)| {
                let record = records[side];
                // What follows from another input has no range of its own.
                stated(domain, (side, k))
                    || follows((side, k))
                    || drawn.draw.admits(&record.fields()[k], &words[side][record.range(k)])
            })
        });
        each && self.links.iter().filter(|link| !stated(domain, link.to)).all(|link| {
            let from = &words[link.from.0][records[link.from.0].range(link.from.1)];
            let to = &words[link.to.0][records[link.to.0].range(link.to.1)];
            let mut follows = to.to_vec();
            let near = |(a, b): (&u32, &u32)| {
                let (a, b) = (number(*a, Scalar::F32), number(*b, Scalar::F32));
                (a - b).abs() <= NEAR * a.abs().max(b.abs()).max(1.0)
            };
            !(link.follow)(from, &mut follows) || follows.iter().zip(to).all(near)
        })
    }

    /// The sample with other values, drawn by number `key`, in the places of inputs that may be anything; none where there are
    /// no such inputs. What no name explains is between 0 and 1 there, where most functions of such a number are used, or
    /// between -1 and 0.
    pub fn redrawn(&self, domain: &Domain, sample: &Sample, key: u64) -> Option<Sample> {
        let mut stream = Stream::new(mix(REDRAWN, key));
        let mut new = sample.clone();
        let mut any = false;
        for (side, drawn) in self.sides.iter().enumerate() {
            let record = [&sample.invocation_record, &sample.case_record][side];
            let words = if side == 0 { &mut new.invocation } else { &mut new.case };
            for (k, drawn) in drawn.iter().enumerate().filter(|(k, drawn)| !drawn.sure && !stated(domain, (side, *k))) {
                let out = &mut words[record.range(k)];
                match drawn.draw {
                    // Once, it is far from 0: a temperature, a distance.
                    Draw::Interval { .. } if key == FAR && [guess::ANY, guess::SHARE].contains(&drawn.taken_for) => {
                        let far = |stream: &mut Stream| (stream.between(1.0, 12.0).exp2() as f32).to_bits();
                        out.iter_mut().for_each(|word| *word = far(&mut stream));
                    }
                    Draw::Interval { .. } if drawn.taken_for == guess::ANY => {
                        let sign = if key.is_multiple_of(2) { 1.0 } else { -1.0 };
                        let drawn = |stream: &mut Stream| (sign * stream.between(0.0625, 0.9375) as f32).to_bits();
                        out.iter_mut().for_each(|word| *word = drawn(&mut stream));
                    }
                    _ => drawn.draw.fill(record.fields()[k].shape, &mut stream, false, out),
                }
                any = true;
            }
        }
        let mut sides = [std::mem::take(&mut new.invocation), std::mem::take(&mut new.case)];
        self.follow([&sample.invocation_record, &sample.case_record], domain, &mut sides);
        [new.invocation, new.case] = sides;
        any.then_some(new)
    }

    /// The sample with input number `index` as plain as it can be; none where there is no such input.
    pub fn plainer(&self, domain: &Domain, sample: &Sample, index: usize) -> Option<Sample> {
        let own = self.sides[0].len();
        let at = if index < own { (0, index) } else { (1, index - own) };
        let drawn = self.sides[at.0].get(at.1)?;
        let mut new = sample.clone();
        if !stated(domain, at) {
            let record = [&sample.invocation_record, &sample.case_record][at.0];
            let words = if at.0 == 0 { &mut new.invocation } else { &mut new.case };
            drawn.draw.plainest(record.fields()[at.1].shape, &mut words[record.range(at.1)]);
        }
        let mut sides = [std::mem::take(&mut new.invocation), std::mem::take(&mut new.case)];
        self.follow([&sample.invocation_record, &sample.case_record], domain, &mut sides);
        [new.invocation, new.case] = sides;
        Some(new)
    }
}

fn stated(domain: &Domain, (side, k): (usize, usize)) -> bool {
    [&domain.invocation, &domain.case][side].get(k).is_some_and(InputDomain::is_stated)
}

fn drawn(field: &Field, guess: &Guess, varying: bool) -> Draw {
    let shape = field.shape;
    let [low, high] = guess.range.unwrap_or([-1.0, 1.0]);
    let real = shape.scalar == Scalar::F32;
    match guess.generator {
        "interval" if guess.taken_for == guess::SCREEN && shape == Shape::VEC4 => Draw::Screen { low, high },
        "interval" if shape.columns > 1 && shape.columns == shape.rows => match guess.taken_for {
            guess::ROTATION => Draw::Turn(Stretch::None),
            guess::NORMAL_MATRIX => Draw::Turn(Stretch::Alike),
            _ => Draw::Turn(Stretch::Each),
        },
        // Pixels lie beside edges: what is interpolated has no value for sure.
        "interval" if real => Draw::Interval { low, high, closed: guess.is_closed() && !varying },
        "direction" if real => {
            let name = field.name.to_ascii_lowercase();
            let fourth = if name.contains("tangent") {
                Fourth::Sign
            } else if ["quat", "orient", "rot"].iter().any(|word| name.contains(word)) {
                Fourth::Free
            } else {
                Fourth::Zero
            };
            Draw::Direction { varying, fourth }
        }
        "point" if real => Draw::Point { low, high },
        _ if guess.taken_for == guess::BITS => Draw::Bits { real: true },
        _ if guess.taken_for == guess::PACKED => Draw::Bits { real: false },
        name => {
            let options = Options { range: guess.range, ..Options::default() };
            let group = by_name(name).and_then(|g| Some((g, Group::new(g, &[shape], options).ok()?)));
            group.map_or(Draw::Interval { low, high, closed: false }, |(generator, group)| {
                Draw::By(generator, Box::new(group), apart::of(shape, guess.range))
            })
        }
    }
}

/// Normal matrices belong to the matrix of the model, inverses to what they are the inverse of.
fn links(records: [&Record; 2], sides: &[Vec<RealisticDraw>; 2]) -> Vec<Link> {
    let mut all: Vec<((usize, usize), &Field, &'static str)> = Vec::new();
    for (side, record) in records.into_iter().enumerate() {
        let fields = record.fields().iter().zip(&sides[side]).enumerate();
        all.extend(fields.map(|(k, (field, drawn))| ((side, k), field, drawn.taken_for)));
    }
    let plain = |field: &Field| field.name.to_ascii_lowercase().replace(['_', '.'], "").replace("matrix", "");
    let is_inverse = |field: &Field| plain(field).contains("inv");
    let mut links = Vec::new();
    for (to, field, taken_for) in &all {
        let candidates = all.iter().filter(|(_, from, _)| from.shape == Shape::MAT4 && !is_inverse(from));
        if *taken_for == guess::NORMAL_MATRIX && field.shape.array.is_none() {
            let score = |field: &Field| {
                let name = plain(field);
                u8::from(name.contains("model") || name.contains("world")) * 2 + u8::from(name.contains("view"))
            };
            let from = candidates
                .filter(|(_, from, taken)| *taken != guess::NORMAL_MATRIX && !plain(from).contains("proj"))
                .max_by_key(|(at, from, _)| (score(from), std::cmp::Reverse(*at)));
            links.extend(from.map(|(from, _, _)| Link { from: *from, to: *to, follow: matrix::normal }));
        } else if field.shape == Shape::MAT4 && is_inverse(field) {
            let name = plain(field).replace("inverse", "").replace("inv", "");
            let from = candidates.clone().find(|(_, from, _)| plain(from) == name);
            links.extend(from.map(|(from, _, _)| Link { from: *from, to: *to, follow: matrix::inverse }));
        }
    }
    links
}

impl Draw {
    /// Writes one value; `edge` asks for one where programs go to the end of what is usual.
    fn fill(&self, shape: Shape, stream: &mut Stream, edge: bool, out: &mut [u32]) {
        let between = |stream: &mut Stream, low: f64, high: f64| (stream.between(low, high) as f32).to_bits();
        // One element of an array alone, so that elements do not coincide.
        let at_edge = if edge { stream.below(out.len() / shape.element_words().max(1)) } else { usize::MAX };
        match self {
            Self::Interval { low, high, closed } => {
                for (k, element) in out.chunks_mut(shape.element_words().max(1)).enumerate() {
                    let all = k == at_edge && *closed;
                    let end = [*low, *high][stream.below(2)];
                    element.iter_mut().for_each(|word| {
                        *word = if all { (end as f32).to_bits() } else { between(stream, *low, *high) };
                    });
                }
            }
            Self::Direction { varying, fourth } => {
                for (k, element) in out.chunks_mut(shape.element_words()).enumerate() {
                    let edge = k == at_edge;
                    let n = if *fourth == Fourth::Free { element.len() } else { element.len().min(3) };
                    direction(&mut element[..n], stream, |_| edge);
                    let length = if *varying { stream.between(SHORTENED, 1.0) } else { 1.0 };
                    if *varying && !edge {
                        let scaled = |word: &mut u32| *word = (f32::from_bits(*word) * length as f32).to_bits();
                        element[..n].iter_mut().for_each(scaled);
                    }
                    if let Some(word) = element.get_mut(n) {
                        let sign = if stream.one_in(2) { 1.0_f32 } else { -1.0 };
                        *word = if *fourth == Fourth::Sign { sign.to_bits() } else { 0 };
                    }
                }
            }
            Self::Point { low, high } => {
                for element in out.chunks_mut(shape.element_words()) {
                    element.iter_mut().for_each(|word| *word = between(stream, *low, *high));
                    if let Some(word) = element.get_mut(3) {
                        *word = 1.0_f32.to_bits();
                    }
                }
            }
            Self::Turn(stretch) => {
                let rows = usize::from(shape.rows);
                for element in out.chunks_mut(shape.element_words()) {
                    rotation(rows, edge, stream, element);
                    let all = stream.between(0.5, 2.0);
                    for column in element.chunks_mut(rows) {
                        let factor = match stretch {
                            Stretch::None => continue,
                            Stretch::Alike => all,
                            Stretch::Each => stream.between(0.5, 2.0),
                        };
                        let scaled = |word: &mut u32| *word = (f32::from_bits(*word) * factor as f32).to_bits();
                        column.iter_mut().for_each(scaled);
                    }
                }
            }
            Self::Screen { low, high } => {
                let pixels = (high - low) as usize + 1;
                for (k, word) in out.iter_mut().enumerate() {
                    *word = match k {
                        0 | 1 => ((stream.below(pixels) as f64 + low) as f32).to_bits(),
                        2 => between(stream, 0.0, 1.0),
                        _ => between(stream, 0.05, 2.0),
                    };
                }
            }
            Self::Bits { real } => {
                let any = |stream: &mut Stream| if *real { between(stream, -2.0, 2.0) } else { stream.bits() as u32 };
                out.iter_mut().for_each(|word| *word = any(stream));
            }
            Self::By(generator, group, list) => {
                let place = Place { case_seed: stream.bits(), invocation: 0, exact: false };
                generator.fill(group, place, stream, out);
                list.iter().for_each(|ends| apart::set(*ends, out));
            }
        }
    }

    fn admits(&self, field: &Field, words: &[u32]) -> bool {
        let shape = field.shape;
        let values: Vec<f64> = words.iter().map(|&word| number(word, shape.scalar)).collect();
        if !values.iter().all(|value| value.is_finite()) {
            return false;
        }
        let mut elements = values.chunks(shape.element_words().max(1));
        let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        match self {
            // 0 is a value that programs reach where it is an end, and hardly ever elsewhere.
            Self::Interval { low, high, closed } => {
                let ends = f64::from(*low as f32)..=f64::from(*high as f32);
                let inside = |value: &f64| ends.contains(value);
                elements.all(|e| e.iter().all(inside) && (*closed || e.iter().any(|value| *value != 0.0)))
            }
            Self::Direction { varying, fourth } => elements.all(|e| {
                let n = if *fourth == Fourth::Free { e.len() } else { e.len().min(3) };
                let length = length(&e[..n]);
                let long = (length - 1.0).abs() <= 4e-7 || *varying && (SHORTENED..=1.0).contains(&length);
                let w = e.get(n).is_none_or(|w| if *fourth == Fourth::Sign { w.abs() == 1.0 } else { *w == 0.0 });
                long && w
            }),
            Self::Point { low, high } => elements.all(|e| {
                let n = e.len().min(3);
                let inside = e[..n].iter().all(|value| (*low..=*high).contains(value));
                inside && e[..n].iter().any(|value| *value != 0.0) && e.get(3).is_none_or(|w| *w == 1.0)
            }),
            Self::Turn(stretch) => elements.all(|e| {
                let columns: Vec<&[f64]> = e.chunks(usize::from(shape.rows)).collect();
                let lengths: Vec<f64> = columns.iter().map(|column| length(column)).collect();
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                let square = (0..columns.len())
                    .all(|i| (0..i).all(|j| dot(columns[i], columns[j]).abs() <= 1e-5 * lengths[i] * lengths[j]));
                let alike = lengths.iter().all(|l| (l - lengths[0]).abs() <= 1e-5);
                let sizes = lengths.iter().all(|l| (0.499..=2.001).contains(l));
                square
                    && sizes
                    && (*stretch == Stretch::Each || alike)
                    && match stretch {
                        Stretch::None => (lengths[0] - 1.0).abs() <= 1e-5,
                        Stretch::Alike | Stretch::Each => true,
                    }
            }),
            Self::Screen { low, high } => {
                let inside = |(k, value): (usize, &f64)| match k {
                    0 | 1 => (*low..=*high).contains(value) && value.fract() == 0.5,
                    2 => (0.0..=1.0).contains(value),
                    _ => (0.05..=2.0).contains(value),
                };
                values.iter().enumerate().all(inside)
            }
            Self::Bits { real } => !real || words.iter().all(|&word| (-2.0..=2.0).contains(&f32::from_bits(word))),
            Self::By(generator, group, list) => generator.admits(group, words) && (list.is_none() || apart::is(words)),
        }
    }

    /// Writes the plainest value that is admitted.
    fn plainest(&self, shape: Shape, out: &mut [u32]) {
        let one = 1.0_f32.to_bits();
        if let Self::By(generator, group, list) = self {
            generator.simplest(group, out);
            return list.iter().for_each(|ends| apart::set(*ends, out));
        }
        for element in out.chunks_mut(shape.element_words().max(1)) {
            match self {
                Self::Interval { low, high, .. } => {
                    let plain = [1.0, 0.5, *high].into_iter().find(|value| (*low..=*high).contains(value));
                    element.fill((plain.unwrap_or(*low) as f32).to_bits());
                }
                Self::Direction { fourth, .. } => {
                    element.fill(0);
                    element[0] = one;
                    if let Some(word) = element.get_mut(3).filter(|_| *fourth == Fourth::Sign) {
                        *word = one;
                    }
                }
                Self::Point { .. } => {
                    element.fill(0);
                    element[0] = one;
                    if let Some(word) = element.get_mut(3) {
                        *word = one;
                    }
                }
                Self::Turn(_) => {
                    let rows = usize::from(shape.rows);
                    element
                        .iter_mut()
                        .enumerate()
                        .for_each(|(k, word)| *word = if k % (rows + 1) == 0 { one } else { 0 });
                }
                Self::Screen { low, .. } => {
                    let plain = [*low as f32, *low as f32, 0.5, 1.0];
                    element.iter_mut().zip(plain).for_each(|(word, value)| *word = value.to_bits());
                }
                Self::Bits { .. } => element.fill(one),
                Self::By(..) => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guess::Role;

    const MAT3: Shape = Shape { columns: 3, rows: 3, ..Shape::MAT4 };

    fn record(fields: &[(&str, Shape)]) -> Arc<Record> {
        let field = |&(name, shape): &(&str, Shape)| Field { name: name.into(), shape };
        Arc::new(Record::new(fields.iter().map(field).collect()))
    }

    fn drawn_of(own: &Arc<Record>, case: &Arc<Record>) -> (Realistic, Domain) {
        let guess = |field: &Field| (guess::of(field, Role::Parameter), field.name.starts_with('v'));
        let realistic = Realistic::new([own, case], &guess);
        (realistic, Domain::new("f", own.fields(), case.fields(), &[]))
    }

    #[test]
    fn what_is_drawn_is_admitted_and_depends_on_its_number_alone() {
        let own = record(&[
            ("aPos", Shape::VEC4),
            ("vNormal", Shape::VEC3),
            ("tangent", Shape::VEC4),
            ("uv", Shape::VEC2.array_of(3)),
            ("boneWeights", Shape::VEC4),
            ("theta", Shape::FLOAT),
            ("id", Shape::INT),
            ("gl_FragCoord", Shape::VEC4),
        ]);
        let case = record(&[
            ("projection", Shape::MAT4),
            ("viewModel", Shape::MAT4),
            ("normalMatrix", MAT3),
            ("turn", MAT3),
            ("inverseProjection", Shape::MAT4),
        ]);
        let (realistic, domain) = drawn_of(&own, &case);
        let batch = realistic.batch((&own, &case), &domain, 5, 0, 2048);
        let part = realistic.batch((&own, &case), &domain, 5, 1000, 16);
        assert_eq!(part.invocations, batch.invocations[1000 * own.words()..1016 * own.words()]);
        for k in 0..2048 {
            let sample = Sample::of(&batch, k);
            assert!(realistic.admits(&domain, &sample), "{:?}", sample);
        }
        // Another normal matrix does not belong to the model.
        let mut other = Sample::of(&batch, 0);
        other.set("normalMatrix", &[8.0, 0.0, 0.0, 0.0, 8.0, 0.0, 0.0, 0.0, 8.0]);
        assert!(!realistic.admits(&domain, &other));
        for input in 0..own.fields().len() + case.fields().len() {
            let plainer = realistic.plainer(&domain, &Sample::of(&batch, 1), input).unwrap();
            assert!(realistic.admits(&domain, &plainer), "{input}: {:?}", plainer);
        }
    }

    #[test]
    fn one_input_at_a_time_is_at_an_edge() {
        let own = record(&[("lightDir", Shape::VEC3), ("viewDir", Shape::VEC3), ("color", Shape::VEC3)]);
        let (case, count) = (record(&[]), 4096);
        let (realistic, domain) = drawn_of(&own, &case);
        let batch = realistic.batch((&own, &case), &domain, 5, 0, count);
        let axis = |v: &[u32]| v.iter().filter(|word| **word << 1 == 0).count() == 2;
        let black = |v: &[u32]| v.iter().all(|word| *word == 0);
        let count = |is: &dyn Fn(&[u32]) -> bool| (0..count).filter(|&k| is(batch.invocation(k))).count();
        assert!(count(&|v| axis(&v[..3])) > 50 && count(&|v| axis(&v[3..6])) > 50 && count(&|v| black(&v[6..])) > 20);
        assert_eq!(count(&|v| axis(&v[..3]) && (axis(&v[3..6]) || black(&v[6..]))), 0);
    }
}
