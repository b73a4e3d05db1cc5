//! Faults in outputs, each found.

use std::io::Cursor;

use super::*;
use crate::read::{ByteOrder, Column, InputFormat, Numbers, Shared, Wanted, outputs};
use crate::tests::{dataset, file};
use crate::write::Format;

fn memory(bytes: &[u8]) -> Shared {
    Shared::new(Box::new(Cursor::new(bytes.to_vec()))).unwrap()
}

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
    let exact = Rule { exact: true, ..Rule::default() };
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
            let exact =
                verify(&reference, &table("gl_Position", bits), Rule { exact: true, ..Rule::default() }, &mut |_| {})
                    .unwrap();
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
    let reported = run(&reference, &with(table("gl_Position", swapped.clone()), "index", 1, index));
    assert_eq!((reported.matched, reported.total().deviated), ("index", 0));
    assert!(matches!(reported.findings[..], [Finding::Misordered(_, 21)]), "{:?}", reported.findings);
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
fn bytes_in_the_other_order_are_reported() {
    let reference = reference(Some("binary32"), 200);
    let bytes: Vec<u8> = perfect(&reference).iter().flat_map(|bits| bits.to_be_bytes()).collect();
    let wanted = Wanted::outputs(&reference.document);
    let read = |order| outputs(InputFormat::Raw, &memory(&bytes), order, &wanted).unwrap();
    let report = run(&reference, &read(ByteOrder::Little));
    assert!(report.findings.contains(&Finding::ByteOrder), "{:?}", report.findings);
    assert_eq!(run(&reference, &read(ByteOrder::Big)).findings, []);
    let odd = outputs(InputFormat::Raw, &memory(&bytes[..30]), ByteOrder::Big, &wanted).err().unwrap();
    assert!(odd.to_string().starts_with("it has 30 bytes, which is no multiple of 16"), "{odd}");
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let reference = reference(None, 20);
    let good = table("gl_Position", perfect(&reference));
    let of = |actual: &Table, exact| verify(&reference, actual, Rule { exact, ..Rule::default() }, &mut |_| {});
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

/// A table, some rows at a time.
struct Rows(Table, usize);

impl crate::read::Windows for Rows {
    fn next(&mut self, rows: usize) -> Result<Table, crate::read::ReadError> {
        let begin = self.1;
        self.1 += rows;
        Ok(self.0.window(begin..self.1))
    }
}

#[test]
fn block_by_block_comes_out_what_comes_out_as_a_whole() {
    use crate::read::Blocks;
    // Blocks of 65536 samples: two and a part of one.
    let bytes = file("bone_weight", Some("binary32"), Format::Npz, 140_000);
    let reference = dataset(&bytes, Format::Npz).unwrap();
    let good: Vec<u32> = reference
        .array("nearest.return")
        .unwrap()
        .1
        .chunks_exact(4)
        .map(|b| u32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    let column = |bits: Vec<u32>| Column { name: "return".into(), width: 1, numbers: Numbers::F4(bits) };
    let plain = |bits: Vec<u32>| Table { columns: vec![column(bits)] };
    let index = |list: Vec<i64>| Column { name: "index".into(), width: 1, numbers: Numbers::Whole(list) };
    let indexed = |bits: Vec<u32>, list: Vec<i64>| Table { columns: vec![index(list), column(bits)] };
    let all: Vec<i64> = (0..140_000).collect();
    let mut flipped = good.clone();
    flipped[70_000] ^= 1 << 22;
    flipped[139_999] = f32::NAN.to_bits();
    let swapped: Vec<u32> = good.iter().map(|bits| bits.swap_bytes()).collect();
    let cases = [
        ("right", plain(good.clone()), true),
        ("two faults", plain(flipped.clone()), true),
        ("rows missing in the middle of a block", plain(good[..100_000].to_vec()), true),
        ("rows missing from the end of a block", plain(good[..65_536].to_vec()), true),
        ("rows that are extra", plain([&good[..], &good[..70_000]].concat()), true),
        ("the other order of bytes", plain(swapped), true),
        ("an index", indexed(flipped, all.clone()), true),
        ("an index with a gap", indexed(good[1..].to_vec(), all[1..].to_vec()), false),
        (
            "an index backwards",
            indexed(good.iter().rev().copied().collect(), all.iter().rev().copied().collect()),
            false,
        ),
        ("an index that goes on", indexed([&good[..], &good[..1]].concat(), (0..140_001).collect()), false),
    ];
    for (name, table, streams) in cases {
        let mut elements = Vec::new();
        let whole = verify(&reference, &table, Rule::default(), &mut |e| elements.push(e.clone())).unwrap();
        let mut blocks = Blocks::open(InputFormat::Npz, &memory(&bytes)).unwrap();
        let mut seen = Vec::new();
        let report = stream(&mut blocks, &mut Rows(table, 0), Rule::default(), &mut |e| seen.push(e.clone())).unwrap();
        assert_eq!(report.is_some(), streams, "{name}");
        if let Some(report) = report {
            assert_eq!(format!("{report:?}"), format!("{whole:?}"), "{name}");
            assert!(format!("{seen:?}") == format!("{elements:?}"), "{name}: other elements");
        }
    }
    // A reference that is damaged gives no report, however far the comparison came.
    let mut damaged = bytes;
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    let mut blocks = Blocks::open(InputFormat::Npz, &memory(&damaged)).unwrap();
    let error = stream(&mut blocks, &mut Rows(plain(good), 0), Rule::default(), &mut |_| {}).unwrap_err();
    assert!(error.to_string().starts_with("SHA-256 is "), "{error}");
}
