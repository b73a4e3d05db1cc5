//! What the script of the page draws, as JSON: places as whole numbers of 16 bits, verdicts as bytes.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::Page;
use engine::suite::run::{Cell, Scene, State};
use judge::verdict::{Blame, Reason};

/// The place of what has none.
const NONE: i16 = i16::MIN;
/// How many times the size of a shape a point may be away from where it should be and still be drawn there.
const FARTHEST: f64 = 4.0;

/// The data of a page.
pub(super) fn data(page: &Page<'_>) -> Value {
    let mut positions = Positions::default();
    let entry = |gallery: &Option<engine::suite::run::Gallery>| match gallery.as_ref().and_then(|g| g.scene.as_ref()) {
        Some(scene) => positions.entry(scene),
        None => json!({}),
    };
    let entries: Vec<Value> = page.galleries.iter().map(entry).collect();
    let reasons: Vec<String> = Reason::ALL.iter().map(ToString::to_string).collect();
    let suites: Vec<&str> = super::suites(page.summary).into_iter().map(|(name, _)| name).collect();
    json!({ "suites": suites, "entries": entries, "positions": positions.all, "reasons": reasons })
}

/// Where points should be: the same for every lane on which a suite ran, and so written once.
#[derive(Default)]
struct Positions {
    all: Vec<Value>,
}

impl Positions {
    fn entry(&mut self, scene: &Scene) -> Value {
        let axis =
            |axis: &engine::suite::run::Axis| json!({ "name": axis.name, "range": axis.range, "count": axis.count });
        let place = scene.output.as_ref().and_then(|_| Frame::of(&scene.expected));
        let (position, off, step) = match &place {
            Some(frame) => {
                let position = frame.position(&scene.expected);
                let number = self.all.iter().position(|known| *known == position).unwrap_or_else(|| {
                    self.all.push(position);
                    self.all.len() - 1
                });
                let (off, step) = frame.off(scene);
                (json!(number), json!(off), step)
            }
            None => (Value::Null, Value::Null, 0.0),
        };
        json!({
            "axes": scene.axes.iter().map(axis).collect::<Vec<_>>(),
            "frames": scene.frames,
            "surface": scene.is_surface,
            "output": scene.output,
            "lines": scene.lines,
            "cells": STANDARD.encode(scene.cells.iter().flat_map(bytes).collect::<Vec<u8>>()),
            "worst": scene.worst.iter().map(|worst| json!({ "place": worst.place })).collect::<Vec<_>>(),
            "position": position,
            "off": off,
            "step": step,
        })
    }
}

/// The box around what is drawn.
struct Frame {
    center: [f64; 3],
    half: f64,
}

fn is_finite(point: &[f64; 3]) -> bool {
    point.iter().all(|c| c.is_finite())
}

impl Frame {
    fn of(points: &[[f64; 3]]) -> Option<Self> {
        let points: Vec<&[f64; 3]> = points.iter().filter(|point| is_finite(point)).collect();
        let first = **points.first()?;
        let (mut lo, mut hi) = (first, first);
        for point in points {
            for c in 0..3 {
                lo[c] = lo[c].min(point[c]);
                hi[c] = hi[c].max(point[c]);
            }
        }
        let center = std::array::from_fn(|c| (lo[c] + hi[c]) / 2.0);
        let half = (0..3).map(|c| (hi[c] - lo[c]) / 2.0).fold(0.0_f64, f64::max);
        Some(Self { center, half: if half > 0.0 { half } else { 1.0 } })
    }

    fn position(&self, points: &[[f64; 3]]) -> Value {
        let word = |point: &[f64; 3], c: usize| (point[c] - self.center[c]) / self.half;
        json!({ "center": self.center, "half": self.half, "at": words(points, word) })
    }

    /// How far the lane's points are off, as parts of the largest distance, and that distance.
    fn off(&self, scene: &Scene) -> (String, f64) {
        let off: Vec<[f64; 3]> = scene
            .expected
            .iter()
            .zip(&scene.actual)
            .map(|(e, a)| std::array::from_fn(|c| (a[c] - e[c]).clamp(-FARTHEST * self.half, FARTHEST * self.half)))
            .collect();
        let largest = off.iter().filter(|p| is_finite(p)).flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        (words(&off, |point, c| if largest > 0.0 { point[c] / largest } else { 0.0 }), largest)
    }
}

fn words(points: &[[f64; 3]], part: impl Fn(&[f64; 3], usize) -> f64) -> String {
    let mut bytes = Vec::with_capacity(points.len() * 6);
    for point in points {
        for c in 0..3 {
            let word = if is_finite(point) { (part(point, c) * 32767.0).round() as i16 } else { NONE };
            bytes.extend_from_slice(&word.to_le_bytes());
        }
    }
    STANDARD.encode(bytes)
}

/// A cell as the script reads it: verdict, error in ULP, error ÷ bound.
fn bytes(cell: &Cell) -> [u8; 3] {
    let state = match cell.state {
        State::Agrees => 0,
        State::Deviates(Blame::Shader) => 1,
        State::Deviates(Blame::Lane) => 2,
        State::Nothing => 3,
        State::Undetermined(reason) => 4 + reason as u8,
    };
    let ulp = if cell.ulp.is_nan() { f64::INFINITY } else { cell.ulp };
    [state, logarithm(ulp), if cell.ratio.is_nan() { 254 } else { logarithm(cell.ratio) }]
}

/// A number by its logarithm, in quarters of a power of two.
fn logarithm(x: f64) -> u8 {
    if x == 0.0 {
        0
    } else if x.is_finite() {
        (1.0 + ((x.log2() + 16.0) * 4.0).round()).clamp(1.0, 253.0) as u8
    } else {
        255
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_within_a_tenth() {
        for x in [1e-3, 0.4, 1.0, 5.5, 1e6] {
            let back = f64::exp2((f64::from(logarithm(x)) - 1.0) / 4.0 - 16.0);
            assert!((back / x).ln().abs() < 0.1, "{x} {back}");
        }
        assert_eq!((logarithm(0.0), logarithm(f64::INFINITY), logarithm(1e-30), logarithm(1e30)), (0, 255, 1, 253));
    }

    #[test]
    fn points_without_a_place_are_told_from_those_with_one() {
        let points = [[1.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0], [-1.0, 0.5, 0.0]];
        let frame = Frame::of(&points).unwrap();
        assert_eq!((frame.half, frame.center), (1.0, [0.0, 0.25, 0.0]));
        let bytes = STANDARD.decode(words(&points, |p, c| p[c])).unwrap();
        let words: Vec<i16> = bytes.chunks(2).map(|b| i16::from_le_bytes([b[0], b[1]])).collect();
        assert_eq!(words, [32767, 0, 0, NONE, NONE, NONE, -32767, 16384, 0]);
        assert!(Frame::of(&[[f64::NAN; 3]]).is_none());
    }
}
