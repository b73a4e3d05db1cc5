//! Whether a device is further off than a profile says.

use judge::profile::{Allowed, Entry, Flush, Op, Profile, Rounding, accept, bin_of, grid};
use judge::single::Arguments;
use lanes::Stage;

use super::definition::by_parts;
use super::{State, promises};

/// Errors beyond what is allowed by less than this many ULP cannot be told from none: the references are no better.
const UNSURE: f64 = 1.0 / 1_048_576.0;

/// An operation that is further off than a profile says, where it exceeds that the most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worsened {
    /// The operation.
    pub op: Op,
    /// Arguments, as bits.
    pub at: Arguments,
    /// The result of the device, as bits.
    pub result: u32,
    /// Its error in ULP at the exact value; infinite for a result that is no finite number.
    pub error: f64,
    /// The error that the profile allows with these arguments, in the same unit.
    pub allowed: f64,
}

impl Worsened {
    /// How many times the error is what is allowed.
    fn excess(&self) -> f64 {
        if self.allowed > 0.0 { self.error / self.allowed } else { f64::INFINITY }
    }
}

/// The operations of a measurement that are further off than `profile` says, one entry each. With arguments for which the
/// profile says nothing, every result is as good.
pub fn worsened(state: &State, profile: &Profile) -> Vec<Worsened> {
    let mut found = Vec::new();
    for (op, tally) in state.measurements() {
        // A bound of a binade is the smaller of one in ULP and an absolute one, so that what exceeds it exceeds it at the
        // largest error of one kind as well.
        let places = tally.bins.iter().flat_map(|bin| [bin.ulp, bin.abs, bin.wild_at]).chain([tally.ratio]);
        let places = places.filter(|worst| worst.value() != 0.0);
        let mut worst: Option<Worsened> = None;
        for place in places.filter_map(|worst| exceeding(profile, op, worst.at, worst.result)) {
            if worst.is_none_or(|worst| place.excess() > worst.excess()) {
                worst = Some(place);
            }
        }
        found.extend(worst);
    }
    found
}

/// A result that is further off than the profile says; `None` for one that is not.
fn exceeding(profile: &Profile, op: Op, at: Arguments, result: u32) -> Option<Worsened> {
    let args = at.map(|word| f64::from(f32::from_bits(word)));
    let args = &args[..op.arity().unwrap_or(0)];
    let (exact, found) = (op.exact(args), f64::from(f32::from_bits(result)));
    if exact.is_nan() {
        return None;
    }
    let allowed = match profile.entry(op) {
        Entry::Measured(table) => match profile.allowed(op, args, exact, Stage::Compute) {
            // Where no API promises anything, as for the sine of 10^30, errors in ULP next to a zero of the function have
            // no largest one: samples tell nothing of the next. The absolute error remains.
            Allowed::Bound(bound) if accept(promises().0, op, args, Stage::Compute).is_err() => {
                let bin = bin_of(op.key(args))?;
                let rows = table.rows.iter().filter(|row| (row.bins.0..=row.bins.1).contains(&bin));
                rows.map(|row| table.margin * row.abs).fold(bound, f64::max)
            }
            Allowed::Bound(bound) => bound,
            Allowed::Inherited { .. } => {
                accept(promises().0, op, args, Stage::Compute).ok()?;
                by_parts(profile, op, args, exact)?
            }
            Allowed::NoPromise | Allowed::OutsideDomain => return None,
        },
        Entry::Promised(_) => {
            let accepted = accept(profile, op, args, Stage::Compute).ok()?;
            if accepted.contains(found) {
                return None;
            }
            if found < exact { exact - accepted.lo } else { accepted.hi - exact }
        }
    };
    let unit = grid::ulp(exact);
    let error = Some((found - exact).abs()).filter(|error| !error.is_nan()).unwrap_or(f64::INFINITY);
    let exceeds = error > allowed + UNSURE * unit || found.is_nan();
    exceeds.then_some(Worsened { op, at, result, error: error / unit, allowed: allowed / unit })
}

/// What a device takes the freedom to do that `then` says it does not, a sentence each.
pub fn freer(now: &Profile, then: &Profile) -> Vec<&'static str> {
    let flushes = |now: Flush, then: Flush| then == Flush::Never && now != Flush::Never;
    let freedoms = [
        (flushes(now.compute, then.compute), "subnormal numbers become zero in the compute stage"),
        (flushes(now.vertex, then.vertex), "subnormal numbers become zero in the vertex stage"),
        (
            now.rounding == Rounding::Either && then.rounding == Rounding::NearestEven,
            "sums are not rounded to the nearest number",
        ),
        (now.contraction && !then.contraction, "a product and a sum become one operation"),
        (
            now.rearrangement && !then.rearrangement,
            "sums or products are computed in another order than that of the source",
        ),
    ];
    freedoms.into_iter().filter(|(taken, _)| *taken).map(|(_, what)| what).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Function, Soft, request, rounded};
    use super::super::{Behaviour, Document, Fusion, run};
    use super::*;
    use base::text::SourceFile;
    use judge::profile::{by_name, parse};
    use lanes::Lane;

    const PLAIN: Behaviour = Behaviour {
        results: Flush::Never,
        arguments: Flush::Never,
        fusion: Fusion { fma: false, expression: false },
        nearest_even: true,
        reordered: false,
    };

    fn measured(ops: &[Op], function: Function) -> State {
        let mut state = State::new(request(ops, 50_000));
        run(&Soft::new(function), &mut state, &mut |_, _| Ok(())).unwrap();
        state
    }

    fn profile(state: &State, behaviour: &Behaviour) -> Profile {
        let lane = Soft::new(|a| a[0]);
        let lane = lane.description();
        let document = Document { lane, state, compute: behaviour, vertex: None, definitions: &[], date: "2026-01-31" };
        parse(&SourceFile::new("m.toml", document.text()), &|name| by_name(name).cloned()).unwrap()
    }

    /// 2^x, and so many ULP further for arguments from 1 to 1.5.
    fn off(x: f32, ulp: u32) -> f32 {
        let exact = rounded(Op::Exp2, x);
        if (1.0..1.5).contains(&x) { f32::from_bits(exact.to_bits() + ulp) } else { exact }
    }

    #[test]
    fn a_device_that_is_worse_is_told_with_both_figures_and_its_twin_is_not() {
        let then = profile(&measured(&[Op::Exp2], |a| off(a[0], 3)), &PLAIN);
        let worse = |function| worsened(&measured(&[Op::Exp2], function), &then);
        assert_eq!(worse(|a| off(a[0], 3)), []);
        assert_eq!(worse(|a| off(a[0], 0)), []);
        assert_eq!(worse(|a| off(a[0], 6)), [], "inside of the margin");
        let [found] = worse(|a| off(a[0], 9))[..] else { panic!("one operation") };
        let x = f32::from_bits(found.at[0]);
        assert!((1.0..1.5).contains(&x) && found.op == Op::Exp2, "{found:?}");
        assert!((9.4..=9.5).contains(&found.error) && (6.9..=7.01).contains(&found.allowed), "{found:?}");
        // One ULP where the profile has correct rounding.
        let elsewhere: Function = |a| if a[0] == 2.5 { rounded(Op::Exp2, 2.5).next_up() } else { off(a[0], 3) };
        assert_eq!(worse(elsewhere), [], "no sample has this argument");
        let elsewhere: Function = |a| if a[0] == 3.0 { 8.0_f32.next_up() } else { off(a[0], 3) };
        let [found] = worse(elsewhere)[..] else { panic!("one operation") };
        assert_eq!((f32::from_bits(found.at[0]), f32::from_bits(found.result)), (3.0, 8.0_f32.next_up()));
    }

    #[test]
    fn where_nothing_is_promised_the_absolute_error_counts() {
        // Beyond the promise of the sine, off by a hundredth, at most next to a zero by far more ULP than any sample shows.
        let off: Function = |a| rounded(Op::Sin, a[0]) + if a[0] > 1000.0 { 0.01 } else { 0.0 };
        let then = profile(&measured(&[Op::Sin], off), &PLAIN);
        let dense = |function| {
            let mut state = State::new(request(&[Op::Sin], 400_000));
            run(&Soft::new(function), &mut state, &mut |_, _| Ok(())).unwrap();
            worsened(&state, &then)
        };
        assert_eq!(dense(off), []);
        assert_eq!(dense(|a| rounded(Op::Sin, a[0]) + if a[0] > 1000.0 { 0.1 } else { 0.0 }).len(), 1);
        assert_eq!(dense(|a| rounded(Op::Sin, a[0]) + if a[0] == 3.0 { 1e-6 } else { 0.0 }).len(), 1);
    }

    #[test]
    fn what_is_no_number_is_worse_than_any_error() {
        let then = profile(&measured(&[Op::Exp2, Op::Sqrt], |a| off(a[0], 3)), &PLAIN);
        for wild in [f32::NAN, f32::INFINITY] {
            let now = if wild.is_nan() {
                measured(&[Op::Exp2], |a| if a[0] == 3.0 { f32::NAN } else { off(a[0], 3) })
            } else {
                measured(&[Op::Exp2], |a| if a[0] == 3.0 { f32::INFINITY } else { off(a[0], 3) })
            };
            let [found] = worsened(&now, &then)[..] else { panic!("one operation") };
            assert_eq!((found.at[0], found.error), (3.0_f32.to_bits(), f32::INFINITY.into()), "{wild}");
        }
    }

    #[test]
    fn a_promise_is_a_profile_as_well() {
        let then = by_name("vulkan-1.4").unwrap();
        let sine: Function = |a| rounded(Op::Sin, a[0]) + 1e-4;
        assert_eq!(worsened(&measured(&[Op::Sin], sine), then), []);
        let sine: Function = |a| rounded(Op::Sin, a[0]) + 1e-3;
        let [found] = worsened(&measured(&[Op::Sin], sine), then)[..] else { panic!("one operation") };
        assert!(found.error > 2.0 * found.allowed && f32::from_bits(found.at[0]).abs() < 3.2, "{found:?}");
    }

    #[test]
    fn parts_of_a_definition_bound_what_is_made_of_them() {
        let then = by_name("llvmpipe-22.3.6").unwrap();
        let tangent: Function = |a| a[0].sin() / a[0].cos();
        assert_eq!(worsened(&measured(&[Op::Tan], tangent), then), []);
        let [found] = worsened(&measured(&[Op::Tan], |a| a[0].tan() + 1e-5), then)[..] else { panic!("one operation") };
        assert!(found.allowed.is_finite() && found.error > found.allowed);
    }

    #[test]
    fn a_freedom_that_is_new_is_told_and_one_that_is_given_up_is_not() {
        let state = measured(&[], |a| a[0]);
        let strict = profile(&state, &PLAIN);
        assert_eq!(freer(&strict, &strict), [""; 0]);
        let flushing = Behaviour { results: Flush::Must, arguments: Flush::Must, ..PLAIN };
        for (behaviour, said) in [
            (flushing, 2),
            (Behaviour { reordered: true, ..PLAIN }, 1),
            (Behaviour { nearest_even: false, ..PLAIN }, 1),
            (Behaviour { fusion: Fusion { fma: true, expression: true }, ..PLAIN }, 1),
        ] {
            let free = profile(&state, &behaviour);
            assert_eq!(freer(&free, &strict).len(), said, "{behaviour:?}");
            assert_eq!(freer(&strict, &free), [""; 0], "{behaviour:?}");
        }
    }
}
