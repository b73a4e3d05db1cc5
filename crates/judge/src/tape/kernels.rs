//! Loops over the columns of a node, written so that they become vector instructions.

use super::arena::Slots;
use super::functions::{Image1, Image2};
use super::model::{BINARY64, gap};
use crate::profile::grid::{MAX_FINITE, MIN_NORMAL};

use program::interp::SLOTS;

/// Values and radii of an argument.
pub(super) type Pair<'a> = (&'a Slots, &'a Slots);

/// The columns of a new node.
pub(super) struct KernelNode<'a> {
    pub value: &'a mut Slots,
    pub radius: &'a mut Slots,
    pub local: &'a mut Slots,
}

/// How the error of a rounding becomes that of a node.
#[derive(Clone, Copy)]
pub(super) struct Closing {
    /// Part of a gap that one rounding is.
    pub part: f64,
    /// Subnormal results may become zero.
    pub flushes: bool,
    /// The radius takes the local error in.
    pub own: bool,
}

/// Error of one rounding of a value that is `v` but for `lost`, and within `e` of it on a device. `lost` is what
/// binary64 itself rounded away: of 1 − 10^-20 it leaves 1, and either neighbour of the true value is right.
#[inline(always)]
pub(super) fn rounding(part: f64, v: f64, lost: f64, e: f64) -> f64 {
    // Exact arguments with a result that is a binary32 number: rounding leaves it. Where binary64 lost something, the exact
    // result lies next to that number: rounding to nearest gives it all the same, and rounding either way may give the next.
    let kept = (e == 0.0) & ((lost == 0.0) | (part == NEAREST)) & (f64::from(v as f32) == v);
    let moved = part * gap(v.abs() + e);
    if kept { 0.0 } else { moved }
}

/// The part of a gap by which rounding to nearest moves a number at most.
const NEAREST: f64 = 0.5;

/// What the binary64 sum `v` of x and y leaves out of the exact one (Knuth, The Art of Computer Programming 2, 4.2.2).
/// Products of exact binary32 numbers are exact in binary64, and no quotient or root of them that is none is nearer to a
/// binary32 number than 2^-48 of it: sums alone lose something that is not seen.
#[inline(always)]
pub(super) fn lost_by_sum(x: f64, y: f64, v: f64) -> f64 {
    let rest = v - x;
    (x - (v - rest)) + (y - rest)
}

/// A local error with what holds for every operation of a device: binary64 itself, flushed results,
/// overflow. The second is true when the result may be subnormal.
#[inline(always)]
pub(super) fn finished(v: f64, e: f64, b: f64, flushes: bool) -> (f64, bool) {
    let v = v.abs();
    // The reference itself is computed in binary64.
    let b = if b > 0.0 { b + v * BINARY64 } else { b };
    let reach = v + e + b;
    let small = (v - e - b < MIN_NORMAL) & (reach > 0.0);
    // What is flushed may lie above the subnormal numbers by the operation's own error.
    let flushed = b.max(reach.min(MIN_NORMAL + b));
    let b = if small & flushes { flushed } else { b };
    let b = if reach > MAX_FINITE { f64::INFINITY } else { b };
    // Where an argument may be anything, nothing is to be said of this operation.
    (if e == f64::INFINITY { 0.0 } else { b }, small)
}

/// A node that is rounded once and takes its local error into its displacement.
pub(super) struct MovedNode<'a> {
    pub form: Once,
    pub closing: Closing,
    /// Values, radii and displacements of the arguments.
    pub args: [(&'a Slots, &'a Slots, &'a Slots); 2],
    pub value: &'a mut Slots,
    pub radius: &'a mut Slots,
    pub moved: &'a mut Slots,
}

/// A function whose local error is known, with the columns that it completes: its radius holds what is carried into it.
pub(super) struct ClosedNode<'a> {
    pub flushes: bool,
    /// Radii, partials and displacements of the arguments.
    pub args: [(&'a Slots, &'a Slots, &'a Slots); 2],
    pub value: &'a Slots,
    pub local: &'a Slots,
    pub radius: &'a mut Slots,
    pub moved: &'a mut Slots,
}

impl number::Wide for ClosedNode<'_> {
    type Output = SeenNode;

    #[inline(always)]
    fn run(self) -> SeenNode {
        let Self { flushes, args: [(ex, sx, dx), (ey, sy, dy)], value, local, radius, moved } = self;
        let along = |slot: usize| sx[slot] * dx[slot] + sy[slot] * dy[slot];
        closed_along(flushes, (ex, ey), along, (value, local), radius, moved)
    }
}

/// Completes a function in all slots; the columns that are written are arguments for the reason of [`rounded_along`].
#[inline(always)]
fn closed_along(
    flushes: bool,
    (ex, ey): (&Slots, &Slots),
    along: impl Fn(usize) -> f64,
    (value, local): (&Slots, &Slots),
    radius: &mut Slots,
    moved: &mut Slots,
) -> SeenNode {
    let (mut tiny, mut open) = (0_u64, 0_u64);
    for slot in 0..SLOTS {
        let e = radius[slot];
        let (b, small) = finished(value[slot], e, local[slot], flushes);
        // See `Tape::lose`.
        let known = (ex[slot] < f64::INFINITY) & (ey[slot] < f64::INFINITY);
        let b = if known { b } else { f64::INFINITY };
        radius[slot] = e + b;
        moved[slot] = farther(along(slot), b);
        tiny |= u64::from(small);
        open |= u64::from(!(e + b < f64::INFINITY));
    }
    SeenNode { tiny: tiny != 0, open: open != 0 }
}

/// What is rounded once.
#[derive(Clone, Copy)]
pub(super) enum Once {
    /// The sum with signs ±1.
    Sum((f64, f64)),
    /// The product.
    Product,
}

impl number::Wide for MovedNode<'_> {
    type Output = SeenNode;

    #[inline(always)]
    fn run(self) -> SeenNode {
        let Self { form, closing, args: [(x, ex, dx), (y, ey, dy)], value, radius, moved } = self;
        match form {
            Once::Sum(signs) => {
                let along = |slot: usize| signs.0 * dx[slot] + signs.1 * dy[slot];
                rounded_along(closing, sum_at((x, ex), (y, ey), signs), along, value, radius, moved)
            }
            // Where a radius is infinite, no displacement is known.
            Once::Product => {
                let along = |slot: usize| y[slot] * dx[slot] + x[slot] * dy[slot];
                rounded_along(closing, product_at((x, ex), (y, ey)), along, value, radius, moved)
            }
        }
    }
}

/// What is seen of the columns of a node that is rounded once.
#[derive(Clone, Copy, Default)]
pub(super) struct SeenNode {
    /// Some result may be subnormal.
    pub tiny: bool,
    /// Some radius is not finite.
    pub open: bool,
}

/// A sum, rounded once, from its arguments to its radius.
#[inline(always)]
pub(super) fn rounded_sum(
    x: Pair<'_>,
    y: Pair<'_>,
    signs: (f64, f64),
    closing: Closing,
    KernelNode { value, radius, local }: KernelNode<'_>,
) -> SeenNode {
    rounded(closing, sum_at(x, y, signs), |slot, v, e, b| (value[slot], radius[slot], local[slot]) = (v, e, b))
}

/// A displacement with an error of its operation's own, in the direction that adds to it.
#[inline(always)]
pub(super) fn farther(moved: f64, own: f64) -> f64 {
    // Of −0, the sign says no direction.
    moved + own.copysign(moved + 0.0)
}

/// Value, what is lost of it, and what is carried into it, of a sum.
#[inline(always)]
fn sum_at((x, ex): Pair<'_>, (y, ey): Pair<'_>, signs: (f64, f64)) -> impl Fn(usize) -> (f64, f64, f64) {
    move |slot| {
        let (x, y) = (signs.0 * x[slot], signs.1 * y[slot]);
        let v = x + y;
        (v, lost_by_sum(x, y, v), ex[slot] + ey[slot])
    }
}

/// The same for a product.
#[inline(always)]
fn product_at((x, ex): Pair<'_>, (y, ey): Pair<'_>) -> impl Fn(usize) -> (f64, f64, f64) {
    move |slot| (x[slot] * y[slot], 0.0, carried_by_product(x[slot], ex[slot], y[slot], ey[slot]))
}

/// A product, rounded once, from its arguments to its radius.
#[inline(always)]
pub(super) fn rounded_product(
    x: Pair<'_>,
    y: Pair<'_>,
    closing: Closing,
    KernelNode { value, radius, local }: KernelNode<'_>,
) -> SeenNode {
    rounded(closing, product_at(x, y), |slot, v, e, b| {
        // 0 times what may be infinite is not 0: the derivative by that factor does not say so.
        let b = if e < f64::INFINITY { b } else { f64::INFINITY };
        (value[slot], radius[slot], local[slot]) = (v, e, b);
    })
}

/// Rounds values once, and lets the displacement of the arguments take the local errors in. The columns that are written are
/// arguments of their own: those of a function are known not to overlap, without which the loop has no vectors.
#[inline(always)]
fn rounded_along(
    closing: Closing,
    of: impl Fn(usize) -> (f64, f64, f64),
    along: impl Fn(usize) -> f64,
    value: &mut Slots,
    radius: &mut Slots,
    moved: &mut Slots,
) -> SeenNode {
    rounded(closing, of, |slot, v, e, b| {
        (value[slot], radius[slot], moved[slot]) = (v, e, farther(along(slot), b));
    })
}

/// A radius that is no number says nothing: 0 times an infinite one is one that may be anything.
#[inline(always)]
pub(super) fn or_infinite(e: f64) -> f64 {
    if e < f64::INFINITY { e } else { f64::INFINITY }
}

/// How far a product moves within the radii of its factors.
#[inline(always)]
pub(super) fn carried_by_product(x: f64, ex: f64, y: f64, ey: f64) -> f64 {
    x.abs() * ey + (y.abs() + ey) * ex
}

/// Rounds values once. `write` gets slot, value, radius and local error.
#[inline(always)]
fn rounded(
    closing: Closing,
    of: impl Fn(usize) -> (f64, f64, f64),
    mut write: impl FnMut(usize, f64, f64, f64),
) -> SeenNode {
    let (mut tiny, mut open) = (0_u64, 0_u64);
    for slot in 0..SLOTS {
        let (v, lost, e) = of(slot);
        let e = or_infinite(e);
        let (b, small) = finished(v, e, rounding(closing.part, v, lost, e), closing.flushes);
        let e = if closing.own { e + b } else { e };
        write(slot, v, e, b);
        tiny |= u64::from(small);
        open |= u64::from(!(e < f64::INFINITY));
    }
    SeenNode { tiny: tiny != 0, open: open != 0 }
}

/// [`finished`] on a column.
pub(super) fn finish(value: &Slots, carried: &Slots, local: &mut Slots, flushes: bool) -> bool {
    number::wide(|| {
        let mut tiny = 0_u64;
        for slot in 0..SLOTS {
            let (b, small) = finished(value[slot], carried[slot], local[slot], flushes);
            local[slot] = b;
            tiny |= u64::from(small);
        }
        tiny != 0
    })
}

/// What a function of one number writes: value, movement, partial and its distance.
pub(super) struct Out1<'a> {
    pub value: &'a mut Slots,
    pub moves: &'a mut Slots,
    pub slope: &'a mut Slots,
    pub bend: &'a mut Slots,
}

/// The images of a function of one number in all slots. Only what is inlined into `image` gains.
#[inline(always)]
pub(super) fn images1((x, e): Pair<'_>, out: &mut Out1<'_>, image: impl Fn(f64, f64) -> Image1) {
    let Out1 { value, moves, slope, bend } = out;
    for slot in 0..SLOTS {
        let found = image(x[slot], e[slot]);
        (value[slot], moves[slot], slope[slot], bend[slot]) = (found.value, found.moves, found.slope, found.bends);
    }
}

/// What a function of two numbers writes.
pub(super) struct Out2<'a> {
    pub value: &'a mut Slots,
    pub moves: &'a mut Slots,
    pub slopes: [&'a mut Slots; 2],
    pub bends: [&'a mut Slots; 2],
}

/// [`images1`] for two numbers.
#[inline(always)]
pub(super) fn images2(
    (x, ex): Pair<'_>,
    (y, ey): Pair<'_>,
    out: &mut Out2<'_>,
    image: impl Fn((f64, f64), (f64, f64)) -> Image2,
) {
    let Out2 { value, moves, slopes: [sx, sy], bends: [bx, by] } = out;
    for slot in 0..SLOTS {
        let found = image((x[slot], ex[slot]), (y[slot], ey[slot]));
        (value[slot], moves[slot]) = (found.value, found.moves);
        (sx[slot], sy[slot]) = (found.slopes[0], found.slopes[1]);
        (bx[slot], by[slot]) = (found.bends[0], found.bends[1]);
    }
}

/// How far the value may be that a function gets: a subnormal argument may be flushed to zero.
#[inline(always)]
pub(super) fn reach(x: f64, radius: f64, flushes: bool) -> f64 {
    let most = x.abs() + radius;
    let tiny = flushes & (most > 0.0) & (x.abs() - radius < MIN_NORMAL);
    let flushed = radius + most.min(MIN_NORMAL);
    if tiny { flushed } else { radius }
}
