//! The blend matrices of ordinary bones, side by side in vectors: the bits are those of [`super::bones`] one by one.
//!
//! The matrices are affine. What is multiplied by the zeros of a last row is left out, which changes no sum, and what
//! is left is computed in the order in which `glam` has it.

use glam::{DMat3, DVec3};

use number::wide;
use property::Stream;
use property::generators::{Range, matrix, word};

/// Bones that are computed side by side.
pub const ABREAST: usize = 8;

/// Where the numbers of each bone begin among random bits.
#[derive(Clone, Debug)]
pub struct Draws {
    roots: [Stream; ABREAST],
    tips: [Stream; ABREAST],
    turns: [matrix::Discs; ABREAST],
    moves: [Stream; ABREAST],
}

/// Roots, tips and blend matrices, word by word.
#[derive(Clone, Debug)]
pub struct Bones {
    /// Roots.
    pub roots: [[f64; ABREAST]; 3],
    /// Tips.
    pub tips: [[f64; ABREAST]; 3],
    /// Matrices, column by column.
    pub matrices: [[u32; ABREAST]; 16],
}

impl Default for Draws {
    fn default() -> Self {
        let streams = [Stream::new(0); ABREAST];
        Self { roots: streams, tips: streams, turns: [matrix::Discs::default(); ABREAST], moves: streams }
    }
}

impl Default for Bones {
    fn default() -> Self {
        Self { roots: [[0.0; ABREAST]; 3], tips: [[0.0; ABREAST]; 3], matrices: [[0; ABREAST]; 16] }
    }
}

impl Draws {
    /// Draws one bone. The root of a chain is the tip before, and draws nothing.
    pub fn draw(&mut self, bone: usize, chained: bool, stream: &mut Stream) {
        if !chained {
            self.roots[bone] = stream.part(3);
        }
        self.tips[bone] = stream.part(3);
        self.turns[bone] = matrix::discs(stream);
        self.moves[bone] = stream.part(3);
    }

    /// Computes the bones. In a chain the first root is `before`, or drawn where there is none.
    pub fn bones(&self, range: &Range, chain: bool, before: Option<DVec3>, out: &mut Bones) {
        wide(
            #[inline(always)]
            || points(self.tips, range, &mut out.tips),
        );
        wide(
            #[inline(always)]
            || points(self.roots, range, &mut out.roots),
        );
        if chain {
            for c in 0..3 {
                let first = before.map_or(out.roots[c][0], |before| before[c]);
                out.roots[c][1..].copy_from_slice(&out.tips[c][..ABREAST - 1]);
                out.roots[c][0] = first;
            }
        }
        wide(
            #[inline(always)]
            || self.pose(range, out),
        );
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn pose(&self, range: &Range, out: &mut Bones) {
        let mut moves = [[0.0; ABREAST]; 3];
        points(self.moves, range, &mut moves);
        let Bones { roots, tips, matrices } = out;
        for k in 0..ABREAST {
            let at = |of: &[[f64; ABREAST]; 3]| DVec3::new(of[0][k], of[1][k], of[2][k]);
            let (root, tip, moved) = (at(roots), at(tips), at(&moves));
            let y = (tip - root).try_normalize().unwrap_or(DVec3::Y);
            let x = y.any_orthonormal_vector();
            let rest = DMat3::from_cols(x, y, x.cross(y));
            let turned = rest * DMat3::from_quat(self.turns[k].rotation());
            let posed = root + moved;
            let (inverse, back, unit) = inverse(&rest, root);
            let linear = turned * inverse;
            let translation = turned * back + posed * unit;
            for (c, column) in [linear.x_axis, linear.y_axis, linear.z_axis, translation].into_iter().enumerate() {
                for r in 0..3 {
                    // As where matrices are written: no -0.
                    matrices[4 * c + r][k] = word(column[r] + 0.0);
                }
            }
            matrices[15][k] = word(unit);
        }
    }
}

/// Points whose coordinates are drawn one after the other.
#[cfg_attr(not(debug_assertions), inline(always))]
fn points(mut streams: [Stream; ABREAST], range: &Range, out: &mut [[f64; ABREAST]; 3]) {
    for column in out {
        for k in 0..ABREAST {
            column[k] = f64::from(range.ordinary(streams[k].bits()));
        }
    }
}

/// The inverse of an affine matrix by cofactors: its linear part, its translation, and what is left of 1 in its corner.
#[cfg_attr(not(debug_assertions), inline(always))]
fn inverse(m: &DMat3, t: DVec3) -> (DMat3, DVec3, f64) {
    let (a, b, c) = (m.x_axis, m.y_axis, m.z_axis);
    // Rows of the inverse without its determinant.
    let first = DVec3::new(b.y * c.z - b.z * c.y, -(b.x * c.z - b.z * c.x), b.x * c.y - b.y * c.x);
    let second = DVec3::new(-(a.y * c.z - a.z * c.y), a.x * c.z - a.z * c.x, -(a.x * c.y - a.y * c.x));
    let third = DVec3::new(a.y * b.z - a.z * b.y, -(a.x * b.z - a.z * b.x), a.x * b.y - a.y * b.x);
    let (c08, c16, c20) = (c.y * t.z - t.y * c.z, c.x * t.z - t.x * c.z, c.x * t.y - t.x * c.y);
    let (c10, c18, c22) = (b.y * t.z - t.y * b.z, b.x * t.z - t.x * b.z, b.x * t.y - t.x * b.y);
    let (c11, c19, c23) = (b.y * c.z - c.y * b.z, b.x * c.z - c.x * b.z, b.x * c.y - c.x * b.y);
    let x = -((b.x * c08 - b.y * c16) + b.z * c20);
    let y = (a.x * c08 - a.y * c16) + a.z * c20;
    let z = -((a.x * c10 - a.y * c18) + a.z * c22);
    let w = (a.x * c11 - a.y * c19) + a.z * c23;
    let inverse = 1.0 / ((a.x * first.x + a.y * first.y) + a.z * first.z);
    let linear = DMat3::from_cols(
        DVec3::new(first.x, second.x, third.x),
        DVec3::new(first.y, second.y, third.y),
        DVec3::new(first.z, second.z, third.z),
    );
    (linear * inverse, DVec3::new(x, y, z) * inverse, w * inverse)
}
