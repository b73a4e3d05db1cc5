//! Local errors of functions that stay one node, though their error is that of a definition in several
//! steps.

use std::f64::consts::LN_2;

use super::arena::Slots;
use super::kernels::Out2;
use super::model::{Arg, Model, gap};
use crate::profile::Op;
use crate::profile::grid::MIN_NORMAL;

use program::interp::{Mask, SLOTS};

/// Local error of a function of one number.
pub(super) fn function(model: &Model<'_>, op: Op, x: Arg<'_>, value: &Slots, carried: &Slots, local: &mut Slots) {
    if op == Op::Sqrt && model.definition(op).is_some() {
        root_by_inverse(model, x, value, carried, local);
    } else {
        model.local(op, &[x], value, carried, local);
    }
}

/// Local error of √x where it inherits from 1/inversesqrt(x): both steps of the definition.
///
/// At 0 the definition is taken in its limit, as every device does that has a root at all.
fn root_by_inverse(model: &Model<'_>, x: Arg<'_>, value: &Slots, carried: &Slots, local: &mut Slots) {
    let (mut inverse, mut reach) = ([0.0; SLOTS], [0.0; SLOTS]);
    let (mut first, mut second) = ([0.0; SLOTS], [0.0; SLOTS]);
    number::wide(|| {
        for slot in 0..SLOTS {
            // A root below which nothing is normal has an inverse that is; the largest is taken.
            inverse[slot] = 1.0 / (value[slot] + carried[slot]).max(MIN_NORMAL);
            reach[slot] = inverse[slot] * 1e-6;
        }
    });
    let exact = [0.0; SLOTS];
    let ones = [1.0; SLOTS];
    model.local(Op::InverseSqrt, &[Arg { value: x.value, radius: &exact }], &inverse, &reach, &mut first);
    // d(1/q)/dq = q^-2 = root².
    let [mut root, mut by_inverse, mut moves] = [[0.0; SLOTS]; 3];
    number::wide(|| {
        for slot in 0..SLOTS {
            root[slot] = value[slot] + carried[slot];
            // An inverse at the other end of the radius may have twice the error for its size, where numbers are
            // farther apart.
            let farther = gap(1.0 / (value[slot] - carried[slot]).max(MIN_NORMAL)) > gap(inverse[slot]);
            let twice = if farther { 2.0 } else { 1.0 };
            by_inverse[slot] = first[slot] * root[slot] * root[slot] * (1.0 + 1e-4) * twice;
            // What the first step moves may lead to where numbers are twice as far apart.
            moves[slot] = carried[slot] + by_inverse[slot];
        }
    });
    let args = [Arg { value: &ones, radius: &exact }, Arg { value: &inverse, radius: &reach }];
    model.local(Op::Div, &args, value, &moves, &mut second);
    number::wide(|| {
        for slot in 0..SLOTS {
            local[slot] = if root[slot] == 0.0 { 0.0 } else { by_inverse[slot] + second[slot] };
        }
    });
}

/// The binary logarithm of a column, which the definition of x^y has.
pub(super) fn logarithm_of(x: &Slots) -> Slots {
    let mut logarithm = [0.0; SLOTS];
    number::LOG2.column(x, &mut logarithm);
    logarithm
}

/// Local error of x^y. `logarithm` is that of x to base 2; `grow` puts e^t − 1 or more in the place of numbers t.
pub(super) fn power(
    model: &Model<'_>,
    args: [Arg<'_>; 2],
    logarithm: &Slots,
    (value, carried): (&Slots, &Slots),
    grow: impl Fn(&mut [f64]),
    local: &mut Slots,
) {
    if model.definition(Op::Pow).is_some() {
        power_by_exp2(model, args, logarithm, (value, carried), grow, local);
    } else {
        model.local(Op::Pow, &args, value, carried, local);
    }
}

/// The largest x of a device in place of a `x` that reaches down to 0.
fn top(x: Arg<'_>, slot: usize) -> f64 {
    (x.value[slot] + x.radius[slot]).max(MIN_NORMAL)
}

/// True where x may be 0 and is not below it, and y is surely positive. There x^y is between 0 and its value at the
/// largest x: 0 to a positive power is 0 by exp2 of what log2(0) is, and by any number near it.
fn is_at_zero([x, y]: [Arg<'_>; 2], slot: usize) -> bool {
    let reach = x.value[slot] + x.radius[slot];
    let near = x.value[slot] <= x.radius[slot].max(MIN_NORMAL) && x.value[slot] >= 0.0 && reach < 1.0;
    near && y.value[slot] > y.radius[slot] && (y.value[slot] + y.radius[slot]).is_finite()
}

/// Writes the images of x^y in those of the `active` slots in which x is not negative and may be 0. True when there is
/// one. The whole movement counts as an error of the operation.
pub(super) fn at_zero(args: [Arg<'_>; 2], active: &Mask, out: &mut Out2<'_>) -> bool {
    let mut some = false;
    active.each(|slot| {
        if !is_at_zero(args, slot) {
            return;
        }
        some = true;
        let [x, y] = args;
        let most = number::POW.value(top(x, slot), y.value[slot] - y.radius[slot]);
        let value = if x.value[slot] > 0.0 { number::POW.value(x.value[slot], y.value[slot]) } else { 0.0 };
        out.value[slot] = value;
        out.moves[slot] = value.max(most - value);
        for k in 0..2 {
            (out.slopes[k][slot], out.bends[k][slot]) = (0.0, f64::INFINITY);
        }
    });
    some
}

/// Local error of x^y where [`at_zero`] holds in some slots: there it is that at the largest x. Below that the logarithm
/// is larger and the power smaller, the latter by more than the former, which twice the error and a few ULP cover.
pub(super) fn power_at_zero(model: &Model<'_>, args: [Arg<'_>; 2], out: Out2<'_>, local: &mut Slots) {
    let [x, y] = args;
    let zero: [bool; SLOTS] = std::array::from_fn(|slot| out.bends[0][slot] == f64::INFINITY && is_at_zero(args, slot));
    let or = |slot: usize, there: f64, here: f64| if zero[slot] { there } else { here };
    let most: Slots = std::array::from_fn(|slot| or(slot, out.value[slot] + out.moves[slot], out.value[slot]));
    let largest: Slots = std::array::from_fn(|slot| or(slot, top(x, slot), x.value[slot]));
    let exact: Slots = std::array::from_fn(|slot| or(slot, 0.0, x.radius[slot]));
    let moves: Slots = std::array::from_fn(|slot| or(slot, 0.0, out.moves[slot]));
    let args = [Arg { value: &largest, radius: &exact }, y];
    power(model, args, &logarithm_of(&largest), (&most, &moves), number::exp_m1_all, local);
    for slot in (0..SLOTS).filter(|&slot| zero[slot]) {
        local[slot] = 2.0 * local[slot] + 2f64.powi(-18) * (1.0 + y.value[slot] + y.radius[slot]) * most[slot];
    }
}

/// Local error of x^y where it inherits from exp2(y·log2(x)): all steps of the definition.
fn power_by_exp2(
    model: &Model<'_>,
    args: [Arg<'_>; 2],
    logarithm: &Slots,
    (value, carried): (&Slots, &Slots),
    grow: impl Fn(&mut [f64]),
    local: &mut Slots,
) {
    let [x, y] = args;
    let mut exponent = [0.0; SLOTS];
    let (mut by_log, mut by_product, mut by_power) = ([0.0; SLOTS], [0.0; SLOTS], [0.0; SLOTS]);
    let mut log_moves = [0.0; SLOTS];
    number::wide(|| {
        for slot in 0..SLOTS {
            let (x, e) = (x.value[slot], x.radius[slot]);
            let moves = e * (1.0 / ((x - e) * LN_2));
            log_moves[slot] = if (x <= e) | (x <= 0.0) { f64::INFINITY } else { moves };
            exponent[slot] = y.value[slot] * logarithm[slot];
        }
    });
    model.local(Op::Log2, &[x], logarithm, &log_moves, &mut by_log);
    let mut product_moves = [0.0; SLOTS];
    number::wide(|| {
        for slot in 0..SLOTS {
            let log = log_moves[slot] + by_log[slot];
            product_moves[slot] = (y.value[slot].abs() + y.radius[slot]) * log + y.radius[slot] * logarithm[slot].abs();
        }
    });
    let log = Arg { value: logarithm, radius: &by_log };
    model.local(Op::Mul, &[log, y], &exponent, &product_moves, &mut by_product);
    let (mut exponent_moves, mut inside) = ([0.0; SLOTS], [0.0; SLOTS]);
    let mut power_moves = [0.0; SLOTS];
    number::wide(|| {
        for slot in 0..SLOTS {
            exponent_moves[slot] = product_moves[slot] + by_product[slot];
            power_moves[slot] = LN_2 * exponent_moves[slot];
            // What the steps inside add to the exponent; what the arguments carry is the node's partials'.
            inside[slot] = LN_2 * ((y.value[slot].abs() + y.radius[slot]) * by_log[slot] + by_product[slot]);
        }
    });
    let argument = Arg { value: &exponent, radius: &exponent_moves };
    for grown in [&mut power_moves, &mut inside] {
        grow(grown);
    }
    number::wide(|| (0..SLOTS).for_each(|slot| power_moves[slot] *= value[slot]));
    model.local(Op::Exp2, &[argument], value, &power_moves, &mut by_power);
    number::wide(|| {
        for slot in 0..SLOTS {
            let most = value[slot] + carried[slot];
            let moved = most * inside[slot] + by_power[slot];
            local[slot] = if moved.is_nan() { f64::INFINITY } else { moved };
        }
    });
}
