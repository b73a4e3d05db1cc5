use std::cell::Cell;

use super::device::{DISPATCH, swept};
use super::*;
use base::text::SourceFile;
use base::value::Batch;
use judge::profile::{Allowed, Definition, Flush, Rounding, accept, parse};
use lanes::{Actual, Api, Description, Marks, Runner};
use program::Kernel;

pub(super) type Function = fn(&[f32]) -> f32;

/// A device that computes one function on the host.
pub(super) struct Soft {
    description: Description,
    function: Function,
    /// Dispatches that still succeed.
    left: Cell<usize>,
}

impl Soft {
    pub(super) fn new(function: Function) -> Self {
        let description = Description {
            name: "soft",
            driver: "soft 1".to_owned(),
            executor: "soft".to_owned(),
            front_end: "naga".to_owned(),
            api: Api::Vulkan,
            stages: vec![Stage::Compute],
        };
        Self { description, function, left: Cell::new(usize::MAX) }
    }
}

impl Lane for Soft {
    fn description(&self) -> &Description {
        &self.description
    }

    fn prepare(&self, kernel: &Kernel, capacity: usize) -> Result<Box<dyn Runner>, LaneError> {
        if self.left.get() == 0 {
            return Err(LaneError::Api("unplugged".to_owned()));
        }
        self.left.set(self.left.get() - 1);
        Ok(Box::new(SoftRunner { function: self.function, layout: kernel.output.clone(), capacity }))
    }
}

struct SoftRunner {
    function: Function,
    layout: program::OutputLayout,
    capacity: usize,
}

impl Runner for SoftRunner {
    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, batch: &Batch) -> Result<Actual, LaneError> {
        let marks = Marks::random();
        let width = self.layout.vertex.words();
        let mut words = Vec::new();
        for k in 0..batch.invocation_count() {
            words.push(marks.canary ^ k as u32);
            let record = batch.invocation(k);
            for column in 0..width as u32 {
                // Wide records belong to the kernel that counts words up from its only argument.
                let arguments: Vec<f32> = record.iter().map(|w| f32::from_bits(w + column)).collect();
                words.push((self.function)(&arguments).to_bits());
            }
        }
        Actual::accept(&self.layout, words, batch.invocation_count(), marks)
    }
}

pub(super) fn request(ops: &[Op], samples: u64) -> Request {
    let ops = ops.iter().map(|op| op.name().to_owned()).collect();
    Request { ops, samples, exhaustive: false, search: 0, driver: "soft 1".to_owned(), part: whole() }
}

fn measured(op: Op, function: Function) -> Tally {
    let mut state = State::new(request(&[op], 20_000));
    run(&Soft::new(function), &mut state, &mut |_, _| Ok(())).unwrap();
    assert_eq!(state.done(), state.request().total());
    state.tallies[0].clone()
}

fn standing(op: Op, function: Function) -> Standing {
    Standing::of(op, &measured(op, function))
}

/// The correctly rounded value of a function of one argument.
pub(super) fn rounded(op: Op, x: f32) -> f32 {
    op.exact(&[f64::from(x)]) as f32
}

#[test]
fn correct_rounding_is_inside_every_promise() {
    assert_eq!(standing(Op::Sin, |a| rounded(Op::Sin, a[0])), Standing::Inside);
    assert_eq!(standing(Op::Log2, |a| rounded(Op::Log2, a[0])), Standing::Inside);
    assert_eq!(standing(Op::Fract, |a| rounded(Op::Fract, a[0])), Standing::Inside);
    let tally = measured(Op::Sqrt, |a| a[0].sqrt());
    assert!(tally.worst_ulp().value() <= 0.5 && tally.undefined > 0 && tally.outside_text == 0);
}

#[test]
fn a_sine_off_by_twice_its_promise_is_outside() {
    let off: Function = |a| (f64::from(a[0]).sin() + 2.0 * 2f64.powi(-11)) as f32;
    let tally = measured(Op::Sin, off);
    assert_eq!(Standing::of(Op::Sin, &tally), Standing::Outside);
    assert!((tally.ratio.value() - 2.0).abs() < 1e-3, "{}", tally.ratio.value());
    // Nothing is promised beyond π: what is wrong there alone is not held against the device.
    assert_eq!(standing(Op::Sin, |a| if a[0].abs() < 3.2 { a[0].sin() } else { 7.0 }), Standing::Inside);
}

#[test]
fn an_error_that_only_the_conformance_suite_accepts_is_told_apart() {
    let edge: Function = |a| {
        let (text, suite) = promises();
        let of = |p| accept(p, Op::Exp2, &[f64::from(a[0])], Stage::Compute);
        match (of(text), of(suite)) {
            // The largest number that the suite accepts; where the text does too, the exact value.
            (Ok(text), Ok(suite)) if suite.hi > text.hi && suite.hi.is_finite() => suite.hi as f32,
            _ => rounded(Op::Exp2, a[0]),
        }
    };
    let tally = measured(Op::Exp2, edge);
    assert_eq!(Standing::of(Op::Exp2, &tally), Standing::InsideSuite);
    assert!(tally.outside_text > 1000, "{}", tally.outside_text);
    // Up to one gap more on 3; just below a power of two, up to two of the smaller gaps.
    assert!(tally.ratio.value() > 1.0 && tally.ratio.value() < 5.0 / 3.0, "{:?}", tally.ratio);
    let beyond: Function = |a| {
        let (_, suite) = promises();
        accept(suite, Op::Exp2, &[f64::from(a[0])], Stage::Compute).map_or(f32::NAN, |i| (i.hi as f32).next_up())
    };
    assert_eq!(standing(Op::Exp2, beyond), Standing::Outside);
}

#[test]
fn what_rounds_to_a_third_number_is_outside_of_correct_rounding() {
    assert_eq!(standing(Op::Floor, |a| a[0].floor().next_up()), Standing::Outside);
    // Either neighbour is accepted: rounding to nearest is not promised.
    let other: Function = |a| {
        let exact = f64::from(a[0]) + f64::from(a[1]);
        let near = exact as f32;
        if f64::from(near) < exact { near.next_up() } else { near }
    };
    assert_eq!(standing(Op::Add, other), Standing::Inside);
    assert_eq!(standing(Op::Add, |a| (a[0] + a[1]).next_up()), Standing::Outside);
}

#[test]
fn a_result_that_is_no_number_is_outside() {
    let tally = measured(Op::InverseSqrt, |a| if a[0] == 2.0 { f32::NAN } else { 1.0 / a[0].sqrt() });
    assert_eq!(Standing::of(Op::InverseSqrt, &tally), Standing::Outside);
    assert_eq!(tally.ratio.value(), f64::INFINITY);
    assert_eq!(f32::from_bits(tally.ratio.at[0]), 2.0);
    let bin = &tally.bins[(2.0_f32.to_bits() >> 23) as usize];
    assert!(bin.wild > 0 && bin.wild == tally.outside_suite, "2 is a special value in more ways than one");
}

#[test]
fn an_operation_without_a_promise_cannot_break_one() {
    assert_eq!(Standing::of(Op::Determinant, &Tally::default()), Standing::NoPromise);
}

#[test]
fn flushed_results_and_arguments_are_counted_and_are_no_errors() {
    let tally = measured(Op::Radians, |a| {
        let flush = |x: f32| if x.abs() < f32::MIN_POSITIVE { 0.0 } else { x };
        flush(flush(a[0]) * (std::f32::consts::PI / 180.0))
    });
    assert_eq!(Standing::of(Op::Radians, &tally), Standing::Inside);
    assert!(tally.flushed > 0 && tally.worst_ulp().value() < 2.0);
}

#[test]
fn a_stopped_run_goes_on_where_it_was_and_ends_alike() {
    let ops = [Op::Sqrt, Op::Exp2, Op::Cos];
    let function: Function = |a| a[0].sqrt();
    let whole = {
        let mut state = State::new(request(&ops, 5000));
        run(&Soft::new(function), &mut state, &mut |_, _| Ok(())).unwrap();
        state
    };
    let lane = Soft::new(function);
    lane.left.set(2);
    let mut saved = Vec::new();
    let mut state = State::new(request(&ops, 5000));
    let save = &mut |state: &State, _| {
        saved = serde_json::to_vec(state).map_err(std::io::Error::other)?;
        Ok(())
    };
    assert!(matches!(run(&lane, &mut state, save), Err(CalibrateError::Lane(_))));
    let state: State = serde_json::from_slice(&saved).unwrap();
    assert_eq!(state.done(), 2 * state.request().size(Op::Sqrt));
    let mut state = state.resume(&request(&ops, 5000)).unwrap();
    lane.left.set(1);
    run(&lane, &mut state, &mut |_, _| Ok(())).unwrap();
    assert_eq!(state, whole);
}

#[test]
fn a_state_of_another_run_is_refused() {
    let state = || State::new(request(&[Op::Sin], 100));
    let refused = |request: &Request| state().resume(request).unwrap_err().to_string();
    assert!(refused(&request(&[Op::Sin], 200)).contains("samples was 100 and is 200"));
    assert!(refused(&request(&[Op::Cos], 100)).contains("operations was sin and is cos"));
    let other = Request { driver: "soft 2".to_owned(), ..request(&[Op::Sin], 100) };
    assert!(refused(&other).contains("device was soft 1 and is soft 2"));
}

#[test]
fn a_state_that_cannot_be_saved_stops_the_run() {
    let mut state = State::new(request(&[Op::Sin], 100));
    let full = &mut |_: &State, _| Err(std::io::Error::other("no space"));
    let error = run(&Soft::new(|a| a[0]), &mut state, full).unwrap_err();
    assert_eq!(error.to_string(), "cannot save the state: no space");
}

#[test]
fn a_sweep_counts_every_finite_number_once() {
    assert_eq!((swept(0), swept(FINITE - 1)), (0, f32::MAX.to_bits()));
    assert_eq!((swept(FINITE), swept(2 * FINITE - 1)), ((-0.0_f32).to_bits(), f32::MIN.to_bits()));
    let lane = Soft::new(|a| a[0].sqrt());
    let (text, suite) = promises();
    let judge = Judge::new(Op::Sqrt, text, suite, Stage::Compute);
    let mut device = MeasuredDevice::new(&lane, Op::Sqrt, true).unwrap();
    // The last numbers of one sign and the first of the other.
    let step = DISPATCH as u64 * kernel::SWEEP as u64;
    let tally = device.block(&judge, FINITE - step..FINITE + step).unwrap();
    assert_eq!(tally.samples, 2 * step);
    assert_eq!(tally.undefined, step - 1, "all with a minus sign but zero");
    assert!(tally.worst_ulp().value() <= 0.5);
    assert_eq!(tally.bins.iter().map(|b| b.samples).sum::<u64>(), step + 1);
}

#[test]
fn the_quick_tally_is_the_plain_one() {
    let (text, suite) = promises();
    // Around the end of a domain, an absolute and a relative promise, overflow, subnormal numbers
    // and undefined values, with errors of all sizes.
    for (op, middle) in [
        (Op::Sin, std::f32::consts::PI),
        (Op::Sin, 1.0),
        (Op::Tan, 1.2),
        (Op::Tan, 5.0),
        (Op::Log2, 1.3),
        (Op::Log2, 9.0),
        (Op::Log2, -1.5),
        (Op::Exp2, -0.06),
        (Op::Exp, 88.75),
        (Op::Sqrt, 1e-40),
        (Op::Tanh, 1e-4),
        (Op::Asin, 0.9),
    ] {
        let judge = Judge::new(op, text, suite, Stage::Compute);
        let first = middle.to_bits() & !0xfff;
        let results: Vec<u32> = (0..0x1000)
            .map(|k| {
                let near = rounded(op, f32::from_bits(first + k)).to_bits();
                match k % 97 {
                    0 => near.wrapping_add(1 << (k % 23)),
                    1 => near.wrapping_sub(k % 5),
                    2 => 0x7f80_0000 + (k & 1),
                    3 => 0,
                    _ => near,
                }
            })
            .collect();
        // All groups, and some of them.
        for step in [1, 3] {
            let width = kernel::SWEEP;
            let firsts: Vec<u32> = (first..first + 0x1000).step_by(width * step).collect();
            let results: Vec<u32> = results.chunks(width).step_by(step).flatten().copied().collect();
            let quick = judge.tally_neighbours(&firsts, &results, op.column().unwrap());
            let word = |k: usize| firsts[k / width] + (k % width) as u32;
            let plain = judge.tally(results.len(), |k| ([word(k), 0, 0], results[k]));
            assert_eq!(quick.bins, plain.bins, "{op:?}");
            assert_eq!(quick, plain, "{op:?}");
        }
    }
}

#[test]
fn the_written_profile_reads_back_with_its_bounds() {
    let driver = "so\"ft, 1".to_owned();
    let mut state = State::new(Request { driver, ..request(&[Op::Sin, Op::Sqrt], 50_000) });
    // An error of 4 ULP in one binade.
    let function: Function = |a| {
        let sine = rounded(Op::Sin, a[0]);
        if (1.0..1.3).contains(&a[0]) { f32::from_bits(sine.to_bits() + 4) } else { sine }
    };
    run(&Soft::new(function), &mut state, &mut |_, _| Ok(())).unwrap();
    let behaviour = Behaviour {
        results: Flush::Never,
        arguments: Flush::Never,
        fusion: Fusion { fma: false, expression: false },
        nearest_even: true,
        reordered: false,
    };
    let lane = Soft::new(function);
    let document = |definitions| {
        let (lane, state) = (lane.description(), &state);
        Document { lane, state, compute: &behaviour, vertex: None, definitions, date: "2026-01-31" }.text()
    };
    let read = |text: String| parse(&SourceFile::new("m.toml", text), &|name| by_name(name).cloned()).unwrap();
    let profile = read(document(&[]));
    assert_eq!((profile.name.as_str(), profile.contraction, profile.rearrangement), ("so\"ft", false, false));
    assert_eq!(profile.driver.as_deref(), Some("so\"ft, 1"));
    assert_eq!(profile.revision, "so\"ft, 1; measured 2026-01-31 with 50000 samples an operation");
    let bound = |op: Op, x: f64| match profile.allowed(op, &[x], op.exact(&[x]), Stage::Compute) {
        Allowed::Bound(bound) => bound / base::value::ulp_at(op.exact(&[x])),
        other => panic!("{other:?}"),
    };
    // Twice the 4.5 ULP that were seen.
    assert!((8.8..9.1).contains(&bound(Op::Sin, 1.3)), "{}", bound(Op::Sin, 1.3));
    assert!(bound(Op::Sin, 0.3) <= 0.5);
    // What was not measured is as the API promises, and operations on vectors are as defined.
    let unmeasured = |op| profile.allowed(op, &[1.0, 1.0, 1.0], 0.5, Stage::Compute);
    assert_eq!(unmeasured(Op::Cos), Allowed::Bound(2f64.powi(-11)));
    assert!(matches!(unmeasured(Op::Dot), Allowed::Inherited { definition: Definition::SumOfProducts, .. }));
    assert_eq!(unmeasured(Op::Inverse), Allowed::NoPromise);
    // An operation that is computed by its definition has the bound of that.
    let by_definition = read(document(&[(Op::Sin, Definition::SinOverCos)]));
    let allowed = by_definition.allowed(Op::Sin, &[1.3], 0.9, Stage::Compute);
    assert_eq!(allowed, Allowed::Inherited { definition: Definition::SinOverCos, or: 0.0 });
}

#[test]
fn what_the_probes_find_is_in_the_header() {
    use Flush::{Must, Never};
    use Rounding::{Either, NearestEven};

    let plain = Behaviour {
        results: Flush::Never,
        arguments: Flush::Never,
        fusion: Fusion { fma: false, expression: false },
        nearest_even: true,
        reordered: false,
    };
    let fused = Behaviour { fusion: Fusion { fma: true, expression: true }, ..plain };
    let reordered = Behaviour { reordered: true, ..plain };
    let flushing = Behaviour { results: Flush::Must, arguments: Flush::Must, ..plain };
    let truncating = Behaviour { nearest_even: false, ..plain };
    let lane = Soft::new(|a| a[0]);
    let state = State::new(request(&[], 1));
    let header = |compute: &Behaviour, vertex: Option<&Behaviour>| {
        let lane = lane.description();
        let text = Document { lane, state: &state, compute, vertex, definitions: &[], date: "2026-01-31" }.text();
        let p = parse(&SourceFile::new("m.toml", text), &|name| by_name(name).cloned()).unwrap();
        (p.contraction, p.rearrangement, p.compute, p.vertex, p.rounding)
    };
    assert_eq!(header(&plain, None), (false, false, Never, Never, NearestEven));
    // One stage is enough for what the header says of both.
    assert_eq!(header(&plain, Some(&fused)), (true, false, Never, Never, NearestEven));
    assert_eq!(header(&reordered, Some(&plain)), (false, true, Never, Never, NearestEven));
    assert_eq!(header(&plain, Some(&flushing)), (false, false, Never, Must, NearestEven));
    assert_eq!(header(&truncating, Some(&plain)), (false, false, Never, Never, Either));
}

#[test]
fn the_measurement_of_the_embedded_lane_is_strict() {
    let lane = lanes::embedded::open().unwrap();
    let ops = [Op::Mul, Op::Sin, Op::Cos, Op::Div, Op::Tan, Op::Exp];
    let driver = lane.description().driver.clone();
    let mut state = State::new(Request { driver, ..request(&ops, 100_000) });
    run(lane.as_ref(), &mut state, &mut |_, _| Ok(())).unwrap();
    let compute = probe(lane.as_ref(), Stage::Compute).unwrap();
    let lane_of = lane.description();
    let document = |definitions| Document {
        lane: lane_of,
        state: &state,
        compute: &compute,
        vertex: None,
        definitions,
        date: "2026-01-31",
    };
    let base = |name: &str| by_name(name).cloned();
    let profile = parse(&SourceFile::new("m.toml", document(&[]).text()), &base).unwrap();
    assert_eq!((profile.compute, profile.rounding), (Flush::Never, Rounding::NearestEven));
    assert!(!profile.contraction && !profile.rearrangement);
    for op in ops {
        let args = [0.3, 0.7];
        let exact = op.exact(&args);
        let bound = Allowed::Bound(base::value::ulp_at(exact) / 2.0);
        assert_eq!(profile.allowed(op, &args, exact, Stage::Compute), bound, "{op:?}");
    }
    assert_eq!(confirmed(lane.as_ref(), &profile).unwrap(), []);
}

#[test]
fn an_error_that_the_references_cannot_tell_from_half_an_ulp_has_no_margin() {
    // 1 + y lies a little above the middle of 1 and its neighbour, and the device says 1.
    let bound = |y: f32| {
        let (text, suite) = promises();
        let judge = Judge::new(Op::Add, text, suite, Stage::Compute);
        let tally = judge.tally(1, |_| ([1.0_f32.to_bits(), y.to_bits(), 0], 1.0_f32.to_bits()));
        assert!(tally.worst_ulp().value() > 0.5 && tally.outside_text == 0);
        let state = State { request: request(&[Op::Add], 1), tallies: vec![tally], position: 1 };
        let lane = lanes::embedded::open().unwrap();
        let compute = probe(lane.as_ref(), Stage::Compute).unwrap();
        let lane = lane.description();
        let document =
            Document { lane, state: &state, compute: &compute, vertex: None, definitions: &[], date: "2026-01-31" };
        let base = |name: &str| by_name(name).cloned();
        let profile = parse(&SourceFile::new("m.toml", document.text()), &base).unwrap();
        let args = [1.0, f64::from(y)];
        match profile.allowed(Op::Add, &args, Op::Add.exact(&args), Stage::Compute) {
            Allowed::Bound(bound) => bound / f64::from(f32::EPSILON),
            other => panic!("{other:?}"),
        }
    };
    let middle = f32::EPSILON / 2.0;
    assert_eq!(bound(middle * (1.0 + f32::EPSILON)), 0.5);
    let further = bound(middle * (1.0 + 2f32.powi(-12)));
    assert!((1.0..1.01).contains(&further), "twice what was seen: {further}");
}

/// The embedded lane against what its profile says, with a fault in the last bit or without.
fn embedded(op: Op, shifted: u32) -> Tally {
    let binary32 = by_name("binary32").unwrap();
    let judge = Judge::new(op, binary32, binary32, Stage::Compute);
    let lane = lanes::embedded::open().unwrap();
    let kernel = kernel::pointwise(op).unwrap();
    let inputs = Inputs::new(op);
    let mut batch = Batch::with_capacity(kernel.invocation.clone(), kernel.case.clone(), 1, DISPATCH);
    batch.invocations.extend((0..20_000).flat_map(|k| inputs.at(k).into_iter().take(op.arity().unwrap())));
    let actual = lane.prepare(&kernel, DISPATCH).unwrap().run(&batch).unwrap();
    judge.tally(batch.invocation_count(), |k| {
        let mut arguments = [0; 3];
        arguments[..batch.invocation(k).len()].copy_from_slice(batch.invocation(k));
        (arguments, actual.vertex(k, 0)[0] ^ shifted)
    })
}

#[test]
fn the_embedded_lane_keeps_the_binary32_profile() {
    for op in measurable() {
        let tally = embedded(op, 0);
        assert_eq!(tally.outside_text, 0, "{op:?}: {:?}", tally.ratio);
        // Without a flush a remainder of a subnormal number can look like one.
        assert!(tally.flushed == 0 || matches!(op, Op::Mod | Op::Fma), "{op:?}");
        assert_eq!(tally.samples, 20_000);
    }
}

#[test]
fn a_wrong_last_bit_is_outside_of_the_binary32_profile() {
    for op in measurable() {
        let tally = embedded(op, 1);
        // A sum of several operations leaves room for it; one operation does not.
        let room = matches!(op, Op::Mod | Op::Fma);
        assert!(room || tally.outside_text > 1000, "{op:?}: {}", tally.outside_text);
    }
}

#[test]
fn parts_cover_the_samples_and_begin_where_a_sweep_may() {
    for exhaustive in [false, true] {
        for count in [1, 2, 3, 7, 509, 510, 511, 2000] {
            let of = |index| Request { exhaustive, part: (index, count), ..request(&[Op::Sin, Op::Mul], 5000) };
            for op in [Op::Sin, Op::Mul] {
                let mut end = 0;
                for index in 0..count {
                    let range = of(index).range(op);
                    assert_eq!(range.start, end, "{op:?} {index}/{count}");
                    if exhaustive && op == Op::Sin {
                        assert!(range.start.is_multiple_of(SWEEP_UNIT) || range.is_empty(), "{index}/{count}");
                    }
                    end = range.end;
                }
                assert_eq!(end, of(0).size(op), "{op:?} in {count}");
            }
        }
    }
}

#[test]
fn parts_of_a_measurement_join_in_any_order() {
    // Many samples share the largest error: which of them is kept must not depend on the order.
    let function: Function = |a| if a[0].abs() < 2.0 { a[0] + 0.5 } else { a[0] };
    let ops = [Op::Floor, Op::Add, Op::Ceil];
    let part = |index, count| {
        let mut state = State::new(Request { part: (index, count), search: 40_000, ..request(&ops, 3000) });
        run(&Soft::new(function), &mut state, &mut |_, _| Ok(())).unwrap();
        assert_eq!(state.done(), state.request().total());
        state
    };
    let whole = part(0, 1);
    for order in [[0, 1, 2, 3], [3, 1, 0, 2], [2, 3, 1, 0]] {
        let mut joined = part(order[0], 4);
        order[1..].iter().for_each(|&index| joined.join(part(index, 4)).unwrap());
        assert_eq!(joined, whole, "{order:?}");
    }
    let mut other = part(0, 2);
    let begun = State::new(Request { part: (1, 2), search: 40_000, ..request(&ops, 3000) });
    assert!(other.join(begun).unwrap_err().to_string().contains("a part of it is not complete"));
}
