//! Control flow in which slots part.

use super::super::{Binary64, FUEL, HazardKind};
use super::support::{batch, compile, glsl, run, wgsl};

/// Runs numbers 0 to 599 through a function of one integer: three chunks, the last one not full.
fn all(shader: &(naga::Module, naga::valid::ModuleInfo)) -> Vec<i64> {
    let rows: Vec<Vec<u32>> = (0..600).map(|k| vec![k]).collect();
    let meaning = run::<Binary64>(shader, &rows);
    (0..600).map(|k| meaning.vertex(k, 0)[0] as i64).collect()
}

fn expect(text: &str, expected: impl Fn(i64) -> i64) {
    let found = all(&wgsl(text));
    for (k, &found) in found.iter().enumerate() {
        assert_eq!(found, expected(k as i64), "at {k} of {text}");
    }
}

#[test]
fn slots_part_and_meet_again() {
    expect(
        "fn f(x: i32) -> i32 { var y = 1; if x % 3 == 0 { y = x; if x % 2 == 0 { y += 5; } } else { y -= x; } return y * 2; }",
        |x| 2 * if x % 3 == 0 { x + if x % 2 == 0 { 5 } else { 0 } } else { 1 - x },
    );
}

#[test]
fn an_early_return_stops_a_slot_and_no_other() {
    expect(
        "fn f(x: i32) -> i32 { if x < 300 { if x % 2 == 0 { return x; } } else { return -x; } var y = x; y += 1; return y * 10; }",
        |x| match x {
            300.. => -x,
            x if x % 2 == 0 => x,
            x => (x + 1) * 10,
        },
    );
}

#[test]
fn loops_with_break_and_continue_run_as_often_as_each_slot_wants() {
    let text = "fn f(x: i32) -> i32 {
        var sum = 0;
        for (var i = 0; i < x; i++) {
            if i % 4 == 1 { continue; }
            if i > 40 { break; }
            sum += i;
        }
        return sum;
    }";
    expect(text, |x| (0..x).filter(|i| i % 4 != 1).take_while(|i| *i <= 40).sum());
    let text = "fn f(x: i32) -> i32 {
        var n = x; var steps = 0;
        loop {
            if n <= 1 { break; }
            if n % 2 == 0 { n = n / 2; continue; }
            n = 3 * n + 1;
            continuing { steps++; break if steps >= 50; }
        }
        return steps;
    }";
    expect(text, |x| {
        let (mut n, mut steps) = (x, 0);
        while n > 1 && steps < 50 {
            n = if n % 2 == 0 { n / 2 } else { 3 * n + 1 };
            steps += 1;
        }
        steps
    });
}

#[test]
fn nested_loops_leave_the_innermost_one() {
    let text = "fn f(x: i32) -> i32 {
        var count = 0;
        for (var i = 0; i < x % 7; i++) {
            for (var j = 0; j < 10; j++) {
                if j == i { break; }
                count += 1;
            }
            if count > 8 { return -count; }
        }
        return count;
    }";
    expect(text, |x| {
        let mut count = 0;
        for i in 0..x % 7 {
            count += i;
            if count > 8 {
                return -count;
            }
        }
        count
    });
}

#[test]
fn a_switch_takes_its_case_and_continue_passes_through_it() {
    let text = "fn f(x: i32) -> i32 {
        var sum = 0;
        for (var i = 0; i < 6; i++) {
            switch (x + i) % 5 {
                case 0 { continue; }
                case 1, 2 { sum += 10; if x > 100 { break; } sum += 1; }
                case 3 { return 1000 + sum; }
                default { sum += 100; }
            }
            sum += 1000000;
        }
        return sum;
    }";
    expect(text, |x| {
        let mut sum = 0;
        for i in 0..6 {
            match (x + i) % 5 {
                0 => continue,
                1 | 2 => sum += if x > 100 { 10 } else { 11 },
                3 => return 1000 + sum,
                _ => sum += 100,
            }
            sum += 1_000_000;
        }
        sum
    });
}

#[test]
fn a_case_falls_through_to_the_next() {
    let text = "int f(int x) {
        int y = 0;
        switch (x % 4) {
            case 0: y += 1;
            case 1: y += 10; break;
            case 2: y += 100;
            default: y += 1000;
        }
        return y;
    }";
    let found = all(&glsl(text));
    for (k, &found) in found.iter().enumerate() {
        assert_eq!(found, [11, 10, 1100, 1000][k % 4], "{k}");
    }
}

#[test]
fn calls_return_to_where_each_slot_came_from() {
    let text = "
        fn root(x: i32) -> i32 { var r = 0; loop { if r * r >= x { return r; } r++; } return -1; }
        fn twice(x: i32) -> i32 { if x % 2 == 0 { return root(x); } return root(x) + root(x + 1); }
        fn f(x: i32) -> i32 { var s = 0; for (var i = 0; i < 3; i++) { s += twice(x + i); } return s; }";
    let root = |x: i64| (0..).find(|r| r * r >= x).unwrap();
    expect(text, |x| (x..x + 3).map(|x| if x % 2 == 0 { root(x) } else { root(x) + root(x + 1) }).sum());
}

#[test]
fn a_loop_without_end_is_reported_for_the_slots_that_run_it() {
    let shader = wgsl("fn f(x: i32) -> i32 { var y = x; loop { if y != 7 { break; } } return y + 1; }");
    let executable = compile(&shader).unwrap();
    let rows: Vec<Vec<u32>> = (0..20).map(|k| vec![k]).collect();
    let meaning = executable.run::<Binary64>(&batch(&rows), 100).unwrap();
    for k in 0..20 {
        assert_eq!(meaning.flags(k).has(HazardKind::Fuel), k == 7);
        if k != 7 {
            assert_eq!(meaning.vertex(k, 0), [k as f64 + 1.0]);
        }
    }
    assert!(!meaning.is_written(7, 0, 0));
    assert_eq!(meaning.findings().len(), 1);
    assert_eq!((meaning.findings()[0].kind, meaning.findings()[0].invocation), (HazardKind::Fuel, 7));
    let span = executable.place(meaning.findings()[0].site).span.to_range().unwrap();
    assert!("fn f(x: i32) -> i32 { var y = x; loop { if y != 7 { break; } } return y + 1; }"[span].starts_with("loop"));
}

#[test]
fn fuel_that_suffices_is_not_reported() {
    let shader = wgsl("fn f(x: i32) -> i32 { var y = 0; for (var i = 0; i < x; i++) { y += 2; } return y; }");
    let rows: Vec<Vec<u32>> = vec![vec![5000], vec![3]];
    let meaning = compile(&shader).unwrap().run::<Binary64>(&batch(&rows), FUEL).unwrap();
    assert!(meaning.findings().is_empty() && meaning.flags(0).is_empty());
    assert_eq!((meaning.vertex(0, 0)[0], meaning.vertex(1, 0)[0]), (10000.0, 6.0));
}
