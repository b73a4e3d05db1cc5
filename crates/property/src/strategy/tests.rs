use proptest::test_runner::{Config, TestCaseError, TestError};

use super::super::generators::{Options, by_name};
use super::super::plan::InputGroup;
use super::*;
use base::value::{Field, Record, Shape};

fn strategy() -> CaseStrategy {
    let record = |fields: &[(&str, Shape)]| {
        let field = |&(name, shape): &(&str, Shape)| Field { name: name.into(), shape };
        Arc::new(Record::new(fields.iter().map(field).collect()))
    };
    let group = |names: &[&str], generator: &str, range| InputGroup {
        names: names.iter().map(|&n| n.to_owned()).collect(),
        generator: crate::Own::Static(by_name(generator).unwrap()),
        options: Options { range, ..Options::default() },
        at: String::new(),
    };
    let groups = [
        group(&["p0", "p1"], "nodes", None),
        group(&["t"], "interval", Some([0.0, 1.0])),
        group(&["mc"], "projection", None),
    ];
    let invocation = record(&[("p0", Shape::VEC4), ("p1", Shape::VEC4)]);
    let plan = Plan::new(&groups, invocation, record(&[("t", Shape::FLOAT), ("mc", Shape::MAT4)]));
    CaseStrategy::new(Arc::new(plan.unwrap()))
}

fn runner() -> TestRunner {
    let config = Config { failure_persistence: None, max_shrink_iters: 100_000, ..Config::default() };
    let rng = proptest::test_runner::TestRng::deterministic_rng(config.rng_algorithm);
    TestRunner::new_with_rng(config, rng)
}

#[test]
fn a_planted_fault_is_found_and_shrunk_to_its_minimum() {
    let fails = |s: &Sample| s.get("t")[0] > 0.5 && s.get("p1")[1] < 0.0;
    let result =
        runner().run(&strategy(), |sample| if fails(&sample) { Err(TestCaseError::fail("planted")) } else { Ok(()) });
    let Err(TestError::Fail(_, minimal)) = result else { panic!("{result:?}") };
    let mut expected = strategy().plan.simplest(&minimal);
    expected.set("t", &[1.0]);
    expected.set("p1", &[0.0, -1.0, 0.0, 1.0]);
    assert_eq!(minimal, expected);
}

#[test]
fn a_property_that_holds_passes() {
    let strategy = strategy();
    let plan = strategy.plan.clone();
    runner()
        .run(&strategy, |sample| {
            proptest::prop_assert!(plan.admits(&sample));
            Ok(())
        })
        .unwrap();
}

#[test]
fn runs_are_reproducible_and_samples_differ() {
    let draw = || {
        let mut runner = runner();
        (0..8).map(|_| strategy().new_tree(&mut runner).unwrap().current()).collect::<Vec<_>>()
    };
    let samples = draw();
    assert_eq!(samples, draw());
    assert!((1..8).all(|i| samples[i] != samples[0]));
}

#[test]
fn a_candidate_that_passes_leaves_the_best_in_place() {
    let mut tree = strategy().new_tree(&mut runner()).unwrap();
    let first = tree.current();
    assert!(tree.simplify());
    assert_ne!(tree.current(), first);
    while tree.complicate() {}
    assert_eq!(tree.current(), first, "nothing simpler failed");
    assert!(!tree.complicate() && !tree.simplify());
}
