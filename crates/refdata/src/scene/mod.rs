//! Formulas that are geometry, as scenes in glTF 2.0: what other programs show and deform themselves.
//!
//! Numbers are binary32 numbers nearest to the exact ones. What the host animates in the listings is an
//! animation here: the time of a morph, weights of targets, turns of bones.

mod arm;
mod glb;
mod grid;
mod line;

use serde_json::{Value, json};

use super::document::{SCHEMA, SCHEMA_VERSION};
use chapter::exact::{Exact, Words};
use number::twofold::{Twofold, WIDTH};

use glb::{Buffer, Use};
use grid::Grid;

/// Why a formula has no scene.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error(
    "`{0}` is no geometry; scenes are made of sphere, cylinder, morph, morph_targets, joints, two_bones, skinning, \
     hair, catmull_rom"
)]
pub struct NoScene(pub String);

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

/// The scene of a formula with about this many vertices, as the bytes of a GLB file.
///
/// # Errors
/// [`NoScene`] for a formula that is no geometry.
pub fn scene(formula: &str, vertices: u64) -> Result<Vec<u8>, NoScene> {
    let unknown = || NoScene(formula.to_owned());
    let exact = Exact::by_name(formula).ok_or_else(unknown)?;
    let grid = Grid::of(vertices);
    let mut buffer = Buffer::default();
    let mut content = match exact {
        Exact::Sphere | Exact::Cylinder => {
            let mesh = grid.mesh(exact, &mut buffer);
            json!({ "meshes": [mesh], "nodes": [{ "mesh": 0, "name": formula }] })
        }
        Exact::Morph => grid.morph(&mut buffer, formula, &[Exact::Cylinder]),
        Exact::MorphTargets => {
            grid.morph(&mut buffer, formula, &[Exact::Cylinder, Exact::Sphere, Exact::Cylinder, Exact::Sphere])
        }
        Exact::Joints => arm::arm(&mut buffer, grid, formula, arm::Weights::Rigid),
        Exact::TwoBones | Exact::Skinning => arm::arm(&mut buffer, grid, formula, arm::Weights::Distance),
        Exact::Hair => line::hair(&mut buffer, vertices),
        Exact::CatmullRom => line::spline(&mut buffer, vertices),
        Exact::Hermite | Exact::Cardinal | Exact::KochanekBartels | Exact::SegmentDistance | Exact::BoneWeight => {
            return Err(unknown());
        }
    };
    let source = chapter::formula::by_name(formula).map_or("", |f| f.source);
    content["asset"] = json!({
        "version": "2.0",
        "generator": concat!("shadercheck ", env!("CARGO_PKG_VERSION")),
        "extras": { "schema": SCHEMA, "schema_version": SCHEMA_VERSION, "formula": formula, "source": source },
    });
    content["scene"] = json!(0);
    if content.get("scenes").is_none() {
        content["scenes"] = json!([{ "nodes": [0] }]);
    }
    Ok(buffer.finish(content))
}

/// One animated property of one node.
fn animation(buffer: &mut Buffer, channels: Vec<Channel>) -> Value {
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
