//! How much faster functions are on columns than one by one in the standard library: both in turn in one
//! run, the fastest of many repetitions. Ratios are what to quote.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::hint::black_box;
use std::time::Instant;

/// Numbers of a column, as the interpreter has them.
const COLUMN: usize = 256;
/// Passes over the column that are timed together.
const PASSES: usize = 200;
/// Repetitions; the fastest counts, since other work on the machine only ever slows a run down.
const REPEAT: usize = 50;

fn main() {
    println!("function   column ns   std ns   std/column");
    let angles = spread(-10.0, 10.0);
    unary("sin", &number::SIN, f64::sin, &angles);
    unary("cos", &number::COS, f64::cos, &angles);
    unary("sin, 1e9", &number::SIN, f64::sin, &spread(1e9, 1.07e9));
    unary("exp2", &number::EXP2, f64::exp2, &spread(-100.0, 100.0));
    unary("log2", &number::LOG2, f64::log2, &spread(0.01, 100.0));
    unary("atan", &number::ATAN, f64::atan, &angles);
    let (bases, exponents) = (spread(0.1, 10.0), spread(-8.0, 8.0));
    let power = |out: &mut [f64]| number::POW.column(black_box(&bases), black_box(&exponents), out);
    compare("pow", power, |out| {
        for ((out, a), b) in out.iter_mut().zip(black_box(&bases)).zip(black_box(&exponents)) {
            *out = a.powf(*b);
        }
    });
}

/// Numbers of a range, in an order that no branch is predicted by.
fn spread(lo: f64, hi: f64) -> Vec<f64> {
    (0..COLUMN).map(|k| lo + (hi - lo) * (k * 97 % COLUMN) as f64 / (COLUMN as f64 - 0.7)).collect()
}

fn unary(name: &str, function: &number::Unary, library: fn(f64) -> f64, x: &[f64]) {
    let column = |out: &mut [f64]| function.column(black_box(x), out);
    compare(name, column, |out| {
        for (out, x) in out.iter_mut().zip(black_box(x)) {
            *out = library(*x);
        }
    });
}

/// Prints nanoseconds a number, of the column and of the standard library.
fn compare(name: &str, column: impl Fn(&mut [f64]), library: impl Fn(&mut [f64])) {
    let mut out = vec![0.0; COLUMN];
    let mut time = |work: &dyn Fn(&mut [f64])| {
        let start = Instant::now();
        for _ in 0..PASSES {
            work(&mut out);
            black_box(&mut out);
        }
        start.elapsed().as_secs_f64() * 1e9 / (PASSES * COLUMN) as f64
    };
    let [mut fast, mut slow] = [f64::MAX; 2];
    for _ in 0..REPEAT {
        fast = fast.min(time(&column));
        slow = slow.min(time(&library));
    }
    println!("{name:<10} {fast:>9.2}   {slow:>6.2}   {:>10.1}", slow / fast);
}
