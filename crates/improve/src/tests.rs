//! Every rule by itself in numbers of many bits, a wrong rule that only the proof can see, and known formulas.

use crate::graph::{Points, values};
use crate::real::{is_finite, same};
use crate::rules::{Condition, Rule, all};
use crate::search::{Settings, search};
use crate::single::{Losses, folded, run};
use crate::term::{Node, Term, parse};
use crate::{Component, Dialect, LeafText, Proof, Split, measure, prove, written};

/// Points of which each has some numbers of many sizes, the same everywhere.
fn numbers(width: usize, count: usize, range: [f32; 2]) -> Points {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1u32 << 24) as f32
    };
    let mut number = || {
        // Half evenly, half of any size in the range.
        let x = range[0] + (range[1] - range[0]) * next();
        if next() < 0.5 { x } else { x * 2f32.powf(-16.0 * next()) }
    };
    Points::new(&(0..count).map(|_| (0..width).map(|_| number()).collect()).collect::<Vec<Vec<f32>>>())
}

/// A side of a rule with its variables as leaves, in the order of `names`.
fn side(text: &str, names: &[String]) -> Term {
    let mut text = format!(" {text} ").replace('(', " ( ").replace(')', " ) ");
    for (k, name) in names.iter().enumerate() {
        text = text.replace(&format!(" {name} "), &format!(" x{k} "));
        text = text.replace(&format!(" {name} "), &format!(" x{k} "));
    }
    parse(text.trim()).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn variables(rule: &Rule) -> Vec<String> {
    let words = rule.from.split(|c: char| c.is_whitespace() || "()".contains(c));
    let mut names: Vec<String> = words.filter(|word| word.starts_with('?')).map(str::to_owned).collect();
    names.sort();
    names.dedup();
    names
}

/// Points at which a rule has to hold, with the values of both sides; those that its guards leave out are not among them.
fn held(rule: &Rule) -> (usize, Vec<String>) {
    let names = variables(rule);
    let conditions = rule.conditions().unwrap();
    let (mut both, mut wrong) = (0, Vec::new());
    // Constants are 2, and what is inside of an interval is drawn there.
    for range in [[-4.0, 4.0], [0.0, 4.0], [-1.0, 1.0], [1.0, 8.0], [-4.0, 0.0]] {
        let drawn = numbers(names.len().max(1), 100, range);
        let keeps = |k: &usize| {
            conditions.iter().all(|(var, condition)| {
                let leaf = names.iter().position(|name| *name == var.to_string()).unwrap();
                condition.holds(f64::from(drawn.leaf(leaf as u32)[*k]))
            })
        };
        let kept: Vec<usize> = (0..drawn.len()).filter(keeps).collect();
        let points = drawn.chosen(&kept);
        let of = |text: &str| values(&side(text, &names), &points).unwrap().last().unwrap().reals.clone();
        let (from, to) = (of(rule.from), of(rule.to));
        for (k, (a, b)) in from.iter().zip(to.iter()).enumerate() {
            if is_finite(a) && is_finite(b) {
                both += 1;
                if !same(a, b) {
                    wrong.push(format!("{} at {:?}: {a} and {b}", rule.name, points.point(k)));
                }
            }
        }
    }
    (both, wrong)
}

#[test]
fn every_rule_holds_in_real_numbers() {
    for rule in all() {
        let (both, wrong) = held(&rule);
        assert!(wrong.is_empty(), "{:?}", &wrong[..wrong.len().min(2)]);
        // Rules about constants and about 0 have few points; none has no point.
        assert!(both >= 20, "{}: both sides have a value at {both} points", rule.name);
    }
}

#[test]
fn names_of_rules_are_names() {
    let mut names: Vec<&str> = all().iter().map(|rule| rule.name).collect();
    names.sort_unstable();
    let count = names.len();
    names.dedup();
    assert_eq!((names.len(), count > 150), (count, true));
}

#[test]
fn a_wrong_rule_is_seen() {
    let wrong = [
        Rule { name: "sine-of-sum-apart", from: "(sin (+ ?a ?b))", to: "(+ (sin ?a) (sin ?b))", guards: "" },
        Rule { name: "root-of-any-square", from: "(sqrt (* ?a ?a))", to: "?a", guards: "" },
        Rule { name: "half-of-half", from: "(- 1 (cos ?x))", to: "(* 2 (sin (* 0.5 ?x)))", guards: "" },
    ];
    for rule in wrong {
        assert!(!held(&rule).1.is_empty(), "{}", rule.name);
    }
    assert!(
        !Condition::Positive.holds(0.0) && Condition::NonNegative.holds(0.0) && !Condition::NonZero.holds(f64::NAN)
    );
}

fn searched(term: &str, range: [f32; 2], extra: &[Rule]) -> (Term, crate::Improved) {
    let term = parse(term).unwrap();
    let settings = Settings { rules: [&all()[..], extra].concat(), ..Settings::default() };
    let found = search(&term, &numbers(2, 256, range), &settings).unwrap();
    (term, found)
}

fn proof_of(term: &Term, found: &crate::Improved, split: &Split, range: [f32; 2]) -> Proof {
    prove(term, split, &found.terms, &numbers(2, 1 << 14, range)).unwrap()
}

#[test]
fn the_proof_catches_a_wrong_rule_that_the_points_of_the_graph_do_not() {
    // Wrong for x < 0 alone, where no point of the search lies.
    let planted = Rule { name: "planted", from: "(- 1 (cos ?x))", to: "(* (abs ?x) (* ?x (sin 0.25)))", guards: "" };
    let (_, found) = searched("(- 1 (cos x0))", [0.25, 0.5], &[planted]);
    assert!(found.conflicts > 0, "the values differ at every point, so that the rule changes nothing");
    // What would have been made of it all the same.
    let term = parse("(- 1 (cos x0))").unwrap();
    let same_above_zero = parse("(* 2 (* (sin (* 0.5 (abs x0))) (sin (* 0.5 x0))))").unwrap();
    let terms = [same_above_zero];
    let at = |range| prove(&term, &Split::Term(0), &terms, &numbers(1, 1 << 14, range)).unwrap();
    assert!(at([0.0, 0.5]).holds());
    let caught = at([-0.5, 0.5]);
    assert!(!caught.holds() && caught.unequal.as_ref().is_some_and(|(point, _)| point[0] < 0.0), "{caught:?}");
    // A pole of the proposal alone.
    let terms = [parse("(/ (* (sin x0) (sin x0)) (+ 1 (cos x0)))").unwrap(), parse("(log x0)").unwrap()];
    assert!(prove(&term, &Split::Term(1), &terms, &numbers(1, 64, [-0.5, 0.5])).unwrap().lost > 0);
    assert!(prove(&term, &Split::Term(0), &terms, &numbers(1, 64, [-0.5, 0.5])).unwrap().holds());
}

/// Bits that the best proposal loses in the mean, and that the original loses; the proposal is proved.
fn improved(term: &str, range: [f32; 2]) -> (f64, f64, String) {
    let (term, found) = searched(term, range, &[]);
    let best = found.candidates.first().unwrap_or_else(|| panic!("nothing for {term}"));
    let proof = proof_of(&term, &found, &best.split, range);
    assert!(proof.holds(), "{term}: {proof:?}");
    let leaves = ["x".to_owned().into(), "y".to_owned().into()];
    (best.losses.mean(), found.original.mean(), written(&best.split, &found.terms, &leaves, Dialect::Glsl))
}

#[test]
fn known_formulas_are_found() {
    for (term, range) in [
        ("(- 1 (cos x0))", [-1.0, 1.0]),
        ("(- (sqrt (+ x0 1)) (sqrt x0))", [1.0, 1e6]),
        ("(log (tan (+ (* 0.25 pi) (/ (* x0 pi) 360))))", [-85.0, 85.0]),
        ("(- (* 2 (atan (exp x0))) (/ pi 2))", [-3.0, 3.0]),
        ("(- (exp x0) 1)", [-0.5, 0.5]),
        ("(- (/ 1 (+ x0 1)) (/ 1 x0))", [1.0, 1e5]),
        ("(log (+ x0 (sqrt (+ (* x0 x0) 1))))", [-4.0, 4.0]),
        ("(- (* x0 x0) (* x1 x1))", [1.0, 1.001]),
    ] {
        let (after, before, text) = improved(term, range);
        assert!(after < 0.75 && after < 0.5 * before, "{term}: {before} bits, then {after}: {text}");
    }
}

#[test]
fn what_loses_nothing_is_left_alone() {
    for term in ["(+ (* 0.25 x0) (* 0.5 x1))", "(sqrt x0)", "(* x0 x1)"] {
        let (_, found) = searched(term, [0.5, 4.0], &[]);
        assert!(found.candidates.is_empty(), "{term}: {:?}", found.candidates.first());
    }
    let none = search(&parse("(sqrt (- -1 (* x0 x0)))").unwrap(), &numbers(1, 32, [0.0, 1.0]), &Settings::default());
    assert!(none.unwrap_err().contains("no value at any point"));
}

#[test]
fn a_length_does_not_overflow() {
    let term = parse("(sqrt (+ (* x0 x0) (* x1 x1)))").unwrap();
    let points = Points::new(&[vec![3e30, 4e30], vec![0.0, 0.0], vec![3.0, 4.0], vec![-3e-30, 4e-30], vec![1.0, 0.0]]);
    let found = search(&term, &points, &Settings::default()).unwrap();
    let best = &found.candidates[0];
    assert!(best.losses.worst() < 2.0 && found.original.worst() > 20.0, "{best:?}");
    assert!(prove(&term, &best.split, &found.terms, &points).unwrap().holds());
}

#[test]
fn terms_are_written_as_they_are_computed() {
    let leaves = ["a + b".to_owned().into(), "v.x".to_owned().into()];
    let of = |text: &str, dialect| written(&Split::Term(0), &[parse(text).unwrap()], &leaves, dialect);
    let glsl = |text| of(text, Dialect::Glsl);
    assert_eq!(glsl("(* 2 (- x0 (- x1 1)))"), "2.0 * ((a + b) - (v.x - 1.0))");
    assert_eq!(glsl("(neg (/ x1 (* x1 x0)))"), "-(v.x / (v.x * (a + b)))");
    assert_eq!(glsl("(safe-acos (/ x1 3))"), "acos(clamp(v.x / 3.0, -1.0, 1.0))");
    assert_eq!(glsl("(* x1 (/ pi 180))"), "v.x * 0.01745329252");
    assert_eq!(glsl("(atan2 x1 (sqrt x0))"), "atan(v.x, sqrt(a + b))");
    assert_eq!(of("(atan2 x1 (inversesqrt x1))", Dialect::Wgsl), "atan2(v.x, inverseSqrt(v.x))");
    let at = |absolute| Split::At {
        leaf: 1,
        absolute,
        threshold: 0.5,
        below: Split::Term(0).into(),
        above: Split::Term(1).into(),
    };
    let terms = [parse("x1").unwrap(), parse("(sin x1)").unwrap()];
    assert_eq!(written(&at(true), &terms, &leaves, Dialect::Glsl), "abs(v.x) < 0.5 ? v.x : sin(v.x)");
    assert_eq!(written(&at(false), &terms, &leaves, Dialect::Wgsl), "select(sin(v.x), v.x, v.x < 0.5)");
}

#[test]
fn losses_count_numbers_between() {
    let next = f32::from_bits(1.0_f32.to_bits() + 1);
    let lost = Losses::of(&[1.0, next, f32::NAN, -0.0], &[1.0, 1.0, 1.0, 0.0]);
    assert_eq!(lost.0, [0.0, 1.0, crate::WORST, 0.0]);
    let term = folded(&parse("(* x0 (* 2 pi))").unwrap());
    assert_eq!((term.len(), run(&term, &Points::new(&[vec![1.0]]))), (3, vec![std::f32::consts::TAU]));
    assert!(parse("(hypot x0 x1)").is_err() && matches!(parse("pi").unwrap()[0.into()], Node::Pi));
}

#[test]
fn components_are_written_as_their_vector() {
    let component = |vector: &str, index: usize| LeafText {
        text: format!("{vector}.{}", ["x", "y", "z"][index]),
        of: Some(Component { vector: vector.to_owned(), index, count: 3 }),
    };
    let leaves: Vec<LeafText> = ["a", "b - c"].into_iter().flat_map(|v| (0..3).map(move |k| component(v, k))).collect();
    let of = |text: &str| written(&Split::Term(0), &[parse(text).unwrap()], &leaves, Dialect::Glsl);
    assert_eq!(of("(+ (+ (* x0 x3) (* x1 x4)) (* x2 x5))"), "dot(a, b - c)");
    assert_eq!(of("(sqrt (+ (+ (* x0 x0) (* x1 x1)) (* x2 x2)))"), "length(a)");
    let scaled = "(sqrt (+ (+ (* (/ x0 2) (/ x0 2)) (* (/ x1 2) (/ x1 2))) (* (/ x2 2) (/ x2 2))))";
    assert_eq!(of(scaled), "length(a / 2.0)");
    let cross = ["(- (* x1 x5) (* x2 x4))", "(- (* x2 x3) (* x0 x5))", "(- (* x0 x4) (* x1 x3))"];
    let [x, y, z] = cross;
    assert_eq!(of(&format!("(sqrt (+ (+ (* {x} {x}) (* {y} {y})) (* {z} {z})))")), "length(cross(a, b - c))");
    // Not all components, another order, another sign: as they stand.
    let leaves = ["a.x", "a.y"].map(|text| LeafText { text: text.to_owned(), of: None });
    let plain = |text: &str| written(&Split::Term(0), &[parse(text).unwrap()], &leaves, Dialect::Glsl);
    assert_eq!(plain("(+ (* x0 x0) (* x1 x1))"), "a.x * a.x + a.y * a.y");
    assert!(!of("(+ (* x0 x3) (* x1 x4))").contains("dot") && !of("(+ (* x1 x0) (* x0 x1))").contains("dot"));
}

#[test]
fn alternatives_are_measured_against_what_is_meant() {
    // An angle between unit vectors of the plane, whose components binary32 rounds.
    let points: Vec<Vec<f32>> = (1..200)
        .map(|k| {
            let (a, b) = (0.3 + 0.001 * f64::from(k), 0.3 + 0.001 * f64::from(k) + 1e-4);
            [a.cos(), a.sin(), b.cos(), b.sin()].map(|x| x as f32).to_vec()
        })
        .collect();
    let points = Points::new(&points);
    let own = parse("(acos (+ (* x0 x2) (* x1 x3)))").unwrap();
    let unit = |x: &str, y: &str, k: &str| format!("(/ {k} (sqrt (+ (* {x} {x}) (* {y} {y}))))");
    let (a, b) = (["x0", "x1"].map(|k| unit("x0", "x1", k)), ["x2", "x3"].map(|k| unit("x2", "x3", k)));
    let meant = parse(&format!("(acos (+ (* {} {}) (* {} {})))", a[0], b[0], a[1], b[1])).unwrap();
    let angle = parse("(atan2 (abs (- (* x0 x3) (* x1 x2))) (+ (* x0 x2) (* x1 x3)))").unwrap();
    let wrong = parse("(atan2 (- (* x0 x3) (* x1 x2)) (- (* x0 x2) (* x1 x3)))").unwrap();
    let found = measure(&own, &meant, &[angle, wrong], &points).unwrap();
    assert_eq!((found.candidates.len(), found.unequal), (1, 1));
    let (before, after) = (found.original.mean(), found.candidates[0].losses.mean());
    assert!(before > 8.0 && after < before - 6.0, "{before} {after}");
    assert!(prove(&meant, &found.candidates[0].split, &found.terms, &points).unwrap().holds());
}
