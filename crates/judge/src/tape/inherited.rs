//! Local errors of functions that stay one node, though their error is that of a definition in several
//! steps.

use super::arena::Lanes;
use super::functions::image1;
use super::kernels::Out2;
use super::model::{Arg, Model, gap};
use crate::profile::Op;
use crate::profile::grid::MIN_NORMAL;

use program::interp::{LANES, Mask};

/// Local error of √x where it inherits from 1/inversesqrt(x): both steps of the definition.
///
/// At 0 the definition is taken in its limit, as every device does that has a root at all.
pub(super) fn root_by_inverse(model: &Model<'_>, x: Arg<'_>, value: &Lanes, carried: &Lanes, local: &mut Lanes) {
    let (mut inverse, mut reach) = ([0.0; LANES], [0.0; LANES]);
    let (mut first, mut second) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        // A root below which nothing is normal has an inverse that is; the largest is taken.
        inverse[lane] = 1.0 / (value[lane] + carried[lane]).max(MIN_NORMAL);
        reach[lane] = inverse[lane] * 1e-6;
    }
    let exact = [0.0; LANES];
    let ones = [1.0; LANES];
    model.local(Op::InverseSqrt, &[Arg { value: x.value, radius: &exact }], &inverse, &reach, &mut first);
    // d(1/q)/dq = q^-2 = root².
    let root: Lanes = std::array::from_fn(|lane| value[lane] + carried[lane]);
    // An inverse at the other end of the radius may have twice the error for its size, where numbers are
    // farther apart.
    let by_inverse: Lanes = std::array::from_fn(|lane| {
        let farther = gap(1.0 / (value[lane] - carried[lane]).max(MIN_NORMAL)) > gap(inverse[lane]);
        first[lane] * root[lane] * root[lane] * (1.0 + 1e-4) * if farther { 2.0 } else { 1.0 }
    });
    // What the first step moves may lead to where numbers are twice as far apart.
    let moves: Lanes = std::array::from_fn(|lane| carried[lane] + by_inverse[lane]);
    let args = [Arg { value: &ones, radius: &exact }, Arg { value: &inverse, radius: &reach }];
    model.local(Op::Div, &args, value, &moves, &mut second);
    for lane in 0..LANES {
        local[lane] = if root[lane] == 0.0 { 0.0 } else { by_inverse[lane] + second[lane] };
    }
}

/// Local error of x^y.
pub(super) fn power(model: &Model<'_>, args: [Arg<'_>; 2], value: &Lanes, carried: &Lanes, local: &mut Lanes) {
    if model.definition(Op::Pow).is_some() {
        power_by_exp2(model, args, value, carried, local);
    } else {
        model.local(Op::Pow, &args, value, carried, local);
    }
}

/// The largest x of a device in place of a `x` that reaches down to 0.
fn top(x: Arg<'_>, lane: usize) -> f64 {
    (x.value[lane] + x.radius[lane]).max(MIN_NORMAL)
}

/// True where x may be 0 and is not below it, and y is surely positive. There x^y is between 0 and its value at the
/// largest x: 0 to a positive power is 0 by exp2 of what log2(0) is, and by any number near it.
fn is_at_zero([x, y]: [Arg<'_>; 2], lane: usize) -> bool {
    let reach = x.value[lane] + x.radius[lane];
    let near = x.value[lane] <= x.radius[lane].max(MIN_NORMAL) && x.value[lane] >= 0.0 && reach < 1.0;
    near && y.value[lane] > y.radius[lane] && (y.value[lane] + y.radius[lane]).is_finite()
}

/// Writes the images of x^y in those of the `active` lanes in which x is not negative and may be 0. True when there is
/// one. The whole movement counts as an error of the operation.
pub(super) fn at_zero(args: [Arg<'_>; 2], active: &Mask, out: &mut Out2<'_>) -> bool {
    let mut some = false;
    active.each(|lane| {
        if !is_at_zero(args, lane) {
            return;
        }
        some = true;
        let [x, y] = args;
        let most = number::POW.value(top(x, lane), y.value[lane] - y.radius[lane]);
        let value = if x.value[lane] > 0.0 { number::POW.value(x.value[lane], y.value[lane]) } else { 0.0 };
        out.value[lane] = value;
        out.moves[lane] = value.max(most - value);
        for k in 0..2 {
            (out.slopes[k][lane], out.bends[k][lane]) = (0.0, f64::INFINITY);
        }
    });
    some
}

/// Local error of x^y where [`at_zero`] holds in some lanes: there it is that at the largest x. Below that the logarithm
/// is larger and the power smaller, the latter by more than the former, which twice the error and a few ULP cover.
pub(super) fn power_at_zero(model: &Model<'_>, args: [Arg<'_>; 2], out: Out2<'_>, local: &mut Lanes) {
    let [x, y] = args;
    let zero: [bool; LANES] = std::array::from_fn(|lane| out.bends[0][lane] == f64::INFINITY && is_at_zero(args, lane));
    let or = |lane: usize, there: f64, here: f64| if zero[lane] { there } else { here };
    let most: Lanes = std::array::from_fn(|lane| or(lane, out.value[lane] + out.moves[lane], out.value[lane]));
    let largest: Lanes = std::array::from_fn(|lane| or(lane, top(x, lane), x.value[lane]));
    let exact: Lanes = std::array::from_fn(|lane| or(lane, 0.0, x.radius[lane]));
    let moves: Lanes = std::array::from_fn(|lane| or(lane, 0.0, out.moves[lane]));
    power(model, [Arg { value: &largest, radius: &exact }, y], &most, &moves, local);
    for lane in (0..LANES).filter(|&lane| zero[lane]) {
        local[lane] = 2.0 * local[lane] + 2f64.powi(-18) * (1.0 + y.value[lane] + y.radius[lane]) * most[lane];
    }
}

/// Local error of x^y where it inherits from exp2(y·log2(x)): all steps of the definition.
fn power_by_exp2(model: &Model<'_>, args: [Arg<'_>; 2], value: &Lanes, carried: &Lanes, local: &mut Lanes) {
    let [x, y] = args;
    let mut logarithm = [0.0; LANES];
    let mut exponent = [0.0; LANES];
    let (mut by_log, mut by_product, mut by_power) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    let mut log_moves = [0.0; LANES];
    for lane in 0..LANES {
        let image = image1(Op::Log2, x.value[lane], x.radius[lane], false);
        (logarithm[lane], log_moves[lane]) = (image.value, image.moves);
        exponent[lane] = y.value[lane] * image.value;
    }
    model.local(Op::Log2, &[x], &logarithm, &log_moves, &mut by_log);
    let mut product_moves = [0.0; LANES];
    for lane in 0..LANES {
        let log = log_moves[lane] + by_log[lane];
        product_moves[lane] = (y.value[lane].abs() + y.radius[lane]) * log + y.radius[lane] * logarithm[lane].abs();
    }
    let log = Arg { value: &logarithm, radius: &by_log };
    model.local(Op::Mul, &[log, y], &exponent, &product_moves, &mut by_product);
    let mut exponent_moves = [0.0; LANES];
    for lane in 0..LANES {
        exponent_moves[lane] = product_moves[lane] + by_product[lane];
    }
    let argument = Arg { value: &exponent, radius: &exponent_moves };
    let mut power_moves = [0.0; LANES];
    for lane in 0..LANES {
        power_moves[lane] = value[lane] * number::exp_m1(std::f64::consts::LN_2 * exponent_moves[lane]);
    }
    model.local(Op::Exp2, &[argument], value, &power_moves, &mut by_power);
    for lane in 0..LANES {
        // What the steps inside add to the exponent; what the arguments carry is the node's partials'.
        let inside = (y.value[lane].abs() + y.radius[lane]) * by_log[lane] + by_product[lane];
        let most = value[lane] + carried[lane];
        let moved = most * number::exp_m1(std::f64::consts::LN_2 * inside) + by_power[lane];
        local[lane] = if moved.is_nan() { f64::INFINITY } else { moved };
    }
}
