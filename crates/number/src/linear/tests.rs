//! Systems against all points of a box, and the lemmas about products one by one.

use std::collections::BTreeMap;

use super::{Constraint, Polynomial, Solution, System, Unknown};

const STEPS: u64 = 200_000;

fn x(unknown: Unknown) -> Polynomial {
    Polynomial::unknown(unknown)
}

fn number(value: i128) -> Polynomial {
    Polynomial::constant(value)
}

fn between(low: i128, of: &Polynomial, high: i128) -> [Constraint; 2] {
    [Constraint::at_most(&number(low), of), Constraint::at_most(of, &number(high))]
}

/// Numbers that look random and are the same each time.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, count: u64) -> i128 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        i128::from((self.0 >> 33) % count)
    }
}

fn any_point(system: &System, unknowns: u32, low: i128, high: i128) -> bool {
    let side = (high - low + 1) as u64;
    (0..side.pow(unknowns)).any(|k| {
        let point: BTreeMap<Unknown, i128> =
            (0..unknowns).map(|u| (u, low + i128::from(k / side.pow(u) % side))).collect();
        let part = |part: &Vec<Constraint>| part.iter().all(|own| own.holds(&point));
        system.all.iter().all(|own| own.holds(&point)) && system.one_of.iter().all(|parts| parts.iter().any(part))
    })
}

/// A random system in a box; `products` has products of two unknowns in it, `choices` alternatives.
fn random(numbers: &mut Numbers, unknowns: u32, products: bool, choices: bool) -> System {
    let polynomial = |numbers: &mut Numbers| {
        let mut all = number(numbers.below(15) - 7);
        for unknown in 0..unknowns {
            all = all.plus_times(&x(unknown), numbers.below(9) - 4);
        }
        if products && numbers.below(2) == 0 {
            let pair = x(numbers.below(u64::from(unknowns)) as u32)
                .product(&x(numbers.below(u64::from(unknowns)) as u32))
                .unwrap();
            all = all.plus_times(&pair, numbers.below(5) - 2);
        }
        all
    };
    let mut system = System::default();
    let low = if products { 0 } else { -4 };
    (0..unknowns).for_each(|unknown| system.all.extend(between(low, &x(unknown), 4)));
    for _ in 0..2 + numbers.below(4) {
        let of = polynomial(numbers);
        system.all.push(Constraint { of, zero: numbers.below(3) == 0 });
    }
    if choices {
        for _ in 0..numbers.below(3) {
            let part =
                |numbers: &mut Numbers| vec![Constraint { of: polynomial(numbers), zero: numbers.below(3) == 0 }];
            system.one_of.push(vec![part(numbers), part(numbers)]);
        }
    }
    system
}

#[test]
fn what_is_said_to_have_no_solution_has_none_in_a_box_and_points_solve() {
    let mut numbers = Numbers(5);
    let mut decided = 0;
    let count = 6000;
    for k in 0..count {
        let (products, choices) = (k % 3 == 1, k % 3 == 2);
        let unknowns = 2 + (k % 3) as u32;
        let system = random(&mut numbers, unknowns, products, choices);
        let low = if products { 0 } else { -4 };
        let any = any_point(&system, unknowns, low, 4);
        match system.solve(&mut STEPS.clone()) {
            Solution::None => {
                assert!(!any, "{system:?}");
                decided += 1;
            }
            Solution::Point(point) => {
                assert!(any && system.all.iter().all(|own| own.holds(&point)), "{point:?} of {system:?}");
                decided += 1;
            }
            Solution::Open => {}
        }
    }
    assert!(decided * 10 > count * 8, "{decided} of {count} are decided");
}

#[test]
fn equations_without_a_coefficient_of_one_are_solved() {
    // 7x + 12y + 31z = 17, 3x + 5y + 14z = 7 (Pugh 1991): x = 1, y = -2 + …
    let row = |a: [i128; 3], c: i128| {
        let sum = (0..3).fold(number(-c), |sum, k| sum.plus_times(&x(k), a[k as usize]));
        Constraint { of: sum, zero: true }
    };
    let mut system = System { all: vec![row([7, 12, 31], 17), row([3, 5, 14], 7)], one_of: Vec::new() };
    system.all.extend(between(1, &x(0), 40));
    system.all.extend(between(-50, &x(1), 50));
    assert!(matches!(system.solve(&mut STEPS.clone()), Solution::Point(_)));
    let odd = System { all: vec![row([4, 6, 10], 7)], one_of: Vec::new() };
    assert_eq!(odd.solve(&mut STEPS.clone()), Solution::None);
}

#[test]
fn rows_of_a_matrix_do_not_overlap() {
    // a w + c == b w + d with 0 <= c, d < w: then a == b and c == d.
    let (a, b, c, d, w) = (x(0), x(1), x(2), x(3), x(4));
    let mut all: Vec<Constraint> =
        [&a, &b, &c, &d, &w].iter().map(|own| Constraint::at_most(&number(0), own)).collect();
    all.extend([Constraint::less(&c, &w), Constraint::less(&d, &w)]);
    let at = |row: &Polynomial, column: &Polynomial| row.product(&w).unwrap().plus(column);
    all.push(Constraint::equal(&at(&a, &c), &at(&b, &d)));
    let differ = |a: &Polynomial, b: &Polynomial| vec![vec![Constraint::less(a, b)], vec![Constraint::less(b, a)]];
    let system = |parts: Vec<Vec<Constraint>>| System { all: all.clone(), one_of: vec![parts] };
    assert_eq!(system(differ(&a, &b)).solve(&mut STEPS.clone()), Solution::None);
    assert_eq!(system(differ(&c, &d)).solve(&mut STEPS.clone()), Solution::None);
    // Without a bound on one column they do.
    let mut open = system(differ(&a, &b));
    open.all.remove(5);
    assert_ne!(open.solve(&mut STEPS.clone()), Solution::None);
}

#[test]
fn a_row_below_the_height_lies_inside() {
    // a <= h - 1 and c <= w - 1: a w + c <= h w - 1.
    let (a, c, h, w) = (x(0), x(1), x(2), x(3));
    let mut all: Vec<Constraint> = [&a, &c, &h, &w].iter().map(|own| Constraint::at_most(&number(0), own)).collect();
    all.extend([Constraint::less(&a, &h), Constraint::less(&c, &w)]);
    let (index, size) = (a.product(&w).unwrap().plus(&c), h.product(&w).unwrap());
    all.push(Constraint::at_most(&size, &index));
    let system = System { all, one_of: Vec::new() };
    assert_eq!(system.solve(&mut STEPS.clone()), Solution::None);
}

#[test]
fn a_limit_of_steps_leaves_it_open() {
    let system = random(&mut Numbers(9), 4, false, true);
    assert_eq!(system.solve(&mut 1), Solution::Open);
}
