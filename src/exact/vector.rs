//! Vectors and matrices of numbers of any kind.

use crate::math::twofold::Real;

/// Inputs of a formula, word by word.
pub trait Words<R: Real> {
    /// The word with this index.
    fn word(&self, index: usize) -> R;
}

/// Four components.
pub(super) type Vec4<R> = [R; 4];

/// The vector that begins at this word.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn vec4<R: Real>(words: &impl Words<R>, at: usize) -> Vec4<R> {
    [words.word(at), words.word(at + 1), words.word(at + 2), words.word(at + 3)]
}

/// The matrix that begins at this word, times a column.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn matrix_times<R: Real>(words: &impl Words<R>, at: usize, p: &Vec4<R>) -> Vec4<R> {
    let row = |r: usize| {
        let term = |c: usize| words.word(at + 4 * c + r) * p[c];
        ((term(0) + term(1)) + term(2)) + term(3)
    };
    [row(0), row(1), row(2), row(3)]
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn add<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> Vec4<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn sub<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> Vec4<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn scale<R: Real>(a: &Vec4<R>, s: R) -> Vec4<R> {
    [a[0] * s, a[1] * s, a[2] * s, a[3] * s]
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn dot<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> R {
    ((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]) + a[3] * b[3]
}

/// |a|²|b|² − (a·b)², as the sum of the squares of all 2×2 determinants: nothing cancels but within one.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn gram<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> R {
    let square = |i: usize, j: usize| {
        let minor = a[i] * b[j] - a[j] * b[i];
        minor * minor
    };
    ((square(0, 1) + square(0, 2)) + (square(0, 3) + square(1, 2))) + (square(1, 3) + square(2, 3))
}

/// Where all components are 0.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn vanishes<R: Real>(a: &[R]) -> R::Mask {
    let mut all = a[0].is_zero();
    for x in &a[1..] {
        all = R::and(all, x.is_zero());
    }
    all
}
