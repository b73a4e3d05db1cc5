use super::super::tests::{Function, Soft, request, rounded};
use super::*;
use crate::calibrate::{Request, State, run};

/// Most results that the searches of these tests compute.
const BUDGET: u64 = 1 << 25;

fn measured(op: Op, search: u64, function: Function) -> Tally {
    let mut state = State::new(Request { search, ..request(&[op], 20_000) });
    run(&Soft::new(function), &mut state, &mut |_, _| Ok(())).unwrap();
    assert_eq!(state.done(), state.request().total());
    state.measurements()[0].1.clone()
}

/// How far a result is moved, in ULP: a hill of some breadth, with this word as the only top.
fn hill(x: f32, middle: u32, height: u32, breadth: u32) -> u32 {
    let away = x.to_bits().abs_diff(middle);
    height.saturating_sub(away / (breadth / height)) + if away == 0 { 2 } else { 0 }
}

fn raised(x: f32, ulp: u32) -> f32 {
    f32::from_bits(rounded(Op::Exp2, x).to_bits() + ulp)
}

/// The middle of the hill, between 2^-3 and 2^-2.
const MIDDLE: u32 = 0x3e2a_b1c5;

#[test]
fn the_top_of_a_hill_is_found_that_samples_miss() {
    let function: Function = |a| raised(a[0], hill(a[0], MIDDLE, 100, 40_000));
    let (samples, searched) = (measured(Op::Exp2, 0, function), measured(Op::Exp2, BUDGET, function));
    assert!(samples.worst_ulp().value() < 99.0, "{:?}", samples.worst_ulp());
    for worst in [searched.worst_ulp(), searched.promised_ulp, searched.ratio] {
        assert_eq!(worst.at[0], MIDDLE, "{worst:?}");
    }
    assert!((101.5..=102.5).contains(&searched.worst_ulp().value()), "{:?}", searched.worst_ulp());
    assert!(searched.samples <= samples.samples + BUDGET);
}

#[test]
fn one_argument_of_a_binade_that_errs_elsewhere_is_found() {
    // Too far from the hill to be followed there: the binade is computed whole.
    const ALONE: u32 = MIDDLE + 0x10_0000;
    let function: Function = |a| match a[0].to_bits() {
        ALONE => raised(a[0], 150),
        _ => raised(a[0], hill(a[0], MIDDLE, 100, 40_000)),
    };
    assert_eq!(measured(Op::Exp2, BUDGET, function).worst_ulp().at[0], ALONE);
}

#[test]
fn one_argument_is_found_by_its_significand_and_by_its_reduced_argument() {
    // In a binade without any other error, with the significand of the worst argument.
    const BINADE: u32 = MIDDLE + (5 << 23);
    let function: Function = |a| match a[0].to_bits() {
        BINADE => raised(a[0], 1000),
        _ => raised(a[0], hill(a[0], MIDDLE, 100, 40_000)),
    };
    assert_eq!(measured(Op::Exp2, BUDGET, function).worst_ulp().at[0], BINADE);
    let function: Function = |a| {
        let moved = f32::from_bits(MIDDLE) + 40.0;
        if a[0] == moved { raised(a[0], 1000) } else { raised(a[0], hill(a[0], MIDDLE, 100, 40_000)) }
    };
    let found = measured(Op::Exp2, BUDGET, function).worst_ulp().at[0];
    assert_eq!(f32::from_bits(found), f32::from_bits(MIDDLE) + 40.0);
}

#[test]
fn a_function_that_rounds_is_looked_at_once() {
    let tally = measured(Op::Sqrt, BUDGET, |a| a[0].sqrt());
    let samples = measured(Op::Sqrt, 0, |a| a[0].sqrt()).samples;
    assert!(tally.samples > samples + BUDGET / LOOK / 2 && tally.samples < samples + BUDGET / LOOK * 2);
    assert!(tally.worst_ulp().value() <= 0.5);
}

#[test]
fn a_search_keeps_to_its_budget_and_leaves_functions_of_two_arguments_alone() {
    let function: Function = |a| raised(a[0], 7);
    let samples = measured(Op::Exp2, 0, function).samples;
    for search in [1, 16, 1000, 100_000] {
        let computed = measured(Op::Exp2, search, function).samples - samples;
        assert!(computed <= search && computed + u64::from(GROUP) > search.min(16_000), "{computed} of {search}");
    }
    let sum: Function = |a| a[0] + a[1];
    assert_eq!(measured(Op::Add, BUDGET, sum), measured(Op::Add, 0, sum));
}

#[test]
fn a_search_that_was_stopped_ends_alike() {
    let function: Function = |a| raised(a[0], hill(a[0], MIDDLE, 100, 40_000));
    let asked = || Request { search: 1 << 23, ..request(&[Op::Exp2, Op::Floor], 5000) };
    let mut whole = State::new(asked());
    run(&Soft::new(function), &mut whole, &mut |_, _| Ok(())).unwrap();
    let mut saved = Vec::new();
    let stop = &mut |state: &State, _| {
        saved = serde_json::to_vec(state).map_err(std::io::Error::other)?;
        let searching = state.done() > state.request().size(Op::Exp2) + 2_500_000;
        if searching { Err(std::io::Error::other("stopped")) } else { Ok(()) }
    };
    run(&Soft::new(function), &mut State::new(asked()), stop).unwrap_err();
    let mut state: State = serde_json::from_slice(&saved).unwrap();
    assert!(state.done() < state.request().total());
    state = state.resume(&asked()).unwrap();
    run(&Soft::new(function), &mut state, &mut |_, _| Ok(())).unwrap();
    assert_eq!(state, whole);
    let other = Request { search: 1, ..asked() };
    let error = state.resume(&other).unwrap_err().to_string();
    assert!(error.contains("search was 8388608 and is 1"), "{error}");
}
