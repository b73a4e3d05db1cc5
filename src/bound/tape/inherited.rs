//! Local errors of functions that stay one node, though their error is that of a definition in several
//! steps.

use super::arena::Lanes;
use super::functions::image1;
use super::model::{Arg, Model, gap};
use crate::bound::profile::Op;
use crate::bound::profile::grid::MIN_NORMAL;
use crate::interp::LANES;
use crate::math;

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

/// Local error of x^y where it inherits from exp2(y·log2(x)): all steps of the definition.
pub(super) fn power_by_exp2(model: &Model<'_>, args: [Arg<'_>; 2], value: &Lanes, carried: &Lanes, local: &mut Lanes) {
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
        power_moves[lane] = value[lane] * math::exp_m1(std::f64::consts::LN_2 * exponent_moves[lane]);
    }
    model.local(Op::Exp2, &[argument], value, &power_moves, &mut by_power);
    for lane in 0..LANES {
        // What the steps inside add to the exponent; what the arguments carry is the node's partials'.
        let inside = (y.value[lane].abs() + y.radius[lane]) * by_log[lane] + by_product[lane];
        let most = value[lane] + carried[lane];
        let moved = most * math::exp_m1(std::f64::consts::LN_2 * inside) + by_power[lane];
        local[lane] = if moved.is_nan() { f64::INFINITY } else { moved };
    }
}
