//! Cubic curves between nodes.

use super::Marks;
use super::vector::{Vec4, Words, add, scale, sub, vanishes, vec4};
use number::twofold::Real;

/// P(s) = a s³ + b s² + c s + d by its coefficients, highest first.
pub(super) struct Cubic<R>([Vec4<R>; 4]);

impl<R: Real> Cubic<R> {
    /// From `p0` with the tangent `m0` to `p1` with the tangent `m1`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn new(p0: &Vec4<R>, p1: &Vec4<R>, m0: &Vec4<R>, m1: &Vec4<R>) -> Self {
        let d = sub(p0, p1);
        let a = add(&add(&add(&d, &d), m0), m1);
        let b = sub(&sub(&scale(&d, R::exact(-3.0)), &add(m0, m0)), m1);
        Self([a, b, *m0, *p0])
    }

    /// Between the second and the third of four nodes, with half the differences times `tight`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn cardinal(q: &[Vec4<R>; 4], tight: R) -> Self {
        let half = tight * R::exact(0.5);
        Self::new(&q[1], &q[2], &scale(&sub(&q[2], &q[0]), half), &scale(&sub(&q[3], &q[1]), half))
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn position(&self, s: R) -> Vec4<R> {
        let [a, b, c, d] = &self.0;
        add(&scale(&add(&scale(&add(&scale(a, s), b), s), c), s), d)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn derivative(&self, s: R) -> Vec4<R> {
        let [a, b, c, _] = &self.0;
        let first = add(&scale(a, R::exact(3.0) * s), &add(b, b));
        add(&scale(&first, s), c)
    }
}

/// Four nodes, marked where neighbours fall together.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn nodes<R: Real>(words: &impl Words<R>, marks: &mut Marks<R>) -> [Vec4<R>; 4] {
    let q = [vec4(words, 0), vec4(words, 4), vec4(words, 8), vec4(words, 12)];
    for k in 0..3 {
        marks.degenerate(vanishes(&sub(&q[k], &q[k + 1])));
    }
    q
}

/// p0, p1, m0, m1, s
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn hermite<R: Real>(words: &impl Words<R>, out: &mut [R]) {
    let cubic = Cubic::new(&vec4(words, 0), &vec4(words, 4), &vec4(words, 8), &vec4(words, 12));
    out.copy_from_slice(&cubic.position(words.word(16)));
}

/// q0 to q3, s
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn catmull_rom<R: Real>(words: &impl Words<R>, out: &mut [R], marks: &mut Marks<R>) {
    let (cubic, s) = (Cubic::cardinal(&nodes(words, marks), R::exact(1.0)), words.word(16));
    out[..4].copy_from_slice(&cubic.position(s));
    out[4..].copy_from_slice(&cubic.derivative(s));
}

/// q0 to q3, w, s
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn cardinal<R: Real>(words: &impl Words<R>, out: &mut [R], marks: &mut Marks<R>) {
    let tight = R::exact(1.0) - words.word(16);
    out.copy_from_slice(&Cubic::cardinal(&nodes(words, marks), tight).position(words.word(17)));
}

/// q0 to q3, tension, bias, continuity, s
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn kochanek_bartels<R: Real>(words: &impl Words<R>, out: &mut [R], marks: &mut Marks<R>) {
    let q = nodes(words, marks);
    let one = R::exact(1.0);
    let (t, b, c) = (words.word(16), words.word(17), words.word(18));
    let tight = (one - t) * R::exact(0.5);
    let [q01, q12, q23] = [sub(&q[1], &q[0]), sub(&q[2], &q[1]), sub(&q[3], &q[2])];
    let mix = |x: &Vec4<R>, fx: R, y: &Vec4<R>, fy: R| add(&scale(x, tight * fx), &scale(y, tight * fy));
    let outgoing = mix(&q01, (one + b) * (one + c), &q12, (one - b) * (one - c));
    let incoming = mix(&q12, (one + b) * (one - c), &q23, (one - b) * (one + c));
    out.copy_from_slice(&Cubic::new(&q[1], &q[2], &outgoing, &incoming).position(words.word(19)));
}
