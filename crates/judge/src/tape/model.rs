//! What an operation may add to the error: by a profile, or by the rounding of binary64 itself.

use super::arena::Slots;
use super::kernels::{self, Closing, rounding};
use crate::profile::grid::{MAX_FINITE, MIN_NORMAL};
use crate::profile::{
    Acceptance, Allowed, Condition, Definition, Entry, Flush, Interval, Op, Piece, Profile, Quantity, Rounding, Rule,
};

use program::interp::SLOTS;
use program::lane::Stage;

/// Error of an evaluation in binary64, relative to the value: a function of the mathematical library
/// is off by less than 2^-51, and rounding errors of the few operations behind one node add to that.
pub(super) const BINARY64: f64 = 1.0 / (1_u64 << 48) as f64;

/// What bounds the error of single operations.
#[derive(Clone, Copy, Debug)]
pub enum Model<'p> {
    /// A device that keeps the promises of a profile in a stage.
    Device {
        /// The profile.
        profile: &'p Profile,
        /// The stage.
        stage: Stage,
        /// Whether sums and products may be regrouped.
        rearranged: bool,
    },
    /// Two evaluations in binary64 of the same real function.
    Binary64,
}

/// An argument of an operation: its values, and how far they may be off.
#[derive(Clone, Copy)]
pub(super) struct Arg<'a> {
    pub value: &'a Slots,
    pub radius: &'a Slots,
}

/// Distance between neighbouring binary32 numbers at x ≥ 0; infinite beyond the range.
#[inline(always)]
pub(crate) fn gap(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    const ULP: f64 = 1.0 / (1 << 23) as f64;
    let power = f64::from_bits(x.to_bits() & EXPONENT);
    (power * ULP).max(f64::from_bits((1023 - 149) << 52))
}

impl<'p> Model<'p> {
    /// The definition that an operation inherits from, with the error that is allowed in any case.
    pub(super) fn definition(&self, op: Op) -> Option<(Definition, f64)> {
        let Self::Device { profile, .. } = self else { return None };
        match profile.entry(op) {
            Entry::Promised(pieces) => match pieces.first().map(|piece| piece.rule) {
                Some(Rule::Inherited { definition, or }) => Some((definition, or)),
                _ => None,
            },
            // The parts of the definition, as measured, bound what was seen.
            Entry::Measured(table) => table.definition.map(|definition| (definition, 0.0)),
        }
    }

    /// True when the ends of what is accepted are moved outward to binary32 numbers.
    pub(super) fn is_outward(&self) -> bool {
        matches!(self, Self::Device { profile, .. } if profile.acceptance == Acceptance::Outward)
    }

    /// How far the ends of what is accepted are moved outward to binary32 numbers, for results up to
    /// this size; 0 for a size that is not finite, where other nodes say why.
    pub(super) fn outward(&self, size: f64) -> f64 {
        if self.is_outward() && size.is_finite() { gap(size) } else { 0.0 }
    }

    pub(super) fn is_rearranged(&self) -> bool {
        matches!(self, Self::Device { rearranged: true, .. })
    }

    /// True where an operation of the source is rounded to nearest by itself, whatever its arguments are: in the order that
    /// is written, fused with no other.
    pub(super) fn rounds_to_nearest(&self, op: Op) -> bool {
        let Self::Device { profile, rearranged: false, .. } = self else { return false };
        profile.rounding == Rounding::NearestEven
            && !profile.contraction
            && match profile.entry(op) {
                Entry::Promised(pieces) => {
                    matches!(&pieces[..], [Piece { rule: Rule::Rounded, domain }] if domain.is_empty())
                }
                Entry::Measured(table) => table.rounds(),
            }
    }

    /// How much of the value one rounding is.
    pub(super) fn unit(&self) -> f64 {
        match self {
            Self::Device { profile, .. } => match profile.rounding {
                Rounding::Either => 2f64.powi(-23),
                Rounding::NearestEven => 2f64.powi(-24),
            },
            Self::Binary64 => BINARY64,
        }
    }

    /// How far a device may be off in the coordinate of a texel, of its size and in texels. Vulkan states
    /// no number; its conformance suite takes coordinates of 20 bits and 7 bits within a texel. Strict
    /// binary32 rounds as all else.
    pub(super) fn texel_slack(&self) -> (f64, f64) {
        match self {
            Self::Device { profile, .. } if !profile.is_strict() => (2f64.powi(-20), 2f64.powi(-7)),
            Self::Device { .. } | Self::Binary64 => (0.0, 0.0),
        }
    }

    /// True where a device may take for granted that no number is infinite, and that none is NaN (WGSL, 15.7.2; Vulkan 1.4,
    /// without `SignedZeroInfNanPreserve`): what it makes of them is open.
    pub(super) fn assumes_finite(&self) -> bool {
        matches!(self, Self::Device { profile, .. } if !profile.is_strict())
    }

    /// True where a number becomes either of its neighbours in binary16 (GLSL 4.60, 4.7.1 and 8.4; WGSL, 15.7.6).
    pub(super) fn rounds_halves_either_way(&self) -> bool {
        matches!(self, Self::Device { profile, .. } if profile.rounding == Rounding::Either)
    }

    /// True when subnormal numbers may become zero.
    pub(super) fn flushes(&self) -> bool {
        match self {
            Self::Device { profile, stage, .. } => profile.flush(*stage) != Flush::Never,
            Self::Binary64 => false,
        }
    }

    /// The error that an operation itself may make, in `local`, for any arguments within their
    /// radius. `carried` is how far the exact result moves with the arguments. Infinite where nothing
    /// is promised.
    pub(super) fn local(&self, op: Op, args: &[Arg<'_>], value: &Slots, carried: &Slots, local: &mut Slots) {
        let Self::Device { profile, stage, .. } = *self else {
            let part = if super::integral::keeps(op) { 0.0 } else { BINARY64 };
            for (b, v) in local.iter_mut().zip(value) {
                *b = v.abs() * part;
            }
            return;
        };
        let lost = lost(op, args, value);
        match profile.entry(op) {
            Entry::Promised(pieces) => match &pieces[..] {
                [Piece { rule, domain }] if domain.is_empty() => {
                    promised(profile, *rule, &lost, args, value, carried, local);
                }
                pieces => pieced(profile, pieces, &lost, args, value, carried, local),
            },
            Entry::Measured(_) => measured(profile, (op, stage), &lost, args, value, carried, local),
        }
    }

    /// Adds what holds for every operation of a device: binary64 itself, flushed results, overflow.
    /// True when some result may be subnormal.
    pub(super) fn finish(&self, value: &Slots, carried: &Slots, local: &mut Slots) -> bool {
        let Self::Device { .. } = self else { return false };
        kernels::finish(value, carried, local, self.flushes())
    }

    /// How a sum or product ends that is rounded once whatever its arguments are, and whose flushed
    /// arguments add nothing; `None` for others. `tiny`: which arguments may be subnormal; `kept`: it is not regrouped in any
    /// case.
    pub(super) fn closing(&self, op: Op, tiny: [bool; 2], kept: bool) -> Option<Closing> {
        let Self::Device { profile, rearranged, .. } = self else { return None };
        let flushes = self.flushes();
        match profile.entry(op) {
            Entry::Promised(pieces) => match &pieces[..] {
                [Piece { rule: Rule::Rounded, domain }] if domain.is_empty() => {}
                _ => return None,
            },
            Entry::Measured(_) => return None,
        }
        let own = !rearranged || kept;
        (!flushes || tiny == [false; 2]).then(|| Closing { part: part(profile.rounding), flushes, own })
    }
}

/// Part of a gap that a rounding is at most.
fn part(rounding: Rounding) -> f64 {
    match rounding {
        Rounding::Either => 1.0,
        Rounding::NearestEven => 0.5,
    }
}

/// What binary64 may have lost of the results of an operation where nothing shows it: 0 where none is, or where a result
/// is off in a way that shows. Zero for all operations that round exact arguments as [`kernels::lost_by_sum`] says.
fn lost(op: Op, args: &[Arg<'_>], value: &Slots) -> Slots {
    let mut out = [0.0; SLOTS];
    match (op, args) {
        (Op::Add | Op::Sub, [x, y]) => {
            // The value is that of ±x ± y: the signs are those that give it.
            number::wide(|| {
                for slot in 0..SLOTS {
                    let (x, y, v) = (x.value[slot], y.value[slot], value[slot]);
                    let least = |a: f64, b: f64| if a.abs() < b.abs() { a } else { b };
                    let all = [(x, y), (x, -y), (-x, y), (-x, -y)];
                    let fits = all.map(|(x, y)| if x + y == v { kernels::lost_by_sum(x, y, v) } else { f64::INFINITY });
                    out[slot] = fits.into_iter().fold(f64::INFINITY, least);
                }
            });
        }
        (Op::Fract, [x, ..]) => {
            number::wide(|| {
                for slot in 0..SLOTS {
                    let x = x.value[slot];
                    out[slot] = kernels::lost_by_sum(x, -x.floor(), value[slot]);
                }
            });
        }
        _ if op.is_inexact() => number::wide(|| {
            for slot in 0..SLOTS {
                out[slot] = value[slot] * BINARY64;
            }
        }),
        _ => {}
    }
    out
}

/// One rule for all arguments.
fn promised(
    profile: &Profile,
    rule: Rule,
    lost: &Slots,
    args: &[Arg<'_>],
    value: &Slots,
    carried: &Slots,
    local: &mut Slots,
) {
    let outward = if profile.acceptance == Acceptance::Outward { 1.0 } else { 0.0 };
    match rule {
        Rule::Exact => local.fill(0.0),
        Rule::Rounded => {
            let part = part(profile.rounding);
            number::wide(|| {
                for slot in 0..SLOTS {
                    local[slot] = rounding(part, value[slot], lost[slot], carried[slot]);
                }
            });
        }
        Rule::Ulp { constant, slope } => {
            let x = args[0];
            number::wide(|| {
                for slot in 0..SLOTS {
                    let count = constant + slope * (x.value[slot].abs() + x.radius[slot]);
                    let reach = value[slot].abs() + carried[slot];
                    let error = count * gap(reach);
                    // The end that is moved outward may lie where numbers are twice as far apart.
                    local[slot] = error + outward * gap(reach + error);
                }
            });
        }
        Rule::Absolute(error) => {
            number::wide(|| {
                for slot in 0..SLOTS {
                    local[slot] = error + outward * gap(value[slot].abs() + carried[slot] + error);
                }
            });
        }
        Rule::NoPromise | Rule::Inherited { .. } => local.fill(f64::INFINITY),
    }
}

/// Rules by the range of the arguments: the largest of those that may hold within the radius.
fn pieced(
    profile: &Profile,
    pieces: &[Piece],
    lost: &Slots,
    args: &[Arg<'_>],
    value: &Slots,
    carried: &Slots,
    local: &mut Slots,
) {
    let mut part = [0.0; SLOTS];
    let mut open = [true; SLOTS];
    local.fill(0.0);
    for (k, piece) in pieces.iter().enumerate() {
        promised(profile, piece.rule, lost, args, value, carried, &mut part);
        let (touches, covers) = places(piece, args);
        if k == 0 && covers.iter().fold(true, |all, covers| all & covers) {
            *local = part;
            return;
        }
        number::wide(|| {
            for slot in 0..SLOTS {
                let touched = open[slot] & touches[slot];
                local[slot] = if touched { local[slot].max(part[slot]) } else { local[slot] };
                open[slot] &= !covers[slot];
            }
        });
    }
    // What no piece covers is promised nothing.
    for (b, open) in local.iter_mut().zip(open) {
        if open {
            *b = f64::INFINITY;
        }
    }
}

/// In which slots a piece may hold for some arguments within their radii, and in which it holds for
/// all of them: [`Piece::touches`] and [`Piece::covers`].
fn places(piece: &Piece, args: &[Arg<'_>]) -> ([bool; SLOTS], [bool; SLOTS]) {
    let (mut touches, mut covers) = ([true; SLOTS], [true; SLOTS]);
    for Condition { quantity, range } in &piece.domain {
        let (k, size) = match quantity {
            Quantity::X => (0, false),
            Quantity::Y => (1, false),
            Quantity::AbsX => (0, true),
            Quantity::AbsY => (1, true),
        };
        let Some(Arg { value, radius }) = args.get(k) else { return ([false; SLOTS], [false; SLOTS]) };
        number::wide(|| {
            for slot in 0..SLOTS {
                let (lo, hi) = (value[slot] - radius[slot], value[slot] + radius[slot]);
                let (near, far) = (lo.abs().min(hi.abs()), lo.abs().max(hi.abs()));
                let near = if (lo <= 0.0) & (0.0 <= hi) { 0.0 } else { near };
                let (lo, hi) = if size { (near, far) } else { (lo, hi) };
                touches[slot] &= (lo <= range.hi) & (range.lo <= hi);
                covers[slot] &= (range.lo <= lo) & (lo <= range.hi) & (range.lo <= hi) & (hi <= range.hi);
            }
        });
    }
    (touches, covers)
}

fn boxed(args: &[Arg<'_>], slot: usize) -> [Interval; 2] {
    std::array::from_fn(|k| match args.get(k) {
        Some(arg) => {
            let (x, e) = (arg.value[slot], arg.radius[slot]);
            Interval { lo: x - e, hi: x + e }
        }
        None => Interval::point(f64::NAN),
    })
}

/// Errors as they were measured, at the ends of what the arguments may be.
fn measured(
    profile: &Profile,
    (op, stage): (Op, Stage),
    lost: &Slots,
    args: &[Arg<'_>],
    value: &Slots,
    carried: &Slots,
    local: &mut Slots,
) {
    if let (Op::Add | Op::Sub | Op::Mul, Entry::Measured(table)) = (op, profile.entry(op))
        && table.rounds()
    {
        return halves(profile.flush(stage) != Flush::Never, args, value, carried, local);
    }
    for slot in 0..SLOTS {
        let ranges = boxed(args, slot);
        let exact = value[slot].abs() + carried[slot];
        let at = |ends: [f64; 2]| match profile.allowed(op, &ends[..args.len()], exact, stage) {
            Allowed::Bound(bound) => bound,
            Allowed::Inherited { .. } | Allowed::NoPromise | Allowed::OutsideDomain => f64::INFINITY,
        };
        let rounded = carried[slot] == 0.0
            && args.iter().all(|arg| arg.radius[slot] == 0.0)
            && f64::from(value[slot] as f32) == value[slot]
            && lost[slot] == 0.0
            && matches!(op, Op::Add | Op::Sub | Op::Mul);
        local[slot] = if rounded {
            0.0
        } else if ranges.iter().take(args.len()).all(|r| r.lo == r.hi) {
            at([ranges[0].lo, ranges[1].lo])
        } else {
            at([ranges[0].lo, ranges[1].lo]).max(at([ranges[0].hi, ranges[1].hi]))
        };
    }
}

/// [`measured`] for sums and products that are rounded to nearest.
fn halves(flushes: bool, args: &[Arg<'_>], value: &Slots, carried: &Slots, local: &mut Slots) {
    let mut sure = [0.0; SLOTS];
    for arg in args {
        number::wide(|| sure.iter_mut().zip(arg.radius).for_each(|(sum, e)| *sum += e));
    }
    number::wide(|| {
        for slot in 0..SLOTS {
            let (v, exact) = (value[slot], value[slot].abs() + carried[slot]);
            let kept = (carried[slot] == 0.0) & (sure[slot] == 0.0) & (f64::from(v as f32) == v);
            let half = 0.5 * gap(exact);
            let flushed = half.max(exact);
            let half = if flushes & (exact - half < MIN_NORMAL) { flushed } else { half };
            let half = if exact + half <= MAX_FINITE { half } else { f64::INFINITY };
            local[slot] = if kept { 0.0 } else { half };
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::by_name;
    use base::value::ulp_at;

    #[test]
    fn measured_sums_are_those_of_the_table() {
        let profile = by_name("llvmpipe-22.3.6").expect("a shipped profile");
        let x: Slots = std::array::from_fn(|k| [0.0, 1.0, -3e38, 1e-40, 0.1, 1e300, f64::NAN][k % 7]);
        let y: Slots = std::array::from_fn(|k| [1.0, -2e38, 0.0, 1e-39, -0.1][k % 5]);
        let radius: Slots = std::array::from_fn(|k| [0.0, 1e-9, 1e36, f64::INFINITY][k / 35 % 4]);
        let value: Slots = std::array::from_fn(|slot| x[slot] + y[slot]);
        let args = [Arg { value: &x, radius: &radius }, Arg { value: &y, radius: &[0.0; SLOTS] }];
        let mut local = [0.0; SLOTS];
        let lost = lost(Op::Add, &args, &value);
        measured(profile, (Op::Add, Stage::Vertex), &lost, &args, &value, &radius, &mut local);
        for slot in 0..SLOTS {
            let exact = value[slot].abs() + radius[slot];
            let at = |x: f64| match profile.allowed(Op::Add, &[x, y[slot]], exact, Stage::Vertex) {
                Allowed::Bound(bound) => bound,
                _ => f64::INFINITY,
            };
            let kept = radius[slot] == 0.0 && f64::from(value[slot] as f32) == value[slot];
            let slow = if kept { 0.0 } else { at(x[slot] - radius[slot]).max(at(x[slot] + radius[slot])) };
            assert_eq!(local[slot], slow, "{} ± {} and {}", x[slot], radius[slot], y[slot]);
        }
    }

    #[test]
    fn the_gap_is_the_distance_of_neighbours() {
        for x in [0.0, 1e-45, 1e-38, 0.3, 1.0, 1.5, 2.0, 3e38] {
            assert_eq!(gap(x), ulp_at(x), "{x}");
        }
        assert_eq!(gap(f64::INFINITY), f64::INFINITY);
    }
}
