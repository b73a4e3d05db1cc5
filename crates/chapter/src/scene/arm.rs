//! An arm with a skin: a tube around two bones, its vertices blended by their distances to them, or each
//! bound to the bone beside it.

use serde_json::{Value, json};

use super::glb::{GlbBuffer, Use};
use super::grid::Grid;
use super::{Channel, animation, evaluate, unit};
use crate::exact::Exact;
use number::twofold::{Real, Twofold};

/// How vertices follow bones.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Weights {
    /// (79) to (81): by distances, with the sum made 1.
    Distance,
    /// Section 9.3.1: each by one.
    Rigid,
}

/// Radius of the tube.
const RADIUS: f64 = 0.25;
/// Ends of the bones.
const BONES: [[f64; 2]; 2] = [[-1.0, 0.0], [0.0, 1.0]];

/// The weights of a vertex, which sum up to 1.
fn weights(point: [f32; 3], rule: Weights) -> [f32; 2] {
    if rule == Weights::Rigid {
        return if point[1] < 0.0 { [1.0, 0.0] } else { [0.0, 1.0] };
    }
    let p = point.map(f64::from);
    let weight = |[from, to]: [f64; 2]| {
        let inputs = [p[0], p[1], p[2], 1.0, 0.0, from, 0.0, 1.0, 0.0, to, 0.0, 1.0];
        let distance = f64::from(evaluate(Exact::SegmentDistance, &inputs)[0]);
        <Twofold>::exact(f64::from(evaluate(Exact::BoneWeight, &[distance, 16.0])[0]))
    };
    let [first, second] = BONES.map(weight);
    let share = (first / (first + second)).rounded()[0] as f32;
    // The difference of two binary32 numbers near 1 is exact, so that the sum is.
    [share, 1.0 - share]
}

pub(super) fn arm(buffer: &mut GlbBuffer, grid: Grid, name: &str, rule: Weights) -> Value {
    let mut slim = unit();
    (slim[0], slim[10]) = (RADIUS, RADIUS);
    let point = |[s, t]: [f32; 2]| {
        let inputs: Vec<f64> = [f64::from(s), f64::from(t)].into_iter().chain(slim).collect();
        let p = evaluate(Exact::Cylinder, &inputs);
        [p[0], p[1], p[2]]
    };
    let points: Vec<[f32; 3]> = grid.parameters().map(point).collect();
    let normals = Grid::normals(Exact::Cylinder, &grid.points(Exact::Cylinder));
    let of_vertex: Vec<[f32; 4]> = points.iter().map(|&p| weights(p, rule)).map(|[a, b]| [a, b, 0.0, 0.0]).collect();
    // A joint without a weight is called 0.
    let joint = |w: &[f32; 4]| [0, u8::from(w[1] > 0.0), 0, 0];
    let joints: Vec<[u8; 4]> = of_vertex.iter().map(joint).collect();
    let attributes = json!({
        "POSITION": buffer.floats(&points, "VEC3", Use::Vertices),
        "NORMAL": buffer.floats(&normals, "VEC3", Use::Vertices),
        "JOINTS_0": buffer.joints(&joints),
        "WEIGHTS_0": buffer.floats(&of_vertex, "VEC4", Use::Vertices),
    });
    let indices = buffer.indices(&grid.triangles(false));
    // M⁻¹ of each bone: its root is moved to the origin.
    let inverse = |[root, _]: [f64; 2]| -> [f32; 16] {
        let mut matrix = unit().map(|x| x as f32);
        matrix[13] = -root as f32;
        matrix
    };
    let matrices = buffer.floats(&BONES.map(inverse), "MAT4", Use::Other);
    // The elbow bends by a right angle and back, and then to the other side.
    let turn = |quarters: f64| -> [f32; 4] {
        let (sin, cos) = <Twofold>::exact(quarters * 0.25).sin_cos_pi();
        [0.0, 0.0, sin.rounded()[0] as f32, cos.rounded()[0] as f32]
    };
    let turns = buffer.floats(&[0.0, 1.0, 0.0, -1.0, 0.0].map(turn), "VEC4", Use::Other);
    let times = vec![0.0, 1.0, 2.0, 3.0, 4.0];
    let channel = Channel { node: 2, path: "rotation", interpolation: "LINEAR", times, output: turns };
    json!({
        "meshes": [{ "name": name, "primitives": [{ "attributes": attributes, "indices": indices, "mode": 4 }] }],
        "nodes": [
            { "mesh": 0, "skin": 0, "name": name },
            { "name": "shoulder", "translation": [0.0, -1.0, 0.0], "children": [2] },
            { "name": "elbow", "translation": [0.0, 1.0, 0.0] },
        ],
        "skins": [{ "joints": [1, 2], "skeleton": 1, "inverseBindMatrices": matrices }],
        "scenes": [{ "nodes": [0, 1] }],
        "animations": animation(buffer, vec![channel]),
    })
}
