//! Bounds of small functions, against bounds derived by hand.

use std::sync::Arc;

use super::{Bounds, Column, Model, Tape, Why};
use crate::profile::{Op, by_name};
use base::text::SourceFile;
use base::value::{Batch, ulp_at};
use program::Program;
use program::interp::{self, Executable, FUEL, Machine, OutputColumn};
use program::lane::Stage;
use program::lower::Target;

/// `float f(…) { … }` as an executable, with a batch of one call.
pub(super) fn call(function: &str, arguments: &[f32]) -> (Executable, Batch) {
    let file = SourceFile::new("f.glsl", format!("#version 450 core\n{function}\n"));
    let program = Program::from_source(&file, syntax::Stage::Library, |_| Ok(Target::Function("f".into()))).unwrap();
    let batch = Batch {
        invocation_record: Arc::new(program.invocation_record()),
        case_record: Arc::new(program.case_record()),
        per_case: 1,
        invocations: arguments.iter().map(|x| x.to_bits()).collect(),
        cases: Vec::new(),
    };
    (interp::compile(&program).unwrap(), batch)
}

/// Value and bound of a function, and what `look` sees on the tape.
fn with<T>(
    model: Model<'_>,
    function: &str,
    arguments: &[f32],
    look: impl FnOnce(&mut Tape<'_>, Column, Bounds) -> T,
) -> T {
    let (executable, batch) = call(function, arguments);
    let mut machine = Machine::new(&executable, Tape::new(model), FUEL);
    machine.run(&batch, 0);
    let OutputColumn::Real(&column) = machine.output(0, 0) else { panic!("a real number") };
    let tape = machine.domain();
    let bounds = tape.bounds(column, &mut |_| false);
    look(tape, column, bounds)
}

pub(super) fn device(profile: &str, rearranged: bool) -> Model<'static> {
    Model::Device { profile: by_name(profile).unwrap(), stage: Stage::Compute, rearranged }
}

fn bound(profile: &str, function: &str, arguments: &[f32]) -> f64 {
    with(device(profile, false), function, arguments, |_, _, bounds| bounds.bound[0])
}

/// True when a bound is what was derived, or larger by less than a part in a thousand: second-order
/// terms and binary64 itself.
#[track_caller]
fn assert_is(found: f64, derived: f64) {
    assert!(found >= derived && found <= derived * 1.001, "{found:e}, derived {derived:e}");
}

pub(super) const THIRD: f32 = 1.0 / 3.0;

#[test]
fn one_rounding_is_one_gap_or_half_of_one() {
    let sum = "float f(float x, float y) { return x + y; }";
    assert_is(bound("vulkan-1.4", sum, &[THIRD, 0.7]), ulp_at(1.03));
    assert_is(bound("binary32", sum, &[THIRD, 0.7]), ulp_at(1.03) / 2.0);
}

#[test]
fn what_is_exact_needs_no_room() {
    assert_eq!(bound("vulkan-1.4", "float f(float x) { return x - x; }", &[THIRD]), 0.0);
    assert_eq!(bound("vulkan-1.4", "float f(float x) { return 2.0 * x; }", &[THIRD]), 0.0);
    assert_eq!(bound("vulkan-1.4", "float f(float x) { return abs(-x); }", &[THIRD]), 0.0);
    assert_eq!(bound("vulkan-1.4", "float f(float x) { return max(x, 0.25); }", &[THIRD]), 0.0);
}

#[test]
fn errors_pass_through_derivatives() {
    // (x + y)·z: the sum's error times z, and one rounding of the product.
    let function = "float f(float x, float y, float z) { return (x + y) * z; }";
    let derived = ulp_at(1.03) * 64.1 + ulp_at(1.033 * 64.1);
    assert_is(bound("vulkan-1.4", function, &[THIRD, 0.7, 64.1]), derived);
    // sin is promised to 2^-11, whatever its argument's error adds.
    let sine = bound("vulkan-1.4", "float f(float x) { return sin(x); }", &[0.5]);
    assert_is(sine, 2f64.powi(-11));
}

#[test]
fn an_overflow_does_not_cancel() {
    // 4097·x is infinite, and infinity less infinity is no number, though the derivative by 4097·x is 0.
    let split = "float f(float x) { float t = 4097.0 * x; return t - (t - x); }";
    assert_eq!(bound("binary32", split, &[8.4e34]), f64::INFINITY);
    assert!(bound("binary32", split, &[8.2e34]) < 1e32);
    // What is not chosen may overflow.
    let chosen = "float f(float x) { float t = 4097.0 * x; return x > 0.0 ? x : t; }";
    assert_eq!(bound("binary32", chosen, &[8.4e34]), 0.0);
}

#[test]
fn an_error_in_numerator_and_denominator_cancels() {
    // w/(w + w) is 1/2 whatever w: of the error of pow nothing is left.
    let shared = "float f(float x) { float w = pow(x, -16.0); return w / (w + w); }";
    let alone = "float f(float x) { return pow(x, -16.0); }";
    let relative = bound("vulkan-1.4", alone, &[1.3]) / 1.3_f64.powi(-16);
    let left = bound("vulkan-1.4", shared, &[1.3]) / 0.5;
    assert!(relative > 5e-6 && left < 1e-6, "{relative:e} {left:e}");
}

#[test]
fn another_order_of_a_sum_needs_the_size_of_its_terms() {
    // (x + y) − x: by its order exact to a rounding of x + y, regrouped exactly y.
    let function = "float f(float x, float y) { return (x + y) - x; }";
    let arguments = [1000.0, THIRD];
    let of = |rearranged| with(device("vulkan-1.4", rearranged), function, &arguments, |_, _, b| b.bound[0]);
    assert!(of(false) >= ulp_at(1000.0) && of(false) < 1.01 * ulp_at(1000.0) + ulp_at(0.4));
    assert!(of(true) > of(false) && of(true) < 8.0 * of(false), "{} {}", of(true), of(false));
}

#[test]
fn what_is_flushed_in_a_distributed_product_is_enlarged_by_the_other_factors() {
    // (p·v + q)·w as a matrix times a matrix times a vector has it: v·w is below the normal numbers, p·(v·w) is not.
    let function = "float f(float p, float v, float q, float w) { return (p * v + q) * w; }";
    let of = |p: f32, v: f32| {
        let arguments = [p, v, 0.0, 2f32.powi(-64)];
        with(device("vulkan-1.4", true), function, &arguments, |_, _, b| b.bound[0])
    };
    let value = 2f64.powi(-121);
    assert!(of(64.0, 2f32.powi(-63)) > value, "0 is allowed: {:e}", of(64.0, 2f32.powi(-63)));
    // The same value without a small product on the way.
    assert!(of(1.0, 2f32.powi(-57)) < value, "0 is not allowed: {:e}", of(1.0, 2f32.powi(-57)));
}

#[test]
fn regrouping_reaches_into_what_a_mask_chose() {
    let of = |body: &str, x: f32| {
        let function = format!("float f(float x, float y) {{ float r = 0.5; if (y > 0.0) r = {body}; return r; }}");
        with(device("vulkan-1.4", true), &function, &[x, 1.0, x, -1.0], |_, _, b| b.bound[0])
    };
    // Two calls, of which one goes each way: else there is nothing to choose.
    // x·1e-20 is below the normal numbers: a device may make 0 of it, chosen or not.
    assert_eq!(of("x * 1e-20 * 1e30 + 1.0", 1e-22), f64::INFINITY);
    assert!(of("x * 1e-20 * 1e30 + 1.0", 1e-12) < 1e-5);
    // The factors before the choice and those after it may come in any order: x·1e-15 is too small, x·1e15 too large.
    let split = |inside: &str, after: &str, x: f32| {
        let function =
            format!("float f(float x, float y) {{ float r = 0.5; if (y > 0.0) r = {inside}; return r * {after}; }}");
        with(device("vulkan-1.4", true), &function, &[x, 1.0, x, -1.0], |_, _, b| b.bound[0])
    };
    assert_eq!(split("x * 1e20", "1e-15", 1e-30), f64::INFINITY);
    assert!(split("x * 1e20", "1e-15", 1e-20) < 1e-20);
    assert_eq!(split("x * 1e-20", "1e15", 1e30), f64::INFINITY);
    assert!(split("x * 1e-20", "1e15", 1e10) < 1.0);
}

#[test]
fn a_step_in_a_sum_may_be_one_less_the_comparison_the_other_way_round() {
    let of = |body: &str, x: f32| {
        let function = format!("float f(float x, float y) {{ return {body}; }}");
        with(device("vulkan-1.4", true), &function, &[x, 1.0], |_, _, b| b.bound[0])
    };
    // (y − 1) + 1 instead of y − 0, with the step to 0.
    let apart = f64::from(-0.3_f32) - (f64::from((-0.3_f32 - 1.0) + 1.0));
    assert!(of("-0.3 - step(x, y)", 2.0) >= apart.abs(), "{:e}", of("-0.3 - step(x, y)", 2.0));
    assert!(of("-0.3 - step(x, y)", 2.0) < 1e-6);
    // By itself it is exact.
    assert_eq!(of("step(x, y)", 2.0), 0.0);
    assert_eq!(of("step(x, y)", 0.5), 0.0);
}

#[test]
fn a_comparison_nearer_than_its_errors_is_a_fork() {
    let function = "float f(float x, float y) { if (x * y > 0.1) return 1.0; return 2.0; }";
    let forks = |x, y| with(device("vulkan-1.4", false), function, &[x, y], |tape, _, _| tape.fork(0).is_some());
    assert!(forks(0.1_f32.sqrt(), 0.1_f32.sqrt()), "a product at 0.1 to within its rounding");
    assert!(!forks(0.5, 0.5));
    // Numbers as they were given are what they are.
    let given = "float f(float x, float y) { if (x > y) return 1.0; return 2.0; }";
    assert!(!with(device("vulkan-1.4", false), given, &[0.5, 0.5], |tape, _, _| tape.fork(0).is_some()));
}

#[test]
fn without_a_bound_the_operation_is_named() {
    let why = |function: &str, arguments: &[f32]| {
        with(device("vulkan-1.4", false), function, arguments, |tape, column, bounds| {
            let open = !bounds.bound[0].is_finite() || !tape.values(column)[0].is_finite();
            assert!(open, "{function}: {:e} ± {:e}", tape.values(column)[0], bounds.bound[0]);
            let cause = tape.cause(column, 0).unwrap();
            (cause.why, cause.op, cause.args)
        })
    };
    let sine = why("float f(float x) { return 1.0 + cos(2.0 * x); }", &[3.0]);
    assert_eq!(sine, (Why::NoPromise, Some(Op::Cos), vec![6.0]));
    let (reason, op, _) = why("float f(float x) { return log2(x - 1.5) * 2.0; }", &[1.0]);
    assert_eq!((reason, op), (Why::Domain, Some(Op::Log2)));
    let (reason, op, _) = why("float f(float x, float y) { return 1.0 / (x * y - 0.25); }", &[0.75, THIRD]);
    assert_eq!((reason, op), (Why::Singular, Some(Op::Div)));
    let (reason, op, _) = why("float f(float x) { return x * x - x; }", &[1e20]);
    assert_eq!((reason, op), (Why::Overflow, Some(Op::Mul)));
}

#[test]
fn shares_tell_what_a_bound_is_made_of() {
    let function = "float f(float x) { return sin(x) + 0.7 * x; }";
    let shares = with(device("vulkan-1.4", false), function, &[0.5], |tape, column, _| tape.shares(column, 0, 2));
    assert_eq!(shares[0].op, Some(Op::Sin));
    assert_is(shares[0].share, 2f64.powi(-11));
    assert!(shares[1].share < 1e-6);
}

#[test]
fn a_sweep_that_may_end_early_gives_no_more_than_the_whole() {
    let (executable, batch) = call("float f(float x, float y) { return sin(x * y) * x + y; }", &[0.5, THIRD]);
    let mut machine = Machine::new(&executable, Tape::new(device("vulkan-1.4", false)), FUEL);
    machine.run(&batch, 0);
    let OutputColumn::Real(&column) = machine.output(0, 0) else { panic!("a real number") };
    let tape = machine.domain();
    let whole = tape.bounds(column, &mut |_| false).bound[0];
    let part = tape.bounds(column, &mut |_| true).bound[0];
    assert!(part <= whole && whole > 2f64.powi(-12), "{part} {whole}");
}

#[test]
fn zero_to_a_positive_power_is_zero_and_stays_near_it() {
    let power = "float f(float x, float y) { return pow(max(x, 0.0), y); }";
    for profile in ["vulkan-1.4", "vulkan-cts", "binary32"] {
        for x in [-0.5, 0.0, 1e-40] {
            let found = bound(profile, power, &[x, 62.5]);
            assert!(found < 1e-37, "{profile} {x}: {found:e}");
        }
        // What the exponent leaves open is open still.
        assert_eq!(bound(profile, power, &[0.0, 0.0]), f64::INFINITY, "{profile}");
        assert_eq!(bound(profile, power, &[0.0, -1.0]), f64::INFINITY, "{profile}");
        // Nothing says that this is not below 0.
        let power = "float f(float x, float y) { return pow(x * y - x * y, 2.0); }";
        assert_eq!(bound(profile, power, &[0.3, 0.7]), f64::INFINITY, "{profile}");
    }
    // An argument that is 0 to within 1e-7 gives at most the power of that.
    let near = "float f(float x, float y) { return pow(max(x * y - 0.09, 0.0), 2.0); }";
    let found = bound("vulkan-1.4", near, &[0.3, 0.3]);
    assert!(found > 1e-17 && found < 1e-14, "{found:e}");
}

#[test]
fn the_sign_of_a_zero_decides_between_half_turns_where_it_is_kept() {
    let angle = "float f(float x, float y) { return atan(x, y); }";
    for zero in [0.0, -0.0] {
        // A card gives π for −0.0 and −1.0.
        assert!(bound("vulkan-1.4", angle, &[zero, -1.0]) >= std::f64::consts::TAU);
        assert!(bound("binary32", angle, &[zero, -1.0]) < 1e-6);
        assert!(bound("vulkan-1.4", angle, &[zero, 1.0]) < 1e-3);
    }
}

#[test]
fn outputs_fade_with_exponentials_and_not_with_small_factors() {
    let faded = |function: &str, x: f32| {
        with(device("vulkan-1.4", false), function, &[x], |tape, column, _| tape.has_faded(column, 0))
    };
    for (body, wanted) in [
        ("exp(-x)", true),
        ("0.5 * exp(-x) / (1.0 + x)", true),
        ("pow(1.0 / x, 40.0)", true),
        ("exp(-x) + exp2(-x) * 0.25", true),
        ("max(exp(-x), 0.0)", true),
        ("exp(-x) + 1e-30", false),
        ("x * 1e-38", false),
        ("exp(-x) * 1e-30", false),
        ("exp(-0.01 * x)", false),
    ] {
        assert_eq!(faded(&format!("float f(float x) {{ return {body}; }}"), 60.0), wanted, "{body}");
    }
}
