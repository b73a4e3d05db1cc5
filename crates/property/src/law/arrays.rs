//! Laws about arrays, which is what buffers of kernels are: order of elements, prefixes, sums.

use super::LawKind;
use crate::Sample;
use crate::ball::Ball;
use crate::rule::{Claims, hash, on_grid, put, with};
use crate::stream::Stream;
use base::value::{Field, Shape};

/// The inputs to run; `None` where the law says nothing.
pub(super) fn related(kind: &LawKind, sample: &Sample) -> Option<Vec<Sample>> {
    match kind {
        LawKind::Unordered { inputs } => {
            let len = shape(sample, inputs.first()?)?.elements();
            let mut order: Vec<usize> = (0..len).collect();
            let mut stream = Stream::new(hash(sample));
            (1..len).rev().for_each(|k| order.swap(k, stream.below(k + 1)));
            Some(vec![sample.clone(), rearranged(sample, inputs, |k| order[k])?])
        }
        LawKind::Prefix { inputs } => {
            let len = shape(sample, inputs.first()?)?.elements();
            let kept = kept(sample, len);
            // What stands behind comes from anywhere in the array, so that every element is one that was generated.
            let mut stream = Stream::new(hash(sample) ^ 1);
            let from: Vec<usize> = (0..len).map(|k| if k < kept { k } else { stream.below(len) }).collect();
            Some(vec![sample.clone(), rearranged(sample, inputs, |k| from[k])?])
        }
        LawKind::Sorts { .. } | LawKind::Sums { .. } => Some(vec![sample.clone()]),
        LawKind::Additive { inputs } => {
            // Sums stay exact on a grid.
            let on = |change: &dyn Fn(&[f64]) -> Vec<f64>| {
                with(sample, |s| inputs.iter().try_for_each(|name| put(s, name, &change(&sample.get(name)))))
            };
            let first = |x: &[f64]| -> Vec<f64> { x.iter().map(|&x| on_grid(x)).collect() };
            let second = |x: &[f64]| -> Vec<f64> { x.iter().rev().map(|&x| on_grid(x / 2.0)).collect() };
            let both = |x: &[f64]| -> Vec<f64> { first(x).iter().zip(second(x)).map(|(x, y)| x + y).collect() };
            Some(vec![on(&first)?, on(&second)?, on(&both)?])
        }
        _ => None,
    }
}

/// Claims about one output; `ball(run, word)` is one of its words.
pub(super) fn claim(
    kind: &LawKind,
    field: &Field,
    inputs: &[Sample],
    ball: &dyn Fn(usize, usize) -> Ball,
    claims: &mut Claims<'_>,
) {
    let words = field.shape.words();
    let name = |word: usize| format!("{}{}", field.name, field.shape.component_name(word));
    match kind {
        LawKind::Unordered { .. } => (0..words).for_each(|k| claims.equal(name(k), ball(1, k), ball(0, k))),
        LawKind::Prefix { .. } => {
            let kept = kept(&inputs[0], field.shape.elements()) * field.shape.element_words();
            (0..kept).for_each(|k| claims.equal(name(k), ball(1, k), ball(0, k)));
        }
        LawKind::Sorts { input, rising } => {
            let mut values = inputs[0].get(input);
            values.sort_by(f64::total_cmp);
            if !rising {
                values.reverse();
            }
            (0..words).zip(values).for_each(|(k, value)| claims.equal(name(k), ball(0, k), Ball::from(value)));
        }
        LawKind::Sums { total, rows } => {
            let part = words / rows;
            for row in 0..*rows {
                let sum = (row * part..(row + 1) * part).fold(Ball::from(0.0), |sum, k| sum + ball(0, k));
                let of = if *rows > 1 {
                    format!("sum of {} in row {row}", field.name)
                } else {
                    format!("sum of {}", field.name)
                };
                claims.equal(of, sum, Ball::from(*total));
            }
        }
        LawKind::Additive { .. } => {
            (0..words).for_each(|k| claims.equal(name(k), ball(2, k), ball(0, k) + ball(1, k)));
        }
        _ => {}
    }
}

/// Elements of the prefix that stays as it is: one to all.
fn kept(sample: &Sample, len: usize) -> usize {
    1 + (hash(sample) % len.max(1) as u64) as usize
}

fn shape(sample: &Sample, name: &str) -> Option<Shape> {
    let records = [&sample.invocation_record, &sample.case_record];
    records.iter().find_map(|r| r.index_of(name).map(|i| r.fields()[i].shape))
}

/// The sample with other elements in the places of arrays: `from(k)` is the one that comes to place `k`.
fn rearranged(sample: &Sample, names: &[String], from: impl Fn(usize) -> usize) -> Option<Sample> {
    with(sample, |s| {
        for name in names {
            let each = shape(sample, name)?.element_words();
            let before = sample.words(name)?;
            for (k, element) in s.words_mut(name)?.chunks_mut(each).enumerate() {
                element.copy_from_slice(before.chunks(each).nth(from(k))?);
            }
        }
        Some(())
    })
}
