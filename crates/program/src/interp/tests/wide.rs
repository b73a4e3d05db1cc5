//! Whole numbers of 64 bits, against those of Rust.

use super::support::{compile, row, row32, run, wgsl};
use crate::interp::{Binary32, HazardKind};

/// Numbers at which carries, signs and halves matter, and some others.
fn numbers() -> Vec<u64> {
    let mut all = vec![0, 1, 2, 31, 32, 33, 63, 0xffff, 0x1_0000, 0x7fff_ffff, 0x8000_0000, 0xffff_ffff, 0x1_0000_0000];
    all.extend([0x7fff_ffff_ffff_ffff, 0x8000_0000_0000_0000, u64::MAX, u64::MAX - 1, 0xffff_ffff_0000_0000]);
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for shift in [0, 0, 7, 20, 33, 40, 50, 60] {
        state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        all.push(state >> shift);
    }
    all
}

fn halves(value: u64) -> [u32; 2] {
    [(value & 0xffff_ffff) as u32, (value >> 32) as u32]
}

/// `expression` of `x` and `y` in a type, as a number of 64 bits.
fn shader(ty: &str, expression: &str) -> (naga::Module, naga::valid::ModuleInfo) {
    wgsl(&format!(
        "fn f(a: vec2u, b: vec2u) -> vec2u {{\n\
         let x = bitcast<{ty}>((u64(a.y) << 32u) | u64(a.x)); let y = bitcast<{ty}>((u64(b.y) << 32u) | u64(b.x));\n\
         let r = bitcast<u64>({expression}); return vec2u(u32(r & 0xfffffffflu), u32(r >> 32u)); }}"
    ))
}

/// An expression, and what it is in Rust.
type Case<T> = (&'static str, fn(T, T) -> T);

#[track_caller]
fn check(ty: &str, expression: &str, expected: &dyn Fn(u64, u64) -> u64) {
    let shader = shader(ty, expression);
    let all = numbers();
    let pairs: Vec<[u64; 2]> = all.iter().flat_map(|&x| all.iter().map(move |&y| [x, y])).collect();
    let rows: Vec<Vec<u32>> = pairs.iter().map(|pair| pair.iter().flat_map(|&x| halves(x)).collect()).collect();
    let found = run::<Binary32>(&shader, &rows);
    for (k, &[x, y]) in pairs.iter().enumerate() {
        let found = found.vertex(k, 0);
        assert_eq!(found, halves(expected(x, y)), "{expression} at {x:#x} and {y:#x}");
    }
}

#[test]
fn numbers_without_a_sign_are_those_of_rust() {
    let cases: [Case<u64>; 17] = [
        ("x + y", u64::wrapping_add),
        ("x - y", u64::wrapping_sub),
        ("x * y", u64::wrapping_mul),
        ("x / y", |x, y| x.checked_div(y).unwrap_or(x)),
        ("x % y", |x, y| x.checked_rem(y).unwrap_or(0)),
        ("(x & y) ^ (x | ~y)", |x, y| (x & y) ^ (x | !y)),
        ("x << (u32(y) & 63u)", |x, y| x << (y & 63)),
        ("x >> (u32(y) & 63u)", |x, y| x >> (y & 63)),
        ("min(x, y) + max(x, 7lu)", |x, y| x.min(y).wrapping_add(x.max(7))),
        ("clamp(x, 5lu, 0xfffffffffflu)", |x, _| x.clamp(5, 0xff_ffff_ffff)),
        ("u64(x < y) | (u64(x <= y) << 1u) | (u64(x > y) << 2u)", |x, y| {
            u64::from(x < y) | u64::from(x <= y) << 1 | u64::from(x > y) << 2
        }),
        ("u64(x == y) | (u64(x != y) << 40u)", |x, y| u64::from(x == y) | u64::from(x != y) << 40),
        ("select(x, y, (x & 1lu) == 0lu)", |x, y| if x & 1 == 0 { y } else { x }),
        ("u64(i64(i32(x)))", |x, _| i64::from(x as u32 as i32) as u64),
        ("(vec2<u64>(x, y).yx * vec2<u64>(3lu, 1lu)).x", |_, y| y.wrapping_mul(3)),
        ("array<u64, 3>(x, y, 9lu)[u32(x) % 3u]", |x, y| [x, y, 9][((x & 0xffff_ffff) % 3) as usize]),
        ("u64(bool(x))", |x, _| u64::from(x != 0)),
    ];
    for (expression, expected) in cases {
        check("u64", expression, &expected);
    }
}

#[test]
fn numbers_with_a_sign_are_those_of_rust() {
    let cases: [Case<i64>; 8] = [
        ("x / y", |x, y| x.checked_div(y).unwrap_or(x)),
        ("x % y", |x, y| x.checked_rem(y).unwrap_or(0)),
        ("x >> (u32(y) & 63u)", |x, y| x >> (y & 63)),
        ("-x * y", |x, y| x.wrapping_neg().wrapping_mul(y)),
        ("abs(x) - sign(y)", |x, y| x.wrapping_abs().wrapping_sub(y.signum())),
        ("min(x, y)", i64::min),
        ("max(x, -3li)", |x, _| x.max(-3)),
        ("i64(x < y) + 2li * i64(x >= y)", |x, y| i64::from(x < y) + 2 * i64::from(x >= y)),
    ];
    for (expression, expected) in cases {
        check("i64", expression, &|x, y| expected(x.cast_signed(), y.cast_signed()).cast_unsigned());
    }
}

#[test]
fn they_become_real_numbers_and_a_division_by_zero_is_told() {
    let shader = wgsl("fn f(a: vec2u) -> f32 { return f32(bitcast<i64>((u64(a.y) << 32u) | u64(a.x))); }");
    assert_eq!(row(&shader, &halves((-5_000_000_000_i64).cast_unsigned())), [-5e9]);
    assert_eq!(row32(&shader, &halves(1 << 40)), [(1_u64 << 40) as f32].map(f32::to_bits));
    let divided = super::wide::shader("u64", "x / y");
    let executable = compile(&divided).unwrap();
    let batch = super::support::batch(&[vec![7, 1, 0, 0], vec![7, 1, 0, 2]]);
    let meaning = executable.run::<Binary32>(&batch, crate::interp::FUEL).unwrap();
    assert_eq!([0, 1].map(|k| meaning.flags(k).has(HazardKind::DivisionByZero)), [true, false]);
}
