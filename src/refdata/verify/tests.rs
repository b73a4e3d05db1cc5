//! Faults in outputs, each found.

use std::io::Cursor;

use super::*;
use crate::refdata::read::{ByteOrder, Column, Numbers, Source, outputs};
use crate::refdata::tests::{dataset, file};
use crate::refdata::write::Format;

fn reference(profile: Option<&str>, samples: u64) -> Dataset {
    dataset(&file("sphere", profile, Format::Npz, samples), Format::Npz).unwrap()
}

/// The nearest numbers of a reference, as somebody's outputs.
fn perfect(reference: &Dataset) -> Vec<u32> {
    let bytes = reference.array("nearest.gl_Position").unwrap().1;
    bytes.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect()
}

fn table(name: &str, bits: Vec<u32>) -> Table {
    Table { columns: vec![Column { name: name.into(), width: 4, numbers: Numbers::F4(bits) }] }
}

fn with(mut table: Table, name: &str, width: usize, numbers: Numbers) -> Table {
    table.columns.push(Column { name: name.into(), width, numbers });
    table
}

fn run(reference: &Dataset, actual: &Table) -> Report {
    verify(reference, actual, Rule::default(), &mut |_| {}).unwrap()
}

#[test]
fn the_nearest_numbers_pass() {
    let reference = reference(Some("binary32"), 500);
    for name in ["gl_Position", "actual.gl_Position", "", "arr_0"] {
        let report = run(&reference, &table(name, perfect(&reference)));
        assert_eq!(report.findings, [], "{name}");
        assert!(report.total().agreed > 1900 && report.total().deviated == 0);
    }
    let exact = Rule { exact: true };
    let report = verify(&reference, &table("gl_Position", perfect(&reference)), exact, &mut |_| {}).unwrap();
    assert_eq!((report.total().agreed, report.findings.len()), (2000, 0));
}

#[test]
fn a_flipped_bit_is_found_where_it_exceeds_the_bound() {
    let reference = reference(Some("binary32"), 500);
    let good = perfect(&reference);
    let bounds = reference.array("bound.gl_Position").unwrap().1;
    let bound = |at: usize| f64::from(f32::from_le_bytes(bounds[4 * at..4 * at + 4].try_into().unwrap()));
    let (mut found, mut within) = (0, 0);
    for at in (0..good.len()).step_by(37) {
        for bit in 0..31 {
            let mut bits = good.clone();
            bits[at] ^= 1 << bit;
            let moved = (f64::from(f32::from_bits(bits[at])) - f64::from(f32::from_bits(good[at]))).abs();
            let report = run(&reference, &table("gl_Position", bits.clone()));
            if !(moved <= 1.5 * bound(at)) {
                let wrong = report.total().deviated + report.total().not_finite;
                assert_eq!(wrong, 1, "bit {bit} of element {at}");
                assert_eq!(report.worst[0].element.sample, at as u64 / 4);
                found += 1;
            } else {
                within += 1;
            }
            let exact = verify(&reference, &table("gl_Position", bits), Rule { exact: true }, &mut |_| {}).unwrap();
            assert_eq!(exact.findings.len(), 1, "bit {bit} of element {at}");
        }
    }
    assert!(found > 500 && within > 50, "{found} {within}");
}

#[test]
fn rows_that_are_missing_extra_or_elsewhere_are_found() {
    let reference = reference(Some("binary32"), 100);
    let good = perfect(&reference);
    let short = run(&reference, &table("gl_Position", good[..4 * 90].to_vec()));
    assert_eq!(short.findings, [Finding::MissingSamples(10, 90)]);
    let long = run(&reference, &table("gl_Position", [&good[..], &good[..8]].concat()));
    assert_eq!(long.findings, [Finding::ExtraRows(2, 100)]);

    // Rows in another order: told by an index, or by the inputs.
    let mut order: Vec<usize> = (0..100).collect();
    order.swap(20, 60);
    let swapped: Vec<u32> = order.iter().flat_map(|&row| good[4 * row..4 * row + 4].to_vec()).collect();
    let unknown = run(&reference, &table("gl_Position", swapped.clone()));
    assert!(matches!(unknown.findings[..], [Finding::Deviate(_)]));
    let index = Numbers::Whole(order.iter().map(|&row| row as i64).collect());
    let told = run(&reference, &with(table("gl_Position", swapped.clone()), "index", 1, index));
    assert_eq!((told.matched, told.total().deviated), ("index", 0));
    assert!(matches!(told.findings[..], [Finding::Misordered(_, 21)]), "{:?}", told.findings);
    let parameters = reference.array("input.parameter").unwrap().1;
    let inputs: Vec<u32> = order
        .iter()
        .flat_map(|&row| parameters[8 * row..8 * row + 8].chunks_exact(4))
        .map(|b| u32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    let matched = with(table("gl_Position", swapped), "input.parameter", 2, Numbers::F4(inputs.clone()));
    let seen = run(&reference, &matched);
    assert_eq!(seen.matched, "inputs");
    assert!(matches!(seen.findings[..], [Finding::Misordered(..)]), "{:?}", seen.findings);

    let twice = Numbers::Whole((0..100).map(|row| if row == 7 { 6 } else { row }).collect());
    let twice = run(&reference, &with(table("gl_Position", good.clone()), "index", 1, twice));
    assert_eq!(twice.findings, [Finding::MissingSamples(1, 7), Finding::Repeated(1, 7)]);
    let mut other = inputs;
    other[11] ^= 1;
    let other = run(&reference, &with(table("gl_Position", good), "parameter", 2, Numbers::F4(other)));
    assert!(other.findings.contains(&Finding::OtherInputs(1, 5)), "{:?}", other.findings);
}

#[test]
fn what_is_no_number_is_found() {
    let reference = reference(Some("binary32"), 50);
    for fault in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut bits = perfect(&reference);
        bits[17] = fault.to_bits();
        let report = run(&reference, &table("gl_Position", bits));
        assert_eq!(report.findings, [Finding::NotFinite(1)]);
        assert_eq!(report.worst[0].element.component, "gl_Position.y");
    }
}

#[test]
fn bytes_in_the_other_order_are_told() {
    let reference = reference(Some("binary32"), 200);
    let bytes: Vec<u8> = perfect(&reference).iter().flat_map(|bits| bits.to_be_bytes()).collect();
    let read = |order| outputs(Source::Raw, &mut Cursor::new(bytes.clone()), order, 4).unwrap();
    let report = run(&reference, &read(ByteOrder::Little));
    assert!(report.findings.contains(&Finding::ByteOrder), "{:?}", report.findings);
    assert_eq!(run(&reference, &read(ByteOrder::Big)).findings, []);
    let odd = outputs(Source::Raw, &mut Cursor::new(bytes[..30].to_vec()), ByteOrder::Big, 4).unwrap_err();
    assert!(odd.to_string().starts_with("it has 30 bytes, which is no multiple of 16"), "{odd}");
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let reference = reference(None, 20);
    let good = table("gl_Position", perfect(&reference));
    let of = |actual: &Table, exact| verify(&reference, actual, Rule { exact }, &mut |_| {});
    assert_eq!(of(&good, false).unwrap_err(), VerifyError::NoBounds);
    assert!(of(&good, true).is_ok());
    let other = with(table("velocity", perfect(&reference)), "normal", 4, Numbers::F4(perfect(&reference)));
    let error = of(&other, true).unwrap_err();
    assert_eq!(
        error.to_string(),
        "none of the outputs of the reference (`gl_Position`) is there; there are: `velocity`, `normal`"
    );
    let narrow = Table { columns: vec![Column { width: 2, ..good.columns[0].clone() }] };
    assert!(matches!(of(&narrow, true).unwrap_err(), VerifyError::Width { found: 2, wanted: 4, .. }));
}

#[test]
fn columns_for_each_word_are_one_output() {
    let reference = reference(Some("binary32"), 30);
    let good = perfect(&reference);
    let column = |k: usize, name: &str| Column {
        name: format!("gl_Position.{name}"),
        width: 1,
        numbers: Numbers::F4(good.iter().skip(k).step_by(4).copied().collect()),
    };
    let columns = ["x", "y", "z", "w"].iter().enumerate().map(|(k, name)| column(k, name)).collect();
    assert_eq!(run(&reference, &Table { columns }).findings, []);
}

#[test]
fn a_run_that_judges_nothing_has_not_passed() {
    let mut reference = reference(Some("binary32"), 10);
    let at = reference.document.arrays.iter().position(|array| array.role == Role::Bound).unwrap();
    reference.arrays[at] = f32::INFINITY.to_le_bytes().repeat(40);
    let good = table("gl_Position", perfect(&reference));
    assert_eq!(run(&reference, &good).findings, [Finding::NothingJudged]);
}
