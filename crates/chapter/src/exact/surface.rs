//! Sphere and cylinder (section 9.1). Angles are parts of a turn, so that no π is rounded.

use super::vector::{Words, matrix_times};
use number::twofold::Real;

/// x, or ½ in place of what differs from it by rounding alone: the product of two roots of ½, which must
/// cancel against another ½.
#[cfg_attr(not(debug_assertions), inline(always))]
fn half<R: Real>(x: R) -> R {
    let off = x.abs().less_word(R::exact(0.5));
    let near = off.abs().less(R::exact(1.0 / (1_u128 << 98) as f64));
    R::select(near, R::select(x.less(R::exact(0.0)), R::exact(-0.5), R::exact(0.5)), x)
}

/// parameter, mc
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn sphere<R: Real>(words: &impl Words<R>, out: &mut [R]) {
    let turn = words.word(0);
    let (sin_th, cos_th) = (turn + turn).sin_cos_pi();
    let (sin_ph, cos_ph) = words.word(1).sin_cos_pi();
    let point = [half(sin_ph * cos_th), cos_ph, half(sin_ph * sin_th), R::exact(1.0)];
    out.copy_from_slice(&matrix_times(words, 2, &point));
}

/// parameter, mc
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn cylinder<R: Real>(words: &impl Words<R>, out: &mut [R]) {
    let (turn, t) = (words.word(0), words.word(1));
    let (sin, cos) = (turn + turn).sin_cos_pi();
    let point = [cos, (t + t) - R::exact(1.0), sin, R::exact(1.0)];
    out.copy_from_slice(&matrix_times(words, 2, &point));
}
