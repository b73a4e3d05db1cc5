//! What leaves the range of its type: the rules of WGSL, and a report.

use super::super::{Binary64, Executable, HazardKind, Meaning};
use super::support::{batch, compile, floats, ints, run, wgsl};
use crate::Written;

fn kinds(meaning: &Meaning<f64>, invocation: usize) -> Vec<HazardKind> {
    HazardKind::ALL.into_iter().filter(|&kind| meaning.flags(invocation).has(kind)).collect()
}

#[test]
fn an_index_outside_takes_the_last_element_and_is_reported() {
    let text = "fn f(i: i32) -> f32 { var a = array<f32, 3>(1, 2, 3); return a[i]; }";
    let shader = wgsl(text);
    let meaning = run::<Binary64>(&shader, &[vec![1], vec![3], ints(&[-1])]);
    assert_eq!([0, 1, 2].map(|k| meaning.vertex(k, 0)[0]), [2.0, 3.0, 3.0]);
    assert_eq!(
        (kinds(&meaning, 0), kinds(&meaning, 1), kinds(&meaning, 2)),
        (vec![], vec![HazardKind::Index], vec![HazardKind::Index])
    );
    let executable = compile(&shader).unwrap();
    let [finding] = meaning.findings() else { panic!("{:?}", meaning.findings()) };
    assert_eq!((finding.invocation, finding.count), (1, 2));
    assert_eq!(&text[executable.place(finding.site).span.to_range().unwrap()], "a[i]");
}

#[test]
fn division_by_zero_and_overflow_follow_wgsl() {
    let quotient = wgsl("fn f(a: i32, b: i32) -> vec2<i32> { return vec2(a / b, a % b); }");
    let rows = [ints(&[7, 0]), ints(&[i32::MIN, -1]), ints(&[7, 2])];
    let meaning = run::<Binary64>(&quotient, &rows);
    assert_eq!(meaning.vertex(0, 0), [7.0, 0.0]);
    assert_eq!(meaning.vertex(1, 0), [f64::from(i32::MIN), 0.0]);
    assert_eq!(kinds(&meaning, 0), [HazardKind::DivisionByZero]);
    assert_eq!(kinds(&meaning, 1), [HazardKind::Quotient, HazardKind::Remainder]);
    assert!(meaning.flags(2).is_empty());
    let unsigned = wgsl("fn f(a: u32, b: u32) -> vec2u { return vec2(a / b, a % b); }");
    let meaning = run::<Binary64>(&unsigned, &[vec![7, 0]]);
    assert_eq!((meaning.vertex(0, 0), kinds(&meaning, 0)), (&[7.0, 0.0][..], vec![HazardKind::DivisionByZero]));
}

#[test]
fn signed_sums_and_products_are_reported_and_unsigned_ones_wrap_in_silence() {
    for (operator, a, b, wrapped) in
        [("+", i32::MAX, 1, i32::MIN), ("-", i32::MIN, 1, i32::MAX), ("*", 65536, 65537, 65536)]
    {
        let shader = wgsl(&format!("fn f(a: i32, b: i32) -> i32 {{ return a {operator} b; }}"));
        let meaning = run::<Binary64>(&shader, &[ints(&[a, b]), ints(&[3, 4])]);
        assert_eq!(meaning.vertex(0, 0), [f64::from(wrapped)], "{operator}");
        assert_eq!((kinds(&meaning, 0), kinds(&meaning, 1)), (vec![HazardKind::Overflow], vec![]), "{operator}");
        let shader = wgsl(&format!("fn f(a: u32, b: u32) -> u32 {{ return a {operator} b; }}"));
        assert!(run::<Binary64>(&shader, &[vec![u32::MAX, 7], vec![0, 1]]).findings().is_empty());
    }
    let negated = wgsl("fn f(a: i32) -> vec2<i32> { return vec2(-a, abs(a)); }");
    let meaning = run::<Binary64>(&negated, &[ints(&[i32::MIN])]);
    assert_eq!((meaning.vertex(0, 0)[0], meaning.findings().len()), (f64::from(i32::MIN), 2));
}

#[test]
fn shifts_and_conversions_are_cut_and_reported() {
    let shift = wgsl("fn f(a: u32, b: u32) -> vec2u { return vec2(a << b, a >> b); }");
    let meaning = run::<Binary64>(&shift, &[vec![6, 33], vec![6, 1]]);
    assert_eq!((meaning.vertex(0, 0), kinds(&meaning, 0)), (&[12.0, 3.0][..], vec![HazardKind::Shift]));
    assert!(meaning.flags(1).is_empty());
    let convert = wgsl("fn f(x: f32) -> vec2f { return vec2f(f32(i32(x)), f32(u32(x))); }");
    let rows = [floats(&[3e9]), floats(&[-2.0]), floats(&[f32::NAN]), floats(&[-0.5])];
    let meaning = run::<Binary64>(&convert, &rows);
    assert_eq!(meaning.vertex(0, 0), [2_147_483_520.0, 3e9]);
    assert_eq!(meaning.vertex(1, 0), [-2.0, 0.0]);
    // GLSL leaves the conversion of every negative number to `uint` undefined (4.60, 5.4.1).
    for (k, reported) in [true, true, true, true].into_iter().enumerate() {
        assert_eq!(meaning.flags(k).has(HazardKind::Conversion), reported, "{k}");
    }
}

#[test]
fn slots_that_do_not_go_there_report_nothing() {
    let shader = wgsl("fn f(a: i32, b: i32) -> i32 { var r = -1; if b != 0 { r = a / b; } return r; }");
    let rows: Vec<Vec<u32>> = (0..300).map(|k| vec![100, k % 3]).collect();
    let meaning = run::<Binary64>(&shader, &rows);
    assert!(meaning.findings().is_empty());
    assert_eq!([0, 1, 2].map(|k| meaning.vertex(k, 0)[0]), [-1.0, 100.0, 50.0]);
}

#[test]
fn slots_behind_the_last_invocation_report_nothing() {
    let shader = wgsl("fn f(a: i32, b: i32) -> i32 { return a / b; }");
    let meaning = run::<Binary64>(&shader, &[ints(&[1, 0])]);
    assert_eq!((meaning.count(), meaning.findings()[0].count), (1, 1));
}

#[test]
fn a_batch_for_another_program_is_refused() {
    let executable = compile(&wgsl("fn f(a: i32, b: i32) -> i32 { return a / b; }")).unwrap();
    let error = executable.run::<Binary64>(&batch(&[vec![1]]), 1).unwrap_err();
    assert_eq!(error.to_string(), "the batch has 1 words for each invocation, the program takes 2");
}

/// Findings of `f` in WGSL and in GLSL with one row of numbers, and the words of the first.
fn in_both(text: &str, row: &[f32]) -> (Vec<HazardKind>, Vec<HazardKind>, Vec<f64>) {
    let shader = wgsl(text);
    let batch = batch(&[floats(row)]);
    let run = |written: Written| {
        let executable = Executable { written, ..compile(&shader).unwrap() };
        let meaning = executable.run::<Binary64>(&batch, 1 << 20).unwrap();
        (kinds(&meaning, 0), meaning.vertex(0, 0).to_vec())
    };
    let ((wgsl, words), (other, _)) = (run(Written::Wgsl), run(Written::Glsl));
    (wgsl, other, words)
}

#[test]
fn wgsl_clamps_conversions_to_binary32_and_leaves_nan_open() {
    let text = "fn f(x: f32) -> vec2f { return vec2f(f32(i32(x)), f32(u32(x))); }";
    for (x, kinds, words) in [
        (3e9, vec![], [2_147_483_520.0, 3e9]),
        (1e30, vec![], [2_147_483_520.0, 4_294_967_040.0]),
        (2_147_483_648.0, vec![], [2_147_483_520.0, 2_147_483_648.0]),
        (-1e30, vec![], [-2_147_483_648.0, 0.0]),
        (f32::INFINITY, vec![], [2_147_483_520.0, 4_294_967_040.0]),
        (f32::NAN, vec![HazardKind::Conversion], [0.0, 0.0]),
    ] {
        let found = in_both(text, &[x]);
        assert_eq!((found.0, found.2), (kinds, words.to_vec()), "{x}");
        assert_eq!(found.1, [HazardKind::Conversion], "GLSL, {x}");
    }
    let spirv = Executable { written: Written::Hlsl, ..compile(&wgsl(text)).unwrap() };
    let meaning = spirv.run::<Binary64>(&batch(&[floats(&[3e9])]), 1).unwrap();
    assert_eq!(kinds(&meaning, 0), [HazardKind::Conversion], "HLSL does not say");
}

#[test]
fn what_does_not_fit_binary16_is_left_open_by_wgsl_alone() {
    for text in [
        "fn f(x: f32) -> f32 { return min(1.0, unpack2x16float(pack2x16float(vec2f(x, 0.0))).x); }",
        "fn f(x: f32) -> f32 { return min(1.0, quantizeToF16(x)); }",
    ] {
        for (x, outside) in [(65504.0, false), (65505.0, true), (-70000.0, true), (f32::INFINITY, true), (0.5, false)] {
            let (wgsl, glsl, _) = in_both(text, &[x]);
            let expected = if outside { vec![HazardKind::Argument] } else { vec![] };
            assert_eq!((wgsl, glsl), (expected, vec![]), "{text} at {x}");
        }
    }
}
