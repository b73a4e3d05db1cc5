//! What operators and functions do to intervals of real numbers. Results are rounded outwards to
//! binary32: rounding is monotone, so an operation that rounds to nearest stays inside.

use super::value::{Evidence, Range, Sources, lower, upper};

/// One part in this many: how far `normalize` and `dot` may be off, in binary32.
pub const UNIT_SLACK: f64 = 4.0 / 16_777_216.0;

/// The greatest finite number of binary32.
const MAX: f64 = f32::MAX as f64;

/// The greatest binary32 number that is not above `x`.
fn down(x: f64) -> f64 {
    let near = narrow(x);
    if near > x { f64::from(narrow32(x).next_down()) } else { near }
}

/// The least binary32 number that is not below `x`.
fn up(x: f64) -> f64 {
    let near = narrow(x);
    if near < x { f64::from(narrow32(x).next_up()) } else { near }
}

#[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is what is asked for")]
fn narrow32(x: f64) -> f32 {
    x as f32
}

/// `x` rounded to binary32.
pub fn narrow(x: f64) -> f64 {
    f64::from(narrow32(x))
}

/// Ends rounded outwards; an operation past the range of binary32 gives infinity.
fn outwards(mut r: Range) -> Range {
    r.lo = if r.lo.is_nan() { f64::NEG_INFINITY } else { down(r.lo) };
    r.hi = if r.hi.is_nan() { f64::INFINITY } else { up(r.hi) };
    if r.hi > MAX {
        r.hi = f64::INFINITY;
    }
    if r.lo < -MAX {
        r.lo = f64::NEG_INFINITY;
    }
    r
}

type End = (f64, Evidence);

fn ends(r: &Range) -> [End; 2] {
    [(r.lo, r.lo_by), (r.hi, r.hi_by)]
}

/// A result of two operands; ends are only known to be met when the operands are independent.
fn combined(a: &Range, b: &Range, lo: End, hi: End) -> Range {
    let sources = a.sources.and(b.sources);
    let apart = a.sources.apart_from(b.sources);
    let by = |e: Evidence| if apart { e } else { Evidence::Bound };
    let nan = a.nan || b.nan;
    let (lo, lo_by, hi, hi_by) = (lo.0, by(lo.1), hi.0, by(hi.1));
    outwards(Range { lo, hi, lo_by, hi_by, nan, nonzero: false, sources })
}

/// `-x`
pub fn neg(x: Range) -> Range {
    Range { lo: -x.hi, hi: -x.lo, lo_by: x.hi_by, hi_by: x.lo_by, ..x }
}

/// `a + b`
pub fn add(a: Range, b: Range) -> Range {
    let sum = |x: End, y: End| (x.0 + y.0, x.1.min(y.1));
    let [al, ah] = ends(&a);
    let [bl, bh] = ends(&b);
    let mut r = combined(&a, &b, sum(al, bl), sum(ah, bh));
    let inf = f64::INFINITY;
    r.nan |= (a.lo == -inf && b.hi == inf) || (a.hi == inf && b.lo == -inf);
    r
}

/// `a - b`
pub fn sub(a: Range, b: Range) -> Range {
    add(a, neg(b))
}

/// `a * b`
pub fn mul(a: Range, b: Range) -> Range {
    let product = |x: End, y: End| match (x.0 == 0.0, y.0 == 0.0) {
        // Nothing times infinity adds nothing to the numbers that are possible.
        (true, true) => (0.0, x.1.max(y.1)),
        (true, false) => (0.0, x.1),
        (false, true) => (0.0, y.1),
        (false, false) => (x.0 * y.0, x.1.min(y.1)),
    };
    let all: Vec<End> = ends(&a).into_iter().flat_map(|x| ends(&b).map(|y| product(x, y))).collect();
    let lo = all.iter().copied().fold(all[0], lower);
    let hi = all.iter().copied().fold(all[0], upper);
    let mut r = combined(&a, &b, lo, hi);
    let endless = |x: &Range| x.lo.is_infinite() || x.hi.is_infinite();
    r.nan |= (endless(&a) && !b.excludes_zero()) || (endless(&b) && !a.excludes_zero());
    // The product of two numbers that are not 0 may be too small for binary32.
    r
}

/// `x * x`
pub fn square(x: Range) -> Range {
    let [l, h] = ends(&x).map(|(v, by)| (v * v, by));
    let (mut lo, hi) = if x.lo.abs() <= x.hi.abs() { (l, h) } else { (h, l) };
    if x.lo <= 0.0 && x.hi >= 0.0 {
        lo = (0.0, zero_by(&x));
    }
    let r = Range { lo: lo.0, hi: hi.0, lo_by: lo.1, hi_by: hi.1, nan: x.nan, nonzero: false, sources: x.sources };
    outwards(r)
}

/// How well it is known that an interval around 0 has 0.
fn zero_by(x: &Range) -> Evidence {
    if x.lo == 0.0 {
        x.lo_by
    } else if x.hi == 0.0 {
        x.hi_by
    } else if x.nonzero {
        Evidence::Bound
    } else {
        x.lo_by.min(x.hi_by)
    }
}

/// `a / b` of floating-point numbers
pub fn div(a: Range, b: Range) -> Range {
    let sources = a.sources.and(b.sources);
    if b.lo <= 0.0 && b.hi >= 0.0 {
        let mut r = Range::unknown(sources);
        let sign = |x: &Range| (x.lo >= 0.0, x.hi <= 0.0);
        // Quotients of one sign keep it; the sign of a zero below is not known to be plus.
        if b.excludes_zero() && matches!((sign(&a), sign(&b)), ((true, _), (true, _)) | ((_, true), (_, true))) {
            r.lo = 0.0;
        }
        return r;
    }
    let quotient = |x: End, y: End| match (x.0 == 0.0, y.0.is_infinite()) {
        (true, _) => (0.0, x.1),
        (false, true) => (0.0, x.1.min(y.1)),
        (false, false) => (x.0 / y.0, x.1.min(y.1)),
    };
    let all: Vec<End> = ends(&a).into_iter().flat_map(|x| ends(&b).map(|y| quotient(x, y))).collect();
    let lo = all.iter().copied().fold(all[0], lower);
    let hi = all.iter().copied().fold(all[0], upper);
    let mut r = combined(&a, &b, lo, hi);
    r.nan |= (a.lo.is_infinite() || a.hi.is_infinite()) && (b.lo.is_infinite() || b.hi.is_infinite());
    r
}

/// A function that grows with its argument, or falls when `rising` is false.
pub fn monotone(x: Range, rising: bool, f: impl Fn(f64) -> f64) -> Range {
    let [l, h] = ends(&x).map(|(v, by)| (f(v), by));
    let (lo, hi) = if rising { (l, h) } else { (h, l) };
    outwards(Range { lo: lo.0, hi: hi.0, lo_by: lo.1, hi_by: hi.1, nan: x.nan, nonzero: false, sources: x.sources })
}

/// As [`monotone`], of a function of the device that may be off by a few units in the last place. Ends
/// in `exact` are met as they are.
fn inexact(x: Range, f: impl Fn(f64) -> f64, exact: &[f64]) -> Range {
    let mut r = monotone(x, true, f);
    if r.lo.is_finite() && !exact.contains(&r.lo) {
        r.lo -= (r.lo.abs() * UNIT_SLACK).max(f64::from(f32::MIN_POSITIVE));
    }
    if r.hi.is_finite() && !exact.contains(&r.hi) {
        r.hi += (r.hi.abs() * UNIT_SLACK).max(f64::from(f32::MIN_POSITIVE));
    }
    r
}

/// `x` cut to between two numbers: what is beyond an end gathers there, where the text states it.
pub fn cut(x: Range, lo: f64, hi: f64) -> Range {
    let limit = |v: f64, by: Evidence| match () {
        () if v < lo => (lo, Evidence::Stated),
        () if v > hi => (hi, Evidence::Stated),
        () => (v, by),
    };
    let (l, h) = (limit(x.lo, x.lo_by), limit(x.hi, x.hi_by));
    Range { lo: l.0, hi: h.0, lo_by: l.1, hi_by: h.1, nan: x.nan, nonzero: x.nonzero, sources: x.sources }
}

/// `min(a, b)`. Of an unknown and a known number, the known one is an end.
pub fn min(a: Range, b: Range) -> Range {
    neg(max(neg(a), neg(b)))
}

/// `max(a, b)`
pub fn max(a: Range, b: Range) -> Range {
    // The lower end is met when one operand stays there while the other goes below.
    let lo = if a.lo > b.lo {
        (a.lo, a.lo_by)
    } else if b.lo > a.lo {
        (b.lo, b.lo_by)
    } else {
        (a.lo, a.lo_by.min(b.lo_by))
    };
    let hi = upper((a.hi, a.hi_by), (b.hi, b.hi_by));
    let mut r = combined(&a, &b, lo, hi);
    // Of a number and NaN, the number may come out.
    if a.nan {
        (r.lo, r.lo_by) = lower((r.lo, r.lo_by), (b.lo, Evidence::Bound));
    }
    if b.nan {
        (r.lo, r.lo_by) = lower((r.lo, r.lo_by), (a.lo, Evidence::Bound));
    }
    r.nonzero = a.excludes_zero() && b.excludes_zero();
    r
}

/// `abs(x)`
pub fn abs(x: Range) -> Range {
    let r = if x.lo >= 0.0 {
        x
    } else if x.hi <= 0.0 {
        neg(x)
    } else {
        let (hi, hi_by) = upper((-x.lo, x.lo_by), (x.hi, x.hi_by));
        Range { lo: 0.0, hi, lo_by: zero_by(&x), hi_by, ..x }
    };
    Range { nonzero: x.nonzero, ..r }
}

/// `fract(x)`. The result may round to 1 for small negative numbers.
pub fn fract(x: Range) -> Range {
    if x.is_finite() && x.lo.floor() == x.hi.floor() {
        return monotone(x, true, |v| v - v.floor());
    }
    let mut r = Range::of(0.0, 1.0, Evidence::Nature, x.sources);
    r.hi_by = Evidence::Bound;
    r.nan = x.nan || !x.is_finite();
    r
}

/// `mod(x, y)`: between 0 and `y`, unless 0 divides.
pub fn modulo(x: Range, y: Range) -> Range {
    let sources = x.sources.and(y.sources);
    if !y.excludes_zero() {
        return Range::unknown(sources);
    }
    let by = Evidence::Bound;
    let mut r = Range::of(y.lo.min(0.0), y.hi.max(0.0), by, sources);
    if x.lo >= 0.0 && y.lo > 0.0 && x.hi < y.lo {
        // Nothing is taken off.
        r = Range { nan: false, ..x };
    }
    r.nan = x.nan || y.nan || !x.is_finite() || !y.is_finite();
    r
}

/// `floor`, `ceil` and their like.
pub fn stepped(x: Range, f: fn(f64) -> f64) -> Range {
    monotone(x, true, f)
}

/// `sign(x)`
pub fn sign(x: Range) -> Range {
    let of = |v: f64| {
        if v > 0.0 {
            1.0
        } else if v < 0.0 {
            -1.0
        } else {
            0.0
        }
    };
    let mut r = monotone(x, true, of);
    let known = if x.is_finite() { Evidence::Bound } else { Evidence::Nature };
    r.lo_by = r.lo_by.max(known);
    r.hi_by = r.hi_by.max(known);
    r
}

/// `sin` and `cos`: `offset` is 0 for the cosine and π/2 for the sine, so that maxima lie at
/// `offset + 2πk`.
pub fn wave(x: Range, f: fn(f64) -> f64, offset: f64) -> Range {
    let tau = std::f64::consts::TAU;
    let crosses = |at: f64| x.is_finite() && ((x.lo - at) / tau).ceil() * tau + at <= x.hi;
    let whole = !x.is_finite() || x.hi - x.lo >= tau;
    let (fl, fh) = (f(x.lo), f(x.hi));
    let by = x.lo_by.min(x.hi_by);
    // An argument without known ends is an angle that goes round; a narrow one is only as well known
    // as its ends.
    let round = if x.is_finite() { by } else { Evidence::Nature };
    let hi = if whole || crosses(offset) { (1.0, round) } else { upper((fl, x.lo_by), (fh, x.hi_by)) };
    let low = offset + std::f64::consts::PI;
    let lo = if whole || crosses(low) { (-1.0, round) } else { lower((fl, x.lo_by), (fh, x.hi_by)) };
    let nan = x.nan || x.lo.is_infinite() || x.hi.is_infinite();
    let r = Range { lo: lo.0, hi: hi.0, lo_by: lo.1, hi_by: hi.1, nan, nonzero: false, sources: x.sources };
    let mut r = outwards(r);
    // Devices are off by up to one part in 2048 here, which near 0 changes the sign.
    if x.single().is_none() && r.lo > -1.0 && lo.0 != 0.0 {
        r.lo = (r.lo - 1.0 / 2048.0).max(-1.0);
    }
    if x.single().is_none() && r.hi < 1.0 && hi.0 != 0.0 {
        r.hi = (r.hi + 1.0 / 2048.0).min(1.0);
    }
    r
}

/// A function that is defined from `least` on, where it rises.
pub fn from(x: Range, least: f64, f: fn(f64) -> f64, exact: &[f64]) -> Range {
    if x.hi < least {
        return Range::unknown(x.sources);
    }
    let outside = x.lo < least;
    let inside =
        Range { lo: x.lo.max(least), lo_by: if outside { x.lo_by.min(Evidence::Nature) } else { x.lo_by }, ..x };
    let mut r = inexact(inside, f, exact);
    r.nan |= outside;
    r
}

/// `exp` and `exp2`: never negative, though 0 by underflow.
pub fn exponential(x: Range, f: fn(f64) -> f64) -> Range {
    let mut r = inexact(x, f, &[0.0, 1.0]);
    r.lo = r.lo.max(0.0);
    r
}

/// `pow(x, y)` where it is defined: `x` not negative.
pub fn pow(x: Range, y: Range) -> Range {
    let sources = x.sources.and(y.sources);
    let outside = x.lo < 0.0 || (x.lo <= 0.0 && y.lo <= 0.0);
    if x.hi < 0.0 {
        return Range::unknown(sources);
    }
    let base = Range { lo: x.lo.max(0.0), ..x };
    let power = |x: End, y: End| (x.0.powf(y.0), x.1.min(y.1));
    let all: Vec<End> = ends(&base).into_iter().flat_map(|x| ends(&y).map(|y| power(x, y))).collect();
    let mut lo = all.iter().copied().fold(all[0], lower);
    let mut hi = all.iter().copied().fold(all[0], upper);
    // Inside, the power is monotone in each operand on either side of `x = 1` and `y = 0`.
    if (base.lo < 1.0 && base.hi > 1.0) || (y.lo < 0.0 && y.hi > 0.0) {
        lo = lower(lo, (1.0, Evidence::Bound));
        hi = upper(hi, (1.0, Evidence::Bound));
    }
    if all.iter().any(|(v, _)| v.is_nan()) {
        return Range { lo: 0.0, ..Range::unknown(sources) };
    }
    let mut r = combined(&x, &y, lo, hi);
    if r.lo > 0.0 && r.lo != 1.0 {
        r.lo *= 1.0 - 64.0 * UNIT_SLACK;
    }
    if r.hi != 1.0 && r.hi != 0.0 {
        r.hi *= 1.0 + 64.0 * UNIT_SLACK;
    }
    r.nan |= outside || (x.hi == f64::INFINITY && !y.excludes_zero());
    if outside {
        // A negative base may give anything where it does not give NaN.
        let anything = Range::unknown(sources);
        r = Range { lo: if x.lo < 0.0 { anything.lo } else { r.lo.max(0.0) }, hi: r.hi, ..r }.vague();
    }
    r
}

/// `asin`, `acos` and `atan` of what is inside the domain.
pub fn arc(x: Range, domain: f64, rising: bool, f: fn(f64) -> f64) -> Range {
    let outside = x.lo < -domain || x.hi > domain;
    if x.lo > domain || x.hi < -domain {
        return Range::unknown(x.sources);
    }
    let inside = Range { lo: x.lo.max(-domain), hi: x.hi.min(domain), ..x };
    let ends = if rising { monotone(inside, true, f) } else { monotone(inside, false, f) };
    let slack = 1.0 / 1024.0;
    let mut r = Range { lo: ends.lo - slack, hi: ends.hi + slack, ..ends }.vague();
    if ends.lo >= 0.0 {
        r.lo = 0.0;
    }
    r.nan |= outside;
    r
}

/// `mix(a, b, t)`: between `a` and `b` when `t` is between 0 and 1.
pub fn mix(a: Range, b: Range, t: Range) -> Range {
    if t.lo < 0.0 || t.hi > 1.0 {
        let unit = Range::exactly(1.0);
        return add(mul(a, sub(unit, t)), mul(b, t)).vague();
    }
    let mut r = a.join(b);
    let from = |end: f64| {
        let at = |met: bool, x: &Range, t_by: Evidence| {
            if met && (x.lo == end || x.hi == end) { t_by } else { Evidence::Bound }
        };
        at(t.lo == 0.0, &a, t.lo_by).max(at(t.hi == 1.0, &b, t.hi_by))
    };
    let apart = a.sources.apart_from(t.sources) && b.sources.apart_from(t.sources);
    let (lo, hi) = (from(r.lo), from(r.hi));
    r.lo_by = if apart { r.lo_by.min(lo) } else { Evidence::Bound };
    r.hi_by = if apart { r.hi_by.min(hi) } else { Evidence::Bound };
    r.nan |= t.nan || !a.is_finite() || !b.is_finite();
    r.sources = r.sources.and(t.sources);
    r
}

/// Between 0 and 1, as `smoothstep` and `step` are.
pub fn stepwise(sources: Sources, nan: bool) -> Range {
    let mut r = Range::of(0.0, 1.0, Evidence::Stated, sources);
    r.nan = nan;
    r
}
