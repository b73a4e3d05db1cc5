//! Surfaces over a grid, and what morphs between them.

use serde_json::{Value, json};

use super::glb::{GlbBuffer, Use};
use super::{Channel, animation, evaluate, unit};
use crate::exact::Exact;

/// A grid of parameters: `around` steps of s, `along` steps of t.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    pub around: u32,
    pub along: u32,
}

impl Grid {
    /// About this many points, with twice as many steps around as along.
    pub fn of(vertices: u64) -> Self {
        let along = ((vertices.min(1 << 24) as f64 / 2.0).sqrt() as u32).max(2);
        Self { around: 2 * along, along }
    }

    /// The parameters, row by row.
    pub fn parameters(self) -> impl Iterator<Item = [f32; 2]> {
        let at = |k: u32, of: u32| (f64::from(k) / f64::from(of)) as f32;
        (0..=self.along).flat_map(move |t| (0..=self.around).map(move |s| [at(s, self.around), at(t, self.along)]))
    }

    /// The points of a surface.
    pub fn points(self, surface: Exact) -> Vec<[f32; 3]> {
        let point = |[s, t]: [f32; 2]| {
            let inputs: Vec<f64> = [f64::from(s), f64::from(t)].into_iter().chain(unit()).collect();
            let p = evaluate(surface, &inputs);
            [p[0], p[1], p[2]]
        };
        self.parameters().map(point).collect()
    }

    /// Directions away from the axis, for points of a cylinder, or from the centre, for those of a sphere.
    pub fn normals(surface: Exact, points: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let flat = surface == Exact::Cylinder;
        points.iter().map(|&[x, y, z]| [x, if flat { 0.0 } else { y }, z]).collect()
    }

    /// Triangles, with the side up from which they are counterclockwise outside. `falls` for a surface on
    /// which t leads downward.
    pub fn triangles(self, falls: bool) -> Vec<u32> {
        let row = self.around + 1;
        let mut list = Vec::new();
        for t in 0..self.along {
            for s in 0..self.around {
                let (a, b, c, d) = (t * row + s, t * row + s + 1, (t + 1) * row + s, (t + 1) * row + s + 1);
                list.extend(if falls { [a, b, c, b, d, c] } else { [a, c, b, b, c, d] });
            }
        }
        list
    }

    /// Attributes of a surface, and its indices.
    fn primitive(self, surface: Exact, buffer: &mut GlbBuffer) -> Value {
        let points = self.points(surface);
        let parameters: Vec<[f32; 2]> = self.parameters().collect();
        let position = buffer.floats(&points, "VEC3", Use::Vertices);
        let normal = buffer.floats(&Self::normals(surface, &points), "VEC3", Use::Vertices);
        let parameter = buffer.floats(&parameters, "VEC2", Use::Vertices);
        let indices = buffer.indices(&self.triangles(surface == Exact::Sphere));
        json!({
            "attributes": { "POSITION": position, "NORMAL": normal, "_PARAMETER": parameter },
            "indices": indices, "mode": 4,
        })
    }

    /// A surface as it is.
    pub fn surface(self, surface: Exact, buffer: &mut GlbBuffer) -> Value {
        let (name, primitive) = (surface.name(), self.primitive(surface, buffer));
        json!({ "meshes": [{ "name": name, "primitives": [primitive] }], "nodes": [{ "mesh": 0, "name": name }] })
    }

    /// A sphere that becomes other surfaces, each after the other; those after the first two are half as
    /// large and moved to either side, so that each is another.
    pub fn morph(self, buffer: &mut GlbBuffer, name: &str, targets: &[Exact]) -> Value {
        let base = self.points(Exact::Sphere);
        let mut primitive = self.primitive(Exact::Sphere, buffer);
        let mut list = Vec::new();
        for (k, &target) in targets.iter().enumerate() {
            let size = [1.0, 0.5, 0.5, 0.25][k.min(3)];
            let moved = [0.0, 0.5, -0.5, 1.0][k.min(3)];
            let offset = |([x, y, z], [bx, by, bz]): ([f32; 3], &[f32; 3])| {
                let away = |to: f32, from: f32| (f64::from(to) * size - f64::from(from)) as f32;
                let along = (f64::from(x) * size + moved - f64::from(*bx)) as f32;
                [along, away(y, *by), away(z, *bz)]
            };
            let offsets: Vec<[f32; 3]> = self.points(target).into_iter().zip(&base).map(offset).collect();
            list.push(json!({ "POSITION": buffer.floats(&offsets, "VEC3", Use::Vertices) }));
        }
        primitive["targets"] = Value::Array(list);
        // From the base to each target and back, in a second each.
        let count = targets.len();
        let mut times = vec![0.0];
        let mut weights: Vec<[f32; 1]> = vec![[0.0]; count];
        for k in 0..count {
            for full in [1.0, 0.0] {
                times.push(times.len() as f32);
                weights.extend((0..count).map(|other| [if other == k { full } else { 0.0 }]));
            }
        }
        let output = buffer.floats(&weights, "SCALAR", Use::Other);
        let channel = Channel { node: 0, path: "weights", interpolation: "LINEAR", times, output };
        json!({
            "meshes": [{ "name": name, "primitives": [primitive], "weights": vec![0.0; count] }],
            "nodes": [{ "mesh": 0, "name": name }],
            "animations": animation(buffer, vec![channel]),
        })
    }
}
