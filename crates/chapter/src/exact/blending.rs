//! Morphing, rigid parts and vertex blending (sections 9.2 and 9.3).

use super::Marks;
use super::vector::{Vec4, Words, add, between_words, dot, gram, matrix_times, scale, sub_words, vanishes, vec4};
use number::twofold::Real;

/// Most bones of the skinning shader.
const MAXBONES: usize = 8;
/// Parts of the shader of joints.
const PARTS: usize = 4;

/// (72): p0, p1, t, mc
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn morph<R: Real>(words: &impl Words<R>, out: &mut [R]) {
    let t = words.word(8);
    let p = add(&scale(&vec4(words, 0), R::exact(1.0) - t), &scale(&vec4(words, 4), t));
    out.copy_from_slice(&matrix_times(words, 9, &p));
}

/// (73), (74): pn, p1 to p4, w, mc
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn morph_targets<R: Real>(words: &impl Words<R>, out: &mut [R]) {
    let base = vec4(words, 0);
    let mut p = base;
    for target in 0..4 {
        let offset = between_words(&vec4(words, 4 + 4 * target), &base);
        p = add(&p, &scale(&offset, words.word(20 + target)));
    }
    out.copy_from_slice(&matrix_times(words, 24, &p));
}

/// Section 9.3.1: position, part, partMatrix, mc. NaN for a part that there is not.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn joints<R: Real>(words: &impl Words<R>, out: &mut [R]) {
    let (position, part) = (vec4(words, 0), words.word(4));
    let mut p = [R::exact(f64::NAN); 4];
    for k in 0..PARTS {
        let here = (part - R::exact(k as f64)).is_zero();
        let moved = matrix_times(words, 5 + 16 * k, &position);
        for (p, moved) in p.iter_mut().zip(moved) {
            *p = R::select(here, moved, *p);
        }
    }
    out.copy_from_slice(&matrix_times(words, 69, &p));
}

/// (75): position, weight, blendMatrix, mc; with what either bone alone gives.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn two_bones<R: Real>(words: &impl Words<R>, out: &mut [R]) {
    let position = vec4(words, 0);
    let (first, second) = (matrix_times(words, 6, &position), matrix_times(words, 22, &position));
    let u = add(&scale(&first, words.word(4)), &scale(&second, words.word(5)));
    out[..4].copy_from_slice(&matrix_times(words, 38, &u));
    out[4..8].copy_from_slice(&first);
    out[8..].copy_from_slice(&second);
}

/// (76), (79) to (81): position, modelViewMatrix, projectionMatrix, numberOfBones, p0, p1, blendMatrix.
/// NaN for a number of bones that there is not.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn skinning<R: Real>(words: &impl Words<R>, out: &mut [R], marks: &mut Marks<R>) {
    let p = matrix_times(words, 4, &vec4(words, 0));
    let count = words.word(36);
    let mut u = [R::exact(0.0); 4];
    let most = count.largest().clamp(0.0, MAXBONES as f64) as usize;
    for bone in 0..most {
        let exists = R::exact(bone as f64).less(count);
        let mut own = Marks::none();
        let d = distance(&p, &vec4(words, 37 + 4 * bone), &vec4(words, 69 + 4 * bone), &mut own);
        // (d + 1)^-16 by squares: the reciprocal first, which cannot overflow.
        let mut w = R::exact(1.0) / (d + R::exact(1.0));
        for _ in 0..4 {
            w = w * w;
        }
        let moved = matrix_times(words, 101 + 16 * bone, &p);
        let next = add(&u, &scale(&moved, w));
        for (u, next) in u.iter_mut().zip(next) {
            *u = R::select(exists, next, *u);
        }
        marks.segment_end(R::and(exists, own.segment_end));
        marks.degenerate(R::and(exists, own.degenerate));
    }
    let none = R::or(count.less(R::exact(0.0)), R::exact(MAXBONES as f64).less(count));
    for (out, u) in out.iter_mut().zip(matrix_times(words, 20, &u)) {
        *out = R::select(none, R::exact(f64::NAN), u);
    }
}

/// (79): p, p0, p1
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn segment_distance<R: Real>(words: &impl Words<R>, marks: &mut Marks<R>) -> R {
    distance(&vec4(words, 0), &vec4(words, 4), &vec4(words, 8), marks)
}

/// (79) in its three cases, for ends that are words; a segment of length 0 is a point.
#[cfg_attr(not(debug_assertions), inline(always))]
fn distance<R: Real>(p: &Vec4<R>, p0: &Vec4<R>, p1: &Vec4<R>, marks: &mut Marks<R>) -> R {
    let (v1, v2) = (between_words(p1, p0), sub_words(p, p0));
    let (squared, along) = (dot(&v1, &v1), dot(&v1, &v2));
    let point = vanishes(&v1);
    let at_start = R::or(point, R::or(along.less(R::exact(0.0)), along.is_zero()));
    let beyond = along - squared;
    let at_end = R::or(R::exact(0.0).less(beyond), beyond.is_zero());
    let v3 = sub_words(p, p1);
    // Where the segment is a point, the quotient is not used.
    let across = gram(&v1, &v2) / R::select(point, R::exact(1.0), squared);
    let square = R::select(at_start, dot(&v2, &v2), R::select(at_end, dot(&v3, &v3), across));
    marks.segment_end(R::or(at_start, at_end));
    marks.degenerate(point);
    square.sqrt()
}

/// (80): d, c. NaN for d < 0.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn bone_weight<R: Real>(words: &impl Words<R>) -> R {
    let (d, c) = (words.word(0), words.word(1));
    let weight = (d + R::exact(1.0)).pow(-c);
    R::select(d.less(R::exact(0.0)), R::exact(f64::NAN), weight)
}
