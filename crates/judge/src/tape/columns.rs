//! Images of functions in all slots at once.
//!
//! The values are those of [`math`], and what is around them is written without branches. Functions
//! that are missing here are taken slot by slot.

use super::arena::Slots;
use super::functions::{image1, image2};
use super::kernels::{Out1, Out2, Pair, images1, images2, reach};
use crate::profile::Op;
use crate::profile::grid::MIN_NORMAL;

use program::interp::{Mask, SLOTS};

/// Active slots from which on a column as a whole is quicker than the slots one by one.
const WORTH_A_COLUMN: usize = SLOTS / 8;

/// Exponents up to which [`growth`] needs no exponential function.
const SHORT: f64 = 1.0 / 1024.0;

/// At least e^t − 1 for t ≥ 0, and not more than 10^-7 of it above.
pub(super) fn growth(t: &mut Slots) {
    let from = *t;
    let long = number::wide(|| {
        let mut long = 0_u64;
        for t in t.iter_mut() {
            long |= u64::from(!(*t <= SHORT));
            // t + t²/2 + t³/4 + … against t + t²/2 + t³/6 + …
            *t /= 1.0 - 0.5 * *t;
        }
        long != 0
    });
    if long {
        for (t, from) in t.iter_mut().zip(from) {
            if !(from <= SHORT) {
                *t = number::exp_m1(from);
            }
        }
    }
}

/// How far the arguments may be, flushed ones included.
fn reaches((x, e): Pair<'_>, flushes: bool) -> Slots {
    let mut out = *e;
    if flushes {
        number::wide(|| {
            for slot in 0..SLOTS {
                out[slot] = reach(x[slot], e[slot], true);
            }
        });
    }
    out
}

/// The images of a function of one number in the active slots; the others hold anything.
pub(super) fn images_of_one(
    op: Op,
    active: &Mask,
    (x, e): Pair<'_>,
    flushes: bool,
    not_negative: bool,
    out: &mut Out1<'_>,
) {
    if active.count() >= WORTH_A_COLUMN && column1(op, (x, e), flushes, not_negative, out) {
        return;
    }
    let Out1 { value, moves, slope, bend } = out;
    if !active.is_full() {
        [&mut **value, moves, slope, bend].into_iter().for_each(|column| column.fill(0.0));
    }
    active.each(|slot| {
        let found = image1(op, x[slot], reach(x[slot], e[slot], flushes), not_negative);
        (value[slot], moves[slot], slope[slot], bend[slot]) = (found.value, found.moves, found.slope, found.bends);
    });
}

/// The same for a function of two numbers. `unsigned`: a device need not keep the sign of zero.
pub(super) fn images_of_two(
    op: Op,
    active: &Mask,
    (x, ex): Pair<'_>,
    (y, ey): Pair<'_>,
    (flushes, unsigned): ([bool; 2], bool),
    out: &mut Out2<'_>,
) {
    if active.count() >= WORTH_A_COLUMN && column2(op, (x, ex), (y, ey), flushes, out) {
        return;
    }
    let Out2 { value, moves, slopes: [sx, sy], bends: [bx, by] } = out;
    if !active.is_full() {
        [&mut **value, moves, sx, sy, bx, by].into_iter().for_each(|column| column.fill(0.0));
    }
    active.each(|slot| {
        let (mut x, y) = ((x[slot], ex[slot]), (y[slot], ey[slot]));
        if op == Op::Atan2 && x.0 == 0.0 && unsigned {
            // The sign of zero decides between the half turns.
            x.1 = x.1.max(MIN_NORMAL);
        }
        let found = image2(op, (x.0, reach(x.0, x.1, flushes[0])), (y.0, reach(y.0, y.1, flushes[1])));
        (value[slot], moves[slot]) = (found.value, found.moves);
        (sx[slot], sy[slot]) = (found.slopes[0], found.slopes[1]);
        (bx[slot], by[slot]) = (found.bends[0], found.bends[1]);
    });
}

/// The images of a function of one number; false, with nothing written, for functions that are taken
/// slot by slot.
fn column1(op: Op, (x, e): Pair<'_>, flushes: bool, not_negative: bool, out: &mut Out1<'_>) -> bool {
    match op {
        // One arm for each, so that each is compiled for itself.
        Op::Abs => number::wide(|| images1((x, e), out, |x, e| image1(Op::Abs, x, reach(x, e, flushes), false))),
        Op::Sqrt => {
            number::wide(|| images1((x, e), out, |x, e| image1(Op::Sqrt, x, reach(x, e, flushes), not_negative)));
        }
        Op::InverseSqrt => {
            number::wide(|| images1((x, e), out, |x, e| image1(Op::InverseSqrt, x, reach(x, e, flushes), false)));
        }
        Op::Sin | Op::Cos => {
            let (value, slope, sign) =
                if op == Op::Sin { (number::SIN, number::COS, 1.0) } else { (number::COS, number::SIN, -1.0) };
            value.column(x, out.value);
            slope.column(x, out.slope);
            number::wide(|| {
                for slot in 0..SLOTS {
                    let moves = reach(x[slot], e[slot], flushes).min(2.0);
                    out.slope[slot] *= sign;
                    out.moves[slot] = moves;
                    out.bend[slot] = moves;
                }
            });
        }
        _ => return false,
    }
    true
}

/// The same for a function of two numbers.
fn column2(op: Op, x: Pair<'_>, y: Pair<'_>, flushes: [bool; 2], out: &mut Out2<'_>) -> bool {
    match op {
        Op::Div => number::wide(|| {
            images2(x, y, out, |(x, ex), (y, ey)| {
                image2(Op::Div, (x, reach(x, ex, flushes[0])), (y, reach(y, ey, flushes[1])))
            });
        }),
        Op::Min => number::wide(|| {
            images2(x, y, out, |(x, ex), (y, ey)| {
                image2(Op::Min, (x, reach(x, ex, flushes[0])), (y, reach(y, ey, flushes[1])))
            });
        }),
        Op::Max => number::wide(|| {
            images2(x, y, out, |(x, ex), (y, ey)| {
                image2(Op::Max, (x, reach(x, ex, flushes[0])), (y, reach(y, ey, flushes[1])))
            });
        }),
        Op::Pow => {
            let mut ln = [0.0; SLOTS];
            number::LN.column(x.0, &mut ln);
            power(x, y, &ln, flushes, growth, out);
        }
        _ => return false,
    }
    true
}

/// x^y; see [`image2`]. `ln` holds the logarithms of x; `grow` puts e^t − 1 or more in the place of numbers t.
pub(super) fn power(
    (x, ex): Pair<'_>,
    (y, ey): Pair<'_>,
    ln: &Slots,
    flushes: [bool; 2],
    grow: impl Fn(&mut Slots),
    out: &mut Out2<'_>,
) {
    let (ex, ey) = (reaches((x, ex), flushes[0]), reaches((y, ey), flushes[1]));
    number::POW.column(x, y, out.value);
    let Out2 { value, moves, slopes: [along_x, along_y], bends: [bend_x, bend_y] } = out;
    number::wide(|| {
        for slot in 0..SLOTS {
            let along = ex[slot] / (x[slot] - ex[slot]);
            moves[slot] = y[slot].abs() * along + ey[slot] * (ln[slot].abs() + along);
        }
    });
    grow(moves);
    number::wide(|| {
        for slot in 0..SLOTS {
            let (x, ex, y, ey, ln, v) = (x[slot], ex[slot], y[slot], ey[slot], ln[slot], value[slot]);
            let (along, moved) = (ex / (x - ex), moves[slot]);
            let moved = if moved == 0.0 { 0.0 } else { v * moved };
            let most = v + moved;
            let nowhere = (x <= ex) | (x <= 0.0);
            let or = |other: f64, here: f64| if nowhere { other } else { here };
            moves[slot] = or(f64::INFINITY, moved);
            along_x[slot] = or(0.0, y * v / x);
            along_y[slot] = or(0.0, ln * v);
            bend_x[slot] = or(f64::INFINITY, (y.abs() * moved + ey * most) / (x - ex) + y.abs() * v * along / x);
            bend_y[slot] = or(f64::INFINITY, ln.abs() * moved + along * most);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arguments with radii: around the places where branches meet, and beyond.
    fn arguments() -> (Slots, Slots) {
        let x = [-2.0, -1e-40, 0.0, 1e-40, 1e-38, 0.3, 1.0, 7.5, f64::INFINITY, f64::NAN];
        let e = [0.0, 1e-45, 1e-9, 0.3, 1.0, 8.0, f64::INFINITY];
        (std::array::from_fn(|k| x[k % x.len()]), std::array::from_fn(|k| e[k / x.len() % e.len()]))
    }

    /// The same number, or two numbers that evaluation in binary64 and [`growth`] may tell apart.
    fn near(a: f64, b: f64) -> bool {
        a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= 2e-7 * a.abs().max(b.abs())
    }

    #[test]
    fn a_column_has_the_images_of_its_slots() {
        let (x, e) = arguments();
        for op in [Op::Abs, Op::Sqrt, Op::InverseSqrt, Op::Sin, Op::Cos] {
            for flags in [(false, false), (true, true)] {
                let [mut value, mut moves, mut slope, mut bend] = [[7.0; SLOTS]; 4];
                let mut out = Out1 { value: &mut value, moves: &mut moves, slope: &mut slope, bend: &mut bend };
                assert!(column1(op, (&x, &e), flags.0, flags.1, &mut out));
                for slot in 0..SLOTS {
                    let image = image1(op, x[slot], reach(x[slot], e[slot], flags.0), flags.1);
                    let both = [(value[slot], image.value), (moves[slot], image.moves), (slope[slot], image.slope)];
                    for (a, b) in both.into_iter().chain([(bend[slot], image.bends)]) {
                        assert!(near(a, b), "{op:?} {} ± {}: {a} against {b}", x[slot], e[slot]);
                    }
                }
            }
        }
    }

    #[test]
    fn a_column_of_two_has_the_images_of_its_slots() {
        let (x, e) = arguments();
        let y: Slots = std::array::from_fn(|k| x[(k * 7 + 3 + k / 70) % 10]);
        let ey: Slots = std::array::from_fn(|k| e[(k * 3 + k / 70) % SLOTS]);
        for op in [Op::Div, Op::Min, Op::Max, Op::Pow] {
            for flushes in [[false, false], [true, true]] {
                let [mut value, mut moves, mut sx, mut sy, mut bx, mut by] = [[7.0; SLOTS]; 6];
                let mut out = Out2 {
                    value: &mut value,
                    moves: &mut moves,
                    slopes: [&mut sx, &mut sy],
                    bends: [&mut bx, &mut by],
                };
                assert!(column2(op, (&x, &e), (&y, &ey), flushes, &mut out));
                for slot in 0..SLOTS {
                    let of = |x: &Slots, e: &Slots, flushes| (x[slot], reach(x[slot], e[slot], flushes));
                    let image = image2(op, of(&x, &e, flushes[0]), of(&y, &ey, flushes[1]));
                    let both = [
                        (value[slot], image.value),
                        (moves[slot], image.moves),
                        (sx[slot], image.slopes[0]),
                        (sy[slot], image.slopes[1]),
                        (bx[slot], image.bends[0]),
                        (by[slot], image.bends[1]),
                    ];
                    for (a, b) in both {
                        let at = format!("{op:?} {} ± {}, {} ± {}", x[slot], e[slot], y[slot], ey[slot]);
                        assert!(near(a, b), "{at}: {a} against {b}");
                    }
                }
            }
        }
    }

    #[test]
    fn growth_is_an_upper_bound_and_a_close_one() {
        let mut t: Slots = std::array::from_fn(|k| 2f64.powf(k as f64 / 8.0 - 30.0));
        let from = t;
        growth(&mut t);
        for (t, from) in t.iter().zip(from) {
            let exact = from.exp_m1();
            assert!(*t >= exact * (1.0 - 1e-15) && *t <= exact * (1.0 + 1e-7), "{from}: {t} against {exact}");
        }
    }
}
