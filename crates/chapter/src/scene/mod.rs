//! Formulas that are geometry, as scenes in glTF 2.0: what other programs show and deform themselves.
//!
//! Numbers are binary32 numbers nearest to the exact ones. What the host animates in the listings is an
//! animation here: the time of a morph, weights of targets, turns of bones.

mod arm;
mod glb;
mod grid;
mod line;

use serde_json::{Value, json};

use engine::catalogue::Scene;
use number::twofold::{Twofold, WIDTH};

use crate::exact::{Exact, Words};
use arm::{Weights, arm};
use glb::{GlbBuffer, Use};
use grid::Grid;

/// All scenes, in the order of the formulas.
pub static ALL: &[Scene] = &[
    Scene { formula: "sphere", glb: |vertices, asset| file(vertices, asset, |b, grid| grid.surface(Exact::Sphere, b)) },
    Scene {
        formula: "cylinder",
        glb: |vertices, asset| file(vertices, asset, |b, grid| grid.surface(Exact::Cylinder, b)),
    },
    Scene {
        formula: "morph",
        glb: |vertices, asset| file(vertices, asset, |b, grid| grid.morph(b, "morph", &[Exact::Cylinder])),
    },
    Scene {
        formula: "morph_targets",
        glb: |vertices, asset| file(vertices, asset, |b, grid| grid.morph(b, "morph_targets", &TARGETS)),
    },
    Scene {
        formula: "joints",
        glb: |vertices, asset| file(vertices, asset, |b, grid| arm(b, grid, "joints", Weights::Rigid)),
    },
    Scene {
        formula: "two_bones",
        glb: |vertices, asset| file(vertices, asset, |b, grid| arm(b, grid, "two_bones", Weights::Distance)),
    },
    Scene {
        formula: "skinning",
        glb: |vertices, asset| file(vertices, asset, |b, grid| arm(b, grid, "skinning", Weights::Distance)),
    },
    Scene { formula: "hair", glb: |vertices, asset| file(vertices, asset, |b, _| line::hair(b, vertices)) },
    Scene { formula: "catmull_rom", glb: |vertices, asset| file(vertices, asset, |b, _| line::spline(b, vertices)) },
];

/// What the sphere becomes with four targets.
const TARGETS: [Exact; 4] = [Exact::Cylinder, Exact::Sphere, Exact::Cylinder, Exact::Sphere];

/// Inputs of a single evaluation.
struct Single<'a>(&'a [f64]);

impl Words<Twofold> for Single<'_> {
    fn word(&self, index: usize) -> Twofold {
        Twofold::of([self.0[index]; WIDTH])
    }
}

/// The exact outputs of a formula, rounded once.
fn evaluate(formula: Exact, inputs: &[f64]) -> Vec<f32> {
    let mut out = vec![Twofold::of([0.0; WIDTH]); formula.outputs()];
    formula.evaluate(&Single(inputs), &mut out);
    let first = |column: &Twofold| {
        let mut bits = [0; WIDTH];
        column.rounded_32(&mut bits);
        // Normals point nowhere else for a zero with a sign.
        f32::from_bits(bits[0]) + 0.0
    };
    out.iter().map(first).collect()
}

/// Columns of the unit matrix.
fn unit() -> [f64; 16] {
    std::array::from_fn(|k| if k % 5 == 0 { 1.0 } else { 0.0 })
}

/// The GLB file with what `content` makes, over a grid of about this many vertices.
fn file(vertices: u64, asset: Value, content: impl FnOnce(&mut GlbBuffer, Grid) -> Value) -> Vec<u8> {
    let mut buffer = GlbBuffer::default();
    let mut content = content(&mut buffer, Grid::of(vertices));
    content["asset"] = asset;
    content["scene"] = json!(0);
    if content.get("scenes").is_none() {
        content["scenes"] = json!([{ "nodes": [0] }]);
    }
    buffer.finish(content)
}

/// One animated property of one node.
fn animation(buffer: &mut GlbBuffer, channels: Vec<Channel>) -> Value {
    let (mut list, mut samplers) = (Vec::new(), Vec::new());
    for Channel { node, path, interpolation, times, output } in channels {
        let times: Vec<[f32; 1]> = times.iter().map(|&t| [t]).collect();
        let input = buffer.floats(&times, "SCALAR", Use::Other);
        list.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
    }
    json!([{ "channels": list, "samplers": samplers }])
}

/// A property of a node with its key frames.
struct Channel {
    node: usize,
    path: &'static str,
    interpolation: &'static str,
    times: Vec<f32>,
    output: usize,
}

#[cfg(test)]
mod tests;
