//! Vectors and matrices of numbers of any kind.

use number::twofold::Real;

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
    // Not as a closure: one that is not inlined is compiled without the vectors of the caller.
    let mut out = *p;
    for (r, out) in out.iter_mut().enumerate() {
        let at = at + r;
        // Words are numbers of binary64: at most binary32 and integers.
        *out = R::dot_of_words([words.word(at), words.word(at + 4), words.word(at + 8), words.word(at + 12)], *p);
    }
    out
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn add<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> Vec4<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn sub<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> Vec4<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

/// The difference to a vector of words.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn sub_words<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> Vec4<R> {
    [a[0].less_word(b[0]), a[1].less_word(b[1]), a[2].less_word(b[2]), a[3].less_word(b[3])]
}

/// The difference of two vectors of words.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn between_words<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> Vec4<R> {
    let one = R::between_words;
    [one(a[0], b[0]), one(a[1], b[1]), one(a[2], b[2]), one(a[3], b[3])]
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn scale<R: Real>(a: &Vec4<R>, s: R) -> Vec4<R> {
    [a[0] * s, a[1] * s, a[2] * s, a[3] * s]
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn dot<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> R {
    R::dot(*a, *b)
}

/// |a|²|b|² − (a·b)², as the sum of the squares of all 2×2 determinants: nothing cancels but within one.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn gram<R: Real>(a: &Vec4<R>, b: &Vec4<R>) -> R {
    let (first, second) = (square(a, b, 0, 1) + square(a, b, 0, 2), square(a, b, 0, 3) + square(a, b, 1, 2));
    (first + second) + (square(a, b, 1, 3) + square(a, b, 2, 3))
}

/// The square of one of the determinants.
#[cfg_attr(not(debug_assertions), inline(always))]
fn square<R: Real>(a: &Vec4<R>, b: &Vec4<R>, i: usize, j: usize) -> R {
    let minor = R::minor(a[i], b[j], a[j], b[i]);
    minor * minor
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
