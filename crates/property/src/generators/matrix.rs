//! Matrices in binary64, to be rounded once: what the generators of transforms share.

use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};

use super::{Range, Stream, float, word};

/// Writes a matrix column by column, each entry rounded to binary32.
pub fn write(matrix: &DMat4, out: &mut [u32]) {
    for (word_out, entry) in out.iter_mut().zip(matrix.to_cols_array()) {
        // Sums that cancel to -0 would only clutter what is shown of a sample.
        *word_out = word(entry + 0.0);
    }
}

/// Reads the 16 words of a matrix.
pub fn read(words: &[u32]) -> DMat4 {
    let mut entries = [0.0; 16];
    for (entry, &w) in entries.iter_mut().zip(words) {
        *entry = f64::from(float(w));
    }
    DMat4::from_cols_array(&entries)
}

/// The inverse of a matrix of 16 words; false where there is none.
pub fn inverse(words: &[u32], out: &mut [u32]) -> bool {
    let inverse = read(words).inverse();
    if inverse.is_finite() {
        write(&inverse, out);
    }
    inverse.is_finite()
}

/// What transforms normals where a matrix of 16 words transforms points, as 9 or 16 words: the inverse of its linear
/// part, transposed. False where there is none.
pub fn normal(words: &[u32], out: &mut [u32]) -> bool {
    let normal = DMat3::from_mat4(read(words)).inverse().transpose();
    if !normal.is_finite() {
        return false;
    }
    if out.len() == 16 {
        write(&DMat4::from_mat3(normal), out);
    } else {
        out.iter_mut().zip(normal.to_cols_array()).for_each(|(out, entry)| *out = word(entry + 0.0));
    }
    true
}

/// Two points of the open unit disc, each with the square of its distance from the centre.
#[derive(Clone, Copy, Debug, Default)]
pub struct Discs([(f64, f64, f64); 2]);

/// Points spread evenly over the disc, by rejection.
#[inline]
pub fn discs(stream: &mut Stream) -> Discs {
    let mut disc = || loop {
        let (a, b) = (stream.between(-1.0, 1.0), stream.between(-1.0, 1.0));
        let square = a * a + b * b;
        if square < 1.0 && square > 1e-12 {
            break (a, b, square);
        }
    };
    Discs([disc(), disc()])
}

impl Discs {
    /// The rotation of two points.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn rotation(self) -> DQuat {
        let [(a, b, s), (c, d, t)] = self.0;
        let f = ((1.0 - s) / t).sqrt();
        DQuat::from_xyzw(a, b, c * f, d * f).normalize()
    }
}

/// A rotation, evenly spread over all rotations (Marsaglia 1972, by rejection: no transcendental
/// functions, hence the same on every machine).
pub fn rotation(stream: &mut Stream) -> DQuat {
    discs(stream).rotation()
}

/// One of the 24 rotations that map axes to axes; its entries are 0 and ±1.
pub fn quarter_turns(stream: &mut Stream) -> DMat3 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let sign = |bits: u64| if bits & 1 == 0 { 1.0 } else { -1.0 };
    let i = stream.below(3);
    let j = (i + 1 + stream.below(2)) % 3;
    let (x, y) = (axes[i] * sign(stream.bits()), axes[j] * sign(stream.bits()));
    DMat3::from_cols(x, y, x.cross(y))
}

/// A point with coordinates spread over the range.
pub fn point(range: &Range, stream: &mut Stream) -> DVec3 {
    let mut next = || f64::from(range.ordinary(stream.bits()));
    DVec3::new(next(), next(), next())
}

/// A point with coordinates -1, 0 or 1, moved into the range.
pub fn lattice(range: &Range, stream: &mut Stream) -> DVec3 {
    let mut next = || f64::from(range.lattice(stream.bits()));
    DVec3::new(next(), next(), next())
}

/// A linear map followed by a translation.
pub fn with_translation(linear: DMat3, translation: DVec3) -> DMat4 {
    let mut matrix = DMat4::from_mat3(linear);
    matrix.w_axis = translation.extend(1.0);
    matrix
}

/// An ordinary rigid transform with its translation in the range.
pub fn rigid(range: &Range, stream: &mut Stream) -> DMat4 {
    let rotation = DMat3::from_quat(rotation(stream));
    with_translation(rotation, point(range, stream))
}

/// A special rigid transform: the identity, a translation, turns that map axes to axes with and
/// without a translation, a rotation by about 2^-11 of a turn or less.
pub fn special_rigid(range: &Range, stream: &mut Stream) -> DMat4 {
    let origin = nearest_to_origin(range);
    match stream.below(6) {
        0 | 1 => with_translation(DMat3::IDENTITY, origin),
        2 => with_translation(DMat3::IDENTITY, point(range, stream)),
        3 => with_translation(quarter_turns(stream), origin),
        4 => with_translation(quarter_turns(stream), lattice(range, stream)),
        _ => {
            let axis = lattice(&Range::new(-1.0, 1.0), stream) * 2f64.powi(-10 - stream.below(10) as i32);
            let turn = DQuat::from_xyzw(axis.x, axis.y, axis.z, 1.0).normalize();
            with_translation(DMat3::from_quat(turn), origin)
        }
    }
}

/// The point of the range's box that is nearest to the origin.
pub fn nearest_to_origin(range: &Range) -> DVec3 {
    DVec3::splat(f64::from(range.clamp(0.0)))
}

/// True for a finite matrix with last row (0, 0, 0, 1).
pub fn is_affine(m: &DMat4) -> bool {
    m.is_finite() && m.row(3) == DVec4::W
}

/// True for a rigid transform: a rotation to within the rounding of its entries, and a translation
/// in the range.
pub fn is_rigid(m: &DMat4, range: &Range) -> bool {
    let linear = DMat3::from_mat4(*m);
    let product = linear.transpose() * linear;
    let near = |a: DMat3, b: DMat3| (a - b).to_cols_array().iter().all(|d| d.abs() <= 1e-6);
    let t = m.w_axis;
    is_affine(m)
        && near(product, DMat3::IDENTITY)
        && linear.determinant() > 0.0
        && [t.x, t.y, t.z].iter().all(|&c| range.contains(c as f32))
}

/// Versions of a rigid transform that are plainer: without its rotation, without its translation,
/// with a turn that maps axes to axes in place of the rotation. `None` when `k` is past the last.
pub fn simpler_rigid(m: &DMat4, range: &Range, k: usize) -> Option<DMat4> {
    let turn = |x: DVec3, y: DVec3| DMat3::from_cols(x, y, x.cross(y));
    let translation = m.w_axis.truncate();
    let rounded = DVec3::from_array(translation.to_array().map(|c| f64::from(range.clamp(c.round() as f32))));
    Some(match k {
        0 => with_translation(DMat3::IDENTITY, nearest_to_origin(range)),
        1 => with_translation(DMat3::IDENTITY, translation),
        2 => with_translation(DMat3::from_mat4(*m), nearest_to_origin(range)),
        3 => with_translation(DMat3::from_mat4(*m), rounded),
        4 => with_translation(turn(DVec3::Y, -DVec3::X), translation),
        5 => with_translation(turn(DVec3::X, DVec3::Z), translation),
        6 => with_translation(turn(-DVec3::Z, DVec3::Y), translation),
        7 => with_translation(turn(-DVec3::X, -DVec3::Y), translation),
        8 => with_translation(turn(-DVec3::X, DVec3::Y), translation),
        9 => with_translation(turn(DVec3::X, -DVec3::Y), translation),
        _ => return None,
    })
}

/// Number of versions that [`simpler_rigid`] has.
pub const SIMPLER_RIGID: usize = 10;
