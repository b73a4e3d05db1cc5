//! Strands of hair and a curve, as strips of lines.

use serde_json::{Value, json};

use super::glb::{GlbBuffer, Use};
use super::{Channel, animation, evaluate, unit};
use crate::exact::Exact;
use property::Stream;

/// Nodes of a strand, and pieces of a segment, as in the suite and its shader.
const NODES: usize = 12;
const PIECES: usize = 4;

/// Words of a vertex of the formula: position, to the viewer, to the light, along.
const VERTEX: usize = 13;

/// Strands that grow outward from a sphere of radius 1, each a little bent: about this many vertices.
pub(super) fn hair(buffer: &mut GlbBuffer, vertices: u64) -> Value {
    let each = (NODES - 1) * PIECES + 1;
    let strands = (vertices.min(1 << 24) as usize / each).max(1);
    let mut primitives = Vec::new();
    for strand in 0..strands {
        let mut stream = Stream::new(strand as u64);
        let mut corner = || f64::from(stream.between(-1.0, 1.0) as f32);
        let root = [corner(), corner(), corner()];
        let size = root.iter().map(|x| x * x).sum::<f64>().sqrt().max(0.125);
        let bend = [corner(), corner(), corner()];
        let node = |k: usize| -> [f64; 4] {
            // The two nodes at the ends stand twice.
            let k = k.clamp(1, NODES) - 1;
            let t = k as f64 / (NODES - 1) as f64;
            let at = |c: usize| f64::from((root[c] / size * (1.0 + t) + 0.5 * bend[c] * t * t) as f32);
            [at(0), at(1), at(2), 1.0]
        };
        let mut columns: [Vec<[f32; 3]>; 4] = Default::default();
        for segment in 0..NODES - 1 {
            let nodes = (0..4).flat_map(|k| node(segment + k));
            let inputs: Vec<f64> = nodes.chain(unit()).collect();
            let out = evaluate(Exact::Hair, &inputs);
            // The first vertex of a segment is the last of the one before.
            for vertex in out.chunks_exact(VERTEX).skip(usize::from(segment > 0)) {
                for (column, at) in columns.iter_mut().zip([0, 4, 7, 10]) {
                    column.push([vertex[at], vertex[at + 1], vertex[at + 2]]);
                }
            }
        }
        let names = ["POSITION", "_V", "_L", "_T"];
        let attributes: serde_json::Map<String, Value> = names
            .iter()
            .zip(&columns)
            .map(|(&name, column)| (name.to_owned(), json!(buffer.floats(column, "VEC3", Use::Vertices))))
            .collect();
        primitives.push(json!({ "attributes": attributes, "mode": 3 }));
    }
    json!({ "meshes": [{ "name": "hair", "primitives": primitives }], "nodes": [{ "mesh": 0, "name": "hair" }] })
}

/// A Catmull-Rom curve through eight nodes as a strip, and a point that runs along it: its key frames have
/// the tangents of the curve, with which glTF interpolates by the same cubic.
pub(super) fn spline(buffer: &mut GlbBuffer, vertices: u64) -> Value {
    const CURVE: [[f64; 3]; 8] = [
        [-4.0, 0.0, 0.0],
        [-3.0, 1.0, 0.5],
        [-1.5, -1.0, 0.0],
        [0.0, 0.5, -0.5],
        [1.0, 2.0, 0.0],
        [2.5, 0.0, 1.0],
        [3.0, -1.0, 0.0],
        [4.0, 0.0, 0.0],
    ];
    let segments = CURVE.len() - 3;
    let pieces = (vertices.min(1 << 24) as usize / segments).max(1);
    let at = |segment: usize, s: f64| -> ([f32; 3], [f32; 3]) {
        let nodes = (0..4).flat_map(|k| CURVE[segment + k].into_iter().chain([1.0]));
        let inputs: Vec<f64> = nodes.chain([s]).collect();
        let out = evaluate(Exact::CatmullRom, &inputs);
        ([out[0], out[1], out[2]], [out[4], out[5], out[6]])
    };
    let mut points = vec![at(0, 0.0).0];
    for segment in 0..segments {
        points.extend((1..=pieces).map(|k| at(segment, k as f64 / pieces as f64).0));
    }
    let position = buffer.floats(&points, "VEC3", Use::Vertices);
    // In-tangent, value, out-tangent of each key frame.
    let frame = |k: usize| if k < segments { at(k, 0.0) } else { at(segments - 1, 1.0) };
    let frames: Vec<[f32; 3]> = (0..=segments).map(frame).flat_map(|(p, tangent)| [tangent, p, tangent]).collect();
    let output = buffer.floats(&frames, "VEC3", Use::Other);
    let times = (0..=segments).map(|k| k as f32).collect();
    let channel = Channel { node: 1, path: "translation", interpolation: "CUBICSPLINE", times, output };
    json!({
        "meshes": [{
            "name": "catmull_rom",
            "primitives": [{ "attributes": { "POSITION": position }, "mode": 3 }],
        }],
        "nodes": [
            { "mesh": 0, "name": "curve" },
            { "name": "runner", "translation": frames[1] },
        ],
        "scenes": [{ "nodes": [0, 1] }],
        "animations": animation(buffer, vec![channel]),
    })
}
