use std::convert::Infallible;
use std::sync::Arc;

use super::*;
use crate::generators::{Options, by_name};
use crate::{InputGroup, Plan};
use base::value::{Field, Record, Scalar, Shape};

fn record(fields: &[(&str, Shape)]) -> Arc<Record> {
    let field = |&(name, shape): &(&str, Shape)| Field { name: name.into(), shape };
    Arc::new(Record::new(fields.iter().map(field).collect()))
}

fn group(names: &[&str], generator: &str, range: Option<[f64; 2]>) -> InputGroup {
    InputGroup {
        names: names.iter().map(|&n| n.to_owned()).collect(),
        generator: crate::Own::Static(by_name(generator).unwrap()),
        options: Options { range, ..Options::default() },
        at: String::new(),
    }
}

fn blending() -> Plan {
    let points = Shape::VEC4.array_of(8);
    let groups = [
        group(&["n"], "index", Some([1.0, 8.0])),
        group(&["p0", "p1"], "point", None),
        group(&["blend"], "rigid", None),
        group(&["t"], "interval", Some([0.0, 1.0])),
        group(&["weights"], "simplex", None),
        group(&["axis"], "direction", None),
        group(&["position"], "point", None),
    ];
    let case = record(&[
        ("n", Shape::INT),
        ("p0", points),
        ("p1", points),
        ("blend", Shape::MAT4.array_of(8)),
        ("t", Shape::FLOAT),
        ("weights", Shape::VEC3),
        ("axis", Shape::VEC3),
    ]);
    Plan::new(&groups, record(&[("position", Shape::VEC4)]), case).unwrap()
}

/// Shrinks the first failing samples of a plan; gives them with the number of calls of the oracle.
fn shrink_all(plan: &Plan, most: usize, fails: &dyn Fn(&Sample) -> bool) -> (Vec<Shrunk>, usize) {
    let found = (0..4000).map(|case| plan.sample(5, case, 0)).filter(|s| fails(s));
    let found: Vec<Sample> = found.take(most).collect();
    assert_eq!(found.len(), most);
    let mut calls = 0;
    let shrunk = shrink::<Infallible>(found, plan, &mut |samples| {
        calls += 1;
        Ok(samples.iter().map(fails).collect())
    });
    let shrunk = shrunk.unwrap();
    assert!(!shrunk.is_empty(), "nothing was shrunk");
    for s in &shrunk {
        assert!(fails(&s.sample) && plan.admits(&s.sample) && s.minimal, "{:?}", s.sample);
    }
    (shrunk, calls)
}

#[test]
fn a_threshold_shrinks_to_a_plain_number_and_all_else_to_its_simplest() {
    let plan = blending();
    let (shrunk, calls) = shrink_all(&plan, 8, &|s| s.get("t")[0] > 0.5);
    for s in &shrunk {
        let mut expected = plan.simplest(&s.original);
        expected.set("t", &[1.0]);
        assert_eq!(s.sample, expected);
    }
    assert!(calls <= 6, "{calls}");
}

#[test]
fn a_number_inside_a_narrow_window_gets_few_digits() {
    let plan = blending();
    let (shrunk, _) = shrink_all(&plan, 4, &|s| (0.6..0.7).contains(&s.get("t")[0]));
    for s in &shrunk {
        // 5/8 = 0.101b is the only number with so few bits in the window.
        assert_eq!(s.sample.get("t"), [0.625]);
    }
}

#[test]
fn a_fault_of_two_inputs_keeps_both_and_nothing_else() {
    let plan = blending();
    let (shrunk, calls) = shrink_all(&plan, 8, &|s| s.get("n")[0] >= 2.0 && s.get("position")[0] != 0.0);
    for s in &shrunk {
        let mut expected = plan.simplest(&s.original);
        expected.set("n", &[2.0]);
        expected.set("position", &[1.0, 0.0, 0.0, 1.0]);
        assert_eq!(s.sample, expected);
    }
    let tried: usize = shrunk.iter().map(|s| s.tried).sum();
    assert!(calls * 100 < tried, "{calls} calls for {tried} candidates");
    assert!(shrunk.iter().all(|s| s.rounds <= calls && s.accepted > 0));
}

#[test]
fn one_entry_of_an_array_of_matrices_is_isolated() {
    let plan = blending();
    let fails = |s: &Sample| s.get("blend")[16 * 5 + 12] > 0.25;
    let (shrunk, calls) = shrink_all(&plan, 4, &fails);
    for s in &shrunk {
        let mut blend = plan.simplest(&s.original).get("blend");
        blend[16 * 5 + 12] = 1.0;
        assert_eq!(s.sample.get("blend"), blend);
        assert_eq!(s.sample.get("position"), [0.0, 0.0, 0.0, 1.0]);
    }
    assert!(calls <= 12, "{calls}");
}

#[test]
fn laws_between_words_are_kept() {
    let plan = blending();
    let (shrunk, _) = shrink_all(&plan, 4, &|s| s.get("weights")[1] > 0.3 && s.get("axis")[2] < -0.5);
    for s in &shrunk {
        assert_eq!(s.sample.get("weights"), [0.0, 1.0, 0.0]);
        assert_eq!(s.sample.get("axis"), [0.0, 0.0, -1.0]);
    }
}

#[test]
fn dependent_words_shrink_together_or_not_at_all() {
    // Only samples with x > y fail: both may not become zero.
    let plan = blending();
    let (shrunk, _) = shrink_all(&plan, 4, &|s| s.get("position")[0] > s.get("position")[1]);
    for s in &shrunk {
        let p = s.sample.get("position");
        assert!(p == [1.0, 0.0, 0.0, 1.0] || p == [0.0, -1.0, 0.0, 1.0], "{p:?}");
    }
}

#[test]
fn shrinking_is_deterministic_and_samples_do_not_influence_each_other() {
    let plan = blending();
    let fails = |s: &Sample| s.get("position")[1] > s.get("t")[0] && s.get("n")[0] > 3.0;
    let (together, _) = shrink_all(&plan, 6, &fails);
    let (again, _) = shrink_all(&plan, 6, &fails);
    assert_eq!(together, again);
    let (alone, _) = shrink_all(&plan, 1, &fails);
    assert_eq!(alone[0], together[0]);
}

#[test]
fn a_sample_that_cannot_be_simpler_comes_back_as_it_is() {
    let plan = blending();
    let sample = plan.simplest(&plan.sample(1, 0, 0));
    let mut calls = 0;
    let shrunk = shrink::<Infallible>(vec![sample.clone()], &plan, &mut |s| {
        calls += 1;
        Ok(vec![true; s.len()])
    });
    let shrunk = shrunk.unwrap();
    assert_eq!(shrunk[0].sample, sample);
    assert!(shrunk[0].minimal && shrunk[0].accepted == 0);
    assert!(calls <= 1, "{calls}");
    assert!(shrink::<Infallible>(vec![], &plan, &mut |_| panic!("nothing to ask")).unwrap().is_empty());
}

#[test]
fn an_oracle_that_says_yes_to_all_ends_at_the_simplest_sample() {
    let plan = blending();
    let (shrunk, calls) = shrink_all(&plan, 3, &|_| true);
    for s in &shrunk {
        assert!(!simpler_than(&plan.simplest(&s.original), &s.sample, &plan.simplest(&s.sample)));
    }
    assert!(calls <= 20, "{calls}");
}

#[test]
fn errors_of_the_oracle_come_through_and_short_answers_count_as_passing() {
    let plan = blending();
    let sample = plan.sample(1, 0, 0);
    let error = shrink(vec![sample.clone()], &plan, &mut |_| Err("device lost")).unwrap_err();
    assert_eq!(error, "device lost");
    let shrunk = shrink::<Infallible>(vec![sample.clone()], &plan, &mut |_| Ok(vec![])).unwrap();
    assert_eq!(shrunk[0].sample, sample);
}

#[test]
fn nan_and_infinity_shrink_to_numbers_where_they_may() {
    let (invocation, case) = (record(&[("x", Shape::FLOAT), ("u", Shape::vector(Scalar::U32, 1))]), record(&[]));
    let word = |x: f32| Sample {
        invocation_record: invocation.clone(),
        case_record: case.clone(),
        invocation: vec![x.to_bits(), 77],
        case: vec![],
    };
    let everything = |_: &Sample| true;
    let failing = vec![word(f32::NAN), word(f32::INFINITY), word(-123.456)];
    let fails = |s: &Sample| s.invocation[0] != 0 && s.invocation[1] > 10;
    let shrunk = shrink::<Infallible>(failing, &everything, &mut |s| Ok(s.iter().map(fails).collect())).unwrap();
    for s in shrunk {
        assert_eq!((s.sample.invocation[0], s.sample.invocation[1]), (1f32.to_bits(), 11));
    }
}
