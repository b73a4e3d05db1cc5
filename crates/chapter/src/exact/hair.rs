//! One piece of a strand of hair: five vertices with the directions to the viewer, to the light and along.

use super::Marks;
use super::curve::{Cubic, nodes};
use super::vector::{Words, matrix_times, vanishes};
use number::twofold::Real;

/// Vertices of a piece.
pub(super) const VERTICES: usize = 5;
/// Words of a vertex.
pub(super) const WORDS: usize = 13;
/// The light, w = 1.
const LIGHT: [f64; 3] = [1.0, 6.0, 4.0];

/// The direction of a vector; NaN for the zero vector.
#[cfg_attr(not(debug_assertions), inline(always))]
fn direction<R: Real>(v: [R; 3], out: &mut [R], marks: &mut Marks<R>) {
    marks.degenerate(vanishes(&v));
    let length = ((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]).sqrt();
    for (out, x) in out.iter_mut().zip(v) {
        *out = x / length;
    }
}

/// gl_Position of four vertices, mc
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn hair<R: Real>(words: &impl Words<R>, out: &mut [R], marks: &mut Marks<R>) {
    let cubic = Cubic::cardinal(&nodes(words, marks), R::exact(1.0));
    for (k, vertex) in out.chunks_exact_mut(WORDS).enumerate() {
        let s = R::exact(k as f64 / (VERTICES - 1) as f64);
        let [x, y, z, w] = cubic.position(s);
        vertex[..4].copy_from_slice(&matrix_times(words, 16, &[x, y, z, w]));
        direction([-x, -y, -z], &mut vertex[4..7], marks);
        // The light has w = 1, and the shader takes the position times that.
        let [lx, ly, lz] = LIGHT.map(R::exact);
        direction([lx - x, ly - y, lz - z], &mut vertex[7..10], marks);
        let [dx, dy, dz, _] = cubic.derivative(s);
        direction([dx, dy, dz], &mut vertex[10..], marks);
    }
}
