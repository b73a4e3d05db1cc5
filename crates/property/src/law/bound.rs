//! A law on samples: which inputs it wants to see, and what must hold between the outputs.

use super::{LawKind, arrays};
use crate::ball::{Ball, output};
use crate::rule::{Claims, Exact, hash, on_grid, put, with};
use crate::{Claim, Observed, Relation, Sample, decode, encode};
use base::value::{Field, Scalar};

/// Half a step of binary32, relative to the number.
const ROUNDING: f64 = 1.0 / (1_u32 << 24) as f64;

/// What becomes of an output in a rigid motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    Plain,
    Point,
    Direction,
}

/// A law that fits its shader.
pub(super) struct BoundLaw {
    pub kind: LawKind,
    pub name: String,
    pub statement: String,
    /// Outputs with their first word among those of a vertex.
    pub outputs: Vec<(Field, usize, Aim)>,
    /// Words of a vertex.
    pub width: usize,
    /// Range of the input of a monotone law.
    pub range: Option<[f64; 2]>,
}

impl Relation for BoundLaw {
    fn name(&self) -> &str {
        &self.name
    }

    fn statement(&self) -> &str {
        &self.statement
    }

    fn inputs(&self, sample: &Sample) -> Vec<Sample> {
        self.related(sample).unwrap_or_default()
    }

    fn claims(&self, inputs: &[Sample], outputs: &[Observed], claims: &mut Vec<Claim>) {
        let mut claims = Claims(claims);
        let Some((first, others)) = outputs.split_first() else { return };
        if others.iter().any(|o| o.vertices != first.vertices) {
            claims.holds("the number of vertices", false);
            return;
        }
        for vertex in 0..first.vertices {
            for (field, at, aim) in &self.outputs {
                let at = vertex * self.width + at;
                self.claim(field, (at, *aim), inputs, outputs, &mut claims);
            }
        }
    }
}

impl BoundLaw {
    /// The inputs to run; `None` where the law says nothing.
    fn related(&self, sample: &Sample) -> Option<Vec<Sample>> {
        let change = |change: &dyn Fn(f64) -> f64, names: &[String]| {
            with(sample, |s| names.iter().try_for_each(|name| map(s, name, change)))
        };
        match &self.kind {
            LawKind::Odd { inputs } | LawKind::Even { inputs } => Some(vec![sample.clone(), change(&|x| -x, inputs)?]),
            LawKind::Scales { inputs, .. } => Some(vec![sample.clone(), change(&|x| 2.0 * x, inputs)?]),
            LawKind::Periodic { inputs, period } => {
                // Sums stay exact on a grid that the period is on.
                let on_grid = |x: f64| if on_grid(*period) == *period { on_grid(x) } else { x };
                let sample = &change(&on_grid, inputs)?;
                let shifted = with(sample, |s| {
                    for name in inputs {
                        let values: Vec<f64> = s.get(name).iter().map(|x| x + period).collect();
                        s.set(name, &values);
                    }
                    Some(())
                })?;
                let mut all = vec![sample.clone()];
                // A period that is not held exactly lands beside the number that is meant: what one step
                // of binary32 to either side changes, the law leaves open.
                let exact = inputs
                    .iter()
                    .all(|name| sample.get(name).iter().zip(shifted.get(name)).all(|(x, y)| x + period == y));
                if !exact {
                    all.extend(neighbours(&shifted, inputs));
                }
                all.insert(1, shifted);
                Some(all)
            }
            LawKind::Monotone { input, .. } => {
                let x = sample.get(input)[0];
                let part = (hash(sample) % 1024 + 1) as f64 / 1024.0;
                let more = match self.range {
                    Some([_, hi]) => x + part * part * (hi - x),
                    None => x + part * part * x.abs().max(1.0),
                };
                let mut after = sample.clone();
                after.set(input, &[more]);
                (after.get(input)[0] > x).then(|| vec![sample.clone(), after])
            }
            LawKind::Range { .. } | LawKind::Unit => Some(vec![sample.clone()]),
            LawKind::Symmetric { inputs } => {
                let words: Vec<Vec<u32>> = inputs.iter().filter_map(|n| sample.words(n).map(<[u32]>::to_vec)).collect();
                let ordered = |order: &dyn Fn(usize) -> usize| {
                    with(sample, |s| {
                        for (k, name) in inputs.iter().enumerate() {
                            s.words_mut(name)?.copy_from_slice(&words[order(k)]);
                        }
                        Some(())
                    })
                };
                // One exchange and one turn make all orders.
                let mut all = vec![sample.clone(), ordered(&|k| if k < 2 { 1 - k } else { k })?];
                if inputs.len() > 2 {
                    all.push(ordered(&|k| (k + 1) % inputs.len())?);
                }
                Some(all)
            }
            LawKind::Rigid { points, directions, mirrored } => {
                let first = with(sample, |s| {
                    for name in points.iter().chain(directions).filter(|name| sample.words(name).is_some()) {
                        map(s, name, &on_grid)?;
                    }
                    Some(())
                })?;
                let motion = motion(&first, *mirrored);
                let second = with(&first, |s| {
                    for (names, w) in [(points, 1.0), (directions, 0.0)] {
                        for name in names.iter().filter(|name| first.words(name).is_some()) {
                            let part = rows(s, name);
                            let moved: Vec<f64> = s.get(name).chunks(part).flat_map(|p| moved(&motion, p, w)).collect();
                            put(s, name, &moved)?;
                        }
                    }
                    Some(())
                })?;
                Some(vec![first, second])
            }
            kind @ (LawKind::Unordered { .. }
            | LawKind::Prefix { .. }
            | LawKind::Sorts { .. }
            | LawKind::Sums { .. }
            | LawKind::Additive { .. }) => arrays::related(kind, sample),
        }
    }

    /// What must hold of one output of one vertex, whose first word is `at`.
    fn claim(
        &self,
        field: &Field,
        (at, aim): (usize, Aim),
        inputs: &[Sample],
        outputs: &[Observed],
        claims: &mut Claims<'_>,
    ) {
        let words = field.shape.words();
        let ball = |run: usize, word: usize| output(&outputs[run], at + word);
        let name = |word: usize| format!("{}{}", field.name, field.shape.component_name(word));
        match &self.kind {
            LawKind::Odd { .. } => (0..words).for_each(|k| claims.equal(name(k), ball(1, k), -ball(0, k))),
            LawKind::Even { .. } => (0..words).for_each(|k| claims.equal(name(k), ball(1, k), ball(0, k))),
            LawKind::Symmetric { .. } => {
                for run in 1..outputs.len() {
                    (0..words).for_each(|k| claims.equal(name(k), ball(run, k), ball(0, k)));
                }
            }
            LawKind::Scales { degree, .. } => {
                (0..words).for_each(|k| claims.equal(name(k), ball(1, k), ball(0, k) * 2.0_f64.powi(*degree)));
            }
            LawKind::Periodic { .. } => {
                for k in 0..words {
                    let mut right = ball(1, k);
                    // Neighbours come in pairs, one pair for each component of the inputs.
                    for pair in 1..outputs.len() / 2 {
                        let step = |run: usize| (ball(run, k) - right).mid.abs() + ball(run, k).rad;
                        let open = step(2 * pair).max(step(2 * pair + 1));
                        // The slope may change over the step.
                        right = Ball { rad: right.rad + 2.0 * open, ..right };
                    }
                    claims.equal(name(k), right, ball(0, k));
                }
            }
            LawKind::Monotone { rising, .. } => {
                let (less, more) = if *rising { (0, 1) } else { (1, 0) };
                (0..words).for_each(|k| claims.at_most(name(k), ball(less, k), ball(more, k)));
            }
            LawKind::Range { range: [lo, hi] } => {
                for k in 0..words {
                    claims.at_most(name(k), ball(0, k), Ball::from(*hi));
                    claims.at_most(format!("-{}", name(k)), -ball(0, k), Ball::from(-*lo));
                }
            }
            LawKind::Unit => {
                let part = usize::from(field.shape.rows);
                for element in 0..words / part {
                    // Components are binary32 numbers, and no nearer to real ones than their rounding.
                    let rounded = |x: Ball| Ball { rad: x.rad + x.mid.abs() * ROUNDING, ..x };
                    let parts = (0..part).map(|k| rounded(ball(0, element * part + k)));
                    let square = parts.fold(Ball::from(0.0), |sum, x| sum + x * x);
                    let of = if words > part { format!("{}[{element}]", field.name) } else { field.name.clone() };
                    claims.equal(format!("|{of}|²"), square, Ball::from(1.0));
                }
            }
            LawKind::Rigid { mirrored, .. } => {
                let motion = motion(&inputs[0], *mirrored);
                let part = match aim {
                    Aim::Plain => return (0..words).for_each(|k| claims.equal(name(k), ball(1, k), ball(0, k))),
                    Aim::Point | Aim::Direction => usize::from(field.shape.rows),
                };
                for element in (0..words).step_by(part) {
                    let w = if aim == Aim::Point { 1.0 } else { 0.0 };
                    let before = std::array::from_fn(|k| if k < part { ball(0, element + k) } else { Ball::from(w) });
                    let after = motion.apply_ball(before);
                    (0..part).for_each(|k| claims.equal(name(element + k), ball(1, element + k), after[k]));
                }
            }
            kind @ (LawKind::Unordered { .. }
            | LawKind::Prefix { .. }
            | LawKind::Sorts { .. }
            | LawKind::Sums { .. }
            | LawKind::Additive { .. }) => arrays::claim(kind, field, inputs, &ball, claims),
        }
    }
}

/// Changes every component of an input; `None` where the result is not held exactly.
fn map(sample: &mut Sample, name: &str, change: &dyn Fn(f64) -> f64) -> Option<()> {
    let values: Vec<f64> = sample.get(name).into_iter().map(change).collect();
    put(sample, name, &values)
}

/// Components of one vector of an input.
fn rows(sample: &Sample, name: &str) -> usize {
    let records = [&sample.invocation_record, &sample.case_record];
    let shape = records.iter().find_map(|r| r.index_of(name).map(|i| r.fields()[i].shape));
    shape.map_or(1, |shape| usize::from(shape.rows))
}

/// The motion of a sample: chosen by its words, which are those of the first input.
fn motion(sample: &Sample, mirrored: bool) -> Exact {
    let motion = Exact::rigid(hash(sample));
    if mirrored { motion } else { motion.proper() }
}

fn moved(motion: &Exact, p: &[f64], w: f64) -> Vec<f64> {
    let column = [p[0], p[1], p[2], p.get(3).copied().unwrap_or(w)];
    motion.apply(column)[..p.len()].to_vec()
}

/// The sample with one component one step of binary32 up and down, for each component of the inputs.
fn neighbours(sample: &Sample, inputs: &[String]) -> Vec<Sample> {
    let mut all = Vec::new();
    for name in inputs {
        for k in 0..sample.words(name).map_or(0, <[u32]>::len) {
            for step in [f32::next_down as fn(f32) -> f32, f32::next_up] {
                let mut copy = sample.clone();
                if let Some(words) = copy.words_mut(name) {
                    let value = step(decode(words[k], Scalar::F32) as f32);
                    words[k] = encode(f64::from(value), Scalar::F32);
                }
                all.push(copy);
            }
        }
    }
    all
}
